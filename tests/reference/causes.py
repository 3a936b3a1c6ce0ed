"""The causes on the true side and at the encoders, one law each; typical sizes are in catalogue.py.

The laws are written from their descriptions, not from the tool's code.
"""

from dataclasses import dataclass
from math import acos, sin, sqrt

import numpy as np
from motion import Cause, Stretch
from robot import Array


@dataclass
class WheelDiameterRatio(Cause):
    """s_R <- s_R 2 e_d/(1 + e_d), s_L <- s_L 2/(1 + e_d); `e_d` = D_R/D_L."""

    e_d: float | Array

    def wheels(self, s: Stretch) -> None:
        s.travel[0] *= 2 / (1 + self.e_d)
        s.travel[1] *= 2 * self.e_d / (1 + self.e_d)


@dataclass
class Wheelbase(Cause):
    """turn <- turn / e_b; `e_b` = effective / nominal wheelbase."""

    e_b: float | Array

    def turns(self, s: Stretch) -> None:
        s.turn /= self.e_b


@dataclass
class Scale(Cause):
    """s_L <- e_s s_L, s_R <- e_s s_R; `e_s` = mean true / nominal wheel diameter."""

    e_s: float | Array

    def wheels(self, s: Stretch) -> None:
        s.travel *= self.e_s


@dataclass
class Crab(Cause):
    """The centre moves at `angle_rad` (left positive) to the heading."""

    angle_rad: float

    def body(self, s: Stretch) -> None:
        s.sideways += np.sin(self.angle_rad) * s.forward
        s.forward *= np.cos(self.angle_rad)


@dataclass
class WheelEccentricity(Cause):
    """ds <- ds + e cos(angle + phase) dangle: radius R + e cos; `eccentricity_m`, `phase_rad`; left
    or right `wheel`.
    """

    eccentricity_m: float
    phase_rad: float
    wheel: int

    def wheels(self, s: Stretch) -> None:
        i = self.wheel
        s.travel[i] += (
            self.eccentricity_m * np.cos(s.angle[i] + self.phase_rad) * s.rate[i] * s.step_s
        )


@dataclass
class TurnSlip(Cause):
    """turn <- turn (1 - `share`) in turns on the spot."""

    share: float

    def turns(self, s: Stretch) -> None:
        s.turn *= 1 - self.share * s.on_the_spot


@dataclass
class TurnSlipRate(Cause):
    """turn <- turn (1 - k |w|); `k_s_per_rad`, w the nominal turn rate."""

    k_s_per_rad: float

    def turns(self, s: Stretch) -> None:
        s.turn *= 1 - self.k_s_per_rad * np.abs(s.w)


@dataclass
class SpeedSlip(Cause):
    """ds <- ds (1 - k |v_w|) with the rim speed v_w of each wheel; `k_s_per_m`; of the left, right
    or both `wheels`.
    """

    radius_m: float
    k_s_per_m: float
    which: tuple[int, ...]

    def wheels(self, s: Stretch) -> None:
        for i in self.which:
            s.travel[i] *= 1 - self.k_s_per_m * self.radius_m * np.abs(s.rate[i])


@dataclass
class AccelerationSlip(Cause):
    """ds <- ds (1 - c a), a = d|v_w|/dt of each wheel's rim: less when pulling, more when braking;
    `c_s2_per_m`.
    """

    radius_m: float
    c_s2_per_m: float

    def wheels(self, s: Stretch) -> None:
        a = self.radius_m * s.acceleration * np.sign(s.rate)
        between = s.rate - 0.5 * s.acceleration * s.step_s
        s.travel -= self.c_s2_per_m * a * self.radius_m * s.step_s * between


@dataclass
class DirectionDependentWheelbase(Cause):
    """turn <- turn / (1 + `share` sign(w)): wheelbase b(1 + share) in left turns, b(1 - share) in
    right ones.
    """

    share: float

    def turns(self, s: Stretch) -> None:
        s.turn /= 1 + self.share * np.sign(s.w)


def released(s: Stretch, length_m: float) -> Array:
    """The share of a kick that is given off in each step: exp(-d/length)/length per metre since the
    last turn.
    """
    return s.rolled_by_centre * np.exp(-s.since_turn / length_m) / length_m


@dataclass
class CasterKick(Cause):
    """Heading step `angle_rad` in the sense of the last turn, given off over `length_m` after it;
    none on leg 1.
    """

    angle_rad: float
    length_m: float

    def body(self, s: Stretch) -> None:
        s.turn += self.angle_rad * s.last_turn * (1 - s.on_the_spot) * released(s, self.length_m)


@dataclass
class LegKick(Cause):
    """Heading step `angle_rad` of constant sense at the start of every leg, given off over
    `length_m`.
    """

    angle_rad: float
    length_m: float

    def body(self, s: Stretch) -> None:
        s.turn += self.angle_rad * (1 - s.on_the_spot) * released(s, self.length_m)


class Backlash(Cause):
    """Play `play_m` at the rim between encoder and wheel: the wheel stays until it is taken up;
    engaged forward at START.
    """

    def __init__(self, runs: int, play_m: float) -> None:
        """No wheel has moved."""
        self.play_m = play_m
        self.motor = np.zeros((2, runs))
        self.rim = np.zeros((2, runs))

    def wheels(self, s: Stretch) -> None:
        for k in range(s.travel.shape[1]):
            self.motor = self.motor + s.travel[:, k]
            rim = np.clip(self.rim, self.motor, self.motor + self.play_m)
            s.travel[:, k] = rim - self.rim
            self.rim = rim


@dataclass
class FloorDrift(Cause):
    """The robot slides by `drift_m_per_m` of its travel towards `direction_rad` of the room (slope
    or nap of a carpet).
    """

    drift_m_per_m: float
    direction_rad: float

    def body(self, s: Stretch) -> None:
        slide = self.drift_m_per_m * s.rolled_by_centre
        s.drift[0] += slide * np.cos(self.direction_rad)
        s.drift[1] += slide * np.sin(self.direction_rad)


@dataclass
class FloorSlopeYaw(Cause):
    """Heading turns by y sin(heading - direction) per metre; `yaw_rad_per_m`, `direction_rad`."""

    yaw_rad_per_m: float
    direction_rad: float

    def body(self, s: Stretch) -> None:
        s.turn += self.yaw_rad_per_m * np.sin(s.heading - self.direction_rad) * s.rolled_by_centre


@dataclass
class DiameterDrift(Cause):
    """E_d grows by `ratio_per_m` of distance driven in the run, split between the wheels."""

    ratio_per_m: float

    def wheels(self, s: Stretch) -> None:
        d = self.ratio_per_m * s.distance
        s.travel[0] *= 1 - d / 2
        s.travel[1] *= 1 + d / 2


@dataclass
class CentripetalLoad(Cause):
    """Radii R_R (1 - c v w), R_L (1 + c v w): the outer tyre is pressed; `c_s2_per_m`."""

    c_s2_per_m: float

    def wheels(self, s: Stretch) -> None:
        c = self.c_s2_per_m * s.v * s.w
        s.travel[0] *= 1 + c
        s.travel[1] *= 1 - c


@dataclass
class MissedCounts(Cause):
    """The right encoder loses `share` of its counts while faster than `threshold_m_s`."""

    radius_m: float
    share: float
    threshold_m_s: float

    def encoders(self, s: Stretch) -> None:
        fast = self.radius_m * np.abs(s.rate[1]) > self.threshold_m_s
        s.counted[1] *= 1 - self.share * fast


def bump_travel(height_m: float, radius_m: float) -> float:
    """Extra path of a wheel's centre over a thin edge: 2R(psi - sin psi), cos psi = 1 - h/R."""
    psi = acos(1 - height_m / radius_m)
    return 2 * radius_m * (psi - sin(psi))


class Bumps(Cause):
    """Each wheel meets edges `height_m` high, `rate_per_m` of its travel; each costs D = 2R(psi -
    sin psi) of it.
    """

    def __init__(self, places_m: Array, radius_m: float, height_m: float) -> None:
        """`places_m` [wheels x runs x bumps] by rim travel of each wheel; infinite where there is
        none.
        """
        self.lost_m = bump_travel(height_m, radius_m)
        self.length_m = self.lost_m + 2 * sqrt(height_m * (2 * radius_m - height_m))
        self.places_m = places_m[:, None]
        self.travelled = np.zeros(places_m.shape[:2])

    def wheels(self, s: Stretch) -> None:
        ends = self.travelled[:, None] + np.cumsum(np.abs(s.rolled), axis=1)
        starts = np.concatenate([self.travelled[:, None], ends[:, :-1]], axis=1)
        s.travel -= np.sign(s.rolled) * (self.lost_until(ends) - self.lost_until(starts))
        self.travelled = ends[:, -1]

    def lost_until(self, travelled: Array) -> Array:
        """[W, m] what the bumps have cost when a wheel has rolled so far."""
        passed = np.clip((travelled[..., None] - self.places_m) / self.length_m, 0.0, 1.0)
        return np.asarray(self.lost_m * passed.sum(axis=-1), dtype=np.float64)


class WheelNoise(Cause):
    """var s_w = k^2 |s_w|, independent from one control period to the next (or as the draws given
    are); `k_sqrt_m`.
    """

    def __init__(self, draws: Array, k_sqrt_m: float) -> None:
        """`draws` [periods x wheels x runs] of unit variance."""
        self.k_sqrt_m = k_sqrt_m
        self.draws = iter(draws)

    def wheels(self, s: Stretch) -> None:
        spread = self.k_sqrt_m * np.sqrt(np.abs(s.rolled) / s.rolled.shape[1])
        s.travel += next(self.draws)[:, None] * spread


@dataclass
class TurnLossAtRamps(Cause):
    """Outside: turn <- turn (1 - `share`) while the turn rate changes by more than 0.4 rad/s^2,
    either way.
    """

    share: float

    def turns(self, s: Stretch) -> None:
        s.turn *= 1 - self.share * (np.abs(s.angular_acceleration) > 0.4)


@dataclass
class SecondHarmonicYaw(Cause):
    """Outside: heading turns by y sin(2 (heading - direction)) per metre; `yaw_rad_per_m`,
    `direction_rad`.
    """

    yaw_rad_per_m: float
    direction_rad: float

    def body(self, s: Stretch) -> None:
        wave = np.sin(2 * (s.heading - self.direction_rad))
        s.turn += self.yaw_rad_per_m * wave * s.rolled_by_centre


@dataclass
class WarmUpYaw(Cause):
    """Outside: heading turns by y exp(-t/T) per metre, t since the run began; `yaw_rad_per_m`,
    `time_s`.
    """

    yaw_rad_per_m: float
    time_s: float

    def body(self, s: Stretch) -> None:
        s.turn += self.yaw_rad_per_m * np.exp(-s.time_s / self.time_s) * s.rolled_by_centre


@dataclass
class RoomScale(Cause):
    """Outside: forward <- forward (1 + k x), x along the room from START; `k_per_m`."""

    k_per_m: float

    def body(self, s: Stretch) -> None:
        s.forward *= 1 + self.k_per_m * s.room[0]


@dataclass
class SlideAfterTurn(Cause):
    """Outside: the robot slides sideways by a exp(-d/l) per metre, d since the last turn, in its
    sense; `slide_m_per_m`.
    """

    slide_m_per_m: float
    length_m: float

    def body(self, s: Stretch) -> None:
        share = s.last_turn * (1 - s.on_the_spot) * np.exp(-s.since_turn / self.length_m)
        s.sideways += self.slide_m_per_m * share * s.rolled_by_centre


@dataclass
class TyreSeam(Cause):
    """Outside: ds_L <- ds_L (1 + a cos(3 angle_L + phase)): three seams round the left tyre;
    `share`, `phase_rad`.
    """

    share: float
    phase_rad: float

    def wheels(self, s: Stretch) -> None:
        s.travel[0] *= 1 + self.share * np.cos(3 * s.angle[0] + self.phase_rad)
