"""Sparse regression of PySINDy: a library of polynomials, waves, steps and decays.

Two of its optimisers are asked, sequentially thresholded least squares and forward orthogonal
least squares; threshold, number of terms and optimiser are chosen by runs left out.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from drives import AT, Array
from increments import Increments
from predicted import MOTIONS, exposures
from pysindy.optimizers import FROLS, STLSQ
from validated import Gain, folds, gain, simplest

MOST_TERMS = 6
THRESHOLDS = (0.3, 0.5, 0.7)
"""Of sequential thresholding, as shares of the largest coefficient of a first solution."""
MOST_KEPT = 30
"""A solution with more terms than this is not sparse, and is left aside."""
RIDGE = 1e-2
LEARNT_FROM = 4000
PERIODS_S = np.geomspace(4, 50, 33)
PERIODS_M = np.geomspace(0.4, 8, 39)
"""Eight per cent apart."""
SCALES = (0.25, 0.5, 0.75)
"""Thresholds and knees stand at these shares of the largest value."""


@dataclass(frozen=True)
class Columns:
    """Functions of the variables; scales are those of the drives that are learnt from."""

    top: Array
    """The largest size of each variable."""

    def shapes(self, features: Array) -> Iterator[tuple[str, Array]]:
        """The functions before exposures, each with its name."""
        at = {name: features[:, column] for name, column in AT.items()}
        yield "1", np.ones(len(features))
        for name in ("speed", "turn_rate", "acceleration", "turn_acceleration"):
            value, top = at[name], max(self.top[AT[name]], 1e-9)
            yield name, value
            yield f"{name}^2", value**2
            yield f"abs({name})", np.abs(value)
            for share in SCALES:
                if name in ("speed", "turn_rate"):
                    size = np.abs(value)
                    yield f"(abs({name}) > {share * top:.3g})", (size > share * top).astype(float)
                    yield f"tanh(abs({name}) / {share * top:.3g})", np.tanh(size / (share * top))
                else:
                    yield f"({name} > {share * top:.3g})", (value > share * top).astype(float)
                    yield f"({name} < {-share * top:.3g})", (value < -share * top).astype(float)
        for name in ("heading", "wheel_angle_left", "wheel_angle_right"):
            for times in (1, 2, 3):
                yield f"sin({times} {name})", np.sin(times * at[name])
                yield f"cos({times} {name})", np.cos(times * at[name])
        for times in (1, 2):
            yield f"speed sin({times} heading)", np.abs(at["speed"]) * np.sin(times * at["heading"])
            yield f"speed cos({times} heading)", np.abs(at["speed"]) * np.cos(times * at["heading"])
        yield "x", at["x"]
        yield "y", at["y"]
        yield "x^2", at["x"] ** 2
        yield "x y", at["x"] * at["y"]
        yield "y^2", at["y"] ** 2
        for name, periods in (("time", PERIODS_S), ("distance", PERIODS_M)):
            yield name, at[name]
            yield f"{name}^2", at[name] ** 2
            for period in periods:
                phase = 2 * np.pi * at[name] / period
                yield f"sin(2 pi {name} / {period:.3g})", np.sin(phase)
                yield f"cos(2 pi {name} / {period:.3g})", np.cos(phase)
        for seconds in (10, 20, 40, 80):
            yield f"exp(-time / {seconds})", np.exp(-at["time"] / seconds)
        yield "since_turn", at["since_turn"]
        yield "last_turn", at["last_turn"]
        yield "last_turn since_turn", at["last_turn"] * at["since_turn"]
        yield "direction", at["direction"]

    def names(self, features: Array) -> list[str]:
        """A name for each column."""
        each = [name for name, _ in self.shapes(features[:1])]
        names = [f"per {per}: {name}" for per in exposures(features[:1], 0) for name in each]
        return [names[column] for column in np.flatnonzero(self.used(features))]

    def used(self, features: Array) -> npt.NDArray[np.bool_]:
        """Which pairs of exposure and shape are in the library: no waves for each radian."""
        each = [name for name, _ in self.shapes(features[:1])]
        pairs = [(per, name) for per in exposures(features[:1], 0) for name in each]
        return np.array([per != "radian" or "2 pi" not in name for per, name in pairs])

    def values(self, features: Array, motion: int) -> Array:
        """[n x columns], per second."""
        shapes = np.stack([value for _, value in self.shapes(features)], axis=1)
        each = exposures(features, motion).values()
        both = np.concatenate([one[:, None] * shapes for one in each], axis=1)
        return np.asarray(both[:, self.used(features)])


@dataclass
class Law:
    """Coefficients of the library, [columns x 3]."""

    columns: Columns
    coefficients: Array
    terms: list[str] = field(default_factory=list)

    def rates(self, features: Array) -> Array:
        """Motion that is added per second, [n x 3]."""
        found = np.zeros((len(features), 3))
        for motion in np.flatnonzero(self.coefficients.any(axis=0)):
            values = self.columns.values(features, int(motion))
            found[:, motion] = values @ self.coefficients[:, motion]
        return found


def paths(columns: Array, target: Array) -> list[npt.NDArray[np.int64]]:
    """Sets of columns that the optimisers propose, some of them empty, always as many."""
    size = np.maximum(np.linalg.norm(columns, axis=0), 1e-12)
    scaled = columns / size
    # The same inner products in as few rows as there are columns, and a little ridge, without which
    # FROLS refuses columns that depend on others.
    scaled_t = np.linalg.cholesky(scaled.T @ scaled + RIDGE**2 * np.eye(scaled.shape[1]))
    rotated = np.linalg.solve(scaled_t, scaled.T @ target)[:, None]
    rotated = rotated / max(float(np.linalg.norm(rotated)), 1e-12)
    scaled = scaled_t.T
    forward = FROLS(max_iter=MOST_TERMS, alpha=1e-9, unbias=False).fit(scaled, rotated)
    found = [np.flatnonzero(one[0]) for one in forward.history_[1:]]
    first = np.linalg.solve(scaled, rotated)
    for share in THRESHOLDS:
        threshold = share * float(np.abs(first).max())
        optimiser = STLSQ(threshold, alpha=1e-9, unbias=False, initial_guess=first.T)
        kept = np.flatnonzero(optimiser.fit(scaled, rotated).coef_[0])
        found.append(kept if len(kept) <= MOST_KEPT else kept[:0])
    return found


def solved(columns: Array, target: Array, chosen: npt.NDArray[np.int64]) -> Array:
    """Least squares with the chosen columns, zero for the others."""
    found = np.zeros(columns.shape[1])
    if len(chosen):
        size = np.maximum(np.linalg.norm(columns[:, chosen], axis=0), 1e-12)
        found[chosen] = np.linalg.lstsq(columns[:, chosen] / size, target, rcond=1e-9)[0] / size
    return found


def learn(data: Increments) -> Law:
    """The terms of each motion that predict runs left out."""
    sample = np.arange(len(data.run))
    if len(sample) > LEARNT_FROM:
        sample = np.sort(np.random.default_rng(0).choice(sample, LEARNT_FROM, replace=False))
    library = Columns(np.abs(data.features).max(axis=0))
    names = library.names(data.features)
    law = Law(library, np.zeros((len(names), 3)))
    for motion, kind in enumerate(MOTIONS):
        # The integral form: sums of columns against sums of motion.
        each = library.values(data.features, motion) * data.seconds[:, None]
        columns = data.summed(each)[sample]
        target = data.summed(data.moved[:, motion])[sample]
        whole = paths(columns, target)
        predicted = np.zeros((len(whole), len(each)))
        for learnt, out in folds(data.run):
            rows = np.isin(sample, learnt)
            own = paths(columns[rows], target[rows])
            for place, chosen in enumerate(own):
                values = solved(columns[rows], target[rows], chosen)
                predicted[place, out] = each[out] @ values
        order = sorted(range(len(whole)), key=lambda place: len(whole[place]))
        gains: list[Gain] = [gain(data, motion, predicted[place]) for place in order]
        best = simplest(gains)
        if best is not None:
            chosen = whole[order[best]]
            law.coefficients[:, motion] = solved(columns, target, chosen)
            law.terms += [f"{kind} {names[column]}" for column in chosen]
    return law
