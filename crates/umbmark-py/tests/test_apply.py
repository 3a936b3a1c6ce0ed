"""Corrected odometry, against arcs and variances worked out in NumPy."""

import pickle

import numpy as np
import pyarrow as pa
import pytest
import umbmark

NOISE = """
[noise]
heading_rad_per_sqrt_m = 0.004
forward_m_per_sqrt_m = 0.005
sideways_m_per_sqrt_m = 0.002
"""


@pytest.fixture
def model() -> umbmark.Model:
    model = umbmark.Model().add("wheel_diameter_ratio", e_d=1.01).add("wheelbase", e_b=0.98)
    return model.add("scale", e_s=1.02)


def test_poses_are_those_of_exact_arcs_of_the_corrected_wheels(model: umbmark.Model) -> None:
    data = umbmark.simulate(model, runs=(1, 1), seed=5)
    robot = data.robot
    assert robot is not None
    for run, corrected in zip(data.runs, umbmark.apply(data, model), strict=True):
        assert corrected.run == run.name
        assert corrected.covariance is None
        time, left, right = run.time_s, run.ticks_left, run.ticks_right
        assert time is not None
        assert left is not None
        assert right is not None
        np.testing.assert_array_equal(corrected.time_s, time)
        metres = np.pi * 0.15 / 2000.0 * 1.02
        rolled_left = np.diff(left) * metres * 2.0 / 2.01
        rolled_right = np.diff(right) * metres * 2.0 * 1.01 / 2.01
        way, turn = 0.5 * (rolled_left + rolled_right), (rolled_right - rolled_left) / (0.34 * 0.98)
        heading = np.concatenate(([0.0], np.cumsum(turn)))
        # A step is the chord of its arc, at the heading halfway.
        chord = way * np.sinc(0.5 * turn / np.pi)
        halfway = heading[:-1] + 0.5 * turn
        x = np.concatenate(([0.0], np.cumsum(chord * np.cos(halfway))))
        y = np.concatenate(([0.0], np.cumsum(chord * np.sin(halfway))))
        np.testing.assert_allclose(corrected.pose, np.stack((x, y, heading), axis=1), atol=1e-9)


def test_start_moves_every_pose_rigidly(model: umbmark.Model) -> None:
    data = umbmark.simulate(model, runs=(1, 0), seed=5)
    (plain,) = umbmark.apply(data, model)
    (moved,) = umbmark.apply(data, model, start=(1.0, -2.0, 0.5))
    x, y, heading = plain.pose.T
    turned = np.stack(
        (
            1.0 + np.cos(0.5) * x - np.sin(0.5) * y,
            -2.0 + np.sin(0.5) * x + np.cos(0.5) * y,
            heading + 0.5,
        ),
        axis=1,
    )
    np.testing.assert_allclose(moved.pose, turned, atol=1e-9)


def test_covariance_grows_as_the_noise_of_the_model_says() -> None:
    model = umbmark.Model.from_toml(umbmark.Model().to_toml() + NOISE)
    assert model.noise is not None
    assert model.noise["heading_rad_per_sqrt_m"] == 0.004
    assert umbmark.Model().noise is None
    ticks = np.linspace(0.0, 20_000.0, 2001)
    time = np.linspace(0.0, 20.0, 2001)
    run = umbmark.Run("cw", 1, time_s=time, ticks_left=ticks, ticks_right=ticks)
    data = umbmark.Dataset(umbmark.Robot.labmate(), None, [run])
    (corrected,) = umbmark.apply(data, model)
    assert corrected.covariance is not None
    assert np.all(corrected.covariance[0] == 0.0)
    way = corrected.pose[-1, 0]
    heading = 0.004**2 * way
    # White noise of the heading, integrated along a straight way.
    expected = np.array(
        [
            [0.005**2 * way, 0.0, 0.0],
            [0.0, 0.002**2 * way + heading * way**2 / 3.0, 0.5 * heading * way],
            [0.0, 0.5 * heading * way, heading],
        ]
    )
    np.testing.assert_allclose(corrected.covariance[-1], expected, rtol=2e-3, atol=1e-12)
    assert np.all(np.linalg.eigvalsh(corrected.covariance[1:]) > 0.0)


def test_corrected_runs_are_a_sequence_that_compares_by_value_and_one_frame() -> None:
    noisy = umbmark.Model.from_toml(umbmark.Model().to_toml() + NOISE)
    data = umbmark.simulate(noisy, runs=(1, 1), seed=5)
    corrected = umbmark.apply(data, noisy)
    assert isinstance(corrected, umbmark.CorrectedRuns)
    assert isinstance(corrected[:1], umbmark.CorrectedRuns)
    again = pickle.loads(pickle.dumps(corrected))
    assert again == corrected == umbmark.apply(data, noisy)
    assert hash(again) == hash(corrected)
    assert corrected[0] != corrected[1]
    assert corrected != umbmark.apply(data, noisy, start=(1.0, 0.0, 0.0))
    assert corrected != [*corrected]
    samples = sum(len(run.time_s) for run in corrected)
    assert repr(corrected) == f"CorrectedRuns(2 runs, {samples} samples)"
    frame = corrected.to_pandas()
    assert len(frame) == samples == len(corrected.to_polars()) == pa.table(corrected).num_rows
    one = frame[frame.run == corrected[1].run]
    covariance = corrected[1].covariance
    assert covariance is not None
    np.testing.assert_array_equal(one.t_s, corrected[1].time_s)
    np.testing.assert_array_equal(one.theta_rad, corrected[1].pose[:, 2])
    np.testing.assert_array_equal(one.cov_y_theta_m_rad, covariance[:, 1, 2])
    assert [*umbmark.apply(data, umbmark.Model()).to_pandas()] == [*frame][:5]


def test_the_frame_has_the_columns_of_the_files_of_the_command() -> None:
    """Those of `crates/umbmark-io/src/corrected.rs`, which users read side by side."""
    noisy = umbmark.Model.from_toml(umbmark.Model().to_toml() + NOISE)
    frame = umbmark.apply(umbmark.simulate(noisy, runs=(1, 0)), noisy).to_polars()
    written = (
        "t_s,x_m,y_m,theta_rad,"
        "var_x_m2,cov_x_y_m2,var_y_m2,cov_x_theta_m_rad,cov_y_theta_m_rad,var_theta_rad2"
    )
    assert frame.columns == ["run", *written.split(",")]


def test_what_cannot_be_corrected_is_refused(model: umbmark.Model) -> None:
    returned = umbmark.Run("cw", 1, returned=(0.1, 0.2, 0.01))
    with pytest.raises(ValueError, match="wheel counts"):
        umbmark.apply(umbmark.Dataset(umbmark.Robot.labmate(), None, [returned]), model)
