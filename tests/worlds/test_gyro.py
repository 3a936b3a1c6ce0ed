"""A gyro as the only reference, on drives of the worlds; `gyro.py` runs it on many."""

from pathlib import Path as File

import numpy as np
import pytest
from gyro import Gyro, found, rates, world
from record import stream
from study import ROOT

COMMAND = ROOT / "target/release/umbmark"

needs_command = pytest.mark.skipif(
    not COMMAND.exists(), reason=f"{COMMAND} is not built (cargo build --release)"
)


@needs_command
@pytest.mark.parametrize(("name", "seed"), [("null", 203), ("perfect", 204)])
def test_wheels_are_found_by_a_gyro_alone(name: str, seed: int) -> None:
    one = found(name, seed, File(COMMAND))
    assert one.verdict == "explained"
    assert all(abs(off) < 4 for off in one.off.values()), one
    assert abs(one.off_by["e_b"]) < 5e-3


def test_a_gyro_shows_the_turns_and_its_own_rate() -> None:
    made, _, _ = world("null", 1)
    log = made.logs[0]
    random = stream(1, "null", "test")
    own = 0.01
    shown = rates(log, Gyro(own, 0.0, 0.0, 0.0), random)
    turned = np.sum(shown[1:] * np.diff(log.stamp_s)) - own * (log.stamp_s[-1] - log.stamp_s[0])
    heading = np.unwrap(log.body[:, 2])
    assert turned == pytest.approx(heading[-1] - heading[0], abs=1e-9)
