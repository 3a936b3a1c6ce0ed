"""Scores of UMBmark tests."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias, TypeGuard, overload

from umbmark import _documents
from umbmark._arguments import Numbers, real
from umbmark._result import Printed, Row
from umbmark._umbmark import Dataset, Model, load_dataset, score_arrays, score_dataset

if TYPE_CHECKING:
    from matplotlib.axes import Axes

log = logging.getLogger("umbmark.data")

Data: TypeAlias = Dataset | str | PathLike[str] | Sequence[str | PathLike[str]]


def data_of(data: Data) -> Dataset:
    """Give the dataset, read where its place is given; several places are read as one.

    What was mended is logged: a caller that gives a place does not see the dataset's warnings.
    """
    if isinstance(data, Dataset):
        return data
    if not _are_places(data):
        raise TypeError(
            "data must be a Dataset, its place, or several places, got"
            f" {data!r:.60} ({type(data).__name__}); Dataset.from_arrays and from_frame make one"
        )
    read = load_dataset(data)
    for warning in read.warnings:
        log.warning("%s: %s", ", ".join(places_of(data)), warning)
    return read


def model_of(model: Model | None) -> Model | None:
    """Give a model, checked; None where none is given."""
    return None if model is None else a_model(model)


def a_model(model: Any) -> Model:
    """Give a model, checked."""
    if isinstance(model, Model):
        return model
    got = type(model).__name__
    raise TypeError(f"model must be a Model, got {model!r:.60} ({got}); Model.read reads a file")


def places_of(data: Data) -> list[str]:
    """Give the places that data are read from: none for those in memory."""
    if isinstance(data, Dataset):
        return []
    return [fspath(data)] if isinstance(data, str | PathLike) else [fspath(place) for place in data]


def _are_places(data: Any) -> TypeGuard[str | PathLike[str] | Sequence[str | PathLike[str]]]:
    """Whether it is a place, or several: numbers are not."""
    if isinstance(data, Sequence) and not isinstance(data, str):
        return bool(data) and all(isinstance(place, str | PathLike) for place in data)
    return isinstance(data, str | PathLike)


class Score(_documents.Score, Printed, frozen=True):
    """The scores of a UMBmark test, with intervals that hold with probability ``level``."""

    _of_row: ClassVar[tuple[str, ...]] = ("value", "low", "high")
    text: str

    def table(self) -> list[Row]:
        """Give each score with the ends of its interval, one dict a row."""
        rows = [
            ("e_max_sys_m", self.e_max_sys_m, self.e_max_sys_interval_m),
            ("sigma_m", self.sigma_m, self.sigma_interval_m),
            (
                "return_heading_cw_rad",
                self.return_heading_cw_rad,
                self.return_heading_cw_interval_rad,
            ),
            (
                "return_heading_ccw_rad",
                self.return_heading_ccw_rad,
                self.return_heading_ccw_interval_rad,
            ),
            (
                "nonsys_orientation_rad",
                self.nonsys_orientation_rad,
                self.nonsys_orientation_interval_rad,
            ),
        ]
        for direction in ("cw", "ccw"):
            centre = getattr(self, f"centroid_{direction}_m") or (None, None)
            intervals = getattr(self, f"centroid_{direction}_interval_m") or (None, None)
            for axis, value, interval in zip("xy", centre, intervals, strict=True):
                rows.append((f"centroid_{direction}_{axis}_m", value, interval))
        return [
            {
                "score": name,
                "value": value,
                "low": (ends or (None,))[0],
                "high": (ends or (None,))[-1],
            }
            for name, value, ends in rows
        ]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the centres of gravity with their ellipses, and E_max,sys, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.score(self, ax)


@overload
def score(data: Data, /, *, level: float = 0.95, convention: str = "mean") -> Score: ...


@overload
def score(
    cw: Numbers,
    ccw: Numbers,
    *,
    bumps_cw: Numbers | None = None,
    bumps_ccw: Numbers | None = None,
    level: float = 0.95,
    convention: str = "mean",
) -> Score: ...


def score(
    cw: Any,
    ccw: Any = None,
    *,
    bumps_cw: Numbers | None = None,
    bumps_ccw: Numbers | None = None,
    level: float = 0.95,
    convention: str = "mean",
) -> Score:
    """Score a UMBmark test: a dataset, or the return errors of its runs.

    Equations 1 to 6 of Borenstein and Feng (1995), "UMBmark: A Benchmark Test for Measuring
    Odometry Errors in Mobile Robots", for any number of runs, with intervals that hold for few of
    them.

    Parameters
    ----------
    cw : Dataset, path-like, or array of numbers, shape (n, 3) or (n, 2)
        A dataset, its place, or several places. Or the return errors of the clockwise runs, one row
        per run: x in m, y in m, heading in rad, each absolute minus computed (Eq. 1), in the frame
        of START, headings counter-clockwise positive. A heading that is NaN, or a missing third
        column, was not measured. Without any run of a direction, shape (0, 3), the other
        direction's centroid is still given. Sequences, NumPy arrays of any real type, and frames of
        pandas, polars and Arrow with these columns are such arrays; C-contiguous float64 is read
        where it lies.
    ccw : array of numbers, shape (n, 3) or (n, 2)
        The same of the counter-clockwise runs, where ``cw`` is an array.
    bumps_cw, bumps_ccw : array of numbers, shape (n, 3) or (n, 2), optional
        The same of the extended test, driven over bumps.
    level : float, default 0.95
        Probability with which each interval holds the true value.
    convention : str, default "mean"
        How Eq. 5 joins both directions: "mean", half of it, as Table II has it, or "sum", as
        printed.

    Returns
    -------
    Score
        Whatever could not be computed is None, and ``Score.warnings`` says why.

    Raises
    ------
    TypeError
        If an argument has no numbers, or is masked, or there are arrays beside a dataset.
    ValueError
        If an array has another shape, a position is not finite, a heading is infinite, the level
        does not lie between 0 and 1, there is no run at all, or a file cannot be read.

    Examples
    --------
    >>> import numpy as np
    >>> import umbmark
    >>> cw = np.array([[-0.21, -0.19, -0.05], [-0.19, -0.21, -0.06], [-0.20, -0.23, -0.04]])
    >>> ccw = np.array([[0.02, 0.01, 0.01], [0.01, -0.02, 0.02], [0.00, -0.02, 0.00]])
    >>> result = umbmark.score(cw, ccw)
    >>> low, high = result.e_max_sys_interval_m
    >>> print(f"E_max,sys {result.e_max_sys_m:.3f} m, between {low:.3f} and {high:.3f} m")
    E_max,sys 0.290 m, between 0.270 and 0.307 m
    >>> print(f"by the runs' scatter alone it would stay below {result.noise_band_m:.3f} m")
    by the runs' scatter alone it would stay below 0.023 m
    """
    level = real("level", level)
    if isinstance(cw, Dataset) or _are_places(cw):
        beside = {"ccw": ccw, "bumps_cw": bumps_cw, "bumps_ccw": bumps_ccw}
        given = [name for name, value in beside.items() if value is not None]
        if given:
            raise TypeError(
                f"{given[0]} goes with return errors in arrays, but the first argument is a"
                f" dataset, which holds all of its runs, got {type(cw).__name__}"
            )
        document, text = score_dataset(data_of(cw), level, convention)
    else:
        document, text = score_arrays(cw, ccw, bumps_cw, bumps_ccw, level, convention)
    return Score._of(document, text=text)
