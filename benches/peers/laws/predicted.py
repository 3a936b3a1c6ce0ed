"""Where the fitted robot is by its ticks, with a learnt law or without."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from drives import AT, POSE, Array, Robot, Run, effects_of

MOTIONS = ("forward", "sideways", "yaw")
FORWARD, SIDEWAYS, YAW = range(3)
KNOT_S = 0.05
"""A law is evaluated at times that are so far apart at least, and linear in between."""
MOST_ROUNDS, SETTLED_M = 20, 1e-6
"""Laws depend on the pose, and the pose on laws: settled after so many rounds, or by so little."""
KNOWN = {
    "wheel_diameter_ratio",
    "wheelbase",
    "scale",
    "reference_delay",
    "reference_clock_rate",
    "marker_offset",
    "marker_yaw",
}
"""Effects that a fitted robot may have."""


class Law(Protocol):
    """What a method learnt."""

    def rates(self, features: Array) -> Array:
        """Motion that is added, forward, sideways, yaw, per second, [n x 3]."""


@dataclass(frozen=True)
class Fitted:
    """E_d, E_b, E_s and what `umbmark fit` found of the reference."""

    robot: Robot
    e_d: float
    e_b: float
    e_s: float
    delay_s: float
    clock_rate: float
    lever: tuple[float, float]
    yaw: float

    @classmethod
    def read(cls, robot: Robot, model: Path) -> "Fitted":
        """From a model that `umbmark` wrote, without its formulas."""
        effects = effects_of(model)
        unknown = {name for name, one in effects.items() if "formula" not in one} - KNOWN
        if unknown:
            raise ValueError(f"the fit has {unknown}, which these scripts do not know")

        def value(effect: str, parameter: str, default: float) -> float:
            found: Any = effects.get(effect, {}).get(parameter, default)
            return float(found["mean"] if isinstance(found, dict) else found)

        lever = tuple(value("marker_offset", name, 0.0) for name in ("forward_m", "left_m"))
        return cls(
            robot,
            value("wheel_diameter_ratio", "e_d", 1.0),
            value("wheelbase", "e_b", 1.0),
            value("scale", "e_s", 1.0),
            value("reference_delay", "delay_s", 0.0),
            value("reference_clock_rate", "ratio", 0.0),
            (lever[0], lever[1]),
            value("marker_yaw", "yaw_rad", 0.0),
        )

    def motion(self, run: Run) -> Array:
        """Forward, sideways and yaw motion of each step, [3 x rows - 1]."""
        both = 2 * self.e_s / (self.e_d + 1)
        left, right = np.diff(run.travel) * np.array([[both], [both * self.e_d]])
        turn = (right - left) / (self.robot.wheelbase_m * self.e_b)
        return np.stack([(left + right) / 2, np.zeros_like(turn), turn])

    def shown(self, run: Run, body: Array) -> Array:
        """Poses that the reference shows of a robot, at the rows that have one."""
        stamps = run.time[run.seen]
        when = stamps * (1 - self.clock_rate) - self.delay_s
        pose = np.stack([np.interp(when, run.time, column) for column in body.T], axis=1)
        ahead, left = self.lever
        cos, sin = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        pose[:, 0] += ahead * cos - left * sin
        pose[:, 1] += ahead * sin + left * cos
        pose[:, 2] += self.yaw
        return pose


def along(motion: Array, start: Array) -> Array:
    """Poses [rows x 3] that steps of forward, sideways and yaw motion lead to."""
    forward, sideways, turn = motion
    course = start[2] + turn.cumsum() - turn / 2
    cos, sin = np.cos(course), np.sin(course)
    steps = [forward * cos - sideways * sin, forward * sin + sideways * cos, turn]
    return np.concatenate([start[None, :], np.stack(steps, axis=1)]).cumsum(axis=0)


def driven(run: Run, fitted: Fitted, start: Array, law: Law | None = None) -> Array:
    """Poses [rows x 3] of the robot in the room, from START."""
    motion = fitted.motion(run)
    poses = along(motion, start)
    if law is None:
        return poses
    middle, step_s = (run.time[1:] + run.time[:-1]) / 2, np.diff(run.time)
    knots = np.unique(np.floor(middle / KNOT_S).astype(int), return_index=True)[1]
    features = run.features.copy()
    for _ in range(MOST_ROUNDS):
        before = poses
        features[:, POSE] = (poses[1:] + poses[:-1]) / 2
        rates = law.rates(features[knots])
        added = [np.interp(middle, middle[knots], rate) for rate in rates.T]
        poses = along(motion + np.stack(added) * step_s * run.moves, start)
        if np.abs(poses - before).max() < SETTLED_M:
            break
    return poses


def exposures(features: Array, motion: int) -> dict[str, Array]:
    """What a law of a motion may be in proportion to, each second: way, time, angle.

    As in formulas of umbmark: a share of the motion ahead and of the rotation has their signs.
    """
    speed, turn_rate = features[:, AT["speed"]], features[:, AT["turn_rate"]]
    return {
        "metre": speed if motion == FORWARD else np.abs(speed),
        "second": np.ones(len(features)),
        "radian": turn_rate if motion == YAW else np.abs(turn_rate),
    }
