"""Robots that are tested again and again; `sequences.py` runs it on many."""

import numpy as np
import pytest
from record import stream
from sequences import Asked, drawn, driven, said
from test_gyro import COMMAND, needs_command


def test_a_robot_as_it_is_entered_returns_to_start() -> None:
    random = stream(1, "nothing", "test")
    robot = drawn(random, 2.0)._replace(noise=0.0)
    sense = np.array([-1.0, 1.0])
    ends = driven(robot, sense, np.ones((4, 2)), random, "nothing")
    assert ends == pytest.approx(np.zeros((3, 2)), abs=1e-9)
    smaller = driven(robot, sense, np.array([[1.0], [0.998], [1.0], [1.0]]), random, "nothing")
    assert np.abs(smaller[2]).min() > 0.01


@needs_command
def test_a_wheel_that_shrinks_is_found_and_one_that_does_not_is_not() -> None:
    for seed in range(1, 9):
        quiet, _ = said("nothing", seed, Asked(60, 60, None, 0.01, COMMAND))
        assert not quiet["changed"]
        found, _ = said("wheel_0.2", seed, Asked(40, 20, None, 0.01, COMMAND))
        assert found["change"]["kind"] == "numbers"
