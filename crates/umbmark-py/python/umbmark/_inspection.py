"""What a dataset holds, whether it is any good, and what it can determine."""

from __future__ import annotations

from os import fspath
from typing import TYPE_CHECKING

from umbmark import _umbmark
from umbmark._result import Record, Result, Row
from umbmark._scores import Data, data_of
from umbmark._setup import Measured, Setup
from umbmark._umbmark import Dataset

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class RobotFacts(Record, frozen=True):
    """A nominal robot."""

    name: str
    wheelbase_m: float
    wheel_diameter_left_m: float
    wheel_diameter_right_m: float
    ticks_per_revolution: float
    encoder_rate_hz: float | None
    counter_bits: int | None


class PathFacts(Record, frozen=True):
    """A path: its shape, sizes and length in m."""

    shape: str
    sizes: dict[str, float | tuple[tuple[float, ...], ...]]
    length_m: float


class Group(Record, frozen=True):
    """Numbers of runs of one test and direction, and of what they have."""

    test: str
    direction: str | None
    runs: int
    returns: int
    headings: int
    logs: int


class WheelFacts(Record, frozen=True):
    """Whether the wheels are what they are called, by the motion of the poses."""

    as_named: bool
    exchanged: bool
    left_backward: bool
    right_backward: bool


class Moves(Record, frozen=True):
    """What was driven, by the ticks."""

    shape: str | None
    described: str
    legs: int
    turns: int
    arcs: int
    stops: int


class Clock(Record, frozen=True):
    """How the clock and the body of a run's track lie against those of the ticks."""

    run: str
    track: str
    offset_s: Measured
    rate: Measured
    lever_ahead_m: Measured | None
    lever_left_m: Measured | None
    yaw_rad: Measured | None
    misfit_m: float
    windows: int
    left_out: int


class ReferenceFacts(Record, frozen=True):
    """The absolute poses of a log."""

    poses: int
    headings: int
    rate_hz: float
    coverage: str
    longest_gap_s: float
    noise_m: float | None
    heading_noise_rad: float | None


class Mended(Record, frozen=True):
    """What was mended in a log while it was read, counted."""

    roll_overs: int
    resets: int
    rows_out_of_order: int
    rows_repeated: int
    stale_poses: int


class LogFacts(Record, frozen=True):
    """A log: its rows, times in s, and what its ticks and poses say.

    ``delay_s`` is how much older than its stamp a pose is in the middle of the run; None where the
    motion does not show it.
    """

    name: str
    direction: str | None
    rows: int
    duration_s: float
    rate_hz: float
    jitter: float
    longest_gap_s: float
    gaps: int
    mended: Mended
    length_m: float | None
    heading_rad: float | None
    heading_off_rad: float | None
    wheels: WheelFacts | None
    moves: Moves | None
    delay_s: Measured | None
    reference: ReferenceFacts | None


class Topics(Record, frozen=True):
    """Where the log of a run was found in an MCAP file."""

    run: str
    wheels: str
    reference: str | None


class Check(Record, frozen=True):
    """A figure, and what good looks like."""

    name: str
    found: str
    good: str
    ok: bool


class Determined(Record, frozen=True):
    """Whether the data determines a quantity, and why.

    Attributes
    ----------
    quantity : str
        What is asked for.
    yes : bool
        Whether the data determines it.
    std_error : float or None
        Standard error that this data promises with noise of the usual size, as a share of one;
        None where the data does not show the quantity, or it is no value of the robot.
    usual_size : float or None
        Usual size of the error in robots, as a share of one; None where it is no value of the
        robot.
    because : str
        Why, or what would help.
    """

    quantity: str
    yes: bool
    std_error: float | None
    usual_size: float | None
    because: str


class Inspection(Result, frozen=True):
    """The findings on a dataset.

    Attributes
    ----------
    checks : tuple of Check
        Figures with what good looks like: is it any good?
    determined : tuple of Determined
        What it can say of the robot.
    groups, logs
        The runs, and each log.
    clocks, topics
        Clocks that were set, and topics that were read.
    setup : Setup or None
        What was found of the runs from their motion and return errors; None without a robot.
    """

    data: str
    robot: RobotFacts | None
    path: PathFacts | None
    groups: tuple[Group, ...]
    logs: tuple[LogFacts, ...]
    clocks: tuple[Clock, ...]
    topics: tuple[Topics, ...]
    checks: tuple[Check, ...]
    determined: tuple[Determined, ...]
    rank: int
    setup: Setup | None
    warnings: tuple[str, ...]
    version: str

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
    place = "memory" if isinstance(data, Dataset) else fspath(data)
    return Inspection._of(_umbmark.inspect(data_of(data), place))
