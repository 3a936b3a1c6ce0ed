"""All methods on all sets; one JSON line a set, and the table at last. Started by `run.py`."""

import argparse
import json
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from types import ModuleType
from typing import Any, TypeAlias

import gaussian_process
import sets
import sparse
import symbolic
from command import Command
from drives import Robot, Run, read_run, read_runs
from error import PoseNoise, Prediction, rms_m
from increments import blocks_of, increments_of
from learnt import law_of
from predicted import Fitted, Law, driven
from table import table
from truth import ALWAYS, Truth

Json: TypeAlias = dict[str, Any]

PEERS: dict[str, ModuleType] = {
    "Gaussian process": gaussian_process,
    "sparse regression": sparse,
    "symbolic regression": symbolic,
}
AGREES = 0.02
"""Our replay of the fitted robot has the error that `umbmark compare` says, within this share."""


def say(text: str) -> None:
    """Tell the user, apart from the table."""
    print(text, file=sys.stderr, flush=True)


def predicts(fitted: Fitted, law: Law | None) -> Prediction:
    """Poses by ticks, with a law or without."""

    def prediction(run: Run) -> Any:
        start = run.at_start
        start[2] -= fitted.yaw
        return fitted.shown(run, driven(run, fitted, start, law))

    return prediction


def by_command(command: Command, split: sets.Split, first: str, model: Path, folder: Path) -> float:
    """The error of a model along the judged runs by `umbmark compare` alone [m].

    Formulas have their origin at START of the first run that was learnt from: it goes along, and
    its own error is taken out again. The command lists clockwise runs first.
    """
    robot = Robot.read(split.train)
    log = (split.train / "runs" / f"{first}.csv").read_text()
    counts, errors = [], []
    for kind, names in (("first", []), ("both", sets.names_in(split.test))):
        part = sets.part(split.test, names, folder / split.name / kind)
        (part / "runs" / "cw_00.csv").write_text(log)
        runs = [read_run(file, robot) for file in (part / "runs").glob("*.csv")]
        counts.append(sum(len(blocks_of(run, robot.wheelbase_m)) - 1 for run in runs))
        errors.append(compared_m(command, part, model))
    rest = counts[1] * errors[1] ** 2 - counts[0] * errors[0] ** 2
    return float((max(rest, 0.0) / (counts[1] - counts[0])) ** 0.5)


def compared_m(command: Command, folder: Path, model: Path) -> float:
    """The error along all runs that `umbmark compare` says [m]."""
    [answer] = command.compare(folder, [model])["models"]
    return float(answer["along"]["rmse_m"])


def studied(split: sets.Split, command: Command, folder: Path) -> Json:
    """All methods on one set."""
    truth = Truth(split) if split.made else None
    fit, learnt = folder / "fit.toml", folder / "learnt.toml"
    command.fit(split.train, fit, split.fitted)
    answer, seconds = command.learn(split.train, learnt)
    robot = Robot.read(split.train)
    fitted = Fitted.read(robot, fit)
    inspected = command.inspect(split.train)
    noise = noise_of(inspected)
    runs = read_runs(split.train, inspected["logs"], robot)
    others = command.inspect(split.test)["logs"]
    judged = read_runs(split.test, others, robot, first=runs[0])
    data = increments_of(runs, fitted)

    def error(model: Fitted, law: Law | None) -> float:
        return rms_m(judged, predicts(model, law), noise, fitted)

    errors = {"E_d, E_b, E_s": error(fitted, None)}
    result: Json = {"set": split.name, "steps": len(data.run)}
    result |= checked(errors["E_d, E_b, E_s"], command.compare(split.test, [fit]), split.name)
    result["model"] = learnt.read_text()
    own = law_of(robot, learnt)
    if own:
        errors["umbmark"] = error(Fitted.read(robot, learnt), own)
    else:
        errors["umbmark"] = by_command(command, split, runs[0].name, learnt, folder)
    terms = {"umbmark": truth.wrong(answer) if truth and not truth.law else added(answer)}
    found, took = {}, {"umbmark": seconds}
    if truth:
        errors["truth"] = rms_m(judged, truth.shown, noise, fitted)
        result["law"] = truth.law
    if truth and truth.law:
        asked = {"learn": {"answer": answer}, "inspect": {"answer": inspected}}
        result["named"] = truth.named(asked)
        found["umbmark"] = result["named"] != "no"
    for name, peer in PEERS.items():
        begin = time.perf_counter()
        law = peer.learn(data)
        took[name] = time.perf_counter() - begin
        errors[name] = error(fitted, law)
        terms[name] = law.terms
        if truth and truth.law:
            found[name] = truth.is_found(law, data)
    return result | {
        "verdict": answer.get("verdict"),
        "error_m": errors,
        "terms": terms,
        "found": found,
        "seconds": took,
    }


def checked(ours_m: float, answer: Json, name: str) -> Json:
    """Hold our replay of the fitted robot against `umbmark compare`, but for tracks that jump."""
    ratio = ours_m / answer["models"][0]["along"]["rmse_m"]
    jumps = len(answer["setup"]["jumps"])
    if abs(ratio - 1) > AGREES:
        why = f"; it starts anew at {jumps} jumps" if jumps else ""
        say(f"{name}: our replay has {ratio:.3f} times the error of umbmark compare{why}")
    return {"replay_over_compare": ratio, "jumps": jumps}


def added(answer: Json) -> list[str]:
    """The steps of `umbmark learn` beyond E_d, E_b and E_s."""
    steps = [step["added"] for step in answer["steps"]]
    return [name for name in steps if name and name not in ALWAYS]


def noise_of(inspected: Json) -> PoseNoise:
    """The noise of single poses, by `umbmark inspect`."""
    references = [log["reference"] for log in inspected["logs"]]

    def of(key: str) -> float:
        return float(median(one[key] for one in references if one[key] is not None))

    return PoseNoise(of("noise_m"), of("heading_noise_rad"))


def splits(chosen: argparse.Namespace, command: Command, folder: Path) -> Iterator[sets.Split]:
    """All sets that are asked for."""
    for seed in range(chosen.first_seed, chosen.first_seed + chosen.sets):
        yield sets.made("unlisted", seed, folder)
    for seed in range(chosen.first_seed, chosen.first_seed + chosen.nulls):
        yield sets.made("unlisted_null", seed, folder)
    if chosen.optiodom:
        if sets.OPTIODOM.exists():
            yield from sets.optiodom(command, folder)
        else:
            say(f"{sets.OPTIODOM} is not there: going on without OptiOdom")


def arguments() -> argparse.Namespace:
    """The command line, as `run.py` hands it on."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, required=True)
    parser.add_argument("--nulls", type=int, required=True)
    parser.add_argument("--first-seed", type=int, required=True)
    parser.add_argument("--optiodom", action="store_true")
    parser.add_argument("--binary", type=Path, required=True)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--table", action="store_true")
    return parser.parse_args()


def main() -> None:
    """Do the study."""
    warnings.simplefilter("ignore")
    chosen = arguments()
    if chosen.table:
        print(table([json.loads(line) for line in chosen.json.read_text().splitlines()]))
        return
    command = Command(chosen.binary)
    results: list[Json] = []
    chosen.json.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name, chosen.json.open("w") as file:
        for split in splits(chosen, command, Path(name)):
            result = studied(split, command, Path(name))
            results.append(result)
            print(json.dumps(result), file=file, flush=True)
            errors = ", ".join(f"{k} {1e3 * v:.1f}" for k, v in result["error_m"].items())
            say(f"{split.name} [mm]: {errors}")
    print(table(results))


if __name__ == "__main__":
    main()
