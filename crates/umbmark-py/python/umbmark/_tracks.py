"""Measured runs beside their odometry and a model, pose by pose."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from umbmark import _umbmark
from umbmark._errors import needs
from umbmark._result import ByValue, Frame, html_table
from umbmark._scores import Data, data_of, model_of
from umbmark._umbmark import Model

if TYPE_CHECKING:
    import pyarrow as pa

Floats: TypeAlias = NDArray[np.float64]

# The columns of a frame: the arrays of a track, and what their columns are called.
COLUMNS = {
    "odometry": ("x_odometry_m", "y_odometry_m", "heading_odometry_rad"),
    "modelled": ("x_modelled_m", "y_modelled_m", "heading_modelled_rad"),
    "measured": ("x_measured_m", "y_measured_m", "heading_measured_rad"),
    "residual": ("x_residual_m", "y_residual_m", "heading_residual_rad"),
    "whitened": ("x_whitened", "y_whitened", "heading_whitened"),
}


@dataclass(frozen=True, eq=False)
class Track(ByValue):
    """One measured run beside its odometry and a model, at the m poses that the reference measured.

    All poses are rows of x in m, y in m and heading in rad, in the frame of START.

    Attributes
    ----------
    run : str
        Name of the run.
    direction : str or None
        "cw" or "ccw"; None for paths that have no sense of driving.
    time_s : ndarray of float64, shape (m,)
        Times of the poses since the run began, in s.
    odometry : ndarray of float64, shape (m, 3)
        The poses that the nominal robot computes from its counts.
    modelled : ndarray of float64, shape (m, 3)
        The poses that the model predicts for the reference, with its delay and marker.
    measured : ndarray of float64, shape (m, 3)
        The measured poses, moved as a whole so that the run begins where the model does; NaN for
        headings that were not measured. Wrong poses, which no fit uses, are left out.
    residual : ndarray of float64, shape (m, 3)
        Measured minus modelled, headings in (-pi, pi].
    whitened : ndarray of float64, shape (m, 3), or None
        Residuals divided by the Cholesky factor of their covariance under the noise of the model,
        as the fit uses them: under a right model, independent and of variance 1. Neighbouring poses
        (a robot at rest) count as one, whose residual stands at the last of them; NaN at the
        others. None for a model without noise.
    """

    run: str
    direction: str | None
    time_s: Floats
    odometry: Floats
    modelled: Floats
    measured: Floats
    residual: Floats
    whitened: Floats | None


class Tracks(Sequence[Track], Frame):
    """Measured runs beside their odometry and a model: a sequence of ``Track``, and one frame.

    It hands its frame, one row a pose, to whatever reads Arrow. Tracks compare by value.
    """

    def __init__(self, tracks: Sequence[Track]) -> None:
        """Keep the tracks."""
        self._tracks = tuple(tracks)

    @overload
    def __getitem__(self, place: int) -> Track: ...

    @overload
    def __getitem__(self, place: slice) -> Tracks: ...

    def __getitem__(self, place: int | slice) -> Track | Tracks:
        """Give a track, or some of them."""
        if isinstance(place, slice):
            return Tracks(self._tracks[place])
        return self._tracks[place]

    def __eq__(self, other: object) -> bool:
        return self._tracks == other._tracks if isinstance(other, Tracks) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._tracks)

    def __len__(self) -> int:
        return len(self._tracks)

    def __iter__(self) -> Iterator[Track]:
        return iter(self._tracks)

    @property
    def rms_m(self) -> float:
        """Root mean square distance of measured from modelled positions, in m."""
        return float(np.sqrt(np.mean(np.sum(self._all("residual")[:, :2] ** 2, axis=1))))

    @property
    def rms_rad(self) -> float:
        """Root mean square of the residuals of headings, in rad; NaN where none were measured."""
        headings = self._all("residual")[:, 2]
        known = headings[np.isfinite(headings)]
        return float(np.sqrt(np.mean(known**2))) if known.size else float("nan")

    @property
    def chi2(self) -> float | None:
        """Sum of the squared whitened residuals; None for a model without noise."""
        if any(track.whitened is None for track in self):
            return None
        return float(np.nansum(self._all("whitened") ** 2))

    @property
    def whitened_count(self) -> int:
        """Number of whitened residuals, from which chi2 is."""
        return sum(
            int(np.isfinite(track.whitened).sum()) for track in self if track.whitened is not None
        )

    @property
    def reduced_chi2(self) -> float | None:
        """chi2 for each whitened residual, about 1 if the model is right; None without noise."""
        return self.chi2 / self.whitened_count if self.chi2 and self.whitened_count else None

    @property
    def poses(self) -> int:
        """Number of measured poses."""
        return sum(len(track.time_s) for track in self)

    def _all(self, name: str) -> Floats:
        arrays = [getattr(track, name) for track in self]
        return np.concatenate(arrays) if arrays else np.empty((0, 3))

    def to_arrow(self) -> pa.Table:
        """Give all poses as an Arrow table: run, direction, time, and each x, y and heading."""
        with needs("frames"):
            import pyarrow as pa

        columns: dict[str, object] = {
            "run": pa.array([track.run for track in self for _ in track.time_s], pa.string()),
            "direction": pa.array(
                [track.direction for track in self for _ in track.time_s], pa.string()
            ),
            "t_s": np.concatenate([track.time_s for track in self]) if self else np.empty(0),
        }
        for name, titles in COLUMNS.items():
            if name != "whitened" or self.chi2 is not None:
                columns |= dict(zip(titles, self._all(name).T, strict=True))
        return pa.table(columns)

    def _repr_html_(self) -> str:
        """Give the root mean square of the residuals of each run, in mm and deg."""
        told = ((track, Tracks([track])) for track in self)
        rows = [
            {
                "run": track.run,
                "direction": track.direction,
                "poses": alone.poses,
                "rms_m": alone.rms_m,
                "rms_rad": None if np.isnan(alone.rms_rad) else alone.rms_rad,
            }
            for track, alone in told
        ]
        return html_table(repr(self), rows)

    def __repr__(self) -> str:
        return f"Tracks({len(self)} runs, {self.poses} poses, {1e3 * self.rms_m:.2f} mm rms)"


def tracks(data: Data, model: Model | None = None) -> Tracks:
    """Put measured runs beside their odometry and a model, pose by pose.

    Parameters
    ----------
    data : Dataset or path-like
        Runs with wheel counts and absolute poses at three or more places.
    model : Model, optional
        The model, with the values that it has; the nominal robot where none is given. Whitened
        residuals need its noise, which ``fit`` and ``learn`` find.

    Returns
    -------
    Tracks

    Raises
    ------
    ValueError
        If no run has counts and enough poses, or the model is not for this robot.

    Examples
    --------
    >>> import umbmark
    >>> truth = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=0.0003)
    >>> data = umbmark.simulate(truth, umbmark.Path(side_m=1.0), runs=2, reference_rate_hz=2)
    >>> fitted = umbmark.fit(data).tracks()
    >>> fitted[0].residual.shape == fitted[0].modelled.shape == (len(fitted[0].time_s), 3)
    True
    >>> fitted.rms_m < 0.2 * umbmark.tracks(data).rms_m
    True
    """
    read = data_of(data)
    found = _umbmark.tracks(read, model_of(model) or Model(read.robot))
    if not found:
        raise ValueError(
            "no run has wheel counts and absolute poses at three or more places: tracks need both"
        )
    return Tracks(
        [
            Track(run, direction, time, odometry, modelled, measured, residual, whitened)
            for run, direction, time, (odometry, modelled, measured, residual), whitened in found
        ]
    )
