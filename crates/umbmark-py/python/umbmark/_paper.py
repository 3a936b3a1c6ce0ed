"""The experiments of Borenstein and Feng (1995), beside their numbers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

from msgspec import UNSET

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed
from umbmark._progress import Bar, Progress
from umbmark._result import Printed, Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Pose = tuple[float, float, float]


class Paper(_documents.Paper, Printed, frozen=True):
    """The paper's experiments; those that were not requested are left out."""

    _of_row: ClassVar[tuple[str, ...]] = ("value", "low", "high", "published")

    text: str

    def table(self) -> list[Row]:
        """Give each number with what was published and where simulated tests lie, one a row."""
        rows: list[Row] = []
        if self.table_1 is not UNSET:
            for robot in self.table_1.rows:
                rows.append(_row("table_1", robot.row, "e_max_sys_m", robot.e_max_sys_m))
                rows.append(_row("table_1", robot.row, "sigma_m", robot.sigma_m))
        if self.table_2 is not UNSET:
            rows += [
                _row("table_2", column.robot, "nonsys_orientation_rad", column.recomputed)
                for column in self.table_2.columns
            ]
        masked = UNSET if self.figure_2 is UNSET else self.figure_2.rows
        both_ways = {
            "figure_2": masked,
            "figure_eight": self.figure_eight,
            "rectangle": self.rectangle,
        }
        for name, tried in both_ways.items():
            for one in () if tried is UNSET else tried:
                for way, (x, y, heading) in (("ccw", one.ccw), ("cw", one.cw)):
                    rows.append(_value(name, one.what, f"return_{way}_m", math.hypot(x, y)))
                    rows.append(_value(name, one.what, f"return_heading_{way}_rad", heading))
        for cluster in () if self.figure_5 is UNSET else self.figure_5:
            rows.append(_value("figure_5", cluster.direction, "r_m", cluster.r_m))
        for place in () if self.figure_6 is UNSET else self.figure_6:
            rows.append(
                _value("figure_6", place.bumps, "return_position_m", place.return_position_m)
            )
            rows.append(
                _value("figure_6", place.bumps, "return_heading_rad", place.return_heading_rad)
            )
        return rows

    def plot(self, ax: Axes | None = None, *, quantity: str | None = None) -> Axes:
        """Draw a quantity of the ``table``: what was found, and what was published of it."""
        from umbmark import _plots

        return _plots.paper(self, ax, quantity)


def _row(experiment: str, what: str, quantity: str, place: _documents.PublishedNumber) -> Row:
    low, high = place.middle_95
    return {
        "experiment": experiment,
        "what": what,
        "quantity": quantity,
        "value": place.mean,
        "low": low,
        "high": high,
        "published": place.published,
    }


def _value(experiment: str, what: str, quantity: str, value: float) -> Row:
    return {
        "experiment": experiment,
        "what": what,
        "quantity": quantity,
        "value": value,
        "low": None,
        "high": None,
        "published": None,
    }


def paper(
    *experiments: str,
    n: int = 2000,
    seed: Seed = 1,
    threads: int = 0,
    progress: Progress = None,
) -> Paper:
    """Repeat experiments of the paper, beside its numbers.

    Source: Borenstein and Feng (1995), "UMBmark: A Benchmark Test for Measuring Odometry Errors in
    Mobile Robots".

    Parameters
    ----------
    *experiments : str
        "table_1", "table_2", "figure_2" (with 3 and 4), "figure_5", "figure_6", "figure_eight",
        "rectangle"; all of them where none is named.
    n : int, default 2000
        Simulated tests of each robot, for the tables.
    seed, threads
        As of ``monte_carlo``.
    progress : bool or callable, optional
        As of ``learn``, for each experiment anew.

    Returns
    -------
    Paper

    Raises
    ------
    ValueError
        If there is no such experiment, or a number is out of range.

    Examples
    --------
    >>> import umbmark
    >>> found = umbmark.paper("figure_2").figure_2
    >>> both = found.rows[-1]
    >>> [f"{x:.2f} m, {y:.2f} m" for x, y, _ in (both.ccw, both.cw)]
    ['-0.00 m, 0.00 m', '-0.70 m, -1.02 m']
    """
    with Bar(progress, 1000, "steps") as bar:
        document, text = _umbmark.paper([*experiments], n, seed, threads, bar.at)
    return Paper._of(document, text=text)
