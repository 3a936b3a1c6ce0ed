"""The hidden cases: which causes, on which path, at which speeds."""

from dataclasses import dataclass, field

import numpy as np
from catalogue import OUTSIDE, TYPICAL, Sizes
from robot import SQUARE, Path, Robot
from schedule import Pace

SPEEDS = [Pace(speed_m_s=v) for v in (0.2, 0.3, 0.4, 0.6, 0.8)]
TURN_RATES = [Pace(turn_rate_rad_s=w) for w in (0.3, 0.5, 0.8, 1.1, 1.4)]
ACCELERATIONS = [Pace(speed_m_s=0.4, acceleration_m_s2=a) for a in (0.15, 0.3, 0.5, 0.8, 1.2)]
BOTH = [
    Pace(speed_m_s=v, turn_rate_rad_s=w)
    for v, w in ((0.2, 0.8), (0.4, 0.3), (0.3, 1.4), (0.8, 0.5), (0.6, 1.1))
]
FIGURE_EIGHT = Path("figure_eight", {"radius_m": 1.0})
CIRCLE = Path("circle", {"radius_m": 1.0, "turns": 2.0})
SPIN = Path("spin", {"turns": 5.0})
RECTANGLE = Path("rectangle", {"length_m": 7.0, "width_m": 4.0})
STRAIGHT = Path("straight", {"length_m": 10.0})
WAYPOINTS = Path(
    "waypoints", {"points_m": ((3.0, 0.0), (3.0, 2.0), (1.0, 3.0), (0.0, 1.0), (0.0, 0.0))}
)


@dataclass(frozen=True)
class Case:
    """Causes besides E_d, E_b, E_s and wheel noise, and how they are shown. Paces are taken in
    turn, run by run.
    """

    causes: dict[str, Sizes] = field(default_factory=dict)
    path: Path = SQUARE
    paces: list[Pace] = field(default_factory=lambda: [Pace()])
    robot: Robot = field(default_factory=Robot)


def sized(name: str, factor: float = 1.0) -> dict[str, Sizes]:
    """A cause at a multiple of its typical size; phases, directions, lengths, thresholds stay."""
    fixed = ("phase_rad", "direction_rad", "length_m", "threshold_m_s", "height_m", "time_s")
    ratio = ("e_d", "e_b", "e_s")
    sizes = {
        key: value if key in fixed else 1 + factor * (value - 1) if key in ratio else factor * value
        for key, value in TYPICAL[name].items()
    }
    return {name: sizes}


PACES = {
    **dict.fromkeys(("speed_slip", "speed_slip_left", "speed_slip_right", "encoder_skew"), SPEEDS),
    **dict.fromkeys(("missed_counts", "reference_delay"), SPEEDS),
    **dict.fromkeys(("turn_slip_rate", "turn_loss_at_ramps"), TURN_RATES),
    "acceleration_slip": ACCELERATIONS,
    "centripetal_load": SPEEDS,
    "encoder_sampling": SPEEDS,
}
"""Paces of the causes that one pace does not show."""

PATHS = {"centripetal_load": FIGURE_EIGHT, "encoder_sampling": CIRCLE}

ALONE = {
    name: Case(sized(name), PATHS.get(name, SQUARE), PACES.get(name, [Pace()]))
    for name in TYPICAL
    if name not in OUTSIDE
}

SIZES = {
    f"{name}_{word}": Case(sized(name, factor), paces=PACES.get(name, [Pace()]))
    for name in (
        "floor_slope",
        "caster_kick",
        "wheel_eccentricity_left",
        "direction_dependent_wheelbase",
        "backlash",
    )
    for word, factor in (("half", 0.5), ("double", 2.0))
}

PAIRS = {
    f"{first}_and_{second}": Case(sized(first) | sized(second), paces=paces)
    for first, second, paces in (
        ("floor_slope", "caster_kick", [Pace()]),
        ("wheel_eccentricity_left", "wheel_eccentricity_right", [Pace()]),
        ("direction_dependent_wheelbase", "diameter_drift", [Pace()]),
        ("crab", "floor_slope_yaw", [Pace()]),
        ("encoder_skew", "turn_slip_rate", BOTH),
        ("backlash", "wheel_eccentricity_right", [Pace()]),
        ("speed_slip_right", "floor_slope", SPEEDS),
    )
}

ABSENT = {
    "none": Case(),
    "none_at_speeds": Case(paces=BOTH),
    "none_on_figure_eight": Case(path=FIGURE_EIGHT),
    "none_on_circle": Case(path=CIRCLE),
    "none_on_rectangle": Case(path=RECTANGLE),
    "none_on_waypoints": Case(path=WAYPOINTS),
    "none_on_straight": Case(path=STRAIGHT),
    "none_on_spin": Case(path=SPIN),
    "none_with_nuisance": Case(
        sized("marker_offset")
        | sized("marker_yaw")
        | sized("reference_delay")
        | sized("start_pose")
    ),
}

UNLISTED = {name: Case(sized(name), paces=PACES.get(name, [Pace()])) for name in OUTSIDE}

RETURNS = {
    "floor_slope_x": Case({"floor_slope": {"drift_m_per_m": 3e-3, "direction_rad": 0.0}}),
    "direction_dependent_wheelbase_alone": Case(sized("direction_dependent_wheelbase")),
}

CASES: dict[str, Case] = ABSENT | ALONE | SIZES | PAIRS | UNLISTED | RETURNS

DRAWN = "drawn"
"""The case in which the seed draws causes, sizes, paces and path."""

ALIKE = (
    ("crab",),
    ("wheel_eccentricity_left", "wheel_eccentricity_right"),
    ("turn_slip_rate",),
    ("speed_slip", "speed_slip_left", "speed_slip_right"),
    ("acceleration_slip",),
    ("direction_dependent_wheelbase",),
    ("caster_kick", "backlash", "leg_kick"),
    ("floor_slope", "carpet_nap"),
    ("floor_slope_yaw",),
    ("diameter_drift",),
    ("encoder_skew",),
)
"""Causes that may be drawn; at most one of a group, whose members look alike in some drives. The
share that is missed above a threshold here is none that the catalogue has.
"""


def drawn(seed: int) -> Case:
    """One to three causes beside each other, each 0.7 to 3 times as large as usual."""
    rng = np.random.default_rng((seed, 2))
    groups = rng.permutation(len(ALIKE))[: rng.integers(1, 4)]
    causes: dict[str, Sizes] = {}
    for group in groups:
        causes |= sized(str(rng.choice(ALIKE[group])), float(np.exp(rng.uniform(-0.36, 1.1))))
    paces = [
        Pace(
            speed_m_s=float(rng.uniform(0.2, 0.8)),
            turn_rate_rad_s=float(rng.uniform(0.3, 1.4)),
            acceleration_m_s2=float(rng.uniform(0.2, 0.8)),
        )
        for _ in range(5)
    ]
    paths = (SQUARE, SQUARE, RECTANGLE, WAYPOINTS)
    return Case(causes, paths[rng.integers(len(paths))], paces)


def case_of(name: str, seed: int) -> Case:
    """A case by its name; the seed matters to the one that is drawn."""
    return drawn(seed) if name == DRAWN else CASES[name]
