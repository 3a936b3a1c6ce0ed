"""`umbmark sensitivity` against SALib, on the same question asked of a formula of our own.

The return errors of a square without noise follow from arcs: four legs and four turns, each at a
constant ratio of the wheel speeds. SALib samples that formula and estimates Sobol indices its way.
"""

import json
import subprocess
from pathlib import Path as File
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

Array = NDArray[np.float64]

COMMAND = File(__file__).parents[2] / "target/release/umbmark"
WHEELBASE = 0.340

BOUNDS = {
    "wheel_diameter_ratio.e_d": ("ed", 0.998, 1.004),
    "wheelbase.e_b": ("eb", 0.98, 1.01),
    "path.side_m": ("side", 2.0, 6.0),
}
"""Inputs, uniform: key, flag and ends."""

pytestmark = pytest.mark.skipif(
    not COMMAND.exists(), reason=f"{COMMAND} is not built (cargo build --release)"
)


def end(e_d: Array, e_b: Array, side: Array, direction: float) -> tuple[Array, Array]:
    """Where the robot ends that believes to drive round the square (direction +1 is ccw)."""
    left, right = 2 / (1 + e_d), 2 * e_d / (1 + e_d)
    x, y, heading = (np.zeros_like(side) for _ in range(3))
    half_turn = direction * WHEELBASE * np.pi / 4
    for _ in range(4):
        for own_left, own_right in ((side, side), (-half_turn, half_turn)):
            travel_left, travel_right = left * own_left, right * own_right
            forward = (travel_left + travel_right) / 2
            turn = (travel_right - travel_left) / (WHEELBASE * e_b)
            chord = forward * np.sinc(turn / (2 * np.pi))
            x = x + chord * np.cos(heading + turn / 2)
            y = y + chord * np.sin(heading + turn / 2)
            heading = heading + turn
    return x, y


def e_max_sys(rows: Array) -> Array:
    """E_max,sys [m] of rows (e_d, e_b, side): Eq. 4 without noise."""
    e_d, e_b, side = rows[:, 0], rows[:, 1], rows[:, 2]
    ends = (end(e_d, e_b, side, direction) for direction in (-1.0, 1.0))
    distances = [np.hypot(x, y) for x, y in ends]
    return np.asarray(np.maximum(*distances))


def asked(*words: str) -> Any:
    """What the command says."""
    vary = [f"--vary={flag}=uniform:{low}:{high}" for flag, low, high in BOUNDS.values()]
    line = [str(COMMAND), "sensitivity", *vary, "--noise-free", "--json", *words]
    done = subprocess.run(line, capture_output=True, check=True, text=True)
    return json.loads(done.stdout)["metrics"]["e_max_sys_m"]


def test_the_formula_is_the_mean_of_the_command_at_fixed_values() -> None:
    """Oracle of the oracle: Table I of the paper gives 310 mm; exactly it is 305.6."""
    found = e_max_sys(np.array([[1.00121, 337.2 / 340, 4.0]]))
    assert abs(found[0] - 0.3056) < 1e-4


def test_sobol_indices_are_those_of_salib() -> None:
    sample = pytest.importorskip("SALib.sample.sobol").sample
    analyze = pytest.importorskip("SALib.analyze.sobol").analyze
    bounds = [[low, high] for _, low, high in BOUNDS.values()]
    problem = {"num_vars": len(BOUNDS), "names": list(BOUNDS), "bounds": bounds}
    rows = sample(problem, 8192, seed=1)
    theirs = analyze(problem, e_max_sys(rows), num_resamples=50, seed=1)
    ours = asked("-n", "8192", "--second-order")
    for order, key in (("first", "S1"), ("total", "ST")):
        found = [ours[order][name]["value"] for name in BOUNDS]
        assert np.abs(np.array(found) - theirs[key]).max() < 0.01, (order, found, theirs[key])
    for pair in ours["second"]:
        one, two = (list(BOUNDS).index(name) for name in pair["of"])
        assert abs(pair["value"] - theirs["S2"][one, two]) < 0.015, (pair, theirs["S2"])
    assert abs(ours["mean"]["value"] - e_max_sys(rows).mean()) < 1e-3


def test_mu_star_orders_the_parameters_as_salib_does() -> None:
    sample = pytest.importorskip("SALib.sample.morris").sample
    analyze = pytest.importorskip("SALib.analyze.morris").analyze
    bounds = [[low, high] for _, low, high in BOUNDS.values()]
    problem = {"num_vars": len(BOUNDS), "names": list(BOUNDS), "bounds": bounds}
    rows = sample(problem, 2000, num_levels=4, seed=1)
    theirs = analyze(problem, rows, e_max_sys(rows), num_levels=4, seed=1)["mu_star"]
    ours = asked("--method", "morris", "--trajectories", "2000")["mu_star"]
    found = [ours[name]["value"] for name in BOUNDS]
    # Their grid reaches the ends of the range, ours its eighths: the order is the same.
    assert list(np.argsort(found)) == list(np.argsort(theirs)), (found, theirs)
