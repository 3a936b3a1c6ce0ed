"""Sets of drives, each in two parts: to learn from, and to judge on."""

import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from command import Command

ROOT = Path(__file__).resolve().parents[3]
WORLDS = ROOT / "tests" / "worlds"
OPTIODOM = ROOT.parent / "shared" / "data" / "optiodom" / "raw"
LEFT_OUT = 0.25
"""Share of the runs of a made set that are judged on."""
ROBOT = """[robot]
drive = "differential"
wheelbase_m = 0.2
wheel_diameter_m = 0.084
ticks_per_revolution = 2796.8
"""
"""OptiOdom's robot, whatever its controller was told."""
MARKERS = ("marker_offset", "marker_yaw")
"""Markers on top of a robot are not exactly above the middle of its axle."""
DAYS = {"June": "0620", "December": "1220"}
"""How the names of the sets of OptiOdom of each month have their month and year."""


@dataclass(frozen=True)
class Split:
    """A set."""

    name: str
    train: Path
    """Folder to learn from."""
    test: Path
    """Folder of the runs that are judged."""
    made: Path | None = None
    """The folder that was made, with truth.json."""
    fitted: tuple[str, ...] = ()
    """Effects of the reference that are fitted besides E_d, E_b and E_s, for all methods."""


def names_in(folder: Path) -> list[str]:
    """The names of the runs of a dataset."""
    return sorted(file.stem for file in (folder / "runs").glob("*.csv"))


def made(world: str, seed: int, folder: Path) -> Split:
    """A set of a world; some runs that the seed draws are left out, of each sense alike."""
    name = f"{world}-{seed}"
    whole = folder / name / "whole"
    make = [sys.executable, str(WORLDS / "make.py"), world, "--seed", str(seed)]
    subprocess.run([*make, "--out", str(whole)], check=True)
    names = names_in(whole)
    random = np.random.default_rng(seed)
    count = max(2, round(LEFT_OUT * len(names)))
    drawn = random.permutation(names).tolist()
    by_sense = [[one for one in drawn if one.startswith(sense)] for sense in ("ccw", "cw", "run")]
    judged = sorted(in_turn(by_sense)[:count])
    learnt = [one for one in names if one not in judged]
    train = part(whole, learnt, folder / name / "train")
    test = part(whole, judged, folder / name / "test")
    return Split(name, train, test, whole)


def in_turn(groups: list[list[str]]) -> list[str]:
    """The first of each group, the second of each, and so on."""
    longest = max(map(len, groups))
    return [group[place] for place in range(longest) for group in groups if place < len(group)]


def part(whole: Path, names: list[str], out: Path) -> Path:
    """A dataset of some runs of another one."""
    shutil.rmtree(out, ignore_errors=True)
    (out / "runs").mkdir(parents=True)
    shutil.copy(whole / "robot.toml", out / "robot.toml")
    for name in names:
        shutil.copy(whole / "runs" / f"{name}.csv", out / "runs")
    return out


def optiodom(command: Command, folder: Path) -> Iterator[Split]:
    """Learn from all squares of a month; judge on its circles, and on its straights and spins."""
    for month, digits in DAYS.items():
        squares = gathered(command, folder, "square", digits)
        for kind, name in (("circular", "circles"), ("ivanjko", "straights and spins")):
            others = gathered(command, folder, kind, digits)
            yield Split(f"OptiOdom, {month}: {name}", squares, others, fitted=MARKERS)


def gathered(command: Command, folder: Path, kind: str, digits: str) -> Path:
    """All sets of a kind and a month as one dataset."""
    out = folder / f"{kind}-{digits}"
    shutil.rmtree(out, ignore_errors=True)
    (out / "runs").mkdir(parents=True)
    (out / "robot.toml").write_text(ROBOT)
    for source in sorted((OPTIODOM / kind).glob(f"??{digits}*")):
        with_names = folder / "converted" / source.name
        with_names.parent.mkdir(exist_ok=True)
        shutil.rmtree(with_names, ignore_errors=True)
        command.convert(source, with_names)
        for file in sorted((with_names / "runs").glob("*.csv")):
            sense = file.stem.partition("_")[0]
            number = len(list((out / "runs").glob(f"{sense}_*"))) + 1
            shutil.copy(file, out / "runs" / f"{sense}_{number:02}.csv")
    return out
