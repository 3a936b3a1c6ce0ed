"""Make recorded drives of a robot with known errors: `make.py WORLD --seed N --out DIR`."""

import argparse
import sys
from pathlib import Path as File

import unlisted
from files import write
from record import Made, driven, setting_of
from worlds import WORLDS


def make(world: str, seed: int, overrides: list[str] | None = None) -> Made:
    """Make a world from its name and seed, with a law that shows where it hides one."""
    setting = setting_of(world, seed, overrides or [])
    if WORLDS[world].hides_law:
        return unlisted.with_law(world, seed, setting, overrides or [])
    return driven(world, seed, setting)


def arguments(words: list[str]) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("world", nargs="?", metavar="WORLD", help="a name of --list")
    parser.add_argument("--list", action="store_true", help="list the worlds")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=File, metavar="DIR", help="the folder to write")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="key=value",
        help="a number of its own in place of the drawn one, by its name in truth.json; repeatable",
    )
    chosen = parser.parse_args(words)
    if not chosen.list and (chosen.world not in WORLDS or chosen.out is None):
        parser.error("it needs a WORLD of --list, and --out DIR")
    return chosen


def main(words: list[str]) -> None:
    """Do what the command line says."""
    chosen = arguments(words)
    if chosen.list:
        for world in WORLDS.values():
            print(f"{world.name:20} {world.says}")
        return
    try:
        made = make(chosen.world, chosen.seed, chosen.set)
    except ValueError as error:
        sys.exit(f"make.py: {error}")
    write(made, chosen.out)


if __name__ == "__main__":
    main(sys.argv[1:])
