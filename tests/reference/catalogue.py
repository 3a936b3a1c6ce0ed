"""Every cause by name: its typical size, what it may be mistaken for at which level of data, and
how it is set up.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import pi

import causes as law
import numpy as np
from motion import Cause
from robot import Array, Robot
from sensors import Reference

Sizes = dict[str, float]

TYPICAL: dict[str, Sizes] = {
    "wheel_diameter_ratio": {"e_d": 1.004},
    "wheelbase": {"e_b": 0.985},
    "scale": {"e_s": 1.004},
    "crab": {"angle_rad": 5.2e-3},
    "wheel_eccentricity_left": {"eccentricity_m": 3e-4, "phase_rad": 0.7},
    "wheel_eccentricity_right": {"eccentricity_m": 3e-4, "phase_rad": 2.1},
    "turn_slip": {"share": 8e-3},
    "turn_slip_rate": {"k_s_per_rad": 8e-3},
    "speed_slip": {"k_s_per_m": 15e-3},
    "speed_slip_left": {"k_s_per_m": 15e-3},
    "speed_slip_right": {"k_s_per_m": 15e-3},
    "acceleration_slip": {"c_s2_per_m": 20e-3},
    "direction_dependent_wheelbase": {"share": 4e-3},
    "caster_kick": {"angle_rad": 3.5e-3, "length_m": 0.10},
    "leg_kick": {"angle_rad": 3.5e-3, "length_m": 0.10},
    "backlash": {"play_m": 5e-4},
    "floor_slope": {"drift_m_per_m": 3e-3, "direction_rad": 0.6},
    "floor_slope_yaw": {"yaw_rad_per_m": 2e-3, "direction_rad": 0.6},
    "carpet_nap": {"drift_m_per_m": 3e-3, "direction_rad": -1.1},
    "diameter_drift": {"ratio_per_m": 7.5e-5},
    "centripetal_load": {"c_s2_per_m": 1e-3},
    "missed_counts": {"share": 2e-3, "threshold_m_s": 0.3},
    "bumps": {"rate_per_m": 0.1, "height_m": 0.010},
    "wheel_noise": {"k_sqrt_m": 1e-3},
    "encoder_skew": {"delay_s": 0.010},
    "encoder_resolution": {"ticks_per_revolution": 200},
    "encoder_sampling": {"period_s": 0.05},
    "reference_delay": {"delay_s": 0.03},
    "reference_clock_rate": {"rate": 5e-4},
    "marker_offset": {"forward_m": 0.006, "left_m": -0.004},
    "marker_yaw": {"angle_rad": 8.7e-3},
    "start_pose": {
        "x_m": 0.005,
        "y_m": -0.004,
        "heading_rad": 5e-3,
        "position_sd_m": 0.0,
        "heading_sd_rad": 0.0,
    },
    "turn_loss_at_ramps": {"share": 0.05},
    "second_harmonic_yaw": {"yaw_rad_per_m": 3e-3, "direction_rad": pi / 4},
    "warm_up_yaw": {"yaw_rad_per_m": 0.02, "time_s": 10.0},
    "room_scale": {"k_per_m": 2e-3},
    "slide_after_turn": {"slide_m_per_m": 0.03, "length_m": 0.15},
    "tyre_seam": {"share": 0.02, "phase_rad": 0.4},
}
"""Sizes of diagnosis.md, section 3; the last six are outside the catalogue."""


@dataclass(frozen=True)
class Outside:
    """What a cause outside the catalogue acts on, and what it depends on, in the words of
    model.toml.
    """

    acts_on: str
    depends_on: tuple[str, ...]


OUTSIDE: dict[str, Outside] = {
    "turn_loss_at_ramps": Outside("turn", ("acceleration", "turn_rate")),
    "second_harmonic_yaw": Outside("heading_per_metre", ("heading",)),
    "warm_up_yaw": Outside("heading_per_metre", ("time", "distance")),
    "room_scale": Outside("forward_scale", ("room_position",)),
    "slide_after_turn": Outside("sideways_per_metre", ("since_turn", "last_turn")),
    "tyre_seam": Outside("left_wheel_scale", ("wheel_angle_left",)),
}

BASE = ("wheel_diameter_ratio", "wheelbase", "scale")
NUISANCE = ("start_pose", "reference_delay", "reference_clock_rate", "marker_offset", "marker_yaw")
NOISE = ("wheel_noise", "bumps", "encoder_resolution")

LEVELS = ("ends", "stops", "tracks")

STRAIGHT_SLIPS = ("scale", "speed_slip", "speed_slip_left", "speed_slip_right")
COURSE = ("crab", "marker_yaw")
COURSE_AT_STOPS = (*COURSE, "encoder_skew", "leg_kick", "acceleration_slip")
WORLD_DRIFT = ("floor_slope", "carpet_nap")

CLASSES: dict[str, tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...]]] = {
    "wheel_diameter_ratio": (("direction_dependent_wheelbase", "leg_kick"), (), ()),
    "wheelbase": (
        ("scale", "turn_slip", "turn_slip_rate", "speed_slip"),
        ("turn_slip",),
        ("turn_slip",),
    ),
    "scale": (("wheelbase",), STRAIGHT_SLIPS, STRAIGHT_SLIPS),
    "crab": ((), COURSE_AT_STOPS, COURSE),
    "marker_yaw": ((), COURSE_AT_STOPS, COURSE),
    "turn_slip": ((), (), ("wheelbase",)),
    "speed_slip": ((), STRAIGHT_SLIPS, STRAIGHT_SLIPS),
    "speed_slip_left": ((), STRAIGHT_SLIPS, STRAIGHT_SLIPS),
    "speed_slip_right": (
        (),
        (*STRAIGHT_SLIPS, "missed_counts"),
        (*STRAIGHT_SLIPS, "missed_counts"),
    ),
    "missed_counts": ((), ("speed_slip_right",), ("speed_slip_right",)),
    "caster_kick": (("backlash", "floor_slope", "start_pose"), ("backlash",), ()),
    "backlash": (("caster_kick",), ("caster_kick",), ()),
    "leg_kick": ((), COURSE_AT_STOPS, ()),
    "encoder_skew": ((), COURSE_AT_STOPS, ()),
    "floor_slope": ((*WORLD_DRIFT, "start_pose", "bumps"), WORLD_DRIFT, WORLD_DRIFT),
    "carpet_nap": ((*WORLD_DRIFT, "start_pose", "bumps"), WORLD_DRIFT, WORLD_DRIFT),
    "start_pose": ((*WORLD_DRIFT, "bumps"), (), ()),
    "floor_slope_yaw": (("bumps", *WORLD_DRIFT, "start_pose"), (), ()),
    "bumps": (("wheel_noise",), ("wheel_noise", "scale"), ("wheel_noise",)),
    "wheel_noise": (("bumps",), ("bumps",), ("bumps",)),
}
"""Names that stand for the cause as well, at LEVELS, by diagnosis.md, section 4; the cause's own is
always one.
"""

SEEN_FROM: dict[str, str] = {
    **dict.fromkeys(("wheel_diameter_ratio", "wheelbase"), "ends"),
    **dict.fromkeys(
        ("floor_slope", "carpet_nap", "floor_slope_yaw", "wheel_noise", "bumps"), "ends"
    ),
    **dict.fromkeys(
        ("scale", "crab", "speed_slip", "speed_slip_left", "speed_slip_right"), "stops"
    ),
    **dict.fromkeys(("direction_dependent_wheelbase", "caster_kick", "leg_kick"), "stops"),
    **dict.fromkeys(
        ("encoder_skew", "diameter_drift", "marker_offset", "marker_yaw", "start_pose"), "stops"
    ),
    **dict.fromkeys(("missed_counts", "second_harmonic_yaw", "warm_up_yaw", "room_scale"), "stops"),
    **dict.fromkeys(("slide_after_turn", "turn_slip_rate"), "stops"),
    **dict.fromkeys(("turn_slip", "encoder_sampling", "encoder_resolution"), "never"),
}
"""The least that shows the cause beside E_d and E_b, at typical size: ends, stops, tracks (where
not listed), never.
"""


def acceptable(name: str, level: str) -> list[str]:
    """Names that are a right answer for a cause; none outside the catalogue."""
    if name in OUTSIDE:
        return []
    others = CLASSES[name][LEVELS.index(level)] if name in CLASSES else ()
    return [name, *(other for other in others if other != name)]


def kind(name: str) -> str:
    """Base and nuisance are always fitted; noise has no mean."""
    groups = {"base": BASE, "nuisance": NUISANCE, "noise": NOISE, "outside": tuple(OUTSIDE)}
    return next((group for group, names in groups.items() if name in names), "physics")


@dataclass
class Setup:
    """Runs side by side, as they are."""

    robot: Robot
    causes: list[Cause] = field(default_factory=list)
    reference: Reference = field(default_factory=Reference)
    start: Array = field(default_factory=lambda: np.zeros((3, 1)))
    right_delay_s: float = 0.0
    euler_readings: int = 0


def laws(robot: Robot, runs: int) -> dict[str, Callable[..., Cause]]:
    """The constructors of causes that need no random draws, by name; they take the sizes as
    keywords.
    """
    radius = robot.radius_m

    def eccentric(wheel: int) -> Callable[..., Cause]:
        return lambda **sizes: law.WheelEccentricity(**sizes, wheel=wheel)

    def slip(*which: int) -> Callable[..., Cause]:
        return lambda **sizes: law.SpeedSlip(radius, **sizes, which=which)

    return {
        "wheel_diameter_ratio": law.WheelDiameterRatio,
        "wheelbase": law.Wheelbase,
        "scale": law.Scale,
        "crab": law.Crab,
        "wheel_eccentricity_left": eccentric(0),
        "wheel_eccentricity_right": eccentric(1),
        "turn_slip": law.TurnSlip,
        "turn_slip_rate": law.TurnSlipRate,
        "speed_slip": slip(0, 1),
        "speed_slip_left": slip(0),
        "speed_slip_right": slip(1),
        "acceleration_slip": lambda **sizes: law.AccelerationSlip(radius, **sizes),
        "direction_dependent_wheelbase": law.DirectionDependentWheelbase,
        "caster_kick": law.CasterKick,
        "leg_kick": law.LegKick,
        "backlash": lambda **sizes: law.Backlash(runs, **sizes),
        "floor_slope": law.FloorDrift,
        "floor_slope_yaw": law.FloorSlopeYaw,
        "carpet_nap": law.FloorDrift,
        "diameter_drift": law.DiameterDrift,
        "centripetal_load": law.CentripetalLoad,
        "missed_counts": lambda **sizes: law.MissedCounts(radius, **sizes),
        "turn_loss_at_ramps": law.TurnLossAtRamps,
        "second_harmonic_yaw": law.SecondHarmonicYaw,
        "warm_up_yaw": law.WarmUpYaw,
        "room_scale": law.RoomScale,
        "slide_after_turn": law.SlideAfterTurn,
        "tyre_seam": law.TyreSeam,
    }
