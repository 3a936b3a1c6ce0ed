"""A Gaussian process of scikit-learn for each motion: ARD squares, noise, and a chosen exposure."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from drives import AT, VARIABLES, Array
from increments import Increments
from predicted import MOTIONS, exposures
from scipy.optimize import minimize
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from validated import Gain, folds, gain

TUNED_ON, LEARNT_FROM = 300, 1000
"""Steps that hyperparameters are tuned on, and steps that the process rests on."""
MERGED = (1, 5)
"""So many steps are one to learn from: short ones show more, long ones have less noise."""
MOST_STEPS = 50
"""Of the search for hyperparameters."""
LEAST_SHARE = 0.3
"""Steps with less than this share of the median exposure say little of a law of it."""
ANGLES = [AT[name] for name in ("heading", "wheel_angle_left", "wheel_angle_right")]
OTHERS = [column for column in range(len(VARIABLES)) if column not in ANGLES]


def inputs(features: Array) -> Array:
    """Variables as an expert gives them to it: angles as sine and cosine."""
    angles = features[:, ANGLES]
    return np.concatenate([features[:, OTHERS], np.sin(angles), np.cos(angles)], axis=1)


@dataclass
class Part:
    """The law of one motion."""

    process: GaussianProcessRegressor
    exposure: str
    mean: Array
    scale: Array
    unit: float
    motion: int

    def rate(self, features: Array) -> Array:
        """Motion per second."""
        at = (inputs(features) - self.mean) / self.scale
        found = self.process.predict(at) * self.unit
        return np.asarray(found * exposures(features, self.motion)[self.exposure])


@dataclass
class Law:
    """Up to three motions; those without a law are absent."""

    parts: dict[int, Part] = field(default_factory=dict)

    def rates(self, features: Array) -> Array:
        """Motion that is added per second, [n x 3]."""
        found = np.zeros((len(features), 3))
        for motion, part in self.parts.items():
            found[:, motion] = part.rate(features)
        return found

    @property
    def terms(self) -> list[str]:
        """A process has no terms: the motions that it corrects."""
        return [MOTIONS[motion] for motion in self.parts]


def tuned(objective: Callable[..., Any], first: Array, bounds: Array) -> tuple[Array, float]:
    """Hyperparameters of the greatest likelihood, in not too many steps."""
    how: dict[str, Any] = {"jac": True, "bounds": bounds, "options": {"maxiter": MOST_STEPS}}
    found = minimize(objective, first, method="L-BFGS-B", **how)
    return found.x, float(found.fun)


def fitted_part(data: Increments, motion: int, exposure: str, known: Part | None) -> Part:
    """A process for one motion; with the hyperparameters of another where there is one."""
    amount = np.abs(exposures(data.features, motion)[exposure] * data.seconds)
    usable = np.flatnonzero(amount > LEAST_SHARE * np.median(amount))
    own = data.take(usable).sample(LEARNT_FROM if known else TUNED_ON)
    target = own.moved[:, motion] / (exposures(own.features, motion)[exposure] * own.seconds)
    at = inputs(own.features)
    if known:
        mean, scale, unit = known.mean, known.scale, known.unit
        process = GaussianProcessRegressor(known.process.kernel_, optimizer=None)
    else:
        mean, scale = at.mean(axis=0), np.maximum(at.std(axis=0), 1e-9)
        unit = float(target.std())
        squares = RBF(np.full(at.shape[1], 3.0), (0.05, 1e3))
        kernel = ConstantKernel(0.3, (1e-4, 1e2)) * squares + WhiteKernel(0.7, (1e-4, 1e1))
        process = GaussianProcessRegressor(kernel, optimizer=tuned, random_state=0)
    with warnings.catch_warnings():
        # A length at its bound means that the process does not depend on that variable.
        warnings.simplefilter("ignore", ConvergenceWarning)
        process.fit((at - mean) / scale, target / unit)
    return Part(process, exposure, mean, scale, unit, motion)


def validated(data: Increments, motion: int, part: Part, count: int) -> Gain:
    """The gain in runs left out, hyperparameters kept; so many steps are one to learn from."""
    predicted = np.zeros(len(data.run))
    for learnt, out in folds(data.run):
        own = fitted_part(data.take(learnt).merged(count), motion, part.exposure, part)
        rest = data.take(out)
        predicted[out] = own.rate(rest.features) * rest.seconds
    return gain(data, motion, predicted)


def learn(data: Increments) -> Law:
    """A process for each motion that one predicts in runs left out."""
    law = Law()
    for motion in range(3):
        tried = [
            (fitted_part(data.merged(count), motion, one, None), count)
            for one in ("metre", "second", "radian")
            for count in MERGED
        ]
        gains = [validated(data, motion, *one) for one in tried]
        best = int(np.argmax([one.mean for one in gains]))
        if gains[best].is_real:
            part, count = tried[best]
            law.parts[motion] = fitted_part(data.merged(count), motion, part.exposure, part)
    return law
