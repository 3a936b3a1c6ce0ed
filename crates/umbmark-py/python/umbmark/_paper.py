"""The experiments of Borenstein and Feng (1995), beside their numbers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec import UNSET, UnsetType

from umbmark import _umbmark
from umbmark._monte_carlo import Bar, Progress
from umbmark._result import Interval, Record, Result, Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Pose = tuple[float, float, float]


class Place(Record, frozen=True):
    """A published number among those that were simulated."""

    published: float
    mean: float
    middle_95: Interval
    share_below_published: float
    inside: bool


class From(Record, frozen=True):
    """Where the numbers of a robot are from, a phrase each."""

    sources: tuple[str, ...]
    assumed: tuple[str, ...]


class RobotOfTableOne(Record, frozen=True, rename={"from_": "from"}):
    """A row of Table I, its name among presets, E_max,sys and sigma in m."""

    row: str
    robot: str
    e_max_sys_m: Place
    sigma_m: Place
    from_: From


class LinkError(Record, frozen=True):
    """A size of an error of the CLAPPER's link, from where it does nothing."""

    effect: str
    parameter: str
    size: float


class TableOne(Record, frozen=True):
    """Table I; and what would leave the CLAPPER's published E_max,sys, each alone."""

    trials: int
    rows: tuple[RobotOfTableOne, ...]
    clapper_would_take: tuple[LinkError, ...]


class RobotOfTableTwo(Record, frozen=True):
    """A column of Table II: the average orientation error, and the extremes of single runs."""

    robot: str
    preset: str
    printed_rad: float
    recomputed: Place
    heading_noise_rad: float
    runs_rad: Interval


class TableTwo(Record, frozen=True):
    """Table II; and what ten bumps turn the CLAPPER by, its correction on and off."""

    trials: int
    columns: tuple[RobotOfTableTwo, ...]
    clapper_corrected_rad: float
    clapper_uncorrected_rad: float


class BothWays(Record, frozen=True):
    """Return errors of one run each way: x, y in m and heading in rad."""

    what: str
    ccw: Pose
    cw: Pose


class Masking(Record, frozen=True):
    """Figs. 2 to 4: two errors that cancel in one direction and add up in the other."""

    e_d: float
    e_b: float
    rows: tuple[BothWays, ...]


class Cluster(Record, frozen=True):
    """Fig. 5: return positions of a direction, their centre and its distance from START, in m."""

    direction: str
    returns_m: tuple[Interval, ...]
    centre_m: Interval
    r_m: float


class BumpPlace(Record, frozen=True):
    """Fig. 6: where ten bumps lie on the first leg, and what a run returns with."""

    bumps: str
    return_position_m: float
    return_heading_rad: float


class Paper(Result, frozen=True, kw_only=True):
    """The paper's experiments; those that were not asked for are ``msgspec.UNSET``.

    Attributes
    ----------
    table_1 : TableOne
        E_max,sys and sigma of every robot, simulated.
    table_2 : TableTwo
        The extended test with ten bumps of 10 mm.
    figure_2 : Masking
        Two errors that cancel in one direction (Figs. 2 to 4).
    figure_5 : tuple of Cluster
        Return positions of one test.
    figure_6 : tuple of BumpPlace
        Where the bumps lie.
    figure_eight, rectangle : tuple of BothWays
        Section 3.1: what a figure-eight hides; section 4.5: the 7 x 4 m rectangle.
    """

    table_1: TableOne | UnsetType = UNSET
    table_2: TableTwo | UnsetType = UNSET
    figure_2: Masking | UnsetType = UNSET
    figure_5: tuple[Cluster, ...] | UnsetType = UNSET
    figure_6: tuple[BumpPlace, ...] | UnsetType = UNSET
    figure_eight: tuple[BothWays, ...] | UnsetType = UNSET
    rectangle: tuple[BothWays, ...] | UnsetType = UNSET
    seed: int
    version: str

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


def _row(experiment: str, what: str, quantity: str, place: Place) -> Row:
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
    seed: int = 1,
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
    with Bar(progress, 1000, "per mille") as bar:
        return Paper._of(_umbmark.paper([*experiments], n, seed, threads, bar.at))
