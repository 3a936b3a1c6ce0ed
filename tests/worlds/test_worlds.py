"""The worlds are what their names say, and a seed decides every byte."""

import json
from dataclasses import replace
from math import cos, hypot, pi, sin
from pathlib import Path as File
from typing import Any

import numpy as np
import pytest
import unlisted
import words
from files import truth, write
from judge import judged
from laws import SHAPES, added_turn, scrubbed, wheel_travel
from make import make
from record import Log, Made, driven, setting_of
from replay import left, rms_m
from setting import Array, Laws
from tracker import turned
from worlds import WORLDS

SHORT = ["runs=2", "run_s=15", "control_period_s=0.02"]
EXACT = [
    "wheel_noise_sqrt_m=0",
    "heading_noise_rad_sqrt_m=0",
    "position_noise_m=2e-4",
    "heading_noise_rad=2e-4",
    "noise=gaussian",
    "stamp_noise_s=0",
    "ticks_per_revolution=50000",
    "tick_rate_hz=100",
    "reference_rate_hz=25",
    "layout=same",
]
"""Little noise, and no poses in rows of another time."""
DRIFTS = {"scanmatch", "slam", "command"}
"""Worlds whose measured poses do not stay near those of the wheels."""


def made(world: str, seed: int = 3, *overrides: str) -> Made:
    """A small world."""
    return make(world, seed, [*SHORT, *overrides])


def both(world: str, *overrides: str) -> tuple[list[Log], list[Log]]:
    """The logs of a world, and of the same with something taken away."""
    return made(world).logs, made(world, 3, *overrides).logs


def with_pose(log: Log) -> Array:
    return log.pose[np.isfinite(log.pose[:, 0])]


def folder_bytes(folder: File) -> dict[str, bytes]:
    files = [file for file in folder.rglob("*") if file.is_file()]
    return {str(file.relative_to(folder)): file.read_bytes() for file in files}


@pytest.mark.parametrize("world", sorted(set(WORLDS) - DRIFTS - {"heading_walk", "stretched"}))
def test_the_truth_replays_to_the_measured_poses_within_noise(world: str, tmp_path: File) -> None:
    write(made(world, 4, *EXACT), tmp_path)
    assert rms_m(left(tmp_path), with_glitches=False) < 2e-3


@pytest.mark.parametrize("world", sorted(DRIFTS))
def test_a_reference_that_drifts_leaves_the_wheels_behind(world: str, tmp_path: File) -> None:
    write(made(world, 4, *EXACT, "run_s=60"), tmp_path)
    assert rms_m(left(tmp_path)) > 5e-3


def test_headings_walk_away_beside_positions_that_stay() -> None:
    walking, steady = both("heading_walk", "heading_walk_rad_sqrt_s=0")
    for one, other in zip(walking, steady, strict=True):
        off = with_pose(one) - with_pose(other)
        turned = np.unwrap(off[:, 2])
        assert np.abs(np.diff(turned)).max() < 0.03 < np.ptp(turned)
        assert off[:, :2] == pytest.approx(0, abs=0.03)


def test_a_stretched_picture_is_longer_along_one_axis_and_shorter_along_the_other() -> None:
    seen = made("stretched", 3, "stretch_along=0.01", "stretch_diagonal=0.004").logs
    true = made("stretched", 3, "stretch_along=0", "stretch_diagonal=0").logs
    for one, other in zip(seen, true, strict=True):
        place = with_pose(other)[:, :2]
        off = with_pose(one)[:, :2] - place
        expected = np.column_stack(
            [0.01 * place[:, 0] + 0.004 * place[:, 1], 0.004 * place[:, 0] - 0.01 * place[:, 1]]
        )
        assert np.abs(off).max() > 5e-3
        assert off == pytest.approx(expected, abs=3e-4)


def test_poses_that_are_filled_in_lie_on_lines_between_the_others() -> None:
    for log in made("filled_in", 3, "filled_in_poses=5", *EXACT).logs:
        place = with_pose(log)[:60, :2].reshape(12, 5, 2)
        assert np.diff(place, n=2, axis=1) == pytest.approx(0.0, abs=2e-3)


@pytest.mark.parametrize("world", ["null", "combined", "one_long", "interleaved"])
def test_the_same_seed_gives_the_same_bytes_and_another_seed_others(
    world: str, tmp_path: File
) -> None:
    layout = ["layout=interleaved"] if world == "interleaved" else []
    name = "null" if layout else world
    for folder, seed in (("a", 1), ("b", 1), ("c", 2)):
        write(made(name, seed, *layout), tmp_path / folder)
    a, b, c = (folder_bytes(tmp_path / folder) for folder in "abc")
    assert a == b
    assert a["robot.toml"] != c["robot.toml"]


def drive_of(kind: str, *overrides: str) -> tuple[Array, Array]:
    """Wheel travel by nominal sizes [2 x rows] and true poses of one exact drive from zero."""
    changes = [f"kind={kind}", "controller=open", "start=origin", "e_d=1", "e_b=1", "e_s=1"]
    one = make("null", 1, [*SHORT, *EXACT, *changes, "first_count=0", *overrides])
    robot, log = one.setting.robot, one.logs[0]
    return log.counts.T * robot.tick_rad * robot.nominal_radius_m, log.body


def test_e_d_above_one_turns_a_straight_to_the_left() -> None:
    travel, body = drive_of("back_and_forth", "e_d=1.01")
    first = int(np.argmax(travel[0] > 0.3))
    wheelbase = make("null", 1, SHORT).setting.robot.wheelbase_m
    expected = 0.01 / 1.005 * travel[:, first].mean() / wheelbase
    assert body[first, 2] == pytest.approx(expected, rel=0.01)


def test_e_b_above_one_turns_less_than_the_nominal_robot() -> None:
    travel, body = drive_of("spins", "e_b=1.05")
    wheelbase = make("null", 1, SHORT).setting.robot.wheelbase_m
    turn = (travel[1] - travel[0]) / wheelbase
    most = int(np.argmax(np.abs(turn)))
    assert body[most, 2] == pytest.approx(turn[most] / 1.05, rel=1e-3)


def test_e_s_above_one_drives_farther_than_the_nominal_robot() -> None:
    travel, body = drive_of("straights", "e_s=1.02")
    most = int(np.argmax(travel[0]))
    assert hypot(*body[most, :2]) == pytest.approx(1.02 * travel[:, most].mean(), rel=1e-3)


COLUMNS = {
    "exchanged": (["exchanged=false"], [[0, 1], [1, 0]]),
    "left_reversed": (["left_reversed=false"], [[-1, 0], [0, 1]]),
    "right_reversed": (["right_reversed=false"], [[1, 0], [0, -1]]),
    "left_doubled": (["left_extra_edges=0"], [[2, 0], [0, 1]]),
    "both_reversed": (["left_reversed=false", "right_reversed=false"], [[-1, 0], [0, -1]]),
    "exchanged_reversed": (
        ["exchanged=false", "left_reversed=false", "right_reversed=false"],
        [[0, -1], [-1, 0]],
    ),
}


@pytest.mark.parametrize("world", COLUMNS)
def test_ticks_stand_in_the_columns_that_the_world_says(world: str) -> None:
    without, matrix = COLUMNS[world]
    for wrong, right in zip(*both(world, *without), strict=True):
        np.testing.assert_array_equal(wrong.counts, right.counts @ np.array(matrix))
        np.testing.assert_array_equal(wrong.pose, right.pose)


def frames(pose: Array) -> dict[str, Array]:
    """What each fault of frames and units makes of poses."""
    x, y, heading = pose.T
    return {
        "heading_clockwise": np.column_stack([x, y, -heading]),
        "mirrored": np.column_stack([x, -y, -heading]),
        "compass": np.column_stack([x, y, pi / 2 - heading]),
        "mm_as_m": np.column_stack([1000 * x, 1000 * y, heading]),
        "deg_as_rad": np.column_stack([x, y, np.degrees(heading)]),
    }


@pytest.mark.parametrize("world", frames(np.zeros((1, 3))))
def test_poses_stand_in_the_frame_and_units_that_the_world_says(world: str) -> None:
    changes = [*SHORT, "wrap=false"]
    wrong = make(world, 3, changes).logs[0]
    right = make(world, 3, [*changes, f"{world}=false"]).logs[0]
    np.testing.assert_allclose(with_pose(wrong), frames(with_pose(right))[world], atol=1e-9)
    np.testing.assert_array_equal(wrong.counts, right.counts)


def test_a_positive_delay_shows_where_the_robot_was() -> None:
    at_rest = ["start=room", *EXACT, "delay_scatter_s=0"]
    late = made("delay", 3, *at_rest, "delay_s=0.1").logs[0]
    seen = np.isfinite(late.true[:, 0])
    was = np.interp(late.stamp_s[seen] - 0.1, late.stamp_s, late.body[:, 0])
    np.testing.assert_allclose(late.true[seen, 0], was, atol=2e-3)


def test_the_tracked_point_lies_where_lever_and_yaw_say() -> None:
    changes = ["start=room", "lever_forward_m=0.1", "lever_left_m=-0.05", "yaw_rad=0.3"]
    log = made("lever", 3, *EXACT, *changes).logs[0]
    seen = np.isfinite(log.true[:, 0])
    body, true = log.body[seen], log.true[seen]
    lever = turned(true[:, :2] - body[:, :2], -body[:, 2])
    np.testing.assert_allclose(lever, np.tile([0.1, -0.05], (len(lever), 1)), atol=1e-3)
    np.testing.assert_allclose(true[:, 2] - body[:, 2], 0.3, atol=1e-3)


@pytest.mark.parametrize("of", ["robot", "reference"])
def test_a_jump_moves_and_turns_the_measured_poses_by_what_the_truth_says(of: str) -> None:
    changes = ["jumping_share=1", "start=room", f"jump_of={of}", "kind=joystick"]
    world = made("jumps", 3, *EXACT, *changes, "controller=open", "reference_rate_hz=100")
    jumps = truth(world)["jumps"]
    assert {jump["run"] for jump in jumps} == {"run_01", "run_02"}
    for jump in jumps:
        log = next(one for one in world.logs if one.name == jump["run"])
        after = int(np.searchsorted(log.stamp_s, jump["time_s"] + 0.05))
        change = log.true[after] - log.true[after - 10]
        assert hypot(*change[:2]) == pytest.approx(jump["moved_m"], abs=0.1)
        assert change[2] == pytest.approx(jump["turned_rad"], abs=0.15)


def test_glitches_are_off_by_5_cm_at_least_and_as_many_as_the_truth_says() -> None:
    world = made("glitches", 3, *EXACT, "glitch_share=0.03", "run_s=60")
    for log in world.logs:
        off = np.hypot(*(log.pose - log.true)[:, :2].T)
        assert off[log.bad > 0].min() > 0.045
        assert np.nanmax(off[log.bad == 0]) < 0.002
        assert len(truth(world)["glitches"][log.name]) == log.bad.sum() > 0


def test_a_late_start_has_turning_wheels_before_the_first_pose() -> None:
    for log in made("late_start", 3, "kind=joystick").logs:
        first = int(np.argmax(np.isfinite(log.pose[:, 0])))
        assert log.stamp_s[first] >= 2
        assert np.abs(log.counts[first] - log.counts[0]).max() > 0


def test_a_moving_start_moves_at_once() -> None:
    logs = made("moving_start", 3, "kind=joystick", "tick_rate_hz=50").logs
    assert all(np.abs(log.counts[25] - log.counts[0]).max() > 0 for log in logs)


def test_gaps_are_there() -> None:
    for log in made("gaps", 3, "run_s=60").logs:
        assert np.diff(log.stamp_s[np.isfinite(log.pose[:, 0])]).max() > 0.5


def test_sparse_poses_are_taken_at_rest() -> None:
    for log in made("sparse", 3, *EXACT, "run_s=40").logs:
        seen = np.isfinite(log.pose[:, 0])
        assert 2 <= seen.sum() <= 100
        speed = np.gradient(log.counts[:, 0], log.stamp_s)
        assert np.abs(speed[seen]).max() < 0.01 * np.abs(speed).max()


def test_the_pieces_of_a_long_drive_are_its_rows() -> None:
    whole = make("one_long", 2, ["run_s=60"]).logs[0]
    pieces = make("long_pieces", 2, ["run_s=60"]).logs
    assert len(pieces) == 8
    np.testing.assert_array_equal(np.concatenate([one.stamp_s for one in pieces]), whole.stamp_s)
    np.testing.assert_array_equal(np.concatenate([one.pose for one in pieces]), whole.pose)
    np.testing.assert_array_equal(np.concatenate([one.counts for one in pieces]), whole.counts)


def test_squares_and_circles_alone_have_names_of_a_direction() -> None:
    for kind, names in (("squares", ["ccw_01", "cw_01"]), ("joystick", ["run_01", "run_02"])):
        logs = made("null", 3, f"kind={kind}", "controller=open").logs
        assert [log.name for log in logs] == names


def test_a_wrong_key_is_refused() -> None:
    with pytest.raises(ValueError, match="no 'colour'"):
        make("null", 1, ["colour=1"])


def test_a_reference_in_the_frame_of_start_begins_at_zero() -> None:
    world = made("lever", 3, *EXACT, "start=origin", "rest_s=1", "reference_rate_hz=100")
    for log in world.logs:
        np.testing.assert_allclose(with_pose(log)[0], 0, atol=2e-3)


def test_a_slipping_wheel_loses_its_share_per_speed() -> None:
    rolled, still = np.full((2, 1), 0.1), np.zeros((2, 1))
    radii = np.array([[0.05], [0.06]])
    travel = wheel_travel(Laws(slip_s_m=0.1), rolled, still, radii, 0.01)
    np.testing.assert_allclose(travel[:, 0], [0.005 * (1 - 0.1 * 0.5), 0.006 * (1 - 0.1 * 0.6)])


def test_both_wheels_slip_by_the_speed_between_them_or_lose_way_alone() -> None:
    rolled, still = np.full((2, 1), 0.1), np.zeros((2, 1))
    radii = np.array([[0.05], [0.06]])
    travel = wheel_travel(Laws(body_slip_s_m=0.1), rolled, still, radii, 0.01)
    np.testing.assert_allclose(travel[:, 0], np.array([0.005, 0.006]) * (1 - 0.1 * 0.55))
    travel = wheel_travel(Laws(forward_slip_s_m=0.1), rolled, still, radii, 0.01)
    np.testing.assert_allclose(travel[:, 0], np.array([0.005, 0.006]) - 0.1 * 0.55 * 0.0055)


def test_slip_by_the_square_of_the_speed_takes_its_share_of_each_wheel_or_of_the_way() -> None:
    rolled, still = np.full((2, 1), 0.1), np.zeros((2, 1))
    radii = np.array([[0.05], [0.06]])
    travel = wheel_travel(Laws(squared_slip_s2_m2=0.1), rolled, still, radii, 0.01)
    shares = np.array([1 - 0.1 * 0.25, 1 - 0.1 * 0.36])
    np.testing.assert_allclose(travel[:, 0], np.array([0.005, 0.006]) * shares)
    travel = wheel_travel(Laws(squared_forward_slip_s2_m2=0.1), rolled, still, radii, 0.01)
    lost = 0.1 * 0.55**2 * 0.0055
    np.testing.assert_allclose(travel[:, 0], np.array([0.005, 0.006]) - lost)


def test_a_wheel_that_is_not_round_is_right_after_each_turn() -> None:
    angle = (np.arange(1000) + 0.5) * 2 * pi / 1000
    rolled = np.full((2, 1000), 2 * pi / 1000)
    laws = Laws(eccentricity_right_m=0.001, eccentricity_phase_rad=0.4)
    travel = wheel_travel(laws, rolled, np.stack([angle, angle]), np.full((2, 1), 0.05), 0.01)
    off = (travel - 0.05 * rolled).cumsum(axis=1)
    np.testing.assert_allclose(off[0], 0, atol=1e-12)
    assert off[1, -1] == pytest.approx(0, abs=1e-9)
    assert np.ptp(off[1]) == pytest.approx(0.002, rel=1e-3)


def test_turns_on_the_spot_lose_more_than_arcs_and_fast_ones_more_than_slow_ones() -> None:
    laws = Laws(scrub_s_rad=0.05)
    turn, forward = np.array([0.01, -0.02, 0.01]), np.array([0.0, 0.0, 0.01])
    left_over = scrubbed(laws, forward, turn, 0.4, 0.01)
    np.testing.assert_allclose(left_over[:2], [0.01 * 0.95, -0.02 * 0.9])
    assert left_over[2] == pytest.approx(0.01 * (1 - 0.05 * 0.002 / 0.012))


def test_a_wave_turns_a_moving_robot_alone() -> None:
    time_s = np.linspace(0.005, 4.995, 500)
    forward = np.full(500, 0.01)
    for moves, expected in ((1.0, 0.01 * 20 / (2 * pi)), (0.0, 0.0)):
        laws = Laws(wave_rad_s=0.01, wave_period_s=20)
        travel = np.stack([forward, forward]) * moves
        turn = added_turn(laws, travel, forward * moves, 0 * forward, time_s, 0.01)
        assert turn.sum() == pytest.approx(expected, rel=1e-4)


# What the study makes of answers.


def answered(**learn: object) -> dict[str, dict[str, object]]:
    """Answers in which only `learn` says something."""
    return {"learn": {"exit": 0, "answer": learn, "stderr": "", "seconds": 1.0}}


def test_a_fault_is_named_by_words_of_a_sentence() -> None:
    assert words.named("left_reversed", "the left wheel counts backward")
    assert words.named("exchanged", "left and right are exchanged")
    assert not words.named("left_reversed", "the left wheel is small. turn backward")
    assert set(words.FAULTS) >= {"compass", "mirrored", "mm_as_m", "deg_as_rad"}


def test_moments_are_found_in_objects_and_in_sentences() -> None:
    answer = {
        "outliers": [{"run": "run_01", "time_s": 3.5}],
        "remarks": ["In cw_02 the robot jumps at 12.25 s by 0.3 m."],
    }
    assert words.moments(answer) == [("run_01", 3.5), ("cw_02", 12.25)]


def test_a_wrong_number_that_is_said_to_be_explained_weighs_most() -> None:
    known = truth(made("null", 3))
    learn = {
        "verdict": "explained",
        "steps": [{"added": None, "class": [], "heldout_rmse_m": 0.01, "rmse_m": 0.01}],
        "fitted": [
            {
                "effect": "scale",
                "parameter": "e_s",
                "value": known["e_s"] + 0.01,
                "standard_error": 1e-4,
            }
        ],
    }
    found = judged(answered(**learn), known, 0.01)
    assert found["ratios"]["e_s"]["standard_errors"] == pytest.approx(100)
    assert [weight for weight, _ in found["problems"]] == [3]


def test_a_truth_file_is_json_and_says_its_conventions() -> None:
    text = json.dumps(truth(made("combined")))
    assert "older than its stamp" in json.loads(text)["conventions"]["delay_s"]


def test_a_slope_turns_by_the_heading_in_the_room() -> None:
    changes = ["kind=straights", "controller=open", "slope_cosine_rad_m=0.02", "start=room"]
    still = ["slope_sine_rad_m=0", "e_d=1", "e_b=1", "e_s=1"]
    world = made("slope_yaw", 3, *EXACT, *changes, *still)
    robot, log = world.setting.robot, world.logs[0]
    metres = (log.counts - log.counts[0]).mean(axis=1) * robot.tick_rad * robot.nominal_radius_m
    row = int(np.argmax(metres > 0.1))
    heading = log.body[0, 2]
    assert log.body[row, 2] - heading == pytest.approx(0.02 * cos(heading) * metres[row], rel=0.05)
    assert sin(heading) != 0


# A law that no catalogue lists.

ADDED: dict[str, dict[str, Any]] = {
    "time_wave": {"law_per": "second", "law_size": 0.05, "law_scale": 7.0, "law_phase_rad": 1.0},
    "way_wave": {"law_size": 0.2, "law_scale": 1.7, "law_phase_rad": -1.0},
    "heading_wave": {"law_size": -0.2, "law_order": 3, "law_phase_rad": 0.5},
    "speed_squared": {"law_size": 0.9},
    "speed_above": {"law_acts_on": "forward", "law_size": -0.1, "law_scale": 0.25},
    "speed_tanh": {"law_size": -0.2, "law_scale": 0.2},
    "speed_times_turn_rate": {"law_acts_on": "sideways", "law_per": "second", "law_size": 0.4},
    "speed_times_heading": {"law_size": 0.5, "law_phase_rad": 2.0},
    "turn_rate_above": {
        "law_acts_on": "forward",
        "law_per": "radian",
        "law_size": 0.03,
        "law_scale": 0.3,
    },
    "turn_rate_squared": {"law_per": "second", "law_size": -0.15},
    "braking": {"law_per": "second", "law_size": 0.1, "law_scale": 0.1},
    "fading": {"law_size": 0.2, "law_scale": 20.0},
    "growing": {"law_size": -0.3, "law_order": 2},
    "disc": {"law_size": 0.3, "law_scale": 0.8, "law_x_m": 0.5, "law_y_m": 0.2},
    "place_x": {"law_acts_on": "forward", "law_size": 0.05},
    "place_y_squared": {"law_acts_on": "forward", "law_size": -0.04},
    "wall": {"law_size": 0.2, "law_scale": 0.6, "law_x_m": -2.0},
    "wheel_pulse": {"law_size": 0.4, "law_scale": 0.4, "law_wheel": "right"},
}
"""Each law, so large that it moves a robot by far more than noise."""
SLOW_ROBOT = [
    *EXACT,
    "top_speed_m_s=0.5",
    "top_turn_rad_s=0.9",
    "acceleration_m_s2=0.5",
    "motor_lag_s=0.05",
    "wheelbase_m=0.3",
    "start=origin",
    "kind=random_commands",
    "controller=open",
    "runs=2",
    "run_s=40",
]


def with_a_law(kind: str, *overrides: str) -> Made:
    """A drive with one law."""
    setting = setting_of("unlisted_null", 5, [*SLOW_ROBOT, *overrides])
    return driven("unlisted_null", 5, setting.with_(law_kind=kind, **ADDED[kind]))


@pytest.mark.parametrize("kind", SHAPES)
def test_ticks_replayed_with_a_law_leave_noise_and_without_it_far_more(
    kind: str, tmp_path: File
) -> None:
    write(with_a_law(kind), tmp_path)
    with_law_m = rms_m(left(tmp_path))
    known = json.loads((tmp_path / "truth.json").read_text())
    known["numbers"]["laws"] |= {"law_size": 0.0}
    (tmp_path / "truth.json").write_text(json.dumps(known))
    without_m = rms_m(left(tmp_path))
    assert with_law_m < 2e-3
    assert without_m > 20e-3
    assert with_law_m < 0.06 * without_m


def of_constant(acts_on: str, size: float) -> tuple[Array, Array]:
    """Way driven and true poses of a straight drive with a law that is the same everywhere."""
    changes = ["kind=straights", "e_d=1", "e_b=1", "e_s=1", "first_count=0"]
    setting = setting_of("unlisted_null", 5, [*SLOW_ROBOT, *changes])
    laws = Laws(law_kind="fading", law_scale=1e9, law_acts_on=acts_on, law_size=size)
    made = driven("unlisted_null", 5, replace(setting, laws=laws))
    robot, log = made.setting.robot, made.logs[0]
    way = log.counts.mean(axis=1) * robot.tick_rad * robot.nominal_radius_m
    far = int(np.argmax(way > 0.5))
    return way[far], log.body[far]


@pytest.mark.parametrize("size", [0.1, -0.1])
def test_laws_act_ahead_to_the_left_and_counter_clockwise(size: float) -> None:
    way, body = of_constant("yaw", size)
    assert body[2] == pytest.approx(size * way, rel=0.01)
    way, body = of_constant("forward", size)
    assert body[0] == pytest.approx((1 + size) * way, rel=1e-3)
    way, body = of_constant("sideways", size)
    assert body[1] == pytest.approx(size * way, rel=0.01)


@pytest.mark.parametrize("acts_on", ["yaw", "forward"])
def test_a_law_that_is_e_d_or_e_s_does_not_show_beyond_them(acts_on: str) -> None:
    setting = setting_of("unlisted_null", 5, [*SLOW_ROBOT, "kind=squares"])
    known = unlisted.known_of(driven("unlisted_null", 5, setting))
    columns = unlisted.taken_up(known)
    same = Laws(law_kind="fading", law_scale=1e9, law_acts_on=acts_on, law_size=1e-4)
    other = replace(same, law_scale=20.0)
    moved = unlisted.positions(known, replace(setting, laws=same))
    moves = np.concatenate(moved) - np.concatenate(unlisted.positions(known, setting))
    moves_m = float(np.sqrt((moves**2).sum(axis=1).mean()))
    assert moves_m > 1e-5
    assert unlisted.beyond_m(known, same, columns) < 0.05 * moves_m
    assert unlisted.beyond_m(known, other, columns) > 3 * unlisted.beyond_m(known, same, columns)


def test_each_kind_of_law_is_first_in_as_many_seeds_as_there_are_kinds() -> None:
    families = list(unlisted.FAMILIES)
    seeds = range(len(families) * 3, len(families) * 4)
    first = [next(unlisted.order(families, "unlisted", seed)) for seed in seeds]
    assert sorted(first, key=families.index) == families
    assert {one.kind for one in families} == set(SHAPES)


def test_a_size_is_such_that_the_law_shows_as_far_as_wanted() -> None:
    setting = setting_of("unlisted_null", 5, [*SLOW_ROBOT, "kind=squares"])
    known = unlisted.known_of(driven("unlisted_null", 5, setting))
    family = next(one for one in unlisted.FAMILIES if one.kind == "place_x")
    law = Laws(law_kind="place_x", law_acts_on="forward", law_size=-1.0)
    for wanted_m in (1e-3, 2e-3):
        laws = unlisted.sized(known, family, law, wanted_m)
        assert laws is not None
        assert laws.law_size < 0
        shows_m = unlisted.beyond_m(known, laws, unlisted.taken_up(known))
        assert shows_m == pytest.approx(wanted_m, rel=0.02)
    assert unlisted.sized(known, family, law, 10.0) is None


def test_a_law_that_shows_too_little_or_too_far_or_that_ticks_do_not_say_is_not_fair() -> None:
    fair = {"shows_m": 3.0, "noise_m": 1.0, "truth_leaves_m": 1.1, "share_of_one_run": 0.5}
    assert unlisted.is_fair(fair)
    wrongs = {"shows_m": 1.9}, {"shows_m": 8.1}, {"truth_leaves_m": 1.3}, {"share_of_one_run": 0.8}
    for wrong in wrongs:
        assert not unlisted.is_fair(fair | wrong)


@pytest.mark.parametrize("seed", [2, 3, 4, 5])
def test_a_law_shows_2_to_8_times_the_noise_and_its_ticks_say_all_of_it(
    seed: int, tmp_path: File
) -> None:
    world = make("unlisted", seed, ["run_s=30"])
    write(world, tmp_path)
    noise_m = truth(world)["law"]["noise_m"]
    assert 2 <= truth(world)["law"]["shows_m"] / noise_m <= 8
    assert rms_m(left(tmp_path)) <= 1.25 * noise_m
    write(make("unlisted_null", seed, ["run_s=30"]), tmp_path)
    assert rms_m(left(tmp_path)) == pytest.approx(noise_m, rel=0.01)


def test_a_null_has_the_robot_and_the_drives_of_the_world_with_a_law() -> None:
    changes = ["kind=random_commands", "controller=open", "runs=3", "run_s=20"]
    hidden = make("unlisted", 3, [*changes, "law_kind=place_x", "law_size=0.3"])
    null = make("unlisted_null", 3, changes)
    assert (null.setting.laws, null.law) == (Laws(), {})
    assert hidden.setting.laws.law_size == 0.3
    assert hidden.setting.robot == null.setting.robot
    for one, other in zip(hidden.logs, null.logs, strict=True):
        np.testing.assert_array_equal(one.counts, other.counts)
        assert np.nanmax(np.abs(one.pose - other.pose)) > 0.01


def test_squares_of_one_size_are_driven_at_speeds_up_to_three_times_apart() -> None:
    changes = ["kind=squares", "controller=open", "runs=10", "run_s=20", "speed_spread=3"]
    world = make("unlisted_null", 3, changes)
    tops = [np.diff(ride.angles(np.arange(0, ride.end_s, 0.05))).max() for ride in world.tracks]
    assert 1.5 < max(tops) / min(tops) <= 3.01
    sides = [np.hypot(*np.ptp(log.body[:, :2], axis=0)) for log in world.logs]
    assert max(sides) / min(sides) < 1.5
