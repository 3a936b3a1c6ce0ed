"""The work that all Python programs share, and how their time is taken."""

import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

MOVES = 8
"""Moves of a run: four legs and four turns."""


@dataclass(frozen=True)
class Work:
    """Runs round a square, each of eight moves at constant speed."""

    readings: tuple[int, ...]
    """How many times the counters are read in each move."""
    tick_m: float
    """Metres per tick of either wheel."""
    rad_per_tick: float
    """Turn of the robot by one tick of one wheel."""
    segments: Array
    """(move, [start left, start right, travel per reading left, right], run), in ticks."""


Program = Callable[[Array], tuple[Array, Array]]
"""From segments to the ends (x, y) of the runs, in metres."""


def load(folder: Path) -> Work:
    """Read what the Rust side exported."""
    about = json.loads((folder / "work.json").read_text())
    numbers = np.fromfile(folder / "segments.f64", dtype="<f8")
    return Work(
        readings=tuple(about["readings"]),
        tick_m=about["tick_m"],
        rad_per_tick=about["tick_m"] / about["wheelbase_m"],
        segments=numbers.reshape(MOVES, 4, about["runs"]),
    )


def measure(make: Callable[[Work], Program], chunk: int) -> None:
    """Run a program once to compile it and once for the clock, `chunk` runs at a time.

    Prints CPU seconds and the largest difference from the exact arcs, in metres.
    """
    folder = Path(sys.argv[1])
    work = load(folder)
    program = make(work)
    runs = work.segments.shape[2]
    chunks = [work.segments[:, :, at : at + chunk] for at in range(0, runs, chunk)]
    program(chunks[0])
    began = time.process_time()
    ends = [np.stack(program(segments), axis=1) for segments in chunks]
    seconds = time.process_time() - began
    reference = np.fromfile(folder / "ends.f64", dtype="<f8").reshape(runs, 2)
    error = np.abs(np.concatenate(ends) - reference).max()
    print(f"{seconds}\t{error:e}")
