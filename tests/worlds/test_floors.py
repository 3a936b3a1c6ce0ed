"""What differs between floors, loads and days, by tape; `floors.py` runs it on many."""

import pytest
from floors import judged, of_learnt, said, world
from test_gyro import COMMAND, needs_command


def test_a_world_states_what_is_true_of_it() -> None:
    made = world("wheelbase", 1)
    assert len(made.rows) == len(made.stated)
    floors = {one["floor"] for one in made.stated}
    values = {made.values["e_b", "floor", name] for name in floors}
    assert len(values) == len(floors)
    assert max(abs(value - 1) for value in values) >= 0.01
    assert made.values["e_d", "floor", made.stated[0]["floor"]] == 1.0
    days = world("days", 1)
    assert {one["session"] for one in days.stated} == {f"day {day}" for day in range(1, 7)}


@needs_command
@pytest.mark.parametrize("kind", ["wheelbase", "load", "days"])
def test_what_differs_is_named(kind: str) -> None:
    assert sum(judged(*said(kind, seed, COMMAND))["all named"] for seed in range(1, 4)) >= 2


@needs_command
def test_where_nothing_differs_it_is_hardly_ever_said() -> None:
    # At 5 %, more than three of 12 are accused with a probability of 0.2 %.
    answers = [judged(*said("nothing", seed, COMMAND)) for seed in range(1, 13)]
    assert sum(answer["something else named"] for answer in answers) <= 3


@needs_command
def test_a_model_is_explained_only_where_it_holds_on_every_floor() -> None:
    def answers(kind: str, sets: int) -> list[dict[str, int]]:
        seeds = range(301, 301 + sets)
        return [of_learnt(*said(kind, seed, COMMAND, "learn")) for seed in seeds]

    differing = answers("wheelbase", 4)
    assert all(answer["differing named"] and not answer["explained"] for answer in differing)
    assert not any(answer["something else named"] for answer in answers("nothing", 8))
