"""The nominal robot and its path: what it believes of itself and what it is told to drive."""

from dataclasses import dataclass, replace
from math import atan2, cos, hypot, pi, sin, tau
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Robot:
    """A differential drive as its owner describes it, with a motor and an encoder at each wheel."""

    wheelbase_m: float = 0.340
    wheel_diameter_m: float = 0.150
    ticks_per_revolution: int = 2000
    motor_lag_s: float = 0.05
    log_rate_hz: float = 20.0

    @property
    def radius_m(self) -> float:
        """Radius of both wheels."""
        return self.wheel_diameter_m / 2

    @property
    def tick_rad(self) -> float:
        """Angle of a wheel per count."""
        return tau / self.ticks_per_revolution

    def with_ticks(self, ticks_per_revolution: int) -> "Robot":
        """The same robot with another encoder."""
        return replace(self, ticks_per_revolution=ticks_per_revolution)


@dataclass(frozen=True)
class Move:
    """A stretch of constant curvature: `length_m` of the centre, `angle_rad` of turning."""

    length_m: float
    angle_rad: float


@dataclass(frozen=True)
class Path:
    """A shape of robot.toml with the values of its keys; its counter-clockwise moves."""

    shape: str
    values: dict[str, float | int | tuple[tuple[float, float], ...]]

    def moves(self) -> list[Move]:
        """The moves of a counter-clockwise run; a clockwise run has the angles reversed."""
        v = self.values
        if self.shape == "waypoints":
            points = v["points_m"]
            assert isinstance(points, tuple)
            return through(points)
        n = {key: value for key, value in v.items() if isinstance(value, (int, float))}
        corner = Move(0.0, pi / 2)
        if self.shape == "square":
            return [Move(n["side_m"], 0.0), corner] * 4
        if self.shape == "rectangle":
            return [Move(n["length_m"], 0.0), corner, Move(n["width_m"], 0.0), corner] * 2
        if self.shape == "figure_eight":
            return [Move(tau * n["radius_m"], angle) for angle in (tau, -tau)]
        if self.shape == "circle":
            return [Move(tau * n["turns"] * n["radius_m"], tau * n["turns"])]
        if self.shape == "straight":
            return [Move(n["length_m"], 0.0)]
        if self.shape == "spin":
            return [Move(0.0, tau * n["turns"])]
        raise ValueError(f"unknown shape {self.shape!r}")


def through(points: tuple[tuple[float, float], ...]) -> list[Move]:
    """Turn towards each point in turn and drive straight to it."""
    x, y, heading = 0.0, 0.0, 0.0
    moves = []
    for px, py in points:
        towards = atan2(py - y, px - x)
        angle = atan2(sin(towards - heading), cos(towards - heading))
        if angle != 0.0:
            moves.append(Move(0.0, angle))
        moves.append(Move(hypot(px - x, py - y), 0.0))
        x, y, heading = px, py, towards
    return moves


SQUARE = Path("square", {"side_m": 4.0})


def robot_toml(name: str, robot: Robot, path: Path) -> str:
    """The file that describes robot and path."""
    values = {key: value for key, value in path.values.items() if key != "points_m"}
    lines = [
        "[robot]",
        f'name = "{name}"',
        'drive = "differential"',
        f"wheelbase_m = {robot.wheelbase_m}",
        f"wheel_diameter_m = {robot.wheel_diameter_m}",
        f"ticks_per_revolution = {robot.ticks_per_revolution}",
        f"encoder_rate_hz = {robot.log_rate_hz}",
        "",
        "[path]",
        f'shape = "{path.shape}"',
        *(f"{key} = {value}" for key, value in values.items()),
    ]
    points = path.values.get("points_m")
    if isinstance(points, tuple):
        lines.append(f"points_m = {[list(point) for point in points]}")
    return "\n".join(lines) + "\n"
