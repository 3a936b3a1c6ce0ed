"""What a viewer needs of a log, held against what Foxglove and ROS 2 publish of themselves.

Foxglove's own package has its layouts as typed classes; rosbags has the definitions of ROS 2 Jazzy.
"""

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import foxglove.layouts as published
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

LAYOUT = Path(__file__).parents[3] / "docs/umbmark.foxglove.json"
STORE = get_typestore(Stores.ROS2_JAZZY)
# What a layout calls a setting of these types of messages, in Foxglove's package.
SETTINGS: dict[str, Any] = {
    "nav_msgs/msg/Path": published.BaseRendererPosesTopicSettings,
    "nav_msgs/msg/Odometry": published.BaseRendererPoseTopicSettings,
    "geometry_msgs/msg/PoseStamped": published.BaseRendererPoseTopicSettings,
    "visualization_msgs/msg/MarkerArray": published.BaseRendererRosMarkerTopicSettings,
}


@pytest.fixture(scope="module")
def log(command: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a simulated log with bumps."""
    file = tmp_path_factory.mktemp("log") / "run.mcap"
    flags = ["--bump-rate", "0.3", "--side", "1", "--ed", "1.002"]
    subprocess.run([command, "simulate", "-o", file, *flags], check=True, capture_output=True)
    return file


@pytest.fixture(scope="module")
def layout() -> dict[str, Any]:
    """Return the layout that the documentation has."""
    read: dict[str, Any] = json.loads(LAYOUT.read_text())
    return read


def channels(log: Path) -> dict[str, tuple[str, str]]:
    """Return the type and its definition by topic."""
    with log.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    schemas = {
        channel.topic: summary.schemas[channel.schema_id] for channel in summary.channels.values()
    }
    return {topic: (schema.name, schema.data.decode()) for topic, schema in schemas.items()}


def as_published(kind: Any, settings: dict[str, Any], **parts: Any) -> Any:
    """Return settings as one of Foxglove's classes, which takes no key that it does not know."""

    def snake(key: str) -> str:
        return re.sub("[A-Z]", lambda letter: "_" + letter[0].lower(), key)

    keys = {snake(key): value for key, value in settings.items() if snake(key) not in parts}
    return kind(**keys, **parts)


def test_every_definition_is_that_of_ros_2_field_by_field(log: Path) -> None:
    found = channels(log)
    assert {"/scene/errors", "/scene/bumps", "/scene/true_path", "/tf"} <= set(found)
    for name, text in found.values():
        for kind, fields in get_types_from_msg(text, name).items():
            assert fields[1] == STORE.fielddefs[kind][1], f"{kind} within {name}"


def test_the_layout_has_settings_that_foxglove_knows(layout: dict[str, Any], log: Path) -> None:
    found = channels(log)
    panels = layout["configById"]
    scene = panels["3D!umbmark"]
    topics = {
        topic: as_published(SETTINGS[found[topic][0]], settings)
        for topic, settings in scene["topics"].items()
    }
    grid = dict(scene["layers"]["grid"])
    # A key that exported layouts have and the class does not list.
    assert grid.pop("frameLocked") is True
    config = as_published(
        published.ThreeDeeConfig,
        scene,
        topics=topics,
        layers={"grid": as_published(published.BaseRendererGridLayerSettings, grid)},
        camera_state=as_published(published.ThreeDeeCameraState, scene["cameraState"]),
    )
    panel = published.Layout(content=published.ThreeDeePanel(config=config))
    written = json.loads(panel.to_json())["content"]["config"]
    assert written["topics"] == scene["topics"]
    assert written["cameraState"] == scene["cameraState"]
    assert (written["followTf"], written["followMode"]) == ("odom", "follow-none")
    for name in ("Plot!wheels", "Plot!speed"):
        plot = dict(panels[name])
        assert plot.pop("foxglovePanelTitle")
        series = [as_published(published.PlotSeries, path) for path in plot["paths"]]
        as_published(published.PlotConfig, plot, paths=series)
    assert {layout["layout"]["first"], *layout["layout"]["second"].values()} >= set(panels)


def test_what_the_layout_shows_stands_in_the_log(layout: dict[str, Any], log: Path) -> None:
    """Scenes are drawn where a transform to their frame is known at their time."""
    scene = layout["configById"]["3D!umbmark"]
    shown = [topic for topic, settings in scene["topics"].items() if settings["visible"]]
    first: dict[str, Any] = {}
    with log.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages():
            first.setdefault(channel.topic, (message.log_time, decoded))
    time, tf = first["/tf"]
    frames = {tf.transforms[0].header.frame_id, tf.transforms[0].child_frame_id}
    assert scene["followTf"] in frames
    for topic in shown:
        at, message = first[topic]
        headers = [one.header for one in getattr(message, "markers", [message])]
        assert {header.frame_id for header in headers} <= frames, topic
        stamps = [header.stamp.sec * 10**9 + header.stamp.nanosec for header in headers]
        assert min(stamps) >= time, topic
        assert at >= time
    for marker in (first[topic][1].markers[0] for topic in ("/scene/errors", "/scene/bumps")):
        # Lines in pairs of points, or balls; added, opaque, as large as can be seen, for good.
        line_list, sphere_list, add = 5, 7, 0
        assert (marker.action, marker.color.a) == (add, 1.0)
        assert marker.type in (line_list, sphere_list)
        assert marker.type == sphere_list or len(marker.points) % 2 == 0
        assert marker.scale.x > 0
        assert (marker.lifetime.sec, marker.lifetime.nanosec) == (0, 0)
        assert len(marker.points) > 2
    paths = [p["value"] for n in ("wheels", "speed") for p in panel_paths(layout, n)]
    for path in paths:
        topic, *fields = path.split(".")
        value = first[topic][1]
        for field in fields:
            name, _, index = field.partition("[")
            value = getattr(value, name)
            value = value[int(index[:-1])] if index else value
        assert isinstance(value, float)


def panel_paths(layout: dict[str, Any], name: str) -> list[dict[str, Any]]:
    """Return what a plot of the layout draws."""
    paths: list[dict[str, Any]] = layout["configById"][f"Plot!{name}"]["paths"]
    return paths
