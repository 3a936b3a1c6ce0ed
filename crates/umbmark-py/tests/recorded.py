"""What tests of logs of messages share: the rows of a CSV log, and how answers are compared."""

import csv
import json
import math
import shutil
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

TICKS_PER_REVOLUTION = 2000
# Times of a calendar, as recorders have them.
EPOCH_NS = 1_760_000_000_000_000_000


def answer(command: Path, *arguments: str | Path) -> Any:
    """Return the JSON document that the command prints."""
    run = [command, *arguments, "--json"]
    return json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)


@dataclass(frozen=True)
class Row:
    """A row of a tick log."""

    stamp: int
    left: int
    right: int
    pose: tuple[float, float, float] | None

    @property
    def time(self) -> dict[str, int]:
        """Return the stamp as messages have it."""
        return {"sec": self.stamp // 10**9, "nanosec": self.stamp % 10**9}

    @property
    def positions(self) -> list[float]:
        """Return the angles of the wheels [rad]."""
        scale = math.tau / TICKS_PER_REVOLUTION
        return [self.left * scale, self.right * scale]

    @property
    def quaternion(self) -> dict[str, float]:
        """Return the heading as a quaternion."""
        assert self.pose is not None
        half = 0.5 * self.pose[2]
        return {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)}


def rows(file: Path) -> Iterator[Row]:
    """Return the rows of a CSV log."""
    with file.open() as text:
        for row in csv.DictReader(text):
            stamp = EPOCH_NS + round(float(row["t_s"]) * 1e9)
            cells = [row["x_ref_m"], row["y_ref_m"], row["theta_ref_rad"]]
            pose = tuple(map(float, cells)) if cells[0] else None
            yield Row(stamp, int(row["ticks_left"]), int(row["ticks_right"]), pose)  # type: ignore[arg-type]


def numbers(value: Any) -> Iterator[float]:
    """Yield every number in a document."""
    if isinstance(value, dict):
        for key in sorted(value):
            yield from numbers(value[key])
    elif isinstance(value, list):
        for item in value:
            yield from numbers(item)
    elif isinstance(value, float):
        yield value


def assert_same_setup(theirs: Any, ours: Any) -> None:
    """Compare findings; what was estimated, within a twentieth of its standard error.

    Estimates rest on windows of the motion, and stamps in nanoseconds move a row across the edge of
    one.
    """
    if isinstance(ours, dict) and "std_error" in ours:
        allowed = 0.05 * ours["std_error"]
        assert theirs["value"] == pytest.approx(ours["value"], rel=0, abs=allowed)
        assert theirs["std_error"] == pytest.approx(ours["std_error"], rel=0.05)
    elif isinstance(ours, dict):
        assert theirs.keys() == ours.keys()
        for key, value in ours.items():
            assert_same_setup(theirs[key], value)
    elif isinstance(ours, list):
        for one, other in zip(theirs, ours, strict=True):
            assert_same_setup(one, other)
    else:
        assert theirs == ours


def record(measured: Path, place: Path, write: Callable[[Path, list[Row]], None]) -> Path:
    """Write the logs of a dataset anew into a folder beside its robot and its returns."""
    folder = place / "robot"
    (folder / "runs").mkdir(parents=True)
    for name in ["robot.toml", "returns.csv"]:
        shutil.copy(measured / name, folder)
    for file in (measured / "runs").iterdir():
        write(folder / "runs" / file.stem, list(rows(file)))
    return folder


def assert_calibrates_alike(command: Path, measured: Path, recorded: Path) -> None:
    """Hold the answer from recorded logs against that from the CSV of the same runs."""
    ours = answer(command, "calibrate", measured)
    theirs = answer(command, "calibrate", recorded)
    assert theirs["warnings"] == ours["warnings"]
    assert_same_setup(theirs.pop("setup"), ours.pop("setup"))
    expected = list(numbers(ours))
    assert len(expected) > 50
    # Stamps since an epoch have other last bits, and the search for the noise may end 1e-10 m away.
    assert list(numbers(theirs)) == pytest.approx(expected, rel=1e-6, abs=1e-9)
