"""Bags of ROS that the package rosbags writes are read as the CSV of the same runs."""

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from recorded import Row, answer, assert_calibrates_alike, record, rows
from rosbags.rosbag1 import Writer as Bag1Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Bag2Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

ROS1 = get_typestore(Stores.ROS1_NOETIC)
ROS2 = get_typestore(Stores.ROS2_JAZZY)
TICKS = "demo_msgs/msg/WheelTicks"
for store in [ROS1, ROS2]:
    text = "std_msgs/Header header\nint64 ticks_left\nint64 ticks_right\n"
    store.register(get_types_from_msg(text, TICKS))


def header(store: Typestore, row: Row, frame: str) -> Any:
    stamp = store.types["builtin_interfaces/msg/Time"](**row.time)
    own = {"seq": 7} if store is ROS1 else {}
    return store.types["std_msgs/msg/Header"](**own, stamp=stamp, frame_id=frame)


def joints(store: Typestore, row: Row) -> Any:
    nothing = np.zeros(0)
    right, left = reversed(row.positions)
    position = np.array([0.1, right, left])
    names = ["arm", "wheel_right_joint", "wheel_left_joint"]
    kind = store.types["sensor_msgs/msg/JointState"]
    return kind(header(store, row, ""), names, position, nothing, nothing)


def ticks(store: Typestore, row: Row) -> Any:
    return store.types[TICKS](header(store, row, ""), row.left, row.right)


def pose(store: Typestore, row: Row) -> Any:
    t = store.types
    assert row.pose
    point = t["geometry_msgs/msg/Point"](row.pose[0], row.pose[1], 0.3)
    orientation = t["geometry_msgs/msg/Quaternion"](**row.quaternion)
    inner = t["geometry_msgs/msg/Pose"](point, orientation)
    whole = t["geometry_msgs/msg/PoseWithCovariance"](inner, np.zeros(36))
    return t["geometry_msgs/msg/PoseWithCovarianceStamped"](header(store, row, "map"), whole)


def write(
    writer: Any, store: Typestore, wheels: Callable[[Typestore, Row], Any], log: list[Row]
) -> None:
    """Write wheels and poses, and a topic that nobody asked for."""
    kind = TICKS if wheels is ticks else "sensor_msgs/msg/JointState"
    posed = "geometry_msgs/msg/PoseWithCovarianceStamped"
    serialize = store.serialize_ros1 if store is ROS1 else store.serialize_cdr
    of_wheels = writer.add_connection("/wheels", kind, typestore=store)
    of_poses = writer.add_connection("/mocap", posed, typestore=store)
    noise = writer.add_connection("/chatter", "std_msgs/msg/String", typestore=store)
    for row in log:
        writer.write(of_wheels, row.stamp, serialize(wheels(store, row), kind))
        said = store.types["std_msgs/msg/String"]("x" * (row.left % 500))
        writer.write(noise, row.stamp, serialize(said, "std_msgs/msg/String"))
        if row.pose:
            writer.write(of_poses, row.stamp + 5, serialize(pose(store, row), posed))


def bag1(
    compression: Any, wheels: Callable[[Typestore, Row], Any]
) -> Callable[[Path, list[Row]], None]:
    def bag(place: Path, log: list[Row]) -> None:
        writer = Bag1Writer(place.with_suffix(".bag"))
        writer.chunk_threshold = 30_000
        if compression:
            writer.set_compression(compression)
        with writer:
            write(writer, ROS1, wheels, log)

    return bag


def bag2(
    plugin: StoragePlugin,
    wheels: Callable[[Typestore, Row], Any],
    mode: CompressionMode | None = None,
    version: Literal[8, 9] = 9,
    bare: bool = False,
) -> Callable[[Path, list[Row]], None]:
    def bag(place: Path, log: list[Row]) -> None:
        writer = Bag2Writer(place, version=version, storage_plugin=plugin)
        if mode:
            writer.set_compression(mode, CompressionFormat.ZSTD)
        with writer:
            write(writer, ROS2, wheels, log)
        if bare:
            shutil.move(next(place.glob("*.db3")), place.with_suffix(".db3"))
            shutil.rmtree(place)

    return bag


def split(plugin: StoragePlugin, listed: bool) -> Callable[[Path, list[Row]], None]:
    """Write a bag in twelve files, which its metadata.yaml lists, or which a killed recorder left.

    The last of the files of a killed recorder ends in the middle of a record.
    """

    def bag(place: Path, log: list[Row]) -> None:
        place.mkdir()
        parts = 12
        size = -(-len(log) // parts)
        names = []
        for part in range(parts):
            own = place / f"part_{part}"
            bag2(plugin, joints)(own, log[part * size : (part + 1) * size])
            (file,) = (f for f in own.iterdir() if f.name != "metadata.yaml")
            names.append(f"rosbag2_{part}{file.suffix}")
            shutil.move(file, place / names[-1])
            shutil.rmtree(own)
        lines = ["rosbag2_bagfile_information:", "  version: 9"]
        if listed:
            lines += ["  relative_file_paths:", *(f"    - {name}" for name in names)]
        (place / "metadata.yaml").write_text("\n".join(lines) + "\n")
        if not listed:
            last = place / names[-1]
            last.write_bytes(last.read_bytes()[: last.stat().st_size // 2])

    return bag


SQLITE, MCAP = StoragePlugin.SQLITE3, StoragePlugin.MCAP
BAGS = {
    "ROS 1": bag1(None, ticks),
    "ROS 1, bz2": bag1(Bag1Writer.CompressionFormat.BZ2, joints),
    "ROS 1, lz4": bag1(Bag1Writer.CompressionFormat.LZ4, ticks),
    "SQLite alone": bag2(SQLITE, ticks, bare=True),
    "SQLite without definitions": bag2(SQLITE, joints, version=8),
    "SQLite, file packed": bag2(SQLITE, joints, CompressionMode.FILE),
    "SQLite, messages packed": bag2(SQLITE, ticks, CompressionMode.MESSAGE),
    "folder of MCAP": bag2(MCAP, ticks),
    "folder of MCAP, packed": bag2(MCAP, joints, CompressionMode.FILE),
    "SQLite in parts": split(SQLITE, listed=True),
    "MCAP in parts": split(MCAP, listed=True),
}


@pytest.mark.parametrize("kind", BAGS)
def test_a_bag_calibrates_as_the_csv_does(
    kind: str, command: Path, measured: Path, tmp_path: Path
) -> None:
    folder = record(measured, tmp_path, BAGS[kind])
    assert_calibrates_alike(command, measured, folder)


@pytest.mark.parametrize("kind", BAGS)
def test_one_bag_is_inspected_without_a_robot(
    kind: str, command: Path, measured: Path, tmp_path: Path
) -> None:
    file = min((measured / "runs").iterdir())
    log = list(rows(file))
    BAGS[kind](tmp_path / file.stem, log)
    (place,) = tmp_path.iterdir()
    found = answer(command, "inspect", place)
    (contents,) = found["contents"]
    topics = {part["name"]: (part["count"], part["used"]) for part in contents["parts"]}
    assert topics["/wheels"] == (len(log), "wheels")
    assert topics["/mocap"] == (sum(row.pose is not None for row in log), "reference")
    assert topics["/chatter"] == (len(log), None)


def test_a_bag_of_a_recorder_that_was_killed_is_read_in_the_order_of_its_files(
    command: Path, measured: Path, tmp_path: Path
) -> None:
    file = min((measured / "runs").iterdir())
    log = list(rows(file))
    split(MCAP, listed=False)(tmp_path / file.stem, log)
    found = answer(command, "inspect", tmp_path / file.stem)
    (contents,) = found["contents"]
    # The index and the end of the last of twelve files are lost, and not the messages before.
    assert 11 / 12 < contents["wheels"]["readings"] / len(log) < 1
    assert contents["wheels"]["rate_hz"] == pytest.approx(100, rel=1e-6)
    assert any("damaged" in note and "rosbag2_11.mcap" in note for note in contents["notes"])


def test_files_that_a_bag_lists_must_be_in_it(command: Path, tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    bag.mkdir()
    for name, said in [
        ("../other.mcap", "outside of the folder"),
        ("gone.mcap", "not there"),
    ]:
        text = f"rosbag2_bagfile_information:\n  relative_file_paths: [{name}]\n"
        (bag / "metadata.yaml").write_text(text)
        refused = subprocess.run([command, "inspect", bag], capture_output=True, text=True)
        assert refused.returncode == 1
        assert said in refused.stderr
