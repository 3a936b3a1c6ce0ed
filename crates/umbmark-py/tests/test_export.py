"""Exported files, read by the parsers of the programs that they are for."""

import tomllib
import xml.etree.ElementTree as xml
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import umbmark
import yaml
from urdf_parser_py.urdf import URDF

NOISE = """
[noise]
heading_rad_per_sqrt_m = 0.004
heading_rad_per_sqrt_rad = 0.03
forward_m_per_sqrt_m = 0.005
sideways_m_per_sqrt_m = 0.0002
"""
BOT = """<robot name="bot"><link name="base"/>
  <link name="wl"><collision><geometry><cylinder radius="0.075" length="0.02"/></geometry>
  </collision></link>
  <link name="wr"><collision><geometry><cylinder radius="0.075" length="0.02"/></geometry>
  </collision></link>
  <joint name="left_wheel_joint" type="continuous"><parent link="base"/><child link="wl"/>
    <origin xyz="0 0.17 0" rpy="0 0 0"/><axis xyz="0 1 0"/></joint>
  <joint name="right_wheel_joint" type="continuous"><parent link="base"/><child link="wr"/>
    <origin xyz="0 -0.17 0" rpy="0 0 0"/><axis xyz="0 1 0"/></joint>
</robot>
"""
LEFT, RIGHT = 0.075 * 2 / 2.002, 0.075 * 2 * 1.002 / 2.002
WHEELBASE = 0.34 * 0.99


@pytest.fixture(scope="module")
def model() -> umbmark.Model:
    model = umbmark.Model().add("wheel_diameter_ratio", e_d=1.002).add("wheelbase", e_b=0.99)
    return umbmark.Model.from_toml(model.to_toml() + NOISE)


def parameters(model: umbmark.Model, to: str, node: str) -> dict[str, Any]:
    """Parameters of a node of ROS, by the YAML 1.1 that it reads."""
    read = yaml.safe_load(umbmark.export(model, to=to).text)
    values: dict[str, Any] = read[node]["ros__parameters"]
    return values


def test_ros2_control_reads_doubles_and_lists_of_six_doubles(model: umbmark.Model) -> None:
    read = parameters(model, "ros2_control", "diff_drive_controller")
    twist = read.pop("twist_covariance_diagonal")
    pose = read.pop("pose_covariance_diagonal")
    assert all(isinstance(value, float) for value in read.values())
    assert (read["wheel_radius"], read["wheel_separation"]) == (0.075, 0.34)
    assert np.isclose(read["left_wheel_radius_multiplier"], LEFT / 0.075, rtol=1e-8)
    assert all(isinstance(value, float) for value in [*twist, *pose])
    assert np.allclose(twist[5], 50 * (0.004**2 * 0.2 + 0.03**2 * 0.5))
    assert np.allclose([twist[0], pose[5]], [50 * 0.005**2 * 0.2, 0.004**2 * 10])


def test_amcl_and_robot_localization_read_their_numbers(model: umbmark.Model) -> None:
    amcl = parameters(model, "amcl", "amcl")
    alphas = [amcl[f"alpha{i}"] for i in range(1, 6)]
    expected = [0.03**2 / 0.2, 0.004**2 / 0.5, 0.005**2 / 0.25, 0.0, 0.0002**2 / 0.25]
    assert np.allclose(alphas, expected, rtol=1e-5)
    ekf = parameters(model, "robot_localization", "ekf_filter_node")
    fused = ekf["odom0_config"]
    assert [i for i, flag in enumerate(fused) if flag] == [6, 7, 11]
    assert len(fused) == 15
    noise = np.array(ekf["process_noise_covariance"]).reshape(15, 15)
    assert noise.dtype == float
    assert np.count_nonzero(noise) == 15


def test_mujoco_loads_the_robot_and_it_drives_straight_and_turns(model: umbmark.Model) -> None:
    twin = mujoco.MjModel.from_xml_string(umbmark.export(model, to="mujoco").text)
    sides = ("left", "right")
    radii = [twin.geom(f"{side}_wheel").size[0] for side in sides]
    assert np.allclose(radii, [LEFT, RIGHT], atol=1e-9)
    places = [twin.body(f"{side}_wheel").pos[1] for side in sides]
    assert np.allclose(places, [WHEELBASE / 2, -WHEELBASE / 2], atol=1e-9)
    assert np.isclose(twin.numeric("heading_noise_rad_per_sqrt_m").data[0], 0.004)
    state = mujoco.MjData(twin)
    state.ctrl[:] = 4.0
    for _ in range(2000):
        mujoco.mj_step(twin, state)
    assert state.qpos[0] > 0.8
    assert abs(state.qpos[1]) < 0.1
    state.ctrl[:] = [-2.0, 2.0]
    for _ in range(1000):
        mujoco.mj_step(twin, state)
    assert state.qvel[5] > 0.3


def test_urdf_has_the_corrected_wheels_and_their_distance(
    model: umbmark.Model, tmp_path: Path
) -> None:
    file = tmp_path / "bot.urdf"
    file.write_text(BOT)
    written = umbmark.export(model, to="urdf", urdf=file)
    robot = URDF.from_xml_string(written.text)
    places = [robot.joint_map[f"{side}_wheel_joint"].origin.xyz[1] for side in ("left", "right")]
    assert np.allclose(places, [WHEELBASE / 2, -WHEELBASE / 2], atol=1e-9)
    radii = [robot.link_map[name].collision.geometry.radius for name in ("wl", "wr")]
    assert np.allclose(radii, [LEFT, RIGHT], atol=1e-9)
    assert not written.notes


def test_gazebo_has_the_elements_of_its_plugins(model: umbmark.Model) -> None:
    drive, publisher = xml.fromstring(umbmark.export(model, to="gazebo").text).iter("plugin")
    assert drive.get("name") == "gz::sim::systems::DiffDrive"
    assert np.isclose(float(drive.findtext("wheel_separation", "")), WHEELBASE)
    assert np.isclose(float(drive.findtext("wheel_radius", "")), (LEFT + RIGHT) / 2)
    turn = float(publisher.findtext("gaussian_noise", ""))
    assert np.isclose(turn**2, 50 * (0.004**2 * 0.2 + 0.03**2 * 0.5), rtol=1e-5)


def test_robot_file_and_its_path_read_back(model: umbmark.Model) -> None:
    path = umbmark.Path("square", side_m=2.0)
    read = tomllib.loads(umbmark.export(model, to="toml", path=path).text)
    assert np.isclose(read["robot"]["wheelbase_m"], WHEELBASE)
    assert read["path"]["side_m"] == 2.0


def test_the_table_holds_start_noise_and_effects_and_both_languages_have_the_same(
    model: umbmark.Model,
) -> None:
    tables = []
    for to in ("embedded", "embedded_rust"):
        text = umbmark.export(model, to=to, start=(1.5, -2.0, 0.25)).text
        rows = [line.split("/")[0] for line in text.splitlines() if line.startswith("    ")]
        tables.append([float(cell) for row in rows for cell in row.split(",") if cell.strip()])
    table, other = tables
    assert table == other
    assert table[2] == len(table)
    assert table[17:20] == [1.5, -2.0, 0.25]
    assert table[20:25] == [1.0, 0.004, 0.03, 0.005, 0.0002]
    assert table[25:] == [2.0, 4.0, 1.002, 5.0, 0.99]
    with pytest.raises(ValueError, match="start must be three finite numbers"):
        umbmark.export(model, to="embedded", start=(float("nan"), 0.0, 0.0))


def test_what_cannot_be_written_is_refused_with_what_to_do(model: umbmark.Model) -> None:
    with pytest.raises(ValueError, match="to must be one of ros2_control, amcl"):
        umbmark.export(model, to="ros")
    with pytest.raises(ValueError, match=r"amcl: no covariances: the model has no \[noise\]"):
        umbmark.export(umbmark.Model(), to="amcl")
    with pytest.raises(ValueError, match="rate_hz must be between"):
        umbmark.export(model, to="c", rate_hz=float("nan"))
    with pytest.raises(ValueError, match="joints must be two names"):
        umbmark.export(model, to="urdf", urdf="bot.urdf", joints=["left"])
