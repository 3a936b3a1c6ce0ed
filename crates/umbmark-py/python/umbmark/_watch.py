"""Whether a robot that is tested again and again changes."""

from __future__ import annotations

from os import PathLike, fspath
from typing import TYPE_CHECKING

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed, integer, real, seed_of
from umbmark._result import Printed, Row
from umbmark._scores import Data, data_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Watched(_documents.Watched, Printed, frozen=True):
    """What is known of a robot that is watched."""

    text: str

    def table(self) -> list[Row]:
        """Give the runs with their likelihood ratios and limits, one dict a row."""
        kinds = ("numbers", "place", "scatter")
        heights = [key for kind in kinds for key in (kind, f"{kind}_limit")]
        keys = ("run", "direction", "used", "outlying", "p", *heights)
        return [{key: getattr(run, key) for key in keys} for run in self.runs]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the likelihood ratios of changes over the runs, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.watched(self, ax)


def watch(
    data: Data,
    state: str | PathLike[str] | None = None,
    *,
    false_alarms: float | None = None,
    runs_per_month: int | None = None,
    restart: str | None = None,
    seed: Seed = 1,
    threads: int = 0,
) -> Watched:
    """Find whether a robot that is tested again and again changed, since when, and what of it.

    Parameters
    ----------
    data : Dataset or path-like, or several paths
        A dataset that grows, or several in the order of time.
    state : path-like, optional
        File in which the runs are kept until the next call; it is made if it does not exist.
        Without it, ``data`` is all that is known.
    false_alarms : float, optional
        Probability of a false alarm in a month; by default that of the state, or 0.01.
    runs_per_month : int, optional
        Runs in a month; by default those of the state, or 60.
    restart : str, optional
        The run with which the baseline begins anew, or "now": with the next new run.
    seed : int, default 1
        Of ``delays``, which are simulated.
    threads : int, default 0
        Threads to use; 0 for all processors.

    Returns
    -------
    Watched
        ``change`` says what changed, and is ``None`` where nothing did.

    Raises
    ------
    ValueError
        If the data cannot be used, or the state is damaged, or of another robot, path or rate.

    Examples
    --------
    >>> import umbmark
    >>> good = umbmark.Model().add("wheel_noise", k_sqrt_m=0.0002)
    >>> runs = umbmark.simulate(good, runs=10, reference_rate_hz=0)
    >>> umbmark.watch(runs).changed
    False
    """
    document, text = _umbmark.watch(
        data_of(data),
        None if state is None else fspath(state),
        None if false_alarms is None else real("false_alarms", false_alarms),
        None if runs_per_month is None else integer("runs_per_month", runs_per_month),
        restart,
        seed_of(seed),
        threads,
    )
    return Watched._of(document, text=text)
