"""The absolute poses: what the reference sees, when, how well, and what is wrong with it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import pi, sqrt

import numpy as np
from encoders import Ride, stamps, times
from plans import Random, wander
from setting import Array, Faults, Pose, Reference, Setting


@dataclass(frozen=True)
class Jump:
    """A jump of the robot or of the frame of the reference, as it shows in the log."""

    run: int
    time_s: float
    """Since the robot was switched on."""
    shift: Pose
    """x and y in the room, and heading."""
    lasts_s: float = 0.0
    spin_rad: tuple[float, float] = (0.0, 0.0)
    """What each wheel turns on the spot."""


@dataclass
class Poses:
    """The measured poses of one run, [poses x 3]."""

    taken_s: Array
    """True times of the measurements, since the robot was switched on."""
    stamp_s: Array
    pose: Array
    true: Array
    """What a perfect reference would have written, jumps included."""
    bad: Array
    """1 where a pose is a glitch, else 0."""
    corrections: list[tuple[float, float, float]] = field(default_factory=list)
    """Of a reference that drifts: stamp, distance and turn of each correction."""


def turned(vector: Array, angle: Array | float) -> Array:
    """Vectors [n x 2] turned counter-clockwise."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack(
        [cos * vector[:, 0] - sin * vector[:, 1], sin * vector[:, 0] + cos * vector[:, 1]], axis=1
    )


def tracked(body: Array, reference: Reference) -> Array:
    """Poses [n x 3] of the tracked point and its axes for poses of the axle's centre."""
    lever = np.array([[reference.lever_forward_m, reference.lever_left_m]])
    place = body[:, :2] + turned(np.repeat(lever, len(body), axis=0), body[:, 2])
    return np.column_stack([place, body[:, 2] + reference.yaw_rad])


def filtered(shown: Callable[[Array], Array], when_s: Array, filter_s: float) -> Array:
    """Poses [n x 3] at times, after a first-order low-pass filter: the mean of those before."""
    if not filter_s:
        return shown(when_s)
    ages = (np.arange(200) + 0.5) * 0.05
    weights = np.exp(-ages) / np.exp(-ages).sum()
    before = np.stack([shown(when_s - age * filter_s) for age in ages])
    return np.asarray(np.einsum("a,apk->pk", weights, before))


def with_frame_moved(pose: Array, taken_s: Array, jump: Jump, pivot: Array) -> Array:
    """Poses [n x 3] in a frame that jumps, and turns about a place, at a time."""
    after = taken_s >= jump.time_s
    x, y, angle = jump.shift
    place = pivot[:2] + turned(pose[after, :2] - pivot[:2], angle) + np.array([x, y])
    moved = pose.copy()
    moved[after] = np.column_stack([place, pose[after, 2] + angle])
    return moved


def from_start(pose: Array, start: Array) -> Array:
    """Poses [n x 3] in the frame of the pose `start`."""
    place = turned(pose[:, :2] - start[:2], -start[2])
    return np.column_stack([place, pose[:, 2] - start[2]])


def noise(reference: Reference, count: int, rate_hz: float, random: Random) -> Array:
    """Noise of so many poses [count x 3], of unit variance but for `t2`, which has none."""
    if reference.noise == "gaussian":
        return random.standard_normal((count, 3))
    if reference.noise == "t4":
        return random.standard_t(4, (count, 3)) / sqrt(2)
    if reference.noise == "t2":
        return random.standard_t(2, (count, 3))
    if reference.noise == "correlated":
        memory = reference.correlation_s * rate_hz
        return np.stack([wander(count, memory, random) for _ in range(3)], axis=1)
    raise ValueError(f"noise is gaussian, t4, t2 or correlated, not {reference.noise!r}")


def added_up(pose: Array, faults: Faults, random: Random) -> Array:
    """A reference that adds up relative motions with noise, some of them wrong."""
    step = turned(np.diff(pose[:, :2], axis=0), -pose[:-1, 2])
    turn = np.diff(pose[:, 2])
    count = len(turn)
    step += faults.scan_noise_m * random.standard_normal((count, 2))
    turn += faults.scan_noise_rad * random.standard_normal(count)
    wrong = random.random(count) < faults.scan_outliers
    step += wrong[:, None] * random.uniform(0.01, 0.1) * random.standard_normal((count, 2))
    turn += wrong * random.uniform(0.01, 0.1) * random.standard_normal(count)
    heading = pose[0, 2] + np.concatenate([[0.0], turn.cumsum()])
    place = np.concatenate([pose[:1, :2], turned(step, heading[:-1])]).cumsum(axis=0)
    return np.column_stack([place, heading])


def drifting(
    pose: Array, stamp_s: Array, faults: Faults, random: Random
) -> tuple[Array, list[tuple[float, float, float]]]:
    """A reference that drifts and is set right every so often, and when it was."""
    pose = pose.copy()
    corrections = []
    begin = stamp_s[0]
    while begin < stamp_s[-1]:
        end = begin + faults.slam_period_s * random.uniform(0.6, 1.4)
        now = (stamp_s >= begin) & (stamp_s < end)
        distance, turn = random.uniform(*faults.slam_m), random.uniform(-0.03, 0.03)
        angle = random.uniform(-pi, pi)
        drift = np.array([distance * np.cos(angle), distance * np.sin(angle), turn])
        pose[now] += drift * ((stamp_s[now] - begin) / (end - begin))[:, None]
        if end < stamp_s[-1]:
            corrections.append((float(end), float(distance), float(-turn)))
        begin = end
    return pose, corrections


def with_glitches(pose: Array, faults: Faults, random: Random) -> tuple[Array, Array]:
    """Poses of which some are bad, alone or in a row, and which."""
    pose = pose.copy()
    bad = np.zeros(len(pose))
    share = faults.glitch_share
    if not share:
        return pose, bad
    mean_length = (1 + faults.glitch_burst) / 2
    for first in np.flatnonzero(random.random(len(pose)) < share / mean_length):
        length = int(random.integers(1, faults.glitch_burst + 1))
        low, high = np.log(faults.glitch_m)
        distance, angle = np.exp(random.uniform(low, high)), random.uniform(-pi, pi)
        turn = faults.glitch_rad * random.uniform(-1, 1)
        wrong = slice(first, first + length)
        pose[wrong] += [distance * np.cos(angle), distance * np.sin(angle), turn]
        bad[wrong] = 1.0
    return pose, bad


def measured(
    setting: Setting, clean: Array, stamp_s: Array, random: Random
) -> tuple[Array, Array, list[tuple[float, float, float]]]:
    """Poses with noise and faults for perfect ones; which are glitches; corrections."""
    reference, faults = setting.reference, setting.faults
    corrections: list[tuple[float, float, float]] = []
    pose = clean
    if faults.scan_outliers:
        pose = added_up(pose, faults, random)
    if faults.slam_period_s:
        pose, corrections = drifting(pose, stamp_s, faults, random)
    if faults.heading_walk_rad_sqrt_s:
        steps = np.sqrt(np.diff(stamp_s, prepend=stamp_s[:1]).clip(min=0.0))
        walk = np.cumsum(steps * random.standard_normal(len(pose)))
        pose = pose + faults.heading_walk_rad_sqrt_s * np.outer(walk, [0.0, 0.0, 1.0])
    if faults.stretch_along or faults.stretch_diagonal:
        along, diagonal = faults.stretch_along, faults.stretch_diagonal
        picture = np.array(
            [[1 + along, diagonal, 0.0], [diagonal, 1 - along, 0.0], [0.0, 0.0, 1.0]]
        )
        pose = pose @ picture
    sizes = [reference.position_noise_m, reference.position_noise_m, reference.heading_noise_rad]
    rate = setting.recording.reference_rate_hz
    pose = pose + noise(reference, len(pose), rate, random) * sizes
    pose, bad = with_glitches(pose, faults, random)
    return filled_in(pose, stamp_s, faults), bad, corrections


def filled_in(pose: Array, stamp_s: Array, faults: Faults) -> Array:
    """Poses of which only some are measured, and the others lie on lines between these."""
    if not faults.filled_in_poses or len(pose) == 0:
        return pose
    some = np.arange(0, len(pose), faults.filled_in_poses)
    some = np.append(some, len(pose) - 1)
    whole = np.column_stack([pose[:, :2], np.unwrap(pose[:, 2])])
    return np.column_stack([np.interp(stamp_s, stamp_s[some], axis[some]) for axis in whole.T])


def resting(ride: Ride, time_s: Array) -> Array:
    """Whether the wheels stand still from 0.2 s before to 0.2 s after the times."""
    change = ride.angles(time_s + 0.2) - ride.angles(time_s - 0.2)
    return np.asarray(np.abs(change).max(axis=0) < 1e-3)


def few_of_each_stop(rests: Array, most: int) -> Array:
    """Keeps at most so many poses of each rest, from its middle."""
    kept = np.zeros(len(rests), dtype=bool)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], rests.astype(int), [0]])))
    for begin, end in edges.reshape(-1, 2):
        first = max(begin, (begin + end - most) // 2)
        kept[first : min(end, first + most)] = True
    return kept


def seen(setting: Setting, ride: Ride, taken_s: Array, random: Random) -> Array:
    """Which of the poses the reference delivers: not while it is blind, in gaps, while moving."""
    reference = setting.reference
    begin, end = taken_s[0], taken_s[-1]
    kept = taken_s - begin >= reference.blind_s
    if reference.gaps_a_minute:
        for _ in range(max(1, random.poisson(reference.gaps_a_minute * (end - begin) / 60))):
            gap = random.uniform(begin + 2, max(begin + 2, end - 2))
            kept &= (taken_s < gap) | (taken_s > gap + random.uniform(*reference.gap_s))
    if reference.at_stops_only:
        kept &= few_of_each_stop(resting(ride, taken_s), int(random.integers(1, 6)))
    return np.asarray(kept)


def perfect(setting: Setting, ride: Ride, shown_s: Array, jumps: list[Jump]) -> Array:
    """What a reference without noise shows of the robot at the given true times."""
    reference = setting.reference
    if setting.faults.jump_of != "reference":
        jumps = []
    when = np.concatenate([shown_s, [jump.time_s for jump in jumps]])
    pose = filtered(lambda t: tracked(ride.poses(t), reference), when, reference.filter_s)
    for i, jump in enumerate(jumps, start=len(shown_s)):
        pose = with_frame_moved(pose, when, jump, pose[i])
    pose = pose[: len(shown_s)]
    if setting.recording.start == "origin":
        begin = tracked(ride.poses(np.array([ride.begin_s])), reference)
        pose = from_start(pose, begin[0])
    return pose


def follow(
    setting: Setting,
    ride: Ride,
    when: tuple[Array, Array],
    delay_s: float,
    jumps: list[Jump],
    random: Random,
) -> Poses:
    """The measured poses of one run, taken and stamped at the times `when`, in a good frame."""
    taken, stamp = when
    shown = taken - delay_s - setting.reference.clock_rate * (taken - ride.begin_s)
    clean = perfect(setting, ride, shown, jumps)
    pose, bad, corrections = measured(setting, clean, stamp, random)
    kept = seen(setting, ride, taken, random)
    return Poses(taken[kept], stamp[kept], pose[kept], clean[kept], bad[kept], corrections)


def in_columns(pose: Array, setting: Setting) -> Array:
    """Poses as they stand in the columns of the log: frame, range of headings, units."""
    faults = setting.faults
    x, y, heading = pose.T
    if faults.heading_clockwise:
        heading = -heading
    if faults.mirrored:
        y, heading = -y, -heading
    if faults.compass:
        heading = pi / 2 - heading
    if setting.recording.wrap:
        heading = np.arctan2(np.sin(heading), np.cos(heading))
    length = 1000.0 if faults.mm_as_m else 1.0
    angle = 180 / pi if faults.deg_as_rad else 1.0
    return np.column_stack([x * length, y * length, heading * angle])


def pose_times(
    setting: Setting, ride: Ride, ticks_taken_s: Array, ticks_stamp_s: Array, random: Random
) -> tuple[Array, Array]:
    """When poses are taken, and their stamps."""
    recording = setting.recording
    if recording.layout == "same":
        each = max(1, round(recording.tick_rate_hz / recording.reference_rate_hz))
        return ticks_taken_s[::each], ticks_stamp_s[::each]
    rate = recording.reference_rate_hz
    taken = times(ride, rate, min(recording.tick_jitter, 0.5), random.uniform(0, 1), random)
    return taken, stamps(taken, ride, recording.stamp_noise_s, rate, random)
