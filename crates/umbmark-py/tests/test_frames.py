"""Data sets of arrays and of frames: those that files with the same rows would be."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
import umbmark
import xarray as xr

ROBOT, PATH = umbmark.Robot.labmate(), umbmark.Path(side_m=0.5)
CW = np.array([[-0.21, -0.19, -0.05], [-0.19, -0.21, np.nan]])
CCW = np.array([[0.02, 0.01], [0.01, -0.02], [0.03, 0.00]])
COLUMNS = ["t_s", "ticks_left", "ticks_right", "x_ref_m", "y_ref_m", "theta_ref_rad"]


def test_return_errors_in_arrays_are_a_dataset_of_numbered_runs() -> None:
    bumps = [[0.1, 0.2, 0.3]]
    data = umbmark.Dataset.from_arrays(CW, CCW, robot=ROBOT, path=PATH, bumps_ccw=bumps)
    assert [run.name for run in data] == [
        "cw_01",
        "cw_02",
        "ccw_01",
        "ccw_02",
        "ccw_03",
        "bumps_ccw_01",
    ]
    assert (data.robot, data.path) == (ROBOT, PATH)
    np.testing.assert_array_equal(data.returns("cw"), CW)
    np.testing.assert_array_equal(data.returns("ccw")[:, :2], CCW)
    np.testing.assert_array_equal(data.returns("ccw", "bumps"), bumps)
    runs = [
        umbmark.Run(way, number, returned=error.tolist())
        for way, errors in (("cw", CW), ("ccw", CCW))
        for number, error in enumerate(errors, start=1)
    ]
    assert umbmark.Dataset.from_arrays(CW, CCW, robot=ROBOT) == umbmark.Dataset(ROBOT, None, runs)
    assert umbmark.score(umbmark.Dataset.from_arrays(CW, CCW)) == umbmark.score(CW, CCW)
    assert len(umbmark.Dataset.from_arrays(ccw=pd.DataFrame(CCW))) == 3


def test_arrays_that_hold_no_return_errors_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"bumps_cw must have shape \(n, 3\)"):
        umbmark.Dataset.from_arrays(CW, CCW, bumps_cw=[1.0, 2.0])
    with pytest.raises(ValueError, match=r"ccw\[1\] must be finite"):
        umbmark.Dataset.from_arrays(CW, [[0.0, 0.0], [np.nan, 0.0]])


@pytest.fixture(scope="module")
def data() -> umbmark.Dataset:
    """Return a robot that was watched on its way, its headings seen now and then."""
    model = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=1e-3)
    return umbmark.simulate(model, PATH, runs=2, reference_rate_hz=3)


def logs(data: umbmark.Dataset) -> Iterator[tuple[str, np.ndarray]]:
    """Give the rows of each run as in its file: NaN where nothing was measured."""
    for run in data:
        assert run.time_s is not None
        assert run.reference_pose is not None
        assert run.reference_sample is not None
        rows = np.full((len(run.time_s), 6), np.nan)
        rows[:, 0], rows[:, 1], rows[:, 2] = run.time_s, run.ticks_left, run.ticks_right
        rows[run.reference_sample, 3:] = run.reference_pose
        yield run.name, rows


@pytest.fixture(scope="module")
def frame(data: umbmark.Dataset) -> pd.DataFrame:
    """Return its logs in one frame."""
    parts = [pd.DataFrame(rows, columns=COLUMNS).assign(run=name) for name, rows in logs(data)]
    return pd.concat(parts, ignore_index=True)


FRAMES: dict[str, Callable[[pd.DataFrame], Any]] = {
    "pandas": lambda frame: frame,
    "polars": pl.from_pandas,
    "Arrow": lambda frame: pa.Table.from_pandas(frame, preserve_index=False),
    "xarray": lambda frame: xr.Dataset.from_dataframe(frame),
    "arrays": lambda frame: {name: frame[name].to_numpy() for name in frame},
    "lists": lambda frame: {name: frame[name].tolist() for name in frame},
    "a stream of Arrow": lambda frame: Stream(pa.Table.from_pandas(frame, preserve_index=False)),
    "integer counts": lambda frame: frame.astype({"ticks_left": "int32", "ticks_right": "int64"}),
    "nullable": lambda frame: frame.convert_dtypes(),
    "shuffled runs": lambda frame: pd.concat(
        [part for _, part in sorted(frame.groupby("run"), reverse=True)]
    ),
}


class Stream:
    """Columns that are handed over as a stream, and in no other way."""

    def __init__(self, table: pa.Table) -> None:
        self._table = table

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        return self._table.__arrow_c_stream__(requested_schema)


@pytest.mark.parametrize("kind", FRAMES)
def test_a_frame_of_logs_is_the_dataset_that_its_files_would_be(
    kind: str, frame: pd.DataFrame, data: umbmark.Dataset, tmp_path: Path
) -> None:
    made = umbmark.Dataset.from_frame(FRAMES[kind](frame), robot=data.robot, path=PATH)
    data.save(tmp_path / "files")
    (tmp_path / "files" / "returns.csv").unlink()
    read = umbmark.load_dataset(tmp_path / "files")
    assert made == read
    assert made.warnings == read.warnings == ()
    assert len(made) == 4
    np.testing.assert_allclose(made.returns("cw"), data.returns("cw"), atol=2e-5)


def test_columns_may_have_any_name(frame: pd.DataFrame, data: umbmark.Dataset) -> None:
    expected = umbmark.Dataset.from_frame(frame, robot=ROBOT)
    names = dict(zip([*COLUMNS, "run"], ["t", "l", "r", "x", "y", "yaw", "drive"], strict=True))
    renamed = frame.rename(columns=names)
    renamed["t"] = pd.Timestamp("2024-05-01") + pd.to_timedelta(frame["t_s"], unit="s")
    made = umbmark.Dataset.from_frame(
        renamed, robot=ROBOT, run="drive", t="t", ticks=("l", "r"), pose=("x", "y", "yaw")
    )
    for one, two in zip(made, expected, strict=True):
        np.testing.assert_allclose(one.time_s, two.time_s, atol=2e-9)  # type: ignore[arg-type]
        np.testing.assert_array_equal(one.reference_pose, two.reference_pose)
    positions = umbmark.Dataset.from_frame(frame, robot=ROBOT, pose=("x_ref_m", "y_ref_m"))
    assert positions[0].reference_pose is not None
    assert np.isnan(positions[0].reference_pose[:, 2]).all()
    one_run = frame[frame.run == "ccw_01"]
    alone = umbmark.Dataset.from_frame(one_run, robot=ROBOT, run=None, pose=None)
    assert [(run.name, run.direction) for run in alone] == [("run_01", "ccw")]
    assert alone[0].reference_pose is not None
    assert len(alone[0].reference_pose) == 0


BERLIN = pd.Timestamp("2024-03-31T01:59:59", tz="Europe/Berlin")


def dated(frame: pd.DataFrame) -> pd.DataFrame:
    """Give the times as dates with a time zone, of a night in which clocks were put forward."""
    return frame.assign(t_s=BERLIN + pd.to_timedelta(frame["t_s"], unit="s"))


DATED: dict[str, Callable[[pd.DataFrame], Any]] = {
    "dates in a zone": lambda frame: frame,
    "an index of dates": lambda frame: frame.set_index("t_s"),
    "two indices": lambda frame: frame.set_index(["run", "t_s"]),
    "dates of Python": lambda frame: {
        name: [*frame[name]] if name != "t_s" else [at.to_pydatetime() for at in frame[name]]
        for name in frame
    },
    "polars": pl.from_pandas,
    "Arrow": lambda frame: pa.Table.from_pandas(frame, preserve_index=False),
    "pandas on Arrow": lambda frame: frame.convert_dtypes(dtype_backend="pyarrow"),
}


@pytest.mark.parametrize("kind", DATED)
def test_times_may_be_dates_in_a_zone_or_an_index(kind: str, frame: pd.DataFrame) -> None:
    expected = umbmark.Dataset.from_frame(frame, robot=ROBOT)
    made = umbmark.Dataset.from_frame(DATED[kind](dated(frame)), robot=ROBOT)
    assert [run.name for run in made] == [run.name for run in expected]
    for one, two in zip(made, expected, strict=True):
        # Dates of Python have microseconds.
        np.testing.assert_allclose(one.time_s, two.time_s, atol=2e-6)  # type: ignore[arg-type]
        np.testing.assert_array_equal(one.ticks_left, two.ticks_left)


def test_an_index_without_a_name_is_called_index(frame: pd.DataFrame) -> None:
    nameless = frame.set_index("t_s").rename_axis(None)
    made = umbmark.Dataset.from_frame(nameless, robot=ROBOT, t="index")
    assert made == umbmark.Dataset.from_frame(frame, robot=ROBOT)
    with pytest.raises(ValueError, match='no column "t_s" in the frame; it has ticks_left'):
        umbmark.Dataset.from_frame(nameless, robot=ROBOT)
    with pytest.raises(ValueError, match='no column "time" in the frame; it has t_s, ticks_left'):
        umbmark.Dataset.from_frame(frame.set_index("t_s"), robot=ROBOT, t="time")


def test_rows_without_a_time_or_a_run_are_refused(frame: pd.DataFrame) -> None:
    dates = dated(frame).t_s
    for times in (dates, dates.dt.tz_localize(None)):
        unknown = frame.assign(t_s=times.where(frame.index != 2))
        with pytest.raises(ValueError, match=r"t_s\[2\] must be a (date|time).*, got NaT"):
            umbmark.Dataset.from_frame(unknown, robot=ROBOT)
    for labels in (frame.run, pd.Series(np.arange(len(frame)), dtype="Int64")):
        unknown = frame.assign(run=labels.where(frame.index != 3))
        for made in (unknown, pl.from_pandas(unknown)):
            with pytest.raises(ValueError, match=r"run\[3\] must name the run of its row, got "):
                umbmark.Dataset.from_frame(made, robot=ROBOT)


def test_a_query_that_has_not_been_run_is_refused(frame: pd.DataFrame) -> None:
    with pytest.raises(TypeError, match=r"pass frame\.collect\(\)"):
        umbmark.Dataset.from_frame(pl.from_pandas(frame).lazy(), robot=ROBOT)


def test_counters_roll_over_and_poses_have_a_frame_of_their_own_as_in_files(
    frame: pd.DataFrame,
) -> None:
    expected = umbmark.Dataset.from_frame(frame, robot=ROBOT)
    bits = umbmark.Robot.from_toml(ROBOT.to_toml().replace("[robot]", "[robot]\ncounter_bits = 12"))
    rolled = frame.assign(ticks_left=frame.ticks_left % 4096, ticks_right=frame.ticks_right % 4096)
    made = umbmark.Dataset.from_frame(rolled, robot=bits)
    np.testing.assert_array_equal(made[0].ticks_left, expected[0].ticks_left)
    assert any("roll-overs of the 12-bit counters undone" in said for said in made.warnings)
    elsewhere = frame.assign(
        x_ref_m=3.0 - frame.y_ref_m,
        y_ref_m=frame.x_ref_m - 1.0,
        theta_ref_rad=frame.theta_ref_rad + np.pi / 2,
    )
    moved = umbmark.Dataset.from_frame(elsewhere, robot=ROBOT)
    np.testing.assert_allclose(moved.returns("ccw"), expected.returns("ccw"), atol=1e-9)


@pytest.mark.parametrize(
    ("change", "keys", "words"),
    [
        ({}, {"t": "time"}, 'there is no column "time" in the frame; it has t_s, ticks_left'),
        ({}, {"run": "drive"}, "Say run=..."),
        ({}, {"pose": ("x", "y")}, "Say pose=..."),
        ({}, {"pose": ("x_ref_m",)}, "pose must name x, y and heading, or x and y, got 1 names"),
        ({"ticks_left": "many"}, {}, "ticks_left must be numbers"),
        ({"ticks_right": np.nan}, {}, "ticks_right[0] must be finite, got nan"),
        ({"t_s": 1.0}, {}, "cw_01"),
        ({"x_ref_m": np.inf}, {}, "x_ref_m[0] must be finite, or NaN where nothing was measured"),
        ({"y_ref_m": np.nan}, {}, "y_ref_m[0] must be known where the other coordinate is"),
        ({"x_ref_m": np.nan, "y_ref_m": np.nan}, {}, "theta_ref_rad[0] must be NaN where"),
    ],
)
def test_a_frame_that_no_robot_recorded_is_refused_by_its_column(
    change: dict[str, Any], keys: dict[str, Any], words: str, frame: pd.DataFrame
) -> None:
    with pytest.raises((TypeError, ValueError), match=re.escape(words)):
        umbmark.Dataset.from_frame(frame.assign(**change), robot=ROBOT, **keys)


def test_columns_of_unequal_length_are_refused(frame: pd.DataFrame) -> None:
    columns = {name: frame[name].to_numpy() for name in frame}
    with pytest.raises(ValueError, match="ticks_left must have as many rows as t_s"):
        umbmark.Dataset.from_frame({**columns, "ticks_left": columns["ticks_left"][:-1]})
