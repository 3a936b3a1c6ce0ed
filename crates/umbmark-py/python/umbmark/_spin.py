"""Turns on the spot."""

from __future__ import annotations

from umbmark import _documents, _umbmark
from umbmark._result import Row
from umbmark._umbmark import Robot


class Spin(_documents.Spin, frozen=True):
    def table(self) -> list[Row]:
        """Give its one row."""
        return [self.to_dict()]


def spin(robot: Robot) -> Spin:
    """Find what a whole turn on the spot takes.

    Parameters
    ----------
    robot : Robot
        The nominal robot.

    Examples
    --------
    >>> import umbmark
    >>> round(umbmark.spin(umbmark.Robot()).travel_m, 3)
    1.068
    """
    return Spin._of(_umbmark.spin(robot))
