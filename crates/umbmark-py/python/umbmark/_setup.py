"""What was found of an experiment before any model was fitted."""

from __future__ import annotations

from umbmark._result import Interval, Record


class Measured(Record, frozen=True):
    """A quantity with its standard error and its 95 % interval, in the unit that its key names.

    ``std_error`` and ``interval`` are None where the data does not give them.
    """

    value: float
    std_error: float | None
    interval: Interval | None


class Fault(Record, frozen=True):
    """A column, a unit or a frame that is not what it is called, and how to correct it."""

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
    ahead_m, left_m : Measured or None
        Where the tracked point lies, ahead and to the left of the centre of the axle, in m.
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


class Delay(Record, frozen=True):
    """How much older than its stamp a pose of a run is, in s; None without enough motion."""

    run: str
    delay_s: Measured | None


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
        Size of the jump, in standard deviations of the motion from pose to pose.
    """

    run: str
    since_s: float
    time_s: float
    moved_m: float
    turned_rad: float | None
    standard_deviations: float | None


class Deviant(Record, frozen=True):
    """A coordinate of a return error that lies far from those of the other runs.

    Attributes
    ----------
    coordinate : str
        "x", "y" or "heading".
    value, mean_of_others : float
        Its value, and the mean of the other runs: in m, headings in rad.
    standard_deviations : float or None
        Distance from that mean, in standard deviations of a run about it.
    """

    coordinate: str
    value: float
    mean_of_others: float
    standard_deviations: float | None


class OutlyingReturn(Record, frozen=True):
    """A run whose return error is far from those of the other runs of its direction and test.

    Attributes
    ----------
    run, test : str
        Name of the run; "systematic" or "bumps".
    direction : str or None
        "cw" or "ccw".
    others : int
        Number of the other runs that it was compared with.
    moved_m : float
        Distance of its end position from their mean, in m.
    turned_rad : float or None
        Its heading minus their mean, in rad; None without headings.
    standard_deviations : float or None
        Distance of the farthest coordinate, in standard deviations.
    deviants : tuple of Deviant
        The coordinates that are off, the farthest first.
    said, remedy : str
        The finding in words, and what to do.
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


class Setup(Record, frozen=True):
    """What was found of an experiment before any model was fitted.

    All of it follows from the motion and the return errors alone. With only return errors in
    arrays, or without a nominal robot, there is nothing in it.

    Attributes
    ----------
    faults : tuple of Fault
        Columns, units and frames that are not what they are called. Correct these first: until
        then no number says anything of the robot.
    reference : Mounting or None
        Clock and mounting of the reference; None without enough absolute poses.
    delays : tuple of Delay
        The delay of the reference in each run with poses.
    jumps : tuple of Jump
        Places where tracks jump.
    wrong_poses : tuple of WrongPose
        Single poses that are wrong; they are left out of fits.
    returns : tuple of OutlyingReturn
        Runs whose return error is far from the others.
    """

    faults: tuple[Fault, ...]
    reference: Mounting | None
    delays: tuple[Delay, ...]
    jumps: tuple[Jump, ...]
    wrong_poses: tuple[WrongPose, ...]
    returns: tuple[OutlyingReturn, ...]


class Taken(Record, frozen=True):
    """An effect of the reference whose values were taken from the motion before any fit.

    Attributes
    ----------
    effect : str
        Name of the effect.
    parameters : dict of str to Measured
        Its values, in the units of its parameters.
    p : float
        Probability of values so large where the effect is absent.
    """

    effect: str
    parameters: dict[str, Measured]
    p: float
