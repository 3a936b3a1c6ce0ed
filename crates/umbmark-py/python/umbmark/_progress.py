"""How far long work is: as tqdm shows it, as a function is told it, and in the log."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from typing import TypeAlias

from umbmark._errors import needs

Progress: TypeAlias = bool | Callable[[int, int], object] | None

log = logging.getLogger("umbmark.progress")

# Between two lines of the log.
LOG_SECONDS = 10.0


class Bar:
    """Progress as tqdm shows it, or as a function is told it.

    The logger "umbmark.progress" has a line every ten seconds and one at the end, at level INFO.
    """

    def __init__(self, progress: Progress, total: int, unit: str) -> None:
        """Begin with nothing done."""
        if not (progress is None or isinstance(progress, bool) or callable(progress)):
            raise TypeError(
                "progress must be True, False or a function of the steps done and of all,"
                f" got {progress!r} ({type(progress).__name__})"
            )
        self._total = total
        self._unit = unit
        self._done = 0
        self._began = self._logged = time.monotonic()
        self._told = progress if callable(progress) else None
        self._bar = None
        if progress is True:
            with needs("progress"):
                from tqdm.auto import tqdm

            self._bar = tqdm(total=total, unit=f" {unit}", delay=1)

    def at(self, done: int) -> None:
        """Tell how many steps are done."""
        self._done = done
        now = time.monotonic()
        if now - self._logged >= LOG_SECONDS:
            self._logged = now
            self._log(now)
        if self._bar is not None:
            self._bar.update(done - self._bar.n)
        if self._told is not None:
            self._told(done, self._total)

    def __enter__(self) -> Bar:
        """Begin."""
        return self

    def __exit__(self, *_: object) -> None:
        """End, whatever happened."""
        self._log(time.monotonic())
        if self._bar is not None:
            self._bar.close()

    def _log(self, now: float) -> None:
        seconds = now - self._began
        log.info("%d of %d %s in %.1f s", self._done, self._total, self._unit, seconds)
