"""How often a hidden cause of a base on rollers is named, and how often one is invented.

The bases, their motion and their sensors are written from equations here and take nothing from the
crates: rims of wheels whose rollers do not slip along their axes, counters, and a reference of
20 Hz. Each set has eight runs of two squares at a fixed heading, one of them on its corner, and a
square whose corners are turned, with rests between the moves. One cause is hidden, or none, besides
different wheels, distances and sizes, which every fit takes into account.

    python tests/reference/rollers.py target/release/umbmark --drive mecanum
"""

from __future__ import annotations

import argparse
import concurrent.futures
import json
import math
import pathlib
import subprocess
import tempfile
from typing import Any

import numpy as np

STEP = 0.005
ROW = 10
PER_REVOLUTION = 20_000.0
RUNS = 8

# Usual sizes of causes, by the names of the catalogue.
CAUSES: dict[str, dict[str, float]] = {
    "mecanum": {
        "diagonal_diameter_ratio": 3e-3,
        "axle_diameter_ratio": 3e-3,
        "lateral_scale": 2e-2,
        "crab": 5.2e-3,
        "floor_slope": 3e-3,
        "floor_slope_yaw": 1e-3,
        "reference_delay": 2e-2,
        "marker_offset": 5e-3,
        "marker_yaw": 6.6e-3,
    },
    "omni3": {
        "rear_diameter_ratio": 3e-3,
        "lateral_scale": 2e-2,
        "crab": 5.2e-3,
        "floor_slope": 3e-3,
        "floor_slope_yaw": 1e-3,
        "reference_delay": 2e-2,
        "marker_offset": 5e-3,
        "marker_yaw": 6.6e-3,
    },
}
for crossed in ("omni4", "omni4x"):
    CAUSES[crossed] = {"omni_axle_ratio": 3e-3, "omni_pair_ratio": 3e-3}
    CAUSES[crossed] |= {
        name: size for name, size in CAUSES["omni3"].items() if name != "rear_diameter_ratio"
    }
CAUSES["dead_wheels"] = {"across_diameter_ratio": 3e-3, "across_wheel_offset": 3e-3}
CAUSES["dead_wheels"] |= {
    name: size
    for name, size in CAUSES["omni3"].items()
    if name not in ("rear_diameter_ratio", "lateral_scale")
}
FITTED = {"side_diameter_ratio", "front_diameter_ratio", "omni_side_ratio", "wheelbase"}
FITTED |= {"roller_scale", "along_diameter_ratio"}
"""What every fit has, so that it is nothing found."""
ROBOT = {
    "mecanum": "wheel_distance_length_m = 0.3\nwheel_distance_width_m = 0.35\n"
    "wheel_diameter_m = 0.15",
    "omni3": "wheel_distance_m = 0.2\nwheel_diameter_m = 0.10",
    "dead_wheels": "wheel_distance_width_m = 0.3\nacross_wheel_ahead_m = -0.1\n"
    "wheel_diameter_m = 0.10",
    "omni4": "wheel_distance_m = 0.2\nwheel_offset_rad = 0\nwheel_diameter_m = 0.10",
    "omni4x": f"wheel_distance_m = 0.2\nwheel_offset_rad = {math.pi / 4}\nwheel_diameter_m = 0.10",
}
PLACES = {
    "omni3": [-math.pi / 3, math.pi / 3, math.pi],
    "omni4": [0, math.pi / 2, math.pi, -math.pi / 2],
    "omni4x": [math.pi / 4, 3 * math.pi / 4, -3 * math.pi / 4, -math.pi / 4],
}
"""Directions of omni wheels from straight ahead."""


def rows(drive: str, distance: float, offset: float = 0.0) -> np.ndarray:
    """Way of each rim for a metre ahead, a metre to the left and a radian."""
    if drive == "mecanum":
        corners = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
        wheels = [
            ((0.15 * distance * x, 0.175 * distance * y), 0.0, -x * y * math.pi / 4)
            for x, y in corners
        ]
    elif drive == "dead_wheels":
        half = 0.15 * distance
        across = ((-0.1 * distance + offset, 0.0), math.pi / 2, math.pi / 2)
        wheels = [((0.0, half), 0.0, 0.0), ((0.0, -half), 0.0, 0.0), across]
    else:
        radius = 0.2 * distance
        wheels = [
            ((radius * math.cos(a), radius * math.sin(a)), a - math.pi / 2, a - math.pi / 2)
            for a in PLACES[drive]
        ]
    made = []
    for (x, y), rolls, axis in wheels:
        cosine, sine = math.cos(axis), math.sin(axis)
        made.append(np.array([cosine, sine, x * sine - y * cosine]) / math.cos(rolls - axis))
    return np.array(made)


def sizes(drive: str, first: float, cause: str | None, size: float) -> np.ndarray:
    """True over nominal diameters of the wheels."""

    def share(ratio: float) -> float:
        return (ratio - 1) / (ratio + 1)

    own = {cause: size} if cause else {}
    if drive == "mecanum":
        s, d, a = (
            share(first),
            share(1 + own.get("diagonal_diameter_ratio", 0)),
            share(1 + own.get("axle_diameter_ratio", 0)),
        )
        return np.array([1 - s + d + a, 1 + s - d + a, 1 - s - d - a, 1 + s + d - a])
    if drive == "dead_wheels":
        s, a = share(first), 1 + own.get("across_diameter_ratio", 0)
        return np.array([1 - s, 1 + s, a])
    if drive.startswith("omni4"):
        across, along = np.sin(PLACES[drive]), np.cos(PLACES[drive])
        s, a, p = (
            share(first) / np.abs(across).max(),
            share(1 + own.get("omni_axle_ratio", 0)) / np.abs(along).max(),
            share(1 + own.get("omni_pair_ratio", 0)),
        )
        return np.asarray(1 - s * across + a * along + p * np.array([1, -1, 1, -1]))
    rear = 1 + own.get("rear_diameter_ratio", 0)
    front = 3 / (2 + rear)
    right = 2 / (1 + first)
    return np.array([front * right, front * right * first, front * rear])


def moves(mirrored: bool) -> list[np.ndarray]:
    """Motions in the base's frame: ahead, left, turn."""
    side, half = 1.5, 1.0
    square = [(side, 0, 0), (0, side, 0), (-side, 0, 0), (0, -side, 0)]
    corner = [(half, -half, 0), (half, half, 0), (-half, half, 0), (-half, -half, 0)]
    turned = [(side, 0, 0), (0, 0, math.pi / 2)] * 4
    sign = np.array([1, -1, -1]) if mirrored else np.ones(3)
    return [np.array(one) * sign for one in square + corner + turned]


def commanded(mirrored: bool, speed: float) -> np.ndarray:
    """The twist that the odometry believes at each step."""
    twists = [np.zeros((int(1.0 / STEP), 3))]
    for one in moves(mirrored):
        way = math.hypot(one[0], one[1]) + 0.3 * abs(one[2])
        ramp = min(speed / 0.3, math.sqrt(way / 0.3))
        whole = way / (0.3 * ramp) + ramp
        count = math.ceil(whole / STEP)
        time = (np.arange(count) + 0.5) * STEP
        pace = np.clip(np.minimum(time, count * STEP - time) / ramp, 0, 1)
        twists.append(np.outer(pace / (pace.sum() * STEP), one))
        twists.append(np.zeros((int(0.5 / STEP), 3)))
    return np.concatenate(twists)


def run(drive: str, hidden: dict[str, Any], number: int, chance: np.random.Generator) -> str:
    """A log of one run."""
    cause, size = hidden["cause"], hidden["size"]
    twist = commanded(number % 2 == 1, hidden["speed"])
    steps = len(twist)
    # The nominal base makes wheel speeds of the twist; the true base follows them by least squares.
    ways = twist @ rows(drive, 1.0).T * STEP
    true = ways * hidden["scale"] * sizes(drive, hidden["first"], cause, size)
    offset = size if cause == "across_wheel_offset" else 0.0
    moved = true @ np.linalg.pinv(rows(drive, hidden["distance"], offset)).T
    if cause == "lateral_scale":
        moved[:, 1] *= 1 - size
    if cause == "crab":
        ahead, left = moved[:, 0].copy(), moved[:, 1].copy()
        moved[:, 0] = math.cos(size) * ahead - math.sin(size) * left
        moved[:, 1] = math.sin(size) * ahead + math.cos(size) * left
    length = np.hypot(moved[:, 0], moved[:, 1])
    spun = np.abs(moved[:, 2])
    moved[:, 2] += 6e-4 * np.sqrt(length + 0.2 * spun) * chance.standard_normal(steps)
    moved[:, 0] += 3e-4 * np.sqrt(length) * chance.standard_normal(steps)
    moved[:, 1] += 3e-4 * np.sqrt(length) * chance.standard_normal(steps)
    poses = np.zeros((steps + 1, 3))
    x = y = heading = 0.0
    for k in range(steps):
        f, s, w = moved[k]
        if cause == "floor_slope_yaw":
            w += size * math.cos(heading) * length[k]
        middle = heading + 0.5 * w
        x += f * math.cos(middle) - s * math.sin(middle)
        y += f * math.sin(middle) + s * math.cos(middle)
        if cause == "floor_slope":
            x += size * length[k]
        heading += w
        poses[k + 1] = x, y, heading
    late = size / STEP if cause == "reference_delay" else 0.0
    per_tick = math.pi * (0.15 if drive == "mecanum" else 0.10) / PER_REVOLUTION
    counted = np.concatenate([np.zeros((1, ways.shape[1])), np.cumsum(ways, axis=0)]) / per_tick
    counted = np.floor(counted + chance.random(ways.shape[1]))
    counted -= counted[0]
    wheels = ",".join(f"ticks_{k + 1}" for k in range(ways.shape[1]))
    lines = [f"t_s,{wheels},x_ref_m,y_ref_m,theta_ref_rad"]
    for k in range(0, steps + 1, ROW // 2):
        counts = ",".join(str(int(count)) for count in counted[k])
        seen = ",,"
        if k % ROW == 0:
            at = min(max(k - late, 0.0), float(steps))
            before = int(at)
            pose = poses[before] + (at - before) * (poses[min(before + 1, steps)] - poses[before])
            px, py, pt = pose
            if cause == "marker_offset":
                px += size * math.cos(pt) - size
                py += size * math.sin(pt)
            if cause == "marker_yaw":
                pt += size
            noise = 1e-3 * chance.standard_normal(3)
            seen = f"{px + noise[0]:.6f},{py + noise[1]:.6f},{pt + noise[2]:.6f}"
        lines.append(f"{k * STEP:.3f},{counts},{seen}")
    return "\n".join(lines) + "\n"


def drawn(drive: str, cause: str | None, seed: int) -> dict[str, Any]:
    """A base with a cause of 0.7 to 3 times its usual size."""
    chance = np.random.default_rng(seed)
    size = 0.0
    if cause:
        size = CAUSES[drive][cause] * chance.uniform(0.7, 3.0) * chance.choice([-1, 1])
        if cause == "reference_delay":
            size = abs(size)
    return {
        "cause": cause,
        "size": float(size),
        "first": 1 + float(chance.uniform(-6e-3, 6e-3)),
        "scale": 1 + float(chance.uniform(-6e-3, 6e-3)),
        "distance": 1 + float(chance.uniform(-2e-2, 2e-2)),
        "speed": float(chance.uniform(0.2, 0.4)),
        "seed": seed,
    }


def judged(umbmark: str, drive: str, hidden: dict[str, Any]) -> dict[str, Any]:
    """What `learn` says of a set."""
    chance = np.random.default_rng(10_000 + hidden["seed"])
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(made)
        (folder / "runs").mkdir()
        robot = f'[robot]\nname = "made"\ndrive = "{drive.removesuffix("x")}"\n{ROBOT[drive]}\n'
        robot += f"ticks_per_revolution = {PER_REVOLUTION}\n"
        (folder / "robot.toml").write_text(robot)
        for number in range(RUNS):
            (folder / "runs" / f"none_{number + 1:02}.csv").write_text(
                run(drive, hidden, number, chance)
            )
        said = subprocess.run(
            [umbmark, "learn", str(folder), "--json", "--threads", "1", "--draws", "199"],
            capture_output=True,
            text=True,
            check=False,
        )
    if said.returncode not in (0, 3):
        return {**hidden, "error": said.stderr.strip()[-300:]}
    answer = json.loads(said.stdout)
    steps = [(step["added"], step.get("class") or []) for step in answer["steps"]]
    added = [(name, alike) for name, alike in steps if name and name not in FITTED]
    return {
        **hidden,
        "verdict": answer["verdict"],
        "added": added,
        "reasons": answer.get("reasons", []),
    }


def found(result: dict[str, Any]) -> tuple[bool, int]:
    """Whether the hidden cause is in the class of something added, and how much else was added."""
    classes = [{name, *alike} for name, alike in result["added"]]
    right = [result["cause"] in names for names in classes]
    return any(right), len(right) - min(1, sum(right))


def main() -> None:
    """Draw sets and print what was found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("umbmark")
    parser.add_argument("--drive", choices=list(CAUSES), default="mecanum")
    parser.add_argument("--sets", type=int, default=40)
    parser.add_argument("--nulls", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    causes = list(CAUSES[given.drive])
    wanted = [
        drawn(given.drive, causes[k % len(causes)], given.seed + k) for k in range(given.sets)
    ]
    wanted += [drawn(given.drive, None, given.seed + 5000 + k) for k in range(given.nulls)]
    right = alone = clean = failed = 0
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        for result in pool.map(lambda hidden: judged(given.umbmark, given.drive, hidden), wanted):
            if "error" in result:
                failed += 1
                print(json.dumps(result), flush=True)
                continue
            named, more = found(result)
            if result["cause"]:
                right, alone = right + named, alone + (named and more == 0)
            else:
                clean += not result["added"]
            if more or (result["cause"] and not named) or result["verdict"] != "explained":
                print(json.dumps(result), flush=True)
    hidden = f"class right in {right} of {given.sets}, nothing besides in {alone}"
    nulls = f"nothing added to {clean} of {given.nulls}"
    print(f"{given.drive}: {hidden}; {nulls}; {failed} failed")


if __name__ == "__main__":
    main()
