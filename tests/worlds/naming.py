"""Whether an answer names the law that no catalogue lists: rightly, by its class, or not."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import hypot, isclose, pi
from typing import Any, TypeAlias

import numpy as np
import words
from formula import Formula, effects_in, read
from laws import SHAPES, Situation
from setting import Laws, Pose, Setting

Json: TypeAlias = dict[str, Any]
NAMES = ("no", "class", "right")
"""From worst to best."""
PERIOD = 0.05
"""A period may be off by this share."""
THRESHOLD = 0.3
PLACE_M = 0.5
ALIKE_IN_ROOM = {"right": 0.97, "class": 0.5}
"""Least square of the correlation of two functions of the place, over the room that was driven."""
FACTOR = 2.0
"""Decays and knees may be off by this factor."""


@dataclass(frozen=True)
class Said:
    """A law that was named."""

    motion: str
    """`forward`, `sideways`, `yaw`, or `wheel`, which is forward and yaw."""
    per: str
    """`metre`, `second` or `radian`."""
    formula: Formula

    @property
    def driven(self) -> float:
        """Power of the speed that being in proportion to the way adds."""
        return float(self.per == "metre")

    @property
    def turned(self) -> float:
        """The same of the turn rate."""
        return float(self.per == "radian")


MOTIONS = (
    ("heading", "yaw"),
    ("yaw", "yaw"),
    ("turn", "yaw"),
    ("forward", "forward"),
    ("sideways", "sideways"),
    ("left_wheel", "wheel"),
    ("right_wheel", "wheel"),
)
"""How what a law acts on begins, and the motion that it means."""


def said_of(acts_on: str, per: str, formula: Formula | None) -> Iterator[Said]:
    """A law with a formula; what it acts on says the motion, and what it is in proportion to."""
    motion = next((motion for begin, motion in MOTIONS if acts_on.startswith(begin)), None)
    if formula is None or motion is None:
        return
    # A share of the turn is an amount for each radian, as one of the motion ahead is for a metre.
    own = "radian" if acts_on == "turn_scale" else "metre"
    named = [one for one in ("metre", "second", "radian") if one in (per or acts_on)]
    yield Said(motion, named[0] if named else own, formula)


def of_effect(effect: Json, origin: Pose) -> Iterator[Said]:
    """An effect of a model that is a formula."""
    if effect.get("formula"):
        formula = read(effect["formula"], numbers_of(effect), origin)
        yield from said_of(effect.get("acts_on", ""), "", formula)


def numbers_of(effect: Json) -> dict[str, float]:
    """Parameters of a formula."""
    numbers = effect.get("parameters")
    if not isinstance(numbers, dict):
        return {}
    return {key: float(value) for key, value in numbers.items() if isinstance(value, int | float)}


def in_repeats(learn: Json, origin: Pose) -> Iterator[Said]:
    """What repeats, where the answer says that something does."""
    repeats = learn.get("repeats")
    if not repeats or learn.get("verdict") == words.EXPLAINED:
        return
    if repeats.get("toml"):
        for effect in effects_in(repeats["toml"]):
            yield from of_effect(effect, origin)
    else:
        text = in_words(repeats["by"])
        sense = "direction * " if repeats.get("with_sense") else ""
        formula = read(sense + text, {}, origin) if text else None
        yield from said_of(repeats["motion"], repeats["per"], formula)


def in_words(by: str) -> str | None:
    """The formula that a few words mean."""
    for pattern, text in words.LAWS_IN_WORDS:
        if found := re.fullmatch(pattern, by):
            return text.format(*(group or "1" for group in found.groups()))
    return None


def in_step(step: Json, learn: Json, origin: Pose) -> Iterator[Said]:
    """The law of a step, with the values that its parameters have at last."""
    law = step.get("law") or {}
    effects = (learn.get("model") or {}).get("effect") or []
    numbers = numbers_of(law)
    for effect in effects:
        numbers |= numbers_of(effect) if effect.get("name") == step["added"] else {}
    yield from of_effect({**law, "parameters": numbers}, origin)


def suggested(learn: Json, origin: Pose) -> Iterator[Said]:
    """The formula for a curve."""
    suggestion = (learn.get("unlisted") or {}).get("suggestion") or {}
    for effect in suggestion.get("effect") or []:
        yield from of_effect(effect, origin)


Check: TypeAlias = Callable[[Said, Setting], bool]
"""Whether the shape of a law and its numbers are right; the motion and the variables are."""


def near(values: list[float], true: float, share: float) -> bool:
    """Whether one is within a share of the true one."""
    return any(abs(value - true) <= share * abs(true) for value in values)


def alike(values: list[float], true: float) -> bool:
    """Whether one is within a factor of the true one."""
    return any(true / FACTOR <= value <= true * FACTOR for value in values)


def periodic(variable: str) -> Check:
    """A wave with the right period."""
    return lambda said, setting: near(
        [2 * pi / one for one in said.formula.frequencies(variable)],
        setting.laws.law_scale,
        PERIOD,
    )


def harmonic(said: Said, setting: Setting) -> bool:
    """The right multiple of the heading."""
    order = setting.laws.law_order if setting.laws.law_kind == "heading_wave" else 1
    return near(said.formula.frequencies("heading"), order, PERIOD)


def decays(variable: str) -> Check:
    """Dies out with a variable, as fast as the law."""
    return lambda said, setting: alike(
        [-1 / one for one in said.formula.slopes_in(variable, "exp")], setting.laws.law_scale
    )


def power_of(formula: Formula, variable: str) -> float:
    """Of a variable that need not be in the formula."""
    return formula.degree(variable) if variable in formula.variables else 0.0


def powers(speed: float, turn_rate: float) -> Check:
    """The right powers of speed and turn rate in what is added each second."""

    def check(said: Said, _: Setting) -> bool:
        found = power_of(said.formula, "speed") + said.driven
        turning = power_of(said.formula, "turn_rate") + said.turned
        return isclose(found, speed, abs_tol=0.05) and isclose(turning, turn_rate, abs_tol=0.05)

    return check


def degree(variable: str, power: Callable[[Laws], int]) -> Check:
    """The right power of a variable."""
    return lambda said, setting: isclose(
        said.formula.degree(variable), power(setting.laws), abs_tol=0.05
    )


def above(variable: str, sign: int = 1) -> Check:
    """A step at the right value."""
    return lambda said, setting: near(
        said.formula.thresholds(variable), sign * setting.laws.law_scale, THRESHOLD
    )


def above_either_way(said: Said, setting: Setting) -> bool:
    """A step at the right turn rate, the same for both senses."""
    return above("turn_rate")(said, setting) and said.formula.is_even("turn_rate")


def saturates(said: Said, setting: Setting) -> bool:
    """tanh of the speed, with its knee at about the right speed."""
    knees = [1 / abs(one) for one in said.formula.slopes_in("speed", "tanh")]
    return alike(knees, setting.laws.law_scale)


def near_place(said: Said, setting: Setting) -> bool:
    """The right place on the floor."""
    x, y = said.formula.place()
    return hypot(x - setting.laws.law_x_m, y - setting.laws.law_y_m) <= PLACE_M


def in_room(said: Said, truth: Json, setting: Setting) -> str:
    """How well a function of the place agrees with the law, over the room that was driven."""
    x_low, x_high, y_low, y_high = truth["law"]["room_m"]
    x = np.repeat(np.linspace(x_low, x_high, 21), 21)
    y = np.tile(np.linspace(y_low, y_high, 21), 21)
    zero = np.zeros_like(x)
    at = Situation(zero, zero, zero, x, y, zero, zero, zero, np.stack([zero, zero]), zero)
    true = SHAPES[setting.laws.law_kind](setting.laws, at)
    values = [said.formula.at(x=a, y=b) for a, b in zip(x.tolist(), y.tolist(), strict=True)]
    if np.ptp(values) == 0 or not np.isfinite(values).all():
        return "no"
    square = np.corrcoef(true, values)[0, 1] ** 2
    return next((name for name, least in ALIKE_IN_ROOM.items() if square >= least), "no")


def pulses(said: Said, setting: Setting) -> bool:
    """A bump or a step, of the right wheel; a smooth wave of its angle is no pulse."""
    wheel = f"wheel_angle_{setting.laws.law_wheel}"
    is_bump = bool(said.formula.calls("exp", "sign", "max", "tanh"))
    return is_bump and said.formula.variables == {wheel}


@dataclass(frozen=True)
class Named:
    """How a law has to be named."""

    variables: frozenset[str]
    """What it depends on."""
    shape: Check


def named(variables: str, shape: Check) -> Named:
    """Variables in a line."""
    return Named(frozenset(variables.split()), shape)


RIGHT: dict[str, Named] = {
    "time_wave": named("time", periodic("time")),
    "way_wave": named("distance", periodic("distance")),
    "heading_wave": named("heading", harmonic),
    "speed_squared": named("speed", powers(3, 0)),
    "speed_above": named("speed", above("speed")),
    "speed_tanh": named("speed", saturates),
    "speed_times_turn_rate": named("speed turn_rate", powers(1, 1)),
    "speed_times_heading": named("speed heading", harmonic),
    "turn_rate_above": named("turn_rate", above_either_way),
    "turn_rate_squared": named("turn_rate", powers(0, 2)),
    "braking": named("acceleration", above("acceleration", -1)),
    "fading": named("time", decays("time")),
    "growing": named("time", degree("time", lambda laws: laws.law_order)),
    "wheel_pulse": named("wheel_angle_left wheel_angle_right", pulses),
}
"""How each law of `laws.SHAPES` is named that does not depend on the place."""
OF_PLACE = {"disc", "place_x", "place_y_squared", "wall"}
SAME_BY_POWERS = {"speed_times_turn_rate", "turn_rate_squared", "speed_squared"}
"""Laws that read otherwise for each metre, second and radian, and are the same."""


def worth(said: Said, truth: Json, setting: Setting) -> str:
    """How well a law that was named is the one that was put in."""
    laws = setting.laws
    if said.motion != laws.law_acts_on and (said.motion, laws.law_acts_on) != ("wheel", "yaw"):
        return "no"
    used = said.formula.variables - {"direction"}
    by_sense = "direction" in said.formula.variables or turns_in_reverse(said, setting)
    if laws.law_kind in OF_PLACE:
        own = of_place(said, truth, setting) if used and used <= {"x", "y"} else "no"
        same_per = said.per == laws.law_per
    else:
        own = of_motion(said, used, setting)
        same_per = laws.law_kind in SAME_BY_POWERS or said.per == laws.law_per
    return "class" if own == "right" and (by_sense or not same_per) else own


def turns_in_reverse(said: Said, setting: Setting) -> bool:
    """Whether a formula gives way where a robot that drives back loses it."""
    ahead, back = said.formula.at(speed=1.0), said.formula.at(speed=-1.0)
    reverses = setting.drive.kind in words.REVERSING
    return said.motion == "forward" and said.per == "metre" and reverses and ahead != back


def of_place(said: Said, truth: Json, setting: Setting) -> str:
    """The same of a law of the place, and a formula of nothing else."""
    if setting.laws.law_kind == "disc":
        return "right" if near_place(said, setting) else "no"
    return in_room(said, truth, setting)


def of_motion(said: Said, used: set[str], setting: Setting) -> str:
    """The same of a law that does not depend on the place."""
    kind = setting.laws.law_kind
    wanted = RIGHT[kind]
    if kind == "wheel_pulse":
        has_all = (bool(used) and used <= wanted.variables) or once_a_turn(said, setting)
    elif kind in SAME_BY_POWERS:
        implied = {"metre": {"speed"}, "radian": {"turn_rate"}}.get(said.per, set())
        has_all = wanted.variables <= used | implied and used <= wanted.variables
    else:
        has_all = used == wanted.variables
    if not has_all:
        return "no"
    return "right" if wanted.shape(said, setting) else "class"


def once_a_turn(said: Said, setting: Setting) -> bool:
    """Whether it is a wave of the way, a whole number of times a turn of the wheel."""
    if said.formula.variables != {"distance"}:
        return False
    turn_m = 2 * pi * setting.robot.true_radii_m[setting.laws.law_wheel == "right"]
    periods = [2 * pi / one for one in said.formula.frequencies("distance")]
    return any(near(periods, turn_m / times, PERIOD / times) for times in range(1, 5))


def same_effects(setting: Setting) -> set[str]:
    """Effects of the catalogue that are the law itself."""
    laws = setting.laws
    same = set(words.SAME_AS_LAW.get((laws.law_kind, laws.law_acts_on), set()))
    squares = setting.drive.kind == "squares" and setting.recording.start == "origin"
    third = laws.law_kind == "heading_wave" and laws.law_order == 3
    if third and squares and laws.law_acts_on == "yaw":
        same |= words.FIRST_HARMONIC
    return same


def of_step(step: Json, learn: Json, truth: Json, setting: Setting, origin: Pose) -> str:
    """How well a step of `learn` names the law."""
    effects = {step["added"]} | set(step.get("class") or [])
    own = "class" if effects & same_effects(setting) else "no"
    said = [worth(one, truth, setting) for one in in_step(step, learn, origin)]
    return best([own, *said])


def best(names: list[str]) -> str:
    """The best of some names."""
    return max(names, key=NAMES.index, default="no")


def origin_of(answers: Json, truth: Json) -> Pose:
    """Where the command has its origin in the room: at START of the first log that it lists."""
    inspect = (answers.get("inspect") or {}).get("answer") or {}
    if truth["numbers"]["recording"]["start"] == "origin":
        return (0.0, 0.0, 0.0)
    first = inspect.get("first_log") or next(iter(truth["logs"]))
    x, y, heading = truth["logs"][first]["start_in_room"]
    return x, y, heading


def named_law(answers: Json, truth: Json, setting: Setting) -> Json:
    """How well the law is named by steps and by what repeats, and by the formula for a curve."""
    learn = answers["learn"]["answer"] or {}
    origin = origin_of(answers, truth)
    steps = [of_step(one, learn, truth, setting, origin) for one in learn.get("steps") or []]
    repeats = [worth(one, truth, setting) for one in in_repeats(learn, origin)]
    return {
        "law_right": best(steps + repeats),
        "law_in_steps": steps,
        "law_repeats": best(repeats),
        "law_suggested": best([worth(one, truth, setting) for one in suggested(learn, origin)]),
    }
