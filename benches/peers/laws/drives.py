"""Recorded drives: ticks, poses, and the variables of the formulas of umbmark."""

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]
Rows: TypeAlias = npt.NDArray[np.int64]
"""Places in an array."""

VARIABLES = (
    "speed",
    "turn_rate",
    "acceleration",
    "turn_acceleration",
    "heading",
    "x",
    "y",
    "wheel_angle_left",
    "wheel_angle_right",
    "distance",
    "time",
    "since_turn",
    "last_turn",
    "direction",
)
"""Columns of features, as docs/files.md defines them; by the nominal robot, but for the pose."""
AT = {name: column for column, name in enumerate(VARIABLES)}
POSE = [AT["x"], AT["y"], AT["heading"]]
HALF_WINDOW_S = 0.05
"""Half the time over which the speed of a wheel is taken."""
MOVES_M_S = 5e-3
"""A wheel that is faster than this moves."""
SENSES = {"ccw": 1.0, "cw": -1.0}
"""The value of `direction` of a run."""
BY_HAND = 0.10
"""STARTs that are nearer to each other than this [m, rad] are one place on the floor."""


@dataclass(frozen=True)
class Robot:
    """The nominal robot."""

    wheelbase_m: float
    tick_m: float
    tick_rad: float

    @classmethod
    def read(cls, folder: Path) -> "Robot":
        """The robot of a dataset."""
        robot = tomllib.loads((folder / "robot.toml").read_text())["robot"]
        tick_rad = 2 * np.pi / robot["ticks_per_revolution"]
        tick_m = 0.5 * robot["wheel_diameter_m"] * tick_rad
        return cls(robot["wheelbase_m"], tick_m, tick_rad)


@dataclass
class Run:
    """One log."""

    name: str
    time: Array
    """Of each row, since the first one [s]."""
    travel: Array
    """Of the left and the right wheel since START, by the nominal robot, [2 x rows, m]."""
    seen: Rows
    """Rows with a pose."""
    measured: Array
    """Poses at these rows, [poses x 3], in the frame of the room."""
    features: Array
    """In the middle of each step, [rows - 1 x variables]; the pose is still zero there."""
    moves: Array
    """1 where a wheel turns in a step, else 0."""
    origin: Array | None = None
    """Where the frame of the poses lies in that of the log."""

    @property
    def at_start(self) -> Array:
        """The mean pose before the first motion."""
        return mean_pose(self.measured[self.rest])

    @property
    def rest(self) -> npt.NDArray[np.bool_]:
        """Which poses were measured before the first motion."""
        gone = np.abs(self.travel[:, self.seen]).max(axis=0)
        still = gone <= max(1e-9, float(gone[0]))
        return np.asarray(still)


def read_runs(
    folder: Path, logs: Iterable[dict[str, Any]], robot: Robot, first: Run | None = None
) -> list[Run]:
    """Logs of a dataset, as `umbmark inspect` lists them.

    All are in the frame of START of the first one, or of another first one.
    """
    runs = [
        read_run(folder / "runs" / f"{log['name']}.csv", robot, SENSES.get(log["direction"], 0.0))
        for log in logs
    ]
    first = first or runs[0]
    origin = first.origin if first.origin is not None else first.at_start
    if is_at_zero(origin):
        origin = np.zeros(3)
    for run in runs:
        start = run.at_start
        # Poses are in the frame of the run's own START, or in that of a room that all runs share.
        run.origin = np.zeros(3) if is_at_zero(start) else origin
        run.measured = seen_from(run.origin, run.measured)
    first.origin = origin
    return runs


def is_at_zero(start: Array) -> bool:
    """Whether poses are those in the frame of START, but for the hand that put the robot there."""
    return bool(np.hypot(*start[:2]) < BY_HAND and abs(start[2]) < BY_HAND)


def read_run(file: Path, robot: Robot, sense: float = 0.0) -> Run:
    """One log; poses as they stand in it."""
    head, *lines = file.read_text().splitlines()
    names = head.split(",")
    rows = np.array([[float(cell or "nan") for cell in line.split(",")] for line in lines])
    column = {name: rows[:, names.index(name)] for name in names}
    ticks = np.stack([column["ticks_left"], column["ticks_right"]])
    seen = np.flatnonzero(np.isfinite(column["x_ref_m"]))
    poses = np.stack([column[name][seen] for name in ("x_ref_m", "y_ref_m", "theta_ref_rad")])
    poses[2] = np.unwrap(poses[2])
    time = column["t_s"] - column["t_s"][0]
    travel = (ticks - ticks[:, :1]) * robot.tick_m
    features, moves = features_of(time, travel, robot, sense)
    return Run(file.stem, time, travel, seen, poses.T, features, moves)


def features_of(time: Array, travel: Array, robot: Robot, sense: float) -> tuple[Array, Array]:
    """The variables in the middle of each step, and whether a wheel turns there."""
    middle = (time[1:] + time[:-1]) / 2
    left, right = (rate(middle, time, one) for one in travel)
    speed, turn = (left + right) / 2, (right - left) / robot.wheelbase_m
    step = np.diff(travel)
    way = np.abs(step.mean(axis=0))
    distance = way.cumsum() - way / 2
    moves = np.maximum(np.abs(left), np.abs(right)) > MOVES_M_S
    turning = moves & (np.abs(right - left) > np.abs(left + right))
    last = np.maximum.accumulate(np.where(turning, np.arange(len(turning)), -1))
    angle = (travel[:, 1:] + travel[:, :-1]) / 2 / robot.tick_m * robot.tick_rad
    columns = {
        "speed": speed,
        "turn_rate": turn,
        "acceleration": rate(middle, middle, speed),
        "turn_acceleration": rate(middle, middle, turn),
        "wheel_angle_left": angle[0],
        "wheel_angle_right": angle[1],
        "distance": distance,
        "time": middle,
        "since_turn": distance - np.where(last >= 0, distance[last], 0.0),
        "last_turn": np.where(last >= 0, np.sign(turn[last]), 0.0),
        "direction": np.full_like(middle, sense),
    }
    zero = np.zeros_like(middle)
    return np.stack([columns.get(name, zero) for name in VARIABLES], axis=1), moves.astype(float)


def rate(when: Array, time: Array, value: Array) -> Array:
    """How fast a value changes, over a tenth of a second."""
    ends = [np.clip(when + s * HALF_WINDOW_S, time[0], time[-1]) for s in (-1, 1)]
    early, late = (np.interp(end, time, value) for end in ends)
    return np.asarray((late - early) / np.maximum(ends[1] - ends[0], 1e-6))


def mean_pose(poses: Array) -> Array:
    """The mean of neighbouring poses."""
    return np.asarray(poses.mean(axis=0))


def seen_from(start: Array, poses: Array) -> Array:
    """Poses [n x 3] in the frame of another pose, or of one pose each."""
    dx, dy = poses[..., 0] - start[..., 0], poses[..., 1] - start[..., 1]
    cos, sin = np.cos(start[..., 2]), np.sin(start[..., 2])
    turn = poses[..., 2] - start[..., 2]
    return np.stack([cos * dx + sin * dy, cos * dy - sin * dx, turn], axis=-1)


def placed(start: Array, poses: Array) -> Array:
    """Poses [n x 3] seen from a pose, in the frame of the room."""
    cos, sin = np.cos(start[2]), np.sin(start[2])
    x = start[0] + cos * poses[:, 0] - sin * poses[:, 1]
    y = start[1] + sin * poses[:, 0] + cos * poses[:, 1]
    return np.stack([x, y, start[2] + poses[:, 2]], axis=1)


def effects_of(model: Path) -> dict[str, dict[str, Any]]:
    """The effects of a model file by their names."""
    effects = tomllib.loads(model.read_text()).get("effect", [])
    return {effect["name"]: effect for effect in effects}
