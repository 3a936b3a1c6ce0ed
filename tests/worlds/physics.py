"""True motion in steps of 1 ms: motors, wheels, body. Runs lie side by side."""

from dataclasses import dataclass

import numpy as np
from laws import MOVING_M_S, Situation, added_turn, scrubbed, unlisted_motion, wheel_travel
from plans import Random
from setting import Array, Setting

STEP_S = 1e-3


@dataclass
class Track:
    """What really happened, every millisecond of the longest run."""

    pose: Array
    """[3 x runs x times] x, y and heading of the axle's centre in the room."""
    counted: Array
    """[2 x runs x times, rad] wheel angles that the encoders see."""


class Motion:
    """The moving robots, one a run; wheels are ordered left, right."""

    def __init__(self, setting: Setting, starts: Array, random: Random) -> None:
        """All robots at rest at their `starts` [3 x runs]."""
        robot = setting.robot
        self.robot = robot
        self.laws = setting.laws
        self.counts_commands = setting.faults.counts_commands
        self.random = random
        self.radii = np.array(robot.true_radii_m)[:, None, None]
        self.pose = starts.copy()
        self.rate = np.zeros((2, starts.shape[1]))
        self.angle = np.zeros_like(self.rate)
        self.counted = np.zeros_like(self.rate)
        self.time_s = 0.0
        self.way_m = np.zeros(starts.shape[1])
        self.poses = [starts[:, :, None]]
        self.counts = [self.counted[:, :, None]]
        self.steps = round(setting.drive.control_period_s / STEP_S)
        self.since = np.asarray((np.arange(self.steps) + 0.5) * STEP_S, dtype=np.float64)
        self.decay = np.exp(-self.since / robot.motor_lag_s)
        self.decay_at_end = float(np.exp(-self.steps * STEP_S / robot.motor_lag_s))

    def advance(self, command: Array) -> None:
        """One control period with commanded wheel rates [2 x runs, rad/s]."""
        lagging = self.rate - command
        before = self.rate
        rolled = (command[:, :, None] + lagging[:, :, None] * self.decay) * STEP_S
        self.rate = command + lagging * self.decay_at_end
        angle = self.angle[:, :, None] + rolled.cumsum(axis=2)
        middle = angle - rolled / 2
        travel = wheel_travel(self.laws, rolled, middle, self.radii, STEP_S)
        faster = (self.radii[:, :, 0] * (self.rate - before)).mean(axis=0)
        self.move(travel, middle, faster / (self.steps * STEP_S))
        self.angle = angle[:, :, -1]
        if self.counts_commands:
            counted = self.counted[:, :, None] + command[:, :, None] * (self.since + STEP_S / 2)
        else:
            counted = angle
        self.counted = counted[:, :, -1]
        self.counts.append(counted)
        self.time_s += self.steps * STEP_S

    def move(self, travel: Array, angle: Array, acceleration: Array) -> None:
        """Move the body by the travel of its wheels [2 x runs x steps] and by noise.

        `angle` is that of the wheels, `acceleration` [runs] that of the whole control period.
        """
        robot = self.robot
        forward = (travel[0] + travel[1]) / 2
        turn = (travel[1] - travel[0]) / robot.true_wheelbase_m
        turn = scrubbed(self.laws, forward, turn, robot.true_wheelbase_m, STEP_S)
        heading = self.pose[2][:, None] + turn.cumsum(axis=1) - turn / 2
        time_s = self.time_s + self.since
        turned = added_turn(self.laws, travel, forward, heading, time_s, STEP_S)
        added = np.zeros((3, *forward.shape))
        if self.laws.law_kind:
            at = self.situation(travel, angle, heading, turn, acceleration)
            added = unlisted_motion(self.laws, at, forward, turn, STEP_S)
            self.way_m = at.way_m[:, -1]
        turn = turn + turned + added[2]
        noise = self.random.standard_normal((3, *forward.shape))
        left, right = robot.wheel_noise_sqrt_m * np.sqrt(np.abs(travel)) * noise[:2]
        turn += (right - left) / robot.true_wheelbase_m
        turn += robot.heading_noise_rad_sqrt_m * np.sqrt(np.abs(forward)) * noise[2]
        forward = forward + (left + right) / 2 + added[0]
        after = self.pose[2][:, None] + turn.cumsum(axis=1)
        heading = after - turn / 2
        cos, sin = np.cos(heading), np.sin(heading)
        x = self.pose[0][:, None] + (forward * cos - added[1] * sin).cumsum(axis=1)
        y = self.pose[1][:, None] + (forward * sin + added[1] * cos).cumsum(axis=1)
        poses = np.stack([x, y, after])
        self.pose = poses[:, :, -1].copy()
        self.poses.append(poses)

    def situation(
        self, travel: Array, angle: Array, heading: Array, turn: Array, acceleration: Array
    ) -> Situation:
        """How and where the robots drive in these steps."""
        forward = travel.mean(axis=0)
        return Situation(
            time_s=np.broadcast_to(self.time_s + self.since, forward.shape),
            way_m=self.way_m[:, None] + np.abs(forward).cumsum(axis=1),
            heading=heading,
            x_m=self.pose[0][:, None] + (forward * np.cos(heading)).cumsum(axis=1),
            y_m=self.pose[1][:, None] + (forward * np.sin(heading)).cumsum(axis=1),
            speed_m_s=forward / STEP_S,
            turn_rad_s=turn / STEP_S,
            acceleration_m_s2=np.broadcast_to(acceleration[:, None], forward.shape),
            wheel_angle=angle,
            moves=(np.abs(travel).max(axis=0) > MOVING_M_S * STEP_S).astype(float),
        )

    def push(self, run: int, shift: Array) -> None:
        """Move the robot of a run by x, y and heading without its wheels."""
        self.pose[:, run] += shift

    def spin(self, run: int, angle: Array) -> None:
        """Turn the wheels of a run by so much where they stand."""
        self.angle[:, run] += angle
        self.counted[:, run] += angle

    def track(self) -> Track:
        """What happened so far."""
        return Track(np.concatenate(self.poses, axis=2), np.concatenate(self.counts, axis=2))
