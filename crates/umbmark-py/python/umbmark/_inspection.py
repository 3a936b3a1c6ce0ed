"""What a dataset holds, whether it is any good, and what it can determine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from umbmark import _documents, _umbmark
from umbmark._result import Printed, Row
from umbmark._scores import Data, data_of, places_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Inspection(_documents.Inspection, Printed, frozen=True):
    """The findings on a dataset."""

    text: str

    def table(self) -> list[Row]:
        """Give the checks, one dict a row."""
        return [
            {"check": check.name, "ok": check.ok, "found": check.found, "good": check.good}
            for check in self.checks
        ]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw how many runs there are of each test and direction, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.inspection(self, ax)


def inspect(data: Data) -> Inspection:
    """Look at a dataset: what it holds, whether it is any good, what it can determine.

    Parameters
    ----------
    data : Dataset or path-like
        The measurements.

    Raises
    ------
    ValueError
        If it cannot be read, or holds no runs.
    """
    place = ", ".join(places_of(data)) or "memory"
    document, text = _umbmark.inspect(data_of(data), place)
    return Inspection._of(document, text=text)
