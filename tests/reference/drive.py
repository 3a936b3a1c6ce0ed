"""The closed loop: a robot follows its schedule by its own odometry, integrated at 1 ms."""

from dataclasses import dataclass

import numpy as np
from motion import TrueMotion
from robot import Array, Robot
from schedule import PERIOD_S, Schedule, wheel_rates
from sensors import Counts, Encoders, Odometry

STEPS = 10
"""Steps of integration per control period."""
ALONG_PER_S, ACROSS_PER_M2, HEADING_PER_S = 3.0, 8.0, 4.0
"""Gains of the tracking controller (Kanayama et al. 1990)."""
STICTION_M_S = 1e-3
"""A wheel commanded slower than this stands still."""


@dataclass(frozen=True)
class Recording:
    """Every control period of all runs, START first."""

    track: Array
    """[periods + 1 x 3 x runs] true poses."""
    ticks: Counts
    """[periods + 1 x 2 x runs]."""
    computed: Array
    """[periods + 1 x 3 x runs] what the robot computed."""


def command(robot: Robot, plan: Schedule, period: int, believed: Array) -> Array:
    """Wheel rates [2 x runs, rad/s] that lead the believed pose back to the schedule."""
    v, w = plan.forward[period], plan.turning[period]
    dx, dy = plan.x[period] - believed[0], plan.y[period] - believed[1]
    off = plan.heading[period] - believed[2]
    cos, sin = np.cos(believed[2]), np.sin(believed[2])
    along, across = cos * dx + sin * dy, cos * dy - sin * dx
    forward = v * np.cos(off) + ALONG_PER_S * along
    turning = w + ACROSS_PER_M2 * v * across + HEADING_PER_S * off
    rates = wheel_rates(robot, forward, turning)
    rates[np.abs(rates) * robot.radius_m < STICTION_M_S] = 0.0
    return rates


def drive(
    robot: Robot, plan: Schedule, truth: TrueMotion, encoders: Encoders, odometry: Odometry
) -> Recording:
    """Drive all runs side by side; `truth` holds where they start."""
    periods, runs = plan.forward.shape
    track = np.empty((periods + 1, 3, runs))
    computed = np.zeros((periods + 1, 3, runs))
    ticks = np.zeros((periods + 1, 2, runs), dtype=np.int64)
    track[0] = truth.pose
    step = PERIOD_S / STEPS
    lag = (1 - np.exp(-step / robot.motor_lag_s)) if robot.motor_lag_s else 1.0
    settled = 1 - (1 - lag) ** np.arange(1, STEPS + 1)[:, None]
    for period in range(periods):
        wanted = command(robot, plan, period, odometry.pose)
        rate = truth.rate[:, None] + settled * (wanted - truth.rate)[:, None]
        stretch = truth.advance(rate, step)
        ticks[period + 1] = encoders.read(stretch)
        odometry.update(ticks[period + 1])
        track[period + 1] = truth.pose
        computed[period + 1] = odometry.pose
    return Recording(track, ticks, computed)
