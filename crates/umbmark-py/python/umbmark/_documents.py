"""Results as the command prints them, typed: written from the core's, not by hand.

``SNAPSHOTS=overwrite cargo test -p umbmark-cli --test all python_classes`` writes them anew.
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
        The corrections by "closed_form_x", "closed_form_y", "closed_form_mean", "heading", "exact"
        and "model"; None where the data does not allow it.
    exported : str or None
        The method whose correction is to be written into the robot; None where none gives both E_d
        and E_b.
    sentence : str or None
        The answer in words, as of ``solve``; None where no model could be learnt.
    observed : str
        "end_poses" or "tracks".
    heading_arm_m : float or None
        Weight of a heading error in m per rad if whole tracks were fitted; otherwise None.
    level : float
        Probability with which the intervals hold.
    setup : Setup
        Findings about the data before any fit: faults, clock and mounting of the reference, jumps,
        wrong poses, outlying runs.
    taken : tuple[Taken, ...]
        Effects of the reference whose values were estimated from the motion.
    doubts : tuple[str, ...]
        Reasons to doubt the corrected lengths, a sentence each; if there are any, nothing is
        exported.
    warnings : tuple[str, ...]
        Warnings: first about the data, then what could not be determined, and why.
    version : str
        Version of umbmark.
    """

    methods: dict[str, Correction | None]
    exported: str | None
    sentence: str | None
    observed: str
    heading_arm_m: float | None
    level: float
    setup: Setup
    taken: tuple[Taken, ...]
    doubts: tuple[str, ...]
    warnings: tuple[str, ...]
    version: str


class Correction(Record, frozen=True):
    """The corrections by one method; None for what the data does not determine.

    Attributes
    ----------
    e_d : float or None
        Ratio of the wheel diameters, right to left.
    e_b : float or None
        Ratio of the wheelbase to its nominal value.
    e_s : float or None
        Ratio of the mean wheel diameter to its nominal value.
    wheelbase_m : float or None
        Corrected wheelbase, in m.
    wheel_diameter_left_m : float or None
        Corrected diameter of the left wheel, in m.
    wheel_diameter_right_m : float or None
        Corrected diameter of the right wheel, in m.
    covariance : tuple[tuple[float, ...], ...] or None
        Covariance of the ratios named in ``covariance_of``.
    covariance_of : tuple[str, ...]
        The ratios that the data determines.
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
        E_max,sys that remains with the correction, in m.
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

    All of it follows from the motion and the return errors alone. It is empty for return errors
    in arrays and without a nominal robot.

    Attributes
    ----------
    faults : tuple[Fault, ...]
        Columns, units and frames that contradict their names. Correct these first: until then no
        number describes the robot.
    doubts : tuple[str, ...]
        What makes ticks or tracks suspicious although no fault is certain, a sentence each.
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
    doubts: tuple[str, ...]
    reference: Mounting | None
    delays: tuple[Delay, ...]
    jumps: tuple[Jump, ...]
    wrong_poses: tuple[WrongPose, ...]
    returns: tuple[OutlyingReturn, ...]


class Fault(Record, frozen=True):
    """A column, unit or frame that contradicts its name, and how to correct it.

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
    """How the poses of the reference relate to the wheels, over all runs.

    A quantity is None if the motion does not determine it.

    Attributes
    ----------
    delay_s : Measured
        Age of a pose at its time stamp, in the middle of a run, in s.
    clock_rate : Measured or None
        Growth of the delay, in s/s.
    ahead_m : Measured or None
        Distance of the tracked point ahead of the axle's centre, in m.
    left_m : Measured or None
        Distance of the tracked point to the left of the axle's centre, in m.
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
        Its standard error; None if the data does not determine it.
    interval : Interval or None
        Its 95 % interval; None if the data does not determine it.
    """

    value: float
    std_error: float | None
    interval: Interval | None


class Delay(Record, frozen=True):
    """The delay of the reference in a run.

    Attributes
    ----------
    run : str
        Name of the run.
    delay_s : Measured or None
        The delay, in s; None without enough motion.
    own_clock_s : float
        By how much the time stamps were set back before that, in s, because the clocks of the runs
        differ; else 0.
    """

    run: str
    delay_s: Measured | None
    own_clock_s: float


class Jump(Record, frozen=True):
    """A place where a track jumps, or a few seconds in which robot and wheels disagree.

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
        Motion of the tracked point that the wheels did not make, in m.
    turned_rad : float or None
        Rotation that the wheels did not make, in rad; None without headings.
    standard_deviations : float or None
        Size of the jump, in standard deviations of the motion from pose to pose; None where that is
        not known.
    unrecorded_s : float or None
        How long the log has no rows within it, in s: the way of the wheels is not known then; None
        where rows are as close as usual.
    """

    run: str
    since_s: float
    time_s: float
    moved_m: float
    turned_rad: float | None
    standard_deviations: float | None
    unrecorded_s: float | None


class WrongPose(Record, frozen=True):
    """A wrong pose: its neighbours contradict it.

    Attributes
    ----------
    run : str
        Name of the run.
    time_s : float
        Time since the log began, in s.
    moved_m : float
        Distance from the place that its neighbours imply, in m.
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
        Distance of the farthest coordinate, in standard deviations; None if the others do not
        scatter.
    deviants : tuple[Deviant, ...]
        The outlying coordinates, the farthest first.
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
    """A coordinate of a return error that is far from those of the other runs.

    Attributes
    ----------
    coordinate : str
        "x", "y" or "heading".
    value : float
        Its value, in m, a heading in rad.
    mean_of_others : float
        Mean of the other runs, in the same unit.
    standard_deviations : float or None
        Distance from that mean, in standard deviations of a run about it; None if the others do not
        scatter.
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
        Probability of values this large if the effect is absent.
    """

    effect: str
    parameters: dict[str, Measured]
    p: float


class Changed(Result, frozen=True):
    """What changed of a robot between two tests.

    Attributes
    ----------
    changed : bool
        Whether something of the robot changed by more than chance.
    as_before : bool
        Whether nothing changed by more than chance, and the test after is explained if the one
        before is.
    sentence : str
        The answer in words.
    robot : tuple[Moved, ...]
        Numbers of the robot and of its effects, and the scatter of its runs.
    reference : tuple[Moved, ...]
        Clock and mounting of the reference: not the robot's.
    alone : tuple[Alone, ...]
        Where return poses show ratios only, and these changed: each length that accounts for it by
        itself.
    start : StartMoved or None
        Where START lies elsewhere in the second test, if that accounts for the change of the return
        poses, too; else None.
    assumed : tuple[str, ...]
        Effects that one of the tests does not show, or with which it cannot be fitted; they are
        taken to be in it as in the other.
    with_before_m : float or None
        Error of the second test with the robot's numbers of before, in m; None where it is not
        known.
    with_after_m : float or None
        Error of the second test with its own numbers, in m; None where it is not known.
    doubts : tuple[str, ...]
        Why the answer is in doubt, a sentence each.
    before : TestBeside
        The first test.
    after : TestBeside
        The second test.
    size : float
        Probability with which something is said to have changed of a robot that did not; intervals
        hold with the rest.
    draws : int
        Simulated tests for p-values that have no closed form.
    seed : int
        Seed of those.
    version : str
        Version of umbmark.
    """

    changed: bool
    as_before: bool
    sentence: str
    robot: tuple[Moved, ...]
    reference: tuple[Moved, ...]
    alone: tuple[Alone, ...]
    start: StartMoved | None
    assumed: tuple[str, ...]
    with_before_m: float | None
    with_after_m: float | None
    doubts: tuple[str, ...]
    before: TestBeside
    after: TestBeside
    size: float
    draws: int
    seed: int
    version: str


class Moved(Record, frozen=True):
    """A number before and after.

    Attributes
    ----------
    key : str
        Its key: of robot.toml, with its unit; EFFECT.PARAMETER in the unit that the catalogue
        states; "wheel_diameter_ratio" (right over left) and "wheelbase_over_diameter" where the
        mean diameter is not shown; "scatter", the root mean square error that the median run
        leaves, in m.
    meaning : str
        What it is, in words.
    of : str
        What it belongs to: "robot", "effect", "scatter" or "reference".
    before : float
        Its value before.
    before_standard_error : float
        Standard error of that; of the scatter, of its logarithm.
    after : float
        Its value after.
    after_standard_error : float
        Standard error of that; of the scatter, of its logarithm.
    change : float
        After less before; of the scatter, after over before.
    interval : Interval or None
        Interval of the change.
    p : float
        p of no change.
    p_adjusted : float
        p adjusted for all numbers of its table (Holm).
    changed : bool
        Whether it changed by more than chance.
    seen : float or None
        The smallest change that 80 % of such pairs of tests show; of the scatter, the smallest
        factor above 1.
    """

    key: str
    meaning: str
    of: str
    before: float
    before_standard_error: float
    after: float
    after_standard_error: float
    change: float
    interval: Interval | None
    p: float
    p_adjusted: float
    changed: bool
    seen: float | None


class Alone(Record, frozen=True):
    """A length that accounts for a change of ratios by itself.

    Attributes
    ----------
    key : str
        Its key in robot.toml.
    share : float
        Change of it as a share of itself.
    standard_error : float or None
        Standard error of that.
    p : float
        p of what it leaves of the change.
    """

    key: str
    share: float
    standard_error: float | None
    p: float


class StartMoved(Record, frozen=True):
    """Where START lies elsewhere in the second test.

    Attributes
    ----------
    x_m : float
        Along the first leg, in m.
    y_m : float
        To its left, in m.
    heading_rad : float or None
        Counter-clockwise, in rad; None where the returns have no headings.
    p : float
        p of what it leaves of the change.
    """

    x_m: float
    y_m: float
    heading_rad: float | None
    p: float


class TestBeside(Record, frozen=True):
    """What one of the two tests says by itself.

    Attributes
    ----------
    verdict : str
        The verdict of its own model, in the words of ``Diagnosis``.
    doubt : str or None
        Why that model must not be used as it is; None where nothing speaks against it.
    runs : int
        Number of runs.
    fitted : tuple[Estimate, ...]
        All that was fitted to it.
    """

    verdict: str
    doubt: str | None
    runs: int
    fitted: tuple[Estimate, ...]


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
        Its standard error; None if the data does not determine it.
    interval : Interval or None
        Its interval; None if the data does not determine it.
    """

    effect: str
    parameter: str
    value: float
    standard_error: float | None
    interval: Interval | None


class Comparison(Result, frozen=True):
    """Models compared with measurements: which explain them, and where the others fail.

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
        Findings about the data before any fit: faults, clock and mounting of the reference, jumps,
        wrong poses, outlying runs.
    remarks : tuple[str, ...]
        Further remarks, a sentence each.
    size : float
        False-alarm rate: probability that a correct model is rejected.
    draws : int
        Simulated tests for the p-values.
    seed : int
        Seed of those.
    version : str
        Version of umbmark.
    contrasts : tuple[Contrast, ...]
        Closure contrasts of a square driven both ways; empty for other paths.
    circle : tuple[OnCircle, ...]
        End points relative to the circle through START; empty for other paths.
    left_m : float or None
        Remaining error, in m.
    repeats_m : Repeats or None
        The part of it that is the same in every run of one path, in m; None if no two runs drive
        one path.
    remains : Remains or None
        The same in detail, with the sources of noise; None if columns contradict their names.
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
    """Result of one model.

    Attributes
    ----------
    name : str
        Its name.
    explains : bool
        Whether it explains the runs.
    p : float
        p of all statistics together.
    noise : str
        "model" if the noise is the model's, "pooled" if it is the scatter of the runs.
    rmse_m : float
        Root mean square error of positions, in m.
    heading_rmse_rad : float or None
        The same of headings, in rad; None where none were measured.
    statistics : dict[str, dict[str, Statistic]]
        Each statistic, by direction and quantity.
    sentences : tuple[str, ...]
        Where it fails, a sentence each.
    left_m : float or None
        Remaining error, in m.
    repeats_m : Repeats or None
        The part of it that is the same in every run of one path, in m; None if no two runs drive
        one path.
    remains : Remains or None
        The same in detail, with the sources of noise; None if columns contradict their names.
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
        Probability of a difference this large if the model is right.
    """

    measured: float
    predicted: float
    p: float


class Repeats(Record, frozen=True):
    """Lower bound of the part of an error that is the same in every run of a path.

    Attributes
    ----------
    value : float
        Root mean square, in m or rad.
    low : float or None
        Lower end of its 95 % interval; None for fewer than three runs.
    high : float or None
        Upper end of its 95 % interval; None for fewer than three runs.
    """

    value: float
    low: float | None
    high: float | None


class Remains(Record, frozen=True):
    """The remaining error of a model.

    Attributes
    ----------
    left_m : float or None
        Root mean square error of positions, in m.
    repeats_m : Repeats or None
        The part that is the same in every run: the root of the mean product of the residuals of two
        runs at the same share of the path; None if no two runs drive one path.
    left_rad : float or None
        Root mean square error of headings, in rad; None where none were measured.
    repeats_rad : Repeats or None
        The part of it that is the same in every run; None if no two runs drive one path or no
        headings were measured.
    pairs_of_one_path : int
        Number of pairs of runs for these.
    piece_s : float or None
        Mean duration, in s, of the pieces of long runs that these are errors of, each from a START
        of its own; None for whole runs.
    chance : tuple[Chance, ...]
        Error that each source of noise alone would cause; empty for return poses.
    disturbances : tuple[Disturbance, ...]
        Accidental bumps and slips, and wrong poses of the reference.
    """

    left_m: float | None
    repeats_m: Repeats | None
    left_rad: float | None
    repeats_rad: Repeats | None
    pairs_of_one_path: int
    piece_s: float | None
    chance: tuple[Chance, ...]
    disturbances: tuple[Disturbance, ...]


class Chance(Record, frozen=True):
    """A source of noise, and the error that it alone would cause.

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
        Whether the robot was displaced for good, as by a bump; otherwise the reference was wrong
        for a moment.
    forward_m : float
        Displacement ahead in the robot's frame, in m.
    left_m : float
        Displacement to the left in the robot's frame, in m.
    heading_rad : float
        Rotation to the left, in rad; 0 if headings were not measured.
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
        Its 95 % interval; None if the runs do not determine it.
    meaning : str
        Its meaning if it is not zero.
    """

    name: str
    unit: str
    value: float
    interval: Interval | None
    meaning: str


class OnCircle(Record, frozen=True):
    """End points of a direction relative to the circle through START.

    Attributes
    ----------
    direction : str
        "cw" or "ccw".
    off_m : tuple[float, ...]
        Distance of each end point outside the circle, in m.
    mean_off_m : float
        Mean of these, in m.
    mean_off_interval_m : Interval or None
        Its 95 % interval, in m; None if the runs do not determine it.
    distance_m : float
        Mean distance of the end points from START, in m.
    distance_by_heading_m : float or None
        The distance that the headings imply, in m; None where none were measured.
    angle_less_heading_rad : float or None
        Angle on the circle minus the return heading, in rad; None where no headings were measured.
    angle_less_heading_interval_rad : Interval or None
        Its 95 % interval, in rad; None if the runs do not determine it.
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


class Conditions(Result, frozen=True):
    """Which numbers of a robot depend on which conditions.

    Attributes
    ----------
    differs : bool
        Whether a number depends on a condition by more than chance.
    sentence : str
        The answer in words.
    remarks : tuple[str, ...]
        What has to be known of the answer, a sentence each.
    numbers : tuple[NumberOfRobot, ...]
        The numbers of the robot.
    asked : tuple[ByCondition, ...]
        Every number under every condition.
    conditions : tuple[AskedCondition, ...]
        The conditions.
    same : tuple[str, ...]
        Conditions that are the same in all runs.
    runs : int
        Number of runs.
    observed : str
        What was observed: "tracks" or "end_poses".
    size : float
        Probability with which something is said to differ of a robot that is the same everywhere;
        intervals hold with the rest.
    version : str
        Version of umbmark.
    """

    differs: bool
    sentence: str
    remarks: tuple[str, ...]
    numbers: tuple[NumberOfRobot, ...]
    asked: tuple[ByCondition, ...]
    conditions: tuple[AskedCondition, ...]
    same: tuple[str, ...]
    runs: int
    observed: str
    size: float
    version: str


class NumberOfRobot(Record, frozen=True):
    """A number of the robot.

    Attributes
    ----------
    key : str
        The number, EFFECT.PARAMETER.
    meaning : str
        What it is, in words.
    value : ValueWithError
        Its value; that of a number which differs at the mean of the conditions on which it depends.
    depends_on : tuple[str, ...]
        The conditions on which it depends, by their first names; none of a number that is one value
        for all runs.
    """

    key: str
    meaning: str
    value: ValueWithError
    depends_on: tuple[str, ...]


class ValueWithError(Record, frozen=True):
    """A value with its error.

    Attributes
    ----------
    value : float
        The value, in the unit that the catalogue states.
    standard_error : float or None
        Its standard error.
    interval : Interval or None
        Its interval.
    degrees_of_freedom : float
        Degrees of freedom of Student's t.
    """

    value: float
    standard_error: float | None
    interval: Interval | None
    degrees_of_freedom: float


class ByCondition(Record, frozen=True):
    """Whether a number depends on a condition, and how.

    Attributes
    ----------
    key : str
        The number, EFFECT.PARAMETER.
    meaning : str
        What it is, in words.
    condition : str
        The condition, by its first name.
    differs : bool
        Whether it depends on the condition by more than chance.
    p : float
        p of no difference.
    p_adjusted : float
        p adjusted for all numbers and conditions (Holm).
    levels : tuple[AtLevel, ...]
        Its values at the levels that show it; none of an amount.
    sd_between : float or None
        Standard deviation between levels (restricted maximum likelihood); None of an amount.
    sd_between_interval : tuple[float or None, float or None] or None
        Interval of that; its upper end is None where the levels leave it open.
    largest : LargestDifference or None
        Of levels, the largest difference; None of an amount.
    slope : ValueWithError or None
        Of an amount, the change by one of its units; None of levels.
    seen : float or None
        The smallest difference between two levels, or the smallest slope, that 80 % of such tests
        show.
    """

    key: str
    meaning: str
    condition: str
    differs: bool
    p: float
    p_adjusted: float
    levels: tuple[AtLevel, ...]
    sd_between: float | None
    sd_between_interval: tuple[float | None, float | None] | None
    largest: LargestDifference | None
    slope: ValueWithError | None
    seen: float | None


class AtLevel(Record, frozen=True):
    """The value of a number at a level of a condition.

    Attributes
    ----------
    level : str
        The level.
    own : ValueWithError
        The value by the runs of this level, other conditions at their mean.
    pooled : float
        The value drawn towards the mean of all levels by what its error leaves open.
    """

    level: str
    own: ValueWithError
    pooled: float


class LargestDifference(Record, frozen=True):
    """The largest difference between two levels.

    Attributes
    ----------
    high : str
        The level with the larger value.
    low : str
        The other level.
    by : ValueWithError
        By how much it is larger.
    """

    high: str
    low: str
    by: ValueWithError


class AskedCondition(Record, frozen=True):
    """A condition that was asked for.

    Attributes
    ----------
    names : tuple[str, ...]
        Its name, and those of others that divide the runs in the same way.
    kind : str
        What it is: "levels", with a value each, or "amount", on which numbers depend by a slope.
    levels : tuple[LevelOfRuns, ...]
        Its levels; none of an amount.
    range : Interval or None
        Of an amount, its smallest and largest value.
    runs : int
        Number of runs of which it is stated.
    beside : tuple[str, ...]
        Other conditions whose effect was fitted along.
    like : tuple[str, ...]
        Conditions of which its effect cannot be told in these runs.
    against : str
        What differences are compared with: those between "runs", or those between "sessions".
    """

    names: tuple[str, ...]
    kind: str
    levels: tuple[LevelOfRuns, ...]
    range: Interval | None
    runs: int
    beside: tuple[str, ...]
    like: tuple[str, ...]
    against: str


class LevelOfRuns(Record, frozen=True):
    """A level of a condition.

    Attributes
    ----------
    level : str
        Its word.
    runs : int
        Number of runs.
    """

    level: str
    runs: int


class Diagnosis(Result, frozen=True):
    """What a model is missing, how certain that is, and what this data cannot show.

    Attributes
    ----------
    verdict : str
        "explained"; "missing_effect" or "several_missing"; "unlisted_effect", which is not in the
        catalogue; "not_explained" if the model does not suffice although no single effect is
        certified (``reasons`` say why); or "not_enough_data".
    observed : str
        "end_poses" or "tracks".
    fitted : tuple[Estimate, ...]
        The free parameters of the model.
    correlations : tuple[tuple[float, ...], ...]
        Their correlations, a row each; empty where the data does not determine them.
    goodness_of_fit : tuple[GoodnessOfFit, ...]
        Tests of the whole model.
    ranking : tuple[Suspect, ...]
        Classes of effects that were tested; the first ``certified`` of them are missing.
    certified : int
        Number of missing classes at the head of the ranking.
    invisible : tuple[str, ...]
        Effects that this data cannot show; ``absorbed`` names the effects that mask them.
    absorbed : dict[str, tuple[str, ...]]
        Effects that other effects of the model absorb, with the names of these.
    minimum_detectable : dict[str, float or None]
        Minimum detectable size of each effect.
    minimum_detectable_sizes : tuple[DetectableSize, ...]
        The same for each parameter.
    confounders : tuple[Confounder, ...]
        Effects that the model lacks, of sizes that these runs allow, that would bias its first
        numbers, the worst first.
    next_experiments : tuple[Experiment, ...]
        What to measure next, the most informative per minute first.
    identifiability : Identifiability
        What this experiment determines of the model.
    unlisted : Unlisted or None
        A missing effect that is not in the catalogue; None if there is none.
    model : Model
        The model with its fitted parameters.
    meaning : dict[str, str]
        Meaning of each fitted effect for the robot, a sentence each.
    outliers : tuple[Outlier, ...]
        Jumps of tracks that exceed the noise.
    setup : Setup
        Findings about the data before any fit: faults, clock and mounting of the reference, jumps,
        wrong poses, outlying runs.
    taken : tuple[Taken, ...]
        Effects of the reference whose values were estimated from the motion.
    reasons : tuple[str, ...]
        Why the verdict is not "explained", a sentence each.
    repeats : Repeated or None
        The strongest pattern that repeats in the residuals, significant or not; None without
        tracks.
    remarks : tuple[str, ...]
        Further remarks, a sentence each.
    size : float
        False-alarm rate: probability that a complete model is rejected.
    draws : int
        Simulated tests for p-values that have no closed form.
    seed : int
        Seed of those.
    version : str
        Version of umbmark.
    contrasts : tuple[Contrast, ...]
        Closure contrasts of a square driven both ways; empty for other paths.
    circle : tuple[OnCircle, ...]
        End points relative to the circle through START; empty for other paths.
    left_m : float or None
        Remaining error, in m.
    repeats_m : Repeats or None
        The part of it that is the same in every run of one path, in m; None if no two runs drive
        one path.
    remains : Remains or None
        The same in detail, with the sources of noise; None if columns contradict their names.
    """

    verdict: str
    observed: str
    fitted: tuple[Estimate, ...]
    correlations: tuple[tuple[float, ...], ...]
    goodness_of_fit: tuple[GoodnessOfFit, ...]
    ranking: tuple[Suspect, ...]
    certified: int
    invisible: tuple[str, ...]
    absorbed: dict[str, tuple[str, ...]]
    minimum_detectable: dict[str, float | None]
    minimum_detectable_sizes: tuple[DetectableSize, ...]
    confounders: tuple[Confounder, ...]
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
        Probability of a statistic this large if nothing is missing.
    """

    name: str
    statistic: float
    degrees_of_freedom: Interval | None
    p: float


class Suspect(Record, frozen=True):
    """A class of effects that may be missing and that this data cannot separate.

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
        Probability of an F this large if the effect is absent.
    p_adjusted : float
        The same, corrected for all classes that were tested.
    p_flips : float or None
        The same by sign flips of runs; None if these were not tested.
    estimate : dict[str, float or None]
        Values of the parameters of the best.
    standard_error : dict[str, float or None]
        Their standard errors.
    expected_drop : float
        Expected decrease of the sum of squares if it is added.
    meaning : str or None
        Meaning of the values for the robot; None if it has none.
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
    """Minimum detectable size of an effect: detected with a probability of 80 %.

    Attributes
    ----------
    effect : str
        The effect.
    parameter : str
        The parameter that has the size.
    size : float or None
        The size, in the unit of the parameter; None if no size would be detected.
    """

    effect: str
    parameter: str
    size: float | None


class Confounder(Record, frozen=True):
    """An effect that the model lacks, of a size that these runs allow, that would bias what is
    fitted.

    Attributes
    ----------
    effect : str
        The effect.
    parameter : str
        The parameter that has the size.
    size : float
        The size, in the unit of the parameter: as these runs show it, else the usual one, or the
        minimum detectable one where that is smaller.
    biases : tuple[Bias, ...]
        The fitted numbers that it would move out of their intervals, by more than a tenth of their
        usual size.
    """

    effect: str
    parameter: str
    size: float
    biases: tuple[Bias, ...]


class Bias(Record, frozen=True):
    """By how much an effect that is left out biases a fitted number.

    Attributes
    ----------
    effect : str
        The effect that the number belongs to.
    parameter : str
        The number.
    bias : float
        The bias, without its sign, in the unit of the number.
    half_width : float
        Half the width of the number's interval, in the same unit.
    """

    effect: str
    parameter: str
    bias: float
    half_width: float


class Experiment(Record, frozen=True):
    """A further experiment that separates two effects.

    Attributes
    ----------
    separates : tuple[str, str]
        The two effects.
    experiment : str
        What to drive.
    minutes : float
        Its duration, in min.
    sd : float
        Separation of the two, in standard deviations.
    """

    separates: tuple[str, str]
    experiment: str
    minutes: float
    sd: float


class Identifiability(Record, frozen=True):
    """What this experiment determines of the model.

    Attributes
    ----------
    parameters : tuple[Share, ...]
        Each free parameter, with its influence on end poses.
    rank : int
        Number of combinations that are determined.
    hidden : tuple[Hidden, ...]
        Combinations that are not determined.
    """

    parameters: tuple[Share, ...]
    rank: int
    hidden: tuple[Hidden, ...]


class Share(Record, frozen=True):
    """Change of an end pose per unit of a parameter.

    Attributes
    ----------
    effect : str
        The effect.
    parameter : str
        Its parameter.
    position_m_per_unit : float
        Shift of the position per unit of the parameter, in m.
    heading_rad_per_unit : float
        Change of the heading per unit of the parameter, in rad.
    """

    effect: str
    parameter: str
    position_m_per_unit: float
    heading_rad_per_unit: float


class Hidden(Record, frozen=True):
    """A combination of parameters that the experiment does not determine.

    Attributes
    ----------
    weights : dict[str, float]
        The weight of each parameter.
    ratio : float or None
        Units of the second parameter that have the effect of one unit of the first, for two
        parameters; otherwise None.
    """

    weights: dict[str, float]
    ratio: float | None


class Unlisted(Record, frozen=True):
    """A missing effect that is not in the catalogue.

    Attributes
    ----------
    acts_on : str
        What it acts on.
    depends_on : str
        What it depends on.
    p_adjusted : float
        Probability of a dependence this strong by chance, corrected for all tests.
    curve : Curve
        How it depends on it.
    nearest : Nearest or None
        The effect of the catalogue that explains the largest share of it; None if no effect
        explains any.
    suggestion : Suggestion or None
        A formula to try; None if none fits.
    """

    acts_on: str
    depends_on: str
    p_adjusted: float
    curve: Curve
    nearest: Nearest | None
    suggestion: Suggestion | None


class Curve(Record, frozen=True):
    """The missing motion as a function of what it depends on.

    Attributes
    ----------
    at_unit : str
        Unit of the covariate.
    unit : str
        Unit of the missing motion.
    points : tuple[CurvePoint, ...]
        Its points, in order.
    """

    at_unit: str
    unit: str
    points: tuple[CurvePoint, ...]


class CurvePoint(Record, frozen=True):
    """A point of a curve, with its 95 % band.

    Attributes
    ----------
    at : float
        Value of the covariate, in the curve's ``at_unit``.
    value : float
        Value of the curve, in its ``unit``.
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
    """The effect of the catalogue that is most similar to the missing one.

    Attributes
    ----------
    effect : str
        Its name.
    share : float
        The share of the missing effect that it explains.
    """

    effect: str
    share: float


class Suggestion(Record, frozen=True, kw_only=True):
    """A formula to try, and the share of the curve that it explains.

    Attributes
    ----------
    effect : tuple[dict[str, Any], ...]
        Its effects in the order in which they act: each with its name, its parameters, whether it
        is free, and which parameters are fixed all the same.
    noise : dict[str, float] or UnsetType
        The sizes of the noise, where it was fitted to tracks.
    share : float
        The share of the curve that it explains.
    toml : str
        The same as text of a model file.
    """

    effect: tuple[dict[str, Any], ...]
    noise: dict[str, float] | UnsetType = UNSET
    share: float
    toml: str


class Outlier(Record, frozen=True):
    """A jump of a track that exceeds the noise.

    Attributes
    ----------
    run : str
        Name of the run.
    time_s : float
        Time since START, in s.
    moved_m : float
        Length of the jump, in m.
    turned_rad : float or None
        Rotation in the jump, in rad; None without headings.
    standard_deviations : float or None
        Size of the jump, in standard deviations of the noise; None if that is not known.
    """

    run: str
    time_s: float
    moved_m: float
    turned_rad: float | None
    standard_deviations: float | None


class Repeated(Record, frozen=True):
    """The repeating part of the remaining error: the law that was chosen for it, and its p.

    Attributes
    ----------
    number : int
        Its number in the table of laws, as ``--law`` of ``umbmark learn`` takes it.
    toml : str or None
        The law as an effect of a model file, with start values or, once it was added, the fitted
        ones; None if formulas do not have a variable that it depends on.
    formula : str or None
        Its formula; None where it cannot be written as one.
    parameters : dict[str, float or None] or None
        The numbers of the formula.
    acts_on : str or None
        What the formula acts on.
    motion : str
        "forward", "sideways" or "yaw", or "left wheel" or "right wheel".
    per : str
        What the motion is in proportion to: "second", "metre", "radian turned", or "metre that it
        rolls", of a wheel.
    meaning : str
        The law in words.
    by : str
        What it follows, in words.
    means : str or None
        What its length corresponds to on the robot or its path, such as the circumference of a
        wheel; None if it has no length or the length is unknown.
    nearest : Nearest or None
        The effect of the catalogue that is most similar to it after the fit, and the share of its
        response that this effect reproduces, as a cosine.
    with_sense : bool
        Whether it changes sign with the sense of the run.
    length : int or None
        Length of the formula: operations, variables and numbers.
    heldout_rmse_m : float
        Error of held-out runs, in m.
    heldout_rmse_with_law_m : float
        The same with the law, in m.
    gain : float
        Relative decrease of the errors of held-out runs: the largest of those of positions, of
        headings and from pose to pose.
    likeness : float
        Share of its response that the chosen law reproduces, as a cosine.
    p : float
        p of all laws together, by sign flips of runs.
    standard_deviations : float
        Largest score of any law, in standard deviations of the noise model.
    laws : int
        Number of laws that the data could show.
    class_ : tuple[str, ...]
        Formulas of the laws that these runs cannot separate from it.
    others : tuple[UnlistedLaw, ...]
        Other significant laws, the one that predicts held-out runs best first.
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
        ones; None if formulas do not have a variable that it depends on.
    formula : str or None
        Its formula; None where it cannot be written as one.
    parameters : dict[str, float or None] or None
        The numbers of the formula.
    acts_on : str or None
        What the formula acts on.
    motion : str
        "forward", "sideways" or "yaw", or "left wheel" or "right wheel".
    per : str
        What the motion is in proportion to: "second", "metre", "radian turned", or "metre that it
        rolls", of a wheel.
    meaning : str
        The law in words.
    by : str
        What it follows, in words.
    means : str or None
        What its length corresponds to on the robot or its path, such as the circumference of a
        wheel; None if it has no length or the length is unknown.
    nearest : Nearest or None
        The effect of the catalogue that is most similar to it after the fit, and the share of its
        response that this effect reproduces, as a cosine.
    with_sense : bool
        Whether it changes sign with the sense of the run.
    length : int or None
        Length of the formula: operations, variables and numbers.
    heldout_rmse_m : float
        Error of held-out runs, in m.
    heldout_rmse_with_law_m : float
        The same with the law, in m.
    gain : float
        Relative decrease of the errors of held-out runs: the largest of those of positions, of
        headings and from pose to pose.
    likeness : float
        Share of its response that the chosen law reproduces, as a cosine.
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
    correlations : tuple[tuple[float, ...], ...]
        Their correlations, a row each; empty where the data does not determine them.
    not_shown : tuple[str, ...]
        Free effects that this data cannot separate from the rest; they keep their values.
    meaning : dict[str, str]
        Meaning of each fitted effect for the robot, a sentence each.
    outliers : tuple[Outlier, ...]
        Jumps of tracks that exceed the noise.
    usual_noise : bool
        Whether the values were fitted with noise of the usual sizes: only from tracks, if these
        values predict held-out runs better by a tenth than those of maximum likelihood.
    setup : Setup
        Findings about the data before any fit: faults, clock and mounting of the reference, jumps,
        wrong poses, outlying runs.
    taken : tuple[Taken, ...]
        Effects of the reference whose values were estimated from the motion.
    ended : Ended
        How the fit ended.
    rmse_m : float or None
        Root mean square distance of observed from predicted positions, in m.
    heading_rmse_rad : float or None
        The same of headings, in rad; None where none were measured.
    chi2 : float or None
        Sum of the squared residuals in units of their standard deviations, those of earlier
        measurements included; from tracks only.
    residual_count : int or None
        Number of these residuals, those of the runs; from tracks only.
    aicc : float or None
        Akaike's information criterion, corrected for few runs; None where these are too few.
    bic : float or None
        Schwarz's information criterion; None where the runs are too few.
    known : tuple[KnownBefore, ...]
        Bounds and earlier measurements of numbers.
    model : Model
        The model with the fitted values.
    level : float
        Probability with which the intervals hold.
    version : str
        Version of umbmark.
    """

    fitted: tuple[Estimate, ...]
    correlations: tuple[tuple[float, ...], ...]
    not_shown: tuple[str, ...]
    meaning: dict[str, str]
    outliers: tuple[Outlier, ...]
    usual_noise: bool
    setup: Setup
    taken: tuple[Taken, ...]
    ended: Ended
    rmse_m: float | None
    heading_rmse_rad: float | None
    chi2: float | None
    residual_count: int | None
    aicc: float | None
    bic: float | None
    known: tuple[KnownBefore, ...]
    model: Model
    level: float
    version: str


class Ended(Record, frozen=True):
    """How a fit ended.

    Attributes
    ----------
    converged : bool
        Whether at a minimum.
    how : str
        How.
    steps : int
        Steps tried.
    """

    converged: bool
    how: str
    steps: int


class KnownBefore(Record, frozen=True):
    """What was known of a number before a fit, and what became of it.

    Attributes
    ----------
    effect : str
        The effect that has it.
    parameter : str
        Its name.
    low : float or None
        Its least value; None without one.
    high : float or None
        Its greatest value; None without one.
    mean : float or None
        Its value by an earlier measurement; None without one.
    sd : float or None
        Standard deviation of that measurement.
    value : float
        Its value by the fit.
    held : bool
        Whether it is held at a bound beyond which the fit would be better; it has no interval then.
    contradiction : float or None
        How far the runs alone are from the earlier measurement, in standard deviations of the
        difference.
    """

    effect: str
    parameter: str
    low: float | None
    high: float | None
    mean: float | None
    sd: float | None
    value: float
    held: bool
    contradiction: float | None


class GearCalibration(Result, frozen=True):
    """A robot of any drive, calibrated by the first effects of its drive.

    Attributes
    ----------
    drive : str
        "synchro", "ackermann", ...
    fitted : tuple[Estimate, ...]
        The sizes of its first effects.
    not_shown : tuple[str, ...]
        Effects that this data cannot separate from the rest; they keep their values.
    corrected : dict[str, float]
        The keys of robot.toml that change, with their new values.
    return_poses_determine : ReturnPosesDetermine or None
        What return poses can determine; None if the path is not known.
    e_max_sys_before_m : float or None
        E_max,sys as driven, in m; None without runs of both directions.
    e_max_sys_after_m : float or None
        The part of it that remains with the correction, in m.
    level : float
        Probability with which the intervals hold.
    warnings : tuple[str, ...]
        Warnings about the data.
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
    """How many combinations of the sizes the return poses of the path determine.

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
    contents : tuple[LogContents, ...]
        Topics or columns of each log, if the nominal robot is not known; empty if it is.
    checks : tuple[Check, ...]
        Checks of the quality of the data.
    determined : tuple[Determined, ...]
        What it can determine of the robot.
    rank : int
        Number of combinations of E_d, E_b and E_s that it determines.
    setup : Setup or None
        Findings about the runs from their motion and return errors; None without a robot.
    warnings : tuple[str, ...]
        Warnings, a sentence each.
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
    contents: tuple[LogContents, ...]
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
        Ticks of an encoder per revolution of its wheel.
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
    """Numbers of runs of one test and direction, and what these contain.

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
    """A log: its rows, and what its ticks and poses show.

    Attributes
    ----------
    name : str
        Name of its run.
    direction : str or None
        "cw" or "ccw"; None for neither.
    rows : int
        Number of rows.
    duration_s : float
        Time from the first row to the last, in s.
    rate_hz : float
        Rows per second.
    jitter : float
        Relative scatter of the time between rows.
    longest_gap_s : float
        The longest time without a row, in s.
    gaps : int
        Number of gaps.
    mended : Mended
        Defects that were corrected while it was read.
    length_m : float or None
        Length of the way by the ticks, in m; None without a nominal robot.
    disagreement_m_per_m : float or None
        What the wheels disagree on, in m for each m of way: slip that shows without a reference;
        None where fewer than four wheels with rollers are counted.
    heading_rad : float or None
        Heading at the end by the ticks, in rad; None without a nominal robot.
    heading_off_rad : float or None
        Its difference from the commanded heading, in rad; None if the path is not known.
    wheels : WheelFacts or None
        Whether the names of the wheels are right; None if the poses do not show it.
    moves : Moves or None
        What was driven; None without a nominal robot.
    delay_s : Measured or None
        Age of a pose at its time stamp in the middle of the run, in s; None if the motion does not
        determine it.
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
    disagreement_m_per_m: float | None
    heading_rad: float | None
    heading_off_rad: float | None
    wheels: WheelFacts | None
    moves: Moves | None
    delay_s: Measured | None
    reference: ReferenceFacts | None


class Mended(Record, frozen=True):
    """Number of defects of a log that were corrected while it was read.

    Attributes
    ----------
    roll_overs : int
        Counters that rolled over.
    resets : int
        Counters that restarted.
    rows_out_of_order : int
        Rows that were out of order.
    rows_repeated : int
        Duplicate rows.
    stale_poses : int
        Poses repeated from the previous row.
    filled_in_poses : int
        Poses that were filled in between measured ones.
    """

    roll_overs: int
    resets: int
    rows_out_of_order: int
    rows_repeated: int
    stale_poses: int
    filled_in_poses: int


class WheelFacts(Record, frozen=True):
    """Whether the motion of the poses confirms the names of the wheels.

    Attributes
    ----------
    as_named : bool
        Whether it does.
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
        Shape of the path; None if it has no name.
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
        Poses per second.
    coverage : str
        Where along the path they lie, in words.
    longest_gap_s : float
        The longest time without one, in s.
    noise_m : float or None
        Noise of a coordinate, in m; None if the poses do not determine it.
    heading_noise_rad : float or None
        Noise of a heading, in rad; None if the poses do not determine it.
    """

    poses: int
    headings: int
    rate_hz: float
    coverage: str
    longest_gap_s: float
    noise_m: float | None
    heading_noise_rad: float | None


class Clock(Record, frozen=True):
    """Offset of a track's clock and tracked body from those of the ticks, in one run.

    Attributes
    ----------
    offset_s : Measured
        Delay of the track's clock, in s.
    rate : Measured
        Rate by which it is fast, in s/s.
    lever_ahead_m : Measured or None
        Distance of the tracked point ahead of the axle's centre, in m; None if the motion does not
        determine it.
    lever_left_m : Measured or None
        Distance of the tracked point to the left of the axle's centre, in m; None if the motion
        does not determine it.
    yaw_rad : Measured or None
        Heading of the tracked body minus heading of the robot, in rad; None if the motion does not
        determine it.
    misfit_m : float
        Root mean square of the residuals, in m.
    windows : int
        Number of windows that were compared.
    left_out : int
        Number of windows that were excluded.
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
    """Where the log of a run was found in an MCAP file or a bag.

    Attributes
    ----------
    run : str
        Name of the run.
    wheels : str
        Topic of the wheels.
    reference : str or None
        Topic of the reference; None without one.
    """

    run: str
    wheels: str
    reference: str | None


class LogContents(Record, frozen=True):
    """The topics or columns of a log whose robot is not known, and which of them would be read.

    Attributes
    ----------
    file : str
        The file.
    layout : str
        "csv", "mcap", "rosbag" or "rosbag2".
    duration_s : float or None
        Time from the first message or row to the last, in s; None if the file does not say it.
    parts : tuple[LogPart, ...]
        Its topics or columns.
    wheels : WheelsFound or None
        The wheels; None if there are none that can be read.
    reference : ReferenceFound or None
        The absolute poses; None if there are none that can be read.
    problems : tuple[str, ...]
        Why wheels or poses cannot be read, a sentence each.
    notes : tuple[str, ...]
        What was noticed in it, a sentence each.
    """

    file: str
    layout: str
    duration_s: float | None
    parts: tuple[LogPart, ...]
    wheels: WheelsFound | None
    reference: ReferenceFound | None
    problems: tuple[str, ...]
    notes: tuple[str, ...]


class LogPart(Record, frozen=True):
    """A topic or a column of a log.

    Attributes
    ----------
    name : str
        Its name.
    kind : str
        The type of its messages; of a column the range of its numbers, or "text".
    count : int or None
        Messages, or cells that hold something; None if the file does not say it.
    rate_hz : float or None
        Messages or cells per second; None for fewer than two.
    used : str or None
        What it would be used for: "time", "wheels" or "reference"; None if it would not be used.
    """

    name: str
    kind: str
    count: int | None
    rate_hz: float | None
    used: str | None


class WheelsFound(Record, frozen=True):
    """What tells how the wheels turned.

    Attributes
    ----------
    source : str
        The topic and its fields, or the columns.
    unit : str
        "counts", "joint positions" or "odometry".
    readings : int
        Number of readings.
    rate_hz : float
        Readings per second.
    ticks_per_revolution : float or None
        Steps per turn of joint positions; None for counts, and if no step shows.
    counter_bits : int or None
        Width of counters that are seen to roll over; None if none is.
    """

    source: str
    unit: str
    readings: int
    rate_hz: float
    ticks_per_revolution: float | None
    counter_bits: int | None


class ReferenceFound(Record, frozen=True):
    """What tells where the robot was.

    Attributes
    ----------
    source : str
        The topic, or the columns.
    poses : int
        Number of poses.
    headings : int
        How many of them have a heading.
    rate_hz : float or None
        Poses per second; None for fewer than two.
    """

    source: str
    poses: int
    headings: int
    rate_hz: float | None


class Check(Record, frozen=True):
    """A check: what was found, and what is good.

    Attributes
    ----------
    name : str
        What is checked.
    found : str
        What was found.
    good : str
        What would be good.
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
        The quantity.
    yes : bool
        Whether the data determines it.
    std_error : float or None
        Expected relative standard error with noise of the usual size; None if the data does not
        determine the quantity or it is not a value of the robot.
    usual_size : float or None
        Usual relative size of the error in robots; None if it is not a value of the robot.
    because : str
        The reason, or what would help.
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
        Verdict of the last diagnosis; see ``Diagnosis``.
    unlisted : Unlisted or None
        A missing effect that is not in the catalogue; None if there is none.
    confounders : tuple[Confounder, ...]
        Effects that the model lacks, of sizes that these runs allow, that would bias its first
        numbers, the worst first.
    next_experiments : tuple[Experiment, ...]
        What to measure next, the most informative per minute first.
    model : Model
        The model that was learnt.
    fitted : tuple[Estimate, ...]
        Its free parameters.
    correlations : tuple[tuple[float, ...], ...]
        Their correlations, a row each; empty where the data does not determine them.
    meaning : dict[str, str]
        Meaning of each fitted effect for the robot, a sentence each.
    outliers : tuple[Outlier, ...]
        Jumps of tracks that exceed the noise.
    setup : Setup
        Findings about the data before any fit: faults, clock and mounting of the reference, jumps,
        wrong poses, outlying runs.
    taken : tuple[Taken, ...]
        Effects of the reference whose values were estimated from the motion.
    reasons : tuple[str, ...]
        Why the verdict is not "explained", a sentence each.
    repeats : Repeated or None
        The strongest pattern that repeats in the residuals, significant or not; None without
        tracks.
    correction : dict[str, Change]
        The new numbers of the robot by their keys in robot.toml, as of ``solve``; empty where these
        runs show none.
    sentence : str
        The answer in words, as of ``solve``.
    conditions : tuple[CrossedCondition, ...]
        The conditions whose levels were left out, one after the other.
    untested : str or None
        What the model was not tested on, in words; None where nothing was fitted.
    remarks : tuple[str, ...]
        Further remarks, a sentence each.
    partial : bool
        Whether it was stopped before the search for missing effects ended.
    size : float
        False-alarm rate: probability that an effect is added to a complete model.
    draws : int
        Simulated tests for p-values that have no closed form.
    seed : int
        Seed of those.
    version : str
        Version of umbmark.
    left_m : float or None
        Remaining error, in m.
    repeats_m : Repeats or None
        The part of it that is the same in every run of one path, in m; None if no two runs drive
        one path.
    remains : Remains or None
        The same in detail, with the sources of noise; None if columns contradict their names.
    """

    steps: tuple[Step, ...]
    verdict: str
    unlisted: Unlisted | None
    confounders: tuple[Confounder, ...]
    next_experiments: tuple[Experiment, ...]
    model: Model
    fitted: tuple[Estimate, ...]
    correlations: tuple[tuple[float, ...], ...]
    meaning: dict[str, str]
    outliers: tuple[Outlier, ...]
    setup: Setup
    taken: tuple[Taken, ...]
    reasons: tuple[str, ...]
    repeats: Repeated | None
    correction: dict[str, Change]
    sentence: str
    conditions: tuple[CrossedCondition, ...]
    untested: str | None
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
    """One step of learning.

    Attributes
    ----------
    added : str or None
        The effect that was added; None for the nominal robot.
    class_ : tuple[str, ...]
        Effects that this data cannot separate from it, including itself.
    p_adjusted : float or None
        Its p, corrected for all classes that were tested; None if nothing was tested.
    law : Repeated or None
        For a law outside the catalogue: how it was found, its alternatives, and its fitted formula.
    rmse_m : float or None
        Error of positions in the runs that the model was fitted to, in m.
    heading_rmse_rad : float or None
        The same of headings, in rad; None where none were measured.
    heldout_rmse_m : float or None
        Error of positions in held-out runs, in m.
    heldout_heading_rmse_rad : float or None
        The same of headings, in rad; None where none were measured.
    elsewhere_rmse_m : tuple[float or None, ...]
        Error of positions of the runs of each level of a condition, predicted by the model fitted
        to those of the other levels, in m: one for each of the conditions.
    elsewhere_heading_rmse_rad : tuple[float or None, ...]
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
    elsewhere_rmse_m: tuple[float | None, ...]
    elsewhere_heading_rmse_rad: tuple[float | None, ...]
    aicc: float | None
    bic: float | None


class Change(Record, frozen=True):
    """A number of the robot, old and new.

    Attributes
    ----------
    old : float
        As the robot has it now.
    new : float
        As it should be.
    low : float or None
        Lower end of the interval of the new value; None where the runs are too few.
    high : float or None
        Upper end of it; None where the runs are too few.
    worth_m : float or None
        By how much writing it lowers the error in the recorded runs, in m: these add up to the fall
        by all new numbers; None where the error is not known.
    """

    old: float
    new: float
    low: float | None
    high: float | None
    worth_m: float | None


class CrossedCondition(Record, frozen=True):
    """A condition whose levels were left out, one after the other.

    Attributes
    ----------
    names : tuple[str, ...]
        Its name, and those of others that divide the runs in the same way.
    levels : tuple[str, ...]
        Its levels.
    told_only_by : tuple[ToldOnlyBy, ...]
        Effects of the model that the runs of one level alone tell.
    """

    names: tuple[str, ...]
    levels: tuple[str, ...]
    told_only_by: tuple[ToldOnlyBy, ...]


class ToldOnlyBy(Record, frozen=True):
    """An effect that the runs of one level of a condition alone tell.

    Attributes
    ----------
    effect : str
        The effect.
    level : str
        The level.
    """

    effect: str
    level: str


class Paper(Result, frozen=True, kw_only=True):
    """The paper's experiments; those that were not requested are left out.

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
        Duration of a run, in min.
    sigma_m : float
        Scatter of the return positions, one coordinate, in m.
    sigma_interval_m : Interval or None
        Its interval, in m; None if it is not from data.
    e_max_sys_m : float
        E_max,sys of the robot on its path, in m.
    with_heading : bool
        Whether return headings are measured.
    power : float
        Power: probability with which a size should be detected.
    size : float
        False-alarm rate: probability of detecting an effect that the robot does not have.
    draws : int
        Simulated tests for every figure without a closed form.
    seed : int
        Seed of those.
    see : tuple[Sought, ...]
        The sizes to be detected, with the runs that they need.
    by_runs : tuple[OfRuns, ...]
        What each number of runs per direction can detect.
    invisible : tuple[str, ...]
        Effects that no number of runs can detect.
    alternatives : tuple[Alternative, ...]
        Another size, another speed, one direction only.
    extended : ExtendedTest or None
        The extended test; None without bumps.
    order : tuple[Drift, ...]
        Error from a drift over the session, for each order of the runs.
    assumed : tuple[str, ...]
        What was assumed, a phrase each.
    partial : bool
        Whether it was stopped early.
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
    """A size to be detected, and the runs per direction that detect it.

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
        The effects of the model that absorb it; None unless it is "never" detected.
    runs : int or None
        Runs per direction that detect it; None if 1000 are not enough.
    runs_at_sigma_interval : tuple[int or None, int or None] or None
        The same at both ends of the interval of the scatter; None if that is not from data.
    power : float
        Probability that the planned runs detect it.
    experiments : tuple[Experiment, ...]
        Experiments that would detect it if return poses do not.
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
    """What a number of runs per direction can detect.

    Attributes
    ----------
    runs : int
        Runs in each direction.
    minutes : float
        Their duration, in min.
    e_max_sys_m : ExpectedEMaxSys
        E_max,sys as they would measure it.
    minimum_detectable : tuple[LeastSize, ...]
        The minimum sizes that they detect.
    """

    runs: int
    minutes: float
    e_max_sys_m: ExpectedEMaxSys
    minimum_detectable: tuple[LeastSize, ...]


class ExpectedEMaxSys(Record, frozen=True):
    """E_max,sys as tests would measure it, and how precisely.

    Attributes
    ----------
    mean : float
        Mean over tests, in m.
    std_dev : float
        Standard deviation over tests, in m.
    interval_half_width_m : float
        Half the width of its interval, in m.
    coverage : float
        Share of tests whose interval contains the true value.
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
    """Minimum size of an effect that is detected with the wanted power.

    Attributes
    ----------
    effect : str
        The effect.
    parameter : str
        Its parameter.
    size : float or None
        The size, in the unit of the parameter; None if none is detected.
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
        Its duration, in min.
    sigma_m : float
        Scatter of the return positions, one coordinate, in m.
    e_max_sys_interval_half_width_m : float or None
        Half the width of the interval of E_max,sys, in m; None if the test does not give one.
    minimum_detectable : tuple[LeastSize, ...]
        The minimum sizes that it detects.
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
        Their duration, in min.
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
    """A change over the session, and the error that it causes for an order of the runs.

    Attributes
    ----------
    effect : str
        The effect that changes.
    parameter : str
        Its parameter.
    change : float
        Its change, in the unit of the parameter.
    order : str
        "mirrored", "alternating" or "blocks".
    error : dict[str, float]
        The error that it causes in each quantity.
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
    """Experiments that separate two effects, the most informative per minute first.

    Attributes
    ----------
    separates : tuple[str, str]
        The two effects.
    beside : str
        The data to which the experiments are added.
    next_experiments : tuple[Experiment, ...]
        The experiments, each with its separation in standard deviations and its duration.
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
    """A page with all results.

    Attributes
    ----------
    bytes : int
        Its length.
    studies : tuple[Said, ...]
        The verdict of each study on it, and the warnings about its data.
    change : str or None
        Of two studies: "better", "worse" or "the same"; None where they cannot be compared.
    seed : int
        Seed of all random numbers.
    version : str
        Version of umbmark.
    """

    bytes: int
    studies: tuple[Said, ...]
    change: str | None
    seed: int
    version: str


class Said(Record, frozen=True):
    """The result of a study.

    Attributes
    ----------
    name : str
        Its name.
    notices : tuple[str, ...]
        Warnings about its data, a sentence each.
    outcome : str
        In a word: "explained", "partly" (effects were found, but something remains or is unsure),
        "not_explained", "fault" or "not_enough_data".
    verdict : str
        Its result, in one sentence.
    """

    name: str
    notices: tuple[str, ...]
    outcome: str
    verdict: str


class Score(Result, frozen=True):
    """The scores of a UMBmark test, with intervals that hold with probability ``level``.

    Lengths are in m, angles in rad, counter-clockwise positive; points are (x, y), intervals
    (low, high). A score is None if the runs do not determine it, and ``warnings`` says why.

    Attributes
    ----------
    e_max_sys_m : float or None
        E_max,sys: the larger distance of the two centroids from START (Eq. 4).
    e_max_sys_interval_m : Interval or None
        Its interval; None with fewer than three runs in a direction.
    noise_band_m : float or None
        The value of E_max,sys that chance alone would reach, from the scatter of the runs.
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
        Its confidence ellipse.
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
        Its confidence ellipse.
    return_heading_ccw_rad : float or None
        Mean return heading of the counter-clockwise runs whose heading was measured (Eq. 6).
    return_heading_ccw_interval_rad : Interval or None
        Its interval.
    nonsys_orientation_rad : float or None
        Average absolute orientation error of the extended test (Eq. 5).
    nonsys_orientation_interval_rad : Interval or None
        Its interval.
    nonsys_convention : str or None
        "mean" for half of Eq. 5, as used in Table II, or "sum" for Eq. 5 as printed.
    n_bumps_cw : int
        Number of clockwise runs with bumps.
    n_bumps_ccw : int
        Number of counter-clockwise runs with bumps.
    level : float
        Probability with which each interval holds.
    setup : Setup
        Findings about the runs before they were scored: faults, jumps and wrong poses of tracks,
        outlying returns. Empty if return errors were given in arrays.
    warnings : tuple[str, ...]
        Warnings: first about the data, then what could not be computed and why, and what looks
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
    """The confidence ellipse of a centre of gravity.

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
        Whether it was stopped before all of it was done.
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
        Sobol indices: the share of the variance that a parameter causes alone.
    total : dict[str, WithInterval] or UnsetType
        Sobol indices: the share that it causes alone and together with others.
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
        The number; None if it cannot be estimated.
    interval : tuple[float or None, float or None]
        Its 95 % interval; an end is None if it cannot be estimated.
    """

    value: float | None
    interval: tuple[float | None, float | None]


class OfPair(Record, frozen=True):
    """The share of two parameters together.

    Attributes
    ----------
    value : float or None
        The share; None if it cannot be estimated.
    interval : tuple[float or None, float or None]
        Its 95 % interval; an end is None if it cannot be estimated.
    of : tuple[str, str]
        The two parameters.
    """

    value: float | None
    interval: tuple[float | None, float | None]
    of: tuple[str, str]


class Solution(Result, frozen=True):
    """The one answer about a measured robot: what is wrong, what to write into it, what remains,
    and what to do next.

    Attributes
    ----------
    verdict : str
        What the last diagnosis of the model says, in the words of ``Diagnosis``.
    sentence : str
        The answer in words.
    correction : dict[str, Change]
        The new numbers of the robot by their keys in robot.toml; empty where these runs show none.
        Where ``not_shown`` has "scale", lengths and their intervals hold if the mean wheel diameter
        is right.
    needed : bool
        Whether the new numbers differ from the old ones by more than chance.
    trusted : bool
        Whether the new numbers may be written: the model explains the runs, and the data are in
        order.
    remains_m : float or None
        Error that remains with the new numbers in the robot, in m; None where it is not known.
    off : Off or None
        How far off the robot is, and what of it is what; None where it is not known.
    next : tuple[str, ...]
        What to do next, a sentence each.
    not_shown : tuple[str, ...]
        What these runs do not show of the robot: effects that become numbers of it.
    confounders : tuple[Confounder, ...]
        Effects that the model lacks, of sizes that these runs allow, that would bias its first
        numbers, the worst first.
    reasons : tuple[str, ...]
        Why the verdict is not "explained", a sentence each.
    model : Model
        The model that was learnt.
    fitted : tuple[Estimate, ...]
        Its free parameters.
    correlations : tuple[tuple[float, ...], ...]
        Their correlations, a row each; empty where the data does not determine them.
    meaning : dict[str, str]
        Meaning of each fitted effect for the robot, a sentence each.
    setup : Setup
        Findings about the data before any fit: faults, clock and mounting of the reference, jumps,
        wrong poses, outlying runs.
    partial : bool
        Whether learning was stopped before the search for missing effects ended.
    size : float
        Probability with which an effect is added to a complete model; intervals hold with the rest.
    draws : int
        Simulated tests for p-values that have no closed form.
    seed : int
        Seed of those.
    version : str
        Version of umbmark.
    left_m : float or None
        Remaining error, in m.
    repeats_m : Repeats or None
        The part of it that is the same in every run of one path, in m; None if no two runs drive
        one path.
    remains : Remains or None
        The same in detail, with the sources of noise; None if columns contradict their names.
    """

    verdict: str
    sentence: str
    correction: dict[str, Change]
    needed: bool
    trusted: bool
    remains_m: float | None
    off: Off | None
    next: tuple[str, ...]
    not_shown: tuple[str, ...]
    confounders: tuple[Confounder, ...]
    reasons: tuple[str, ...]
    model: Model
    fitted: tuple[Estimate, ...]
    correlations: tuple[tuple[float, ...], ...]
    meaning: dict[str, str]
    setup: Setup
    partial: bool
    size: float
    draws: int
    seed: int
    version: str
    left_m: float | None
    repeats_m: Repeats | None
    remains: Remains | None


class Off(Record, frozen=True):
    """How far off a robot is, and what of it is what. Each list of parts adds up to the fall
    between the errors before and after it.

    Attributes
    ----------
    measure : str
        What is measured: "e_max_sys" (mean returns of both directions), "end_rmse" (ends of runs),
        "rmse_along" (all measured poses) or "rmse_steps" (all measured steps).
    driven_m : float or None
        Error as driven, in m.
    reference_m : dict[str, float or None]
        Parts of it that are the reference's and not the robot's, by effect, in m.
    written_m : dict[str, float or None]
        Parts of it that new numbers take away, by effect, in m.
    known_m : dict[str, float or None]
        Parts of it that are known and that no number of the robot holds, by effect, in m.
    rest_m : float or None
        What all of the model leaves of it, in m.
    chance_m : float or None
        What chance alone stays below in 95 % of tests, in m; None where that is not known.
    """

    measure: str
    driven_m: float | None
    reference_m: dict[str, float | None]
    written_m: dict[str, float | None]
    known_m: dict[str, float | None]
    rest_m: float | None
    chance_m: float | None


class MonteCarlo(Result, frozen=True):
    """The result of a study.

    Attributes
    ----------
    n : int
        Trials done.
    seed : int
        Seed of all random numbers.
    partial : bool
        Whether it was stopped before all trials were done.
    metrics : dict[str, MetricStatistics]
        The metrics that the test has: "e_max_sys_m", "sigma_m", "centroid_cw_x_m", ...
    trials_per_s : float or None
        Trials per second; None if that was not measured.
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
        Sources of the values, a phrase each.
    assumed : tuple[str, ...]
        What was assumed, a phrase each.
    published : Published or None
        What was published about this test; None if nothing.
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
        Mean; None if no trial has the metric.
    std_dev : float or None
        Standard deviation; None for fewer than two trials.
    std_error : float or None
        Standard error of the mean; None for fewer than two trials.
    min : float or None
        Smallest value; None if no trial has the metric.
    max : float or None
        Largest value; None if no trial has the metric.
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


class Survey(Result, frozen=True):
    """Many robots of one kind.

    Attributes
    ----------
    robots : tuple[SurveyedRobot, ...]
        A row for each robot of which something was found.
    failed : tuple[FailedRobot, ...]
        Robots of which nothing was found.
    among : tuple[AmongRobots, ...]
        How far they are apart.
    size : float
        False-alarm rate: of the verdict on one robot, and of all robots that stand out together;
        intervals hold with the rest.
    partial : bool
        Whether the work was stopped before all robots were asked.
    draws : int
        Simulated tests for p-values that have no closed form.
    seed : int
        Seed of those.
    version : str
        Version of umbmark.
    """

    robots: tuple[SurveyedRobot, ...]
    failed: tuple[FailedRobot, ...]
    among: tuple[AmongRobots, ...]
    size: float
    partial: bool
    draws: int
    seed: int
    version: str


class SurveyedRobot(Record, frozen=True):
    """What was found of one robot.

    Attributes
    ----------
    robot : str
        Its name.
    runs : int
        Number of runs.
    fitted : tuple[Estimate, ...]
        Its numbers: E_d, E_b and, of tracks, E_s, or those of its drive.
    e_max_sys_m : float or None
        E_max,sys in m; None where not both directions returned.
    verdict : str or None
        Whether these numbers explain the runs, in the words of ``Diagnosis``; None where no robot
        was diagnosed.
    missing : tuple[str, ...]
        The class of effects that is missing.
    stands_out : tuple[StandsOut, ...]
        Numbers in which it stands out from the others.
    """

    robot: str
    runs: int
    fitted: tuple[Estimate, ...]
    e_max_sys_m: float | None
    verdict: str | None
    missing: tuple[str, ...]
    stands_out: tuple[StandsOut, ...]


class StandsOut(Record, frozen=True):
    """A number in which a robot stands out from the others.

    Attributes
    ----------
    key : str
        The number, EFFECT.PARAMETER.
    p_adjusted : float
        p adjusted for all robots and numbers.
    """

    key: str
    p_adjusted: float


class FailedRobot(Record, frozen=True):
    """A robot of which nothing was found.

    Attributes
    ----------
    robot : str
        Its name.
    reason : str
        Why.
    """

    robot: str
    reason: str


class AmongRobots(Record, frozen=True):
    """How far robots are apart in one number.

    Attributes
    ----------
    key : str
        The number, EFFECT.PARAMETER.
    robots : int
        Number of robots that show it and do not stand out.
    mean : float
        Their mean.
    interval : Interval or None
        Its interval.
    sd_between : float
        Standard deviation between robots, without the errors of their tests (restricted maximum
        likelihood).
    sd_between_interval : tuple[float or None, float or None]
        Its interval; an end is None where the robots leave it open.
    standard_error : float
        Standard error of one robot's number, root mean square.
    """

    key: str
    robots: int
    mean: float
    interval: Interval | None
    sd_between: float
    sd_between_interval: tuple[float | None, float | None]
    standard_error: float


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
        Whether it was stopped before all points were done.
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
        Mean; None if no trial has the metric.
    std_dev : float or None
        Standard deviation; None for fewer than two trials.
    std_error : float or None
        Standard error of the mean; None for fewer than two trials.
    quantiles : dict[str, float or None]
        Quantiles, by the share that lies below.
    """

    mean: float | None
    std_dev: float | None
    std_error: float | None
    quantiles: dict[str, float | None]


class Tolerance(Result, frozen=True):
    """How many robots meet a target, and the cheapest tolerances with which enough do.

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
        Whether it was stopped before all choices were tested.
    now : Choice
        The first grade of every parameter.
    alone : tuple[Choice, ...]
        One parameter tightened alone.
    last : Choice
        The last grade of every parameter.
    cheapest : Choice or None
        The cheapest choice that certainly meets the target, tested on newly drawn robots; None if
        none does.
    choices_looked_at : int
        Number of choices that were tested.
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
    """The required share of robots whose metric stays within a size.

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
    """Grades of all parameters, their cost, and the quality of the resulting robots.

    Attributes
    ----------
    grades : dict[str, Grade]
        The grade of each parameter.
    cost : float
        Their total cost.
    share_within : WithInterval
        The share of robots that meet the target.
    quantile : WithInterval
        The quantile of the metric at the required share.
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
        Its cost.
    """

    grade: int
    distribution: dict[str, float | str]
    cost: float


class TrackComparison(Result, frozen=True):
    """Models compared with tracks: where along the path the error arises, and what it depends on.

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
        Further remarks, a sentence each.
    setup : Setup
        Findings about the data before any fit: faults, clock and mounting of the reference, jumps,
        wrong poses, outlying runs.
    size : float
        False-alarm rate: probability that a correct model is rejected.
    version : str
        Version of umbmark.
    left_m : float or None
        Remaining error, in m.
    repeats_m : Repeats or None
        The part of it that is the same in every run of one path, in m; None if no two runs drive
        one path.
    remains : Remains or None
        The same in detail, with the sources of noise; None if columns contradict their names.
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
    """Result of one model along the path, and at its end.

    Attributes
    ----------
    name : str
        Its name.
    explains : bool or None
        Whether it explains the tracks; None if nothing was tested.
    p : float or None
        p of all tests together: the smallest of those with a gain of at least 0.02, times the
        number of all; None if nothing was tested.
    tests : int
        Number of these tests.
    along : RootMeanSquare
        Errors along the path.
    end : RootMeanSquare
        Errors at its end.
    parts : dict[str, tuple[Part, ...]]
        Error that each part of the path adds, for each way of grouping parts.
    overall : dict[str, Overall]
        Mean rates of the error.
    against : tuple[Against, ...]
        Rates of the error as functions of driving quantities.
    sentences : tuple[str, ...]
        Findings, a sentence each.
    taken : tuple[Taken, ...]
        Effects of the reference whose values were estimated from the motion.
    reasons : tuple[str, ...]
        Why the model does not explain the tracks, a sentence each.
    left_m : float or None
        Remaining error, in m.
    repeats_m : Repeats or None
        The part of it that is the same in every run of one path, in m; None if no two runs drive
        one path.
    remains : Remains or None
        The same in detail, with the sources of noise; None if columns contradict their names.
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
    """Error that a part of the path adds.

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
        Its interval, with None for an open end; None for a single run.
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
    """Share of a part of the path in the squared error.

    Attributes
    ----------
    position : float or None
        Of positions along the path.
    heading : float or None
        Of headings along the path.
    end : float or None
        Of positions at its end.
    """

    position: float | None
    heading: float | None
    end: float | None


class Overall(Record, frozen=True):
    """Mean rate of an error over the whole path.

    Attributes
    ----------
    mean : float or None
        The mean; None without runs.
    interval : tuple[float or None, float or None] or None
        Its interval, with None for an open end; None for a single run.
    runs : int
        Number of runs.
    p : float or None
        p of a rate of zero; None if it was not tested.
    gain : float or None
        Share by which the error of runs left out falls if the mean rate is taken off; None if it
        was not tested.
    """

    mean: float | None
    interval: tuple[float | None, float | None] | None
    runs: int
    p: float | None
    gain: float | None


class Against(Record, frozen=True):
    """Rate of an error as a function of a quantity.

    Attributes
    ----------
    rate : str
        The rate.
    covariate : str
        The quantity.
    unit : str
        Unit of the quantity.
    p : float or None
        p of no dependence; None if it was not tested.
    gain : float or None
        Share by which the error of runs left out falls if the dependence is taken off; None if it
        was not tested.
    bins : tuple[Bin, ...]
        The rate in each span of the quantity.
    """

    rate: str
    covariate: str
    unit: str
    p: float | None
    gain: float | None
    bins: tuple[Bin, ...]


class Bin(Record, frozen=True):
    """Mean rate of an error while a quantity is between two values, for one sense or both.

    Attributes
    ----------
    mean : float or None
        The mean; None without runs.
    interval : tuple[float or None, float or None] or None
        Its interval, with None for an open end; None for fewer than two runs.
    runs : int
        Number of runs.
    low : float
        Least value of the quantity.
    high : float or None
        Largest value of the quantity; None if it is open.
    sense : float
        1 counter-clockwise, -1 clockwise, 0 both.
    amount : float
        Amount of driving in this bin, in the unit of the rate.
    """

    mean: float | None
    interval: tuple[float | None, float | None] | None
    runs: int
    low: float
    high: float | None
    sense: float
    amount: float


class Watched(Result, frozen=True):
    """What is known of a robot that is watched.

    Attributes
    ----------
    changed : bool
        Whether something changed.
    sentence : str
        The answer in words.
    change : WatchedChange or None
        The change; None where nothing changed.
    new : int
        Number of runs that are new.
    runs : tuple[WatchedRun, ...]
        All runs in the order in which they arrived.
    missing : tuple[int, int]
        Runs that the baseline still needs, clockwise and counter-clockwise.
    delays : tuple[WatchedDelay, ...]
        How soon changes would be found that happened now; empty while there is no baseline, and
        after an alarm.
    vanished : tuple[str, ...]
        Runs that were watched before and are not in the data any more.
    altered : tuple[str, ...]
        Runs that were watched before and have other values in the data now.
    left_out : tuple[str, ...]
        Runs of the data that cannot be watched.
    false_alarms_per_month : float
        Probability of a false alarm in a month.
    runs_per_month : int
        Runs in a month.
    seed : int
        Seed of the delays.
    version : str
        Version of umbmark.
    """

    changed: bool
    sentence: str
    change: WatchedChange | None
    new: int
    runs: tuple[WatchedRun, ...]
    missing: tuple[int, int]
    delays: tuple[WatchedDelay, ...]
    vanished: tuple[str, ...]
    altered: tuple[str, ...]
    left_out: tuple[str, ...]
    false_alarms_per_month: float
    runs_per_month: int
    seed: int
    version: str


class WatchedChange(Record, frozen=True):
    """A change of a robot that is watched.

    Attributes
    ----------
    kind : str
        What changed: "numbers" of the robot, "place" of the return errors, or "scatter" of the
        runs.
    since : str
        The first run after the change.
    earliest : str
        The first run after the change lies between this one,
    latest : str
        and this one, with 95 % probability.
    seen : str
        The run with which the alarm was raised.
    runs_until_seen : int
        Runs from the first after the change to that.
    numbers : tuple[WatchedNumber, ...]
        The numbers of the robot.
    alone : tuple[WatchedLength, ...]
        Lengths of which each accounts for the change of the numbers by itself, the best first.
    p_left : float or None
        p of what the numbers leave of the change of the return errors; None where they leave
        nothing to compare.
    places : tuple[WatchedPlace, ...]
        The mean return errors.
    scatter_ratio : float or None
        Scatter after over before, as a ratio of standard deviations; None where it is not known.
    scatter_interval : Interval or None
        95 % interval of that.
    """

    kind: str
    since: str
    earliest: str
    latest: str
    seen: str
    runs_until_seen: int
    numbers: tuple[WatchedNumber, ...]
    alone: tuple[WatchedLength, ...]
    p_left: float | None
    places: tuple[WatchedPlace, ...]
    scatter_ratio: float | None
    scatter_interval: Interval | None


class WatchedNumber(Record, frozen=True):
    """A number of the robot before and after a change.

    Attributes
    ----------
    key : str
        "e_d", "e_b" or "e_s"; where runs were not tracked, "e_b" is that for E_s = 1.
    before : float
        True over nominal before, as the return errors show it if nothing else makes them.
    before_half : float or None
        Half the width of the 95 % interval of that.
    after : float
        True over nominal after.
    after_half : float or None
        Half the width of the 95 % interval of that.
    change : float
        After less before.
    interval : Interval or None
        95 % interval of the change.
    p_adjusted : float
        p of no change, adjusted for all numbers (Holm).
    moved : bool
        Whether it moved by more than chance.
    """

    key: str
    before: float
    before_half: float | None
    after: float
    after_half: float | None
    change: float
    interval: Interval | None
    p_adjusted: float
    moved: bool


class WatchedLength(Record, frozen=True):
    """A length that accounts for a change of the numbers by itself.

    Attributes
    ----------
    key : str
        Its key in robot.toml.
    share : float
        Change of it as a share of itself.
    half : float or None
        Half the width of its 95 % interval.
    p : float
        p of what it leaves of the change.
    """

    key: str
    share: float
    half: float | None
    p: float


class WatchedPlace(Record, frozen=True):
    """The mean return error of a direction, after a change less before.

    Attributes
    ----------
    direction : str
        "cw" or "ccw".
    x_m : float
        Along the START heading, in m.
    x_half_m : float or None
        Half the width of its 95 % interval, in m.
    y_m : float
        To the left, in m.
    y_half_m : float or None
        Half the width of its 95 % interval, in m.
    heading_rad : float or None
        Heading, in rad; None where it was not measured.
    heading_half_rad : float or None
        Half the width of its 95 % interval, in rad.
    """

    direction: str
    x_m: float
    x_half_m: float | None
    y_m: float
    y_half_m: float | None
    heading_rad: float | None
    heading_half_rad: float | None


class WatchedRun(Record, frozen=True):
    """A run of a robot that is watched.

    Attributes
    ----------
    run : str
        Its name.
    direction : str
        "cw" or "ccw".
    used : str
        What it is used for: "earlier" than the baseline, "baseline", "compared" or "left_out".
    reason : str or None
        Why it is left out; None where it is not.
    outlying : bool
        Whether it lies farther out than one good run in 200, and belongs to no lasting change.
    p : float or None
        Probability that a good run lies as far from what the earlier runs predict; None where it
        was not compared.
    numbers : float or None
        Logarithm of the likelihood ratio of a change of E_d, E_b and E_s, as of this run; None
        where it was not compared.
    numbers_limit : float or None
        Its limit.
    place : float or None
        The same of any other change of the return errors.
    place_limit : float or None
        Its limit.
    scatter : float or None
        The same of larger scatter.
    scatter_limit : float or None
        Its limit.
    """

    run: str
    direction: str
    used: str
    reason: str | None
    outlying: bool
    p: float | None
    numbers: float | None
    numbers_limit: float | None
    place: float | None
    place_limit: float | None
    scatter: float | None
    scatter_limit: float | None


class WatchedDelay(Record, frozen=True):
    """How soon a change would be found that happened now.

    Attributes
    ----------
    key : str
        The key of a length in robot.toml.
    share : float
        The share by which it grows.
    half : int or None
        Runs after which half of such changes are found; None for more than 60.
    most : int or None
        Runs after which nine of ten are; None for more than 60.
    """

    key: str
    share: float
    half: int | None
    most: int | None


class Effect(Record, frozen=True):
    """An effect of the catalogue: equation, cause, signature, and effects that look like it.

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
        How to separate it from these.
    source : str
        Its source.
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
        Its default; a word if it takes words or comes from the robot.
    typical : float
        Its usual size.
    bounds : tuple[float or None, float or None]
        Its allowed range; an open end is None.
    choices : tuple[str, ...]
        The allowed words; empty if it takes numbers.
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
