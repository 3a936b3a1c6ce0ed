"""Many robots of one kind in one call."""

import pickle

import numpy as np
import pytest
import umbmark


def robots(count: int) -> dict[str, umbmark.Dataset]:
    draw = np.random.default_rng(1)
    cw = draw.normal([-0.20, -0.21, -0.05], 0.01, (count, 5, 3))
    ccw = draw.normal([0.01, 0.00, 0.01], 0.01, (count, 5, 3))
    cw[3] += (0.4, 0.4, 0.2)
    return umbmark.fleet(cw, ccw, robot=umbmark.Model().robot, path=umbmark.Path.umbmark())


def test_each_robot_has_the_row_of_a_call_of_its_own_and_the_odd_one_is_named() -> None:
    fleet = robots(12)
    found = umbmark.survey(fleet, draws=99)
    assert [one.robot for one in found.robots] == list(fleet)
    assert [one.robot for one in found.robots if one.stands_out] == ["4"]
    alone = umbmark.diagnose(fleet["7"], draws=99)
    assert found.robots[6].verdict == alone.verdict
    assert found.robots[6].fitted == alone.fitted
    assert found.among[0].sd_between >= 0.0
    assert found.table()[3]["stands_out"] != ""
    assert str(found) == found.text.rstrip()
    assert pickle.loads(pickle.dumps(found)) == found
    assert len(found.to_pandas()) == 12


def test_a_sequence_is_numbered_and_robots_without_a_verdict_have_none() -> None:
    found = umbmark.survey([*robots(4).values()], diagnosis=False)
    assert [one.robot for one in found.robots] == ["1", "2", "3", "4"]
    assert {one.verdict for one in found.robots} == {None}
    with pytest.raises(ValueError, match="size"):
        umbmark.survey(robots(4), size=0)
