"""What a model leaves: what of it is the same in every run, and what chance there is."""

from __future__ import annotations

from umbmark._result import Record


class Repeats(Record, frozen=True):
    """How much of an error is the same in every run of a path, at least, and its 95 % interval."""

    value: float
    low: float | None
    high: float | None


class Chance(Record, frozen=True):
    """A source of chance, and the error in m and rad that it alone would leave."""

    source: str
    position_m: float
    heading_rad: float


class Disturbance(Record, frozen=True):
    """A place where a run is disturbed by more than its noise.

    Attributes
    ----------
    run : str
        The run's name.
    t_s, rolled_m : float
        Time since START, and how far the wheels have rolled by then.
    lasts : bool
        Whether the robot was moved and stayed so, as by a bump; else the reference was off for a
        moment.
    forward_m, left_m, heading_rad : float
        By how much, as the robot sees it.
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


class Remains(Record, frozen=True):
    """What a model leaves.

    Attributes
    ----------
    left_m : float or None
        Root mean square error of positions.
    repeats_m : Repeats or None
        How much of it is the same in every run: the root of the mean product of what is left in
        two runs at the same share of one path. None where no two runs drive one path.
    left_rad, repeats_rad
        The same of headings; None where none were measured.
    pairs_of_one_path : int
        How many pairs of runs that rests on.
    chance : tuple of Chance
        What each source of noise would leave; empty for return poses.
    disturbances : tuple of Disturbance
        Bumps and slips met by chance, and poses of the reference that are off.
    """

    left_m: float | None
    repeats_m: Repeats | None
    left_rad: float | None
    repeats_rad: Repeats | None
    pairs_of_one_path: int
    chance: tuple[Chance, ...]
    disturbances: tuple[Disturbance, ...]
