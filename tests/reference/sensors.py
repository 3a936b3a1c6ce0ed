"""What is read: encoders, the pose computed from them, the absolute reference."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from motion import Stretch
from robot import Array, Robot
from schedule import PERIOD_S

Counts = npt.NDArray[np.int64]


class Encoders:
    """Integer counters; START lies anywhere within a count. The right one is read `right_delay_s`
    late.
    """

    def __init__(self, robot: Robot, within_tick: Array, right_delay_s: float) -> None:
        """`within_tick` [2 x runs] in [0, 1)."""
        self.tick_rad = robot.tick_rad
        self.within_tick = within_tick
        self.right_delay_s = right_delay_s
        self.counted = np.zeros((2, within_tick.shape[1]))
        self.past = np.zeros((1, within_tick.shape[1]))

    def read(self, s: Stretch) -> Counts:
        """The counters at the end of a stretch."""
        angles = self.counted[1] + np.cumsum(s.counted[1], axis=0)
        self.counted = self.counted + s.counted.sum(axis=1)
        seen = self.counted
        if self.right_delay_s > 0:
            late = self.right_delay_s / s.step_s
            keep = int(late) + 2
            self.past = np.concatenate([self.past, angles])[-keep:]
            seen = np.stack([self.counted[0], self.late(late)])
        return np.floor(seen / self.tick_rad + self.within_tick).astype(np.int64)

    def late(self, steps: float) -> Array:
        """The right wheel's angle that many steps ago, between two that are remembered."""
        whole = int(steps)
        share = steps - whole
        last = len(self.past) - 1
        near, far = (self.past[max(last - back, 0)] for back in (whole, whole + 1))
        return np.asarray((1 - share) * near + share * far, dtype=np.float64)


class Odometry:
    """The computed pose: mid-heading arcs at every reading, or Euler steps after several."""

    def __init__(self, robot: Robot, runs: int, euler_readings: int) -> None:
        """`euler_readings` = 0: mid-heading."""
        self.robot = robot
        self.euler_readings = euler_readings
        self.readings = 0
        self.pose = np.zeros((3, runs))
        self.ticks = np.zeros((2, runs), dtype=np.int64)

    def update(self, ticks: Counts) -> None:
        """Take a reading of the counters."""
        self.readings += 1
        if self.euler_readings and self.readings % self.euler_readings:
            return
        rim = (ticks - self.ticks) * (self.robot.tick_rad * self.robot.radius_m)
        self.ticks = ticks
        turn = (rim[1] - rim[0]) / self.robot.wheelbase_m
        forward = 0.5 * (rim[0] + rim[1])
        heading = self.pose[2] if self.euler_readings else self.pose[2] + 0.5 * turn
        x = self.pose[0] + forward * np.cos(heading)
        y = self.pose[1] + forward * np.sin(heading)
        self.pose = np.stack([x, y, self.pose[2] + turn])


@dataclass(frozen=True)
class Reference:
    """Motion capture in the frame of START: clock, marker and noise."""

    delay_s: float = 0.0
    """A sample stamped t shows the pose at t (1 + rate) - delay."""
    rate: float = 0.0
    forward_m: float = 0.0
    """The marker's place on the robot; the frame was laid through the marker at START."""
    left_m: float = 0.0
    yaw_rad: float = 0.0
    """The heading of the marker against the robot's; the frame was turned by it, too."""
    position_sd_m: float = 8e-4
    heading_sd_rad: float = 8e-4

    def see(self, t_s: Array, track: Array, noise: Array) -> Array:
        """Measured poses [times x 3] of one run from its true `track` [periods x 3]; `noise` of
        unit variance.
        """
        at = np.clip((t_s * (1 + self.rate) - self.delay_s) / PERIOD_S, 0.0, len(track) - 1.0)
        grid = np.arange(len(track))
        x, y, heading = (np.interp(at, grid, track[:, i]) for i in range(3))
        cos, sin = np.cos(heading), np.sin(heading)
        x = x + self.forward_m * cos - self.left_m * sin - self.forward_m
        y = y + self.forward_m * sin + self.left_m * cos - self.left_m
        cos, sin = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        seen = np.stack([cos * x + sin * y, cos * y - sin * x, heading], axis=1)
        sd = [self.position_sd_m, self.position_sd_m, self.heading_sd_rad]
        return np.asarray(seen + noise * sd, dtype=np.float64)
