"""A script as users write it: it runs, and type checkers know the type of everything in it."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import umbmark
from matplotlib.axes import Axes
from numpy.typing import NDArray
from umbmark.distributed import monte_carlo


def made() -> umbmark.Dataset:
    """Return measured runs of a robot."""
    robot = umbmark.Robot(
        name="cart", wheelbase_m=0.4, wheel_diameter_m=0.15, ticks_per_revolution=4000
    )
    model = umbmark.Model(robot).add("wheelbase", e_b=1.01).add("floor_slope", drift_x=0.01)
    model = model.add("wheel_noise", k_sqrt_m=3e-4)
    path = umbmark.Path("square", side_m=1.0, speed_m_s=0.3)
    return umbmark.simulate(model, path, runs=(3, 3), reference_rate_hz=5, seed=np.int64(4))


def rms_of_each_run(tracks: umbmark.Tracks) -> dict[str, float]:
    """Return the root mean square of the residuals of each run in m."""
    squares: dict[str, NDArray[np.float64]] = {
        track.run: track.residual[:, :2] ** 2 for track in tracks
    }
    return {run: float(np.sqrt(of.sum(axis=1).mean())) for run, of in squares.items()}


def worst(learnt: umbmark.Learnt) -> umbmark.results.Step:
    """Return the step after which the error is largest."""
    return max(learnt.steps, key=lambda step: step.rmse_m or 0.0)


def test_a_script_of_a_user_runs_and_is_typed(tmp_path: Path) -> None:
    data = made()
    score: umbmark.Score = umbmark.score(data.returns("cw"), data.returns("ccw"))
    low, high = score.e_max_sys_interval_m or (0.0, 0.0)
    assert low < high
    learnt = umbmark.learn(data, draws=99)
    assert worst(learnt).added in (None, "wheel_diameter_ratio")
    assert max(rms_of_each_run(learnt.tracks()).values()) < 0.01
    axes: Axes = learnt.plot()
    panels: list[Axes] = learnt.plot(kind="tracks")
    assert axes.lines
    assert len(panels) == 2
    model: umbmark.Model = learnt.model
    if learnt.unlisted is not None and learnt.unlisted.suggestion is not None:
        model = model.add(learnt.unlisted.suggestion)
    text: str = umbmark.export(model, to="toml", force=True).text
    (tmp_path / "robot.toml").write_text(text)
    with ThreadPoolExecutor(2) as executor:
        study = umbmark.Study(umbmark.Model().add("wheel_noise", k_sqrt_m=1e-3), n=100)
        mean: float | None = monte_carlo(executor, study).metrics["e_max_sys_m"].mean
        found = umbmark.each(umbmark.fit, {"cart": data}, executor=executor)
    assert mean
    fitted: umbmark.Fitted = found["cart"]
    errors: list[float | None] = [estimate.standard_error for estimate in fitted.fitted]
    assert all(errors)
    names: list[str] = found.to_pandas()["robot"].unique().tolist()
    assert names == ["cart"]
