"""How often the covariances of an exported model hold the measured poses of runs left out.

The command learns a model on some runs and exports it; this file reckons the other runs with the
exported lengths, from the equations and without the crates, and adds up covariances in two ways:

* model: the noise grows with the way and the rotation that were driven;
* constant: a filter adds the exported twist covariance for every message, also at rest.

A pose is held where its squared error, in units of the covariance and with that of the reference,
is below the 95 % quantile of chi-squared with 3 degrees of freedom (the NEES).

    python tests/reference/held_poses.py UMBMARK [OPTIODOM]
"""

import csv
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

HELD = 7.815
"""95 % quantile of chi-squared with 3 degrees of freedom."""

RATE_HZ = 50.0
FREE = ("wheel_diameter_ratio", "wheelbase", "scale")


@dataclass(frozen=True)
class Exported:
    """Lengths, noise and constant variances as the command wrote them."""

    wheelbase: float
    per_tick: tuple[float, float]
    noise: dict[str, float]
    twist: Array


def run(command: str, *arguments: str) -> None:
    """Run the command and stop where it fails."""
    subprocess.run([command, *arguments], check=True, capture_output=True)


def exported(command: str, model: Path, speed: float, turn_rate: float) -> Exported:
    """Read back a C header and the parameters of ros2_control."""
    header, yaml = model.with_suffix(".h"), model.with_suffix(".yaml")
    run(command, "export", str(model), "--to", "c", "-o", str(header), "--force")
    usual = ["--speed", str(speed), "--turn-rate", str(turn_rate), "--rate", str(RATE_HZ)]
    to_ros = ["export", str(model), "--to", "ros2_control", "-o", str(yaml), "--force"]
    run(command, *to_ros, *usual)
    lines = [line.split() for line in header.read_text().splitlines() if "#define UMBMARK_" in line]
    numbers = {line[1].removeprefix("UMBMARK_"): float(line[2]) for line in lines if len(line) > 2}
    lines_of = yaml.read_text().splitlines()
    diagonal = next(line for line in lines_of if "twist_covariance_diagonal" in line)
    values = [float(word) for word in diagonal.split("[")[1].rstrip("]").split(",")]
    return Exported(
        numbers["WHEELBASE_M"],
        (numbers["METRES_PER_TICK_LEFT"], numbers["METRES_PER_TICK_RIGHT"]),
        tomllib.loads(model.read_text())["noise"],
        np.array([values[0], values[1], values[5]]),
    )


def rows_of(file: Path) -> Array:
    """Time, ticks and measured pose of a log; not a number where nothing was measured."""
    keys = ("t_s", "ticks_left", "ticks_right", "x_ref_m", "y_ref_m", "theta_ref_rad")
    with file.open() as text:
        rows = list(csv.DictReader(text))
    return np.array([[float(row[key] or "nan") for key in keys] for row in rows])


def squared_errors(rows: Array, model: Exported) -> tuple[Array, Array]:
    """Squared errors of measured poses in units of both covariances, a row a pose."""
    noise = model.noise
    square = {name: size**2 for name, size in noise.items()}
    pose, at = np.zeros(3), rows[0]
    covariances = [np.zeros((3, 3)), np.zeros((3, 3))]
    sees = np.array([square["reference_position_m"] + square["reference_pose_position_m"]] * 2)
    turned = square["reference_heading_rad"] + square["reference_pose_heading_rad"]
    reference = np.diag([*sees, turned])
    found: tuple[list[float], list[float]] = ([], [])
    for row in rows[1:]:
        left, right = (row[1:3] - at[1:3]) * model.per_tick
        way, turn, dt = 0.5 * (left + right), (right - left) / model.wheelbase, row[0] - at[0]
        # Wheels slip in turns on the spot too.
        rolled = 0.5 * (abs(left) + abs(right))
        middle = pose[2] + 0.5 * turn
        share = np.sinc(0.5 * turn / np.pi)
        step = way * share * np.array([np.cos(middle), np.sin(middle)])
        pose = pose + np.array([*step, turn])
        moves = np.array([[1, 0, -step[1]], [0, 1, step[0]], [0, 0, 1.0]])
        turning = np.array(
            [[np.cos(middle), -np.sin(middle), 0], [np.sin(middle), np.cos(middle), 0], [0, 0, 1]]
        )
        of_model = np.array(
            [
                square["forward_m_per_sqrt_m"] * rolled,
                square["sideways_m_per_sqrt_m"] * rolled,
                square["heading_rad_per_sqrt_m"] * abs(way)
                + square["heading_rad_per_sqrt_rad"] * abs(turn),
            ]
        )
        for which, added in enumerate((of_model, model.twist * dt / RATE_HZ)):
            moved = moves @ covariances[which] @ moves.T
            covariances[which] = moved + turning @ np.diag(added) @ turning.T
        at = row
        if np.isnan(row[3:]).any() or abs(way) + abs(turn) == 0.0:
            continue
        error = row[3:] - pose
        error[2] = (error[2] + np.pi) % (2 * np.pi) - np.pi
        for which, covariance in enumerate(covariances):
            found[which].append(float(error @ np.linalg.solve(covariance + reference, error)))
    return np.array(found[0]), np.array(found[1])


def held(files: list[Path], model: Exported) -> list[float]:
    """Shares of poses held, of all poses and of the last ones, by model and by constant."""
    pairs = [squared_errors(rows_of(file), model) for file in files]
    shares = []
    for which in range(2):
        shares.append(float(np.mean(np.concatenate([pair[which] for pair in pairs]) < HELD)))
        shares.append(float(np.mean([pair[which][-1] < HELD for pair in pairs])))
    return shares


def fitted(command: str, data: Path, model: Path) -> None:
    """Fit E_d, E_b and E_s with the noise."""
    free = "".join(f'[[effect]]\nname = "{name}"\nfree = true\n\n' for name in FREE)
    asked = model.with_name("asked.toml")
    asked.write_text(free)
    run(command, "fit", str(data), "--model", str(asked), "-o", str(model), "--force")


def made(command: str, folder: Path, seeds: int) -> None:
    """Simulated squares of 2 m: fit on 5 + 5 runs, hold against 5 + 5 others."""
    speeds = ["--speed", "0.3", "--side", "2"]
    truth = [
        "--encoder-rate",
        "20",
        "--ed",
        "1.003",
        "--eb",
        "0.99",
        "--es",
        "1.004",
        "--wheel-noise",
        "0.0006",
    ]
    sees = ["--reference-position-noise", "0.001", "--reference-heading-noise", "0.002"]
    for usual in ((0.3, 0.0), (0.3, 0.5), (0.3, 1.5)):
        table = []
        for seed in range(seeds):
            parts = [folder / f"{name}_{seed}" for name in ("learn", "test")]
            for part, shift in zip(parts, (0, 1000), strict=True):
                if not part.exists():
                    rate = ["--reference-rate", "2", "--runs", "5", "--seed", str(seed + shift)]
                    run(command, "simulate", "-o", str(part), *speeds, *truth, *sees, *rate)
            model = folder / f"model_{seed}.toml"
            if not model.exists():
                fitted(command, parts[0], model)
            files = sorted((parts[1] / "runs").glob("*.csv"))
            table.append(held(files, exported(command, model, *usual)))
        mean, scatter = np.mean(table, axis=0), np.std(table, axis=0) / np.sqrt(seeds)
        print("made", usual, *(f"{m:.3f} ± {s:.3f}" for m, s in zip(mean, scatter, strict=True)))


def real(command: str, folder: Path, optiodom: Path) -> None:
    """Squares of OptiOdom: each set fitted, the other sets of its size left out."""
    names = {
        "0.75 m": ("230620202042", "230620202258", "230620202317"),
        "1.7 m": ("231220200029", "231220200045", "231220200048"),
    }
    for size, sets in names.items():
        table = []
        for name in sets:
            place = folder / name
            if not place.exists():
                found = next((optiodom / "raw" / "square").glob(f"{name}*"))
                run(command, "convert", str(found), "-o", str(place))
            model = folder / f"{name}.toml"
            fitted(command, place, model)
            others = [other for other in sets if other != name and (folder / other).exists()]
            files = [f for other in others for f in sorted((folder / other / "runs").glob("*.csv"))]
            if files:
                table.append(held(files, exported(command, model, 0.2, 0.5)))
        print("real", size, *(f"{m:.3f}" for m in np.mean(table, axis=0)))


if __name__ == "__main__":
    umbmark = sys.argv[1]
    with tempfile.TemporaryDirectory() as made_in:
        print("kind, usual; held by model: all poses, last poses; by the constant: all, last")
        made(umbmark, Path(made_in), 10)
        if len(sys.argv) > 2:
            real(umbmark, Path(made_in), Path(sys.argv[2]))
