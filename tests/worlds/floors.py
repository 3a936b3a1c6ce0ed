"""UMBmark tests by tape on several floors or days, whose numbers differ in known ways or do not.

`floors.py --sets 300 --binary PATH` prints how often `umbmark conditions` names what differs, and
with `--learn` how often `umbmark learn` says that its model does not hold on every floor.
"""

import argparse
import json
import subprocess
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path as File
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from draw import log_uniform
from pairs import Returned, Robot, Test, drawn, measured, write
from plans import Random
from record import stream
from study import ROOT

KINDS = ("nothing", "wheelbase", "wheels", "both", "load", "days", "noise")
"""What differs: nothing; E_b on floors; E_d on floors; E_b on floors and E_d with the battery; E_b
with the load; E_b on days, whatever the floor; only the noise on floors."""
FLOORS = ("tile", "carpet", "felt", "stone")


class World(NamedTuple):
    """Runs with their conditions, and what is true of them."""

    robot: Robot
    test: Test
    rows: list[Returned]
    stated: list[dict[str, str]]
    differing: set[tuple[str, str]]
    """Numbers that differ, each with the condition."""
    values: dict[tuple[str, str, str], float]
    """Number, condition and level: its true value, relative to the first level."""


def floor(robot: Robot, wheelbase: float = 1.0, wheel: float = 1.0, noise: float = 1.0) -> Robot:
    """The robot on a floor."""
    return robot._replace(
        true_wheelbase_m=wheelbase * robot.true_wheelbase_m,
        true_right_m=wheel * robot.true_right_m,
        true_left_m=robot.true_left_m / wheel,
        noise=noise * robot.noise,
    )


def sizes(random: Random, levels: int, least: float, most: float) -> list[float]:
    """Factors of levels: 1, and others that are off by about so much and differ."""
    off = log_uniform(random, least, most) * (1 if random.random() < 0.5 else -1)
    return [1.0, *(1 + off * (1 + 0.5 * k) for k in range(levels - 1))]


def world(kind: str, seed: int) -> World:
    """A world of this kind."""
    random = stream(seed, kind, "floors")
    robot, test = drawn(random)
    test = test._replace(runs=int(random.integers(4, 9)))
    levels = int(random.integers(2, 4))
    floors = [str(name) for name in random.permutation(FLOORS)[:levels]]
    of_wheelbase = kind in ("wheelbase", "both")
    wheelbases = sizes(random, levels, 0.01, 0.04) if of_wheelbase else [1.0] * levels
    wheels = sizes(random, levels, 0.001, 0.003) if kind == "wheels" else [1.0] * levels
    noises = sizes(random, levels, 1.0, 3.0) if kind == "noise" else [1.0] * levels
    noises = [abs(noise) + 0.5 for noise in noises] if kind == "noise" else noises
    by_load = log_uniform(random, 0.002, 0.006) if kind == "load" else 0.0
    by_battery = log_uniform(random, 0.0005, 0.001) if kind == "both" else 0.0
    days = 6 if kind == "days" else levels
    by_day = [1 + 0.01 * random.standard_normal() if kind == "days" else 1.0 for _ in range(days)]
    rows: list[Returned] = []
    stated: list[dict[str, str]] = []
    for day in range(days):
        place = day % levels
        for sense in ("cw", "ccw"):
            for _ in range(test.runs if kind != "days" else 3):
                load, battery = float(random.integers(0, 6)), round(random.uniform(22, 26), 1)
                own = floor(
                    robot,
                    wheelbases[place] * by_day[day] * (1 + by_load * load),
                    wheels[place] * (1 + by_battery * (battery - 24)),
                    noises[place],
                )
                row = next(
                    row for row in measured(own, test._replace(runs=1), random) if row[0] == sense
                )
                number = sum(row[0] == sense for row in rows) + 1
                rows.append((sense, number, *row[2:]))
                one = {"run": f"{sense}_{number:02}", "floor": floors[place]}
                one |= {"load_kg": str(load), "battery_v": str(battery)}
                stated.append(one | ({"session": f"day {day + 1}"} if kind == "days" else {}))
    differing = {
        "wheelbase": {("e_b", "floor")},
        "wheels": {("e_d", "floor")},
        "both": {("e_b", "floor"), ("e_d", "battery_v")},
        "load": {("e_b", "load_kg")},
        "days": {("e_b", "session")},
    }.get(kind, set())
    values = {("e_b", "floor", name): value for name, value in zip(floors, wheelbases, strict=True)}
    values |= {("e_d", "floor", name): value**2 for name, value in zip(floors, wheels, strict=True)}
    return World(robot, test, rows, stated, differing, values)


def said(
    kind: str, seed: int, binary: File, verb: str = "conditions"
) -> tuple[World, dict[str, Any]]:
    """A world, and what the command says of it."""
    made = world(kind, seed)
    with TemporaryDirectory() as place:
        folder = File(place) / "data"
        write(folder, made.robot, made.test, made.rows)
        names = list(made.stated[0])
        lines = [",".join(one[name] for name in names) for one in made.stated]
        (folder / "conditions.csv").write_text("\n".join([",".join(names), *lines]) + "\n")
        words = [str(binary), verb, str(folder), "--json", "--threads", "1"]
        answer = subprocess.run(words, capture_output=True, text=True, timeout=300)
    if not answer.stdout:
        raise RuntimeError(f"{kind} {seed}: {answer.stderr}")
    found: dict[str, Any] = json.loads(answer.stdout)
    return made, found


def judged(made: World, found: dict[str, Any]) -> dict[str, int]:
    """Whether what differs was named, whether something else was, and how many intervals hold."""
    differing = [one for one in found["asked"] if one["differs"]]
    named = {(one["key"].split(".")[1], one["condition"]) for one in differing}
    held = asked = 0
    for one in found["asked"]:
        parameter = one["key"].split(".")[1]
        largest = one["largest"]
        if largest is None or one["condition"] != "floor" or not made.values:
            continue
        ends = [(parameter, "floor", largest[side]) for side in ("high", "low")]
        if (parameter, "floor") not in made.differing or len(one["levels"]) > 2:
            continue
        # The true value is that of the first floor times the factor.
        base = made.robot.true_wheelbase_m / made.robot.wheelbase_m
        if parameter == "e_d":
            base = made.robot.true_right_m / made.robot.true_left_m
        truth = base * (made.values[ends[0]] - made.values[ends[1]])
        low, high = largest["by"]["interval"]
        asked, held = asked + 1, held + (low < truth < high)
    return {
        "all named": int(made.differing <= named),
        "something else named": int(bool(named - made.differing)),
        "right": int(named == made.differing),
        "intervals": asked,
        "hold": held,
    }


def of_learnt(made: World, learnt: dict[str, Any]) -> dict[str, int]:
    """What `learn` says of models that do not hold under another level."""
    against = [reason for reason in learnt["reasons"] if reason.startswith("runs of a ")]
    accused = {reason.split()[3] for reason in against}
    differing = {condition for _, condition in made.differing}
    return {
        "explained": int(learnt["verdict"] == "explained"),
        "differing named": int(bool(accused & differing)),
        "something else named": int(bool(accused - differing)),
    }


def main(words: list[str]) -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kinds", nargs="*", default=KINDS)
    parser.add_argument("--sets", type=int, default=100)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--learn", action="store_true", help="ask `learn`, not `conditions`")
    parser.add_argument("--binary", type=File, default=ROOT / "target/release/umbmark")
    chosen = parser.parse_args(words)
    for kind in chosen.kinds:
        counts, failed = Counter[str](), 0

        def one(seed: int, kind: str = kind) -> dict[str, int] | str:
            try:
                if chosen.learn:
                    return of_learnt(*said(kind, seed, chosen.binary, "learn"))
                return judged(*said(kind, seed, chosen.binary))
            except RuntimeError as error:
                return str(error)

        seeds = range(chosen.first_seed, chosen.first_seed + chosen.sets)
        with ThreadPoolExecutor(2) as pool:
            for answer in pool.map(one, seeds):
                if isinstance(answer, str):
                    failed += 1
                    print(answer)
                else:
                    counts.update(answer)
        print(f"{kind}: of {chosen.sets - failed}: {dict(counts)}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
