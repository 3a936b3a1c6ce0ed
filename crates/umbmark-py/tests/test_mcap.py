"""MCAP logs that other packages write are read as the CSV of the same runs, and they read ours."""

import json
import math
import random
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from mcap.reader import make_reader
from mcap.writer import CompressionType
from mcap.writer import Writer as PlainWriter
from mcap_protobuf.writer import Writer as ProtobufWriter
from mcap_ros2.decoder import DecoderFactory
from mcap_ros2.writer import Writer as Ros2Writer
from recorded import (
    TICKS_PER_REVOLUTION,
    Row,
    answer,
    assert_calibrates_alike,
    record,
    rows,
)
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

ROOT = Path(__file__).parents[3]
STORE = get_typestore(Stores.ROS2_JAZZY)
NO_RATES: dict[str, list[float]] = {"velocity": [], "effort": []}


def definition(name: str) -> str:
    return STORE.generate_msgdef(name, ros_version=2)[0]


def write_ros2(compression: CompressionType, chunked: bool) -> Callable[[Path, list[Row]], None]:
    """Write with mcap-ros2-support."""

    def write(file: Path, log: list[Row]) -> None:
        with file.open("wb") as stream:
            writer = Ros2Writer(
                stream, compression=compression, chunk_size=50_000 if chunked else 1 << 30
            )
            names = ["sensor_msgs/msg/JointState", "geometry_msgs/msg/PoseStamped"]
            joints, poses = [writer.register_msgdef(name, definition(name)) for name in names]
            for row in log:
                times = {"log_time": row.stamp + 5_000_000, "publish_time": row.stamp}
                header = {"stamp": row.time, "frame_id": "map"}
                right, left = reversed(row.positions)
                state = {
                    "header": header,
                    "name": ["arm", "wheel_right_joint", "wheel_left_joint"],
                    "position": [0.1, right, left],
                    **NO_RATES,
                }
                writer.write_message("/joint_states", joints, state, **times)
                if row.pose:
                    position = {"x": row.pose[0], "y": row.pose[1], "z": 0.2}
                    pose = {"position": position, "orientation": row.quaternion}
                    writer.write_message("/mocap", poses, {"header": header, "pose": pose}, **times)
            writer.finish()  # type: ignore[no-untyped-call]

    return write


def write_rosbags(file: Path, log: list[Row]) -> None:
    """Write with rosbags: counts of the wheels in a type of one's own, poses in TF."""
    own = "demo_msgs/msg/WheelTicks"
    from rosbags.typesys import get_types_from_msg

    text = "std_msgs/Header header\nint64 ticks_left\nint64 ticks_right\n"
    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg(text, own))
    t = store.types
    bag = file.with_suffix("")
    with BagWriter(bag, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        ticks = writer.add_connection("/ticks", own, typestore=store)
        tf = writer.add_connection("/tf", "tf2_msgs/msg/TFMessage", typestore=store)
        for row in log:
            stamp = t["builtin_interfaces/msg/Time"](**row.time)
            header = t["std_msgs/msg/Header"](stamp, "world")
            message = t[own](header, row.left, row.right)
            writer.write(ticks, row.stamp, store.serialize_cdr(message, own))
            if row.pose:
                translation = t["geometry_msgs/msg/Vector3"](row.pose[0], row.pose[1], 0.0)
                rotation = t["geometry_msgs/msg/Quaternion"](**row.quaternion)
                transform = t["geometry_msgs/msg/Transform"](translation, rotation)
                stamped = t["geometry_msgs/msg/TransformStamped"](header, "base_link", transform)
                tfs = t["tf2_msgs/msg/TFMessage"]([stamped])
                writer.write(tf, row.stamp, store.serialize_cdr(tfs, "tf2_msgs/msg/TFMessage"))
    shutil.move(next(bag.glob("*.mcap")), file)
    shutil.rmtree(bag)


def write_json(file: Path, log: list[Row]) -> None:
    """Write JSON with mcap."""
    with file.open("wb") as stream:
        writer = PlainWriter(stream, compression=CompressionType.LZ4)
        writer.start()
        properties = {"left": {"type": "integer"}, "right": {"type": "integer"}}
        schemas = {
            "/ticks": ("wheel_ticks", {"type": "object", "properties": properties}),
            "/mocap": ("foxglove.PoseInFrame", {"type": "object"}),
        }
        channels = {}
        for topic, (name, schema) in schemas.items():
            number = writer.register_schema(name, "jsonschema", json.dumps(schema).encode())
            channels[topic] = writer.register_channel(topic, "json", number)

        def add(topic: str, stamp: int, message: dict[str, Any]) -> None:
            data = json.dumps(message).encode()
            writer.add_message(channels[topic], log_time=stamp, publish_time=stamp, data=data)

        for row in log:
            add("/ticks", row.stamp, {"left": row.left, "right": row.right})
            if row.pose:
                time = {"sec": row.stamp // 10**9, "nsec": row.stamp % 10**9}
                position = {"x": row.pose[0], "y": row.pose[1], "z": 0.0}
                pose = {"position": position, "orientation": row.quaternion}
                message = {"timestamp": time, "frame_id": "map", "pose": pose}
                add("/mocap", row.stamp, message)
        writer.finish()  # type: ignore[no-untyped-call]


def write_protobuf(file: Path, log: list[Row]) -> None:
    """Write poses with mcap-protobuf-support, counts in JSON."""
    with file.open("wb") as stream, ProtobufWriter(stream) as writer:
        plain = writer._writer
        properties = {"ticks_left": {"type": "integer"}, "ticks_right": {"type": "integer"}}
        schema = json.dumps({"type": "object", "properties": properties}).encode()
        number = plain.register_schema("wheel_ticks", "jsonschema", schema)
        channel = plain.register_channel("/ticks", "json", number)
        for row in log:
            data = json.dumps({"ticks_left": row.left, "ticks_right": row.right}).encode()
            plain.add_message(channel, log_time=row.stamp, publish_time=row.stamp, data=data)
            if row.pose:
                pose = PoseInFrame(frame_id="map")
                pose.timestamp.FromNanoseconds(row.stamp)
                pose.pose.position.x, pose.pose.position.y = row.pose[:2]
                for name, value in row.quaternion.items():
                    setattr(pose.pose.orientation, name, value)
                writer.write_message("/mocap", pose, log_time=row.stamp, publish_time=row.stamp)


WRITERS = {
    "mcap-ros2-support, zstd": write_ros2(CompressionType.ZSTD, chunked=True),
    "mcap-ros2-support, lz4": write_ros2(CompressionType.LZ4, chunked=True),
    "mcap-ros2-support, not packed, one chunk": write_ros2(CompressionType.NONE, chunked=False),
    "rosbags": write_rosbags,
    "mcap, JSON": write_json,
    "mcap-protobuf-support": write_protobuf,
}


@pytest.mark.parametrize("writer", WRITERS)
def test_what_other_packages_write_calibrates_as_the_csv_does(
    writer: str, command: Path, measured: Path, tmp_path: Path
) -> None:
    def write(place: Path, log: list[Row]) -> None:
        WRITERS[writer](place.with_suffix(".mcap"), log)

    folder = record(measured, tmp_path, write)
    assert_calibrates_alike(command, measured, folder)


@pytest.fixture(scope="session")
def written(command: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """Return a log that umbmark wrote, and what it said of it."""
    file = tmp_path_factory.mktemp("written") / "run.mcap"
    said = answer(
        command, "simulate", "-o", file, "--side", "1", "--eb", "1.01", "--direction", "cw"
    )
    return file, said


def peak_memory(process: subprocess.Popen[bytes]) -> float:
    """The most memory that a process had until it ended [bytes].

    Not from its resource usage, which begins with the memory of this interpreter.
    """
    status, most = Path(f"/proc/{process.pid}/status"), 0.0
    while process.poll() is None:
        if found := re.search(r"VmHWM:\s*(\d+) kB", status.read_text()):
            most = 1024 * float(found[1])
        time.sleep(0.005)
    return most


@pytest.mark.skipif(sys.platform != "linux", reason="memory is read from /proc")
def test_a_log_with_a_camera_takes_little_memory(
    command: Path, measured: Path, tmp_path: Path
) -> None:
    file = tmp_path / "run.mcap"
    with file.open("wb") as stream:
        writer = Ros2Writer(stream, compression=CompressionType.ZSTD)
        names = ["sensor_msgs/msg/JointState", "std_msgs/msg/ByteMultiArray"]
        joints, images = [writer.register_msgdef(name, definition(name)) for name in names]
        layout = {"dim": [], "data_offset": 0}
        image = {"layout": layout, "data": random.Random(1).randbytes(1 << 20)}
        log = list(rows(measured / "runs" / "ccw_01.csv"))
        for number, row in enumerate(log):
            names = ["left_wheel", "right_wheel"]
            header = {"stamp": row.time, "frame_id": ""}
            state = {"header": header, "name": names, "position": row.positions}
            writer.write_message("/joint_states", joints, state | NO_RATES, log_time=row.stamp)
            if number % 5 == 0:
                writer.write_message("/camera", images, image, log_time=row.stamp)
        writer.finish()  # type: ignore[no-untyped-call]
    shutil.copy(measured / "robot.toml", tmp_path)
    with (tmp_path / "out.json").open("wb") as out:
        process = subprocess.Popen([command, "inspect", file, "--json"], stdout=out)
        most = peak_memory(process)
    assert process.returncode == 0
    said = json.loads((tmp_path / "out.json").read_text())
    assert said["logs"][0]["rows"] == len(log)
    assert file.stat().st_size > 200e6
    assert 0 < most < 150e6, "more than a chunk or two"


TOPICS = {
    "/joint_states": "sensor_msgs/msg/JointState",
    "/odom": "nav_msgs/msg/Odometry",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/ground_truth": "geometry_msgs/msg/PoseStamped",
    "/scene/computed_path": "nav_msgs/msg/Path",
    "/scene/true_path": "nav_msgs/msg/Path",
    "/scene/errors": "visualization_msgs/msg/MarkerArray",
}


def check(messages: dict[str, list[Any]], said: dict[str, Any]) -> None:
    """Hold what was read against what umbmark said: whole ticks, and the return error."""
    scale = TICKS_PER_REVOLUTION / math.tau
    ticks = [scale * p for message in messages["/joint_states"] for p in message.position]
    assert max(abs(tick - round(tick)) for tick in ticks) < 1e-6
    assert len(messages["/odom"]) == len(messages["/tf"]) == len(messages["/joint_states"]) > 1000
    true, computed = messages["/ground_truth"][-1].pose, messages["/odom"][-1].pose.pose
    transform = messages["/tf"][-1].transforms[0].transform
    assert (transform.translation.x, transform.rotation.z) == (
        computed.position.x,
        computed.orientation.z,
    )
    run = said["runs"][0]
    assert true.position.x - computed.position.x == pytest.approx(run["ex_m"], abs=1e-12)
    assert true.position.y - computed.position.y == pytest.approx(run["ey_m"], abs=1e-12)
    turn = [2 * math.atan2(p.orientation.z, p.orientation.w) for p in (true, computed)]
    assert math.remainder(turn[0] - turn[1] - run["etheta_rad"], math.tau) == pytest.approx(
        0, abs=1e-12
    )


def test_mcap_ros2_support_reads_what_umbmark_writes(written: tuple[Path, dict[str, Any]]) -> None:
    file, said = written
    messages: dict[str, list[Any]] = {}
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()], validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            assert schema is not None
            assert schema.name == TOPICS[channel.topic]
            first = {"/tf": "transforms", "/scene/errors": "markers"}.get(channel.topic)
            stamp = (getattr(decoded, first)[0] if first else decoded).header.stamp
            assert stamp.sec * 10**9 + stamp.nanosec == message.log_time
            messages.setdefault(channel.topic, []).append(decoded)
        summary = reader.get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == sum(map(len, messages.values()))
    check(messages, said)


def test_rosbags_reads_what_umbmark_writes(written: tuple[Path, dict[str, Any]]) -> None:
    file, said = written
    messages: dict[str, list[Any]] = {}
    with AnyReader([file]) as reader:
        assert {c.topic: c.msgtype for c in reader.connections} == TOPICS
        for connection, _, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            messages.setdefault(connection.topic, []).append(message)
    check(messages, said)


def test_bumps_that_a_simulated_run_met_lie_beside_its_path(command: Path, tmp_path: Path) -> None:
    file = tmp_path / "bumps.mcap"
    flags = ["--bump-rate", "0.3", "--wheel-noise", "0", "--reference-rate", "20"]
    subprocess.run([command, "simulate", "-o", file, *flags], check=True, capture_output=True)
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        topics = ["/scene/bumps", "/scene/true_path"]
        found = {c.topic: d for _, c, _, d in reader.iter_decoded_messages(topics)}
    (marker,) = found["/scene/bumps"].markers
    sphere_list, half_wheelbase = 7, 0.17
    assert marker.type == sphere_list
    assert len(marker.points) > 3
    way = [(at.pose.position.x, at.pose.position.y) for at in found["/scene/true_path"].poses]
    aside = [min(math.dist((b.x, b.y), place) for place in way) for b in marker.points]
    assert max(aside) == pytest.approx(half_wheelbase, abs=0.02)
