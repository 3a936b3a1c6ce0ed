"""Calibration: from measured runs to the true wheel diameters and wheelbase."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import msgspec

from umbmark._diagnosis import Estimate
from umbmark._result import Interval, Record, Result, Row
from umbmark._scores import Data, data_of
from umbmark._setup import Setup, Taken
from umbmark._umbmark import Model, Path, Robot, export
from umbmark._umbmark import calibrate as _calibrate
from umbmark._umbmark import calibrate_gears as _calibrate_gears

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Replayed(Record, frozen=True):
    """Return errors of the recorded runs, their ticks computed again, in m."""

    e_max_sys_m: float | None
    largest_m: float


class Correction(Record, frozen=True):
    """The corrections that one method gives; None for what the data does not show.

    ``e_d`` is the ratio of the wheel diameters, right to left; ``e_b`` and ``e_s`` are wheelbase
    and mean diameter by their nominal values. Lengths are in m. ``covariance`` is of the ratios
    named in ``covariance_of``.
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


class Calibration(Result, frozen=True):
    """A calibration by every method that the data allows.

    Attributes
    ----------
    methods : dict of str to Correction or None
        "closed_form_x", "closed_form_y", "closed_form_mean", "heading" and "exact".
    observed : str
        "end_poses" or "tracks".
    heading_arm_m : float or None
        Metres that a radian of heading counted as, where whole tracks were fitted.
    level : float
        Probability with which the intervals hold.
    setup : Setup
        What was found of the data before anything was fitted: faults, clock and mounting of the
        reference, jumps, wrong poses, runs far from the others.
    taken : tuple of Taken
        Effects of the reference whose values were taken from the motion.
    doubts : tuple of str
        What puts the corrected lengths in doubt, a sentence each; ``export`` refuses them then.
    warnings : tuple of str
        What to know of the data first; then what could not be determined, and why.
    robot, path
        The nominal robot, and the path where it is known.
    """

    _beside: ClassVar[tuple[str, ...]] = ("robot", "path")

    methods: dict[str, Correction | None]
    observed: str
    heading_arm_m: float | None
    level: float
    setup: Setup
    taken: tuple[Taken, ...]
    doubts: tuple[str, ...]
    warnings: tuple[str, ...]
    version: str
    robot: Robot
    path: Path | None

    @property
    def exact(self) -> Correction:
        """The corrections by the exact fit."""
        return self._of_method("exact")

    def export(
        self,
        format: str,
        *,
        method: str = "exact",
        controller: str = "diff_drive_controller",
        force: bool = False,
    ) -> str:
        """Give the corrected lengths as the text of a file of another program.

        Parameters
        ----------
        format : str
            "ros2_control" (parameters of diff_drive_controller), "robot_toml" or "c_header".
        method : str, default "exact"
            Whose corrections.
        controller : str
            Name of the controller in the parameters of ros2_control.
        force : bool, default False
            Whether to give lengths that are in doubt.

        Raises
        ------
        ValueError
            If the method does not give both ratios, the format is unknown, or the lengths are in
            doubt (``doubts`` says why) and ``force`` is not set.
        """
        if self.doubts and not force:
            why = " ".join(self.doubts)
            raise ValueError(f"the lengths are in doubt; force=True gives them all the same. {why}")
        found = self._of_method(method)
        if found.e_d is None or found.e_b is None:
            raise ValueError(f"nothing to export: {method} does not give both E_d and E_b")
        return export(self.robot, self.path, (found.e_d, found.e_b, found.e_s), format, controller)

    def _of_method(self, method: str) -> Correction:
        found = self.methods.get(method)
        if found is None:
            known = ", ".join(name for name, given in self.methods.items() if given)
            raise ValueError(f'there is no correction by "{method}"; there is {known}')
        return found

    def table(self) -> list[Row]:
        """Give the corrections of each method, one dict a row."""
        lengths = ("wheelbase_m", "wheel_diameter_left_m", "wheel_diameter_right_m")
        keys = ("e_d", "e_b", "e_s", *lengths, "e_max_sys_before_m", "e_max_sys_after_m")
        given = ((name, found) for name, found in self.methods.items() if found)
        return [
            {"method": name, **{key: getattr(found, key) for key in keys}} for name, found in given
        ]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw E_d and E_b of every method with their intervals, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.calibration(self, ax)


def calibrate(
    data: Data,
    *,
    level: float = 0.95,
    heading_arm_m: float | None = None,
    radius_wheelbase: str = "nominal",
) -> Calibration:
    """Calibrate a differential drive: E_d, E_b, and E_s where the data shows it.

    The paper's closed forms (Eqs. 7 to 20), the heading form, and the exact fit.

    Parameters
    ----------
    data : Dataset or path-like
        The measurements.
    level : float, default 0.95
        Probability with which the intervals hold.
    heading_arm_m : float, optional
        Metres that a radian of heading error counts as when whole tracks are fitted; the root mean
        square distance of the poses from START where none is given.
    radius_wheelbase : str, default "nominal"
        Wheelbase in the closed forms' formula for E_d: "nominal", as the paper's companion has it,
        or "corrected".

    Raises
    ------
    ValueError
        If nothing can be calibrated from these runs, or the drive is another one; it says why.

    Examples
    --------
    >>> import umbmark
    >>> truth = umbmark.Model().add("wheel_diameter_ratio", e_d=1.00203)
    >>> truth = truth.add("wheelbase", e_b=0.9915)
    >>> data = umbmark.simulate(truth, reference_rate_hz=0)
    >>> found = umbmark.calibrate(data).exact
    >>> print(f"{found.e_d:.4f} {found.e_b:.3f}")
    1.0020 0.992
    """
    data = data_of(data)
    document = _calibrate(data, level, heading_arm_m, radius_wheelbase)
    return Calibration._of(document, robot=data.robot, path=data.path)


class Determined(Record, frozen=True):
    """What return poses of the path determine: so many combinations of so many sizes."""

    rank: int
    of: int
    hidden: tuple[dict[str, float], ...]


class GearCalibration(Result, frozen=True):
    """A robot of any drive, calibrated by the first effects of its drive.

    Attributes
    ----------
    drive : str
        "synchro", "ackermann", ...
    fitted : tuple of Estimate
        The sizes of its first effects.
    not_shown : tuple of str
        Effects that this data does not show apart from the rest; they keep their values.
    corrected : dict of str to float
        The keys of robot.toml that change, with their new values.
    return_poses_determine : Determined or None
        What return poses can tell; None where the path is not known.
    e_max_sys_before_m, e_max_sys_after_m : float or None
        E_max,sys as driven, and what is left of it with the correction.
    model : Model
        The nominal robot with the fitted effects.
    robot : Robot
        The robot with its odometry corrected.
    """

    _beside: ClassVar[tuple[str, ...]] = ("model", "robot")

    drive: str
    fitted: tuple[Estimate, ...]
    not_shown: tuple[str, ...]
    corrected: dict[str, float]
    return_poses_determine: Determined | None
    e_max_sys_before_m: float | None
    e_max_sys_after_m: float | None
    level: float
    warnings: tuple[str, ...]
    version: str
    model: Model
    robot: Robot

    def table(self) -> list[Row]:
        """Give the fitted sizes, one dict a row."""
        return [msgspec.structs.asdict(estimate) for estimate in self.fitted]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the fitted sizes in units of their standard errors, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.fitted(self, ax)


def calibrate_gears(data: Data, *, level: float = 0.95) -> GearCalibration:
    """Calibrate a robot of any drive by the first effects of its drive.

    Parameters
    ----------
    data : Dataset or path-like
        The measurements.
    level : float, default 0.95
        Probability with which the intervals hold.

    Returns
    -------
    GearCalibration

    Raises
    ------
    ValueError
        If nothing can be calibrated from these runs; it says why.

    Examples
    --------
    >>> import umbmark
    >>> robot = umbmark.Robot(
    ...     drive="synchro",
    ...     wheel_circle_m=0.5,
    ...     wheel_diameter_m=0.15,
    ...     ticks_per_revolution=2000,
    ...     steering_ticks_per_revolution=10_000,
    ... )
    >>> truth = umbmark.Model(robot).add("wheel_noise", k_sqrt_m=0.0003)
    >>> data = umbmark.simulate(truth)
    >>> umbmark.calibrate_gears(data).drive
    'synchro'
    """
    document, model, robot = _calibrate_gears(data_of(data), level)
    return GearCalibration._of(document, model=model, robot=robot)
