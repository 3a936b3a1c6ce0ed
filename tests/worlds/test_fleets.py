"""Many robots of one kind, by tape; `fleets.py` runs it on hundreds of fleets."""

from pathlib import Path

from fleets import judged, make, said
from test_gyro import COMMAND, needs_command


def test_a_fleet_has_as_many_robots_as_it_says_and_one_that_is_odd(tmp_path: Path) -> None:
    fleet = make("odd", 1, tmp_path)
    robots = sorted(one.name for one in tmp_path.iterdir())
    assert 20 <= len(robots) <= 40
    assert fleet.odd in robots
    assert make("alike", 1, tmp_path / "alike").spreads == (0.0, 0.0)


@needs_command
def test_an_odd_robot_is_named_and_the_others_are_hardly_ever() -> None:
    # At 5 % for each fleet, more than two of six are accused with a probability of 0.2 %.
    answers = [judged(*said("odd", seed, COMMAND)) for seed in range(1, 7)]
    assert all(answer["odd named"] for answer in answers)
    assert sum(answer["another named"] for answer in answers) <= 2


@needs_command
def test_intervals_of_a_spread_hold_the_true_one() -> None:
    # Of 16 intervals of 95 %, at least 12 hold with a probability of 99.9 %.
    answers = [judged(*said("spread", seed, COMMAND)) for seed in range(1, 5)]
    held = [value for one in answers for key, value in one.items() if key.endswith("holds")]
    assert len(held) == 16
    assert sum(held) >= 12
