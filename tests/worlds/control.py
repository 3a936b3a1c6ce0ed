"""The loop that drives: plans, controllers, the moving robots."""

from dataclasses import dataclass

import numpy as np
from physics import Motion, Track
from plans import Random
from setting import Array, Robot, Setting

GAIN_AHEAD = 0.8
"""Speed per distance behind the plan [1/s]."""
GAIN_ASIDE = 2.0
"""Turn rate per distance beside the plan and speed [1/m²]."""
GAIN_HEADING = 1.0
"""Turn rate per heading error [1/s]."""


@dataclass(frozen=True)
class Push:
    """A robot that is moved by hand."""

    run: int
    time_s: float
    lasts_s: float
    shift: Array
    """x, y and heading."""
    spin_rad: Array
    """What each wheel turns more than it rolls."""

    def share(self, period: int, period_s: float) -> float:
        """Which part of it happens in a control period."""
        if self.lasts_s == 0:
            return float(round(self.time_s / period_s) == period)
        begin, end = (np.array([period, period + 1]) * period_s - self.time_s) / self.lasts_s
        return float(np.clip(end, 0, 1) - np.clip(begin, 0, 1))


def wheel_rates(twist: Array, robot: Robot) -> Array:
    """Wheel rates [2 x ..., rad/s] that the nominal robot needs for a speed and a turn rate."""
    rim = twist[1] * robot.wheelbase_m / 2
    return np.stack([twist[0] - rim, twist[0] + rim]) / robot.nominal_radius_m


def moved(pose: Array, forward: Array, turn: Array) -> Array:
    """Poses [3 x runs] after an arc, nearly: along the heading in its middle."""
    heading = pose[2] + turn / 2
    return np.stack(
        [pose[0] + forward * np.cos(heading), pose[1] + forward * np.sin(heading), pose[2] + turn]
    )


class OwnOdometry:
    """The pose that the robot computes from its ticks."""

    def __init__(self, robot: Robot, starts: Array) -> None:
        """It knows where it starts."""
        self.robot = robot
        self.pose = starts.copy()
        self.counts = np.zeros((2, starts.shape[1]))

    def see(self, motion: Motion) -> Array:
        """The pose now."""
        counts = np.floor(motion.counted / self.robot.tick_rad)
        metres = (counts - self.counts) * self.robot.tick_rad * self.robot.nominal_radius_m
        self.counts = counts
        turn = (metres[1] - metres[0]) / self.robot.wheelbase_m
        self.pose = moved(self.pose, (metres[0] + metres[1]) / 2, turn)
        return self.pose


class LateTruth:
    """The true pose, some control periods ago."""

    def __init__(self, periods: int) -> None:
        """Nothing was seen yet."""
        self.periods = periods
        self.seen: list[Array] = []

    def see(self, motion: Motion) -> Array:
        """The pose that has arrived by now."""
        self.seen.append(motion.pose)
        return self.seen[max(0, len(self.seen) - 1 - self.periods)]


def correction(goal: Array, pose: Array, twist: Array) -> Array:
    """What to add to the planned speed and turn rate [2 x runs] (Kanayama's tracking law)."""
    dx, dy = goal[0] - pose[0], goal[1] - pose[1]
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    ahead, aside = cos * dx + sin * dy, cos * dy - sin * dx
    off = goal[2] - pose[2]
    off = np.arctan2(np.sin(off), np.cos(off))
    turn = GAIN_ASIDE * aside * twist[0] + GAIN_HEADING * np.sin(off)
    return np.stack([GAIN_AHEAD * ahead, turn])


def planned_poses(plan: Array, starts: Array, period_s: float) -> Array:
    """Poses [periods x 3 x runs] at the beginning of each period of a plan [periods x 2 x runs]."""
    forward, turn = plan[:, 0] * period_s, plan[:, 1] * period_s
    heading = starts[2] + turn.cumsum(axis=0) - turn
    middle = heading + turn / 2
    dx, dy = forward * np.cos(middle), forward * np.sin(middle)
    x, y = starts[0] + dx.cumsum(axis=0) - dx, starts[1] + dy.cumsum(axis=0) - dy
    return np.stack([x, y, heading], axis=1)


def side_by_side(plans: list[Array], after: int) -> Array:
    """Plans of unlike length in one array [periods x 2 x runs], with rest behind them."""
    longest = max(len(plan) for plan in plans) + after
    return np.stack([np.pad(p, ((0, longest - len(p)), (0, 0))) for p in plans], axis=2)


def drive(
    setting: Setting, plans: list[Array], starts: Array, pushes: list[Push], random: Random
) -> Track:
    """Drive the plans [periods x 2] of all runs from their `starts` [3 x runs]."""
    period_s = setting.drive.control_period_s
    plan = side_by_side(plans, after=round(1 / period_s))
    goals = planned_poses(plan, starts, period_s)
    motion = Motion(setting, starts, random)
    late = round(setting.drive.feedback_delay_s / period_s)
    observers: dict[str, OwnOdometry | LateTruth | None] = {
        "open": None,
        "odometry": OwnOdometry(setting.robot, starts),
        "truth": LateTruth(late),
    }
    observer = observers[setting.drive.controller]
    limit = 1.3 * np.array([[setting.robot.top_speed_m_s], [setting.robot.top_turn_rad_s]])
    for period, twist in enumerate(plan):
        for push in pushes:
            if share := push.share(period, period_s):
                motion.push(push.run, share * push.shift)
                motion.spin(push.run, share * push.spin_rad)
        if observer is not None:
            steered = twist + correction(goals[period], observer.see(motion), twist)
            moves = np.any(twist != 0, axis=0)
            twist = np.where(moves, np.clip(steered, -limit, limit), 0.0)
        motion.advance(wheel_rates(twist, setting.robot))
    return motion.track()
