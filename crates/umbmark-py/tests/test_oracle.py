"""Calibrations against the same equations in plain NumPy and SciPy, written from the paper.

| here              | there                                                          |
|-------------------|----------------------------------------------------------------|
| `closed_forms`    | closed_form_x, closed_form_y, closed_form_mean                 |
| `exact`           | exact: end poses, weighted by the shape that wheel noise gives |
"""

import numpy as np
import pytest
import umbmark
from numpy.typing import NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]

SIDE, WHEELBASE = 4.0, 0.340
SIGN = {"cw": -1.0, "ccw": 1.0}
TOLERANCE = 1e-9


def moved(pose: Array, left: float, right: float) -> Array:
    """Return the pose after an arc of constant ratio of the wheel travels."""
    forward, turn = 0.5 * (left + right), (right - left) / WHEELBASE
    half = 0.5 * turn
    chord = forward * np.sinc(half / np.pi)
    x, y, heading = pose
    return np.array(
        [x + chord * np.cos(heading + half), y + chord * np.sin(heading + half), heading + turn]
    )


def travels(direction: str) -> list[tuple[float, float]]:
    """Return believed wheel travels: four legs, a quarter turn on the spot after each."""
    half = SIGN[direction] * np.pi / 2 * WHEELBASE / 2
    return 4 * [(SIDE, SIDE), (-half, half)]


def end(direction: str, e_d: float = 1.0, e_b: float = 1.0) -> Array:
    """Return where a robot with these ratios ends; a wheelbase that is longer turns it less."""
    left, right = 2 / (1 + e_d), 2 * e_d / (1 + e_d)
    pose = np.zeros(3)
    for believed_left, believed_right in travels(direction):
        true_left, true_right = left * believed_left, right * believed_right
        middle, half = 0.5 * (true_left + true_right), 0.5 * (true_right - true_left) / e_b
        pose = moved(pose, middle - half, middle + half)
    return pose


def shape(direction: str) -> Array:
    """Return the covariance of the end pose for unit variance per metre on each wheel."""
    total, pose = np.zeros((3, 3)), np.zeros(3)
    last = end(direction)
    for left, right in travels(direction):
        for piece in range(16):
            share = (piece + 0.5) / 16
            x, y, heading = moved(pose, share * left, share * right)
            along = 0.5 * np.array([np.cos(heading), np.sin(heading), 0.0])
            about = np.array([y - last[1], last[0] - x, 1.0]) / WHEELBASE
            for shift, rolled in ((along - about, left), (along + about, right)):
                total += np.outer(shift, shift) * abs(rolled) / 16
        pose = moved(pose, left, right)
    return total


def exact(returns: dict[str, Array]) -> Array:
    """Return E_d and E_b."""
    weights = {d: np.linalg.inv(np.linalg.cholesky(shape(d))) for d in SIGN}

    def residuals(p: Array) -> Array:
        parts = []
        for direction, errors in returns.items():
            predicted = end(direction, *p) - end(direction)
            parts.append((weights[direction] @ (errors - predicted).T).ravel())
        return np.concatenate(parts)

    found = least_squares(
        residuals, [1.0, 1.0], jac="3-point", x_scale=1e-3, xtol=1e-15, ftol=1e-15, gtol=1e-15
    )
    return np.asarray(found.x)


def closed_forms(returns: dict[str, Array]) -> dict[str, tuple[float, float]]:
    """Return E_d and E_b of the companion paper's Eqs. 10 to 20, by x, by y, and by their mean."""
    cw, ccw = (returns[d].mean(axis=0) for d in ("cw", "ccw"))
    by_x = ((cw[0] + ccw[0]) / (-4 * SIDE), (cw[0] - ccw[0]) / (-4 * SIDE))
    by_y = ((cw[1] - ccw[1]) / (-4 * SIDE), (cw[1] + ccw[1]) / (-4 * SIDE))
    mean = tuple(0.5 * (a + b) for a, b in zip(by_x, by_y, strict=True))
    found = {}
    for name, (alpha, beta) in (("x", by_x), ("y", by_y), ("mean", mean)):
        radius = 0.5 * SIDE / np.sin(0.5 * beta)
        e_d = (radius + WHEELBASE / 2) / (radius - WHEELBASE / 2)
        found[f"closed_form_{name}"] = (e_d, 90 / (90 - np.degrees(alpha)))
    return found


@pytest.fixture(scope="module", params=[1, 2, 3])
def data(request: pytest.FixtureRequest) -> umbmark.Dataset:
    """Return a LabMate by its return poses."""
    seed = request.param
    rng = np.random.default_rng(seed)
    e_d, e_b = 1 + rng.normal(0, 2e-3), 1 + rng.normal(0, 8e-3)
    runs = []
    for direction in SIGN:
        root = np.linalg.cholesky(shape(direction))
        for number in range(1, 6):
            error = end(direction, e_d, e_b) - end(direction) + 3e-4 * root @ rng.normal(size=3)
            runs.append(umbmark.Run(direction, number, returned=error.tolist()))
    return umbmark.Dataset(umbmark.Robot.labmate(), umbmark.Path(side_m=SIDE), runs)


def test_the_exact_fit_is_that_of_scipy(data: umbmark.Dataset) -> None:
    returns = {direction: data.returns(direction) for direction in SIGN}
    e_d, e_b = exact(returns)
    found = umbmark.calibrate(data).exact
    assert found.e_d == pytest.approx(e_d, abs=TOLERANCE)
    assert found.e_b == pytest.approx(e_b, abs=TOLERANCE)
    by_fit = {estimate.effect: estimate.value for estimate in umbmark.fit(data).fitted}
    assert by_fit["wheel_diameter_ratio"] == pytest.approx(e_d, abs=TOLERANCE)
    assert by_fit["wheelbase"] == pytest.approx(e_b, abs=TOLERANCE)


def test_the_closed_forms_are_those_of_the_paper(data: umbmark.Dataset) -> None:
    returns = {direction: data.returns(direction) for direction in SIGN}
    methods = umbmark.calibrate(data).methods
    for name, (e_d, e_b) in closed_forms(returns).items():
        found = methods[name]
        assert found is not None
        assert found.e_d == pytest.approx(e_d, abs=TOLERANCE)
        assert found.e_b == pytest.approx(e_b, abs=TOLERANCE)


def test_a_simulated_robot_without_noise_returns_where_plain_kinematics_say() -> None:
    model = umbmark.Model().add("wheel_diameter_ratio", e_d=1.002).add("wheelbase", e_b=0.99)
    found = umbmark.monte_carlo(model, n=1, runs=1, odometry="continuous", keep=True)
    assert found.trials is not None
    for direction in SIGN:
        x, y, heading = end(direction, 1.002, 0.99) - end(direction)
        assert found.trials[f"centroid_{direction}_x_m"][0] == pytest.approx(x, abs=TOLERANCE)
        assert found.trials[f"centroid_{direction}_y_m"][0] == pytest.approx(y, abs=TOLERANCE)
        told = found.trials[f"return_heading_{direction}_rad"][0]
        assert told == pytest.approx(heading, abs=TOLERANCE)
