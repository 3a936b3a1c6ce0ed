"""True motion: what wheels that turn by known angles do to a body that is not as believed.

Runs lie side by side in the last axis; a `Stretch` holds the steps of one control period in the
axis before. Causes change a stretch in three places, in this order: the travel of each wheel, the
turn that follows from both, the motion of the body. A fourth place is what the encoders count.
"""

from dataclasses import dataclass, field

import numpy as np
from robot import Array, Robot

RESTING_RAD_S = 0.02
"""Turn rates of the body below this are no turn."""
SETTLED_M = 5e-3
"""A turn after so much way is another turn."""


@dataclass
class Stretch:
    """Some steps of all runs.

    Shapes: W = wheels (left, right) x steps x runs, S = steps x runs, R = runs.
    """

    step_s: float
    time_s: Array
    """[steps x 1] time since the run began, at the middle of each step."""
    rate: Array
    """[W, rad/s] of the wheels."""
    acceleration: Array
    """[W, rad/s^2] of the wheels."""
    angle: Array
    """[W, rad] of the wheels since START, at the middle of each step."""
    rolled: Array
    """[W, m] rim travel by the nominal radius."""
    v: Array
    """[S, m/s] nominal speed of the centre."""
    w: Array
    """[S, rad/s] nominal turn rate."""
    angular_acceleration: Array
    """[S, rad/s^2] nominal."""
    distance: Array
    """[S, m] nominal distance driven by the centre since START."""
    since_turn: Array
    """[S, m] the same since the last turn on the spot (or START)."""
    last_turn: Array
    """[R] sense of the last turn on the spot: +1 left, -1 right, 0 before the first."""
    on_the_spot: Array
    """[S] 1 while turning on the spot, else 0."""
    room: Array
    """[2 x R, m] true position at the beginning of the stretch."""

    travel: Array
    """[W, m] true travel of each wheel; causes change it."""
    counted: Array
    """[W, rad] angle that the encoders count; causes change it."""
    turn: Array = field(default_factory=lambda: np.empty(0))
    """[S, rad] true turn of each step; causes change it."""
    heading: Array = field(default_factory=lambda: np.empty(0))
    """[S, rad] true heading at the middle of each step, before causes that act on the body."""
    forward: Array = field(default_factory=lambda: np.empty(0))
    """[S, m] true travel of the centre along the heading; causes change it."""
    sideways: Array = field(default_factory=lambda: np.empty(0))
    """[S, m] to the left; causes change it."""
    drift: Array = field(default_factory=lambda: np.empty(0))
    """[2 x S, m] along the axes of the room; causes change it."""

    @property
    def rolled_by_centre(self) -> Array:
        """[S, m] nominal distance of the centre in each step, never negative."""
        return np.abs(self.v) * self.step_s


class Cause:
    """Something that makes a robot other than believed. Each changes what concerns it and leaves
    the rest.
    """

    def wheels(self, s: Stretch) -> None:
        """Change `s.travel`."""

    def turns(self, s: Stretch) -> None:
        """Change `s.turn`."""

    def body(self, s: Stretch) -> None:
        """Change `s.turn`, `s.forward`, `s.sideways`, `s.drift`."""

    def encoders(self, s: Stretch) -> None:
        """Change `s.counted`."""


class TrueMotion:
    """The true poses of runs side by side."""

    def __init__(self, robot: Robot, causes: list[Cause], runs: int) -> None:
        """All runs at START, at rest."""
        self.robot = robot
        self.causes = causes
        self.pose = np.zeros((3, runs))
        self.time_s = 0.0
        self.rate = np.zeros((2, runs))
        self.angle = np.zeros((2, runs))
        self.distance = np.zeros(runs)
        self.since_turn = np.zeros(runs)
        self.last_turn = np.zeros(runs)
        self.turned = np.zeros(runs)

    def stretch(self, rate: Array, step_s: float) -> Stretch:
        """The steps with the given wheel rates [W], before any cause."""
        robot = self.robot
        before = np.concatenate([self.rate[:, None], rate[:, :-1]], axis=1)
        acceleration = (rate - before) / step_s
        rolled = rate * (robot.radius_m * step_s)
        v = robot.radius_m * 0.5 * (rate[0] + rate[1])
        w = robot.radius_m / robot.wheelbase_m * (rate[1] - rate[0])
        centre = np.abs(v) * step_s
        done = np.cumsum(centre, axis=0) - 0.5 * centre
        turning = np.abs(w) * robot.wheelbase_m > 4.0 * np.abs(v)
        on_the_spot = (turning & (np.abs(w) > RESTING_RAD_S)).astype(np.float64)
        return Stretch(
            step_s=step_s,
            time_s=self.time_s + step_s * np.arange(0.5, rate.shape[1], dtype=np.float64)[:, None],
            rate=rate,
            acceleration=acceleration,
            angle=self.angle[:, None] + np.cumsum(rate, axis=1) * step_s - 0.5 * rate * step_s,
            rolled=rolled,
            v=v,
            w=w,
            angular_acceleration=robot.radius_m
            / robot.wheelbase_m
            * (acceleration[1] - acceleration[0]),
            distance=self.distance + done,
            since_turn=self.since_turn + done,
            last_turn=self.last_turn,
            on_the_spot=on_the_spot,
            room=self.pose[:2],
            travel=rolled.copy(),
            counted=rate * step_s,
        )

    def advance(self, rate: Array, step_s: float) -> Stretch:
        """Move by the given wheel rates [wheels x steps x runs, rad/s], each held for `step_s`."""
        s = self.stretch(rate, step_s)
        for cause in self.causes:
            cause.encoders(s)
            cause.wheels(s)
        s.turn = (s.travel[1] - s.travel[0]) / self.robot.wheelbase_m
        for cause in self.causes:
            cause.turns(s)
        s.heading = self.pose[2] + np.cumsum(s.turn, axis=0) - 0.5 * s.turn
        s.forward = 0.5 * (s.travel[0] + s.travel[1])
        s.sideways = np.zeros_like(s.forward)
        s.drift = np.zeros((2, *s.forward.shape))
        for cause in self.causes:
            cause.body(s)
        self.move(s)
        return s

    def move(self, s: Stretch) -> None:
        """Chain the arcs of a stretch."""
        heading = self.pose[2] + np.cumsum(s.turn, axis=0)
        middle = heading - 0.5 * s.turn
        shortening = np.sinc(s.turn / (2 * np.pi))
        forward, sideways = s.forward * shortening, s.sideways * shortening
        x = forward * np.cos(middle) - sideways * np.sin(middle) + s.drift[0]
        y = forward * np.sin(middle) + sideways * np.cos(middle) + s.drift[1]
        self.pose = np.stack([self.pose[0] + x.sum(0), self.pose[1] + y.sum(0), heading[-1]])
        self.time_s += s.step_s * s.rate.shape[1]
        self.rate = s.rate[:, -1]
        self.angle = self.angle + s.rate.sum(axis=1) * s.step_s
        driven = s.rolled_by_centre.sum(axis=0)
        self.distance = self.distance + driven
        turned = s.on_the_spot[-1] > 0
        self.since_turn = np.where(turned, 0.0, self.since_turn + driven)
        # A servo that settles turns back a little: the sense is that of the whole turn.
        gone = self.since_turn > SETTLED_M
        self.turned = np.where(gone, 0.0, self.turned) + np.where(
            turned, s.w.sum(0) * s.step_s, 0.0
        )
        self.last_turn = np.where(turned, np.sign(self.turned), self.last_turn)
