"""Which words of the command name which trouble. Edit this table when its sentences change."""

import re

FAULTS: dict[str, str] = {
    # Exchanged wheels and a mirrored frame show the same: turns to the other side.
    "exchanged": r"exchang|swapp|mirror|left-handed",
    "mirrored": r"exchang|swapp|mirror|left-handed",
    "left_reversed": r"left[^.]{0,60}(backward|revers|down)|left_backward\W+true",
    "right_reversed": r"right[^.]{0,60}(backward|revers|down)|right_backward\W+true",
    "left_extra_edges": r"ticks_left has [\d.]+ times",
    "both_reversed": r"both[^.]{0,60}(backward|revers|down)|(wheels|counters)[^.]{0,40}backward",
    # Exchanged and both reversed: the robot drives tail first, as a heading turned by half a turn.
    "exchanged_reversed": r"exchang|swapp|backward|tail|18\d(\.\d+)? deg|half a turn|marker_yaw",
    "heading_clockwise": r"clockwise|heading[^.]{0,60}(sign|revers|negat)",
    "compass": r"compass|bearing|clockwise",
    "mm_as_m": r"millimet|in mm\b|mm (for|as|under)|(1000|thousand) times",
    "deg_as_rad": r"in degrees|degrees (for|as|under)|57\.\d* times",
}
"""Regular expressions, in lower case, by fault."""

EVENT = re.compile(r"\b(\w+_\d+)\b[^.;:]{0,60}?\bat (\d+(?:\.\d+)?) s\b")
"""A sentence that names a moment of a run."""
TIME_KEYS = ("time_s", "at_s", "t_s", "from_s")
"""Keys of JSON objects that, beside `run`, name a moment."""
LEFT_UNREAD = ("next_experiments", "model", "fitted")
"""Keys of what `learn` prints in which a word names nothing that was found."""

ALWAYS = {"wheel_diameter_ratio", "wheelbase", "scale"}
"""Steps of every model."""
NUISANCES: dict[str, set[str]] = {
    "delay_s": {"reference_delay"},
    "filter_s": {"reference_filter", "reference_delay"},
    "clock_rate": {"reference_clock_rate", "reference_delay"},
    "lever_forward_m": {"marker_offset"},
    "yaw_rad": {"marker_yaw", "crab"},
    "counts_commands": {"wheel_lag", "reference_delay"},
    "stretch_along": {"reference_stretch"},
    "stretch_diagonal": {"reference_stretch"},
}
"""Effects that are right to add where the number is not zero."""
LAWS: dict[str, tuple[set[str], str]] = {
    "slope_cosine_rad_m": ({"floor_slope_yaw"}, "heading"),
    "slip_s_m": ({"speed_slip", "speed_slip_left", "speed_slip_right"}, "speed"),
    "body_slip_s_m": ({"body_speed_slip"}, "speed"),
    "forward_slip_s_m": ({"forward_slip"}, "speed"),
    "squared_slip_s2_m2": ({"squared_speed_slip"}, "speed"),
    "squared_forward_slip_s2_m2": ({"squared_forward_slip"}, "speed"),
    "eccentricity_left_m": ({"wheel_eccentricity_left"}, "wheel_angle_left"),
    "eccentricity_right_m": ({"wheel_eccentricity_right"}, "wheel_angle_right"),
    "wave_rad_s": (set(), "time"),
    "scrub_s_rad": ({"turn_slip", "turn_slip_rate"}, "turn_rate"),
}
"""Effects, and the variable of a formula, that are right where the number is not zero."""
SAME_AS_LAW: dict[tuple[str, str], set[str]] = {
    ("turn_rate_squared", "yaw"): {"turn_slip_rate"},
    ("speed_squared", "forward"): {"squared_forward_slip"},
}
"""Effects of the catalogue that are a law of `laws.SHAPES` itself, in other words: they name it, by
the kind of the law and what it acts on.

`missed_counts` loses in proportion to the speed beyond a threshold, and no fixed share there;
`diameter_drift` grows with the way, and not with the time; `wheel_eccentricity` is a sine, and no
pulse; `speed_slip` is linear; `squared_speed_slip` acts on each wheel, and not on the way ahead;
`centripetal_load` acts on the wheels, and not sideways.
"""
FIRST_HARMONIC = {"floor_slope_yaw"}
"""Where all headings are multiples of a right angle, a third harmonic of it is a first one."""
REVERSING = {"random_commands", "joystick", "back_and_forth"}
"""Drives in which robots drive back, too."""
NUMBER = r"(-?[\d.]+)"
LAWS_IN_WORDS: list[tuple[str, str]] = [
    (rf"a wave of the time with a period of about {NUMBER} s", "sin(2 * pi * time / {0})"),
    (rf"a wave of the way with a period of about {NUMBER} m", "sin(2 * pi * distance / {0})"),
    (rf"what dies away within {NUMBER} s of the start", "exp(-time / {0})"),
    (r"the time in the run", "time"),
    (r"the square of the time in the run", "time^2"),
    (r"a wave of (?:(\d) times )?the heading", "sin({0} * heading)"),
    (
        r"a wave of (?:(\d) times )?the angle of the (left|right) wheel",
        "sin({0} * wheel_angle_{1})",
    ),
    (
        r"the speed times a wave of (?:(\d) times )?the heading",
        "abs(speed) * sin({0} * heading)",
    ),
    (r"x in the room", "x"),
    (r"y in the room", "y"),
    (r"the square of x in the room", "x^2"),
    (r"the square of y in the room", "y^2"),
    (r"x times y in the room", "x * y"),
    (rf"what dies away within {NUMBER} m of the least (x|y)", "exp(-{1} / {0})"),
    (rf"what dies away within {NUMBER} m of the greatest (x|y)", "exp({1} / {0})"),
    (
        rf"a place on the floor near \({NUMBER}, {NUMBER}\) m",
        "exp(-2 * ((x - ({0}))^2 + (y - ({1}))^2))",
    ),
]
"""What `repeats` says in words, and the same as a formula: laws that have none in its answer."""
EXPLAINED = "explained"
FREE_START = {"late_start", "moving_start", "long_pieces"}
"""Worlds where START was never seen at rest: `start_pose` is right there."""
UNSTEADY = {"scanmatch", "slam", "heading_walk", "stretched", "command", "sparse"}
"""Worlds whose reference or wheels do more than the model can say: any verdict is right."""


def named(fault: str, text: str) -> bool:
    """Whether a text, in lower case, names the fault."""
    return re.search(FAULTS[fault], text) is not None


def as_one(faults: list[str]) -> list[str]:
    """Faults of columns that together are one."""
    together = set(faults)
    if together >= {"exchanged", "left_reversed", "right_reversed"}:
        return ["exchanged_reversed"]
    return ["both_reversed"] if together >= {"left_reversed", "right_reversed"} else faults


def moments(answer: object) -> list[tuple[str, float]]:
    """Every moment of a run, (run, seconds), that an answer in JSON names."""
    if isinstance(answer, dict):
        own = [
            (str(answer["run"]), float(answer[key]))
            for key in TIME_KEYS
            if "run" in answer and isinstance(answer.get(key), int | float)
        ]
        return own + [one for value in answer.values() for one in moments(value)]
    if isinstance(answer, list):
        return [one for value in answer for one in moments(value)]
    if isinstance(answer, str):
        return [(run, float(at)) for run, at in EVENT.findall(answer)]
    return []
