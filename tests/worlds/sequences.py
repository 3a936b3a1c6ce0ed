"""Squares by tape that one robot drives again and again, with a change at some run or without.

`sequences.py nothing --sets 834` prints how often `umbmark watch` accuses robots that do not
change, in months of 60 runs; `sequences.py wheel_0.2` after how many runs a change is found.
"""

import argparse
import json
import subprocess
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from math import pi, sqrt
from pathlib import Path as File
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from draw import log_uniform
from numpy.typing import NDArray
from plans import Random
from record import stream
from study import ROOT

Array = NDArray[np.float64]

PIECE_M = 0.05
MONTH = 60
"""Runs."""
QUIET = ("nothing", "student", "correlated", "bumps", "blocks")
"""Worlds in which nothing changes: normal noise; Student's t with 4 degrees of freedom;
correlated by 0.3 from run to run; wheels on rare bumps; five runs of a direction at a time."""


class Change(NamedTuple):
    """Factors after a change."""

    right: float = 1.0
    wheelbase: float = 1.0
    noise: float = 1.0
    start_m: float = 0.0
    """START has moved so far."""


CHANGES = {
    "wheel_0.1": Change(right=0.999),
    "wheel_0.2": Change(right=0.998),
    "wheel_0.5": Change(right=0.995),
    "wheelbase_0.5": Change(wheelbase=1.005),
    "wheelbase_1": Change(wheelbase=1.01),
    "noise_2": Change(noise=2.0),
    "start_50mm": Change(start_m=0.05),
    "bad_run": Change(),
}


class Asked(NamedTuple):
    """How sequences are driven and watched."""

    runs: int
    change_at: int
    side_m: float | None
    rate: float
    binary: File


class Robot(NamedTuple):
    """As it is entered, how it differs from that, and how it is measured."""

    wheelbase_m: float
    diameter_m: float
    left: float
    right: float
    wheelbase: float
    noise: float
    """Standard deviation of a wheel's travel in a metre, in metres."""
    side_m: float
    with_headings: bool
    tape_m: float


def drawn(random: Random, side_m: float | None) -> Robot:
    """A robot within wide tolerances, and its test."""
    wheelbase, diameter = random.uniform(0.2, 0.6), random.uniform(0.08, 0.25)
    left, right = (1 + random.uniform(-0.01, 0.01) for _ in range(2))
    noise, side = log_uniform(random, 1e-4, 5e-4), float(random.choice([1, 2, 4]))
    heading, tape = bool(random.random() < 0.5), random.uniform(0, 2e-3)
    ratio = 1 + random.uniform(-0.04, 0.04)
    return Robot(wheelbase, diameter, left, right, ratio, noise, side_m or side, heading, tape)


def driven(robot: Robot, sense: Array, factors: Array, random: Random, what: str) -> Array:
    """Where the robot comes to stand after each run.

    `factors` are rows of left, right, wheelbase and noise.
    """
    runs = len(sense)
    x, y, heading = np.zeros((3, runs))
    left_factor, right_factor, base_factor, noise_factor = factors
    if what == "student":
        # The noise of a whole run is larger or smaller: its pieces together are Student's t.
        noise_factor = noise_factor * np.sqrt(4 / random.chisquare(4, runs)) / sqrt(2)
    quarter = pi / 2 * robot.wheelbase_m / 2
    for is_turn in [False, True] * 4:
        way = quarter if is_turn else robot.side_m
        pieces = max(1, int(way / PIECE_M))
        scatter = robot.noise * sqrt(way / pieces) * noise_factor
        for _ in range(pieces):
            a = -sense * way / pieces if is_turn else np.full(runs, way / pieces)
            b = sense * way / pieces if is_turn else a
            a = a * left_factor + scatter * random.standard_normal(runs)
            b = b * right_factor + scatter * random.standard_normal(runs)
            if what == "bumps":
                a = a + 0.002 * (random.random(runs) < 0.1 / pieces)
                b = b + 0.002 * (random.random(runs) < 0.1 / pieces)
            turn = (b - a) / (robot.wheelbase_m * base_factor)
            x += (a + b) / 2 * np.cos(heading + turn / 2)
            y += (a + b) / 2 * np.sin(heading + turn / 2)
            heading += turn
    return np.array([x, y, heading - sense * 2 * pi])


def correlated(ends: Array, sense: Array) -> Array:
    """The same with deviations that are correlated by 0.3 from a run to its next."""
    mixed = ends.copy()
    for own in (sense < 0, sense > 0):
        mean = ends[:, own].mean(axis=1, keepdims=True)
        off = ends[:, own] - mean
        for run in range(1, off.shape[1]):
            off[:, run] = 0.3 * off[:, run - 1] + sqrt(1 - 0.09) * off[:, run]
        mixed[:, own] = mean + off
    return mixed


def sequence(
    robot: Robot, what: str, runs: int, change_at: int, random: Random
) -> tuple[Array, Array]:
    """The sense of each run, and its return error."""
    sense = np.where(np.arange(runs) % 2 == 0, -1.0, 1.0)
    if what == "blocks":
        sense = np.where(np.arange(runs) % 10 < 5, -1.0, 1.0)
    change = CHANGES.get(what, Change())
    after = np.arange(runs) >= change_at
    own = np.array([robot.left, robot.right, robot.wheelbase, 1.0])
    then = own * np.array([1.0, change.right, change.wheelbase, change.noise])
    factors = np.where(after, then[:, None], own[:, None])
    ends = driven(robot, sense, factors, random, what)
    ends[:2] += robot.tape_m * random.standard_normal((2, runs))
    ends[2] += 0.002 * random.standard_normal(runs)
    ends[0] += change.start_m * after
    if what == "correlated":
        ends = correlated(ends, sense)
    if what == "bad_run":
        ends[:, change_at] += 10 * ends[:, :change_at].std(axis=1)
    return sense, ends


def write(folder: File, robot: Robot, sense: Array, ends: Array) -> None:
    """A dataset of return poses, in the order of the runs."""
    folder.mkdir(parents=True)
    (folder / "robot.toml").write_text(
        f'[robot]\ndrive = "differential"\nwheelbase_m = {robot.wheelbase_m}\n'
        f"wheel_diameter_m = {robot.diameter_m}\nticks_per_revolution = 20000\n"
        f'[path]\nshape = "square"\nside_m = {robot.side_m}\n'
    )
    count = 3 if robot.with_headings else 2
    names = ["direction", "run", "ex_m", "ey_m", "etheta_rad"][: 2 + count]
    rows = [
        ",".join(["ccw" if way > 0 else "cw", str(run), *map(repr, map(float, end[:count]))])
        for run, (way, end) in enumerate(zip(sense, ends.T, strict=True), 1)
    ]
    (folder / "returns.csv").write_text("\n".join([",".join(names), *rows]) + "\n")


def said(what: str, seed: int, asked: Asked) -> tuple[dict[str, Any], Robot]:
    """What the command says of a sequence, and the robot."""
    random = stream(seed, what, "sequence")
    robot = drawn(random, asked.side_m)
    sense, ends = sequence(robot, what, asked.runs, asked.change_at, random)
    with TemporaryDirectory() as place:
        folder = File(place) / "robot"
        write(folder, robot, sense, ends)
        words = [str(asked.binary), "watch", str(folder), "--json", "--threads", "1"]
        words += ["--false-alarms", str(asked.rate)]
        answer = subprocess.run(words, capture_output=True, text=True, timeout=300)
    if not answer.stdout:
        raise RuntimeError(f"{what} {seed}: {answer.stderr}")
    return json.loads(answer.stdout), robot


def all_said(
    what: str, asked: Asked, chosen: argparse.Namespace
) -> list[tuple[dict[str, Any], Robot]]:
    """What the command says of all sequences."""
    seeds = range(chosen.first_seed, chosen.first_seed + chosen.sets)
    with ThreadPoolExecutor(2) as pool:
        return list(pool.map(lambda seed: said(what, seed, asked), seeds))


def quiet(what: str, chosen: argparse.Namespace) -> None:
    """Alarms in months in which nothing changes; a sequence ends with its first alarm."""
    runs = chosen.months * MONTH + 10
    alarms, compared, early, kinds = 0, 0, 0, Counter[str]()
    asked = Asked(runs, runs, chosen.side, chosen.rate, chosen.binary)
    for found, _ in all_said(what, asked, chosen):
        names = [run["run"] for run in found["runs"]]
        change = found["change"]
        last = names.index(change["seen"]) if change else len(names)
        own = sum(run["used"] == "compared" for run in found["runs"][: last + 1])
        compared += own
        if change:
            alarms += 1
            early += own <= MONTH
            kinds[change["kind"]] += 1
    months = compared / MONTH
    print(
        f"{what}: {alarms} alarms in {months:.0f} months, {alarms / months:.5f} a month, "
        f"{chosen.rate} asked; in the first month {early} of {chosen.sets}; {dict(kinds)}",
        flush=True,
    )


def changes(what: str, chosen: argparse.Namespace) -> None:
    """How many runs after a change it is found, and what is said of it."""
    at = chosen.before
    asked = Asked(at + 60, at, chosen.side, chosen.rate, chosen.binary)
    delays: list[int] = []
    early, covered, right, where, kinds = 0, 0, 0, 0, Counter[str]()
    key = "wheelbase_m" if "wheelbase" in what else "wheel_diameter_right_m"
    for found, robot in all_said(what, asked, chosen):
        names = [run["run"] for run in found["runs"]]
        change = found["change"]
        if not change:
            delays.append(1000)
            continue
        seen = names.index(change["seen"])
        if seen < at:
            early += 1
            continue
        delays.append(seen - at + 1)
        kinds[change["kind"]] += 1
        where += names.index(change["earliest"]) <= at <= names.index(change["latest"])
        right += any(one["key"] == key for one in change["alone"])
        e_d = robot.right / robot.left * (CHANGES[what].right - 1)
        if change["numbers"]:
            low, high = change["numbers"][0]["interval"]
            covered += low <= e_d <= high
    delays.sort()
    share = [delays[int(len(delays) * part)] for part in (0.5, 0.8, 0.9, 0.95)]
    within, seen = (sum(delay <= most for delay in delays) for most in (20, 60))
    print(
        f"{what}: of {len(delays)} after {at} runs, {within} found within 20, {seen} within 60, "
        f"{early} false before; 50, 80, 90, 95 % after {share}; {dict(kinds)}; "
        f"E_d in its interval {covered}, the length named {right}, "
        f"the run in its interval {where}",
        flush=True,
    )


def main(words: list[str]) -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("worlds", nargs="*", default=[*QUIET, *CHANGES])
    parser.add_argument("--sets", type=int, default=100)
    parser.add_argument("--months", type=int, default=12)
    parser.add_argument("--before", type=int, default=20)
    parser.add_argument("--side", type=float)
    parser.add_argument("--rate", type=float, default=0.01)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--binary", type=File, default=ROOT / "target/release/umbmark")
    chosen = parser.parse_args(words)
    for what in chosen.worlds:
        (quiet if what in QUIET else changes)(what, chosen)


if __name__ == "__main__":
    main(sys.argv[1:])
