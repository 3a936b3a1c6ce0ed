"""How often the covariances of `umbmark apply` hold the measured poses of runs left out.

The command learns a model on 3 + 3 runs of a made set, and corrects the logs of the other 2 + 2
with it. A pose is held where its squared error, in units of the covariance that `apply` writes and
with the noise of the reference as the generator made it, is below the 95 % quantile of chi-squared
with 3 degrees of freedom (the NEES).

    python tests/reference/held_applied.py UMBMARK [CASE ...]
"""

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt
from generate import main as generate

Array = npt.NDArray[np.float64]

HELD = 7.815
"""95 % quantile of chi-squared with 3 degrees of freedom."""

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
)
SEEDS = (51, 52, 53)
LEFT_OUT = (4, 5)
"""Numbers of the runs that are corrected, each way."""

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


def leave_out(folder: Path, other: Path) -> None:
    """Move the logs of some runs into another folder, and take their rows out of returns.csv."""
    other.mkdir()
    for log in (folder / "runs").glob("*.csv"):
        if int(log.stem.rpartition("_")[2]) in LEFT_OUT:
            log.rename(other / log.name)
    returns = folder / "returns.csv"
    lines = returns.read_text().splitlines(keepends=True)
    kept = [line for line in lines if line.split(",")[1:2] not in [[str(n)] for n in LEFT_OUT]]
    returns.write_text("".join(kept))


def held(command: str, case: str, seed: int) -> tuple[float, float]:
    """Shares of all poses and of the last of each run that are held."""
    noise = np.array([8e-4, 8e-4, 8e-4])
    with tempfile.TemporaryDirectory() as place:
        learnt, other, model = (Path(place) / name for name in ("learnt", "other", "model.toml"))
        generate([case, str(learnt), "--seed", str(seed)])
        leave_out(learnt, other)
        learn = [command, "learn", str(learnt), "--quiet", "--force", "-o", str(model)]
        subprocess.run(learn, check=True, capture_output=True)
        every, last = [], []
        for log in sorted(other.glob("*.csv")):
            corrected = Path(place) / "corrected.csv"
            apply = [command, "apply", str(log), "--model", str(model), "--quiet", "--force"]
            subprocess.run([*apply, "-o", str(corrected)], check=True, capture_output=True)
            errors = squared_errors(log, corrected, noise)
            every.append(errors < HELD)
            last.append(errors[-1] < HELD)
    return float(np.mean(np.concatenate(every))), float(np.mean(last))


def main(command: str, cases: tuple[str, ...]) -> None:
    """Print a table: a row for each case, over the seeds, and one over all."""
    print("| hidden | all poses | last poses |\n|---|---|---|")
    whole = []
    for case in cases:
        shares = [held(command, case, seed) for seed in SEEDS]
        whole.append(np.mean(shares, axis=0))
        print(f"| {case} | {100 * whole[-1][0]:.1f} % | {100 * whole[-1][1]:.1f} % |", flush=True)
    mean, error = np.mean(whole, axis=0), np.std(whole, axis=0, ddof=1) / len(whole) ** 0.5
    both = [f"{100 * mean[k]:.1f} ± {100 * error[k]:.1f} %" for k in range(2)]
    print(f"| all | {both[0]} | {both[1]} |")


if __name__ == "__main__":
    main(sys.argv[1], tuple(sys.argv[2:]) or CASES)
