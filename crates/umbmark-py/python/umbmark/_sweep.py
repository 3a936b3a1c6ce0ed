"""Studies repeated on the points of a grid."""

from __future__ import annotations

import math
from collections.abc import Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed, by_name, integer, real
from umbmark._errors import needs
from umbmark._progress import Bar, Progress
from umbmark._result import Printed, Row
from umbmark._umbmark import Model, Path, Study

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


class Sweep(_documents.Sweep, Printed, frozen=True):
    """A study on every point of a grid."""

    _of_row: ClassVar[tuple[str, ...]] = ("mean", "std_error", "std_dev", "q*")
    text: str

    def table(self) -> list[Row]:
        """Give each metric at each point, one dict a row."""
        names = [axis.flag for axis in self.axes]
        return [
            dict(zip(names, point.values, strict=True))
            | {"metric": metric, "mean": s.mean, "std_error": s.std_error, "std_dev": s.std_dev}
            | {f"q{share}": value for share, value in s.quantiles.items()}
            for point in self.points
            for metric, s in point.metrics.items()
        ]

    def to_xarray(self) -> xr.Dataset:
        """Give the grid as an xarray Dataset: a dimension for each axis.

        Each metric is its mean; METRIC_std_error, METRIC_std_dev and METRIC_quantile (along
        ``share``) stand beside it. Points that were not reached are NaN.
        """
        with needs("frames"):
            import xarray as xr

        names = [axis.flag for axis in self.axes]
        shape = [axis.count for axis in self.axes]
        metrics = self.points[0].metrics if self.points else {}
        shares = [*next(iter(metrics.values())).quantiles] if metrics else []
        variables: dict[str, tuple[list[str], NDArray[np.float64]]] = {}
        for metric in metrics:
            rows = [
                [s.mean, s.std_error, s.std_dev, *(s.quantiles[share] for share in shares)]
                for s in (point.metrics[metric] for point in self.points)
            ]
            told = np.full((math.prod(shape), 3 + len(shares)), np.nan)
            told[: len(rows)] = np.array(rows, np.float64)
            told = told.reshape(*shape, -1)
            for place, name in enumerate(("", "_std_error", "_std_dev")):
                variables[metric + name] = (names, told[..., place])
            variables[f"{metric}_quantile"] = ([*names, "share"], told[..., 3:])
        values = {axis.flag: np.linspace(axis.first, axis.last, axis.count) for axis in self.axes}
        shown = {"share": [float(share) for share in shares]}
        return xr.Dataset(variables, coords={**values, **shown}, attrs={"seed": self.seed})

    def plot(self, ax: Axes | None = None, *, metric: str = "e_max_sys_m") -> Axes:
        """Draw the mean of a metric over one axis, or as a map over two, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.sweep(self, ax, metric)


def _axis(name: str, axis: Any) -> tuple[str, float, float, int]:
    """Give the name, the ends and the number of values of what is swept."""
    try:
        first, last, count = axis
    except (TypeError, ValueError):
        raise TypeError(f'axes["{name}"] must be (first, last, count), got {axis!r}') from None
    ends = (real(f'first of axes["{name}"]', first), real(f'last of axes["{name}"]', last))
    return name, *ends, integer(f'count of axes["{name}"]', count)


def sweep(
    model: Model,
    axes: Mapping[str, tuple[float, float, int]],
    path: Path | None = None,
    *,
    n: int = 1000,
    runs: int | tuple[int, int] = 5,
    seed: Seed = 1,
    odometry: str = "robot",
    update: str = "arc",
    phase: str = "random",
    checkpoint: str | PathLike[str] | None = None,
    resume: bool = False,
    replace: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Sweep:
    """Repeat a study for equally spaced values of parameters, on a grid where there are several.

    Parameters
    ----------
    model : Model
        The robot and its effects.
    axes : dict of str to (first, last, count)
        What is swept, by the flag of ``umbmark mc`` or the full name: "ed", "floor_slope.drift_x",
        "side", "runs", "encoder-rate".
    path : Path, optional
        The path; the paper's 4 x 4 m square where none is given.
    n : int, default 1000
        Trials of each point. Trial i has the same noise at every point, so that differences between
        points are smoother than either.
    runs, seed, odometry, update, phase, checkpoint, resume, replace, threads, progress
        As of ``monte_carlo``.

    Returns
    -------
    Sweep

    Raises
    ------
    ValueError
        If there is no such parameter, or a value is out of range.

    Examples
    --------
    >>> import umbmark
    >>> found = umbmark.sweep(umbmark.Model(), {"eb": (0.99, 1.01, 3)}, n=1, runs=1)
    >>> [f"{p.metrics['e_max_sys_m'].mean:.2f} m" for p in found.points]
    ['0.18 m', '0.00 m', '0.18 m']
    """
    study = Study(
        model, path, n=n, runs=runs, seed=seed, odometry=odometry, update=update, phase=phase
    )
    given = [_axis(name, axis) for name, axis in by_name("axes", axes, "(first, last, count)")]
    points = math.prod(count for *_, count in given)
    with Bar(progress, points, "points") as bar:
        written = None if checkpoint is None else (checkpoint, resume, replace)
        document, text = _umbmark.sweep(study, given, written, threads, bar.at)
    return Sweep._of(document, text=text)
