"""The worlds are what their names say, and a seed decides every byte."""

import json
from math import cos, hypot, pi, sin
from pathlib import Path as File

import numpy as np
import pytest
import words
from files import truth, write
from judge import judged
from laws import added_turn, scrubbed, wheel_travel
from record import Log, Made, make
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


@pytest.mark.parametrize("world", sorted(set(WORLDS) - DRIFTS))
def test_the_truth_replays_to_the_measured_poses_within_noise(world: str, tmp_path: File) -> None:
    write(made(world, 4, *EXACT), tmp_path)
    assert rms_m(left(tmp_path), with_glitches=False) < 2e-3


@pytest.mark.parametrize("world", sorted(DRIFTS))
def test_a_reference_that_drifts_leaves_the_wheels_behind(world: str, tmp_path: File) -> None:
    write(made(world, 4, *EXACT, "run_s=60"), tmp_path)
    assert rms_m(left(tmp_path)) > 5e-3


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
