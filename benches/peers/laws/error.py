"""The error of a prediction along a run, START fitted as `umbmark compare` fits it.

START is fitted to the first places of a run by generalised least squares: each has the noise of its
poses, and what wheels usually gather until then. The check in `study.py` holds the result against
the command.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from drives import Array, Run, placed
from increments import blocks_of, means
from predicted import Fitted

HEADING_PER_METRE, HEADING_PER_RADIAN, FORWARD_PER_METRE = 1.5e-3, 1e-3, 3e-4
"""Usual noise of wheels, per square root."""
ENOUGH = (1e-3, 5e-4)
"""The first place alone is START where its mean is as sure as this [m, rad]."""
LEAST = 1e-4
"""No pose is taken for better than this [m, rad]."""


@dataclass(frozen=True)
class PoseNoise:
    """Noise of single poses."""

    position_m: float
    heading_rad: float


Prediction = Callable[[Run], Array]
"""Poses of the tracked point at the rows that have a pose."""


def weights_of(own: Array, step: Array) -> Array:
    """How much each place says of START: a random walk seen with noise, by least squares."""
    walk = np.concatenate([[0.0], step[1:]]).cumsum()
    covariance = np.minimum.outer(walk, walk) + np.diag(own)
    solved = np.linalg.solve(covariance, np.ones(len(own)))
    return np.asarray(solved / solved.sum())


def start_weights(
    predicted: Array, counts: Array, noise: PoseNoise, most: int = 60
) -> tuple[Array, Array]:
    """Weights of the first places for the position and for the heading of START."""
    position, heading = (
        max(sd, LEAST) ** 2 / counts[:most] for sd in (noise.position_m, noise.heading_rad)
    )
    alone = np.zeros(len(position))
    alone[0] = 1.0
    if position[0] <= ENOUGH[0] ** 2 and heading[0] <= ENOUGH[1] ** 2:
        return alone, alone
    moved = np.diff(predicted[: len(position)], axis=0, prepend=predicted[:1])
    way, turned = np.hypot(moved[:, 0], moved[:, 1]), np.abs(moved[:, 2])
    turning = HEADING_PER_METRE**2 * way + HEADING_PER_RADIAN**2 * turned
    aside = (FORWARD_PER_METRE**2 + turning.cumsum() * way.cumsum()) * way
    return weights_of(position, aside), weights_of(heading, turning)


def squares(run: Run, predicted: Array, noise: PoseNoise, wheelbase_m: float) -> Array:
    """Squared distances of the places of a run from a prediction, without the first [m²]."""
    blocks = blocks_of(run, wheelbase_m)
    own, true = means(predicted, blocks), means(run.measured, blocks)
    counts = np.array([len(block) for block in blocks], dtype=float)
    position, heading = start_weights(own, counts, noise)
    first = len(position)
    turn = float(heading @ (true - own)[:first, 2])
    turned = placed(np.array([0.0, 0.0, turn]), own)
    shift = position @ (true - turned)[:first, :2]
    left = true[:, :2] - turned[:, :2] - shift
    return np.asarray((left[1:] ** 2).sum(axis=1))


def rms_m(runs: Sequence[Run], predict: Prediction, noise: PoseNoise, fitted: Fitted) -> float:
    """Root mean square distance along some runs [m]."""
    wheelbase_m = fitted.robot.wheelbase_m
    all_squares = [squares(run, predict(run), noise, wheelbase_m) for run in runs]
    return float(np.sqrt(np.concatenate(all_squares).mean()))
