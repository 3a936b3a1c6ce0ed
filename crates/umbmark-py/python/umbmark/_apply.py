"""A model at work: corrected odometry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from umbmark import _umbmark
from umbmark._scores import Data, data_of
from umbmark._umbmark import Model


@dataclass(frozen=True, eq=False)
class Corrected:
    """Corrected odometry of one run.

    Attributes
    ----------
    run : str
        Name of the run.
    time_s : ndarray of float64, shape (n,)
        Times of the samples in s.
    pose : ndarray of float64, shape (n, 3)
        x in m, y in m and heading in rad at each.
    covariance : ndarray of float64, shape (n, 3, 3), or None
        Their covariances, in the same units; None for a model without noise.
    """

    run: str
    time_s: NDArray[np.float64]
    pose: NDArray[np.float64]
    covariance: NDArray[np.float64] | None


def apply(
    data: Data, model: Model, *, start: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> list[Corrected]:
    """Correct the odometry of logs by a model; no reference is needed.

    Effects of the reference (delay, clock, marker) do nothing here. Covariances grow by the noise
    of the model; START and the model's values are taken to be exact.

    Parameters
    ----------
    data : Dataset or path-like
        Runs with wheel counts.
    model : Model
        The model, as ``learn`` or ``fit`` gives it.
    start : tuple of float
        Where each run begins: x and y in m, heading in rad.

    Returns
    -------
    list of Corrected
        One for each run that has a log, in their order.

    Raises
    ------
    ValueError
        If no run has a log, or the model is not for this robot.

    Examples
    --------
    >>> import umbmark
    >>> model = umbmark.Model().add("scale", e_s=1.01)
    >>> corrected = umbmark.apply(umbmark.simulate(model, runs=1), model)
    >>> len(corrected), corrected[0].pose.shape[1], corrected[0].covariance
    (2, 3, None)
    """
    return [Corrected(*run) for run in _umbmark.apply(data_of(data), model, start)]
