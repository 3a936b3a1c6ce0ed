"""Every number of one world: the robot, its drives, the log, the reference, and what is wrong.

A `Setting` is drawn from the seed (`draw.py`), changed by the world (`worlds.py`) and by
`--set key=value`, and written into truth.json. Lengths are in metres, angles in radians
(counter-clockwise positive), times in seconds.
"""

from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, fields, replace
from math import pi
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]
Pose: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class Robot:
    """A robot with two driven wheels: the nominal sizes, and by how much the true ones differ."""

    wheelbase_m: float = 0.3
    """Nominal."""
    wheel_diameter_m: float = 0.1
    """Nominal, of both wheels."""
    ticks_per_revolution: int = 2000
    e_d: float = 1.0
    """True right wheel diameter over true left one; the mean of both does not depend on it."""
    e_b: float = 1.0
    """True wheelbase over the nominal one."""
    e_s: float = 1.0
    """True mean wheel diameter over the nominal one."""
    motor_lag_s: float = 0.05
    """Time constant with which the wheels follow the commanded speed."""
    top_speed_m_s: float = 0.5
    top_turn_rad_s: float = 1.0
    acceleration_m_s2: float = 0.5
    turn_acceleration_rad_s2: float = 2.0
    wheel_noise_sqrt_m: float = 3e-4
    """Standard deviation of a wheel's travel after one metre [m/√m]."""
    heading_noise_rad_sqrt_m: float = 0.0
    """Standard deviation of the heading after one metre, besides what the wheels' noise does."""

    @property
    def nominal_radius_m(self) -> float:
        """Radius of both wheels in the robot's own odometry."""
        return self.wheel_diameter_m / 2

    @property
    def true_radii_m(self) -> tuple[float, float]:
        """Radii of the left and of the right wheel."""
        mean = self.nominal_radius_m * self.e_s
        return mean * 2 / (1 + self.e_d), mean * 2 * self.e_d / (1 + self.e_d)

    @property
    def true_wheelbase_m(self) -> float:
        """Distance of the wheels' contact points."""
        return self.wheelbase_m * self.e_b

    @property
    def tick_rad(self) -> float:
        """Angle of a wheel per tick."""
        return 2 * pi / self.ticks_per_revolution


@dataclass(frozen=True)
class Drive:
    """What is driven, how often, and who steers."""

    kind: str = "random_commands"
    """A name of `plans.PLANS`."""
    controller: str = "open"
    """`open`: wheel speeds only; `odometry`: the robot follows its plan by its own odometry;
    `truth`: by its true pose, which arrives late."""
    control_period_s: float = 0.02
    feedback_delay_s: float = 0.1
    runs: int = 6
    run_s: float = 60.0
    """Length of a run; a path that closes is driven as often as fits."""
    rest_s: float = 2.0
    """Rest at the beginning and at the end of each run."""
    pause_s: float = 0.0
    """Rest between two moves of a path."""
    cut_s: float = 0.0
    """This much of the beginning and of the end is not recorded."""
    pieces: int = 1
    """A run is cut into so many files."""
    speed_spread: float = 1.0
    """Squares: the speeds and turn rates of runs differ by up to this factor."""


@dataclass(frozen=True)
class Recording:
    """How rows are written."""

    tick_rate_hz: float = 50.0
    tick_jitter: float = 0.05
    """Readings are early or late by up to half of this share of the period; stamps say when."""
    stamp_noise_s: float = 0.0
    """Standard deviation of the time stamps of ticks and poses."""
    reference_rate_hz: float = 20.0
    layout: str = "same"
    """`same`: a pose is measured with the ticks of its row; `nearest`: it is put into the tick row
    nearest in time; `interleaved`: it has a row of its own with interpolated ticks."""
    start: str = "room"
    """`origin`: the reference begins at zero; `room`: each run begins anywhere in a room."""
    wrap: bool = True
    """Whether headings are kept within half a turn."""
    first_count: int = 0
    """Count of both wheels when a run begins."""


@dataclass(frozen=True)
class Reference:
    """What measures the poses, and how well."""

    position_noise_m: float = 1e-3
    heading_noise_rad: float = 1e-3
    noise: str = "gaussian"
    """`gaussian`, `t4`, `t2` (heavy tails) or `correlated` (low-pass)."""
    correlation_s: float = 0.5
    """Time constant of correlated noise."""
    delay_s: float = 0.0
    """Positive: the measured pose is older than its stamp; it shows where the robot was."""
    delay_scatter_s: float = 0.0
    """Standard deviation of the delay from run to run."""
    filter_s: float = 0.0
    """Time constant of a first-order low-pass filter of the poses."""
    clock_rate: float = 0.0
    """The delay grows by this many seconds each second of the run."""
    lever_forward_m: float = 0.0
    """How far ahead of the axle's centre the tracked point sits."""
    lever_left_m: float = 0.0
    yaw_rad: float = 0.0
    """How far the tracked heading is counter-clockwise of the robot's."""
    has_heading: bool = True
    blind_s: float = 0.0
    """No poses at the beginning of a run for so long."""
    gaps_a_minute: float = 0.0
    gap_s: tuple[float, float] = (0.5, 5.0)
    """Shortest and longest gap."""
    at_stops_only: bool = False


@dataclass(frozen=True)
class Faults:
    """What is wrong with columns, frames, units and single poses."""

    exchanged: bool = False
    left_reversed: bool = False
    right_reversed: bool = False
    left_extra_edges: int = 0
    """Edges that the left counter counts beside each one of the right counter."""
    heading_clockwise: bool = False
    """The heading has the wrong sign; x and y are right."""
    mirrored: bool = False
    """y and the heading have the wrong sign: a left-handed frame."""
    compass: bool = False
    """The heading is a bearing: from y, clockwise."""
    mm_as_m: bool = False
    deg_as_rad: bool = False
    jumps: int = 0
    """Largest number of jumps in a run; they persist."""
    jumping_share: float = 1.0
    """Share of runs that have jumps."""
    jump_of: str = "robot"
    """`robot`: it was pushed; `reference`: its frame moved; `wheel`: one spun on the spot."""
    jump_lasts_s: tuple[float, float] = (0.0, 0.0)
    """How long a push lasts, or a wheel spins."""
    jump_m: tuple[float, float] = (0.1, 1.0)
    jump_rad: tuple[float, float] = (3 * pi / 180, 60 * pi / 180)
    glitch_share: float = 0.0
    """Share of poses that are bad."""
    glitch_burst: int = 1
    """Longest series of bad poses."""
    glitch_m: tuple[float, float] = (0.05, 3.0)
    glitch_rad: float = pi
    scan_outliers: float = 0.0
    """Share of relative motions that are wrong, of a reference that adds them up; 0: absolute."""
    scan_noise_m: float = 0.0
    scan_noise_rad: float = 0.0
    slam_period_s: float = 0.0
    """A reference that drifts is corrected every so often; 0: it does not drift."""
    slam_m: tuple[float, float] = (0.05, 0.3)
    heading_walk_rad_sqrt_s: float = 0.0
    """Measured headings drift, and positions do not: a random walk that begins anew in each run."""
    stretch_along: float = 0.0
    """Positions are longer by this share along x, and shorter along y."""
    stretch_diagonal: float = 0.0
    """The same along the diagonal between x and y, and across it."""
    filled_in_poses: int = 0
    """One of so many poses is measured, and the others lie on lines between those; 0: all are."""
    counts_commands: bool = False
    """Ticks are made from commanded speeds, not from the wheels' motion."""

    COLUMNS = ("exchanged", "left_reversed", "right_reversed", "left_extra_edges")
    FRAMES = ("heading_clockwise", "mirrored", "compass")
    UNITS = ("mm_as_m", "deg_as_rad")


@dataclass(frozen=True)
class Laws:
    """Physical laws besides wheels and wheelbase."""

    slope_cosine_rad_m: float = 0.0
    slope_sine_rad_m: float = 0.0
    """Each metre, ahead or back, turns the robot by cosine·cos(heading) + sine·sin(heading)."""
    slip_s_m: float = 0.0
    """Each wheel loses this share of its travel per m/s of its speed."""
    body_slip_s_m: float = 0.0
    """Both wheels lose this share of their travel per m/s of the speed between them."""
    forward_slip_s_m: float = 0.0
    """The way between them loses this share per m/s of its speed; no turn does."""
    squared_slip_s2_m2: float = 0.0
    """Each wheel loses this share of its travel at 1 m/s, and by the square of its speed."""
    squared_forward_slip_s2_m2: float = 0.0
    """The way between them loses this share at 1 m/s, by the square of its speed; no turn does."""
    eccentricity_left_m: float = 0.0
    eccentricity_right_m: float = 0.0
    """The radius of a wheel changes by this as it turns."""
    eccentricity_phase_rad: float = 0.0
    wave_rad_s: float = 0.0
    """While the robot moves it turns at this rate times a sine of the time."""
    wave_period_s: float = 20.0
    scrub_s_rad: float = 0.0
    """A turn on the spot loses this share per rad/s of its rate; an arc loses less."""
    law_kind: str = ""
    """A law that no catalogue lists: a name of `laws.SHAPES`."""
    law_acts_on: str = "yaw"
    """`yaw` (counter-clockwise), `forward` or `sideways` (to the left)."""
    law_per: str = "metre"
    """`metre` driven, `second` in motion, or `radian` turned."""
    law_size: float = 0.0
    """What a shape of one adds for each metre, second or radian [m or rad]."""
    law_scale: float = 0.0
    """Period, decay or radius [s or m], threshold [m/s, rad/s or m/s²] or width [rad]."""
    law_phase_rad: float = 0.0
    law_order: int = 1
    """Harmonic of the heading, or power of the time."""
    law_wheel: str = "left"
    """The wheel whose angle counts, `left` or `right`."""
    law_x_m: float = 0.0
    """Of a place in the room, or of a wall."""
    law_y_m: float = 0.0


@dataclass(frozen=True)
class Setting:
    """All of it."""

    robot: Robot = field(default_factory=Robot)
    drive: Drive = field(default_factory=Drive)
    recording: Recording = field(default_factory=Recording)
    reference: Reference = field(default_factory=Reference)
    faults: Faults = field(default_factory=Faults)
    laws: Laws = field(default_factory=Laws)

    def with_(self, **changes: Any) -> "Setting":
        """The same with some numbers changed, each by the name of its field."""
        changed = self
        for key, value in changes.items():
            part = part_of(key)
            changed = replace(changed, **{part: replace(getattr(changed, part), **{key: value})})
        return changed

    def overridden(self, words: Iterable[str]) -> "Setting":
        """The same with the `key=value` words of the command line applied."""
        changed = self
        for word in words:
            key, equals, text = word.partition("=")
            if not equals:
                raise ValueError(f"--set takes key=value, got {word!r}")
            now = getattr(getattr(self, part_of(key)), key)
            changed = changed.with_(**{key: parsed(key, text, now)})
        return changed

    def numbers(self) -> dict[str, dict[str, Any]]:
        """Everything that was put in, by part and name."""
        return asdict(self)

    def faults_present(self) -> list[str]:
        """Names of the faults of columns, frames and units that this world has."""
        names = Faults.COLUMNS + Faults.FRAMES + Faults.UNITS
        return [name for name in names if getattr(self.faults, name)]


def part_of(key: str) -> str:
    """The part of a setting that has this number."""
    for part in fields(Setting):
        if key in {one.name for one in fields(getattr(Setting(), part.name))}:
            return part.name
    raise ValueError(f"there is no {key!r} to set; truth.json lists what there is")


def parsed(key: str, text: str, now: object) -> object:
    """The value that a text means, of the type that the number has now."""
    if isinstance(now, bool):
        if text not in ("true", "false"):
            raise ValueError(f"{key} is true or false, got {text!r}")
        return text == "true"
    if isinstance(now, tuple):
        return tuple(float(one) for one in text.split(","))
    return type(now)(text)  # type: ignore[call-arg]
