"""Symbolic regression of gplearn for each motion and each exposure.

Programs evolve on three quarters of the runs, by their correlation with the target (scale and
offset follow by least squares). The runs that are left choose among the last generation.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
from drives import VARIABLES, Array
from gplearn.functions import make_function
from gplearn.genetic import SymbolicRegressor
from increments import Increments
from predicted import MOTIONS, exposures
from validated import Gain, folds, gain, simplest

POPULATION, GENERATIONS, LEARNT_FROM = 1000, 15, 800
PARSIMONY = 0.002
"""Of correlation, for each node."""
BEST = 20
"""So many of the last generation are tried on the runs left out."""


def above(value: Array, threshold: Array) -> Array:
    """1 where a value is above a threshold."""
    return np.asarray(np.greater(value, threshold), dtype=float)


def decay(value: Array) -> Array:
    """exp(-|value|), bounded."""
    return np.asarray(np.exp(-np.minimum(np.abs(value), 50.0)))


FUNCTIONS = (
    *("add", "sub", "mul", "div", "sin", "cos", "abs"),
    make_function(function=above, name="above", arity=2),
    make_function(function=decay, name="decay", arity=1),
    make_function(function=np.tanh, name="tanh", arity=1),
)


@dataclass
class Part:
    """The law of one motion: offset and size times a program."""

    program: Any
    exposure: str
    size: float
    offset: float
    motion: int

    def rate(self, features: Array) -> Array:
        """Motion per second."""
        value = self.offset + self.size * finite(self.program, features)
        return np.asarray(value * exposures(features, self.motion)[self.exposure])


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
        """What it says, motion by motion."""
        return [f"{MOTIONS[m]} per {one.exposure}: {one.program}" for m, one in self.parts.items()]


def finite(program: Any, features: Array) -> Array:
    """The value of a program, zero where it has none."""
    value = np.broadcast_to(program.execute(features), len(features))
    return np.nan_to_num(value, nan=0.0, posinf=0.0, neginf=0.0)


def evolved(data: Increments, motion: int, exposure: str) -> list[Any]:
    """The best programs of the last generation, each once."""
    own = data.sample(LEARNT_FROM)
    rate = exposures(own.features, motion)[exposure]
    amount = rate * own.seconds
    usable = np.abs(amount) > 0.1 * np.median(np.abs(amount))
    amount = amount[usable]
    regressor = SymbolicRegressor(
        population_size=POPULATION,
        generations=GENERATIONS,
        function_set=FUNCTIONS,
        metric="pearson",
        stopping_criteria=1.0,
        parsimony_coefficient=PARSIMONY,
        const_range=(-5.0, 5.0),
        init_depth=(2, 5),
        p_crossover=0.7,
        p_subtree_mutation=0.1,
        p_hoist_mutation=0.05,
        p_point_mutation=0.1,
        feature_names=VARIABLES,
        random_state=0,
    )
    target = own.moved[usable, motion] / amount
    regressor.fit(own.features[usable], target, sample_weight=amount**2)
    last = sorted(regressor._programs[-1], key=lambda one: -one.fitness_)
    return list({str(one): one for one in last}.values())[:BEST]


def fitted_part(program: Any, exposure: str, data: Increments, motion: int) -> Part:
    """Size and offset of a program by least squares."""
    amount = exposures(data.features, motion)[exposure] * data.seconds
    columns = np.stack([amount * finite(program, data.features), amount], axis=1)
    size, offset = np.linalg.lstsq(columns, data.moved[:, motion], rcond=1e-9)[0]
    return Part(program, exposure, float(size), float(offset), motion)


def chosen(data: Increments, motion: int, rows: npt.NDArray[np.int64]) -> Part | None:
    """The program of any exposure that predicts best what it did not evolve on."""
    out = np.setdiff1d(np.arange(len(data.run)), rows)
    learnt, rest = data.take(rows), data.take(out)
    parts = [
        fitted_part(program, exposure, learnt, motion)
        for exposure in ("metre", "second", "radian")
        for program in evolved(learnt, motion, exposure)
    ]
    parts.sort(key=lambda part: part.program.length_)
    gains: list[Gain] = [
        gain(rest.moved[:, motion], part.rate(rest.features) * rest.seconds, rest.part)
        for part in parts
    ]
    best = simplest(gains)
    return None if best is None else parts[best]


def learn(data: Increments) -> Law:
    """A program for each motion that one predicts in runs left out."""
    law = Law()
    rows, _ = next(folds(data.run))
    for motion in range(3):
        part = chosen(data, motion, rows)
        if part is not None:
            law.parts[motion] = fitted_part(part.program, part.exposure, data, motion)
    return law
