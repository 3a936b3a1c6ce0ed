"""Datasets as files: the folder that anyone may read, and the sealed answer beside it."""

import json
from pathlib import Path as File

import numpy as np
from cases import Case
from catalogue import OUTSIDE, SEEN_FROM, acceptable, kind
from measure import Dataset, Run, Terms
from robot import Array, robot_toml

RETURNS_HEADER = "direction,run,x_abs_m,y_abs_m,theta_abs_rad,x_calc_m,y_calc_m,theta_calc_rad"
LOG_HEADER = "t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad"


def write_dataset(folder: File, case: Case, data: Dataset) -> None:
    """robot.toml, returns.csv and a log for each run."""
    (folder / "runs").mkdir(parents=True, exist_ok=True)
    (folder / "robot.toml").write_text(robot_toml(folder.name, data.robot, case.path))
    for run in data.runs:
        (folder / "runs" / f"{run.direction}_{run.number:02}.csv").write_text(log(run))
    absolute = np.array([run.absolute for run in data.runs])
    computed = np.array([run.computed for run in data.runs])
    labels = [(run.direction, run.number) for run in data.runs]
    (folder / "returns.csv").write_text(returns(labels, absolute, computed))


def log(run: Run) -> str:
    """The rows of one run; cells without a measurement are empty."""
    rows = [LOG_HEADER]
    for t, (left, right), (x, y, heading) in zip(run.t_s, run.ticks, run.reference, strict=True):
        pose = ",," if np.isnan(x) else f"{x:.5f},{y:.5f},{heading:.6f}"
        rows.append(f"{t:.3f},{left},{right},{pose}")
    return "\n".join(rows) + "\n"


def returns(labels: list[tuple[str, int]], absolute: Array, computed: Array) -> str:
    """The end poses [runs x 3]."""
    rows = [RETURNS_HEADER]
    for (direction, number), a, c in zip(labels, absolute, computed, strict=True):
        rows.append(",".join([direction, str(number), *(f"{value:.6f}" for value in (*a, *c))]))
    return "\n".join(rows) + "\n"


def write_returns(folder: File, case: Case, terms: Terms, absolute: Array, computed: Array) -> None:
    """robot.toml and returns.csv from end poses [3 x runs] of one dataset."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "robot.toml").write_text(robot_toml(folder.name, case.robot, case.path))
    labels = [
        ("ccw" if direction > 0 else "cw", i % terms.runs_each + 1)
        for i, direction in enumerate(terms.directions)
    ]
    (folder / "returns.csv").write_text(returns(labels, absolute.T, computed.T))


def write_truth(
    folder: File, name: str, case: Case, seed: int, terms: Terms, level: str, base: dict[str, float]
) -> None:
    """What was put in and which answers are right, beside the folder: only assertions read it."""
    causes = [
        {
            "name": cause,
            "kind": kind(cause),
            "parameters": sizes,
            "acceptable": acceptable(cause, level),
            "seen_from": SEEN_FROM.get(cause, "tracks"),
        }
        | (
            {"acts_on": OUTSIDE[cause].acts_on, "depends_on": list(OUTSIDE[cause].depends_on)}
            if cause in OUTSIDE
            else {}
        )
        for cause, sizes in case.causes.items()
    ]
    truth = {
        "case": name,
        "seed": seed,
        "level": level,
        "base": base,
        "wheel_noise_k_sqrt_m": case.causes.get("wheel_noise", {}).get("k_sqrt_m", terms.k_sqrt_m),
        "noise_model": terms.noise_model,
        "causes": causes,
    }
    folder.with_name(folder.name + ".truth.json").write_text(json.dumps(truth, indent=1) + "\n")
