"""What the robots are told to drive: one function a kind of drive.

A plan holds the speed of the axle's centre and the turn rate for each control period. A closed
loop follows the poses that the plan leads to (`control.py`).
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from math import atan2, ceil, cos, hypot, pi, sin, sqrt
from typing import TypeAlias

import numpy as np
from setting import Array

Random: TypeAlias = np.random.Generator
Move: TypeAlias = tuple[float, float]
"""Length of the centre's way [m] and angle of the turn [rad], at constant curvature."""


@dataclass(frozen=True)
class Limits:
    """How fast a run is driven, and how long it lasts."""

    speed_m_s: float
    turn_rad_s: float
    acceleration_m_s2: float
    turn_acceleration_rad_s2: float
    period_s: float
    pause_s: float
    run_s: float
    sense: int
    """+1: a path that goes round is driven counter-clockwise; -1: clockwise."""
    side_m: float
    """Of a square."""


Plan: TypeAlias = Callable[[Limits, Random], Array]
"""Makes the plan of one run, [periods x 2]: speed [m/s] and turn rate [rad/s]."""


def still(seconds: float, limits: Limits) -> Array:
    """A plan that rests."""
    return np.zeros((round(seconds / limits.period_s), 2))


def stroke(move: Move, limits: Limits) -> Array:
    """One move from rest to rest, with ramps."""
    length, angle = abs(move[0]), abs(move[1])
    ways = np.array([length, angle])
    driven = ways > 0
    top = min(np.array([limits.speed_m_s, limits.turn_rad_s])[driven] / ways[driven])
    ramp = min(
        np.array([limits.acceleration_m_s2, limits.turn_acceleration_rad_s2])[driven] / ways[driven]
    )
    top = min(top, sqrt(ramp))
    seconds = 1 / top + top / ramp
    periods = max(1, ceil(seconds / limits.period_s))
    t = (np.arange(periods) + 0.5) * (seconds / periods)
    rate = np.minimum(np.minimum(ramp * t, ramp * (seconds - t)), top)
    rate /= rate.sum() * limits.period_s
    return np.asarray(rate[:, None] * np.array(move))


def stop_and_go(moves: Iterable[Move], limits: Limits) -> Array:
    """Moves with a stop behind each, until the run is over; the last one is driven to its end."""
    parts: list[Array] = []
    periods = 0
    for move in moves:
        parts += [stroke(move, limits), still(limits.pause_s, limits)]
        periods += len(parts[-2]) + len(parts[-1])
        if periods * limits.period_s >= limits.run_s:
            break
    return np.concatenate(parts)


def rolling(moves: Iterable[Move], limits: Limits) -> Array:
    """Moves without a stop between them; speeds change by ramps."""
    parts: list[Array] = []
    periods = 0
    for length, angle in moves:
        seconds = max(abs(length) / limits.speed_m_s, abs(angle) / limits.turn_rad_s)
        count = max(1, ceil(seconds / limits.period_s))
        parts.append(np.full((count, 2), np.array([length, angle]) / (count * limits.period_s)))
        periods += count
        if periods * limits.period_s >= limits.run_s:
            break
    return ramped(np.concatenate(parts), limits)


def ramped(plan: Array, limits: Limits) -> Array:
    """The plan with steps made ramps, which leaves the sum of all motion as it is."""
    seconds = max(
        limits.speed_m_s / limits.acceleration_m_s2,
        limits.turn_rad_s / limits.turn_acceleration_rad_s2,
    )
    box = np.ones(max(1, round(seconds / limits.period_s)))
    box /= len(box)
    return np.stack([np.convolve(column, box) for column in plan.T], axis=1)


def random_commands(limits: Limits, random: Random) -> Array:
    """Every 1 to 4 s another speed and turn rate from a list."""
    v, w = limits.speed_m_s, limits.turn_rad_s
    choices = [(v, 0.0), (0.0, w), (0.0, -w), (-0.4 * v, 0.0), (0.0, 0.0)]
    choices += [(v * random.uniform(0.2, 1), w * random.uniform(-1, 1)) for _ in range(6)]
    parts = []
    seconds = 0.0
    while seconds < limits.run_s:
        each = random.uniform(1, 4)
        twist = choices[random.integers(len(choices))]
        parts.append(np.tile(twist, (round(each / limits.period_s), 1)))
        seconds += each
    return ramped(np.concatenate(parts), limits)


def wander(periods: int, memory: float, random: Random) -> Array:
    """An Ornstein-Uhlenbeck process of unit variance that forgets over `memory` periods."""
    kept = np.exp(-1 / memory)
    news = random.standard_normal(periods) * sqrt(1 - kept**2)
    value = random.standard_normal()
    values = np.empty(periods)
    for i, new in enumerate(news.tolist()):
        value = kept * value + new
        values[i] = value
    return values


def joystick(limits: Limits, random: Random) -> Array:
    """Smoothly changing speed and turn rate, now and then backwards."""
    periods = round(limits.run_s / limits.period_s)
    memory = random.uniform(0.8, 3) / limits.period_s
    v = limits.speed_m_s * np.clip(0.6 + 0.3 * wander(periods, memory, random), 0, 1)
    w = limits.turn_rad_s * np.clip(0.4 * wander(periods, memory, random), -1, 1)
    backwards = wander(periods, 4 * memory, random) > 1.3
    return ramped(np.stack([np.where(backwards, -0.5 * v, v), w], axis=1), limits)


def towards(goal: Array, pose: list[float], arcs: bool) -> Iterator[Move]:
    """The moves to a place, by a turn and a straight or by one arc; changes `pose`."""
    dx, dy = goal[0] - pose[0], goal[1] - pose[1]
    bearing = atan2(dy, dx)
    side = atan2(sin(bearing - pose[2]), cos(bearing - pose[2]))
    distance = hypot(dx, dy)
    if arcs and 0.05 < abs(side) < 1.2:
        yield distance * side / sin(side), 2 * side
        pose[2] += 2 * side
    else:
        yield 0.0, side
        yield distance, 0.0
        pose[2] = bearing
    pose[:2] = goal.tolist()


def way_points(limits: Limits, random: Random) -> Array:
    """Random places in a room, reached by turn and straight or by arcs."""
    room = limits.speed_m_s * random.uniform(3, 15)
    arcs = bool(random.random() < 0.5)

    def moves() -> Iterator[Move]:
        pose = [0.0, 0.0, 0.0]
        while True:
            goal = random.uniform(-room / 2, room / 2, 2)
            if hypot(goal[0] - pose[0], goal[1] - pose[1]) > 0.1 * room:
                yield from towards(goal, pose, arcs)

    return stop_and_go(moves(), limits)


def lawn_mower(limits: Limits, random: Random) -> Array:
    """Lanes to and fro, with square or round turns between them."""
    lane = limits.speed_m_s * random.uniform(4, 15)
    spacing = lane * random.uniform(0.05, 0.3)
    is_round = bool(random.random() < 0.5)

    def moves() -> Iterator[Move]:
        turn = limits.sense * pi / 2
        while True:
            yield lane, 0.0
            if is_round:
                yield spacing * pi / 2, 2 * turn
            else:
                yield from [(0.0, turn), (spacing, 0.0), (0.0, turn)]
            turn = -turn

    return (rolling if is_round else stop_and_go)(moves(), limits)


def square_side_m(speed_m_s: float, turn_rad_s: float, pause_s: float, run_s: float) -> float:
    """Side of a square that takes about half a run."""
    corner_s = pi / 2 / turn_rad_s + 0.5 + 2 * pause_s
    return speed_m_s * max(2.0, run_s / 8 - corner_s)


def squares(limits: Limits, _: Random) -> Array:
    """Whole squares with turns on the spot, as often as fit into a run, once at least."""
    side = [(limits.side_m, 0.0), (0.0, limits.sense * pi / 2)]
    once = stop_and_go(side * 4, replace(limits, run_s=np.inf))
    return np.tile(once, (max(1, int(limits.run_s / (len(once) * limits.period_s))), 1))


def circles(limits: Limits, random: Random) -> Array:
    """Circles of several radii, all the same way round."""
    smallest = limits.speed_m_s / limits.turn_rad_s

    def moves() -> Iterator[Move]:
        while True:
            radius = smallest * random.uniform(0.7, 4)
            yield 2 * pi * radius, limits.sense * 2 * pi

    return (rolling if random.random() < 0.5 else stop_and_go)(moves(), limits)


def figure_eights(limits: Limits, random: Random) -> Array:
    """A circle to the left and one to the right, in turn."""
    radius = limits.speed_m_s / limits.turn_rad_s * random.uniform(0.8, 3)

    def moves() -> Iterator[Move]:
        turn = limits.sense * 2 * pi
        while True:
            yield 2 * pi * radius, turn
            turn = -turn

    return (rolling if random.random() < 0.5 else stop_and_go)(moves(), limits)


def spins_and_straights(limits: Limits, random: Random) -> Array:
    """Turns on the spot of several sizes, and straights."""

    def moves() -> Iterator[Move]:
        while True:
            yield 0.0, random.choice([-1, 1]) * random.uniform(0.5, 4 * pi)
            yield limits.speed_m_s * random.uniform(1, 8), 0.0

    return stop_and_go(moves(), limits)


def back_and_forth(limits: Limits, random: Random) -> Array:
    """Straight ahead, then back the same way: in reverse, or after half a turn."""
    lane = limits.speed_m_s * random.uniform(3, 12)
    in_reverse = bool(random.random() < 0.5)

    def moves() -> Iterator[Move]:
        while True:
            yield lane, 0.0
            if in_reverse:
                yield -lane, 0.0
            else:
                yield 0.0, random.choice([-1, 1]) * pi

    return stop_and_go(moves(), limits)


def straights(limits: Limits, random: Random) -> Array:
    """Straight strokes alone, ahead and back."""

    def moves() -> Iterator[Move]:
        while True:
            yield limits.speed_m_s * random.uniform(2, 10), 0.0
            yield -limits.speed_m_s * random.uniform(1, 8), 0.0

    return stop_and_go(moves(), limits)


def spins(limits: Limits, random: Random) -> Array:
    """Turns on the spot alone, both ways."""

    def moves() -> Iterator[Move]:
        while True:
            yield 0.0, random.choice([-1, 1]) * random.uniform(0.5, 4 * pi)

    return stop_and_go(moves(), limits)


PLANS: dict[str, Plan] = {
    plan.__name__: plan
    for plan in (
        random_commands,
        joystick,
        way_points,
        lawn_mower,
        squares,
        circles,
        figure_eights,
        spins_and_straights,
        back_and_forth,
        straights,
        spins,
    )
}

FREE = [
    "random_commands",
    "joystick",
    "way_points",
    "lawn_mower",
    "figure_eights",
    "spins_and_straights",
    "back_and_forth",
]
"""Drives that go round in no fixed sense: their logs are called run_01.csv and so on."""
ROUND = ["squares", "circles"]
"""Drives that are made clockwise and counter-clockwise: cw_01.csv, ccw_01.csv."""
WITHOUT_PLAN = ["random_commands", "joystick"]
"""Drives that nobody steers along a plan: always open loop."""
WITH_STOPS = ["way_points", "squares", "spins_and_straights", "back_and_forth"]
"""Drives that rest between their moves where there is a pause."""
