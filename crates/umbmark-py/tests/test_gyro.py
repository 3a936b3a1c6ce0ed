"""A gyro in bags is read as a column of CSV is, also where the only poses are the robot's own."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import umbmark
from recorded import Row, answer, record
from rosbags.rosbag1 import Writer as Bag1Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Bag2Writer
from rosbags.typesys.store import Typestore
from test_bags import ROS1, ROS2, TICKS, header, ticks

IMU, ODOMETRY = "sensor_msgs/msg/Imu", "nav_msgs/msg/Odometry"
# The gyro's own rate [rad/s].
OWN = 0.006


def with_rates(log: list[Row]) -> list[tuple[Row, float]]:
    """Return the rows with a pose, each with the mean rate since the one before."""
    seen = [row for row in log if row.pose]
    headings = np.unwrap([row.pose[2] for row in seen if row.pose])
    times = np.array([row.stamp for row in seen], dtype=np.int64)
    rates = np.diff(headings) / (np.diff(times) / 1e9) + OWN
    rates = np.concatenate([rates[:1], rates])
    return [(row, float(rate)) for row, rate in zip(seen, rates, strict=True)]


def imu(store: Typestore, row: Row, rate: float) -> Any:
    vector = store.types["geometry_msgs/msg/Vector3"]
    still = store.types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    nine = np.zeros(9)
    turns = vector(0.01, -0.02, rate)
    return store.types[IMU](
        header(store, row, "imu"), still, nine, turns, nine, vector(0.0, 0.0, 9.81), nine
    )


def odometry(store: Typestore, row: Row) -> Any:
    t = store.types
    way = 1e-4 * (row.left + row.right)
    pose = t["geometry_msgs/msg/Pose"](
        t["geometry_msgs/msg/Point"](way, 0.0, 0.0),
        t["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0),
    )
    nothing = t["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0)
    return t[ODOMETRY](
        header(store, row, "odom"),
        "base_link",
        t["geometry_msgs/msg/PoseWithCovariance"](pose, np.zeros(36)),
        t["geometry_msgs/msg/TwistWithCovariance"](
            t["geometry_msgs/msg/Twist"](nothing, nothing), np.zeros(36)
        ),
    )


def write(writer: Any, store: Typestore, log: list[Row], own_odometry: bool) -> None:
    """Write wheels, a gyro and, if asked for, what the robot believes itself."""
    serialize = store.serialize_ros1 if store is ROS1 else store.serialize_cdr
    of_wheels = writer.add_connection("/wheels", TICKS, typestore=store)
    of_gyro = writer.add_connection("/imu/data", IMU, typestore=store)
    of_odometry = writer.add_connection("/odom", ODOMETRY, typestore=store)
    rates = {row.stamp: rate for row, rate in with_rates(log)}
    for row in log:
        writer.write(of_wheels, row.stamp, serialize(ticks(store, row), TICKS))
        if own_odometry:
            writer.write(of_odometry, row.stamp, serialize(odometry(store, row), ODOMETRY))
        if row.stamp in rates:
            message = serialize(imu(store, row, rates[row.stamp]), IMU)
            writer.write(of_gyro, row.stamp, message)


def bag1(place: Path, log: list[Row]) -> None:
    with Bag1Writer(place.with_suffix(".bag")) as writer:
        write(writer, ROS1, log, own_odometry=False)


def bag2(place: Path, log: list[Row]) -> None:
    with Bag2Writer(place, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        write(writer, ROS2, log, own_odometry=True)


def sheet(place: Path, log: list[Row]) -> None:
    """Write the same as CSV."""
    rates = {row.stamp: f"{rate!r}" for row, rate in with_rates(log)}
    begin = log[0].stamp
    lines = ["t_s,ticks_left,ticks_right,gyro_rad_s"]
    for row in log:
        time = (row.stamp - begin) / 1e9
        lines.append(f"{time:.9f},{row.left},{row.right},{rates.get(row.stamp, '')}")
    place.with_suffix(".csv").write_text("\n".join(lines) + "\n")


@pytest.fixture(scope="module")
def as_csv(measured: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = record(measured, tmp_path_factory.mktemp("csv"), sheet)
    (folder / "returns.csv").unlink()
    return folder


@pytest.mark.parametrize("bag", [bag1, bag2])
def test_a_gyro_in_a_bag_gives_what_its_column_gives(
    bag: Callable[[Path, list[Row]], None],
    command: Path,
    measured: Path,
    as_csv: Path,
    tmp_path: Path,
) -> None:
    folder = record(measured, tmp_path, bag)
    (folder / "returns.csv").unlink()
    ours, theirs = (answer(command, "fit", place) for place in (as_csv, folder))
    assert [number["parameter"] for number in ours["fitted"]] == ["e_d", "e_b"]
    for one, other in zip(ours["fitted"], theirs["fitted"], strict=True):
        assert other["value"] == pytest.approx(one["value"], abs=0.05 * one["standard_error"])
    (kind,) = {
        check["found"].split(",")[0]
        for check in answer(command, "inspect", folder)["checks"]
        if check["name"] == "kind of reference"
    }
    assert kind == "gyro"


def test_a_run_of_headings_in_python_is_that_of_the_file(as_csv: Path) -> None:
    read = umbmark.load_dataset(as_csv)
    robot = read.robot
    assert robot is not None
    (run, *_) = read.runs
    assert run.relative is True
    poses = run.reference_pose
    assert poses is not None
    assert np.isnan(poses[:, :2]).all()
    assert np.isfinite(poses[:, 2]).all()
    made = [
        umbmark.Run(
            run.direction,
            run.number,
            time_s=run.time_s,
            ticks_left=run.ticks_left,
            ticks_right=run.ticks_right,
            reference_sample=run.reference_sample,
            reference_pose=run.reference_pose,
            relative=True,
        )
        for run in read.runs
    ]
    ours, theirs = (
        {number.parameter: number.value for number in umbmark.fit(data).fitted}
        for data in (read, umbmark.Dataset(robot=robot, path=read.path, runs=made))
    )
    assert theirs == pytest.approx(ours, abs=1e-6)
    assert set(ours) == {"e_d", "e_b"}


def test_a_gyro_that_turns_too_fast_is_refused(tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    (folder / "runs").mkdir(parents=True)
    (folder / "robot.toml").write_text(
        "[robot]\nwheelbase_m = 0.3\nwheel_diameter_m = 0.1\nticks_per_revolution = 2000\n"
    )
    file = folder / "runs" / "a.csv"
    file.write_text(f"t_s,ticks_left,ticks_right,gyro_deg_s\n0,0,0,0\n1,1,1,{math.inf}\n")
    with pytest.raises(ValueError, match=r"a\.csv:3: .*gyro_deg_s.* finite number in deg/s"):
        umbmark.load_dataset(folder)
