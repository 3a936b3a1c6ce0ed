"""Fleets of robots of one kind, tested by tape, whose spread is known.

`fleets.py --sets 200 --binary PATH` prints how often `umbmark survey` names a robot that is odd or
one that is not, and how often its intervals hold the true mean and spread.
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
from pairs import drawn, measured, write
from record import stream
from study import ROOT

KINDS = ("alike", "spread", "few", "uneven", "odd")
"""All robots are the same; they differ; a few that differ; some are tested less; one is odd."""


class Fleet(NamedTuple):
    """What is true of a fleet."""

    means: tuple[float, float]
    """Of E_d and E_b."""
    spreads: tuple[float, float]
    odd: str | None
    """The robot that is not like the others."""


def make(kind: str, seed: int, folder: File) -> Fleet:
    """Write the datasets of a fleet into a folder."""
    random = stream(seed, kind, "fleets")
    robot, test = drawn(random)
    robots = int(random.integers(6, 13) if kind == "few" else random.integers(20, 41))
    means = (1 + random.normal(0, 0.003), 1 + random.normal(0, 0.02))
    spreads = (0.0, 0.0)
    if kind != "alike":
        spreads = (log_uniform(random, 2e-4, 3e-3), log_uniform(random, 2e-3, 2e-2))
    odd = f"robot_{int(random.integers(robots)):02}" if kind == "odd" else None
    for place in range(robots):
        name = f"robot_{place:02}"
        e_d, e_b = (m + s * random.standard_normal() for m, s in zip(means, spreads, strict=True))
        if name == odd:
            e_b = means[1] + max(12 * spreads[1], 0.05)
        own = robot._replace(
            true_left_m=robot.diameter_m * 2 / (1 + e_d),
            true_right_m=robot.diameter_m * 2 * e_d / (1 + e_d),
            true_wheelbase_m=e_b * robot.wheelbase_m,
        )
        runs = int(random.integers(3, 9)) if kind == "uneven" else test.runs
        tested = test._replace(runs=runs)
        write(folder / name, own, tested, measured(own, tested, random))
    return Fleet(means, spreads, odd)


def said(kind: str, seed: int, binary: File) -> tuple[Fleet, dict[str, Any]]:
    """A fleet, and what the command says of it."""
    with TemporaryDirectory() as place:
        fleet = make(kind, seed, File(place) / "fleet")
        words = [str(binary), "survey", f"{place}/fleet", "--no-diagnosis", "--json"]
        answer = subprocess.run(words, capture_output=True, text=True, timeout=300)
    if not answer.stdout:
        raise RuntimeError(f"{kind} {seed}: {answer.stderr}")
    found: dict[str, Any] = json.loads(answer.stdout)
    return fleet, found


def judged(fleet: Fleet, found: dict[str, Any]) -> dict[str, int]:
    """How an answer stands to the truth."""
    named = {one["robot"] for one in found["robots"] if one["stands_out"]}
    counts = {"odd named": int(fleet.odd in named), "another named": int(bool(named - {fleet.odd}))}
    for one in found["among"]:
        which = 0 if one["key"].endswith("e_d") else 1
        low, high = one["interval"]
        least, most = one["sd_between_interval"]
        counts[f"{one['key']}: mean holds"] = int(low < fleet.means[which] < high)
        held = (least or 0) <= fleet.spreads[which] and (
            most is None or fleet.spreads[which] <= most
        )
        counts[f"{one['key']}: spread holds"] = int(held)
    return counts


def main(words: list[str]) -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kinds", nargs="*", default=KINDS)
    parser.add_argument("--sets", type=int, default=100)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--binary", type=File, default=ROOT / "target/release/umbmark")
    chosen = parser.parse_args(words)
    for kind in chosen.kinds:

        def one(seed: int, kind: str = kind) -> dict[str, int]:
            return judged(*said(kind, seed, chosen.binary))

        counts = Counter[str]()
        with ThreadPoolExecutor(2) as pool:
            for answer in pool.map(one, range(chosen.first_seed, chosen.first_seed + chosen.sets)):
                counts.update(answer)
        print(f"{kind}: of {chosen.sets}: {dict(counts)}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
