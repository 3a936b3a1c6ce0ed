"""The workbench in the browser: the loop by hand, beside Python."""

from __future__ import annotations

import html
import tempfile
import time
import webbrowser
from os import PathLike, fspath
from pathlib import Path as Place
from types import TracebackType

from umbmark import _umbmark
from umbmark._arguments import Seed, options_of, whole
from umbmark._scores import Data, data_of

# Between two looks at whether it still answers.
LOOK_SECONDS = 0.2


class Workbench:
    """A workbench that is open in the browser, until it is closed or Python ends.

    Attributes
    ----------
    address : str
        Its address, for this machine only and for whoever has it.
    """

    def __init__(self, server: _umbmark.Server) -> None:
        """Show what is served."""
        self._server = server
        self.address: str = server.address

    @property
    def is_open(self) -> bool:
        """Whether it still answers."""
        return self._server.is_open()

    def wait(self) -> None:
        """Wait until it is closed: a script that ends ends its workbench. Ctrl-C ends both."""
        try:
            while self.is_open:
                time.sleep(LOOK_SECONDS)
        finally:
            self.close()

    def close(self) -> None:
        """End it. What was done on the page is kept beside the data."""
        self._server.close()

    def __enter__(self) -> Workbench:
        """Leave it open."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        """End it."""
        self.close()

    def __repr__(self) -> str:
        return f"Workbench({self.address if self.is_open else 'closed'})"

    def _repr_html_(self) -> str:
        if not self.is_open:
            return "<p>This workbench is closed.</p>"
        address = html.escape(self.address)
        return (
            f'<p><a href="{address}" target="_blank">{address}</a></p>'
            f'<iframe src="{address}" style="width:100%;height:800px;border:0"></iframe>'
        )


def open(
    data: Data | None = None,
    *,
    port: int = 0,
    browser: bool | None = None,
    drops: str | PathLike[str] = "umbmark_open",
    size: float = 0.05,
    draws: int = 999,
    seed: Seed = 1,
    threads: int = 0,
) -> Workbench:
    """Open the workbench: compare, try an effect, fit, and watch the error fall, in the browser.

    A server answers on 127.0.0.1 alone, on a thread of its own, and only who has its address.

    Parameters
    ----------
    data : Dataset or path-like, optional
        The measurements to begin with; a dataset in memory is written to a folder in ``drops``.
        Without it, files can be dropped on the page, or returns typed there.
    port : int, default 0
        The port; 0 takes any that is free.
    browser : bool, optional
        Whether to open the browser; by default not in a notebook, which shows the page itself.
    drops : path-like, default "umbmark_open"
        The folder into which files are written that are dropped on the page.
    size, draws, seed, threads
        As of ``diagnose``.

    Returns
    -------
    Workbench
        Open until it is closed; ``wait`` keeps a script from ending.

    Raises
    ------
    DataError
        If the data cannot be read.
    UmbmarkError
        If the port cannot be used.

    Examples
    --------
    >>> import umbmark
    >>> with umbmark.open(browser=False) as workbench:
    ...     workbench.is_open
    True
    >>> workbench
    Workbench(closed)
    """
    served = _umbmark.serve(
        None if data is None else _place_of(data, fspath(drops)),
        fspath(drops),
        whole("port", port, 0, 65535),
        options_of(size, draws, seed),
        threads,
    )
    workbench = Workbench(served)
    if browser or (browser is None and not _is_notebook()):
        webbrowser.open(workbench.address)
    return workbench


def _place_of(data: Data, drops: str) -> str:
    """Give the place of a dataset; one in memory, or several, are written to a folder."""
    if isinstance(data, str | PathLike):
        return fspath(data)
    read = data_of(data)
    Place(drops).mkdir(parents=True, exist_ok=True)
    place = Place(tempfile.mkdtemp(prefix="dataset_", dir=drops)) / "data"
    read.save(place)
    return fspath(place)


def _is_notebook() -> bool:
    """Whether a notebook shows what a cell gives."""
    try:
        from IPython import get_ipython
    except ImportError:
        return False
    shell = get_ipython()
    return shell is not None and getattr(shell, "kernel", None) is not None
