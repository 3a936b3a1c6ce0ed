"""How often the intervals of `umbmark solve` hold the true numbers of the robot, on tracks.

Makes the data, runs the command on each set as a user would, and holds each new number against the
sealed truth: `python tests/reference/answers.py --seeds 7 8 9`.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path as File
from typing import Any

from cases import CASES, RETURNS, UNLISTED
from generate import main as generate
from study import COMMANDS

ACTS_LIKE_WHEELS = {"wheel_diameter_ratio", "wheelbase", "scale", "turn_slip"}
"""Cases whose cause is one of the three, or is the same as another value of it on every path."""


@dataclass
class Answer:
    """The numbers of one set beside the true ones."""

    case: str
    seed: int
    verdict: str
    trusted: bool
    off_m: float
    remains_m: float
    held: dict[str, bool]
    deviations: dict[str, float]
    """Distance of each new number from the true one, in halves of its interval."""


def true_lengths(robot: dict[str, float], e_d: float, e_b: float, e_s: float) -> dict[str, float]:
    """Give the true lengths of a robot by the definitions of E_d, E_b and E_s."""
    left = robot["wheel_diameter_m"] * e_s * 2.0 / (1.0 + e_d)
    return {
        "wheelbase_m": robot["wheelbase_m"] * e_b,
        "wheel_diameter_left_m": left,
        "wheel_diameter_right_m": left * e_d,
    }


def answer(command: File, case: str, seed: int) -> Answer:
    """Make one set and ask for its numbers."""
    with tempfile.TemporaryDirectory() as place:
        folder = File(place) / "data"
        generate([case, str(folder), "--seed", str(seed)])
        words = [str(command), "solve", str(folder), "--json", "--threads", "1"]
        done = subprocess.run(words, capture_output=True, check=True, text=True)
        sealed = json.loads(folder.with_name("data.truth.json").read_text())
    found: dict[str, Any] = json.loads(done.stdout)
    base = sealed["base"]
    if "scale" in found["not_shown"]:
        # Lengths are then told as if the mean wheel diameter were right.
        base = {"e_d": base["e_d"], "e_b": base["e_b"] / base["e_s"], "e_s": 1.0}
    truth = true_lengths({"wheelbase_m": 0.34, "wheel_diameter_m": 0.15}, **base)
    held, deviations = {}, {}
    for key, true in truth.items():
        given = found["correction"].get(key)
        if given is None or given["low"] is None:
            continue
        held[key] = given["low"] <= true <= given["high"]
        deviations[key] = (given["new"] - true) / (0.5 * (given["high"] - given["low"]))
    off = found["off"] or {"driven_m": float("nan")}
    remains = found["remains_m"] if found["remains_m"] is not None else float("nan")
    verdict, trusted = found["verdict"], found["trusted"]
    return Answer(case, seed, verdict, trusted, off["driven_m"], remains, held, deviations)


def table(command: File, seeds: list[int], threads: int, names: list[str]) -> Iterator[str]:
    """A line for each set with a miss, and what all come to."""
    work = [(name, seed) for name in names for seed in seeds]
    answers: list[Answer] = []
    yield "| case | seed | verdict | misses, in halves of the interval |\n|---|---|---|---|"
    with ThreadPoolExecutor(threads) as pool:
        for one in pool.map(lambda pair: answer(command, *pair), work):
            answers.append(one)
            missed = [key for key, holds in one.held.items() if not holds]
            if missed:
                told = ", ".join(f"{key} {one.deviations[key]:+.2f}" for key in missed)
                mark = "" if one.trusted else " (not to be written)"
                yield f"| {one.case} | {one.seed} | {one.verdict}{mark} | {told} |"
    for what, chosen in (
        ("all", answers),
        ("to be written", [one for one in answers if one.trusted]),
    ):
        held = [holds for one in chosen for holds in one.held.values()]
        yield f"\n{what}: {sum(held)} of {len(held)} intervals of {len(chosen)} sets hold the truth"


def main() -> None:
    """Ask, and print."""
    parse = argparse.ArgumentParser(description=__doc__)
    parse.add_argument("--seeds", type=int, nargs="+", default=[7, 8, 9])
    parse.add_argument("--threads", type=int, default=2)
    parse.add_argument("--command", type=File, help="the command [default: the one in target]")
    parse.add_argument("--cases", nargs="+", help="only these cases")
    given = parse.parse_args()
    command = given.command or next((one for one in COMMANDS if one.exists()), None)
    if command is None:
        sys.exit("no command: cargo build --release")
    outside = {*ACTS_LIKE_WHEELS, *RETURNS, *UNLISTED}
    names = given.cases or [name for name in CASES if name not in outside]
    for line in partial(table, command, given.seeds, given.threads)(names):
        print(line, flush=True)


if __name__ == "__main__":
    main()
