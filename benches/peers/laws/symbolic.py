"""Symbolic regression of gplearn for each motion and each exposure.

Programs evolve on two thirds of the runs, by their correlation with the target (scale and offset
follow by least squares). The runs that are left choose among the best of each length.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from drives import VARIABLES, Array, Rows
from gplearn.fitness import make_fitness
from gplearn.functions import make_function
from gplearn.genetic import SymbolicRegressor
from increments import Increments
from predicted import MOTIONS, exposures
from validated import Gain, folds, gain, simplest

POPULATION, GENERATIONS, LEARNT_FROM = 1000, 12, 1500
CHOOSE = 0.3
"""Share of the runs that programs are chosen by, and do not evolve on."""
PARSIMONY = 0.002
"""Of correlation, for each node."""


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
    return np.asarray(np.nan_to_num(value, nan=0.0, posinf=0.0, neginf=0.0))


def evolved(data: Increments, motion: int, exposure: str) -> list[Any]:
    """The best programs of the last generation, of each length."""
    own = data.sample_parts(LEARNT_FROM)
    amount = exposures(own.features, motion)[exposure] * own.seconds
    regressor = SymbolicRegressor(
        population_size=POPULATION,
        generations=GENERATIONS,
        function_set=FUNCTIONS,
        metric=fitness(own, amount),
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
    regressor.fit(own.features, own.summed(own.moved[:, motion]))
    return front(regressor._programs[-1])


def fitness(data: Increments, amount: Array) -> Any:
    """How well sums of a program correlate with sums of motion, both freed of a constant rate."""
    constant = data.summed(amount)
    constant = constant / max(float(np.linalg.norm(constant)), 1e-12)

    def correlation(moved: Array, value: Array, _: Array) -> float:
        if len(moved) != len(amount):
            return 0.0  # gplearn tries two values first
        sums = data.summed(np.nan_to_num(value, nan=0.0, posinf=0.0, neginf=0.0) * amount)
        both = [one - constant * (constant @ one) for one in (sums, moved)]
        size = np.linalg.norm(both[0]) * np.linalg.norm(both[1])
        return float(abs(both[0] @ both[1]) / size) if 1e-12 < size < 1e12 else 0.0

    return make_fitness(function=correlation, greater_is_better=True)


def front(programs: list[Any]) -> list[Any]:
    """Programs that fit better than all shorter ones."""
    found: list[Any] = []
    for one in sorted(programs, key=lambda one: (one.length_, -one.raw_fitness_)):
        if not found or one.raw_fitness_ > found[-1].raw_fitness_:
            found.append(one)
    return found


def fitted_part(program: Any, exposure: str, data: Increments, motion: int) -> Part:
    """Size and offset of a program by least squares."""
    amount = exposures(data.features, motion)[exposure] * data.seconds
    columns = np.stack([amount * finite(program, data.features), amount], axis=1)
    target = data.summed(data.moved[:, motion])
    size, offset = np.linalg.lstsq(data.summed(columns), target, rcond=1e-9)[0]
    return Part(program, exposure, float(size), float(offset), motion)


def chosen(data: Increments, motion: int, rows: Rows) -> Part | None:
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
        gain(rest, motion, part.rate(rest.features) * rest.seconds) for part in parts
    ]
    best = simplest(gains)
    return None if best is None else parts[best]


def validated(data: Increments, motion: int, part: Part) -> Gain:
    """The gain of a program in runs left out, size and offset fitted to the others."""
    predicted = np.zeros(len(data.run))
    for learnt, out in folds(data.run):
        own = fitted_part(part.program, part.exposure, data.take(learnt), motion)
        rest = data.take(out)
        predicted[out] = own.rate(rest.features) * rest.seconds
    return gain(data, motion, predicted)


def learn(data: Increments) -> Law:
    """A program for each motion that one predicts in runs left out."""
    law = Law()
    names = np.random.default_rng(0).permutation(np.unique(data.run))
    rows = np.flatnonzero(~np.isin(data.run, names[: max(1, round(CHOOSE * len(names)))]))
    for motion in range(3):
        part = chosen(data, motion, rows)
        if part is not None and validated(data, motion, part).is_real:
            law.parts[motion] = fitted_part(part.program, part.exposure, data, motion)
    return law
