"""A script as users write it: it runs, and type checkers know the type of everything in it."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pandas as pd
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


def log_of(data: umbmark.Dataset) -> pd.DataFrame:
    """Return logs as a logger hands them over: dated rows, NaN where no pose was measured."""
    parts: list[pd.DataFrame] = []
    for run in data:
        assert run.time_s is not None
        assert run.reference_sample is not None
        assert run.reference_pose is not None
        pose = np.full((len(run.time_s), 3), np.nan)
        pose[run.reference_sample] = run.reference_pose
        stamps = pd.Timestamp("2026-05-01T10:00", tz="UTC") + pd.to_timedelta(run.time_s, unit="s")
        columns = {"left": run.ticks_left, "right": run.ticks_right, "drive": run.name}
        part = pd.DataFrame({"stamp": stamps, **columns})
        parts.append(part.assign(x=pose[:, 0], y=pose[:, 1], yaw=pose[:, 2]))
    return pd.concat(parts).set_index("stamp")


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
    simulated = made()
    data = umbmark.Dataset.from_frame(
        log_of(simulated),
        robot=simulated.robot,
        path=simulated.path,
        run="drive",
        t="stamp",
        ticks=("left", "right"),
        pose=("x", "y", "yaw"),
    )
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
    fixed: umbmark.Fitted = umbmark.fit(data, model, fix={"wheelbase.e_b": 1.01})
    covariance: NDArray[np.float64] = fixed.covariance
    assert covariance.shape == (len(fixed.fitted), len(fixed.fitted))
    corrected = umbmark.apply(data, model)
    ends: NDArray[np.float64] = np.array([run.pose[-1] for run in corrected])
    last = corrected.to_pandas().groupby("run", sort=False)["x_m"].last()
    np.testing.assert_array_equal(last.to_numpy(), ends[:, 0])
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
