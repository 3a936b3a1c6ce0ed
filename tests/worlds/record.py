"""Draw a world, drive it, record it."""

from dataclasses import dataclass, field, replace
from math import pi
from typing import Any
from zlib import crc32

import control
import encoders
import numpy as np
import tracker
from draw import around, draw, log_uniform, signed
from encoders import Ride, Ticks, read_ticks
from physics import STEP_S, Track
from plans import PLANS, ROUND, Limits, Random, square_side_m, still
from setting import Array, Setting
from tracker import Jump, Poses, follow, pose_times
from worlds import WORLDS


@dataclass
class Log:
    """One file of runs/, row by row; rows without a pose hold NaN there."""

    name: str
    run: int
    """The drive that it is, or is a piece of, counted from 0."""
    stamp_s: Array
    counts: Array
    """[rows x 2] as they stand in the file."""
    pose: Array
    """[rows x 3] as they stand in the file."""
    true: Array
    """[rows x 3] what a perfect reference without faults would have written."""
    error: Array
    """[rows x 3] what the measurement adds to it."""
    body: Array
    """[rows x 3] where the axle's centre is in the room."""
    bad: Array
    """1 where the pose is a glitch, else 0."""
    late_s: float
    """By how much the rows of the poses are stamped after the poses, in the mean."""


@dataclass
class Made:
    """A world, ready to be written."""

    world: str
    seed: int
    setting: Setting
    logs: list[Log] = field(default_factory=list)
    jumps: list[Jump] = field(default_factory=list)
    delays_s: list[float] = field(default_factory=list)
    """Of each drive."""
    begins_s: list[float] = field(default_factory=list)
    """When the recording of each drive began, since the robot was switched on."""
    corrections: list[tuple[int, float, float, float]] = field(default_factory=list)
    """Of a reference that drifts: drive, stamp, distance, turn."""
    tracks: list[Ride] = field(default_factory=list)
    """What really happened in each drive, from its beginning to its end."""
    law: dict[str, Any] = field(default_factory=dict)
    """How far the law that no catalogue lists shows, where there is one."""


def stream(seed: int, world: str, purpose: str) -> Random:
    """Random numbers that depend on nothing else."""
    return np.random.default_rng([seed, crc32(world.encode()), crc32(purpose.encode())])


def setting_of(world: str, seed: int, overrides: list[str]) -> Setting:
    """The numbers of a world."""
    known = WORLDS[world]
    source = known.same_drive_as or world
    setting = draw(stream(seed, source, "draw"))
    setting = setting.with_(**known.change(setting, stream(seed, source, "change")))
    return setting.overridden(overrides)


def sense(setting: Setting, run: int) -> int:
    """Which way round a run goes."""
    return -1 if run % 2 else 1


def plan(setting: Setting, run: int, random: Random) -> Array:
    """The plan of one run, with rest at both ends."""
    limits = common_limits(setting, run)
    speed, turn, length = random.uniform((0.5, 0.6, 0.8), (1, 1, 1.2)).tolist()
    if setting.drive.kind not in ROUND:
        limits = replace(
            limits,
            speed_m_s=max(0.05, limits.speed_m_s * speed),
            turn_rad_s=limits.turn_rad_s * turn,
            run_s=limits.run_s * length,
        )
    elif setting.drive.speed_spread > 1:
        slower = setting.drive.speed_spread ** -random.uniform(0, 1, 2)
        limits = replace(
            limits,
            speed_m_s=limits.speed_m_s * slower[0],
            turn_rad_s=limits.turn_rad_s * slower[1],
        )
    rest = still(setting.drive.rest_s, limits)
    return np.concatenate([rest, PLANS[setting.drive.kind](limits, random), rest])


def common_limits(setting: Setting, run: int) -> Limits:
    """Limits of a run that is driven as fast as the robot may, and as long as the others."""
    robot, drive = setting.robot, setting.drive
    return Limits(
        robot.top_speed_m_s,
        robot.top_turn_rad_s,
        robot.acceleration_m_s2,
        robot.turn_acceleration_rad_s2,
        drive.control_period_s,
        drive.pause_s,
        drive.run_s,
        sense(setting, run),
        square_side_m(robot.top_speed_m_s, robot.top_turn_rad_s, drive.pause_s, drive.run_s),
    )


def starts(setting: Setting, random: Random) -> Array:
    """True poses [3 x runs] where the robots are switched on."""
    runs = setting.drive.runs
    if setting.recording.start == "origin":
        return np.zeros((3, runs))
    return np.stack([*random.uniform(-5, 5, (2, runs)), random.uniform(-pi, pi, runs)])


def between_steps(setting: Setting, time_s: float) -> float:
    """The time in the middle of the first step of a control period."""
    period_s = setting.drive.control_period_s
    return round(time_s / period_s) * period_s + STEP_S / 2


def draw_jumps(setting: Setting, seconds: list[float], random: Random) -> list[Jump]:
    """The jumps of all runs, between a fifth and four fifths of each."""
    faults = setting.faults
    if not faults.jumps:
        return []
    count = max(1, round(faults.jumping_share * len(seconds)))
    jumps = []
    for run in sorted(random.permutation(len(seconds))[:count].tolist()):
        number = int(random.integers(1, faults.jumps + 1))
        for part in range(number):
            share = 0.2 + 0.6 * (part + random.uniform(0.1, 0.9)) / number
            x, y = around(random, log_uniform(random, *faults.jump_m))
            turn = signed(random, log_uniform(random, *faults.jump_rad))
            at = between_steps(setting, share * seconds[run])
            jump = Jump(run, at, (x, y, turn))
            if faults.jump_lasts_s[1] > 0:
                jump = replace(jump, lasts_s=float(random.uniform(*faults.jump_lasts_s)))
            if faults.jump_of == "wheel":
                jump = spun(setting, jump, random)
            jumps.append(jump)
    return jumps


def spun(setting: Setting, jump: Jump, random: Random) -> Jump:
    """A wheel that spins as long as a jump lasts, and how far the odometry is off by it, nearly."""
    robot = setting.robot
    rim = float(random.uniform(0.2, 1.0)) * robot.top_speed_m_s * jump.lasts_s
    rim = signed(random, rim)
    angle = rim / robot.nominal_radius_m
    right = random.random() < 0.5
    turn = (-1 if right else 1) * rim / robot.wheelbase_m
    return replace(
        jump, shift=(rim / 2, 0.0, turn), spin_rad=(0.0, angle) if right else (angle, 0.0)
    )


def merged(setting: Setting, ride: Ride, ticks: Ticks, poses: Poses) -> Log:
    """The rows of a run: poses in rows of ticks, or in rows of their own."""
    if setting.recording.layout == "interleaved":
        inside = (poses.stamp_s > ticks.stamp_s[0]) & (poses.stamp_s < ticks.stamp_s[-1])
        stamp = np.union1d(ticks.stamp_s, poses.stamp_s[inside])
    else:
        inside = np.ones(len(poses.stamp_s), dtype=bool)
        stamp = ticks.stamp_s
    counts = np.stack([np.interp(stamp, ticks.stamp_s, c) for c in ticks.counts.T], axis=1)
    nowhere = np.full((len(stamp), 3), np.nan)
    row = nearest(stamp, poses.stamp_s[inside])
    log = Log(
        log_name(setting, ride.run),
        ride.run,
        stamp,
        encoders.in_columns(counts, setting),
        nowhere,
        nowhere.copy(),
        nowhere.copy(),
        ride.poses(ride.begin_s + stamp),
        np.zeros(len(stamp)),
        float(np.mean(stamp[row] - poses.stamp_s[inside])),
    )
    log.pose[row] = tracker.in_columns(poses.pose[inside], setting)
    log.true[row] = poses.true[inside]
    log.error[row] = (poses.pose - poses.true)[inside]
    log.bad[row] = poses.bad[inside]
    return log


def nearest(stamp_s: Array, wanted_s: Array) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Rows whose stamps are nearest to the wanted ones."""
    after = np.clip(np.searchsorted(stamp_s, wanted_s), 1, len(stamp_s) - 1)
    before = after - 1
    earlier = wanted_s - stamp_s[before] < stamp_s[after] - wanted_s
    return np.where(earlier, before, after)


def log_name(setting: Setting, run: int) -> str:
    """The name of a log without its ending."""
    if setting.drive.kind not in ROUND:
        return f"run_{run + 1:02}"
    return f"{'ccw' if sense(setting, run) > 0 else 'cw'}_{run // 2 + 1:02}"


def pieces(log: Log, count: int) -> list[Log]:
    """A log cut into so many."""
    parts = np.array_split(np.arange(len(log.stamp_s)), count)
    return [
        Log(
            f"run_{i:02}",
            log.run,
            log.stamp_s[rows],
            log.counts[rows],
            log.pose[rows],
            log.true[rows],
            log.error[rows],
            log.body[rows],
            log.bad[rows],
            log.late_s,
        )
        for i, rows in enumerate(parts, start=1)
    ]


def record_run(made: Made, track: Track, run: int, end_s: float, random: Random) -> Log:
    """Record one drive, and note in `made` what was put in."""
    setting = made.setting
    ride = Ride(track, run, setting.drive.cut_s, end_s - setting.drive.cut_s)
    ticks = read_ticks(setting, ride, random)
    when = pose_times(setting, ride, ticks.taken_s, ticks.stamp_s, random)
    reference = setting.reference
    delay = reference.delay_s + reference.delay_scatter_s * float(random.standard_normal())
    jumps = [jump for jump in made.jumps if jump.run == run]
    poses = follow(setting, ride, when, delay, jumps, random)
    made.delays_s.append(delay)
    made.begins_s.append(ride.begin_s)
    made.corrections += [(run, *correction) for correction in poses.corrections]
    return merged(setting, ride, ticks, poses)


def driven(world: str, seed: int, setting: Setting) -> Made:
    """Drive and record a world with these numbers."""
    source = WORLDS[world].same_drive_as or world
    made = Made(world, seed, setting)
    random = stream(seed, source, "drive")
    plans = [plan(setting, run, random) for run in range(setting.drive.runs)]
    ends = [len(one) * setting.drive.control_period_s for one in plans]
    made.jumps = draw_jumps(setting, ends, stream(seed, source, "jumps"))
    pushes = [
        control.Push(
            jump.run,
            jump.time_s,
            jump.lasts_s,
            np.array(jump.shift) * (setting.faults.jump_of == "robot"),
            np.array(jump.spin_rad),
        )
        for jump in made.jumps
        if setting.faults.jump_of != "reference"
    ]
    track = control.drive(setting, plans, starts(setting, random), pushes, random)
    made.tracks = [Ride(track, run, 0.0, end_s) for run, end_s in enumerate(ends)]
    for run, end_s in enumerate(ends):
        log = record_run(made, track, run, end_s, stream(seed, source, f"record {run}"))
        made.logs += pieces(log, setting.drive.pieces) if setting.drive.pieces > 1 else [log]
    return made
