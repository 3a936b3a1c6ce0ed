"""What changed of a robot between two tests."""

import pickle

import pytest
import umbmark


def noisy() -> umbmark.Model:
    return umbmark.Model().add("wheel_noise", k_sqrt_m=2e-4)


def test_a_change_is_found_its_interval_holds_the_truth_and_print_gives_the_text() -> None:
    worn = noisy().add("wheelbase", e_b=1.01)
    before = umbmark.simulate(noisy(), reference_rate_hz=0, seed=7)
    after = umbmark.simulate(worn, reference_rate_hz=0, seed=8)
    found = umbmark.changed(before, after, draws=99)
    assert found.changed
    assert not found.as_before
    row = next(row for row in found.robot if row.key == "wheelbase_over_diameter")
    assert row.interval is not None
    assert row.interval[0] < 0.01 * row.before < row.interval[1]
    assert [alone.key for alone in found.alone] == ["wheelbase_m"]
    assert str(found) == found.text.rstrip()
    assert found.table()[0]["key"] == "wheel_diameter_ratio"
    assert pickle.loads(pickle.dumps(found)) == found
    same = umbmark.changed(before, before, draws=99)
    assert same.as_before
    assert all(row.change in (0.0, 1.0) for row in same.robot)


def test_tests_that_show_nothing_in_common_are_refused() -> None:
    robot, path = umbmark.Model().robot, umbmark.Path.square(1.0)
    data = umbmark.Dataset.from_arrays([(0.1, 0.0, 0.0)], [], robot=robot, path=path)
    with pytest.raises(umbmark.FitError, match="no number of the robot is shown by both tests"):
        umbmark.changed(data, data, draws=99)
