"""Missions with stops, dockings and arcs of a robot whose one wheel warms up, or that is kicked.

`missions.py --sets 40 --binary PATH` prints, kind by kind, how often what is hidden is named, and
how far the numbers of the robot are off. `missions.py warms --shape linear` hides growth of another
shape than the effect has.
"""

import argparse
import json
import subprocess
import sys
from collections.abc import Callable
from math import exp, pi
from pathlib import Path as File
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from draw import log_uniform
from plans import Random
from record import stream
from setting import Array
from study import ROOT

KINDS = ("nothing", "warms", "kicked")
"""Nothing; one wheel grows by a share that settles with the way; each drive-off ahead kicks."""
NAMES = {"warms": "diameter_drift", "kicked": "leg_kick"}
"""The effect that is meant."""
GROWTHS: dict[str, Callable[[Array, Array, float], Array]] = {
    "usual": lambda way, _, settles: 1 - np.exp(-way / settles),
    "rational": lambda way, _, settles: way / (way + settles),
    "linear": lambda way, _, settles: np.minimum(way / (1.5 * settles), 1),
    "sigmoid": lambda way, _, settles: 1 / (1 + np.exp((settles - way) / (0.2 * settles))),
    "by_time": lambda _, time, settles: 1 - np.exp(-0.3 * time / settles),
}
"""Share of the growth by the way [m] and the time [s] since the run began, and a length [m]."""
KICKS: dict[str, Callable[[float, float], float]] = {
    "usual": lambda way, _: 1 - exp(-way / 0.05),
    "fixed": lambda way, _: min(way / 0.04, 1),
    "late": lambda way, _: min(max(way / 0.04 - 1, 0), 1),
    "undone": lambda way, _: 1 - exp(-way / 0.05) - 0.4 * (1 - exp(-way / 0.2)),
    "by_time": lambda _, time: 1 - exp(-time / 0.25),
}
"""Share of a kick that is made by the way [m] and the time [s] since the robot stood."""
SHAPES = {"nothing": ["usual"], "warms": list(GROWTHS), "kicked": list(KICKS)}
RUNS = 8
STEP_S = 0.01
ROW = 2
POSE = 10
"""A row of ticks every 20 ms, a pose every 100 ms."""


class World(NamedTuple):
    """A robot as it is entered and as it is, and what is hidden."""

    kind: str
    shape: str
    wheelbase_m: float
    diameter_m: float
    ticks: int
    e_d: float
    e_b: float
    e_s: float
    wheel: int
    share: float
    settles_m: float
    kick_rad: float
    noise: float
    """Of a wheel's travel in a metre, in metres."""
    runs: int


def drawn(kind: str, random: Random, shape: str = "usual") -> World:
    """A robot and its trouble."""
    return World(
        kind,
        shape,
        random.uniform(0.25, 0.6),
        random.uniform(0.08, 0.25),
        int(random.choice([1440, 4096, 20000])),
        1 + random.uniform(-0.005, 0.005),
        1 + random.uniform(-0.03, 0.03),
        1 + random.uniform(-0.01, 0.01),
        int(random.integers(0, 2)),
        log_uniform(random, 0.002, 0.006) if kind == "warms" else 0.0,
        random.uniform(10, 40),
        log_uniform(random, 0.004, 0.012) if kind == "kicked" else 0.0,
        log_uniform(random, 1e-4, 4e-4),
        RUNS,
    )


def commands(random: Random, minutes: float = 2.0) -> Array:
    """Speed and turn rate of each step, with ramps and rests."""
    told: list[tuple[float, float, float]] = [(0.0, 0.0, 2.0)]
    while sum(seconds for *_, seconds in told) < 60 * minutes:
        move = int(random.integers(0, 5))
        speed = float(random.choice([0.2, 0.4, 0.6]))
        if move == 0:
            told += [(speed, 0.0, random.uniform(3, 8)), (0.0, 0.0, 1.0)]
        elif move == 1:
            told += [
                (0.0, float(random.choice([-0.8, 0.8])), random.uniform(1, 4)),
                (0.0, 0.0, 0.5),
            ]
        elif move == 2:
            told += [(speed, random.uniform(-0.4, 0.4), random.uniform(3, 8))]
        elif move == 3:
            told += [(0.2, 0.0, 3.0), (0.0, 0.0, 1.5), (-0.2, 0.0, 3.0), (0.0, 0.0, 1.0)]
        else:
            told += [(speed, 0.0, 3.0), (0.0, 0.0, 2.0), (speed, 0.0, 3.0)]
    told += [(0.0, 0.0, 2.0)]
    wanted = np.concatenate([np.tile([v, w], (int(s / STEP_S), 1)) for v, w, s in told])
    most = np.array([0.5, 1.5]) * STEP_S
    now, driven = np.zeros(2), np.empty_like(wanted)
    for k, goal in enumerate(wanted):
        now = now + np.clip(goal - now, -most, most)
        driven[k] = now
    return driven


def run(world: World, random: Random) -> tuple[Array, Array]:
    """Ticks and true poses at each step."""
    speed, rate = commands(random).T
    left, right = world.e_s * 2 / (1 + world.e_d), world.e_s * 2 * world.e_d / (1 + world.e_d)
    told = np.stack([speed - rate * world.wheelbase_m / 2, speed + rate * world.wheelbase_m / 2])
    told = told * STEP_S
    way = np.concatenate([[0.0], np.cumsum(np.abs(speed) * STEP_S)])[:-1]
    rolled = told * np.array([[left], [right]])
    if world.share:
        grown = GROWTHS[world.shape](
            way, STEP_S * np.arange(len(way), dtype=np.float64), world.settles_m
        )
        rolled[world.wheel] *= 1 + world.share * grown
    rolled = rolled + world.noise * np.sqrt(np.abs(told)) * random.standard_normal(told.shape)
    turn = (rolled[1] - rolled[0]) / (world.e_b * world.wheelbase_m)
    if world.kick_rad:
        turn = turn + world.kick_rad * kicks(speed, KICKS[world.shape])
    heading = np.concatenate([[0.0], np.cumsum(turn)])
    middle, forward = heading[:-1] + turn / 2, rolled.mean(axis=0)
    x = np.concatenate([[0.0], np.cumsum(forward * np.cos(middle))])
    y = np.concatenate([[0.0], np.cumsum(forward * np.sin(middle))])
    angle = np.concatenate([np.zeros((2, 1)), np.cumsum(told, axis=1)], axis=1)
    return np.floor(angle / (pi * world.diameter_m) * world.ticks), np.stack([x, y, heading])


def kicks(speed: Array, by: Callable[[float, float], float] = KICKS["usual"]) -> Array:
    """Share of a kick that is made in each step after each drive-off from rest, ahead."""
    made = np.zeros_like(speed)
    way, time = 1.0, 10.0
    for k, v in enumerate(speed.tolist()):
        if v == 0.0:
            way, time = 0.0, 0.0
            continue
        after = (way + abs(v) * STEP_S, time + STEP_S)
        if v > 0.0:
            made[k] = by(*after) - by(way, time)
        way, time = after
    return made


def write(world: World, folder: File, random: Random) -> None:
    """A dataset: ticks with poses in the room in their rows."""
    (folder / "runs").mkdir(parents=True)
    (folder / "robot.toml").write_text(
        f'[robot]\nname = "mission"\nwheelbase_m = {world.wheelbase_m}\n'
        f"wheel_diameter_m = {world.diameter_m}\nticks_per_revolution = {world.ticks}\n"
    )
    for number in range(world.runs):
        ticks, poses = run(world, random)
        lines = ["t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad"]
        for k in range(0, ticks.shape[1], ROW):
            cells = [f"{k * STEP_S:.2f}", *(f"{count:.0f}" for count in ticks[:, k])]
            seen = poses[:, k] + [1e-3, 1e-3, 1e-3] * random.standard_normal(3)
            cells += [f"{value:.5f}" for value in seen] if k % POSE == 0 else [""] * 3
            lines.append(",".join(cells))
        (folder / f"runs/run_{number + 1:02}.csv").write_text("\n".join(lines) + "\n")


def said(
    kind: str, seed: int, binary: File, shape: str = "usual", runs: int = RUNS
) -> tuple[World, dict[str, Any]]:
    """A world of so many runs, and what `learn` says of it."""
    random = stream(seed, kind, "missions")
    world = drawn(kind, random, shape)._replace(runs=runs)
    with TemporaryDirectory() as place:
        folder = File(place) / "data"
        write(world, folder, random)
        words = [str(binary), "learn", str(folder), "--json", "--threads", "1", "--quiet"]
        answer = subprocess.run(words, capture_output=True, text=True, timeout=600)
    if not answer.stdout:
        raise RuntimeError(f"{kind} {seed}: {answer.stderr}")
    found: dict[str, Any] = json.loads(answer.stdout)
    return world, found


def judged(world: World, found: dict[str, Any]) -> dict[str, Any]:
    """What was added, whether it was right, and how many standard errors the numbers are off."""
    own = {"e_d": world.e_d, "e_b": world.e_b, "e_s": world.e_s}
    fitted = {one["parameter"]: one for one in found["fitted"]}
    first = [name for name in own if name in fitted]
    off = {k: (fitted[k]["value"] - own[k]) / fitted[k]["standard_error"] for k in first}
    always = {None, "wheel_diameter_ratio", "wheelbase", "scale"}
    added = {step["added"] for step in found["steps"]} - always
    meant = {NAMES[world.kind]} if world.kind in NAMES else set()
    return {
        "right": added == meant,
        "added": sorted(added),
        "off": off,
        "verdict": found["verdict"],
    }


def main(words: list[str]) -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kinds", nargs="*", default=KINDS)
    parser.add_argument("--shape", choices=sorted({*GROWTHS, *KICKS}), default="usual")
    parser.add_argument("--sets", type=int, default=20)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--binary", type=File, default=ROOT / "target/release/umbmark")
    chosen = parser.parse_args(words)
    unknown = [kind for kind in chosen.kinds if kind not in SHAPES]
    if unknown:
        parser.error(f"no kind is called {unknown[0]}; there are {', '.join(KINDS)}")
    kinds = [kind for kind in chosen.kinds if chosen.shape in SHAPES[kind]]
    if not kinds:
        parser.error(f"none of {', '.join(chosen.kinds)} has the shape {chosen.shape}")
    for kind in kinds:
        right, explained, off = 0, 0, []
        for seed in range(chosen.first_seed, chosen.first_seed + chosen.sets):
            one = judged(*said(kind, seed, chosen.binary, chosen.shape))
            right, explained = right + one["right"], explained + (one["verdict"] == "explained")
            off += [abs(value) for value in one["off"].values()]
            told = ", ".join(f"{key} {value:+.1f}" for key, value in one["off"].items())
            print(f"  {seed}: {one['verdict']}, {', '.join(one['added'])}: {told}", flush=True)
        inside = sum(value < 3 for value in off)
        print(
            f"{kind}: of {chosen.sets}, {right} right, {explained} explained; "
            f"{inside} of {len(off)} numbers within 3 standard errors",
            flush=True,
        )


if __name__ == "__main__":
    main(sys.argv[1:])
