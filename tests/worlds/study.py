"""Run the command on worlds and hold its answers against the truth.

`study.py --sets 10 --jobs 2` makes ten sets of each world, `study.py null jumps` of these two.
Writes one JSON line a set and prints a table. `study.py --table` prints it again, `study.py
--worst` the sets that went wrong, each with the command that makes it again; both judge anew what
was written down.
"""

import argparse
import hashlib
import json
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path as File

import tables
from files import write
from judge import Json
from make import make
from replay import left, read_truth, rms_m
from worlds import WORLDS

ROOT = File(__file__).parents[2]
TIMEOUT_S = 120.0
KEPT_OF_STDERR = 4000


@dataclass(frozen=True)
class Task:
    """One set."""

    world: str
    seed: int
    overrides: tuple[str, ...]
    binary: File
    keep: File | None
    timeout_s: float

    @property
    def name(self) -> str:
        """Of the folder."""
        return f"{self.world}-{self.seed}"

    @property
    def made_by(self) -> str:
        """The command that makes the set again."""
        changes = "".join(f" --set {word}" for word in self.overrides)
        words = f"{self.world} --seed {self.seed}{changes} --out {self.name}"
        return f"python tests/worlds/make.py {words}"


def ask(task: Task, *verb: str) -> Json:
    """Run the command once: exit code (none after the timeout), answer, messages, seconds."""
    words = [str(task.binary), *verb, "--json", "--quiet", "--threads", "1"]
    began = time.monotonic()
    try:
        done = subprocess.run(
            words, capture_output=True, text=True, timeout=task.timeout_s, check=False
        )
    except subprocess.TimeoutExpired:
        return {"exit": None, "answer": None, "stderr": "", "seconds": task.timeout_s}
    try:
        answer = json.loads(done.stdout)
    except json.JSONDecodeError:
        answer = None
    return {
        "exit": done.returncode,
        "answer": answer,
        "stderr": done.stderr[-KEPT_OF_STDERR:],
        "seconds": time.monotonic() - began,
    }


def answers_of(task: Task, folder: File, model: File) -> dict[str, Json]:
    """What all verbs say of a set."""
    data = str(folder)
    answers = {
        "inspect": ask(task, "inspect", data),
        "learn": ask(task, "learn", data, "-o", str(model), "--force"),
        "diagnose": ask(task, "diagnose", data, "--check"),
        "fit": ask(task, "fit", data),
    }
    if model.exists():
        answers["compare"] = ask(task, "compare", data, "--model", str(model))
    return answers


KEPT = {
    "inspect": ("warnings", "checks", "determined", "setup"),
    "learn": (),
    "diagnose": ("verdict", "certified", "remarks", "reasons", "outliers"),
    "fit": ("fitted", "not_shown", "outliers"),
    "compare": ("models", "remarks"),
}
"""Keys of each answer that are written down; all where none is named."""


def shortened(verb: str, answered: Json) -> Json:
    """An answer with the keys that are kept."""
    whole = answered["answer"]
    answer = whole
    if answer and KEPT[verb]:
        answer = {key: answer.get(key) for key in KEPT[verb]}
    if verb == "inspect" and whole and whole.get("logs"):
        answer["first_log"] = whole["logs"][0]["name"]
    if verb == "compare" and answer:
        kept = ("name", "explains", "p", "along", "end")
        answer["models"] = [{key: one[key] for key in kept} for one in answer["models"]]
    return answered | {"answer": answer}


def study(task: Task) -> Json:
    """Make one set and ask the command."""
    with tempfile.TemporaryDirectory() as place:
        # The command must not read the answer in the name of the folder.
        folder = File(place) / "data"
        write(make(task.world, task.seed, list(task.overrides)), folder)
        answers = answers_of(task, folder, File(place) / "model.toml")
        truth = read_truth(folder)
        best = rms_m(left(folder))
        if task.keep:
            shutil.copytree(folder, task.keep / task.name, dirs_exist_ok=True)
    return {
        "world": task.world,
        "seed": task.seed,
        "made_by": task.made_by,
        "truth": truth,
        "truth_leaves_m": best,
        "answers": {verb: shortened(verb, answered) for verb, answered in answers.items()},
    }


def studied(tasks: list[Task], jobs: int) -> Iterator[Json]:
    """The results of all sets as they come."""
    with ProcessPoolExecutor(jobs) as pool:
        pending = {pool.submit(study, task): task for task in tasks}
        for done in as_completed(pending):
            try:
                yield done.result()
            except Exception as error:
                # One set that cannot be made or judged must not cost the results of the others.
                print(f"{pending[done].name}: {error!r}", file=sys.stderr)


def arguments(words: list[str]) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("worlds", nargs="*", metavar="WORLD", help="all where none is given")
    parser.add_argument("--sets", type=int, default=10, help="of each world")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--binary", type=File, default=ROOT / "target" / "release" / "umbmark")
    parser.add_argument("--keep", type=File, metavar="DIR", help="keep the sets in this folder")
    parser.add_argument("--set", action="append", default=[], metavar="key=value")
    parser.add_argument("--timeout", type=float, default=TIMEOUT_S, help="of one command [s]")
    parser.add_argument(
        "--results",
        type=File,
        default=ROOT / "target" / "worlds" / "results.jsonl",
        help="one JSON line a set",
    )
    parser.add_argument("--append", action="store_true", help="add to the results that are there")
    parser.add_argument("--worst", action="store_true", help="print what went wrong before")
    parser.add_argument("--table", action="store_true", help="print the table of results again")
    parser.add_argument(
        "--by",
        default="world",
        metavar="KEY",
        help="a row for each value of a number of truth.json, as start, kind, layout, controller",
    )
    chosen = parser.parse_args(words)
    unknown = [name for name in chosen.worlds if name not in WORLDS]
    if unknown:
        parser.error(f"no world is called {unknown[0]}; make.py --list names them")
    return chosen


def tasks_of(chosen: argparse.Namespace) -> list[Task]:
    """All sets of a study, each seed of all worlds before the next one."""
    seeds = range(chosen.first_seed, chosen.first_seed + chosen.sets)
    return [
        Task(world, seed, tuple(chosen.set), chosen.binary, chosen.keep, chosen.timeout)
        for seed in seeds
        for world in chosen.worlds or WORLDS
    ]


def read_results(file: File, worlds: list[str]) -> list[Json]:
    """The last result of each set, of some worlds or all, with what is to be said of it."""
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    last = {(line["world"], line["seed"]): line for line in lines}
    chosen = [line for line in last.values() if not worlds or line["world"] in worlds]
    return [tables.with_judgement(line) for line in chosen]


def run(chosen: argparse.Namespace) -> None:
    """Do the study."""
    if not chosen.binary.exists():
        sys.exit(f"{chosen.binary} is not there: cargo build --release, or say --binary")
    digest = hashlib.sha256(chosen.binary.read_bytes()).hexdigest()[:12]
    chosen.results.parent.mkdir(parents=True, exist_ok=True)
    with chosen.results.open("a" if chosen.append else "w") as file:
        for result in studied(tasks_of(chosen), chosen.jobs):
            print(json.dumps(result | {"binary": digest}), file=file, flush=True)
            print(tables.one_line(tables.with_judgement(result)), file=sys.stderr, flush=True)


def main(words: list[str]) -> None:
    """Do what the command line says."""
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    chosen = arguments(words)
    if not (chosen.worst or chosen.table):
        run(chosen)
    results = read_results(chosen.results, chosen.worlds)
    if chosen.worst:
        lines = [*tables.worst(results)]
    else:
        lines = [*tables.table(results, chosen.by), *tables.laws(results)]
    print("\n".join(lines))


if __name__ == "__main__":
    main(sys.argv[1:])
