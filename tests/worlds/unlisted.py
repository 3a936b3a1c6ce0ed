"""A law that no catalogue lists: drawn from a wide family, and so large that it shows.

Its size follows from the drive without it. What it adds to the positions, less what E_d, E_b, E_s
and START of each run can take up by least squares, is 2 to 8 times what the truth leaves where
there is noise alone. A law that would have to be larger than laws are is drawn anew.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import pi
from typing import Any, TypeAlias

import numpy as np
from draw import chance, log_uniform, pick, signed
from files import truth
from laws import SHAPES
from plans import Random
from record import Log, Made, driven, stream
from replay import driving, left_in, replayed, rms_m
from setting import Array, Laws, Setting

SHOWS = (2.0, 8.0)
"""Least and largest quotient of what a law adds and what noise leaves."""
STEP_S = 0.02
"""Poses that laws are held against are so far apart."""
TRIES = 4
"""So often a law of one kind is drawn before another kind is."""
ROUNDS = 4
"""A size is corrected so often for what a law does that is not in proportion to it."""
IN_ONE_RUN = 0.75
"""What shows in one run is this share of all that shows, at most: a law repeats."""
BLURS = 1.25
"""A replay of the ticks with a law leaves so many times as much as without it, at most."""
SMALL = 1e-4
"""A change of E_d, E_b and E_s by which their derivatives are taken."""
SMALL_SHARE = 1e-2
"""Of the largest size a law may have: it moves the robot in proportion to it there."""
TOO_LITTLE = 0.5
"""A law that would have to be twice as large as the largest is given up at once."""


@dataclass
class Driven:
    """What is known of a drive without the law."""

    setting: Setting
    on_s: list[Array]
    """Of each run, since the robot was switched on."""
    angles: list[Array]
    """[2 x times] of each run."""
    poses: list[Array]
    """[times x 3] of each run, true."""
    speed_m_s: Array
    """Of all runs, where they move."""
    turn_rad_s: Array
    """Of all runs, where they turn."""
    noise_m: float
    """What the truth leaves."""


Draw: TypeAlias = Callable[[Driven, Random], dict[str, Any]]
"""Draws scale, phase and place of a law, by the names of their fields."""


@dataclass(frozen=True)
class Family:
    """Laws of one kind."""

    kind: str
    acts_on: str
    per: str
    draw: Draw
    sign: int = 0
    """-1: a loss; 0: either way."""


def nothing(_: Driven, __: Random) -> dict[str, Any]:
    """A law without numbers but its size."""
    return {}


def phase(_: Driven, random: Random) -> dict[str, Any]:
    """A wave of the heading."""
    return {"law_phase_rad": random.uniform(-pi, pi)}


def scale(low: float, high: float) -> Draw:
    """A scale in a range, log-uniform."""
    return lambda _, random: {"law_scale": log_uniform(random, low, high)}


def wave(low: float, high: float) -> Draw:
    """A period in a range, and a phase."""
    return lambda known, random: scale(low, high)(known, random) | phase(known, random)


def harmonic(known: Driven, random: Random) -> dict[str, Any]:
    """The second or third harmonic of the heading."""
    return {"law_order": int(random.integers(2, 4))} | phase(known, random)


def threshold_of_speed(known: Driven, random: Random) -> dict[str, Any]:
    """A speed that the robot has on both sides of."""
    return {"law_scale": float(np.quantile(known.speed_m_s, random.uniform(0.25, 0.75)))}


def threshold_of_turns(known: Driven, random: Random) -> dict[str, Any]:
    """A turn rate that the robot has on both sides of."""
    return {"law_scale": float(np.quantile(known.turn_rad_s, random.uniform(0.25, 0.75)))}


def knee(known: Driven, random: Random) -> dict[str, Any]:
    """A speed at which a law begins to be constant."""
    return {"law_scale": random.uniform(0.2, 0.8) * float(known.speed_m_s.max())}


def brakes(known: Driven, random: Random) -> dict[str, Any]:
    """Less than the robot brakes by."""
    return {"law_scale": random.uniform(0.1, 0.5) * known.setting.robot.acceleration_m_s2}


def visited(known: Driven, random: Random) -> dict[str, Any]:
    """A disc about a place of some run."""
    poses = known.poses[int(random.integers(len(known.poses)))]
    x, y = poses[int(random.integers(len(poses))), :2].tolist()
    return {"law_scale": log_uniform(random, 0.3, 1.0), "law_x_m": x, "law_y_m": y}


def least_x(known: Driven, random: Random) -> dict[str, Any]:
    """A wall at the least x."""
    x = float(np.concatenate(known.poses)[:, 0].min())
    return {"law_scale": log_uniform(random, 0.3, 0.8), "law_x_m": x}


def bump(_: Driven, random: Random) -> dict[str, Any]:
    """A bump of a wheel, 10 to 25 degrees wide."""
    return {
        "law_scale": random.uniform(10, 25) * pi / 180,
        "law_phase_rad": random.uniform(-pi, pi),
        "law_wheel": pick(random, ["left", "right"]),
    }


def power(_: Driven, random: Random) -> dict[str, Any]:
    """Linear or quadratic."""
    return {"law_order": 1 if chance(random, 0.5) else 2}


FAMILIES = (
    Family("time_wave", "yaw", "second", wave(5, 40)),
    Family("way_wave", "yaw", "metre", wave(0.5, 6)),
    Family("way_wave", "forward", "metre", wave(0.5, 6)),
    Family("heading_wave", "forward", "metre", harmonic),
    Family("heading_wave", "yaw", "metre", harmonic),
    Family("heading_wave", "sideways", "metre", harmonic),
    Family("speed_squared", "yaw", "metre", nothing),
    Family("speed_above", "forward", "metre", threshold_of_speed, sign=-1),
    Family("speed_tanh", "yaw", "metre", knee),
    Family("speed_times_turn_rate", "sideways", "second", nothing),
    Family("speed_times_heading", "yaw", "metre", phase),
    Family("turn_rate_above", "forward", "radian", threshold_of_turns),
    Family("turn_rate_squared", "yaw", "second", nothing),
    Family("braking", "yaw", "second", brakes),
    Family("fading", "yaw", "metre", scale(15, 60)),
    Family("growing", "yaw", "metre", power),
    Family("disc", "yaw", "metre", visited),
    Family("wall", "yaw", "metre", least_x),
    Family("place_x", "forward", "metre", nothing),
    Family("place_y_squared", "forward", "metre", nothing),
    Family("wheel_pulse", "yaw", "metre", bump),
)
"""All kinds, each as likely as the others."""


def largest_size(known: Driven, family: Family, laws: Laws) -> float:
    """The largest size that a law may have; 0 where the drive never calls on it."""
    robot = known.setting.robot
    shape = peak(known, laws)
    if shape == 0:
        return 0.0
    if family.kind == "speed_times_turn_rate":
        return 0.2 / robot.top_turn_rad_s  # a side slip of a fifth in the narrowest arc
    if family.kind == "turn_rate_squared":
        return 0.2 / robot.top_turn_rad_s  # a fifth of the fastest turn
    if family.kind == "wheel_pulse":
        return 1.5 / shape  # rad/m, for a sixth of a turn at most
    share = {"metre": 0.2, "second": 0.2 * robot.top_speed_m_s, "radian": 0.2 * robot.wheelbase_m}
    yaw = {"metre": 0.3, "second": 0.1}
    return (yaw if family.acts_on == "yaw" else share)[family.per] / shape


def known_of(made: Made) -> Driven:
    """What is known of a drive without a law."""
    on_s = [np.arange(0.0, ride.end_s, STEP_S) for ride in made.tracks]
    rides = list(zip(made.tracks, on_s, strict=True))
    angles = [ride.angles(times) for ride, times in rides]
    situations = [driving(times, a, made.setting) for times, a in zip(on_s, angles, strict=True)]
    speed = np.abs(np.concatenate([at.speed_m_s for at in situations]))
    turn = np.abs(np.concatenate([at.turn_rad_s for at in situations]))
    return Driven(
        made.setting,
        on_s,
        angles,
        [ride.poses(times) for ride, times in rides],
        speed[speed > 0.1 * speed.max()],
        turn[turn > 0.1 * turn.max()],
        left_out_m(made),
    )


def rows_of(log: Log) -> Array:
    """The rows of a log, as they are read from its file."""
    return np.column_stack([log.stamp_s, log.counts, log.pose])


def left_out_m(made: Made) -> float:
    """What the truth leaves in a world that was not written."""
    about = truth(made)
    logs = [left_in(rows_of(log), log.name, about, made.setting) for log in made.logs]
    return rms_m({log.name: left for log, left in zip(made.logs, logs, strict=True)})


def positions(known: Driven, setting: Setting) -> list[Array]:
    """Where a robot with these numbers would have been, [times x 2] of each run."""
    runs = zip(known.on_s, known.angles, known.poses, strict=True)
    return [replayed(on_s, angle, setting, pose[0])[:, :2] for on_s, angle, pose in runs]


def taken_up(known: Driven) -> list[Array]:
    """What E_d, E_b, E_s and the heading at START do to the positions, centred run by run.

    [3 + runs x times x 2] of each run. Where START is does nothing to centred positions.
    """
    robot = known.setting.robot
    plain = positions(known, known.setting)
    changes = [{name: getattr(robot, name) + SMALL} for name in ("e_d", "e_b", "e_s")]
    moved = [positions(known, known.setting.with_(**change)) for change in changes]
    columns = []
    for run, place in enumerate(plain):
        own = [(one[run] - place) / SMALL for one in moved]
        turned = np.stack([place[0, 1] - place[:, 1], place[:, 0] - place[0, 0]], axis=1)
        own += [turned if other == run else np.zeros_like(place) for other in range(len(plain))]
        columns.append(centred(np.array(own)))
    return columns


def centred(columns: Array) -> Array:
    """Columns [... x times x 2] without their means over the run."""
    return np.asarray(columns - columns.mean(axis=-2, keepdims=True))


def beyond_m(known: Driven, laws: Laws, columns: list[Array]) -> float:
    """Root mean square distance by which a law moves the robot beyond E_d, E_b, E_s and START."""
    return float(np.sqrt(np.concatenate(squares_beyond(known, laws, columns)).mean()))


def share_of_one_run(known: Driven, laws: Laws, columns: list[Array]) -> float:
    """Of the squares of these distances, the greatest part that is of one run."""
    sums = [one.sum() for one in squares_beyond(known, laws, columns)]
    return float(max(sums) / sum(sums))


def squares_beyond(known: Driven, laws: Laws, columns: list[Array]) -> list[Array]:
    """Squares of the distances by which a law moves the robot beyond what is fitted, run by run."""
    with_law = positions(known, replace(known.setting, laws=laws))
    without = positions(known, known.setting)
    both = zip(with_law, without, strict=True)
    moved = np.concatenate([centred(a - b).ravel() for a, b in both])
    fitted = np.concatenate([one.reshape(len(one), -1) for one in columns], axis=1).T
    size = np.maximum(np.linalg.norm(fitted, axis=0), 1e-12)
    values = np.linalg.lstsq(fitted / size, moved, rcond=1e-9)[0]
    rest = (moved - fitted / size @ values).reshape(-1, 2)
    ends = np.cumsum([len(one) for one in with_law])[:-1]
    return np.split((rest**2).sum(axis=1), ends)


def peak(known: Driven, laws: Laws) -> float:
    """The greatest value of a law's shape along the drive."""
    largest = 0.0
    for on_s, angle, pose in zip(known.on_s, known.angles, known.poses, strict=True):
        x, y, heading = ((pose[1:] + pose[:-1]) / 2).T
        at = replace(driving(on_s, angle, known.setting), x_m=x, y_m=y, heading=heading)
        value = np.abs(SHAPES[laws.law_kind](laws, at)) * at.moves
        largest = max(largest, float(value.max()))
    return largest


def sized(known: Driven, family: Family, laws: Laws, wanted_m: float) -> Laws | None:
    """The law with a size by which it moves the robot that far; none where that is too large."""
    limit = largest_size(known, family, laws)
    if limit == 0:
        return None
    columns = taken_up(known)
    sign, size = np.sign(laws.law_size), limit * SMALL_SHARE
    for _ in range(ROUNDS):
        shows_m = beyond_m(known, replace(laws, law_size=sign * size), columns)
        if shows_m * limit < wanted_m * size * TOO_LITTLE:
            return None
        size = size * wanted_m / shows_m
    return replace(laws, law_size=float(sign * size)) if size <= limit else None


def drawn(known: Driven, family: Family, random: Random) -> Laws:
    """A law of a family, of size one."""
    sign = float(family.sign) if family.sign else signed(random, 1.0)
    return Laws(
        law_kind=family.kind,
        law_acts_on=family.acts_on,
        law_per=family.per,
        law_size=sign,
        **family.draw(known, random),
    )


def chosen(overrides: list[str]) -> list[Family]:
    """The families that the `key=value` words of the command line leave."""
    words = dict(word.split("=", 1) for word in overrides)
    kind, acts_on = words.get("law_kind"), words.get("law_acts_on")
    left = [one for one in FAMILIES if kind in (None, one.kind) and acts_on in (None, one.acts_on)]
    if not left:
        raise ValueError(f"no law {kind or ''} acts on {acts_on or 'anything'}")
    return left


def order(families: list[Family], world: str, seed: int) -> Iterator[Family]:
    """Families to try, each a few times; as many successive seeds begin with one each."""
    count = len(families)
    first = stream(seed // count, world, "first law").permutation(count)[seed % count]
    others = stream(seed, world, "other laws").permutation(count)
    for i in [first, *others[others != first]]:
        yield from [families[i]] * TRIES


def with_law(world: str, seed: int, setting: Setting, words: list[str]) -> Made:
    """A world with a law that shows, drawn until there is one; a given size is kept."""
    known = known_of(driven(world, seed, replace(setting, laws=Laws())))
    random = stream(seed, world, "law")
    is_given = any(word.startswith("law_size=") for word in words)
    for family in order(chosen(words), world, seed):
        wanted_m = known.noise_m * log_uniform(random, *SHOWS)
        plain = drawn(known, family, random)
        laws = plain if is_given else sized(known, family, plain, wanted_m)
        if laws is None:
            continue
        made = driven(world, seed, replace(setting, laws=laws).overridden(words))
        made.law = about(made, known)
        if is_given or is_fair(made.law):
            return made
    raise ValueError(f"no law shows in {world} --seed {seed}")


def is_fair(law: dict[str, Any]) -> bool:
    """Whether a law shows as far as laws are to, and again, and the ticks say all about it."""
    is_visible = SHOWS[0] <= law["shows_m"] / law["noise_m"] <= SHOWS[1]
    repeats = law["share_of_one_run"] <= IN_ONE_RUN
    return bool(is_visible and repeats and law["truth_leaves_m"] <= BLURS * law["noise_m"])


def about(made: Made, known: Driven) -> dict[str, Any]:
    """How far the law of a world shows in it."""
    rides = list(zip(made.tracks, known.on_s, strict=True))
    own = replace(
        known,
        angles=[ride.angles(times) for ride, times in rides],
        poses=[ride.poses(times) for ride, times in rides],
    )
    laws, columns = made.setting.laws, taken_up(own)
    places = np.concatenate(own.poses)[:, :2]
    low, high = places.min(axis=0), places.max(axis=0)
    return {
        "room_m": [low[0], high[0], low[1], high[1]],
        "shows_m": beyond_m(own, laws, columns),
        "share_of_one_run": share_of_one_run(own, laws, columns),
        "noise_m": known.noise_m,
        "truth_leaves_m": left_out_m(made),
    }
