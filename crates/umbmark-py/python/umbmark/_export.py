"""A model as the file of another program."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from umbmark import _umbmark

if TYPE_CHECKING:
    from umbmark._umbmark import Model, Path


@dataclass(frozen=True)
class Exported:
    """A file as text, and what it does not hold.

    Attributes
    ----------
    text : str
        The file.
    notes : list of str
        What the file does not correct or hold, a sentence each.
    """

    text: str
    notes: list[str]


def export(
    model: Model,
    *,
    to: str,
    path: Path | None = None,
    controller: str | None = None,
    urdf: str | os.PathLike[str] | None = None,
    joints: Sequence[str] | None = None,
    speed_m_s: float = 0.2,
    turn_rate_rad_s: float = 0.5,
    rate_hz: float = 50.0,
    start: tuple[float, float, float] = (0.0, 0.0, 0.0),
    force: bool = False,
) -> Exported:
    """Write the numbers of a model for a program that needs them.

    Parameters
    ----------
    model : Model
        The model. Covariances need its noise, which ``learn`` and ``fit`` find in tracks.
    to : str
        "ros2_control", "amcl", "robot_localization", "toml", "c", "urdf", "gazebo", "mujoco",
        "embedded" or "embedded_rust".
    path : Path, optional
        The path that a robot.toml has beside the robot.
    controller : str, optional
        Name of the controller in parameters of ros2_control; that of its type where none is given.
    urdf : path-like, optional
        The file of yours that "urdf" edits.
    joints : sequence of str, optional
        Joints of the left and the right wheel in it, where their names leave that open.
    speed_m_s, turn_rate_rad_s : float
        The usual motion, for which a constant covariance is right.
    rate_hz : float, default 50.0
        Rate at which the robot publishes its odometry.
    start : tuple of float, default (0.0, 0.0, 0.0)
        Where the robot stands at its first reading: x and y in m, heading in rad; for "embedded".
    force : bool, default False
        Whether to write a model that is in doubt; ``Model.doubt`` says why it is.

    Raises
    ------
    ValueError
        If the target cannot have such a robot, something is missing, or the model is in doubt; it
        says what to do.

    Examples
    --------
    >>> import umbmark
    >>> model = umbmark.Model().add("wheelbase", e_b=0.99)
    >>> print(umbmark.export(model, to="toml").text.splitlines()[0])
    # umbmark 0.1.0: E_d 1.0, E_b 0.99, E_s 1.0
    """
    if joints is not None and len(joints) != 2:
        raise ValueError(f"joints must be two names, left and right, got {len(joints)}")
    wheels = None if joints is None else list(joints)
    edited = None if urdf is None else (os.fspath(urdf), wheels)
    usual = [speed_m_s, turn_rate_rad_s, rate_hz]
    return Exported(*_umbmark.export(model, to, path, controller, edited, usual, start, force))
