"""What a run is told to do: the speeds of the body over time, with ramps and rests, and the poses
that they lead to.
"""

from dataclasses import dataclass

import numpy as np
from robot import Array, Move, Path, Robot

PERIOD_S = 0.010
"""Period of the control loop."""


@dataclass(frozen=True)
class Pace:
    """How fast a run is driven: `turn_rate_rad_s` on the spot, `speed_m_s` elsewhere."""

    speed_m_s: float = 0.2
    turn_rate_rad_s: float = 0.6
    acceleration_m_s2: float = 0.4
    angular_acceleration_rad_s2: float = 1.2
    rest_s: float = 1.0


@dataclass(frozen=True)
class Schedule:
    """Commands at every control period of runs side by side: arrays of periods x runs.

    Speeds hold during a period; poses are START and then those at the end of each period. `stops`
    lists for each run the periods at whose end it has come to rest (half a rest after each move),
    `periods` how long each run takes.
    """

    forward: Array
    turning: Array
    x: Array
    y: Array
    heading: Array
    stops: list[list[int]]
    periods: list[int]


def ramped(amount: float, rate: float, acceleration: float) -> Array:
    """Mean rates of consecutive periods of a trapezoidal profile that covers `amount` exactly."""
    size = abs(amount)
    top = min(rate, np.sqrt(size * acceleration))
    ramp = top / acceleration
    total = size / top + ramp
    t = np.arange(int(np.ceil(total / PERIOD_S)) + 1) * PERIOD_S
    rising = 0.5 * acceleration * np.minimum(t, ramp) ** 2
    flat = top * np.clip(t - ramp, 0.0, total - 2 * ramp)
    left = np.clip(total - t, 0.0, ramp)
    falling = np.where(t > total - ramp, 0.5 * acceleration * (ramp**2 - left**2), 0.0)
    covered: Array = rising + flat + falling
    return np.asarray(np.sign(amount) * np.diff(covered) / PERIOD_S, dtype=np.float64)


def speeds_of(moves: list[Move], pace: Pace) -> tuple[Array, Array, list[int]]:
    """Forward and turning speed of each period of one run, and the periods of its stops."""
    rest = np.zeros(round(pace.rest_s / PERIOD_S))
    forward, turning, stops = [rest], [rest], []
    periods = len(rest)
    for move in moves:
        if move.length_m == 0.0:
            w = ramped(move.angle_rad, pace.turn_rate_rad_s, pace.angular_acceleration_rad_s2)
            v = np.zeros_like(w)
        else:
            v = ramped(move.length_m, pace.speed_m_s, pace.acceleration_m_s2)
            w = v * (move.angle_rad / move.length_m)
        forward += [v, rest]
        turning += [w, rest]
        stops.append(periods + len(v) + len(rest) // 2)
        periods += len(v) + len(rest)
    return np.concatenate(forward), np.concatenate(turning), stops


def schedule(path: Path, directions: Array, paces: list[Pace]) -> Schedule:
    """The commands of runs side by side; `directions` is +1 for counter-clockwise, -1 for
    clockwise.
    """
    memory: dict[Pace, tuple[Array, Array, list[int]]] = {}
    for pace in paces:
        if pace not in memory:
            memory[pace] = speeds_of(path.moves(), pace)
    each = [memory[pace] for pace in paces]
    periods = [len(v) for v, _, _ in each]
    forward = np.zeros((max(periods), len(each)))
    turning = np.zeros_like(forward)
    for run, (v, w, _) in enumerate(each):
        forward[: len(v), run] = v
        turning[: len(w), run] = w
    turning *= directions
    half = 0.5 * turning * PERIOD_S
    middle = np.cumsum(2 * half, axis=0) - half
    chord = forward * PERIOD_S * np.sinc(half / np.pi)
    x, y, heading = (chain(d) for d in (chord * np.cos(middle), chord * np.sin(middle), 2 * half))
    return Schedule(forward, turning, x, y, heading, [s for _, _, s in each], periods)


def chain(increments: Array) -> Array:
    """Sums from START on."""
    return np.concatenate([np.zeros((1, increments.shape[1])), np.cumsum(increments, axis=0)])


def wheel_rates(robot: Robot, forward: Array, turning: Array) -> Array:
    """Angular rates (left, right) of the wheels of a robot that is as believed."""
    half = 0.5 * robot.wheelbase_m * turning
    return np.stack([forward - half, forward + half]) / robot.radius_m
