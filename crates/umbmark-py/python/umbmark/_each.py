"""Many robots by one call: in parallel, with one frame of all."""

from __future__ import annotations

import functools
import inspect
import itertools
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from umbmark._arguments import Numbers, whole
from umbmark._executor import MOST_WORKERS, Executor, in_order
from umbmark._progress import Bar, Progress
from umbmark._result import Frame, Result, Row, arrow_of, html_table
from umbmark._scores import Data
from umbmark._umbmark import Dataset, Path, Robot

if TYPE_CHECKING:
    import pyarrow as pa

Found = TypeVar("Found", bound=Result)

# Tasks for each worker, so that none waits long for another, and the most robots in one.
TASKS = 16
MOST_AT_ONCE = 32


def fleet(
    cw: Numbers,
    ccw: Numbers,
    *,
    robot: Robot | None = None,
    path: Path | None = None,
    names: Sequence[str] | None = None,
) -> dict[str, Dataset]:
    """Give the return errors of many robots of one kind as a dataset each, for ``each``.

    Parameters
    ----------
    cw, ccw : array of numbers, shape (robots, runs, 3) or (robots, runs, 2)
        The return errors of each robot's runs, as ``score`` takes those of one. A run that was not
        driven is a row of NaN.
    robot, path, optional
        As of ``Dataset.from_arrays``, of all of them.
    names : sequence of str, optional
        Names of the robots; "1", "2", ... where none are given.

    Raises
    ------
    ValueError
        If the arrays have other shapes or tell of different numbers of robots, or two names are
        the same.

    Examples
    --------
    >>> import numpy as np
    >>> import umbmark
    >>> cw = np.random.default_rng(1).normal([-0.20, -0.21, -0.05], 0.01, (100, 5, 3))
    >>> ccw = np.random.default_rng(2).normal([0.01, 0.00, 0.01], 0.01, (100, 5, 3))
    >>> robot, path = umbmark.Model().robot, umbmark.Path.umbmark()
    >>> fleet = umbmark.fleet(cw, ccw, robot=robot, path=path)
    >>> umbmark.each(umbmark.calibrate, fleet, learn=False)
    Each(Calibration: 100 robots, 0 failed)
    """
    arrays = [_of_robots("cw", cw), _of_robots("ccw", ccw)]
    counts = [len(array) for array in arrays]
    if counts[0] != counts[1]:
        raise ValueError(f"cw has {counts[0]} robots and ccw {counts[1]}: they must be the same")
    names = [str(place) for place in range(1, counts[0] + 1)] if names is None else [*names]
    if len(names) != counts[0] or len(set(names)) != counts[0]:
        raise ValueError(f"names must be {counts[0]} different names, one for each robot")
    driven = ([rows[~np.isnan(rows).all(axis=1)] for rows in array] for array in arrays)
    of_robots = zip(names, *driven, strict=True)
    return {
        name: Dataset.from_arrays(one, other, robot=robot, path=path)
        for name, one, other in of_robots
    }


def _of_robots(name: str, value: Numbers) -> NDArray[np.float64]:
    array = np.asarray(value, np.float64)
    if array.ndim != 3 or array.shape[2] not in (2, 3):
        raise ValueError(
            f"{name} must have shape (robots, runs, 3) or (robots, runs, 2), got {array.shape}"
        )
    return array


class Each(Mapping[str, Found], Frame, Generic[Found]):
    """What one call found for each of many robots: a mapping of their names to results.

    It hands one frame of all of them to whatever reads Arrow.

    Attributes
    ----------
    failed : dict of str to str
        Robots for which nothing was found, by their names, and why.
    """

    def __init__(self, found: Mapping[str, Found], failed: Mapping[str, str]) -> None:
        """Keep what was found."""
        self._found = dict(found)
        self.failed: dict[str, str] = dict(failed)

    def __getitem__(self, name: str) -> Found:
        """Give the result of a robot."""
        return self._found[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Each):
            return (self._found, self.failed) == (other._found, other.failed)
        return NotImplemented

    # What failed can be changed.
    __hash__ = None  # type: ignore[assignment]

    def table(self) -> list[Row]:
        """Give the tables of all results one below the other, with the name of the robot."""
        rows = [{"robot": name} | row for name, result in self.items() for row in result.table()]
        names = dict.fromkeys(name for row in rows for name in row)
        return [{name: row.get(name) for name in names} for row in rows]

    def to_arrow(self) -> pa.Table:
        """Give its ``table`` as an Arrow table."""
        first = next(iter(self.values()), None)
        return arrow_of(self.table(), {} if first is None else first._kinds())

    def _repr_html_(self) -> str:
        """Give its ``table`` with lengths in mm and angles in deg, and what failed."""
        first = next(iter(self.values()), None)

        def cells(row: Row) -> list[str]:
            # A robot may be called what a column is.
            rest = {key: value for key, value in row.items() if key != "robot"}
            return [row["robot"], *(() if first is None else first._cells(rest))]

        failed = [{"robot": name, "failed": why} for name, why in self.failed.items()]
        page = html_table(repr(self), self.table(), cells)
        return page + (html_table("failed", failed) if failed else "")

    def __repr__(self) -> str:
        first = next(iter(self.values()), None)
        kind = "nothing found" if first is None else type(first).__name__
        return f"Each({kind}: {len(self)} robots, {len(self.failed)} failed)"


def each(
    call: Callable[..., Found],
    robots: Mapping[str, Data] | Sequence[Data],
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress = None,
    **keys: Any,
) -> Each[Found]:
    """Score, calibrate, diagnose or learn many robots, in parallel.

    Parameters
    ----------
    call : callable
        What is asked of each: ``umbmark.score``, ``calibrate``, ``diagnose``, ``learn``, ``solve``,
        ``fit``, ``inspect``, or a function of your own that takes data and gives such a result.
    robots : mapping of str to Dataset or path-like, or sequence of these
        The measurements of each robot. In a sequence they are called "1", "2", ...
    executor : Executor, optional
        What runs the calls, as of ``umbmark.distributed``; threads of this process where none is
        given.
    workers : int, optional
        How many calls run at a time; the processors of this machine where none is given.
    progress : bool or callable, optional
        True for a bar of tqdm; or a function of the robots done and of all.
    **keys
        Passed to each call. ``threads`` is 1 where the call takes it and nothing else is said. All
        robots have the same ``seed``: each gets what a call of its own would give.

    Returns
    -------
    Each
        The results in the order of the robots. A robot whose call raises ValueError stands in
        ``failed`` with the message; the others are not stopped.

    Raises
    ------
    TypeError
        If the robots are the place of a single one.

    Examples
    --------
    >>> import umbmark
    >>> model = umbmark.Model().add("wheel_noise", k_sqrt_m=0.001)
    >>> robots = {f"cart {i}": umbmark.simulate(model, seed=i, runs=3) for i in (1, 2)}
    >>> found = umbmark.each(umbmark.score, robots)
    >>> found
    Each(Score: 2 robots, 0 failed)
    >>> found["cart 2"] == umbmark.score(robots["cart 2"])
    True
    >>> found.to_pandas()["robot"].unique().tolist()
    ['cart 1', 'cart 2']
    """
    robots = named(robots)
    if workers is not None:
        workers = whole("workers", workers, 1, MOST_WORKERS)
    if "threads" in inspect.signature(call).parameters:
        keys.setdefault("threads", 1)
    work = functools.partial(_told, call, keys)
    found: dict[str, Found] = {}
    failed: dict[str, str] = {}
    with ExitStack() as stack:
        if executor is None:
            executor = stack.enter_context(ThreadPoolExecutor(workers or os.cpu_count()))
        bar = stack.enter_context(Bar(progress, len(robots), "robots"))
        parts = in_order(executor, work, _parts([*robots.values()], workers), workers)
        told = itertools.chain.from_iterable(parts)
        for name, (result, why) in zip(robots, told, strict=True):
            if result is None:
                failed[name] = why
            else:
                found[name] = result
            bar.at(len(found) + len(failed))
    return Each(found, failed)


def named(robots: Mapping[str, Data] | Sequence[Data]) -> Mapping[str, Data]:
    """Give the data of robots by name; in a sequence they are called "1", "2", ..."""
    if isinstance(robots, str | Dataset) or not isinstance(robots, Mapping | Sequence):
        got = type(robots).__name__
        raise TypeError(f"robots must be a mapping or a sequence of data, got {got}")
    if isinstance(robots, Mapping):
        return robots
    return {str(place): data for place, data in enumerate(robots, 1)}


def _parts(robots: list[Data], workers: int | None) -> list[list[Data]]:
    """Give the robots that are asked by one task: it costs about as much as one short call."""
    tasks = TASKS * (workers or os.cpu_count() or 1)
    size = max(1, min(MOST_AT_ONCE, len(robots) // tasks))
    return [robots[begin : begin + size] for begin in range(0, len(robots), size)]


def _told(
    call: Callable[..., Found], keys: Mapping[str, Any], part: list[Data]
) -> list[tuple[Found | None, str]]:
    """Give what the call gives of each robot, or why it gives nothing."""
    return [_told_of(call, keys, data) for data in part]


def _told_of(
    call: Callable[..., Found], keys: Mapping[str, Any], data: Data
) -> tuple[Found | None, str]:
    try:
        return call(data, **keys), ""
    except ValueError as error:
        return None, str(error)
