"""Calibration: from measured runs to the true wheel diameters and wheelbase."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import msgspec

from umbmark import _documents
from umbmark._arguments import real
from umbmark._documents import Correction
from umbmark._export import export
from umbmark._result import Printed, Row
from umbmark._scores import Data, data_of
from umbmark._umbmark import Model, Path, Robot
from umbmark._umbmark import calibrate as _calibrate
from umbmark._umbmark import calibrate_gears as _calibrate_gears

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Calibration(_documents.Calibration, Printed, frozen=True):
    """A calibration by every method that the data allows.

    Attributes
    ----------
    robot : Robot
        The nominal robot.
    path : Path or None
        The path; None where it is not known.
    """

    robot: Robot
    path: Path | None
    text: str

    @property
    def exact(self) -> Correction:
        """The corrections by the exact fit."""
        return self._of_method("exact")

    def export(
        self,
        format: str,
        *,
        method: str | None = None,
        controller: str | None = None,
        force: bool = False,
    ) -> str:
        """Give the corrected lengths as the text of a file of another program.

        Parameters
        ----------
        format : str
            "ros2_control" (parameters of diff_drive_controller), "robot_toml" or "c_header".
        method : str, optional
            Whose corrections; those of ``exported`` where none is given.
        controller : str, optional
            Name of the controller in the parameters of ros2_control; that of its type where none
            is given.
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
        method = method or self.exported or "exact"
        found = self._of_method(method)
        if found.e_d is None or found.e_b is None:
            raise ValueError(f"nothing to export: {method} does not give both E_d and E_b")
        targets = {"ros2_control": "ros2_control", "robot_toml": "toml", "c_header": "c"}
        if format not in targets:
            known = ", ".join(targets)
            raise ValueError(f'format must be one of {known}, got "{format}"')
        model = Model(self.robot).add("wheel_diameter_ratio", e_d=found.e_d)
        model = model.add("wheelbase", e_b=found.e_b).add("scale", e_s=found.e_s or 1.0)
        return export(model, to=targets[format], path=self.path, controller=controller).text

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
    learn: bool = True,
    threads: int = 0,
) -> Calibration:
    """Calibrate a differential drive: E_d, E_b, and E_s where the data shows it.

    The paper's closed forms (Eqs. 7 to 20), the heading form, the exact fit, and the numbers of the
    learnt model, which are exported (see ``solve``).

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
    learn : bool, default True
        Whether to learn a model too, whose numbers are exported. Without it the others come
        some forty times as fast, for fleets, and stand in doubt: nobody asked whether another
        effect spoils them.
    threads : int, default 0
        Threads to use; 0 for all processors. No number depends on it.

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
    arm = None if heading_arm_m is None else real("heading_arm_m", heading_arm_m)
    level = real("level", level)
    document, text = _calibrate(data, level, arm, radius_wheelbase, learn, threads)
    return Calibration._of(document, robot=data.robot, path=data.path, text=text)


class GearCalibration(_documents.GearCalibration, Printed, frozen=True):
    """A robot of any drive, calibrated by the first effects of its drive.

    Attributes
    ----------
    model : Model
        The nominal robot with the fitted effects.
    robot : Robot
        The robot with its odometry corrected.
    text : str
        What the command prints of it; ``print`` and ``str`` give this.
    """

    _of_row: ClassVar[tuple[str, ...]] = ("value", "standard_error", "interval")

    model: Model
    robot: Robot
    text: str

    def table(self) -> list[Row]:
        """Give the fitted sizes, one dict a row."""
        return [msgspec.structs.asdict(estimate) for estimate in self.fitted]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the fitted sizes in units of their standard errors, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.fitted(self, ax)


def calibrate_gears(
    data: Data, *, level: float = 0.95, learn: bool = True, threads: int = 0
) -> GearCalibration:
    """Calibrate a robot of any drive by the first effects of its drive.

    Parameters
    ----------
    data : Dataset or path-like
        The measurements.
    level : float, default 0.95
        Probability with which the intervals hold.
    learn : bool, default True
        Whether to learn a model too, and to say in ``text`` what of it is to be written.
    threads : int, default 0
        Threads to use; 0 for all processors. No number depends on it.

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
    found = _calibrate_gears(data_of(data), real("level", level), learn, threads)
    document, text, model, robot = found
    return GearCalibration._of(document, model=model, robot=robot, text=text)
