"""Results as the command prints them, typed: written from the core's, not by hand.

``SNAPSHOTS=overwrite cargo test -p umbmark-cli --test python_classes`` writes them anew.
"""

from __future__ import annotations

from typing import Any

import msgspec
from msgspec import UNSET, UnsetType

from umbmark._result import Interval, Record, Result
from umbmark._umbmark import Model


class Calibration(Result, frozen=True):
    """A calibration by every method that the data allows.

    Attributes
    ----------
    methods : dict[str, Correction or None]
        The corrections by "closed_form_x", "closed_form_y", "closed_form_mean", "heading" and
        "exact"; None where the data does not allow it.
    observed : str
        "end_poses" or "tracks".
    heading_arm_m : float or None
        Metres that a radian of heading counted as, where whole tracks were fitted; else None.
    level : float
        Probability with which the intervals hold.
    setup : Setup
        What was found of the data before anything was fitted: faults, clock and mounting of the
        reference, jumps, wrong poses, runs far from the others.
    taken : tuple[Taken, ...]
        Effects of the reference whose values were taken from the motion.
    doubts : tuple[str, ...]
        What puts the corrected lengths in doubt, a sentence each; they are not exported then.
    warnings : tuple[str, ...]
        What to know of the data first; then what could not be determined, and why.
    version : str
        Version of umbmark.
    """

    methods: dict[str, Correction | None]
    observed: str
    heading_arm_m: float | None
    level: float
    setup: Setup
    taken: tuple[Taken, ...]
    doubts: tuple[str, ...]
    warnings: tuple[str, ...]
    version: str


class Correction(Record, frozen=True):
    """The corrections that one method gives; None for what the data does not show.

    Attributes
    ----------
    e_d : float or None
        Ratio of the wheel diameters, right to left.
    e_b : float or None
        Wheelbase by its nominal value.
    e_s : float or None
        Mean wheel diameter by its nominal value.
    wheelbase_m : float or None
        Corrected wheelbase, in m.
    wheel_diameter_left_m : float or None
        Corrected diameter of the left wheel, in m.
    wheel_diameter_right_m : float or None
        Corrected diameter of the right wheel, in m.
    covariance : tuple[tuple[float, ...], ...] or None
        Covariance of the ratios named in ``covariance_of``.
    covariance_of : tuple[str, ...]
        The ratios that the data shows.
    degrees_of_freedom : float or None
        Degrees of freedom of the covariance.
    e_d_interval : Interval or None
        Interval of E_d.
    e_b_interval : Interval or None
        Interval of E_b.
    e_s_interval : Interval or None
        Interval of E_s.
    e_max_sys_before_m : float or None
        E_max,sys as driven, in m.
    e_max_sys_after_m : float or None
        E_max,sys that is left with the correction, in m.
    replayed_before : Replayed or None
        Return errors of the recorded ticks with the nominal lengths.
    replayed_after : Replayed or None
        Return errors of the recorded ticks with the corrected lengths.
    termination : str or None
        How the fit ended; None for closed forms.
    """

    e_d: float | None
    e_b: float | None
    e_s: float | None
    wheelbase_m: float | None
    wheel_diameter_left_m: float | None
    wheel_diameter_right_m: float | None
    covariance: tuple[tuple[float, ...], ...] | None
    covariance_of: tuple[str, ...]
    degrees_of_freedom: float | None
    e_d_interval: Interval | None
    e_b_interval: Interval | None
    e_s_interval: Interval | None
    e_max_sys_before_m: float | None
    e_max_sys_after_m: float | None
    replayed_before: Replayed | None
    replayed_after: Replayed | None
    termination: str | None


class Replayed(Record, frozen=True):
    """Return errors of the recorded runs, their ticks computed again.

    Attributes
    ----------
    e_max_sys_m : float or None
        E_max,sys, in m; None without runs of both directions.
    largest_m : float
        The largest distance of a return position from START, in m.
    """

    e_max_sys_m: float | None
    largest_m: float


class Setup(Record, frozen=True):
    """What was found of an experiment before any model was fitted.

    All of it follows from the motion and the return errors alone. With only return errors in
    arrays, or without a nominal robot, there is nothing in it.

    Attributes
    ----------
    faults : tuple[Fault, ...]
        Columns, units and frames that are not what they are called. Correct these first: until then
        no number says anything of the robot.
    reference : Mounting or None
        Clock and mounting of the reference; None without enough absolute poses.
    delays : tuple[Delay, ...]
        The delay of the reference in each run with poses.
    jumps : tuple[Jump, ...]
        Places where tracks jump.
    wrong_poses : tuple[WrongPose, ...]
        Single poses that are wrong; they are left out of fits.
    returns : tuple[OutlyingReturn, ...]
        Runs whose return error is far from the others.
    """

    faults: tuple[Fault, ...]
    reference: Mounting | None
    delays: tuple[Delay, ...]
    jumps: tuple[Jump, ...]
    wrong_poses: tuple[WrongPose, ...]
    returns: tuple[OutlyingReturn, ...]


class Fault(Record, frozen=True):
    """A column, a unit or a frame that is not what it is called, and how to correct it.

    Attributes
    ----------
    fault : str
        The fault, in a sentence.
    remedy : str
        What to do.
    """

    fault: str
    remedy: str


class Mounting(Record, frozen=True):
    """How the poses of the reference lie against the wheels, over all runs.

    A quantity is None where the motion does not show it.

    Attributes
    ----------
    delay_s : Measured
        How much older than its stamp a pose is in the middle of a run, in s.
    clock_rate : Measured or None
        How much the delay grows in a second, in s/s.
    ahead_m : Measured or None
        How far ahead of the centre of the axle the tracked point lies, in m.
    left_m : Measured or None
        How far to the left of it the tracked point lies, in m.
    yaw_rad : Measured or None
        Heading of the tracked body minus heading of the robot, in rad.
    scale : Measured or None
        Distance by the reference divided by distance by the wheels.
    gain : Measured or None
        Turning by the reference divided by turning by the wheels.
    drift_rad_per_m : Measured or None
        Turning by the reference for each metre driven ahead, in rad/m.
    """

    delay_s: Measured
    clock_rate: Measured | None
    ahead_m: Measured | None
    left_m: Measured | None
    yaw_rad: Measured | None
    scale: Measured | None
    gain: Measured | None
    drift_rad_per_m: Measured | None


class Measured(Record, frozen=True):
    """A quantity with its standard error and its 95 % interval, in the unit that its key names.

    Attributes
    ----------
    value : float
        The estimate.
    std_error : float or None
        Its standard error; None where the data does not give it.
    interval : Interval or None
        Its 95 % interval; None where the data does not give it.
    """

    value: float
    std_error: float | None
    interval: Interval | None


class Delay(Record, frozen=True):
    """How much older than its stamp a pose of a run is.

    Attributes
    ----------
    run : str
        Name of the run.
    delay_s : Measured or None
        The delay, in s; None without enough motion.
    """

    run: str
    delay_s: Measured | None


class Jump(Record, frozen=True):
    """A place where a track jumps, or a few seconds in which robot and wheels part.

    A wheel slipped, the robot was pushed or carried, or the reference lost it.

    Attributes
    ----------
    run : str
        Name of the run.
    since_s : float
        Time of the last pose before it since the log began, in s.
    time_s : float
        Time of the first pose behind it, in s.
    moved_m : float
        How far the tracked point moved without the wheels, in m.
    turned_rad : float or None
        How far it turned without the wheels, in rad; None without headings.
    standard_deviations : float or None
        Size of the jump, in standard deviations of the motion from pose to pose; None where that is
        not known.
    """

    run: str
    since_s: float
    time_s: float
    moved_m: float
    turned_rad: float | None
    standard_deviations: float | None


class WrongPose(Record, frozen=True):
    """A pose that is wrong: the poses around it contradict it.

    Attributes
    ----------
    run : str
        Name of the run.
    time_s : float
        Time since the log began, in s.
    moved_m : float
        Distance from where the poses around it place it, in m.
    turned_rad : float or None
        The same for the heading, in rad; None without headings.
    """

    run: str
    time_s: float
    moved_m: float
    turned_rad: float | None


class OutlyingReturn(Record, frozen=True):
    """A run whose return error is far from those of the other runs of its direction and test.

    Attributes
    ----------
    run : str
        Name of the run.
    test : str
        "systematic" or "bumps".
    direction : str or None
        "cw" or "ccw"; None where the run has neither.
    others : int
        Number of the other runs that it was compared with.
    moved_m : float
        Distance of its end position from their mean, in m.
    turned_rad : float or None
        Its heading minus their mean, in rad; None without headings.
    standard_deviations : float or None
        Distance of the farthest coordinate, in standard deviations; None where the others do not
        scatter.
    deviants : tuple[Deviant, ...]
        The coordinates that are off, the farthest first.
    said : str
        The finding in words.
    remedy : str
        What to do.
    """

    run: str
    test: str
    direction: str | None
    others: int
    moved_m: float
    turned_rad: float | None
    standard_deviations: float | None
    deviants: tuple[Deviant, ...]
    said: str
    remedy: str


class Deviant(Record, frozen=True):
    """A coordinate of a return error that lies far from those of the other runs.

    Attributes
    ----------
    coordinate : str
        "x", "y" or "heading".
    value : float
        Its value, in m, a heading in rad.
    mean_of_others : float
        Mean of the other runs, in the same unit.
    standard_deviations : float or None
        Distance from that mean, in standard deviations of a run about it; None where the others do
        not scatter.
    """

    coordinate: str
    value: float
    mean_of_others: float
    standard_deviations: float | None


class Taken(Record, frozen=True):
    """An effect of the reference whose values were taken from the motion before any fit.

    Attributes
    ----------
    effect : str
        Name of the effect.
    parameters : dict[str, Measured]
        Its values, in the units of its parameters.
    p : float
        Probability of values so large where the effect is absent.
    """

    effect: str
    parameters: dict[str, Measured]
    p: float


class Comparison(Result, frozen=True):
    """Models beside measurements: which explain them, and where the others fail.

    Attributes
    ----------
    observed : str
        "end_poses".
    n_cw : int
        Number of clockwise runs.
    n_ccw : int
        Number of counter-clockwise runs.
    models : tuple[Judged, ...]
        The models, in the order in which they were given.
    setup : Setup
        What was found of the data before anything was fitted: faults, clock and mounting of the
        reference, jumps, wrong poses, runs far from the others.
    remarks : tuple[str, ...]
        What else should be said.
    size : float
        False-alarm rate: probability with which a right model is accused.
    draws : int
        Simulated tests for the p-values.
    seed : int
        Seed of those.
    version : str
        Version of umbmark.
    contrasts : tuple[Contrast, ...]
        Closure contrasts of a square driven both ways; empty for other paths.
    circle : tuple[OnCircle, ...]
        End points beside the circle through START; empty for other paths.
    left_m : float or None
        Error that is left, in m.
    repeats_m : Repeats or None
        How much of it is the same in every run of one path, in m; None where no two runs drive one
        path.
    remains : Remains or None
        The same in detail, with what chance there is; None where columns are not what they are
        called.
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


class Judged(Record, frozen=True):
    """How one model does.

    Attributes
    ----------
    name : str
        Its name.
    explains : bool
        Whether it explains the runs.
    p : float
        p of all statistics together.
    noise : str
        "model" where the noise is the model's, "pooled" where it is that of the runs.
    rmse_m : float
        Root mean square error of positions, in m.
    heading_rmse_rad : float or None
        The same of headings, in rad; None where none were measured.
    statistics : dict[str, dict[str, Statistic]]
        Each statistic, by direction and quantity.
    sentences : tuple[str, ...]
        Where it fails, a sentence each.
    left_m : float or None
        Error that is left, in m.
    repeats_m : Repeats or None
        How much of it is the same in every run of one path, in m; None where no two runs drive one
        path.
    remains : Remains or None
        The same in detail, with what chance there is; None where columns are not what they are
        called.
    """

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


class Statistic(Record, frozen=True):
    """A statistic as measured and as a model predicts it, in m, rad or 1.

    Attributes
    ----------
    measured : float
        As measured.
    predicted : float
        As the model predicts it.
    p : float
        Probability of so large a difference where the model is right.
    """

    measured: float
    predicted: float
    p: float


class Repeats(Record, frozen=True):
    """How much of an error is the same in every run of a path, at least.

    Attributes
    ----------
    value : float
        Root mean square, in m or rad.
    low : float or None
        Lower end of its 95 % interval; None below three runs.
    high : float or None
        Upper end of its 95 % interval; None below three runs.
    """

    value: float
    low: float | None
    high: float | None


class Remains(Record, frozen=True):
    """What a model leaves.

    Attributes
    ----------
    left_m : float or None
        Root mean square error of positions, in m.
    repeats_m : Repeats or None
        How much of it is the same in every run: the root of the mean product of what is left in two
        runs at the same share of one path; None where no two runs drive one path.
    left_rad : float or None
        Root mean square error of headings, in rad; None where none were measured.
    repeats_rad : Repeats or None
        How much of that is the same in every run; None where no two runs drive one path or no
        headings were measured.
    pairs_of_one_path : int
        How many pairs of runs that rests on.
    chance : tuple[Chance, ...]
        What each source of noise would leave; empty for return poses.
    disturbances : tuple[Disturbance, ...]
        Bumps and slips met by chance, and poses of the reference that are off.
    """

    left_m: float | None
    repeats_m: Repeats | None
    left_rad: float | None
    repeats_rad: Repeats | None
    pairs_of_one_path: int
    chance: tuple[Chance, ...]
    disturbances: tuple[Disturbance, ...]


class Chance(Record, frozen=True):
    """A source of chance, and the error that it alone would leave.

    Attributes
    ----------
    source : str
        Its name.
    position_m : float
        Root mean square error of positions, in m.
    heading_rad : float
        Root mean square error of headings, in rad.
    """

    source: str
    position_m: float
    heading_rad: float


class Disturbance(Record, frozen=True):
    """A place where a run is disturbed by more than its noise.

    Attributes
    ----------
    run : str
        Name of the run.
    t_s : float
        Time since START, in s.
    rolled_m : float
        How far the wheels have rolled by then, in m.
    lasts : bool
        Whether the robot was moved and stayed so, as by a bump; else the reference was off for a
        moment.
    forward_m : float
        By how much ahead, as the robot sees it, in m.
    left_m : float
        By how much to the left, as the robot sees it, in m.
    heading_rad : float
        By how much it turned to the left, in rad; 0 where headings were not measured.
    standard_deviations : float
        The same in standard deviations of the noise.
    """

    run: str
    t_s: float
    rolled_m: float
    lasts: bool
    forward_m: float
    left_m: float
    heading_rad: float
    standard_deviations: float


class Contrast(Record, frozen=True):
    """A closure contrast of a square driven both ways: zero where the model is complete.

    Attributes
    ----------
    name : str
        Its name.
    unit : str
        Its unit.
    value : float
        Its value.
    interval : Interval or None
        Its 95 % interval; None where the runs do not give it.
    meaning : str
        What it means where it is not zero.
    """

    name: str
    unit: str
    value: float
    interval: Interval | None
    meaning: str


class OnCircle(Record, frozen=True):
    """End points of a direction beside the circle through START.

    Attributes
    ----------
    direction : str
        "cw" or "ccw".
    off_m : tuple[float, ...]
        How far each end point lies off the circle, in m.
    mean_off_m : float
        Mean of these, in m.
    mean_off_interval_m : Interval or None
        Its 95 % interval, in m; None where the runs do not give it.
    distance_m : float
        Mean distance of the end points from START, in m.
    distance_by_heading_m : float or None
        The distance that the headings imply, in m; None where none were measured.
    angle_less_heading_rad : float or None
        Angle on the circle less the return heading, in rad; None where no headings were measured.
    angle_less_heading_interval_rad : Interval or None
        Its 95 % interval, in rad; None where the runs do not give it.
    explained : bool
        Whether the circle explains the end points.
    """

    direction: str
    off_m: tuple[float, ...]
    mean_off_m: float
    mean_off_interval_m: Interval | None
    distance_m: float
    distance_by_heading_m: float | None
    angle_less_heading_rad: float | None
    angle_less_heading_interval_rad: Interval | None
    explained: bool


class Diagnosis(Result, frozen=True):
    """What a model is missing, how sure that is, and what this data cannot see.

    Attributes
    ----------
    verdict : str
        "explained"; "missing_effect" or "several_missing"; "unlisted_effect", which is not in the
        catalogue; "not_explained", where the model is not enough though no single effect is
        certified (``reasons`` say why); or "not_enough_data".
    observed : str
        "end_poses" or "tracks".
    fitted : tuple[Estimate, ...]
        The free parameters of the model.
    goodness_of_fit : tuple[GoodnessOfFit, ...]
        Tests of the whole model.
    ranking : tuple[Suspect, ...]
        Classes of effects that were asked, the first ``certified`` of them missing.
    certified : int
        How many of the ranking are missing.
    invisible : tuple[str, ...]
        Effects that this data says nothing of; ``absorbed`` says by what.
    absorbed : dict[str, tuple[str, ...]]
        Effects that others of the model make up for, with these.
    minimum_detectable : dict[str, float or None]
        The least size of each effect that would have been seen.
    minimum_detectable_sizes : tuple[DetectableSize, ...]
        The same for each parameter.
    next_experiments : tuple[Experiment, ...]
        What to measure next, the most telling per minute first.
    identifiability : Identifiability
        What of the model this experiment determines.
    unlisted : Unlisted or None
        What is missing and not in the catalogue; None where nothing is.
    model : Model
        The model, its free parameters fitted.
    meaning : dict[str, str]
        What each fitted effect means for the robot, a sentence each.
    outliers : tuple[Outlier, ...]
        Jumps of tracks that are beyond noise.
    setup : Setup
        What was found of the data before anything was fitted: faults, clock and mounting of the
        reference, jumps, wrong poses, runs far from the others.
    taken : tuple[Taken, ...]
        Effects of the reference whose values were taken from the motion.
    reasons : tuple[str, ...]
        Why the model is not called explained, a sentence each.
    repeats : Repeated or None
        What repeats most beside the model, whether it counts or not; None without tracks.
    remarks : tuple[str, ...]
        What else should be said.
    size : float
        False-alarm rate: probability with which a complete model is accused.
    draws : int
        Simulated tests for p-values that have no closed form.
    seed : int
        Seed of those.
    version : str
        Version of umbmark.
    contrasts : tuple[Contrast, ...]
        Closure contrasts of a square driven both ways; empty for other paths.
    circle : tuple[OnCircle, ...]
        End points beside the circle through START; empty for other paths.
    left_m : float or None
        Error that is left, in m.
    repeats_m : Repeats or None
        How much of it is the same in every run of one path, in m; None where no two runs drive one
        path.
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


class Estimate(Record, frozen=True):
    """A parameter that was fitted.

    Attributes
    ----------
    effect : str
        The effect that has it.
    parameter : str
        Its name.
    value : float
        Its value, in the unit that the catalogue states.
    standard_error : float or None
        Its standard error; None where the data does not give it.
    interval : Interval or None
        Its interval; None where the data does not give it.
    """

    effect: str
    parameter: str
    value: float
    standard_error: float | None
    interval: Interval | None


class GoodnessOfFit(Record, frozen=True):
    """A test of the whole model.

    Attributes
    ----------
    name : str
        Its name.
    statistic : float
        Its statistic.
    degrees_of_freedom : Interval or None
        Degrees of freedom; None where its p is from simulated tests.
    p : float
        Probability of so large a statistic where nothing is missing.
    """

    name: str
    statistic: float
    degrees_of_freedom: Interval | None
    p: float


class Suspect(Record, frozen=True):
    """A class of effects that may be missing, which this data cannot tell apart.

    Attributes
    ----------
    class_ : tuple[str, ...]
        Names of its effects.
    best : str
        The one that fits best.
    f : float
        F of adding it.
    degrees_of_freedom : Interval
        Degrees of freedom of F.
    p : float
        Probability of so large an F where it is absent.
    p_adjusted : float
        The same, corrected for all classes that were asked.
    p_flips : float or None
        The same by flips of the signs of runs; None where these were not asked.
    estimate : dict[str, float or None]
        Values of the parameters of the best.
    standard_error : dict[str, float or None]
        Their standard errors.
    expected_drop : float
        By how much adding it is expected to lower the sum of squares.
    meaning : str or None
        What the values mean for the robot; None where there is nothing to say.
    """

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
    """The least size of an effect that this data would show in four cases of five.

    Attributes
    ----------
    effect : str
        The effect.
    parameter : str
        The parameter that has the size.
    size : float or None
        The size, in the unit of the parameter; None where no size would be seen.
    """

    effect: str
    parameter: str
    size: float | None


class Experiment(Record, frozen=True):
    """A further experiment that tells two effects apart.

    Attributes
    ----------
    separates : tuple[str, str]
        The two effects.
    experiment : str
        What to drive.
    minutes : float
        How long it takes, in min.
    sd : float
        By how many standard deviations it puts them apart.
    """

    separates: tuple[str, str]
    experiment: str
    minutes: float
    sd: float


class Identifiability(Record, frozen=True):
    """What of the model this experiment determines.

    Attributes
    ----------
    parameters : tuple[Share, ...]
        Each free parameter, with what it does to end poses.
    rank : int
        Number of combinations that are determined.
    hidden : tuple[Hidden, ...]
        Combinations that are not determined.
    """

    parameters: tuple[Share, ...]
    rank: int
    hidden: tuple[Hidden, ...]


class Share(Record, frozen=True):
    """How far a unit of a parameter moves an end pose.

    Attributes
    ----------
    effect : str
        The effect.
    parameter : str
        Its parameter.
    position_m_per_unit : float
        How far the position moves for a unit of the parameter, in m.
    heading_rad_per_unit : float
        How far the heading turns for a unit of the parameter, in rad.
    """

    effect: str
    parameter: str
    position_m_per_unit: float
    heading_rad_per_unit: float


class Hidden(Record, frozen=True):
    """A combination of parameters that the experiment does not show.

    Attributes
    ----------
    weights : dict[str, float]
        The weight of each parameter.
    ratio : float or None
        How much less it is seen than the combination that is seen best; None where it is not seen
        at all.
    """

    weights: dict[str, float]
    ratio: float | None


class Unlisted(Record, frozen=True):
    """What is missing and not in the catalogue.

    Attributes
    ----------
    acts_on : str
        What it acts on.
    depends_on : str
        What it depends on.
    p_adjusted : float
        Probability of so strong a dependence where there is none, corrected for all that were
        asked.
    curve : Curve
        How it depends on it.
    nearest : Nearest or None
        The effect of the catalogue that explains the largest share of it; None where none explains
        any.
    suggestion : Suggestion or None
        A formula to try; None where none is near.
    """

    acts_on: str
    depends_on: str
    p_adjusted: float
    curve: Curve
    nearest: Nearest | None
    suggestion: Suggestion | None


class Curve(Record, frozen=True):
    """What is added to the motion, by what it depends on.

    Attributes
    ----------
    at_unit : str
        Unit of what it depends on.
    unit : str
        Unit of what is added.
    points : tuple[CurvePoint, ...]
        Its points, in order.
    """

    at_unit: str
    unit: str
    points: tuple[CurvePoint, ...]


class CurvePoint(Record, frozen=True):
    """What is added at a place, with its 95 % band.

    Attributes
    ----------
    at : float
        The place, in the curve's ``at_unit``.
    value : float
        What is added, in the curve's ``unit``.
    low : float
        Lower end of its band.
    high : float
        Upper end of its band.
    """

    at: float
    value: float
    low: float
    high: float


class Nearest(Record, frozen=True):
    """The effect of the catalogue that comes nearest to what is missing.

    Attributes
    ----------
    effect : str
        Its name.
    share : float
        The share that it explains.
    """

    effect: str
    share: float


class Suggestion(Record, frozen=True):
    """A formula to try, and the share that it explains.

    Attributes
    ----------
    effect : tuple[dict[str, Any], ...]
        Its effects in the order in which they act: each with its name, its parameters and whether
        it is free.
    share : float
        The share of the curve that it explains.
    toml : str
        The same as text of a model file.
    """

    effect: tuple[dict[str, Any], ...]
    share: float
    toml: str


class Outlier(Record, frozen=True):
    """A jump of a track that is beyond noise.

    Attributes
    ----------
    run : str
        Name of the run.
    time_s : float
        Time since START, in s.
    moved_m : float
        How far it jumps, in m.
    turned_rad : float or None
        How far it turns, in rad; None without headings.
    standard_deviations : float or None
        Size of the jump, in standard deviations of the noise; None where that is not known.
    """

    run: str
    time_s: float
    moved_m: float
    turned_rad: float | None
    standard_deviations: float | None


class Repeated(Record, frozen=True):
    """What is left of the error and repeats: the law that it is taken for, and its p.

    Attributes
    ----------
    number : int
        Its number in the table of laws, as ``--law`` of ``umbmark learn`` takes it.
    toml : str or None
        The law as an effect of a model file, with start values or, once it was added, the fitted
        ones; None where formulas lack what it depends on.
    formula : str or None
        Its formula; None where it cannot be written as one.
    parameters : dict[str, float or None] or None
        The numbers of the formula.
    acts_on : str or None
        What the formula acts on.
    motion : str
        "forward", "sideways" or "yaw".
    per : str
        What the motion is in proportion to: "second", "metre" or "radian turned".
    meaning : str
        The law in words.
    by : str
        What it follows, in words.
    means : str or None
        What its length is of the robot or of its path, such as the circumference of a wheel; None
        where it has none or it is unknown.
    nearest : Nearest or None
        The effect of the catalogue that comes nearest to it once it was added, and the share of its
        response that this makes, as a cosine.
    with_sense : bool
        Whether it turns over with the sense of the run.
    length : int or None
        How long the formula is: operations, variables and numbers.
    heldout_rmse_m : float
        Error of runs left out, in m.
    heldout_rmse_with_law_m : float
        The same with the law, in m.
    gain : float
        By what share errors of runs left out fall: of positions, of headings, or from pose to pose,
        whichever falls most.
    likeness : float
        Share of its response that the law which is taken makes as well, as a cosine.
    p : float
        Of all laws together, by flips of the signs of runs.
    standard_deviations : float
        Size of the greatest score of a law, in standard deviations of the noise model.
    laws : int
        How many laws there are that the data could show.
    class_ : tuple[str, ...]
        Formulas of those that these runs cannot tell from it.
    others : tuple[UnlistedLaw, ...]
        Others that stand out, the one that predicts runs left out best first.
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
    p: float
    standard_deviations: float
    laws: int
    class_: tuple[str, ...] = msgspec.field(name="class")
    others: tuple[UnlistedLaw, ...]


class UnlistedLaw(Record, frozen=True):
    """A law that no catalogue lists.

    Attributes
    ----------
    number : int
        Its number in the table of laws, as ``--law`` of ``umbmark learn`` takes it.
    toml : str or None
        The law as an effect of a model file, with start values or, once it was added, the fitted
        ones; None where formulas lack what it depends on.
    formula : str or None
        Its formula; None where it cannot be written as one.
    parameters : dict[str, float or None] or None
        The numbers of the formula.
    acts_on : str or None
        What the formula acts on.
    motion : str
        "forward", "sideways" or "yaw".
    per : str
        What the motion is in proportion to: "second", "metre" or "radian turned".
    meaning : str
        The law in words.
    by : str
        What it follows, in words.
    means : str or None
        What its length is of the robot or of its path, such as the circumference of a wheel; None
        where it has none or it is unknown.
    nearest : Nearest or None
        The effect of the catalogue that comes nearest to it once it was added, and the share of its
        response that this makes, as a cosine.
    with_sense : bool
        Whether it turns over with the sense of the run.
    length : int or None
        How long the formula is: operations, variables and numbers.
    heldout_rmse_m : float
        Error of runs left out, in m.
    heldout_rmse_with_law_m : float
        The same with the law, in m.
    gain : float
        By what share errors of runs left out fall: of positions, of headings, or from pose to pose,
        whichever falls most.
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


class Fitted(Result, frozen=True):
    """A fit of a model: its numbers, and the model with them.

    Attributes
    ----------
    fitted : tuple[Estimate, ...]
        The free parameters.
    not_shown : tuple[str, ...]
        Free effects that this data does not show apart from the rest; they keep their values.
    meaning : dict[str, str]
        What each fitted effect means for the robot, a sentence each.
    outliers : tuple[Outlier, ...]
        Jumps of tracks that are beyond noise.
    usual_noise : bool
        Whether the values are those under noise of the usual sizes: from tracks, where these
        predict runs left out nearer than the likeliest ones by a tenth.
    setup : Setup
        What was found of the data before anything was fitted: faults, clock and mounting of the
        reference, jumps, wrong poses, runs far from the others.
    taken : tuple[Taken, ...]
        Effects of the reference whose values were taken from the motion.
    model : Model
        The model with the fitted values.
    level : float
        Probability with which the intervals hold.
    version : str
        Version of umbmark.
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


class GearCalibration(Result, frozen=True):
    """A robot of any drive, calibrated by the first effects of its drive.

    Attributes
    ----------
    drive : str
        "synchro", "ackermann", ...
    fitted : tuple[Estimate, ...]
        The sizes of its first effects.
    not_shown : tuple[str, ...]
        Effects that this data does not show apart from the rest; they keep their values.
    corrected : dict[str, float]
        The keys of robot.toml that change, with their new values.
    return_poses_determine : ReturnPosesDetermine or None
        What return poses can tell; None where the path is not known.
    e_max_sys_before_m : float or None
        E_max,sys as driven, in m; None without runs of both directions.
    e_max_sys_after_m : float or None
        What is left of it with the correction, in m.
    level : float
        Probability with which the intervals hold.
    warnings : tuple[str, ...]
        What to know of the data.
    version : str
        Version of umbmark.
    """

    drive: str
    fitted: tuple[Estimate, ...]
    not_shown: tuple[str, ...]
    corrected: dict[str, float]
    return_poses_determine: ReturnPosesDetermine | None
    e_max_sys_before_m: float | None
    e_max_sys_after_m: float | None
    level: float
    warnings: tuple[str, ...]
    version: str


class ReturnPosesDetermine(Record, frozen=True):
    """What return poses of the path determine: so many combinations of so many sizes.

    Attributes
    ----------
    rank : int
        Number of combinations that are determined.
    of : int
        Number of sizes.
    hidden : tuple[dict[str, float], ...]
        Combinations that are not determined: the weight of each size.
    """

    rank: int
    of: int
    hidden: tuple[dict[str, float], ...]


class Inspection(Result, frozen=True):
    """The findings on a dataset.

    Attributes
    ----------
    data : str
        Where it was read from.
    robot : RobotFacts or None
        The nominal robot; None where it is not known.
    path : PathFacts or None
        The path; None where it is not known.
    groups : tuple[Group, ...]
        The runs.
    logs : tuple[LogFacts, ...]
        Each log.
    clocks : tuple[Clock, ...]
        Clocks that were set.
    topics : tuple[Topics, ...]
        Topics that were read.
    checks : tuple[Check, ...]
        Figures with what good looks like: is it any good?
    determined : tuple[Determined, ...]
        What it can say of the robot.
    rank : int
        Number of combinations of E_d, E_b and E_s that it determines.
    setup : Setup or None
        What was found of the runs from their motion and return errors; None without a robot.
    warnings : tuple[str, ...]
        What looks wrong.
    version : str
        Version of umbmark.
    """

    data: str
    robot: RobotFacts | None
    path: PathFacts | None
    groups: tuple[Group, ...]
    logs: tuple[LogFacts, ...]
    clocks: tuple[Clock, ...]
    topics: tuple[Topics, ...]
    checks: tuple[Check, ...]
    determined: tuple[Determined, ...]
    rank: int
    setup: Setup | None
    warnings: tuple[str, ...]
    version: str


class RobotFacts(Record, frozen=True):
    """A nominal robot.

    Attributes
    ----------
    name : str
        Its name.
    wheelbase_m : float
        Its wheelbase, in m.
    wheel_diameter_left_m : float
        Diameter of its left wheel, in m.
    wheel_diameter_right_m : float
        Diameter of its right wheel, in m.
    ticks_per_revolution : float
        Ticks of an encoder in a revolution of its wheel.
    encoder_rate_hz : float or None
        How often the encoders are read, in Hz; None where that is not known.
    counter_bits : int or None
        Bits of the counters; None where they do not roll over.
    """

    name: str
    wheelbase_m: float
    wheel_diameter_left_m: float
    wheel_diameter_right_m: float
    ticks_per_revolution: float
    encoder_rate_hz: float | None
    counter_bits: int | None


class PathFacts(Record, frozen=True):
    """A path.

    Attributes
    ----------
    shape : str
        Its shape.
    sizes : dict[str, float or tuple[tuple[float, ...], ...]]
        Its sizes, in the units that their names carry, or its points.
    length_m : float
        Its length, in m.
    """

    shape: str
    sizes: dict[str, float | tuple[tuple[float, ...], ...]]
    length_m: float


class Group(Record, frozen=True):
    """Numbers of runs of one test and direction, and of what they have.

    Attributes
    ----------
    test : str
        "systematic" or "bumps".
    direction : str or None
        "cw" or "ccw"; None for runs of neither.
    runs : int
        Number of runs.
    returns : int
        How many of them have a return error.
    headings : int
        How many of these have a heading.
    logs : int
        How many of the runs have a log.
    """

    test: str
    direction: str | None
    runs: int
    returns: int
    headings: int
    logs: int


class LogFacts(Record, frozen=True):
    """A log: its rows, and what its ticks and poses say.

    Attributes
    ----------
    name : str
        Name of its run.
    direction : str or None
        "cw" or "ccw"; None for neither.
    rows : int
        Number of rows.
    duration_s : float
        From the first row to the last, in s.
    rate_hz : float
        Rows in a second.
    jitter : float
        Scatter of the time from row to row, as a share of it.
    longest_gap_s : float
        The longest time without a row, in s.
    gaps : int
        Number of gaps.
    mended : Mended
        What was mended while it was read.
    length_m : float or None
        Length of the way by the ticks, in m; None without a nominal robot.
    heading_rad : float or None
        Heading at the end by the ticks, in rad; None without a nominal robot.
    heading_off_rad : float or None
        How far that is off what the path asks for, in rad; None where the path is not known.
    wheels : WheelFacts or None
        Whether the wheels are what they are called; None where the poses do not show it.
    moves : Moves or None
        What was driven; None without a nominal robot.
    delay_s : Measured or None
        How much older than its stamp a pose is in the middle of the run, in s; None where the
        motion does not show it.
    reference : ReferenceFacts or None
        Its absolute poses; None where it has none.
    """

    name: str
    direction: str | None
    rows: int
    duration_s: float
    rate_hz: float
    jitter: float
    longest_gap_s: float
    gaps: int
    mended: Mended
    length_m: float | None
    heading_rad: float | None
    heading_off_rad: float | None
    wheels: WheelFacts | None
    moves: Moves | None
    delay_s: Measured | None
    reference: ReferenceFacts | None


class Mended(Record, frozen=True):
    """What was mended in a log while it was read, counted.

    Attributes
    ----------
    roll_overs : int
        Counters that rolled over.
    resets : int
        Counters that began anew.
    rows_out_of_order : int
        Rows that were out of order.
    rows_repeated : int
        Rows that stood there twice.
    stale_poses : int
        Poses that were those of the row before.
    """

    roll_overs: int
    resets: int
    rows_out_of_order: int
    rows_repeated: int
    stale_poses: int


class WheelFacts(Record, frozen=True):
    """Whether the wheels are what they are called, by the motion of the poses.

    Attributes
    ----------
    as_named : bool
        Whether they are.
    exchanged : bool
        Whether left and right are exchanged.
    left_backward : bool
        Whether the left one counts backward.
    right_backward : bool
        Whether the right one counts backward.
    """

    as_named: bool
    exchanged: bool
    left_backward: bool
    right_backward: bool


class Moves(Record, frozen=True):
    """What was driven, by the ticks.

    Attributes
    ----------
    shape : str or None
        Shape of the path; None where it is none that has a name.
    described : str
        The path in words.
    legs : int
        Number of straight legs.
    turns : int
        Number of turns on the spot.
    arcs : int
        Number of arcs.
    stops : int
        Number of stops.
    """

    shape: str | None
    described: str
    legs: int
    turns: int
    arcs: int
    stops: int


class ReferenceFacts(Record, frozen=True):
    """The absolute poses of a log.

    Attributes
    ----------
    poses : int
        Number of poses.
    headings : int
        How many of them have a heading.
    rate_hz : float
        Poses in a second.
    coverage : str
        Where on the way they lie, in words.
    longest_gap_s : float
        The longest time without one, in s.
    noise_m : float or None
        Noise of a coordinate, in m; None where the poses do not show it.
    heading_noise_rad : float or None
        Noise of a heading, in rad; None where the poses do not show it.
    """

    poses: int
    headings: int
    rate_hz: float
    coverage: str
    longest_gap_s: float
    noise_m: float | None
    heading_noise_rad: float | None


class Clock(Record, frozen=True):
    """How the clock and the body of a run's track lie against those of the ticks.

    Attributes
    ----------
    offset_s : Measured
        How much later the clock of the track is, in s.
    rate : Measured
        How much faster it goes, in s/s.
    lever_ahead_m : Measured or None
        How far ahead of the centre of the axle the tracked point lies, in m; None where the motion
        does not show it.
    lever_left_m : Measured or None
        How far to the left of it the tracked point lies, in m; None where the motion does not show
        it.
    yaw_rad : Measured or None
        Heading of the tracked body minus heading of the robot, in rad; None where the motion does
        not show it.
    misfit_m : float
        Root mean square of what is left, in m.
    windows : int
        Number of windows that were compared.
    left_out : int
        Number of these that were left out.
    run : str
        Name of the run.
    track : str
        Name of the track.
    """

    offset_s: Measured
    rate: Measured
    lever_ahead_m: Measured | None
    lever_left_m: Measured | None
    yaw_rad: Measured | None
    misfit_m: float
    windows: int
    left_out: int
    run: str
    track: str


class Topics(Record, frozen=True):
    """Where the log of a run was found in an MCAP file.

    Attributes
    ----------
    run : str
        Name of the run.
    wheels : str
        Topic of the wheels.
    reference : str or None
        Topic of the reference; None where there is none.
    """

    run: str
    wheels: str
    reference: str | None


class Check(Record, frozen=True):
    """A figure, and what good looks like.

    Attributes
    ----------
    name : str
        What is looked at.
    found : str
        The figure that was found.
    good : str
        What good looks like.
    ok : bool
        Whether it is good.
    """

    name: str
    found: str
    good: str
    ok: bool


class Determined(Record, frozen=True):
    """Whether the data determines a quantity, and why.

    Attributes
    ----------
    quantity : str
        What is asked for.
    yes : bool
        Whether the data determines it.
    std_error : float or None
        Standard error that this data promises with noise of the usual size, as a share of one; None
        where the data does not show the quantity, or it is no value of the robot.
    usual_size : float or None
        Usual size of the error in robots, as a share of one; None where it is no value of the
        robot.
    because : str
        Why, or what would help.
    """

    quantity: str
    yes: bool
    std_error: float | None
    usual_size: float | None
    because: str


class Learnt(Result, frozen=True):
    """What was learnt, from the nominal robot to the model.

    Attributes
    ----------
    steps : tuple[Step, ...]
        The nominal robot, and each effect that was added.
    verdict : str
        What the last diagnosis says, in the words of ``Diagnosis``.
    unlisted : Unlisted or None
        What is missing and not in the catalogue; None where nothing is.
    next_experiments : tuple[Experiment, ...]
        What to measure next, the most telling per minute first.
    model : Model
        The model that was learnt.
    fitted : tuple[Estimate, ...]
        Its free parameters.
    meaning : dict[str, str]
        What each fitted effect means for the robot, a sentence each.
    outliers : tuple[Outlier, ...]
        Jumps of tracks that are beyond noise.
    setup : Setup
        What was found of the data before anything was fitted: faults, clock and mounting of the
        reference, jumps, wrong poses, runs far from the others.
    taken : tuple[Taken, ...]
        Effects of the reference whose values were taken from the motion.
    reasons : tuple[str, ...]
        Why the model is not called explained, a sentence each.
    repeats : Repeated or None
        What repeats most beside the model, whether it counts or not; None without tracks.
    remarks : tuple[str, ...]
        What else should be said.
    partial : bool
        Whether it was stopped while an effect was still missing.
    size : float
        Probability with which an effect is added to a complete model.
    draws : int
        Simulated tests for p-values that have no closed form.
    seed : int
        Seed of those.
    version : str
        Version of umbmark.
    left_m : float or None
        Error that is left, in m.
    repeats_m : Repeats or None
        How much of it is the same in every run of one path, in m; None where no two runs drive one
        path.
    remains : Remains or None
        The same in detail, with what chance there is; None where columns are not what they are
        called.
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
    remarks: tuple[str, ...]
    partial: bool
    size: float
    draws: int
    seed: int
    version: str
    left_m: float | None
    repeats_m: Repeats | None
    remains: Remains | None


class Step(Record, frozen=True):
    """One line of the story of a learnt model.

    Attributes
    ----------
    added : str or None
        The effect that was added; None for the nominal robot.
    class_ : tuple[str, ...]
        Effects that this data cannot tell from it, itself among them.
    p_adjusted : float or None
        p of it, corrected for all classes that were asked; None where nothing was asked.
    law : Repeated or None
        The law of a step which no effect of the catalogue makes: how it was found, what else it may
        be, and its formula as it was fitted.
    rmse_m : float or None
        Error of positions in the runs that the model was fitted to, in m.
    heading_rmse_rad : float or None
        The same of headings, in rad; None where none were measured.
    heldout_rmse_m : float or None
        Error of positions in runs left out, in m.
    heldout_heading_rmse_rad : float or None
        The same of headings, in rad; None where none were measured.
    aicc : float or None
        Akaike's information criterion, corrected for few runs; None where these are too few.
    bic : float or None
        Schwarz's information criterion; None where the runs are too few.
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


class Paper(Result, frozen=True, kw_only=True):
    """The paper's experiments; those that were not asked for are left out.

    Attributes
    ----------
    table_1 : TableOne or UnsetType
        E_max,sys and sigma of every robot, simulated.
    table_2 : TableTwo or UnsetType
        The extended test with ten bumps of 10 mm.
    figure_2 : Masking or UnsetType
        Two errors that cancel in one direction (Figs. 2 to 4).
    figure_5 : tuple[Cluster, ...] or UnsetType
        Return positions of one test.
    figure_6 : tuple[BumpPlace, ...] or UnsetType
        Where the bumps lie.
    figure_eight : tuple[BothWays, ...] or UnsetType
        Section 3.1: what a figure-eight hides.
    rectangle : tuple[BothWays, ...] or UnsetType
        Section 4.5: the 7 x 4 m rectangle.
    seed : int
        Seed of all random numbers.
    version : str
        Version of umbmark.
    """

    table_1: TableOne | UnsetType = UNSET
    table_2: TableTwo | UnsetType = UNSET
    figure_2: Masking | UnsetType = UNSET
    figure_5: tuple[Cluster, ...] | UnsetType = UNSET
    figure_6: tuple[BumpPlace, ...] | UnsetType = UNSET
    figure_eight: tuple[BothWays, ...] | UnsetType = UNSET
    rectangle: tuple[BothWays, ...] | UnsetType = UNSET
    seed: int
    version: str


class TableOne(Record, frozen=True):
    """Table I.

    Attributes
    ----------
    trials : int
        Simulated tests of each robot.
    rows : tuple[RobotOfTableOne, ...]
        Its rows.
    clapper_would_take : tuple[LinkError, ...]
        What would leave the CLAPPER's published E_max,sys, each alone and to first order.
    """

    trials: int
    rows: tuple[RobotOfTableOne, ...]
    clapper_would_take: tuple[LinkError, ...]


class RobotOfTableOne(Record, frozen=True):
    """A robot of Table I.

    Attributes
    ----------
    row : str
        Its name there.
    robot : str
        Its name in flags.
    e_max_sys_m : PublishedNumber
        E_max,sys, in m.
    sigma_m : PublishedNumber
        Standard deviation of one coordinate, in m.
    from_ : From
        Where its numbers are from.
    """

    row: str
    robot: str
    e_max_sys_m: PublishedNumber
    sigma_m: PublishedNumber
    from_: From = msgspec.field(name="from")


class PublishedNumber(Record, frozen=True):
    """A published number among those that were simulated, in SI.

    Attributes
    ----------
    published : float
        What the paper says, or what follows from it.
    mean : float
        Mean of the simulated tests.
    middle_95 : Interval
        Where the middle 95 % of them lie.
    share_below_published : float
        Share of them below the published number.
    inside : bool
        Whether the published number lies in the middle 95 %.
    """

    published: float
    mean: float
    middle_95: Interval
    share_below_published: float
    inside: bool


class From(Record, frozen=True):
    """Where the numbers of a robot are from.

    Attributes
    ----------
    sources : tuple[str, ...]
        What is taken from the paper, a phrase each.
    assumed : tuple[str, ...]
        What the paper leaves open, a phrase each.
    """

    sources: tuple[str, ...]
    assumed: tuple[str, ...]


class LinkError(Record, frozen=True):
    """A size of an error of the CLAPPER's link.

    Attributes
    ----------
    effect : str
        The effect.
    parameter : str
        Its parameter.
    size : float
        How far from where it does nothing.
    """

    effect: str
    parameter: str
    size: float


class TableTwo(Record, frozen=True):
    """Table II.

    Attributes
    ----------
    trials : int
        Simulated tests of each robot.
    columns : tuple[RobotOfTableTwo, ...]
        Its columns.
    clapper_corrected_rad : float
        What ten bumps turn the CLAPPER by without other noise, its correction on, in rad.
    clapper_uncorrected_rad : float
        The same with its correction off.
    """

    trials: int
    columns: tuple[RobotOfTableTwo, ...]
    clapper_corrected_rad: float
    clapper_uncorrected_rad: float


class RobotOfTableTwo(Record, frozen=True):
    """A robot of Table II.

    Attributes
    ----------
    robot : str
        Its name there.
    preset : str
        Its name in flags.
    printed_rad : float
        The average as printed, in rad.
    recomputed : PublishedNumber
        The average as it follows from the printed headings, in rad.
    heading_noise_rad : float
        Standard deviation with which headings were measured in the simulated tests, in rad.
    runs_rad : Interval
        The least and the largest deviation of a single run, in rad.
    """

    robot: str
    preset: str
    printed_rad: float
    recomputed: PublishedNumber
    heading_noise_rad: float
    runs_rad: Interval


class Masking(Record, frozen=True):
    """Figs. 2 to 4: two errors that cancel in one direction and add up in the other.

    Attributes
    ----------
    e_d : float
        E_d of the robot.
    e_b : float
        E_b of the robot.
    rows : tuple[BothWays, ...]
        One error, the other, both.
    """

    e_d: float
    e_b: float
    rows: tuple[BothWays, ...]


class BothWays(Record, frozen=True):
    """What a robot returns with, either way.

    Attributes
    ----------
    what : str
        What is tried.
    ccw : tuple[float, float, float]
        Counter-clockwise.
    cw : tuple[float, float, float]
        Clockwise.
    """

    what: str
    ccw: tuple[float, float, float]
    cw: tuple[float, float, float]


class Cluster(Record, frozen=True):
    """Fig. 5: the return positions of one direction.

    Attributes
    ----------
    direction : str
        Its name.
    returns_m : tuple[Interval, ...]
        x and y of each run, in m.
    centre_m : Interval
        Their centre of gravity, in m.
    r_m : float
        Its distance from START, in m.
    """

    direction: str
    returns_m: tuple[Interval, ...]
    centre_m: Interval
    r_m: float


class BumpPlace(Record, frozen=True):
    """Fig. 6: where ten bumps lie on the first leg.

    Attributes
    ----------
    bumps : str
        Where.
    return_position_m : float
        Distance from START after the run, in m.
    return_heading_rad : float
        Heading after the run, in rad.
    """

    bumps: str
    return_position_m: float
    return_heading_rad: float


class Plan(Result, frozen=True):
    """What a test would show before it is driven.

    Attributes
    ----------
    robot : str
        Name of the robot.
    runs : int
        Runs in each direction that are planned.
    minutes_a_run : float
        How long a run takes, in min.
    sigma_m : float
        Scatter of the return positions, one coordinate, in m.
    sigma_interval_m : Interval or None
        Its interval, in m; None where it is not from data.
    e_max_sys_m : float
        E_max,sys of the robot on its path, in m.
    with_heading : bool
        Whether return headings are measured.
    power : float
        Probability with which a size is to be seen.
    size : float
        False-alarm rate: probability with which a robot without it is accused.
    draws : int
        Simulated tests behind every figure that has no closed form.
    seed : int
        Seed of those.
    see : tuple[Sought, ...]
        The sizes that are to be seen, with the runs that they take.
    by_runs : tuple[OfRuns, ...]
        What each number of runs a direction shows.
    invisible : tuple[str, ...]
        Effects that no number of runs shows.
    alternatives : tuple[Alternative, ...]
        Another size, another speed, one direction only.
    extended : ExtendedTest or None
        The extended test; None without bumps.
    order : tuple[Drift, ...]
        What a drift of the session does in each order of the runs.
    assumed : tuple[str, ...]
        What was assumed, a phrase each.
    partial : bool
        Whether it was stopped before all was looked at.
    version : str
        Version of umbmark.
    """

    robot: str
    runs: int
    minutes_a_run: float
    sigma_m: float
    sigma_interval_m: Interval | None
    e_max_sys_m: float
    with_heading: bool
    power: float
    size: float
    draws: int
    seed: int
    see: tuple[Sought, ...]
    by_runs: tuple[OfRuns, ...]
    invisible: tuple[str, ...]
    alternatives: tuple[Alternative, ...]
    extended: ExtendedTest | None
    order: tuple[Drift, ...]
    assumed: tuple[str, ...]
    partial: bool
    version: str


class Sought(Record, frozen=True):
    """A size that is to be seen, and how many runs a direction show it.

    Attributes
    ----------
    effect : str
        The effect.
    parameter : str
        Its parameter.
    value : float
        The size, in the unit of the parameter.
    seen_by : str
        "calibrate", "diagnose", "not_asked" or "never".
    absorbed_by : tuple[str, ...] or None
        The effects of the model that make up for it; None where it is not "never" seen.
    runs : int or None
        Runs a direction that show it; None where 1000 do not.
    runs_at_sigma_interval : tuple[int or None, int or None] or None
        The same at both ends of the interval of the scatter; None where that is not from data.
    power : float
        Probability with which the planned runs show it.
    experiments : tuple[Experiment, ...]
        Experiments that would show it where return poses do not.
    """

    effect: str
    parameter: str
    value: float
    seen_by: str
    absorbed_by: tuple[str, ...] | None
    runs: int | None
    runs_at_sigma_interval: tuple[int | None, int | None] | None
    power: float
    experiments: tuple[Experiment, ...]


class OfRuns(Record, frozen=True):
    """What a number of runs a direction shows.

    Attributes
    ----------
    runs : int
        Runs in each direction.
    minutes : float
        How long they take, in min.
    e_max_sys_m : ExpectedEMaxSys
        E_max,sys as they would read it.
    minimum_detectable : tuple[LeastSize, ...]
        The least sizes that they show.
    """

    runs: int
    minutes: float
    e_max_sys_m: ExpectedEMaxSys
    minimum_detectable: tuple[LeastSize, ...]


class ExpectedEMaxSys(Record, frozen=True):
    """E_max,sys as tests would read it, and how well.

    Attributes
    ----------
    mean : float
        Mean over tests, in m.
    std_dev : float
        Standard deviation over tests, in m.
    interval_half_width_m : float
        Half the width of its interval, in m.
    coverage : float
        The share of tests whose interval holds the true value.
    tests : int
        Number of simulated tests.
    noise_band_m : float
        E_max,sys that a robot without systematic error stays below, in m.
    """

    mean: float
    std_dev: float
    interval_half_width_m: float
    coverage: float
    tests: int
    noise_band_m: float


class LeastSize(Record, frozen=True):
    """The least size of an effect that is seen with the wanted power.

    Attributes
    ----------
    effect : str
        The effect.
    parameter : str
        Its parameter.
    size : float or None
        The size, in the unit of the parameter; None where none is seen.
    """

    effect: str
    parameter: str
    size: float | None


class Alternative(Record, frozen=True):
    """Another test in place of the planned one.

    Attributes
    ----------
    what : str
        What is driven.
    runs : Runs
        Numbers of runs.
    minutes : float
        How long it takes, in min.
    sigma_m : float
        Scatter of the return positions, one coordinate, in m.
    e_max_sys_interval_half_width_m : float or None
        Half the width of the interval of E_max,sys, in m; None where the test does not give one.
    minimum_detectable : tuple[LeastSize, ...]
        The least sizes that it shows.
    """

    what: str
    runs: Runs
    minutes: float
    sigma_m: float
    e_max_sys_interval_half_width_m: float | None
    minimum_detectable: tuple[LeastSize, ...]


class Runs(Record, frozen=True):
    """Numbers of runs in each direction.

    Attributes
    ----------
    cw : int
        Clockwise.
    ccw : int
        Counter-clockwise.
    """

    cw: int
    ccw: int


class ExtendedTest(Record, frozen=True):
    """The extended test, with bumps.

    Attributes
    ----------
    bumps : float
        Number of bumps in a run.
    runs : int
        Runs in each direction.
    minutes : float
        How long they take, in min.
    nonsys_orientation_rad : float
        Average absolute orientation error (Eq. 5), in rad.
    interval_half_width_rad : float
        Half the width of its interval, in rad.
    """

    bumps: float
    runs: int
    minutes: float
    nonsys_orientation_rad: float
    interval_half_width_rad: float


class Drift(Record, frozen=True):
    """A change over the session, and the error that it makes in an order of the runs.

    Attributes
    ----------
    effect : str
        The effect that changes.
    parameter : str
        Its parameter.
    change : float
        By how much it changes, in the unit of the parameter.
    order : str
        "mirrored", "alternating" or "blocks".
    error : dict[str, float]
        The error that it makes, of each quantity.
    error_sd : dict[str, float]
        The same in standard deviations.
    """

    effect: str
    parameter: str
    change: float
    order: str
    error: dict[str, float]
    error_sd: dict[str, float]


class Separation(Result, frozen=True):
    """Experiments that tell two effects apart, the most telling per minute first.

    Attributes
    ----------
    separates : tuple[str, str]
        The two effects.
    beside : str
        What the experiments come on top of.
    next_experiments : tuple[Experiment, ...]
        How many standard deviations apart each puts them, and how long it takes.
    seed : int
        Seed of the simulated tests.
    version : str
        Version of umbmark.
    """

    separates: tuple[str, str]
    beside: str
    next_experiments: tuple[Experiment, ...]
    seed: int
    version: str


class Report(Result, frozen=True):
    """A page of everything.

    Attributes
    ----------
    bytes : int
        Its length.
    studies : tuple[Said, ...]
        The verdict of each study on it, and what to know of its data first.
    seed : int
        Seed of all random numbers.
    version : str
        Version of umbmark.
    """

    bytes: int
    studies: tuple[Said, ...]
    seed: int
    version: str


class Said(Record, frozen=True):
    """What a study comes to.

    Attributes
    ----------
    name : str
        Its name.
    notices : tuple[str, ...]
        What to know of its data first, a sentence each.
    verdict : str
        What it comes to, in one sentence.
    """

    name: str
    notices: tuple[str, ...]
    verdict: str


class Score(Result, frozen=True):
    """The scores of a UMBmark test, with intervals that hold with probability ``level``.

    Lengths are in m, angles in rad, counter-clockwise positive; points are (x, y), intervals
    (low, high). A score is None where the runs do not give it, and ``warnings`` says why.

    Attributes
    ----------
    e_max_sys_m : float or None
        E_max,sys: the larger distance of the two centroids from START (Eq. 4).
    e_max_sys_interval_m : Interval or None
        Its interval; None with fewer than three runs in a direction.
    noise_band_m : float or None
        E_max,sys that a robot without systematic error stays below, by the scatter of its runs.
    sigma_m : float or None
        Standard deviation of one coordinate about its direction's centroid, n - 1, pooled over both
        coordinates and directions.
    sigma_interval_m : Interval or None
        Its interval.
    sigma_radial_m : float or None
        Standard deviation of the distance from the centroid.
    n_cw : int
        Number of clockwise runs.
    centroid_cw_m : Interval or None
        Centre of gravity of the clockwise runs (Eq. 2).
    centroid_cw_interval_m : tuple[Interval or None, Interval or None] or None
        The intervals of its coordinates.
    centroid_cw_ellipse : Ellipse or None
        The ellipse that holds it.
    return_heading_cw_rad : float or None
        Mean return heading of the clockwise runs whose heading was measured (Eq. 6).
    return_heading_cw_interval_rad : Interval or None
        Its interval.
    n_ccw : int
        Number of counter-clockwise runs.
    centroid_ccw_m : Interval or None
        Centre of gravity of the counter-clockwise runs (Eq. 2).
    centroid_ccw_interval_m : tuple[Interval or None, Interval or None] or None
        The intervals of its coordinates.
    centroid_ccw_ellipse : Ellipse or None
        The ellipse that holds it.
    return_heading_ccw_rad : float or None
        Mean return heading of the counter-clockwise runs whose heading was measured (Eq. 6).
    return_heading_ccw_interval_rad : Interval or None
        Its interval.
    nonsys_orientation_rad : float or None
        Average absolute orientation error of the extended test (Eq. 5).
    nonsys_orientation_interval_rad : Interval or None
        Its interval.
    nonsys_convention : str or None
        "mean" for half of Eq. 5, which Table II has, or "sum" for Eq. 5 as printed.
    n_bumps_cw : int
        Number of clockwise runs with bumps.
    n_bumps_ccw : int
        Number of counter-clockwise runs with bumps.
    level : float
        Probability with which each interval holds.
    setup : Setup
        What was found of the runs before they were scored: faults, jumps and wrong poses of tracks,
        runs whose return is far from the others. Empty where return errors were given in arrays.
    warnings : tuple[str, ...]
        What to know of the data first; then what could not be computed and why, and what looks
        wrong.
    version : str
        Version of umbmark.
    """

    e_max_sys_m: float | None
    e_max_sys_interval_m: Interval | None
    noise_band_m: float | None
    sigma_m: float | None
    sigma_interval_m: Interval | None
    sigma_radial_m: float | None
    n_cw: int
    centroid_cw_m: Interval | None
    centroid_cw_interval_m: tuple[Interval | None, Interval | None] | None
    centroid_cw_ellipse: Ellipse | None
    return_heading_cw_rad: float | None
    return_heading_cw_interval_rad: Interval | None
    n_ccw: int
    centroid_ccw_m: Interval | None
    centroid_ccw_interval_m: tuple[Interval | None, Interval | None] | None
    centroid_ccw_ellipse: Ellipse | None
    return_heading_ccw_rad: float | None
    return_heading_ccw_interval_rad: Interval | None
    nonsys_orientation_rad: float | None
    nonsys_orientation_interval_rad: Interval | None
    nonsys_convention: str | None
    n_bumps_cw: int
    n_bumps_ccw: int
    level: float
    setup: Setup
    warnings: tuple[str, ...]
    version: str


class Ellipse(Record, frozen=True):
    """The ellipse that holds a centre of gravity.

    Attributes
    ----------
    semi_major_m : float
        Major semi-axis, in m.
    semi_minor_m : float
        Minor semi-axis, in m.
    angle_rad : float
        Angle of the major axis, in rad.
    """

    semi_major_m: float
    semi_minor_m: float
    angle_rad: float


class Sensitivity(Result, frozen=True, kw_only=True):
    """Which parameter drives which metric.

    Attributes
    ----------
    method : str
        "sobol", "morris" or "local".
    base_points : int or UnsetType
        Base points of Sobol indices.
    trajectories : int or UnsetType
        Trajectories of Morris.
    trials : int or UnsetType
        Tests on each side for derivatives.
    evaluations : int or UnsetType
        Tests that were simulated.
    seed : int
        Seed of all random numbers.
    partial : bool
        Whether less was done than was asked for.
    noise : str
        "simulated" or "absent".
    parameters : tuple[Varied, ...]
        What was varied.
    correlations : tuple[Correlation, ...]
        Correlations of the parameters.
    metrics : dict[str, OfMetric]
        Sensitivities of each metric; "noise" stands for all that is random in a test.
    assumed : tuple[str, ...]
        What was assumed, a phrase each.
    version : str
        Version of umbmark.
    """

    method: str
    base_points: int | UnsetType = UNSET
    trajectories: int | UnsetType = UNSET
    trials: int | UnsetType = UNSET
    evaluations: int | UnsetType = UNSET
    seed: int
    partial: bool
    noise: str
    parameters: tuple[Varied, ...]
    correlations: tuple[Correlation, ...]
    metrics: dict[str, OfMetric]
    assumed: tuple[str, ...]
    version: str


class Varied(Record, frozen=True):
    """A parameter and the distribution that it was drawn from.

    Attributes
    ----------
    name : str
        Full name of the parameter.
    flag : str
        Its flag.
    distribution : dict[str, float or str]
        Its distribution, as in ``model.toml``.
    """

    name: str
    flag: str
    distribution: dict[str, float | str]


class Correlation(Record, frozen=True):
    """Correlation of the normal scores of two parameters.

    Attributes
    ----------
    of : tuple[str, str]
        The two parameters.
    value : float
        The correlation.
    """

    of: tuple[str, str]
    value: float


class OfMetric(Record, frozen=True, kw_only=True):
    """Sensitivities of a metric, by parameter; those that the method gives.

    Attributes
    ----------
    mean : WithInterval or UnsetType
        Mean of the metric.
    std_dev : WithInterval or UnsetType
        Its standard deviation.
    first : dict[str, WithInterval] or UnsetType
        Sobol indices: the share of the variance that a parameter makes alone.
    total : dict[str, WithInterval] or UnsetType
        Sobol indices: the share that it makes alone and with others.
    second : tuple[OfPair, ...] or UnsetType
        Sobol indices of pairs.
    mu : dict[str, WithInterval] or UnsetType
        Morris: mean of the elementary effects.
    mu_star : dict[str, WithInterval] or UnsetType
        Morris: mean of their sizes.
    sigma : dict[str, WithInterval] or UnsetType
        Morris: their standard deviation.
    per_unit : dict[str, WithInterval] or UnsetType
        Derivative by the parameter.
    per_spread : dict[str, WithInterval] or UnsetType
        Derivative times the spread of the parameter.
    """

    mean: WithInterval | UnsetType = UNSET
    std_dev: WithInterval | UnsetType = UNSET
    first: dict[str, WithInterval] | UnsetType = UNSET
    total: dict[str, WithInterval] | UnsetType = UNSET
    second: tuple[OfPair, ...] | UnsetType = UNSET
    mu: dict[str, WithInterval] | UnsetType = UNSET
    mu_star: dict[str, WithInterval] | UnsetType = UNSET
    sigma: dict[str, WithInterval] | UnsetType = UNSET
    per_unit: dict[str, WithInterval] | UnsetType = UNSET
    per_spread: dict[str, WithInterval] | UnsetType = UNSET


class WithInterval(Record, frozen=True):
    """A number with its interval.

    Attributes
    ----------
    value : float or None
        The number; None where it cannot be estimated.
    interval : tuple[float or None, float or None]
        Its 95 % interval, an end None where it cannot be estimated.
    """

    value: float | None
    interval: tuple[float | None, float | None]


class OfPair(Record, frozen=True):
    """The share of two parameters together.

    Attributes
    ----------
    value : float or None
        The share; None where it cannot be estimated.
    interval : tuple[float or None, float or None]
        Its 95 % interval, an end None where it cannot be estimated.
    of : tuple[str, str]
        The two parameters.
    """

    value: float | None
    interval: tuple[float | None, float | None]
    of: tuple[str, str]


class MonteCarlo(Result, frozen=True):
    """What a study found.

    Attributes
    ----------
    n : int
        Trials done.
    seed : int
        Seed of all random numbers.
    partial : bool
        Whether trials that were asked for are not done.
    metrics : dict[str, MetricStatistics]
        The metrics that the test has: "e_max_sys_m", "sigma_m", "centroid_cw_x_m", ...
    trials_per_s : float or None
        Trials in a second; None where that was not measured.
    noise_free : NoiseFree
        The same test without noise.
    runs : Runs
        Numbers of runs of each test.
    robot : str
        Name of the robot.
    path : PathSizes
        The path.
    effects : tuple[dict[str, str or float or dict[str, float or str]], ...]
        The effects, in the order in which they act: each with its name and its values, or the
        distributions that these are drawn from.
    sources : tuple[str, ...]
        Where values are from, a phrase each.
    assumed : tuple[str, ...]
        What was assumed, a phrase each.
    published : Published or None
        What was published of this test; None where nothing was.
    version : str
        Version of umbmark.
    """

    n: int
    seed: int
    partial: bool
    metrics: dict[str, MetricStatistics]
    trials_per_s: float | None
    noise_free: NoiseFree
    runs: Runs
    robot: str
    path: PathSizes
    effects: tuple[dict[str, str | float | dict[str, float | str]], ...]
    sources: tuple[str, ...]
    assumed: tuple[str, ...]
    published: Published | None
    version: str


class MetricStatistics(Record, frozen=True):
    """Statistics of a metric over the trials, in its unit.

    Attributes
    ----------
    mean : float or None
        Mean; None where no trial has the metric.
    std_dev : float or None
        Standard deviation; None below two trials.
    std_error : float or None
        Standard error of the mean; None below two trials.
    min : float or None
        Least value; None where no trial has the metric.
    max : float or None
        Greatest value; None where no trial has the metric.
    quantiles : dict[str, float or None]
        Quantiles, by the share that lies below.
    """

    mean: float | None
    std_dev: float | None
    std_error: float | None
    min: float | None
    max: float | None
    quantiles: dict[str, float | None]


class NoiseFree(Record, frozen=True):
    """E_max,sys of the test without noise.

    Attributes
    ----------
    e_max_sys_m : float or None
        By exact kinematics, in m; None without runs of both directions.
    first_order_e_max_sys_m : float or None
        By the formulas of the paper's companion, in m; None where the test is no square of a
        differential drive.
    """

    e_max_sys_m: float | None
    first_order_e_max_sys_m: float | None


class PathSizes(Record, frozen=True):
    """Shape and sizes of a path.

    Attributes
    ----------
    shape : str
        Its shape.
    sizes : dict[str, float]
        Its sizes, in the units that their names carry.
    """

    shape: str
    sizes: dict[str, float]


class Published(Record, frozen=True):
    """What was published of a robot: its row of Table I.

    Attributes
    ----------
    row : str
        The row.
    e_max_sys_m : float
        E_max,sys, in m.
    sigma_m : float
        Standard deviation of one coordinate, in m.
    """

    row: str
    e_max_sys_m: float
    sigma_m: float


class Sweep(Result, frozen=True):
    """A study on every point of a grid.

    Attributes
    ----------
    axes : tuple[Axis, ...]
        What is swept; the last axis varies fastest.
    n : int
        Trials of each point. Trial i has the same noise at every point.
    seed : int
        Seed of all random numbers.
    partial : bool
        Whether points that were asked for are not done.
    points : tuple[Point, ...]
        The points, in order.
    assumed : tuple[str, ...]
        What was assumed, a phrase each.
    version : str
        Version of umbmark.
    """

    axes: tuple[Axis, ...]
    n: int
    seed: int
    partial: bool
    points: tuple[Point, ...]
    assumed: tuple[str, ...]
    version: str


class Axis(Record, frozen=True):
    """Equally spaced values of a parameter.

    Attributes
    ----------
    name : str
        Full name of the parameter.
    flag : str
        Its flag.
    first : float
        First value.
    last : float
        Last value.
    count : int
        Number of values.
    """

    name: str
    flag: str
    first: float
    last: float
    count: int


class Point(Record, frozen=True):
    """A point of the grid.

    Attributes
    ----------
    values : tuple[float, ...]
        The values of the axes.
    metrics : dict[str, Summary]
        The metrics there.
    """

    values: tuple[float, ...]
    metrics: dict[str, Summary]


class Summary(Record, frozen=True):
    """Statistics of a metric over the trials of a point, in its unit.

    Attributes
    ----------
    mean : float or None
        Mean; None where no trial has the metric.
    std_dev : float or None
        Standard deviation; None below two trials.
    std_error : float or None
        Standard error of the mean; None below two trials.
    quantiles : dict[str, float or None]
        Quantiles, by the share that lies below.
    """

    mean: float | None
    std_dev: float | None
    std_error: float | None
    quantiles: dict[str, float | None]


class Tolerance(Result, frozen=True):
    """How many robots keep a target, and the cheapest tolerances with which enough do.

    Attributes
    ----------
    metric : str
        The metric of the target.
    target : Target
        The target.
    noise : str
        "simulated" or "absent".
    robots : int
        Robots drawn for each choice of grades.
    seed : int
        Seed of the robots.
    partial : bool
        Whether not all choices were looked at.
    now : Choice
        The first grade of every parameter.
    alone : tuple[Choice, ...]
        One parameter tightened alone.
    last : Choice
        The last grade of every parameter.
    cheapest : Choice or None
        The cheapest choice that keeps the target surely, judged by robots drawn anew; None where
        none does.
    choices_looked_at : int
        Number of choices that were looked at.
    assumed : tuple[str, ...]
        What was assumed, a phrase each.
    version : str
        Version of umbmark.
    """

    metric: str
    target: Target
    noise: str
    robots: int
    seed: int
    partial: bool
    now: Choice
    alone: tuple[Choice, ...]
    last: Choice
    cheapest: Choice | None
    choices_looked_at: int
    assumed: tuple[str, ...]
    version: str


class Target(Record, frozen=True, kw_only=True):
    """The share of robots whose metric is to stay within a size.

    Attributes
    ----------
    at_most_m : float or UnsetType
        The size of a metric that is a length, in m.
    at_most_rad : float or UnsetType
        The size of a metric that is an angle, in rad.
    share : float
        The share.
    """

    at_most_m: float | UnsetType = UNSET
    at_most_rad: float | UnsetType = UNSET
    share: float


class Choice(Record, frozen=True):
    """Grades of all parameters, what they cost, and how good the robots are that they make.

    Attributes
    ----------
    grades : dict[str, Grade]
        The grade of each parameter.
    cost : float
        What they cost together.
    share_within : WithInterval
        The share of robots that keeps the target.
    quantile : WithInterval
        The size that the wanted share keeps.
    """

    grades: dict[str, Grade]
    cost: float
    share_within: WithInterval
    quantile: WithInterval


class Grade(Record, frozen=True):
    """A grade of tolerance.

    Attributes
    ----------
    grade : int
        Its number, from 1 as in the file.
    distribution : dict[str, float or str]
        Its distribution, as in ``model.toml``.
    cost : float
        What it costs.
    """

    grade: int
    distribution: dict[str, float | str]
    cost: float


class TrackComparison(Result, frozen=True):
    """Models beside tracks: where on the way their error is made, and what it depends on.

    Attributes
    ----------
    observed : str
        "tracks".
    n_cw : int
        Number of clockwise runs.
    n_ccw : int
        Number of counter-clockwise runs.
    n_other : int
        Number of runs of neither direction.
    poses : int
        Number of observations.
    models : tuple[JudgedAlong, ...]
        The models, in the order in which they were given.
    remarks : tuple[str, ...]
        What else should be said.
    setup : Setup
        What was found of the data before anything was fitted: faults, clock and mounting of the
        reference, jumps, wrong poses, runs far from the others.
    size : float
        False-alarm rate: probability with which a right model is accused.
    version : str
        Version of umbmark.
    left_m : float or None
        Error that is left, in m.
    repeats_m : Repeats or None
        How much of it is the same in every run of one path, in m; None where no two runs drive one
        path.
    remains : Remains or None
        The same in detail, with what chance there is; None where columns are not what they are
        called.
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


class JudgedAlong(Record, frozen=True):
    """How one model does along the way, and at its end.

    Attributes
    ----------
    name : str
        Its name.
    explains : bool or None
        Whether it explains the tracks; None where nothing was asked.
    p : float or None
        p of all tests together; None where nothing was asked.
    tests : int
        How many tests these are.
    along : RootMeanSquare
        Errors along the way.
    end : RootMeanSquare
        Errors at its end.
    parts : dict[str, tuple[Part, ...]]
        Error that each part of the way adds, by what the parts are told apart.
    overall : dict[str, Overall]
        Mean rates of the error.
    against : tuple[Against, ...]
        Rates of the error against quantities of the way.
    sentences : tuple[str, ...]
        What stands out, a sentence each.
    taken : tuple[Taken, ...]
        Effects of the reference whose values were taken from the motion.
    reasons : tuple[str, ...]
        Why the model does not explain the tracks, a sentence each.
    left_m : float or None
        Error that is left, in m.
    repeats_m : Repeats or None
        How much of it is the same in every run of one path, in m; None where no two runs drive one
        path.
    remains : Remains or None
        The same in detail, with what chance there is; None where columns are not what they are
        called.
    """

    name: str
    explains: bool | None
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


class RootMeanSquare(Record, frozen=True):
    """Root mean square errors.

    Attributes
    ----------
    rmse_m : float or None
        Of positions, in m.
    heading_rmse_rad : float or None
        Of headings, in rad; None where none were measured.
    """

    rmse_m: float | None
    heading_rmse_rad: float | None


class Part(Record, frozen=True):
    """Error that a part of the way adds.

    Attributes
    ----------
    forward_m : Mean
        Ahead, in m.
    sideways_m : Mean
        To the left, in m.
    heading_rad : Mean
        In heading, in rad.
    name : str
        Its name.
    direction : str or None
        "cw" or "ccw"; None for both together.
    count : int
        How many there are.
    share : PartShare
        Its share in the squared error.
    """

    forward_m: Mean
    sideways_m: Mean
    heading_rad: Mean
    name: str
    direction: str | None
    count: int
    share: PartShare


class Mean(Record, frozen=True):
    """A mean over runs with its interval, and the scatter of the runs.

    Attributes
    ----------
    mean : float or None
        The mean; None without runs.
    interval : tuple[float or None, float or None] or None
        Its interval, an end None where it is open; None with a single run.
    runs : int
        Number of runs.
    sd : float or None
        Standard deviation of the runs; None with a single one.
    """

    mean: float | None
    interval: tuple[float | None, float | None] | None
    runs: int
    sd: float | None


class PartShare(Record, frozen=True):
    """Share of a part of the way in the squared error.

    Attributes
    ----------
    position : float or None
        Of positions along the way.
    heading : float or None
        Of headings along the way.
    end : float or None
        Of positions at its end.
    """

    position: float | None
    heading: float | None
    end: float | None


class Overall(Record, frozen=True):
    """Mean rate of an error over all of the way.

    Attributes
    ----------
    mean : float or None
        The mean; None without runs.
    interval : tuple[float or None, float or None] or None
        Its interval, an end None where it is open; None with a single run.
    runs : int
        Number of runs.
    p : float or None
        p of none at all; None where it was not asked.
    """

    mean: float | None
    interval: tuple[float | None, float | None] | None
    runs: int
    p: float | None


class Against(Record, frozen=True):
    """Rate of an error against a quantity of the way.

    Attributes
    ----------
    rate : str
        The rate.
    covariate : str
        The quantity.
    unit : str
        Unit of the quantity.
    p : float or None
        p of no dependence; None where it was not asked.
    bins : tuple[Bin, ...]
        The rate in each span of the quantity.
    """

    rate: str
    covariate: str
    unit: str
    p: float | None
    bins: tuple[Bin, ...]


class Bin(Record, frozen=True):
    """Mean rate of an error where a quantity lies between two values, in a sense or in both.

    Attributes
    ----------
    mean : float or None
        The mean; None without runs.
    interval : tuple[float or None, float or None] or None
        Its interval, an end None where it is open; None with fewer than two runs.
    runs : int
        Number of runs.
    low : float
        Least value of the quantity.
    high : float or None
        Greatest value of the quantity; None where it is open.
    sense : float
        1 counter-clockwise, -1 clockwise, 0 both.
    amount : float
        How much of the way this is, in the unit of the rate.
    """

    mean: float | None
    interval: tuple[float | None, float | None] | None
    runs: int
    low: float
    high: float | None
    sense: float
    amount: float


class Effect(Record, frozen=True):
    """An effect of the catalogue: law, cause, signature, and what looks like it.

    Attributes
    ----------
    name : str
        Its name.
    title : str
        Its name in words.
    acts_on : str
        What it acts on.
    drives : tuple[str, ...]
        The drives that have it.
    equation : str
        Its law.
    physics : str
        Its cause.
    signature : str
        How it shows.
    confused_with : tuple[str, ...]
        Effects that look like it.
    separated_by : str
        What tells it from these.
    source : str
        Where it is from.
    parameters : tuple[Parameter, ...]
        Its parameters.
    """

    name: str
    title: str
    acts_on: str
    drives: tuple[str, ...]
    equation: str
    physics: str
    signature: str
    confused_with: tuple[str, ...]
    separated_by: str
    source: str
    parameters: tuple[Parameter, ...]


class Parameter(Record, frozen=True):
    """A number of an effect.

    Attributes
    ----------
    name : str
        Its name.
    flag : str
        Its flag.
    unit : str
        Its unit.
    default : float or str
        What it is where nothing is said; a word where it takes words, or is of the robot.
    typical : float
        Its usual size.
    bounds : tuple[float or None, float or None]
        The least and the greatest that it may be; an end None where it is open.
    choices : tuple[str, ...]
        The words that it takes; empty where it takes numbers.
    meaning : str
        What it means.
    """

    name: str
    flag: str
    unit: str
    default: float | str
    typical: float
    bounds: tuple[float | None, float | None]
    choices: tuple[str, ...]
    meaning: str
