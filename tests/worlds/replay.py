"""What the truth leaves: the ticks of a world replayed with everything that was put into it.

Works from the files alone. The rest of the error is noise of wheels and reference, and what a
reference does that drifts.
"""

import json
from dataclasses import dataclass, replace
from math import pi
from pathlib import Path as File
from typing import Any

import numpy as np
from laws import Situation, added_turn, scrubbed, unlisted_motion, wheel_travel
from setting import Array, Drive, Faults, Laws, Recording, Reference, Robot, Setting
from tracker import filtered, tracked, turned

FIRST_S = 2.0
"""A replay is laid on the poses of so many first seconds, and on five poses at least."""
SMOOTH_S = 0.1
"""Speeds, of which some laws are functions, are means over so long."""
MOVES_M_S = 5e-3
"""A wheel that is faster than this in such a mean moves."""
MOST_ROUNDS, SETTLED = 40, 1e-7
"""Laws of the pose are settled after so many rounds at most, or where poses change by less."""


@dataclass
class Left:
    """Measured minus replayed poses of one log, [poses x 3]; NaN where there is no heading."""

    stamp_s: Array
    error: Array
    bad: Array
    """1 where the pose is a glitch, else 0."""


def read_truth(folder: File) -> dict[str, Any]:
    """What truth.json says."""
    truth: dict[str, Any] = json.loads((folder / "truth.json").read_text())
    return truth


def setting_in(truth: dict[str, Any]) -> Setting:
    """The numbers of a world from its truth.json."""
    parts: dict[str, Any] = truth["numbers"]
    return Setting(
        Robot(**parts["robot"]),
        Drive(**parts["drive"]),
        Recording(**parts["recording"]),
        Reference(**parts["reference"]),
        Faults(**parts["faults"]),
        Laws(**parts["laws"]),
    )


def read_log(file: File) -> Array:
    """The rows of a log [rows x 6]; NaN in cells without a number."""
    lines = file.read_text().splitlines()
    cells = [[float(cell or "nan") for cell in line.split(",")] for line in lines[1:]]
    rows = np.array(cells)
    missing = np.full((len(rows), 6 - rows.shape[1]), np.nan)
    return np.column_stack([rows, missing])


def wheels_of(log: Array, setting: Setting) -> Array:
    """Angles [2 x rows, rad] of the wheels since they were switched on, from a log's columns."""
    faults = setting.faults
    left, right = log[:, 1:3].T
    if faults.exchanged:
        left, right = right, left
    if faults.left_reversed:
        left = -left
    if faults.right_reversed:
        right = -right
    left = left / (1 + faults.left_extra_edges)
    return (np.stack([left, right]) - setting.recording.first_count) * setting.robot.tick_rad


def poses_of(log: Array, setting: Setting) -> Array:
    """Measured poses [rows x 3] in metres, radians and a right-handed frame."""
    x, y, heading = log[:, 3:6].T
    faults = setting.faults
    length = 1e-3 if faults.mm_as_m else 1.0
    heading = heading * (pi / 180 if faults.deg_as_rad else 1.0)
    if faults.heading_clockwise or faults.mirrored:
        heading = -heading
    if faults.compass:
        heading = pi / 2 - heading
    return np.column_stack([x * length, (-y if faults.mirrored else y) * length, heading])


def smoothed_rate(when_s: Array, on_s: Array, value: Array) -> Array:
    """How fast a value known at some times changes at others, over a short while about each."""
    early, late = (np.clip(when_s + s, on_s[0], on_s[-1]) for s in (-SMOOTH_S / 2, SMOOTH_S / 2))
    change = np.interp(late, on_s, value) - np.interp(early, on_s, value)
    return np.asarray(change / np.maximum(late - early, 1e-6))


def driving(on_s: Array, angle: Array, setting: Setting) -> Situation:
    """How a robot drives in each step, by the angles [2 x rows] of its wheels; not yet where.

    Single counts are no speed: what is a rate is smoothed.
    """
    laws, robot = setting.laws, setting.robot
    rolled, step_s = np.diff(angle), np.maximum(np.diff(on_s), 1e-6)
    middle = (angle[:, 1:] + angle[:, :-1]) / 2
    radii = np.array(robot.true_radii_m)[:, None]
    travel = wheel_travel(laws, rolled, middle, radii, step_s)
    middle_s = (on_s[1:] + on_s[:-1]) / 2
    left, right = (
        smoothed_rate(middle_s, on_s, np.concatenate([[0.0], one.cumsum()])) for one in travel
    )
    speed = (left + right) / 2
    way = np.abs(travel.mean(axis=0))
    turn_rate = (right - left) / robot.true_wheelbase_m
    return Situation(
        time_s=middle_s,
        way_m=way.cumsum() - way / 2,
        heading=np.zeros_like(speed),
        x_m=np.zeros_like(speed),
        y_m=np.zeros_like(speed),
        speed_m_s=speed,
        turn_rad_s=scrubbed(laws, speed, turn_rate, robot.true_wheelbase_m, 1.0),
        acceleration_m_s2=smoothed_rate(middle_s, middle_s, speed),
        wheel_angle=middle,
        moves=(np.maximum(np.abs(left), np.abs(right)) > MOVES_M_S).astype(float),
    )


def replayed(on_s: Array, angle: Array, setting: Setting, start: Array) -> Array:
    """Poses [rows x 3] from wheel angles [2 x rows], beginning at a pose.

    `on_s` is the time since the robot was switched on.
    """
    robot, laws = setting.robot, setting.laws
    rolled, step_s = np.diff(angle), np.maximum(np.diff(on_s), 1e-6)
    at = driving(on_s, angle, setting)
    radii = np.array(robot.true_radii_m)[:, None]
    travel = wheel_travel(laws, rolled, at.wheel_angle, radii, step_s)
    forward = (travel[0] + travel[1]) / 2
    turn = (travel[1] - travel[0]) / robot.true_wheelbase_m
    turn = scrubbed(laws, forward, turn, robot.true_wheelbase_m, step_s)
    motion = np.stack([forward, np.zeros_like(forward), turn])
    poses = along(motion, start)
    # Laws depend on the pose, and the pose on laws.
    for _ in range(MOST_ROUNDS):
        before = poses
        x, y, heading = ((poses[1:] + poses[:-1]) / 2).T
        at = replace(at, x_m=x, y_m=y, heading=heading)
        added = np.zeros_like(motion)
        added[2] = added_turn(laws, travel, forward, heading, at.time_s, step_s)
        if laws.law_kind:
            added += unlisted_motion(laws, at, forward, turn, step_s)
        poses = along(motion + added, start)
        if np.abs(poses - before).max() < SETTLED:
            break
    return poses


def along(motion: Array, start: Array) -> Array:
    """Poses [rows x 3] that steps of forward, sideways and yaw motion [3 x steps] lead to."""
    forward, sideways, turn = motion
    course = start[2] + turn.cumsum() - turn / 2
    cos, sin = np.cos(course), np.sin(course)
    steps = [forward * cos - sideways * sin, forward * sin + sideways * cos, turn]
    return np.concatenate([start[None, :], np.stack(steps, axis=1)]).cumsum(axis=0)


def shown(stamp_s: Array, body: Array, when_s: Array, setting: Setting) -> Array:
    """Poses of the tracked point [poses x 3] at other times than those of the rows."""

    def seen(when_s: Array) -> Array:
        moved = [np.interp(when_s, stamp_s, column) for column in body.T]
        return tracked(np.stack(moved, axis=1), setting.reference)

    return filtered(seen, when_s, setting.reference.filter_s)


def mean_angle(angles: Array) -> float:
    """The mean direction."""
    return float(np.arctan2(np.sin(angles).mean(), np.cos(angles).mean()))


def best_turn(from_: Array, to: Array) -> float:
    """The angle that turns places [n x 2] best onto others, all about their means."""
    a, b = from_ - from_.mean(axis=0), to - to.mean(axis=0)
    return float(np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum()))


def laid_on(poses: Array, measured: Array, stamp_s: Array, good: Array) -> Array:
    """Poses [n x 3] turned and shifted so that their first ones lie on the measured ones.

    Without headings, all poses say how they are turned.
    """
    first = np.flatnonzero(good)
    first = first[stamp_s[first] <= max(stamp_s[first[0]] + FIRST_S, stamp_s[first[:5]].max())]
    if np.isnan(measured[:, 2]).any():
        angle = best_turn(poses[good > 0, :2], measured[good > 0, :2])
    else:
        angle = mean_angle(measured[first, 2] - poses[first, 2])
    place = turned(poses[:, :2], angle)
    place += (measured[first, :2] - place[first]).mean(axis=0)
    return np.column_stack([place, poses[:, 2] + angle])


def left_in(rows: Array, name: str, truth: dict[str, Any], setting: Setting) -> Left:
    """What the truth leaves in one log; START is laid anew behind each jump."""
    stamp_s = rows[:, 0]
    has_pose = np.isfinite(rows[:, 3])
    measured, when_s = poses_of(rows, setting)[has_pose], stamp_s[has_pose]
    about = truth["logs"][name]
    start = np.array(about["start_in_room"])
    body = replayed(stamp_s + about["begin_s"], wheels_of(rows, setting), setting, start)
    rate = setting.reference.clock_rate
    predicted = shown(stamp_s, body, when_s * (1 - rate) - about["delay_s"], setting)
    glitches = np.array(truth["glitches"].get(name, []))
    bad = np.array([np.abs(glitches - t).min(initial=1.0) < 1e-5 for t in when_s], dtype=float)
    own_jumps = [jump for jump in truth["jumps"] if jump["run"] == name]
    jumps = sorted(jump[end] for jump in own_jumps for end in ("since_s", "time_s"))
    error = np.full_like(measured, np.nan)
    part = np.searchsorted(np.array(jumps), when_s)
    for i in np.unique(part):
        if i % 2:  # within a jump
            continue
        own = part == i
        laid = laid_on(predicted[own], measured[own], when_s[own], 1 - bad[own])
        error[own] = measured[own] - laid
    error[:, 2] = np.arctan2(np.sin(error[:, 2]), np.cos(error[:, 2]))
    return Left(when_s, error, bad)


def left(folder: File) -> dict[str, Left]:
    """What the truth leaves in each log of a world."""
    truth = read_truth(folder)
    setting = setting_in(truth)
    files = sorted((folder / "runs").glob("*.csv"))
    return {f.stem: left_in(read_log(f), f.stem, truth, setting) for f in files}


def rms_m(logs: dict[str, Left], with_glitches: bool = True) -> float:
    """Root mean square distance of the poses from the replay."""
    squares = [
        (one.error[(one.bad == 0) | with_glitches, :2] ** 2).sum(axis=1) for one in logs.values()
    ]
    return float(np.sqrt(np.nanmean(np.concatenate(squares))))
