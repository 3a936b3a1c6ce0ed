"""Where models agree with measured runs, and where they do not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias

import msgspec

from umbmark import _umbmark
from umbmark._remains import Remains, Repeats
from umbmark._result import Interval, Record, Result, Row
from umbmark._scores import Data, data_of
from umbmark._setup import Setup, Taken
from umbmark._umbmark import Model

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Statistic(Record, frozen=True):
    """A statistic as measured and as a model predicts it, in m, rad or 1."""

    measured: float
    predicted: float
    p: float


class Contrast(Record, frozen=True):
    """A closure contrast of a square driven both ways: zero where the model is complete."""

    name: str
    unit: str
    value: float
    interval: Interval
    meaning: str


class OnCircle(Record, frozen=True):
    """End points of a direction beside the circle through START, in m and rad."""

    direction: str
    off_m: tuple[float, ...]
    mean_off_m: float
    mean_off_interval_m: Interval
    distance_m: float
    distance_by_heading_m: float | None
    angle_less_heading_rad: float | None
    angle_less_heading_interval_rad: Interval | None
    explained: bool


class Judged(Record, frozen=True):
    """How one model does: statistics by direction and quantity, and p of all together."""

    name: str
    explains: bool
    p: float
    noise: str
    rmse_m: float
    heading_rmse_rad: float | None
    statistics: dict[str, dict[str, Statistic]]
    sentences: tuple[str, ...]
    left_m: float | None
    repeats_m: Repeats | None
    remains: Remains | None


class Comparison(Result, frozen=True):
    """Models beside measurements: which explain them, and where the others fail.

    Attributes
    ----------
    observed : str
        What was compared.
    n_cw, n_ccw : int
        Numbers of runs.
    models : tuple of Judged
        In the order in which they were given.
    setup : Setup
        What was found of the data before anything was fitted: faults, clock and mounting of the
        reference, jumps, wrong poses, runs far from the others.
    remarks : tuple of str
        What else should be said.
    contrasts, circle
        What the closure of a square says.
    left_m : float or None
        Error that the model leaves which leaves least.
    repeats_m : Repeats or None
        How much of it is the same in every run of one path.
    remains : Remains or None
        The same in detail, with what chance there is.
    """

    observed: str
    n_cw: int
    n_ccw: int
    models: tuple[Judged, ...]
    setup: Setup
    remarks: tuple[str, ...]
    size: float
    draws: int
    seed: int
    version: str
    contrasts: tuple[Contrast, ...]
    circle: tuple[OnCircle, ...]
    left_m: float | None
    repeats_m: Repeats | None
    remains: Remains | None

    def table(self) -> list[Row]:
        """Give every statistic of every model, one dict a row."""
        return [
            {"model": model.name, "direction": direction, "quantity": quantity}
            | {key: getattr(told, key) for key in ("measured", "predicted", "p")}
            for model in self.models
            for direction, statistics in model.statistics.items()
            for quantity, told in statistics.items()
        ]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the p of every statistic of every model, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.comparison(self, ax)


class RootMeanSquare(Record, frozen=True):
    """Root mean square errors of positions in m and of headings in rad."""

    rmse_m: float | None
    heading_rmse_rad: float | None


HalfOpen: TypeAlias = tuple[float | None, float | None]


class Mean(Record, frozen=True):
    """A mean over runs with its interval, and the scatter of the runs."""

    mean: float | None
    interval: HalfOpen | None
    runs: int
    sd: float | None


class PartShare(Record, frozen=True):
    """Share of a part of the way in the squared error along it, and at its end."""

    position: float | None
    heading: float | None
    end: float | None


class Part(Record, frozen=True):
    """Error that a part of the way adds: ahead, to the left, and in heading."""

    forward_m: Mean
    sideways_m: Mean
    heading_rad: Mean
    name: str
    direction: str | None
    count: int
    share: PartShare


class Overall(Record, frozen=True):
    """Mean rate of an error over all of the way, and p of none at all."""

    mean: float | None
    interval: HalfOpen | None
    runs: int
    p: float | None


class Bin(Record, frozen=True):
    """Mean rate of an error where a quantity lies between two values, in a sense or in both."""

    mean: float | None
    interval: HalfOpen | None
    runs: int
    low: float
    high: float | None
    sense: float
    amount: float


class Against(Record, frozen=True):
    """Rate of an error against a quantity of the way."""

    rate: str
    covariate: str
    unit: str
    p: float | None
    bins: tuple[Bin, ...]


class JudgedAlong(Record, frozen=True):
    """How one model does along the way, and at its end.

    ``taken`` has the effects of the reference whose values were taken from the motion; ``reasons``
    say why the model does not explain the tracks, a sentence each.
    """

    name: str
    explains: bool
    p: float | None
    tests: int
    along: RootMeanSquare
    end: RootMeanSquare
    parts: dict[str, tuple[Part, ...]]
    overall: dict[str, Overall]
    against: tuple[Against, ...]
    sentences: tuple[str, ...]
    taken: tuple[Taken, ...]
    reasons: tuple[str, ...]
    left_m: float | None
    repeats_m: Repeats | None
    remains: Remains | None


class TrackComparison(Result, frozen=True):
    """Models beside tracks: where on the way their error is made, and what it depends on.

    Attributes
    ----------
    observed : str
        "tracks".
    n_cw, n_ccw, n_other : int
        Numbers of runs.
    poses : int
        Number of observations.
    models : tuple of JudgedAlong
        In the order in which they were given.
    remarks : tuple of str
        What else should be said.
    setup : Setup
        What was found of the data before anything was fitted: faults, clock and mounting of the
        reference, jumps, wrong poses, runs far from the others.
    left_m : float or None
        Error that the model leaves which leaves least.
    repeats_m : Repeats or None
        How much of it is the same in every run of one path.
    remains : Remains or None
        The same in detail, with what chance there is.
    """

    observed: str
    n_cw: int
    n_ccw: int
    n_other: int
    poses: int
    models: tuple[JudgedAlong, ...]
    remarks: tuple[str, ...]
    setup: Setup
    size: float
    version: str
    left_m: float | None
    repeats_m: Repeats | None
    remains: Remains | None

    def table(self) -> list[Row]:
        """Give the errors of each model, one dict a row."""
        return [
            {
                "model": model.name,
                "explains": model.explains,
                "p": model.p,
                "rmse_m": model.along.rmse_m,
                "heading_rmse_rad": model.along.heading_rmse_rad,
                "end_rmse_m": model.end.rmse_m,
                "end_heading_rmse_rad": model.end.heading_rmse_rad,
            }
            for model in self.models
        ]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the errors of each model along the way and at its end, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.track_comparison(self, ax)


def compare(
    data: Data,
    models: Mapping[str, Model] | Sequence[Model] | Model | None = None,
    *,
    size: float = 0.05,
    draws: int = 999,
    seed: int = 1,
    return_poses: bool = False,
    threads: int = 0,
) -> Comparison | TrackComparison:
    """Hold models, with the values that they have, against measured runs.

    Parameters
    ----------
    data : Dataset or path-like
        The measurements.
    models : mapping of str to Model, sequence of Model, or Model, optional
        What to hold against it; the nominal robot, and E_d and E_b (on tracks E_s too) fitted to
        this data, where nothing is given.
    size : float, default 0.05
        Probability with which a right model is accused all the same.
    draws : int, default 999
        Simulated tests for the p-values.
    seed : int, default 1
        Seed of those.
    return_poses : bool, default False
        Whether to use return poses alone, even where the runs were observed on the way.
    threads : int, default 0
        Threads to use; 0 for all processors. No number depends on it.

    Returns
    -------
    Comparison or TrackComparison
        Of return poses, or of tracks where every run has one.

    Raises
    ------
    ValueError
        If there is nothing to predict, or a number is out of range.
    """
    if models is None:
        models = {}
    elif isinstance(models, Model):
        models = {"model": models}
    elif not isinstance(models, Mapping):
        models = {f"model {place}": model for place, model in enumerate(models, 1)}
    options = (size, draws, seed)
    document = _umbmark.compare(data_of(data), [*models.items()], options, return_poses, threads)
    if msgspec.json.decode(document)["observed"] == "tracks":
        return TrackComparison._of(document)
    return Comparison._of(document)
