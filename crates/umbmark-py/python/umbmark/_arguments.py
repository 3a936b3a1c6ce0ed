"""Arguments of calls: numbers, seeds and arrays of any kind, and errors that name the argument."""

from __future__ import annotations

import operator
from collections.abc import Mapping, Sequence
from typing import Any, Protocol, SupportsIndex, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from umbmark._errors import needs

# What a call takes as a seed; None draws a fresh one.
Seed: TypeAlias = (
    int
    | SupportsIndex
    | np.random.Generator
    | np.random.BitGenerator
    | np.random.SeedSequence
    | None
)


class ArrowStream(Protocol):
    """What hands its columns over by the PyCapsule interface of Arrow."""

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        """Give a stream of Arrow."""


# What a call takes as numbers: sequences, arrays of any real type, and frames; None is missing.
Numbers: TypeAlias = (
    ArrayLike | Sequence[float | None] | Sequence[Sequence[float | None]] | ArrowStream
)

# As many threads as the command takes.
MOST_THREADS = 65_535
# Numbers of simulated tests that a p-value may come from, as the command takes them.
DRAWS = (99, 99_999)
# A fresh seed stays a whole number in every reader of JSON.
SEED_BITS = 53


def integer(name: str, value: Any) -> int:
    """Give a number of any integer type."""
    try:
        return operator.index(value)
    except TypeError:
        got = type(value).__name__
        raise TypeError(f"{name} must be a whole number, got {value!r} ({got})") from None


def whole(name: str, value: Any, least: int, most: int, note: str = "") -> int:
    """Give a number of any integer type within a range, both ends included."""
    number = integer(name, value)
    if not least <= number <= most:
        raise ValueError(f"{name} must be between {least}{note} and {most}, got {number}")
    return number


def threads_of(threads: Any) -> int:
    """Give a number of threads, checked; 0 stands for all processors."""
    return whole("threads", threads, 0, MOST_THREADS, " (all processors)")


def seed_of(seed: Seed) -> int:
    """Give the number that a seed stands for: itself, or a number drawn from a source."""
    if seed is None:
        seed = np.random.SeedSequence()
    if isinstance(seed, np.random.BitGenerator):
        seed = np.random.Generator(seed)
    if isinstance(seed, np.random.Generator):
        return int(seed.integers(1 << SEED_BITS))
    if isinstance(seed, np.random.SeedSequence):
        return int(seed.generate_state(1, np.uint64)[0]) >> (64 - SEED_BITS)
    try:
        return whole("seed", seed, 0, (1 << 64) - 1)
    except TypeError:
        raise TypeError(
            "seed must be a whole number, a numpy Generator, BitGenerator or SeedSequence, or None"
            f" for a fresh one, got {seed!r} ({type(seed).__name__})"
        ) from None


def options_of(size: float, draws: int, seed: Seed) -> tuple[float, int, int]:
    """Give size, draws and seed of tests."""
    return (real("size", size), whole("draws", draws, *DRAWS), seed_of(seed))


def real(name: str, value: Any) -> float:
    """Give a number of any real type."""
    try:
        return float(value)
    except (TypeError, ValueError):
        got = type(value).__name__
        raise TypeError(f"{name} must be a number, got {value!r} ({got})") from None


def names(name: str, value: Any) -> list[str]:
    """Give names as a list; a text is one of them, not its letters."""
    if isinstance(value, str):
        return [value]
    try:
        given = [*value]
    except TypeError:
        given = [value]
    for one in given:
        if not isinstance(one, str):
            raise TypeError(f"{name} must be names, got {one!r} ({type(one).__name__})")
    return given


def by_name(name: str, value: Any, wanted: str) -> list[tuple[str, Any]]:
    """Give the items of a mapping by names."""
    if not isinstance(value, Mapping):
        got = type(value).__name__
        raise TypeError(f"{name} must be a mapping of names to {wanted}, got {value!r} ({got})")
    return [*value.items()]


def pairs(name: str, value: Any, first: str, second: str) -> list[tuple[str, tuple[float, float]]]:
    """Give a mapping of names to two numbers as a list; None is an open end, on either side."""
    given = by_name(name, {} if value is None else value, f"({first}, {second})")
    return [(key, _pair(f'{name}["{key}"]', pair, first, second)) for key, pair in given]


def _pair(name: str, value: Any, first: str, second: str) -> tuple[float, float]:
    try:
        low, high = value
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be ({first}, {second}), got {value!r}") from None
    ends = (-np.inf if low is None else low, np.inf if high is None else high)
    return real(f"{name}[0]", ends[0]), real(f"{name}[1]", ends[1])


def column(name: str, value: Numbers) -> NDArray[np.float64]:
    """Give numbers of any real type, sequence or frame as an array of shape (n,)."""
    array = _array(name, value, "numbers of shape (n,)")
    if array.ndim == 2 and 1 in array.shape:
        array = array.ravel()
    if array.ndim != 1:
        raise ValueError(f"{name} must have shape (n,), got {array.shape}")
    return np.ascontiguousarray(array, np.float64)


def indices(name: str, value: Numbers) -> NDArray[np.int64]:
    """Give whole numbers of any type as an array of int64, shape (n,)."""
    array = column(name, value)
    wrong = np.flatnonzero(array != np.rint(array))
    if wrong.size:
        index = int(wrong[0])
        raise ValueError(f"{name}[{index}] must be a whole number, got {array[index]}")
    return array.astype(np.int64)


def poses(name: str, value: Numbers) -> NDArray[np.float64]:
    """Give rows of x, y and heading as an array of shape (n, 3), itself where it lies as needed.

    A missing third column becomes NaN: the heading was not measured.
    """
    shapes = "shape (n, 3), or (n, 2) without heading"
    array = _array(name, value, f"numbers of {shapes}")
    if array.shape == (0,):
        array = np.empty((0, 3))
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise ValueError(f"{name} must have {shapes}, got shape {array.shape}")
    if array.shape[1] == 2:
        array = np.column_stack([array, np.full(len(array), np.nan)])
    return np.require(array, np.float64, ["C", "A"])


def _array(name: str, value: Any, wanted: str) -> NDArray[Any]:
    """Give an array of real numbers."""
    if np.ma.isMaskedArray(value):
        raise TypeError(f"{name} must not be masked; say {name}.filled(numpy.nan)")
    if hasattr(value, "__arrow_c_stream__") and not hasattr(value, "__array__"):
        with needs("frames"):
            import pyarrow as pa

        value = pa.table(value)
    try:
        array = np.asarray(value)
        if array.dtype.kind == "O":
            # Missing values of nullable columns.
            array = np.where(is_missing(array), np.nan, array).astype(np.float64)
    except (TypeError, ValueError) as error:
        got = type(value).__name__
        raise TypeError(f"{name} must be {wanted}, got {got}: {error}") from None
    if array.dtype.kind not in "iuf":
        got = type(value).__name__
        raise TypeError(f"{name} must be {wanted}, got {got} of dtype {array.dtype}")
    if array.ndim == 0:
        raise TypeError(f"{name} must be {wanted}, got {value!r} ({type(value).__name__})")
    return array


def is_missing(array: NDArray[Any]) -> NDArray[np.bool_]:
    """Where an array has None, NaN, NaT, or pandas' NA, which equals nothing, not even itself."""
    if array.dtype.kind != "O":
        return np.asarray(array != array, bool)
    return np.array([_equals_nothing(item) for item in array.flat], bool).reshape(array.shape)


def _equals_nothing(item: Any) -> bool:
    return item is None or type(item).__name__ == "NAType" or bool(item != item)
