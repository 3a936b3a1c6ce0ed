"""Worlds whose only reference is a gyro: `gyro.py --sets 40 --binary PATH` prints what is found.

The drives are those of the other worlds. The gyro shows the mean rate since its last reading, with
a rate of its own that is another one in each run and wanders, and noise.
"""

import argparse
import json
import subprocess
import sys
from math import radians
from pathlib import Path as File
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from draw import log_uniform, signed
from files import robot_toml, ticks
from make import make
from plans import Random
from record import Log, Made, stream
from setting import Array

ROOT = File(__file__).resolve().parents[2]
WORLDS = ("null", "perfect", "null", "one_long", "wheelbase_off")
"""Drawn in turn."""


class Gyro(NamedTuple):
    """What a gyro adds to the rate of the robot."""

    own_rad_s: float
    """Its own rate, the same in all runs."""
    run_rad_s: float
    """How that scatters from run to run."""
    walk_rad_s: float
    """How it wanders in a second."""
    noise_rad: float
    """How the heading wanders in a second."""


class Said(NamedTuple):
    """What the command says of a world."""

    verdict: str
    added: list[str]
    off: dict[str, float]
    """E_d and E_b less the truth, in standard errors."""
    off_by: dict[str, float]


def drawn(random: Random) -> Gyro:
    """A gyro between a good and a poor one."""
    return Gyro(
        signed(random, radians(log_uniform(random, 0.05, 2.0))),
        radians(log_uniform(random, 0.005, 0.2)),
        radians(log_uniform(random, 0.0005, 0.01)),
        radians(log_uniform(random, 0.005, 0.1)),
    )


def rates(log: Log, gyro: Gyro, random: Random) -> Array:
    """What the gyro shows at each row: the mean since the row before."""
    heading = np.unwrap(log.body[:, 2])
    step = np.diff(log.stamp_s)
    count = len(step)
    wander = np.cumsum(gyro.walk_rad_s * np.sqrt(step) * random.standard_normal(count))
    own = gyro.own_rad_s + gyro.run_rad_s * random.standard_normal()
    seen = np.diff(heading) / step + own + wander
    seen += gyro.noise_rad * random.standard_normal(count) / np.sqrt(step)
    return np.concatenate([seen[:1], seen])


def write(made: Made, gyro: Gyro, folder: File, random: Random) -> None:
    """Write the folder, without what other references saw."""
    (folder / "runs").mkdir(parents=True, exist_ok=True)
    (folder / "robot.toml").write_text(robot_toml(made.setting))
    for log in made.logs:
        columns = zip(
            log.stamp_s.tolist(),
            *log.counts.T.tolist(),
            rates(log, gyro, random).tolist(),
            strict=True,
        )
        lines = [f"{t:.6f},{ticks(a)},{ticks(b)},{rate:.7f}" for t, a, b, rate in columns]
        text = "\n".join(["t_s,ticks_left,ticks_right,gyro_rad_s", *lines])
        (folder / "runs" / f"{log.name}.csv").write_text(text + "\n")


def world(name: str, seed: int) -> tuple[Made, Gyro, Random]:
    """A world whose counts and gyro are read together, 50 to 100 times a second."""
    random = stream(seed, name, "gyro")
    rate = random.uniform(50, 100)
    settings = [f"tick_rate_hz={rate}", f"reference_rate_hz={rate}", "layout=same"]
    return make(name, seed, settings), drawn(random), random


def learn(binary: File, folder: File) -> dict[str, Any]:
    """What `learn` prints."""
    words = [str(binary), "learn", str(folder), "--json", "--threads", "1"]
    answer = subprocess.run(words, capture_output=True, text=True, timeout=300)
    if not answer.stdout:
        raise RuntimeError(answer.stderr)
    found: dict[str, Any] = json.loads(answer.stdout)
    return found


def said(answer: dict[str, Any], made: Made) -> Said:
    """The answer against the truth, where it was fitted: headings show E_b for E_s = 1."""
    robot = made.setting.robot
    true = {"e_d": robot.e_d, "e_b": robot.e_b / robot.e_s}
    fitted = {one["parameter"]: one for one in answer["fitted"]}
    by = {name: fitted[name]["value"] - value for name, value in true.items() if name in fitted}
    off = {name: by[name] / fitted[name]["standard_error"] for name in by}
    added = [step["added"] for step in answer["steps"][1:]]
    return Said(answer["verdict"], added, off, by)


def found(name: str, seed: int, binary: File) -> Said:
    """What the command finds in a world."""
    made, gyro, random = world(name, seed)
    with TemporaryDirectory() as place:
        write(made, gyro, File(place), random)
        return said(learn(binary, File(place)), made)


def main(words: list[str]) -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=12)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--binary", type=File, default=ROOT / "target/release/umbmark")
    chosen = parser.parse_args(words)
    squares: dict[str, list[float]] = {"e_d": [], "e_b": []}
    for k in range(chosen.sets):
        name, seed = WORLDS[k % len(WORLDS)], chosen.first_seed + k
        one = found(name, seed, chosen.binary)
        off = ", ".join(
            f"{number} {100 * one.off_by[number]:+.3f} % ({value:+.1f})"
            for number, value in one.off.items()
        )
        print(f"{name:10} {seed} {one.verdict:16} {off} {' '.join(one.added)}", flush=True)
        for number, value in one.off.items():
            squares[number].append(value**2)
    print({number: round(float(np.mean(of)) ** 0.5, 2) for number, of in squares.items() if of})


if __name__ == "__main__":
    main(sys.argv[1:])
