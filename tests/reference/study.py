"""What `umbmark learn` finds on tracks: every hidden case, and sets with nothing hidden.

Makes the data, runs the command on each set as a user would, holds its answer against the sealed
one and prints the tables of docs/studies/tracks.md:
`python tests/reference/study.py --seeds 7 8 --nulls 500`.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path as File
from typing import Any, TypeVar

from cases import CASES, DRAWN, RETURNS, UNLISTED
from generate import main as generate
from measure import NOISE_MODELS

One = TypeVar("One")
ROOT = File(__file__).parents[2]
COMMANDS = [ROOT / "target" / build / "umbmark" for build in ("release", "debug")]
ADDED = ("physics", "nuisance")
"""Kinds of causes that a finder adds to the model."""
FITTED = {"wheel_diameter_ratio", "wheelbase", "scale", "start_pose"}
"""What every fit has: what looks like it need not be added."""
FIRST_NULL = 1001
FIRST_DRAWN = 5001


@dataclass
class Answer:
    """What was learnt of one set, beside what is in it."""

    case: str
    seed: int
    verdict: str
    classes: list[set[str]]
    hidden: list[set[str]]
    before_m: float
    after_m: float
    outliers: int
    repeats: bool
    """Whether pairs of runs show something of what is left to be the same in every run."""

    @property
    def right(self) -> bool:
        """Whether each cause is in a class that was added, and nothing else was."""
        return self.found and not self.besides

    @property
    def besides(self) -> bool:
        """Whether something besides the causes was added."""
        return any(
            not any(one & acceptable for acceptable in self.hidden) for one in self.classes
        ) or len(self.classes) > len(self.hidden)

    @property
    def found(self) -> bool:
        """Whether each cause is in a class that was added."""
        return all(
            acceptable & FITTED or any(one & acceptable for one in self.classes)
            for acceptable in self.hidden
        )

    @property
    def asked(self) -> bool:
        """Whether something is hidden that no fit has, or something like it was added."""
        return any(not acceptable & FITTED for acceptable in self.hidden) or (
            bool(self.hidden) and self.right and bool(self.classes)
        )


def learn(command: File, case: str, seed: int, noise: str = "gaussian") -> Answer:
    """Make one set and learn from it."""
    with tempfile.TemporaryDirectory() as place:
        folder = File(place) / "data"
        generate([case, str(folder), "--seed", str(seed), "--noise", noise])
        words = [str(command), "learn", str(folder), "--json", "--threads", "1"]
        done = subprocess.run(words, capture_output=True, check=True, text=True)
        sealed = json.loads(folder.with_name("data.truth.json").read_text())
    answer: dict[str, Any] = json.loads(done.stdout)
    steps = answer["steps"]
    added = [step for step in steps if step["p_adjusted"] is not None]
    repeats = [answer["remains"][key] for key in ("repeats_m", "repeats_rad")]
    begun = [step for step in steps if step["p_adjusted"] is None]
    causes = [set(one["acceptable"]) for one in sealed["causes"] if one["kind"] in ADDED]
    return Answer(
        case,
        seed,
        answer["verdict"],
        [set(step["class"]) for step in added],
        causes,
        begun[-1]["heldout_rmse_m"],
        steps[-1]["heldout_rmse_m"],
        len(answer.get("outliers", [])),
        any(one and (one["low"] or 0) > 0 for one in repeats),
    )


def each_of(ask: Callable[[One], Answer], work: Sequence[One], threads: int) -> Iterator[Answer]:
    """The answers in order, each as soon as it is there; how far it is on stderr."""
    with ThreadPoolExecutor(threads) as pool:
        for done, answer in enumerate(pool.map(ask, work), start=1):
            print(f"\r{done} of {len(work)} ", end="", file=sys.stderr, flush=True)
            yield answer
    print(file=sys.stderr)


def hidden(command: File, seeds: list[int], threads: int) -> Iterator[str]:
    """A line for each case and seed, and what they come to."""
    names = [name for name in CASES if name not in RETURNS]
    work = [(name, seed) for name in names for seed in seeds]
    yield "| case | seed | added | verdict | left out [mm] | |\n|---|---|---|---|---|---|"
    answers: list[Answer] = []
    for answer in each_of(lambda one: learn(command, *one), work, threads):
        answers.append(answer)
        classes = ", ".join(" or ".join(sorted(one)) for one in answer.classes) or "nothing"
        if answer.case in UNLISTED:
            judged = "unlisted" if answer.verdict == "unlisted_effect" else "not called unlisted"
        else:
            judged = "right" if answer.right else "found, and more" if answer.found else "not found"
        yield (
            f"| {answer.case} | {answer.seed} | {classes} | {answer.verdict} "
            f"| {1e3 * answer.before_m:.1f} to {1e3 * answer.after_m:.1f} | {judged} |"
        )
    with_cause = [one for one in answers if one.asked and one.case not in UNLISTED]
    without = [one for one in answers if not one.asked and one.case not in UNLISTED]
    outside = [one for one in answers if one.case in UNLISTED]
    certified = [one for one in with_cause if one.classes]
    yield (
        f"\nhidden: {sum(one.found for one in with_cause)} of {len(with_cause)} found; of "
        f"{len(certified)} where something was added, the right class in "
        f"{sum(one.found for one in certified)}, and nothing else in "
        f"{sum(one.right for one in certified)}\n"
        f"nothing hidden: something added in {sum(bool(one.classes) for one in without)} of "
        f"{len(without)}\n"
        f"outside the catalogue: called unlisted in "
        f"{sum(one.verdict == 'unlisted_effect' for one in outside)} of {len(outside)}"
    )


def drawn(command: File, sets: int, threads: int) -> Iterator[str]:
    """A line for each set of one to three causes drawn at random in which not just these are found,
    and what all come to by the number of causes.
    """
    seeds = range(FIRST_DRAWN, FIRST_DRAWN + sets)
    yield "| seed | hidden | added | verdict | left out [mm] |\n|---|---|---|---|---|"
    answers: list[Answer] = []
    for one in each_of(partial(learn, command, DRAWN), seeds, threads):
        answers.append(one)
        if not one.right:
            hidden = ", ".join(" or ".join(sorted(names)) for names in one.hidden)
            classes = ", ".join(" or ".join(sorted(names)) for names in one.classes) or "nothing"
            yield (
                f"| {one.seed} | {hidden} | {classes} | {one.verdict} "
                f"| {1e3 * one.before_m:.1f} to {1e3 * one.after_m:.1f} |"
            )
    yield "\n| causes | sets | all found | something besides |\n|---|---|---|---|"
    for count in sorted({len(one.hidden) for one in answers}):
        own = [one for one in answers if len(one.hidden) == count]
        found, besides = sum(one.found for one in own), sum(one.besides for one in own)
        yield f"| {count} | {len(own)} | {found} | {besides} |"


def nulls(command: File, sets: int, threads: int) -> Iterator[str]:
    """A line for each model of the noise, of so many sets in all, and one for each addition."""
    yield "| noise | sets | something added | called unlisted | an outlier named | said to repeat |"
    yield "|---|---|---|---|---|---|"
    added: list[tuple[str, Answer]] = []
    for index, noise in enumerate(NOISE_MODELS):
        each = sets // len(NOISE_MODELS) + (index < sets % len(NOISE_MODELS))
        seeds = range(FIRST_NULL, FIRST_NULL + each)
        answers = list(each_of(partial(learn, command, "none", noise=noise), seeds, threads))
        yield (
            f"| {noise} | {each} | {sum(bool(one.classes) for one in answers)} "
            f"| {sum(one.verdict == 'unlisted_effect' for one in answers)} "
            f"| {sum(one.outliers > 0 for one in answers)} "
            f"| {sum(one.repeats for one in answers)} |"
        )
        added.extend((noise, one) for one in answers if one.classes)
    if added:
        yield "\n| noise | seed | added | left out [mm] |\n|---|---|---|---|"
    for noise, one in added:
        classes = ", ".join(" or ".join(sorted(names)) for names in one.classes)
        yield (
            f"| {noise} | {one.seed} | {classes} "
            f"| {1e3 * one.before_m:.1f} to {1e3 * one.after_m:.1f} |"
        )


def main() -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, nargs="*", default=[7], help="of the hidden cases")
    parser.add_argument("--nulls", type=int, default=500, metavar="N", help="sets in all")
    parser.add_argument("--drawn", type=int, default=0, metavar="N", help="sets of drawn causes")
    parser.add_argument("--command", type=File, help="the umbmark to ask")
    parser.add_argument("--threads", type=int, default=2)
    chosen = parser.parse_args()
    command = chosen.command or next((one for one in COMMANDS if one.exists()), None)
    if command is None:
        sys.exit("the command is not built: cargo build --release")
    if chosen.seeds:
        for line in hidden(command, chosen.seeds, chosen.threads):
            print(line, flush=True)
    if chosen.drawn:
        for line in drawn(command, chosen.drawn, chosen.threads):
            print(line, flush=True)
    if chosen.nulls:
        for line in nulls(command, chosen.nulls, chosen.threads):
            print(line, flush=True)


if __name__ == "__main__":
    main()
