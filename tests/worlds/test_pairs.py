"""What changed between two tests by tape; `pairs.py` runs it on many."""

import pytest
from pairs import START_M, changed, drawn, driven, said
from record import stream
from test_gyro import COMMAND, needs_command


def test_a_robot_as_it_is_entered_returns_to_start() -> None:
    random = stream(1, "nothing", "test")
    robot, test = drawn(random)
    perfect = robot._replace(
        true_left_m=robot.diameter_m,
        true_right_m=robot.diameter_m,
        true_wheelbase_m=robot.wheelbase_m,
        noise=0.0,
    )
    for sense in (-1, 1):
        assert driven(perfect, test, sense, random) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    smaller = changed(perfect, "wheel")
    assert abs(driven(smaller, test, 1, random)[2]) > 0.01


@needs_command
def test_what_changed_is_said_and_where_nothing_did_hardly_ever() -> None:
    false = sum(bool(said("nothing", seed, COMMAND)["changed"]) for seed in range(1, 13))
    assert false <= 3
    for seed in range(1, 4):
        assert said("wheelbase", seed, COMMAND)["changed"]
        wheel = said("wheel", seed, COMMAND)
        assert wheel["changed"]
        assert any("wheel" in one["key"] for one in wheel["robot"])


@needs_command
def test_a_start_that_lies_elsewhere_is_named_where_it_looks_like_other_wheels() -> None:
    for seed in range(1, 4):
        found = said("start", seed, COMMAND)
        assert found["changed"]
        assert found["start"]["x_m"] == pytest.approx(START_M[0], abs=0.03)
        assert found["start"]["y_m"] == pytest.approx(START_M[1], abs=0.03)
        assert said("wheelbase", seed, COMMAND)["start"] is None
