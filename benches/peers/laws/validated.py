"""The one rule by which all peers keep what they learnt: it has to predict parts left out better.

Parts are quarters of runs. The error of a law in a part is that of the motion added up from its
beginning, as it is along a drive. A law of a motion is kept where the mean gain of the parts left
out is more than two standard errors above zero; among laws, the simplest within one standard error
of the best is taken.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from drives import Array, Rows
from increments import Increments

KEEPS, TIES = 2.0, 1.0
"""Standard errors."""
FOLDS = 5


@dataclass(frozen=True)
class Gain:
    """By how much less squared error parts have that were left out, each part on its own."""

    parts: Array

    @property
    def mean(self) -> float:
        """Over the parts."""
        return float(self.parts.mean())

    @property
    def standard_error(self) -> float:
        """Of the mean."""
        return float(self.parts.std(ddof=1) / np.sqrt(len(self.parts)))

    @property
    def is_real(self) -> bool:
        """Whether it is more than chance."""
        return self.mean > KEEPS * self.standard_error


def gain(data: Increments, motion: int, predicted: Array) -> Gain:
    """The gain over no law, where that much motion of each step is predicted."""
    moved = data.summed(data.moved[:, motion])
    less = moved**2 - (moved - data.summed(predicted)) ** 2
    return Gain(np.array([less[data.part == one].sum() for one in np.unique(data.part)]))


def folds(run: Rows) -> Iterator[tuple[Rows, Rows]]:
    """Rows to learn from and rows left out; whole runs are left out."""
    names = np.random.default_rng(0).permutation(np.unique(run))
    for left_out in np.array_split(names, min(FOLDS, len(names))):
        out = np.isin(run, left_out)
        yield np.flatnonzero(~out).astype(np.int64), np.flatnonzero(out).astype(np.int64)


def simplest(gains: Sequence[Gain]) -> int | None:
    """Of laws in the order of their length, the first that is as good as the best; or no law."""
    best = max(gains, key=lambda one: one.mean)
    for place, one in enumerate(gains):
        if one.is_real and one.mean >= best.mean - TIES * best.standard_error:
            return place
    return None
