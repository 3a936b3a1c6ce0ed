"""Residuals as arrays, held against odometry computed elsewhere and against chance."""

import pathlib
import pickle

import numpy as np
import pyarrow as pa
import pytest
import umbmark

PATH = umbmark.Path(side_m=1.0)
TRUTH = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=3e-4)


@pytest.fixture(scope="module")
def data() -> umbmark.Dataset:
    """Return a robot with a wrong wheelbase, watched with noise."""
    truth = TRUTH.add("reference_noise", position_sd_m=1e-3, heading_sd_rad=1e-3)
    return umbmark.simulate(truth, PATH, runs=4, reference_rate_hz=2, seed=5)


@pytest.fixture(scope="module")
def fitted(data: umbmark.Dataset) -> umbmark.Fitted:
    """Return its fit."""
    return umbmark.fit(data)


def at_the_poses(run: umbmark.Run, of: umbmark.Corrected) -> np.ndarray:
    assert run.reference_sample is not None
    return of.pose[run.reference_sample]


def test_odometry_and_model_are_those_of_apply(
    data: umbmark.Dataset, fitted: umbmark.Fitted
) -> None:
    nominal = umbmark.apply(data, umbmark.Model(data.robot))
    corrected = umbmark.apply(data, fitted.model)
    tracks = fitted.tracks()
    assert [track.run for track in tracks] == [run.name for run in data]
    assert [track.direction for track in tracks] == [run.direction for run in data]
    for track, run, plain, better in zip(tracks, data, nominal, corrected, strict=True):
        assert run.time_s is not None
        assert run.reference_sample is not None
        np.testing.assert_allclose(track.time_s, run.time_s[run.reference_sample], atol=1e-12)
        np.testing.assert_allclose(track.odometry, at_the_poses(run, plain), atol=1e-9)
        np.testing.assert_allclose(track.modelled, at_the_poses(run, better), atol=1e-9)


def test_residuals_are_measured_less_modelled_and_measured_is_moved_as_a_whole(
    data: umbmark.Dataset, fitted: umbmark.Fitted
) -> None:
    for track, run in zip(fitted.tracks(), data, strict=True):
        assert run.reference_pose is not None
        np.testing.assert_array_equal(
            track.residual[:, :2], (track.measured - track.modelled)[:, :2]
        )
        turned = np.remainder(track.residual - track.measured + track.modelled + 1, 2 * np.pi)[:, 2]
        np.testing.assert_allclose(turned, 1, atol=1e-9)
        steps = [
            np.hypot(*np.diff(poses[:, :2], axis=0).T)
            for poses in (track.measured, run.reference_pose)
        ]
        np.testing.assert_allclose(steps[0], steps[1], atol=1e-9)


def test_whitened_residuals_are_independent_and_of_variance_one(fitted: umbmark.Fitted) -> None:
    """The mean square and that of neighbours: |z| < 4, n = about 1000, seed 5."""
    tracks = fitted.tracks()
    values = [
        track.whitened[np.isfinite(track.whitened).all(axis=1)]
        for track in tracks
        if track.whitened is not None
    ]
    white = np.concatenate(values)
    n = white.size
    assert n > 500
    assert abs(np.mean(white**2) - 1) < 4 * np.sqrt(2 / n)
    neighbours = np.concatenate([(of[1:] * of[:-1]).ravel() for of in values])
    assert abs(neighbours.mean()) < 4 / np.sqrt(neighbours.size)
    assert tracks.chi2 == pytest.approx(np.sum(white**2), rel=0.02)
    assert tracks.whitened_count >= n
    raw = np.concatenate([track.residual for track in tracks])
    assert np.corrcoef(raw[1:, 0], raw[:-1, 0])[0, 1] > 0.3


def test_a_right_model_leaves_nothing_where_nothing_is_random() -> None:
    truth = umbmark.Model().add("wheelbase", e_b=1.02).add("wheel_diameter_ratio", e_d=1.003)
    data = umbmark.simulate(truth, PATH, runs=1, reference_rate_hz=2)
    assert umbmark.tracks(data, truth).rms_m < 2e-4
    assert umbmark.tracks(data, truth).chi2 is None
    assert umbmark.tracks(data, truth)[0].whitened is None
    wrong = umbmark.tracks(data)
    assert wrong.rms_m > 0.02
    assert wrong.rms_rad > 0.01
    np.testing.assert_array_equal(wrong[0].odometry, wrong[0].modelled)


def test_every_result_with_a_model_has_its_tracks(data: umbmark.Dataset) -> None:
    results = (
        umbmark.learn(data, draws=99),
        umbmark.solve(data, draws=99),
        umbmark.diagnose(data, draws=99),
    )
    for result in results:
        assert result.tracks().rms_m == umbmark.tracks(data, result.model).rms_m
        again = pickle.loads(pickle.dumps(result))
        assert again == result
        assert again.tracks().rms_m == result.tracks().rms_m
        assert "data" not in result.to_dict()


def test_tracks_are_a_sequence_and_one_frame(fitted: umbmark.Fitted) -> None:
    tracks = fitted.tracks()
    assert len(tracks) == 8
    assert isinstance(tracks[1:3], umbmark.Tracks)
    poses = sum(len(track.time_s) for track in tracks)
    frame = tracks.to_pandas()
    assert len(frame) == poses == len(tracks.to_polars()) == pa.table(tracks).num_rows
    second = frame[frame.run == tracks[1].run]
    np.testing.assert_array_equal(second.x_residual_m, tracks[1].residual[:, 0])
    np.testing.assert_array_equal(second.heading_odometry_rad, tracks[1].odometry[:, 2])
    assert "x_whitened" in frame
    assert "x_whitened" not in umbmark.tracks(fitted.data).to_pandas()
    words = f"Tracks(8 runs, {poses} poses, {1e3 * tracks.rms_m:.2f} mm rms)"
    assert repr(tracks) == words


def test_tracks_compare_by_value(data: umbmark.Dataset, fitted: umbmark.Fitted) -> None:
    tracks = fitted.tracks()
    again = pickle.loads(pickle.dumps(tracks))
    assert again == tracks == fitted.tracks()
    assert hash(again) == hash(tracks)
    assert hash(again[0]) == hash(tracks[0])
    assert tracks[0] == again[0] != tracks[1]
    assert tracks != umbmark.tracks(data)
    assert tracks != tracks[1:]
    assert tracks != [*tracks]


def test_headings_that_were_not_measured_stay_unknown(data: umbmark.Dataset) -> None:
    runs = [
        umbmark.Run(
            run.direction,
            run.number,
            time_s=run.time_s,
            ticks_left=run.ticks_left,
            ticks_right=run.ticks_right,
            reference_sample=run.reference_sample,
            reference_pose=None if run.reference_pose is None else run.reference_pose[:, :2],
        )
        for run in data
    ]
    tracks = umbmark.tracks(umbmark.Dataset(data.robot, data.path, runs))
    assert np.isnan(tracks[0].residual[:, 2]).all()
    assert np.isnan(tracks.rms_rad)
    assert tracks.rms_m > 0.005


def test_return_poses_alone_have_no_tracks() -> None:
    data = umbmark.simulate(TRUTH, PATH, runs=3, reference_rate_hz=0)
    with pytest.raises(ValueError, match="no run has wheel counts and absolute poses at three"):
        umbmark.tracks(data)
    with pytest.raises(ValueError, match="the nominal robot is not known"):
        umbmark.tracks(umbmark.Dataset.from_arrays([[0.1, 0.2]], [[0.1, 0.2]]), umbmark.Model())


def test_two_places_are_read_as_one(tmp_path: pathlib.Path) -> None:
    places = [tmp_path / "monday", tmp_path / "tuesday"]
    for seed, place in enumerate(places):
        umbmark.simulate(TRUTH, PATH, runs=2, reference_rate_hz=2, seed=seed).save(place)
    joined = umbmark.load_dataset(places)
    assert [run.name.split("/")[0] for run in joined] == 4 * ["monday"] + 4 * ["tuesday"]
    assert umbmark.fit(joined) == umbmark.fit(places) != umbmark.fit(places[0])
    again = pickle.loads(pickle.dumps(joined))
    assert again == joined
    assert again.warnings == joined.warnings
    with pytest.raises(ValueError, match="given twice"):
        umbmark.load_dataset([places[0], places[0]])


def test_circles_driven_one_way_do_not_tell_the_wheels_and_accuse_none() -> None:
    noisy = umbmark.Model().add("wheel_noise", k_sqrt_m=3e-4).add("wheelbase", e_b=1.02)
    noisy = noisy.add("reference_noise", position_sd_m=5e-3, heading_sd_rad=5e-3)
    path = umbmark.Path("circle", radius_m=0.5, turns=2.0)
    for seed in range(1, 9):
        data = umbmark.simulate(noisy, path, runs=(3, 0), reference_rate_hz=10, seed=seed)
        setup = umbmark.inspect(data).setup
        assert setup is not None
        assert setup.doubts == ()
