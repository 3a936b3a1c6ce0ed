"""Missions of a robot whose one wheel warms up, or that is kicked; `missions.py` runs many."""

import numpy as np
import pytest
from missions import KICKS, NAMES, commands, drawn, judged, kicks, run, said
from record import stream
from test_gyro import COMMAND, needs_command


def test_a_kick_is_made_after_each_drive_off_and_a_wheel_grows_to_its_share() -> None:
    random = stream(1, "kicked", "test")
    speed, _ = commands(random).T
    offs = np.count_nonzero((speed[1:] > 0) & (speed[:-1] == 0))
    assert kicks(speed).sum() == pytest.approx(offs, rel=0.02)
    for shape in ("fixed", "late", "by_time"):
        assert kicks(speed, KICKS[shape]).sum() == pytest.approx(offs, rel=0.02)
    assert kicks(speed, KICKS["undone"]).sum() == pytest.approx(0.6 * offs, rel=0.05)
    plain = drawn("nothing", random)._replace(noise=0.0)
    warm = plain._replace(share=0.01, settles_m=1.0, wheel=1)
    ways = [run(world, stream(2, "warms", "test"))[1] for world in (plain, warm)]
    assert ways[1][2, -1] > ways[0][2, -1]


@needs_command
@pytest.mark.parametrize("kind", ["nothing", *NAMES])
def test_what_warms_or_kicks_is_named_and_the_numbers_of_the_robot_hold(kind: str) -> None:
    # Half of the runs of the study show it too.
    found = [judged(*said(kind, seed, COMMAND, runs=4)) for seed in (1, 2)]
    assert all(one["right"] for one in found), found
    assert all(abs(value) < 4 for one in found for value in one["off"].values()), found
