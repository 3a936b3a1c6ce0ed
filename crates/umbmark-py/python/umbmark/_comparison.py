"""Where models agree with measured runs, and where they do not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, TypeAlias

import msgspec

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed, options_of
from umbmark._result import Printed, Row
from umbmark._scores import Data, a_model, data_of
from umbmark._umbmark import Model

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Comparison(_documents.Comparison, Printed, frozen=True):
    """Models compared with measurements: which explain them, and where the others fail."""

    _of_row: ClassVar[tuple[str, ...]] = ("measured", "predicted")
    text: str

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


HalfOpen: TypeAlias = tuple[float | None, float | None]


class TrackComparison(_documents.TrackComparison, Printed, frozen=True):
    """Models compared with tracks: where on the way the error arises, and what it depends on."""

    text: str
    _words: ClassVar[Mapping[str, str]] = {"explains": "bool"}

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
    seed: Seed = 1,
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
        False-alarm rate: probability that a correct model is rejected.
    draws : int, default 999
        Simulated tests for the p-values.
    seed : int, numpy Generator, BitGenerator or SeedSequence, or None, default 1
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
    options = options_of(size, draws, seed)
    checked = [(name, a_model(model)) for name, model in models.items()]
    document, text = _umbmark.compare(data_of(data), checked, options, return_poses, threads)
    if msgspec.json.decode(document)["observed"] == "tracks":
        return TrackComparison._of(document, text=text)
    return Comparison._of(document, text=text)
