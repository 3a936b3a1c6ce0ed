"""Logs in frames: the columns of each run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from umbmark._arguments import column, is_missing, poses
from umbmark._errors import needs

Floats: TypeAlias = NDArray[np.float64]
# Name, times, counts of the left and the right wheel, rows of the poses, and the poses.
Log: TypeAlias = tuple[str, Floats, Floats, Floats, NDArray[np.int64], Floats]


def logs(
    frame: Any,
    run: str | None,
    t: str,
    ticks: tuple[str, str],
    pose: Sequence[str] | None,
) -> Iterator[Log]:
    """Give the columns of each run of a frame, the runs in the order of their first rows."""
    if hasattr(frame, "collect") and hasattr(frame, "collect_schema"):
        raise TypeError("frame is a query that has not been run: pass frame.collect()")
    if hasattr(frame, "__arrow_c_stream__") and not hasattr(frame, "__getitem__"):
        with needs("frames"):
            import pyarrow as pa

        frame = pa.table(frame)
    time = _seconds(t, _get(frame, "t", t))
    counts = [column(name, _get(frame, "ticks", name)) for name in ticks]
    measured = _poses(frame, pose, len(time))
    for name, of in zip((t, *ticks), (time, *counts), strict=True):
        if len(of) != len(time):
            raise ValueError(f"{name} must have as many rows as {t}, got {len(of)} and {len(time)}")
        _refuse(name, ~np.isfinite(of), of, "must be finite")
    for label, rows in _runs(frame, run, len(time)):
        seen = np.flatnonzero(~np.isnan(measured[rows, :2]).all(axis=1))
        left, right = (of[rows] for of in counts)
        yield label, time[rows], left, right, seen, measured[rows][seen]


def _get(frame: Any, argument: str, name: str) -> Any:
    try:
        return frame[name]
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, LookupError):
        pass
    except Exception as error:  # polars has an exception of its own
        if "NotFound" not in type(error).__name__:
            raise
    levels = [*getattr(getattr(frame, "index", None), "names", ())]
    if name in levels or (name == "index" and levels == [None]):
        return frame.index.get_level_values(levels.index(name) if name in levels else 0)
    known = frame if isinstance(frame, Mapping) else getattr(frame, "columns", None)
    known = getattr(frame, "column_names", known)
    names = [str(of) for of in (*levels, *(() if known is None else known)) if of is not None]
    has = f"; it has {', '.join(names)}" if names else ""
    raise ValueError(f'there is no column "{name}" in the frame{has}. Say {argument}=...')


def _seconds(name: str, values: Any) -> Floats:
    """Give times in s; dates count from the first one, whatever their time zone."""
    array = np.asarray(values)
    if array.size == 0:
        return np.empty(0)
    if array.dtype.kind == "O" and isinstance(array[0], datetime):
        # Dates with a time zone, for which NumPy has no type. NaT is not equal to itself.
        unknown = [not isinstance(value, datetime) or value != value for value in array]
        _refuse(name, np.array(unknown), array, "must be a date, as in the first row")
        # In one zone, Python subtracts what clocks show, also where they are put forward.
        times = [value.astimezone(UTC) if value.tzinfo else value for value in array]
        first = min(times)
        return np.array([(value - first).total_seconds() for value in times], np.float64)
    if array.dtype.kind in "mM":
        _refuse(name, np.isnat(array), array, "must be a time")
        since = array - array.min() if array.dtype.kind == "M" else array
        return np.asarray(since / np.timedelta64(1, "s"), np.float64)
    return column(name, values)


def _poses(frame: Any, names: Sequence[str] | None, rows: int) -> Floats:
    if names is None:
        return np.full((rows, 3), np.nan)
    if len(names) not in (2, 3):
        raise ValueError(f"pose must name x, y and heading, or x and y, got {len(names)} names")
    columns = [column(name, _get(frame, "pose", name)) for name in names]
    x, y, *heading = columns
    for name, of in zip(names, columns, strict=True):
        if len(of) != rows:
            raise ValueError(
                f"{name} must have as many rows as the times, got {len(of)} and {rows}"
            )
        _refuse(name, np.isinf(of), of, "must be finite, or NaN where nothing was measured")
    beside = "must be known where the other coordinate is"
    _refuse(names[0], np.isnan(x) & ~np.isnan(y), x, beside)
    _refuse(names[1], np.isnan(y) & ~np.isnan(x), y, beside)
    for of in heading:
        _refuse(names[2], np.isnan(x) & ~np.isnan(of), of, "must be NaN where no position is known")
    return poses("pose", np.column_stack(columns))


def _refuse(name: str, wrong: NDArray[np.bool_], values: NDArray[Any], words: str) -> None:
    """Refuse a value by its column and row."""
    if wrong.any():
        row = int(np.argmax(wrong))
        raise ValueError(f"{name}[{row}] {words}, got {values[row]}")


def _runs(frame: Any, name: str | None, rows: int) -> Iterator[tuple[str, NDArray[np.intp]]]:
    """Give the rows of each run."""
    if name is None:
        yield "run_01", np.arange(rows)
        return
    given = np.asarray(_get(frame, "run", name))
    if len(given) != rows:
        raise ValueError(f"{name} must have as many rows as the times, got {len(given)}")
    _refuse(name, is_missing(given), given, "must name the run of its row")
    if given.dtype.kind == "O":
        given = given.astype(str)
    labels, first, of_row = np.unique(given, return_index=True, return_inverse=True)
    for place in np.argsort(first):
        yield str(labels[place]), np.flatnonzero(of_row == place)
