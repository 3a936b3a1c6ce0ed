"""How often the covariances of `umbmark apply` hold the measured poses of runs left out.

The command learns a model on some runs and corrects the logs of others of the same robot with it.
A pose is held where its squared error, in units of the covariance that `apply` writes and with the
noise of the reference, is below the 95 % quantile of chi-squared with 3 degrees of freedom (the
NEES). Three kinds of data:

* 5 + 5 runs of each case of `CASES`: learnt on 3 + 3, the other 2 + 2 corrected;
* `scatter`: the command's own simulator, wheels that scatter much: learnt on 5 + 5 of 25 + 25;
* `examples`: learnt on `examples/hidden`, corrected in `examples/fresh_day`.

    python tests/reference/held_applied.py UMBMARK [CASE ...]
"""

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from generate import main as generate
from held_poses import HELD, Array
from sensors import Reference

CASES = (
    "none",
    "none_on_figure_eight",
    "wheel_eccentricity_left",
    "direction_dependent_wheelbase",
    "caster_kick",
    "floor_slope",
    "floor_slope_yaw",
    "diameter_drift",
    "second_harmonic_yaw",
    "bumps",
    "wheel_noise",
    "scatter",
    "examples",
)
SETS = 3
"""Of each case; no two sets have one seed, so their errors are independent."""
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SCATTER = "--ed 1.001 --eb 0.995 --es 0.998 --wheel-noise 0.0005 --side 4 --runs 25"
SEEN = "--reference-rate 20 --reference-position-noise 0.001 --reference-heading-noise 0.001"

Row = dict[str, float]


def rows_of(file: Path) -> list[Row]:
    """The rows of a file that have numbers."""
    with file.open(newline="") as lines:
        body = csv.DictReader(line for line in lines if not line.startswith("#"))
        return [{key: float(value) for key, value in row.items() if value} for row in body]


def squared_errors(log: Path, corrected: Path, noise: Array) -> Array:
    """Squared errors of the poses of a run that moves, in units of their covariance."""
    poses = {round(row["t_s"], 6): row for row in rows_of(corrected)}
    found = []
    for row in rows_of(log):
        at = poses.get(round(row["t_s"], 6))
        if at is None or "x_ref_m" not in row or at["var_theta_rad2"] == 0.0:
            continue
        error = np.array(
            [
                row["x_ref_m"] - at["x_m"],
                row["y_ref_m"] - at["y_m"],
                row["theta_ref_rad"] - at["theta_rad"],
            ]
        )
        error[2] = (error[2] + np.pi) % (2 * np.pi) - np.pi
        covariance = np.array(
            [
                [at["var_x_m2"], at["cov_x_y_m2"], at["cov_x_theta_m_rad"]],
                [at["cov_x_y_m2"], at["var_y_m2"], at["cov_y_theta_m_rad"]],
                [at["cov_x_theta_m_rad"], at["cov_y_theta_m_rad"], at["var_theta_rad2"]],
            ]
        )
        found.append(float(error @ np.linalg.solve(covariance + np.diag(noise**2), error)))
    return np.array(found)


def leave_out(folder: Path, other: Path, first: int) -> None:
    """Move the logs of runs from a number on into another folder; returns.csv forgets them."""
    other.mkdir()
    for log in (folder / "runs").glob("*.csv"):
        if int(log.stem.rpartition("_")[2]) >= first:
            log.rename(other / log.name)
    returns = folder / "returns.csv"
    rows = [line.split(",") for line in returns.read_text().splitlines()]
    kept = [row for row in rows if len(row) < 2 or not row[1].isdigit() or int(row[1]) < first]
    returns.write_text("".join(",".join(row) + "\n" for row in kept))


def made(command: str, case: str, seed: int, place: Path) -> tuple[Path, Path, Array]:
    """Folders of what is learnt from and of logs to correct, and the noise of the reference."""
    if case == "examples":
        # As it is learnt: 0.8 mm and 1.1 mrad.
        noise = np.array([8e-4, 8e-4, 1.1e-3])
        return EXAMPLES / "hidden", EXAMPLES / "fresh_day" / "runs", noise
    learnt, other = place / "learnt", place / "other"
    if case == "scatter":
        words = [command, "simulate", *SCATTER.split(), *SEEN.split(), "--seed", str(seed)]
        subprocess.run([*words, "-o", str(learnt)], check=True, capture_output=True)
        leave_out(learnt, other, 6)
        return learnt, other, np.array([1e-3, 1e-3, 1e-3])
    generate([case, str(learnt), "--seed", str(seed)])
    leave_out(learnt, other, 4)
    sees = Reference()
    return learnt, other, np.array([sees.position_sd_m] * 2 + [sees.heading_sd_rad])


def held(command: str, case: str, seed: int) -> tuple[float, float]:
    """Shares of all poses and of the last of each run that are held."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        learnt, other, noise = made(command, case, seed, place)
        model, corrected = place / "model.toml", place / "corrected.csv"
        learn = [command, "learn", str(learnt), "--quiet", "--force", "-o", str(model)]
        subprocess.run(learn, check=True, capture_output=True)
        every, last = [], []
        for log in sorted(other.glob("*.csv")):
            apply = [command, "apply", str(log), "--model", str(model), "--quiet", "--force"]
            subprocess.run([*apply, "-o", str(corrected)], check=True, capture_output=True)
            errors = squared_errors(log, corrected, noise)
            every.append(errors < HELD)
            last.append(errors[-1] < HELD)
    return float(np.mean(np.concatenate(every))), float(np.mean(last))


def row(name: str, shares: list[tuple[float, float]]) -> str:
    """A row of the table: means, and their standard errors where there are several sets."""
    means = 100 * np.mean(shares, axis=0)
    if len(shares) == 1:
        return f"| {name} | 1 | {means[0]:.1f} % | {means[1]:.1f} % |"
    errors = 100 * np.std(shares, axis=0, ddof=1) / len(shares) ** 0.5
    both = [f"{mean:.1f} ± {error:.1f} %" for mean, error in zip(means, errors, strict=True)]
    return f"| {name} | {len(shares)} | {both[0]} | {both[1]} |"


def main(command: str, cases: tuple[str, ...]) -> None:
    """Print a table: a row for each case, ± a standard error over its sets, and one over all."""
    print("| hidden | sets | all poses | last poses |\n|---|---|---|---|")
    whole = []
    for case in cases:
        first = 51 + SETS * CASES.index(case)
        sets = 1 if case == "examples" else SETS
        shares = [held(command, case, seed) for seed in range(first, first + sets)]
        whole += shares
        print(row(case, shares), flush=True)
    print(row("all", whole))


if __name__ == "__main__":
    main(sys.argv[1], tuple(sys.argv[2:]) or CASES)
