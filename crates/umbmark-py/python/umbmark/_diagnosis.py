"""What a model is missing, and the loop that adds it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import msgspec

from umbmark import _umbmark
from umbmark._comparison import Contrast, OnCircle
from umbmark._monte_carlo import Bar, Progress
from umbmark._remains import Remains, Repeats
from umbmark._result import Interval, Record, Result, Row
from umbmark._scores import Data, data_of
from umbmark._setup import Setup, Taken
from umbmark._umbmark import Model

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Estimate(Record, frozen=True):
    """A parameter that was fitted, with standard error and interval."""

    effect: str
    parameter: str
    value: float
    standard_error: float | None
    interval: Interval | None


class GoodnessOfFit(Record, frozen=True):
    """A test of the whole model."""

    name: str
    statistic: float
    degrees_of_freedom: Interval | None
    p: float


class Suspect(Record, frozen=True):
    """A class of effects that may be missing, which this data cannot tell apart."""

    class_: tuple[str, ...] = msgspec.field(name="class")
    best: str
    f: float
    degrees_of_freedom: Interval
    p: float
    p_adjusted: float
    p_flips: float | None
    estimate: dict[str, float | None]
    standard_error: dict[str, float | None]
    expected_drop: float
    meaning: str | None


class DetectableSize(Record, frozen=True):
    """The least size of an effect that this data would show in four cases of five."""

    effect: str
    parameter: str
    size: float | None


class Experiment(Record, frozen=True):
    """A further experiment that tells two effects apart, by so many standard deviations."""

    separates: tuple[str, str]
    experiment: str
    minutes: float
    sd: float


class Share(Record, frozen=True):
    """How far a unit of a parameter moves an end pose, in m and rad."""

    effect: str
    parameter: str
    position_m_per_unit: float
    heading_rad_per_unit: float


class Hidden(Record, frozen=True):
    """A combination of parameters that the experiment does not show."""

    weights: dict[str, float]
    ratio: float | None


class Identifiability(Record, frozen=True):
    """What of the model this experiment determines."""

    parameters: tuple[Share, ...]
    rank: int
    hidden: tuple[Hidden, ...]


class CurvePoint(Record, frozen=True):
    """What is added at a place, with its 95 % band."""

    at: float
    value: float
    low: float
    high: float


class Curve(Record, frozen=True):
    """What is added to the motion, by what it depends on."""

    at_unit: str
    unit: str
    points: tuple[CurvePoint, ...]


class Nearest(Record, frozen=True):
    """The effect of the catalogue that explains the largest share of it."""

    effect: str
    share: float


class Suggestion(Record, frozen=True):
    """A formula to try, and the share that it explains."""

    effect: tuple[dict[str, Any], ...]
    share: float
    toml: str


class Unlisted(Record, frozen=True):
    """What is missing and not in the catalogue."""

    acts_on: str
    depends_on: str
    p_adjusted: float
    curve: Curve
    nearest: Nearest | None
    suggestion: Suggestion | None


class Outlier(Record, frozen=True):
    """A jump of a track that is beyond noise."""

    run: str
    time_s: float
    moved_m: float
    turned_rad: float | None
    standard_deviations: float | None


class UnlistedLaw(Record, frozen=True):
    """A law that no catalogue lists.

    Attributes
    ----------
    number : int
        Its number in the table of laws, as `--law` of `umbmark learn` takes it.
    toml : str or None
        The law as an effect of a model file, with start values or, once it was added, the fitted
        ones; None where formulas lack what it depends on.
    formula, acts_on : str or None
        Its formula, and what that acts on.
    parameters : dict of str to float, or None
        The numbers of the formula.
    motion : str
        "forward", "sideways" or "yaw".
    per : str
        What the motion is in proportion to: "second", "metre" or "radian turned".
    meaning : str
        The law in words.
    by : str
        What it follows, in words.
    means : str or None
        What its length is of the robot or of its path, such as the circumference of a wheel.
    nearest : Nearest or None
        The effect of the catalogue that comes nearest to it once it was added, and the share of
        its response that this makes, as a cosine.
    with_sense : bool
        Whether it turns over with the sense of the run.
    length : int or None
        How long the formula is: operations, variables and numbers.
    heldout_rmse_m : float
        Error of runs left out, in m.
    heldout_rmse_with_law_m : float
        The same with the law, in m.
    gain : float
        By what share errors of runs left out fall: of positions, of headings, or from pose to
        pose, whichever falls most.
    likeness : float
        Share of its response that the law which is taken makes as well, as a cosine.
    """

    number: int
    toml: str | None
    formula: str | None
    parameters: dict[str, float | None] | None
    acts_on: str | None
    motion: str
    per: str
    meaning: str
    by: str
    means: str | None
    nearest: Nearest | None
    with_sense: bool
    length: int | None
    heldout_rmse_m: float
    heldout_rmse_with_law_m: float
    gain: float
    likeness: float


class Repeated(UnlistedLaw, frozen=True):
    """What is left of the error and repeats: the law that it is taken for, and its p.

    Attributes
    ----------
    p : float
        Of all laws together, by flips of the signs of runs.
    standard_deviations : float
        Size of the greatest score of a law, in standard deviations of the noise model.
    laws : int
        How many laws there are that the data could show.
    class_ : tuple of str
        Formulas of those that these runs cannot tell from it.
    others : tuple of UnlistedLaw
        Others that stand out, the one that predicts runs left out best first.
    """

    p: float
    standard_deviations: float
    laws: int
    class_: tuple[str, ...] = msgspec.field(name="class")
    others: tuple[UnlistedLaw, ...]


class Diagnosis(Result, frozen=True):
    """What a model is missing, how sure that is, and what this data cannot see.

    Attributes
    ----------
    verdict : str
        "explained"; "missing_effect" or "several_missing"; "unlisted_effect", which is not in the
        catalogue; "not_explained", where the model is not enough though no single effect is
        certified (``reasons`` say why); or "not_enough_data".
    ranking : tuple of Suspect
        Classes of effects that were asked, the first ``certified`` of them missing.
    fitted : tuple of Estimate
        The free parameters of the model.
    model : Model
        The model, its free parameters fitted.
    invisible : tuple of str
        Effects that this data says nothing of; ``absorbed`` says by what.
    minimum_detectable : dict of str to float
        The least size of each effect that would have been seen.
    next_experiments : tuple of Experiment
        What to measure next, the most telling per minute first.
    setup : Setup
        What was found of the data before anything was fitted: faults, clock and mounting of the
        reference, jumps, wrong poses, runs far from the others.
    taken : tuple of Taken
        Effects of the reference whose values were taken from the motion.
    reasons : tuple of str
        Why the model is not called explained, a sentence each.
    repeats : Repeated or None
        What repeats most beside the model, whether it counts or not; None without tracks.
    left_m : float or None
        Error that is left.
    repeats_m : Repeats or None
        How much of it is the same in every run of one path.
    remains : Remains or None
        The same in detail, with what chance there is; None where columns are not what they are
        called.
    """

    verdict: str
    observed: str
    fitted: tuple[Estimate, ...]
    goodness_of_fit: tuple[GoodnessOfFit, ...]
    ranking: tuple[Suspect, ...]
    certified: int
    invisible: tuple[str, ...]
    absorbed: dict[str, tuple[str, ...]]
    minimum_detectable: dict[str, float | None]
    minimum_detectable_sizes: tuple[DetectableSize, ...]
    next_experiments: tuple[Experiment, ...]
    identifiability: Identifiability
    unlisted: Unlisted | None
    model: Model
    meaning: dict[str, str]
    outliers: tuple[Outlier, ...]
    setup: Setup
    taken: tuple[Taken, ...]
    reasons: tuple[str, ...]
    repeats: Repeated | None
    left_m: float | None
    repeats_m: Repeats | None
    remains: Remains | None
    remarks: tuple[str, ...]
    size: float
    draws: int
    seed: int
    version: str
    contrasts: tuple[Contrast, ...]
    circle: tuple[OnCircle, ...]

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

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the p of the first classes of the ranking, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.diagnosis(self, ax)


class Fitted(Result, frozen=True):
    """A fit of a model: its numbers, and the model with them.

    Attributes
    ----------
    fitted : tuple of Estimate
        The free parameters.
    not_shown : tuple of str
        Free effects that this data does not show apart from the rest; they keep their values.
    usual_noise : bool
        Whether the values are those under noise of the usual sizes: from tracks, where these
        predict runs left out nearer than the likeliest ones by a tenth.
    setup : Setup
        What was found of the data before anything was fitted: faults, clock and mounting of the
        reference, jumps, wrong poses, runs far from the others.
    taken : tuple of Taken
        Effects of the reference whose values were taken from the motion.
    model : Model
        The model with the fitted values.
    level : float
        Probability with which the intervals hold.
    """

    fitted: tuple[Estimate, ...]
    not_shown: tuple[str, ...]
    meaning: dict[str, str]
    outliers: tuple[Outlier, ...]
    usual_noise: bool
    setup: Setup
    taken: tuple[Taken, ...]
    model: Model
    level: float
    version: str

    def table(self) -> list[Row]:
        """Give the free parameters, one dict a row."""
        return [msgspec.structs.asdict(estimate) for estimate in self.fitted]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the fitted values in units of their standard errors, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.fitted(self, ax)


class Step(Record, frozen=True):
    """One line of the story of a learnt model; errors in m and rad.

    ``law`` is that of a step which no effect of the catalogue makes: how it was found, what else
    it may be, and its formula as it was fitted.
    """

    added: str | None
    class_: tuple[str, ...] = msgspec.field(name="class")
    p_adjusted: float | None
    law: Repeated | None
    rmse_m: float | None
    heading_rmse_rad: float | None
    heldout_rmse_m: float | None
    heldout_heading_rmse_rad: float | None
    aicc: float | None
    bic: float | None


class Learnt(Result, frozen=True):
    """What was learnt, from the nominal robot to the model.

    Attributes
    ----------
    steps : tuple of Step
        The nominal robot, and each effect that was added.
    verdict : str
        What the last diagnosis says, in the words of ``Diagnosis``.
    model : Model
        The model that was learnt.
    fitted : tuple of Estimate
        Its free parameters.
    setup : Setup
        What was found of the data before anything was fitted: faults, clock and mounting of the
        reference, jumps, wrong poses, runs far from the others.
    taken : tuple of Taken
        Effects of the reference whose values were taken from the motion.
    reasons : tuple of str
        Why the model is not called explained, a sentence each.
    repeats : Repeated or None
        What repeats most beside the model, whether it counts or not; None without tracks.
    left_m : float or None
        Error that is left.
    repeats_m : Repeats or None
        How much of it is the same in every run of one path.
    remains : Remains or None
        The same in detail, with what chance there is; None where columns are not what they are
        called.
    partial : bool
        Whether it was stopped while an effect was still missing.
    """

    steps: tuple[Step, ...]
    verdict: str
    unlisted: Unlisted | None
    next_experiments: tuple[Experiment, ...]
    model: Model
    fitted: tuple[Estimate, ...]
    meaning: dict[str, str]
    outliers: tuple[Outlier, ...]
    setup: Setup
    taken: tuple[Taken, ...]
    reasons: tuple[str, ...]
    repeats: Repeated | None
    left_m: float | None
    repeats_m: Repeats | None
    remains: Remains | None
    remarks: tuple[str, ...]
    partial: bool
    size: float
    draws: int
    seed: int
    version: str

    def table(self) -> list[Row]:
        """Give the steps, one dict a row."""
        keys = ("p_adjusted", "rmse_m", "heldout_rmse_m", "heldout_heading_rmse_rad", "aicc")
        return [
            {"added": step.added or "nominal robot"} | {key: getattr(step, key) for key in keys}
            for step in self.steps
        ]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the error falling from step to step, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.learnt(self, ax)


def diagnose(
    data: Data,
    model: Model | None = None,
    *,
    size: float = 0.05,
    draws: int = 999,
    seed: int = 1,
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
        Probability with which a complete model is accused all the same.
    draws : int, default 999
        Simulated tests for p-values that have no closed form.
    seed : int, default 1
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
    options = (size, draws, seed)
    document, fitted = _umbmark.diagnose(data_of(data), model, options, return_poses, threads)
    return Diagnosis._of(document, model=fitted)


def fit(
    data: Data, model: Model | None = None, *, add: Sequence[str] = (), level: float = 0.95
) -> Fitted:
    """Fit the free effects of a model to measured runs.

    Parameters
    ----------
    data : Dataset or path-like
        The measurements.
    model : Model, optional
        The model whose free effects are fitted; E_d and E_b, on tracks E_s too, where none is
        given.
    add : sequence of str
        Effects to add and fit too.
    level : float, default 0.95
        Probability with which the intervals hold.

    Raises
    ------
    ValueError
        If no effect is free, or the fit does not settle.
    """
    document, fitted = _umbmark.fit(data_of(data), model, [*add], level)
    return Fitted._of(document, model=fitted)


def learn(
    data: Data,
    model: Model | None = None,
    *,
    size: float = 0.05,
    draws: int = 999,
    seed: int = 1,
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
    options = (size, draws, seed)
    with Bar(progress, 1000, "per mille") as bar:
        document, learnt = _umbmark.learn(
            data_of(data), model, options, return_poses, threads, bar.at
        )
    return Learnt._of(document, model=learnt)
