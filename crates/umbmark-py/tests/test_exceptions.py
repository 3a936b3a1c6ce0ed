"""Exceptions: their own classes, all of them ValueError, that survive a pickle."""

import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import umbmark


def no_dataset() -> object:
    return umbmark.score("there is no such place")


def no_runs() -> object:
    return umbmark.score(np.empty((0, 3)), np.empty((0, 3)))


def no_effect() -> object:
    data = umbmark.simulate(umbmark.Model(), runs=2, reference_rate_hz=0)
    return umbmark.fit(data, add=["wheelbas"])


def no_robot() -> object:
    return umbmark.calibrate(umbmark.Dataset.from_arrays([[0.1, 0.0, 0.0]] * 2))


def a_path_in_millimetres() -> object:
    errors = [[210.0, -150.0, 0.02]] * 3
    robot, path = umbmark.Model().robot, umbmark.Path.square(1.0)
    return umbmark.fit(umbmark.Dataset.from_arrays(errors, errors, robot=robot, path=path))


CASES: list[tuple[Callable[[], object], type[ValueError]]] = [
    (no_dataset, umbmark.DataError),
    (no_runs, umbmark.DataError),
    (no_effect, umbmark.ModelError),
    (no_robot, umbmark.DataError),
    (a_path_in_millimetres, umbmark.FitError),
]


@pytest.mark.parametrize(("call", "kind"), CASES)
def test_what_cannot_be_done_raises_its_own_exception(
    call: Callable[[], object], kind: type[ValueError]
) -> None:
    with pytest.raises(ValueError, match=r".") as raised:
        call()
    assert type(raised.value) is kind
    assert isinstance(raised.value, umbmark.UmbmarkError)
    again = pickle.loads(pickle.dumps(raised.value))
    assert (type(again), str(again)) == (kind, str(raised.value))


def test_an_argument_that_is_out_of_range_is_a_plain_value_error(tmp_path: Path) -> None:
    data = umbmark.simulate(umbmark.Model(), runs=2, reference_rate_hz=0)
    with pytest.raises(ValueError, match="size must be between 0 and 1") as raised:
        umbmark.diagnose(data, size=2.0)
    assert type(raised.value) is ValueError
    data.save(tmp_path)
    with pytest.raises(umbmark.UmbmarkError, match="replace=True"):
        data.save(tmp_path)


def test_each_names_what_an_exception_says() -> None:
    found = umbmark.each(umbmark.score, {"none": "there is no such place"})
    assert "there is no such place" in found.failed["none"]
