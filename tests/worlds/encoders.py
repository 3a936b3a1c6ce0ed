"""The rows that the robot writes: time stamps and tick counts."""

from dataclasses import dataclass
from math import ceil

import numpy as np
from physics import STEP_S, Track
from plans import Random
from setting import Array, Setting


@dataclass(frozen=True)
class Ride:
    """One run of a track, and the part of it that is recorded."""

    track: Track
    run: int
    begin_s: float
    """Since the robot was switched on, as is `end_s`."""
    end_s: float

    def poses(self, time_s: Array) -> Array:
        """True poses [n x 3] of the axle's centre."""
        return at(self.track.pose[:, self.run], time_s).T

    def angles(self, time_s: Array) -> Array:
        """Wheel angles [2 x n] that the encoders see."""
        return at(self.track.counted[:, self.run], time_s)


@dataclass
class Ticks:
    """The rows of one run."""

    taken_s: Array
    """True times of the readings, since the robot was switched on."""
    stamp_s: Array
    """Time stamps, since the recording began."""
    counts: Array
    """[rows x 2] left, right."""


def at(values: Array, time_s: Array) -> Array:
    """Values [... x milliseconds] of a track at other times, between its steps."""
    steps = np.arange(values.shape[-1]) * STEP_S
    rows = [np.interp(time_s, steps, row) for row in values.reshape(-1, values.shape[-1])]
    return np.array(rows).reshape(*values.shape[:-1], len(time_s))


def times(ride: Ride, rate_hz: float, jitter: float, offset: float, random: Random) -> Array:
    """Times of readings at a rate; each is early or late by up to half of `jitter` periods."""
    count = max(2, ceil((ride.end_s - ride.begin_s) * rate_hz - offset))
    late = jitter * random.uniform(-0.5, 0.5, count)
    late[0] = 0.0
    return np.asarray(ride.begin_s + (np.arange(count) + offset + late) / rate_hz)


def stamps(taken_s: Array, ride: Ride, noise_s: float, rate_hz: float, random: Random) -> Array:
    """The time stamps of readings, in whole microseconds; noise never changes their order."""
    most = 0.2 / rate_hz
    noise = np.clip(noise_s * random.standard_normal(len(taken_s)), -most, most)
    return np.asarray(np.round(np.maximum(taken_s - ride.begin_s + noise, 0.0), 6))


def read_ticks(setting: Setting, ride: Ride, random: Random) -> Ticks:
    """The rows of a run: whole ticks, from a random place within the first one."""
    recording = setting.recording
    rate = recording.tick_rate_hz
    taken = times(ride, rate, min(recording.tick_jitter, 0.5), 0.0, random)
    phase = random.uniform(0, 1, (2, 1))
    counts = np.floor(ride.angles(taken) / setting.robot.tick_rad + phase) + recording.first_count
    stamp = stamps(taken, ride, recording.stamp_noise_s, rate, random)
    return Ticks(taken, stamp, counts.T)


def in_columns(counts: Array, setting: Setting) -> Array:
    """Counts as they stand in the columns of the log, with wheels exchanged or reversed."""
    faults = setting.faults
    sign = np.array([-1 if faults.left_reversed else 1, -1 if faults.right_reversed else 1])
    signed = counts * sign * np.array([1 + faults.left_extra_edges, 1])
    return np.asarray(signed[:, ::-1] if faults.exchanged else signed)
