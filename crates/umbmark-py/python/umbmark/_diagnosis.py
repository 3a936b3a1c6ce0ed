"""What a model is missing, and the loop that adds it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar

import msgspec

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed, names, options_of, pairs, real
from umbmark._explained import Explained
from umbmark._progress import Bar, Progress
from umbmark._result import Row
from umbmark._scores import Data, data_of, model_of
from umbmark._umbmark import Dataset, Model
from umbmark._unlisted import Unlisted

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Diagnosis(_documents.Diagnosis, Explained, frozen=True):
    """What a model is missing, how certain that is, and what this data cannot show."""

    unlisted: Unlisted | None
    data: Dataset
    text: str

    def table(self) -> list[Row]:
        """Give the ranking, one dict a row."""
        return [
            {
                "class": " or ".join(suspect.class_),
                "p_adjusted": suspect.p_adjusted,
                "f": suspect.f,
                "expected_drop": suspect.expected_drop,
                "certified": place < self.certified,
            }
            for place, suspect in enumerate(self.ranking)
        ]

    def _drawn(self, ax: Axes | None) -> Axes:
        from umbmark import _plots

        return _plots.diagnosis(self, ax)


class Fitted(_documents.Fitted, Explained, frozen=True):
    """A fit of a model: its numbers, and the model with them."""

    _of_row: ClassVar[tuple[str, ...]] = ("value", "standard_error", "interval")

    data: Dataset
    text: str

    def table(self) -> list[Row]:
        """Give the free parameters, one dict a row."""
        return [msgspec.structs.asdict(estimate) for estimate in self.fitted]

    def _drawn(self, ax: Axes | None) -> Axes:
        from umbmark import _plots

        return _plots.fitted(self, ax)


class Learnt(_documents.Learnt, Explained, frozen=True):
    """What was learnt, from the nominal robot to the model."""

    unlisted: Unlisted | None
    data: Dataset
    text: str

    def table(self) -> list[Row]:
        """Give the steps, one dict a row; ``by_floor_rmse_m`` where floors were left out."""
        keys = ("p_adjusted", "rmse_m", "heldout_rmse_m", "heldout_heading_rmse_rad", "aicc")
        by = [f"by_{condition.names[0]}_rmse_m" for condition in self.conditions]
        return [
            {"added": step.added or "nominal robot"}
            | {key: getattr(step, key) for key in keys}
            | dict(zip(by, step.elsewhere_rmse_m, strict=False))
            for step in self.steps
        ]

    def _drawn(self, ax: Axes | None) -> Axes:
        from umbmark import _plots

        return _plots.learnt(self, ax)


def diagnose(
    data: Data,
    model: Model | None = None,
    *,
    size: float = 0.05,
    draws: int = 999,
    seed: Seed = 1,
    return_poses: bool = False,
    threads: int = 0,
) -> Diagnosis:
    """Find which class of effects a model is missing, and what to measure next.

    Parameters
    ----------
    data : Dataset or path-like
        The measurements.
    model : Model, optional
        The model to question, its free effects fitted; E_d and E_b, on tracks E_s too, where none
        is given.
    size : float, default 0.05
        False-alarm rate: probability that a complete model is rejected.
    draws : int, default 999
        Simulated tests for p-values that have no closed form.
    seed : int, numpy Generator, BitGenerator or SeedSequence, or None, default 1
        Seed of those.
    return_poses : bool, default False
        Whether to use return poses alone, even where the runs were observed on the way.
    threads : int, default 0
        Threads to use; 0 for all processors. No number depends on it.

    Raises
    ------
    ValueError
        If there is nothing to diagnose, or a number is out of range.

    Examples
    --------
    >>> import umbmark
    >>> truth = umbmark.Model().add("wheel_noise", k_sqrt_m=0.0003)
    >>> truth = truth.add("floor_slope", drift_x=0.01)
    >>> umbmark.diagnose(umbmark.simulate(truth, reference_rate_hz=0)).verdict
    'missing_effect'
    """
    options = options_of(size, draws, seed)
    data = data_of(data)
    document, text, fitted = _umbmark.diagnose(
        data, model_of(model), options, return_poses, threads
    )
    return Diagnosis._of(document, model=fitted, data=data, text=text)


def fit(
    data: Data,
    model: Model | None = None,
    *,
    add: str | Sequence[str] = (),
    fix: str | Sequence[str] | Mapping[str, float] = (),
    bounds: Mapping[str, tuple[float | None, float | None]] | None = None,
    priors: Mapping[str, tuple[float, float]] | None = None,
    level: float = 0.95,
) -> Fitted:
    """Fit the free effects of a model to measured runs.

    Parameters
    ----------
    data : Dataset or path-like
        The measurements.
    model : Model, optional
        The model whose free effects are fitted; E_d and E_b, on tracks E_s too, where none is
        given.
    add : str or sequence of str
        Effects to add and fit too.
    fix : str, sequence of str, or mapping of str to float
        Parameters of free effects that are not fitted, "floor_slope.drift_y", at the values of the
        model or at those given. The model that is returned keeps them fixed.
    bounds : mapping of str to (low, high), optional
        Limits of parameters that the fit does not exceed, of which one may be None. A parameter
        that ends at a bound has no interval; ``known`` of the result says so.
    priors : mapping of str to (mean, sd), optional
        Earlier measurements of parameters with their standard deviations: each counts as one more
        measurement beside the runs. ``known`` says how far the runs alone are from them.
    level : float, default 0.95
        Probability with which the intervals hold.

    Raises
    ------
    ValueError
        If no parameter is free, there is none of that name, or the fit does not settle.

    Examples
    --------
    >>> import umbmark
    >>> truth = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=0.0003)
    >>> data = umbmark.simulate(truth, reference_rate_hz=0)
    >>> fitted = umbmark.fit(data, fix={"wheel_diameter_ratio.e_d": 1.0})
    >>> [estimate.parameter for estimate in fitted.fitted]
    ['e_b']
    >>> fitted = umbmark.fit(data, priors={"wheelbase.e_b": (1.0, 0.005)})
    >>> fitted.known[0].effect, fitted.ended.converged
    ('wheelbase', True)
    """
    data = data_of(data)
    held = (
        [(name, real(f'fix["{name}"]', value)) for name, value in fix.items()]
        if isinstance(fix, Mapping)
        else [(name, None) for name in names("fix", fix)]
    )
    knowledge = pairs("bounds", bounds, "low", "high"), pairs("priors", priors, "mean", "sd")
    document, text, fitted = _umbmark.fit(
        data, model_of(model), names("add", add), held, knowledge, real("level", level)
    )
    return Fitted._of(document, model=fitted, data=data, text=text)


def learn(
    data: Data,
    model: Model | None = None,
    *,
    size: float = 0.05,
    draws: int = 999,
    seed: Seed = 1,
    return_poses: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Learnt:
    """Learn a model: fit, diagnose, add, until nothing is missing.

    Parameters
    ----------
    data : Dataset or path-like
        The measurements.
    model : Model, optional
        Effects to begin with beside E_d and E_b, on tracks E_s too: a formula to try, say.
    size : float, default 0.05
        Probability with which an effect is added to a complete model.
    draws, seed, return_poses, threads
        As of ``diagnose``.
    progress : bool or callable, optional
        True for a bar of tqdm; or a function of the steps done and of all, in thousandths.

    Raises
    ------
    ValueError
        If there is nothing to learn from, or a number is out of range.

    Examples
    --------
    >>> import umbmark
    >>> truth = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=0.0003)
    >>> learnt = umbmark.learn(umbmark.simulate(truth, reference_rate_hz=0), draws=99)
    >>> [step.added for step in learnt.steps], learnt.verdict
    ([None, 'wheel_diameter_ratio', 'wheelbase'], 'explained')
    """
    data, options = data_of(data), options_of(size, draws, seed)
    with Bar(progress, 1000, "steps") as bar:
        document, text, learnt = _umbmark.learn(
            data, model_of(model), options, return_poses, threads, bar.at
        )
    return Learnt._of(document, model=learnt, data=data, text=text)
