"""A model at work: corrected odometry."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, overload

import numpy as np
from numpy.typing import NDArray

from umbmark import _umbmark
from umbmark._arguments import column
from umbmark._errors import needs
from umbmark._result import ByValue, Frame
from umbmark._scores import Data, a_model, data_of
from umbmark._umbmark import Model

if TYPE_CHECKING:
    import pyarrow as pa

# The columns of a pose and of its covariance, as in the files of ``umbmark apply``.
POSE = ("x_m", "y_m", "theta_rad")
COVARIANCE = {
    "var_x_m2": (0, 0),
    "cov_x_y_m2": (0, 1),
    "var_y_m2": (1, 1),
    "cov_x_theta_m_rad": (0, 2),
    "cov_y_theta_m_rad": (1, 2),
    "var_theta_rad2": (2, 2),
}


@dataclass(frozen=True, eq=False)
class Corrected(ByValue):
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


class CorrectedRuns(Sequence[Corrected], Frame):
    """Corrected odometry of logs: a sequence of ``Corrected``, and one frame.

    It hands its frame, one row a sample, to whatever reads Arrow. The columns are those of the
    files that ``umbmark apply`` writes, with the name of the run before them.
    """

    def __init__(self, runs: Sequence[Corrected]) -> None:
        """Keep the runs."""
        self._runs = tuple(runs)

    @overload
    def __getitem__(self, place: int) -> Corrected: ...

    @overload
    def __getitem__(self, place: slice) -> CorrectedRuns: ...

    def __getitem__(self, place: int | slice) -> Corrected | CorrectedRuns:
        """Give a run, or some of them."""
        if isinstance(place, slice):
            return CorrectedRuns(self._runs[place])
        return self._runs[place]

    def __eq__(self, other: object) -> bool:
        return self._runs == other._runs if isinstance(other, CorrectedRuns) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._runs)

    def __len__(self) -> int:
        return len(self._runs)

    def __iter__(self) -> Iterator[Corrected]:
        return iter(self._runs)

    def to_arrow(self) -> pa.Table:
        """Give all samples as an Arrow table: run, time, pose, and its covariance where known."""
        with needs("frames"):
            import pyarrow as pa

        def joined(
            arrays: list[NDArray[np.float64]], shape: tuple[int, ...]
        ) -> NDArray[np.float64]:
            return np.concatenate([np.empty((0, *shape)), *arrays])

        columns: dict[str, object] = {
            "run": pa.array([run.run for run in self for _ in run.time_s], pa.string()),
            "t_s": joined([run.time_s for run in self], ()),
        }
        columns |= zip(POSE, joined([run.pose for run in self], (3,)).T, strict=True)
        covariances = [run.covariance for run in self if run.covariance is not None]
        if covariances:
            told = joined(covariances, (3, 3))
            columns |= {name: told[:, row, of] for name, (row, of) in COVARIANCE.items()}
        return pa.table(columns)

    def __repr__(self) -> str:
        samples = sum(len(run.time_s) for run in self)
        return f"CorrectedRuns({len(self)} runs, {samples} samples)"


def apply(
    data: Data, model: Model, *, start: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> CorrectedRuns:
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
    CorrectedRuns
        A ``Corrected`` for each run that has a log, in their order; ``to_pandas`` and the like
        give one frame of all.

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
    at = column("start", start)
    if at.size != 3 or not np.isfinite(at).all():
        raise ValueError(f"start must be three finite numbers (x_m, y_m, theta_rad), got {start!r}")
    found = _umbmark.apply(data_of(data), a_model(model), (at[0], at[1], at[2]))
    return CorrectedRuns([Corrected(*run) for run in found])
