"""A robot that is tested again and again."""

import pickle
from pathlib import Path

import numpy as np
import pytest
import umbmark

SQUARE = umbmark.Path.square(4.0)


def driven(runs: int, changed_at: int) -> umbmark.Dataset:
    """Give runs in each direction; 0.2 % of E_d moves the returns of later ones by 270 mm."""
    random = np.random.default_rng(3)
    cw, ccw = (random.normal(0.0, (0.02, 0.02, 0.01), (60, 3))[:runs] for _ in range(2))
    cw[changed_at:] += (-0.181, -0.199, 0.094)
    ccw[changed_at:] += (0.1946, -0.1768, 0.094)
    return umbmark.Dataset.from_arrays(cw, ccw, robot=umbmark.Robot.labmate(), path=SQUARE)


def test_a_robot_is_watched_until_it_changes_and_the_alarm_stays_until_a_restart(
    tmp_path: Path,
) -> None:
    state = tmp_path / "robot.watch.json"
    quiet = umbmark.watch(driven(15, 15), state)
    assert not quiet.changed
    assert quiet.new == 30
    assert {delay.share: delay.most for delay in quiet.delays}[-0.002] is not None
    written = state.read_bytes()
    again = umbmark.watch(driven(15, 15), state)
    assert (again.new, again.changed) == (0, False)
    assert state.read_bytes() == written
    found = umbmark.watch(driven(20, 15), state)
    assert found.change is not None
    assert found.change.kind == "numbers"
    e_d = found.change.numbers[0]
    assert e_d.interval is not None
    assert e_d.interval[0] < 0.002 < e_d.interval[1]
    assert found.change.runs_until_seen <= 4
    assert str(found) == found.text.rstrip()
    assert found.table()[-1]["used"] == "compared"
    assert pickle.loads(pickle.dumps(found)) == found
    assert not umbmark.watch(driven(20, 15), state, restart=found.change.since).changed


def test_a_state_of_another_rate_and_a_damaged_one_are_refused(tmp_path: Path) -> None:
    state = tmp_path / "robot.watch.json"
    umbmark.watch(driven(8, 8), state, false_alarms=0.1)
    with pytest.raises(umbmark.DataError, match=r"watched with 0\.1 false alarms a month"):
        umbmark.watch(driven(8, 8), state, false_alarms=0.2)
    with pytest.raises(ValueError, match="got 0"):
        umbmark.watch(driven(8, 8), runs_per_month=0)
    state.write_bytes(state.read_bytes()[:-9])
    with pytest.raises(umbmark.DataError, match="is damaged"):
        umbmark.watch(driven(8, 8), state)
