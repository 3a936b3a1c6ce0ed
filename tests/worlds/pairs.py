"""Pairs of UMBmark tests by tape, between which something changed or nothing did.

`pairs.py --sets 300 --binary PATH` prints how often `umbmark changed` says so, and of what.
"""

import argparse
import json
import subprocess
import sys
from collections import Counter
from math import cos, pi, sin, sqrt
from pathlib import Path as File
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from draw import log_uniform
from plans import Random
from record import stream
from study import ROOT

CHANGES = ("nothing", "wheel", "wheelbase", "noise", "start", "turned_start")
"""What a pair may differ by."""
WHEEL, WHEELBASE, NOISE = 0.998, 1.01, 3.0
"""Factors of the right wheel, the wheelbase, and the noise of both wheels."""
START_M = (0.05, -0.03)
"""Where START is by the tape of the second test."""
TURNED_RAD = 0.035
"""By how much it is turned there, in the pairs with a START that is turned, too."""
PIECE_M = 0.02


class Robot(NamedTuple):
    """As it is entered, and as it is."""

    wheelbase_m: float
    diameter_m: float
    true_left_m: float
    true_right_m: float
    true_wheelbase_m: float
    noise: float
    """Standard deviation of a wheel's travel in a metre, in metres."""


class Test(NamedTuple):
    """How it is driven and measured."""

    side_m: float
    runs: int
    with_headings: bool
    tape_m: float


Returned = tuple[str, int, float, float, float]


def drawn(random: Random) -> tuple[Robot, Test]:
    """A robot within wide tolerances, and a test of it."""
    wheelbase, diameter = random.uniform(0.2, 0.6), random.uniform(0.08, 0.25)
    left, right = (diameter * (1 + random.uniform(-0.01, 0.01)) for _ in range(2))
    true = wheelbase * (1 + random.uniform(-0.04, 0.04))
    robot = Robot(wheelbase, diameter, left, right, true, log_uniform(random, 1e-4, 5e-4))
    side, runs = float(random.choice([1, 2, 4])), int(random.integers(3, 9))
    return robot, Test(side, runs, bool(random.random() < 0.5), random.uniform(0, 2e-3))


def changed(robot: Robot, what: str) -> Robot:
    """The same robot after the change."""
    if what == "wheel":
        return robot._replace(true_right_m=WHEEL * robot.true_right_m)
    if what == "wheelbase":
        return robot._replace(true_wheelbase_m=WHEELBASE * robot.true_wheelbase_m)
    return robot._replace(noise=NOISE * robot.noise) if what == "noise" else robot


def driven(robot: Robot, test: Test, sense: int, random: Random) -> tuple[float, float, float]:
    """Where a robot that commands a square by its own numbers comes to stand."""
    x = y = heading = 0.0
    quarter = sense * pi / 2 * robot.wheelbase_m / 2
    for left, right in [(test.side_m, test.side_m), (-quarter, quarter)] * 4:
        pieces = max(1, int(abs(left) / PIECE_M))
        scatter = robot.noise * sqrt(abs(left) / pieces)
        for _ in range(pieces):
            a = left / pieces * robot.true_left_m / robot.diameter_m
            b = right / pieces * robot.true_right_m / robot.diameter_m
            a, b = a + scatter * random.standard_normal(), b + scatter * random.standard_normal()
            turn = (b - a) / robot.true_wheelbase_m
            x += (a + b) / 2 * cos(heading + turn / 2)
            y += (a + b) / 2 * sin(heading + turn / 2)
            heading += turn
    return x, y, heading - sense * 2 * pi


def measured(robot: Robot, test: Test, random: Random) -> list[Returned]:
    """The return errors of all runs, by a tape and a protractor."""
    rows: list[Returned] = []
    for direction, sense in (("cw", -1), ("ccw", 1)):
        for run in range(1, test.runs + 1):
            x, y, heading = driven(robot, test, sense, random)
            x, y = (value + test.tape_m * random.standard_normal() for value in (x, y))
            rows.append((direction, run, x, y, heading + 0.002 * random.standard_normal()))
    return rows


def from_elsewhere(rows: list[Returned], turned: float) -> list[Returned]:
    """The same returns measured from a START that lies elsewhere."""
    along, left = START_M
    c, s = cos(turned), sin(turned)
    return [
        (direction, run, along + c * x - s * y, left + s * x + c * y, heading + turned)
        for direction, run, x, y, heading in rows
    ]


def write(folder: File, robot: Robot, test: Test, rows: list[Returned]) -> None:
    """A dataset of return poses."""
    folder.mkdir(parents=True)
    (folder / "robot.toml").write_text(
        f'[robot]\ndrive = "differential"\nwheelbase_m = {robot.wheelbase_m}\n'
        f"wheel_diameter_m = {robot.diameter_m}\nticks_per_revolution = 20000\n"
        f'[path]\nshape = "square"\nside_m = {test.side_m}\n'
    )
    count = 5 if test.with_headings else 4
    names = ["direction", "run", "ex_m", "ey_m", "etheta_rad"][:count]
    lines = [",".join(map(str, row[:count])) for row in rows]
    (folder / "returns.csv").write_text("\n".join([",".join(names), *lines]) + "\n")


def said(what: str, seed: int, binary: File) -> dict[str, Any]:
    """What the command says of a pair."""
    random = stream(seed, what, "pair")
    robot, test = drawn(random)
    with TemporaryDirectory() as place:
        folders = [File(place) / name for name in ("before", "after")]
        for folder, own in zip(folders, (robot, changed(robot, what)), strict=True):
            rows = measured(own, test, random)
            if what in ("start", "turned_start") and folder.name == "after":
                rows = from_elsewhere(rows, TURNED_RAD if what == "turned_start" else 0.0)
            write(folder, own, test, rows)
        words = [str(binary), "changed", *map(str, folders), "--json"]
        answer = subprocess.run(words, capture_output=True, text=True, timeout=300)
    if not answer.stdout:
        raise RuntimeError(f"{what} {seed}: {answer.stderr}")
    found: dict[str, Any] = json.loads(answer.stdout)
    return found


def main(words: list[str]) -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("changes", nargs="*", default=CHANGES)
    parser.add_argument("--sets", type=int, default=100)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--binary", type=File, default=ROOT / "target/release/umbmark")
    chosen = parser.parse_args(words)
    for what in chosen.changes:
        count, named, failed = 0, Counter[str](), 0
        for seed in range(chosen.first_seed, chosen.first_seed + chosen.sets):
            try:
                found = said(what, seed, chosen.binary)
            except RuntimeError as error:
                failed += 1
                print(error)
                continue
            count += bool(found["changed"])
            named.update(one["key"] for one in found["robot"] if one["changed"])
            named.update(one["key"] for one in found["alone"])
            named["start"] += found["start"] is not None
        print(f"{what}: {count} of {chosen.sets - failed} changed; {dict(named)}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
