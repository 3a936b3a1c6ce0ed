"""Many robots by one call: what one call after the other gives, and one frame of all."""

import pickle
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest
import umbmark

PATH = umbmark.Path(side_m=1.0)
MODEL = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=3e-4)


@pytest.fixture(scope="module")
def robots() -> dict[str, umbmark.Dataset]:
    """Return three robots by their return poses."""
    return {
        f"cart {seed}": umbmark.simulate(MODEL, PATH, runs=4, reference_rate_hz=0, seed=seed)
        for seed in (3, 1, 2)
    }


CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "score": (umbmark.score, {"level": 0.9}),
    "calibrate": (umbmark.calibrate, {}),
    "fit": (umbmark.fit, {}),
    "diagnose": (umbmark.diagnose, {"draws": 99}),
    "learn": (umbmark.learn, {"draws": 99}),
    "solve": (umbmark.solve, {"draws": 99}),
    "inspect": (umbmark.inspect, {}),
}


def test_a_fleet_is_what_its_robots_are_alone() -> None:
    cw = np.random.default_rng(1).normal([-0.20, -0.21, -0.05], 0.01, (4, 5, 3))
    ccw = np.random.default_rng(2).normal([0.01, 0.00, 0.01], 0.01, (4, 6, 3))
    cw[2, 3] = np.nan
    fleet = umbmark.fleet(cw, ccw, path=PATH, names=["a", "b", "c", "d"])
    alone = umbmark.Dataset.from_arrays(cw[2, [0, 1, 2, 4]], ccw[2], path=PATH)
    assert [*fleet] == ["a", "b", "c", "d"]
    assert fleet["c"] == alone
    scores = umbmark.each(umbmark.score, fleet)
    assert scores["b"] == umbmark.score(cw[1], ccw[1])
    for wrong, words in (
        ({"cw": cw[0]}, r"cw must have shape \(robots, runs, 3\)"),
        ({"ccw": ccw[:3]}, "cw has 4 robots and ccw 3"),
        ({"names": ["a", "b", "b", "d"]}, "4 different names"),
    ):
        with pytest.raises(ValueError, match=words):
            umbmark.fleet(**{"cw": cw, "ccw": ccw, **wrong})


def test_a_calibration_without_learning_is_the_same_but_stands_in_doubt() -> None:
    data = umbmark.simulate(MODEL, PATH, runs=4, reference_rate_hz=0)
    learnt, quick = umbmark.calibrate(data), umbmark.calibrate(data, learn=False)
    assert quick.methods["model"] is None
    assert learnt.methods["model"] is not None
    for method in ("closed_form_mean", "heading", "exact"):
        assert quick.methods[method] == learnt.methods[method]
    with pytest.raises(ValueError, match="learn=False was said"):
        quick.export("ros2_control")
    assert "wheel_separation_multiplier" in quick.export("ros2_control", force=True)


@pytest.mark.parametrize("name", CALLS)
def test_each_robot_gets_what_a_call_of_its_own_gives(
    name: str, robots: dict[str, umbmark.Dataset]
) -> None:
    call, keys = CALLS[name]
    found = umbmark.each(call, robots, workers=2, **keys)
    alone = {robot: call(data, **keys) for robot, data in robots.items()}
    assert dict(found) == alone
    assert [*found] == [*robots]
    assert found.failed == {}
    parts = [one.to_pandas().assign(robot=robot) for robot, one in alone.items()]
    expected = pd.concat(parts, ignore_index=True)
    frame = found.to_pandas()
    assert next(iter(frame.columns)) == "robot"
    pd.testing.assert_frame_equal(frame, expected[frame.columns.to_list()])
    assert found.to_polars().shape == frame.shape


def test_a_robot_that_is_refused_does_not_stop_the_others(
    robots: dict[str, umbmark.Dataset],
) -> None:
    empty = umbmark.Dataset(runs=[])
    asked: dict[str, Any] = {"empty": empty, **robots, "missing": "no/such/place"}
    found = umbmark.each(umbmark.score, asked)
    assert [*found] == [*robots]
    assert [*found.failed] == ["empty", "missing"]
    for name, why in found.failed.items():
        with pytest.raises(ValueError) as refused:  # noqa: PT011
            umbmark.score(asked[name])
        assert why == str(refused.value)
    assert repr(found) == "Each(Score: 3 robots, 2 failed)"
    none = umbmark.each(umbmark.score, [empty])
    assert none.failed["1"]
    assert (len(none), none.to_arrow().num_rows) == (0, 0)
    assert repr(none) == "Each(nothing found: 0 robots, 1 failed)"
    with pytest.raises(KeyError):
        found["empty"]


def test_a_sequence_is_numbered_and_arrays_become_robots() -> None:
    rng = np.random.default_rng(1)
    cw, ccw = rng.normal(size=(2, 5, 4, 3)) * [0.01, 0.01, 0.001]
    made = [umbmark.Dataset.from_arrays(*both, path=PATH) for both in zip(cw, ccw, strict=True)]
    found = umbmark.each(umbmark.score, made)
    assert [*found] == ["1", "2", "3", "4", "5"]
    assert found["4"].e_max_sys_m == umbmark.score(cw[3], ccw[3]).e_max_sys_m


def test_each_call_has_one_thread_unless_more_are_asked_for(
    robots: dict[str, umbmark.Dataset],
) -> None:
    heard: list[int] = []

    def call(data: umbmark.Dataset, *, threads: int = 0) -> umbmark.Score:
        heard.append(threads)
        return umbmark.score(data)

    umbmark.each(call, robots)
    umbmark.each(call, robots, threads=3)
    assert heard == [1, 1, 1, 3, 3, 3]


def test_progress_counts_robots(robots: dict[str, umbmark.Dataset]) -> None:
    heard: list[tuple[int, int]] = []
    umbmark.each(umbmark.score, robots, progress=lambda *at: heard.append(at))
    assert heard == [(1, 3), (2, 3), (3, 3)]


def test_many_robots_are_asked_in_parts_and_come_in_their_order_one_of_them_refused() -> None:
    cw, ccw = np.random.default_rng(4).normal(size=(2, 150, 3, 3)) * [0.01, 0.01, 0.001]
    fleet: dict[str, Any] = dict(umbmark.fleet(cw, ccw, path=PATH))
    fleet["75"] = "there is no such place"
    asked: list[int] = []
    found = umbmark.each(umbmark.score, fleet, workers=2, progress=lambda at, _: asked.append(at))
    assert asked == [*range(1, 151)]
    assert [*found.failed] == ["75"]
    assert [*found] == [name for name in fleet if name != "75"]
    assert found["149"] == umbmark.score(fleet["149"])


FORKED = """
import os, signal, umbmark
data = umbmark.Dataset.from_arrays([[0.1, 0, 0], [0.2, 0, 0]], [[0, 0.1, 0], [0, 0.2, 0]])
before = umbmark.score(data)
child = os.fork()
if child == 0:
    signal.alarm(60)
    os._exit(0 if umbmark.score(data) == before else 1)
print(os.waitpid(child, 0)[1], umbmark.score(data) == before)
"""


def test_a_forked_process_has_threads_of_its_own() -> None:
    told = subprocess.run(
        [sys.executable, "-c", FORKED], capture_output=True, text=True, check=True, timeout=120
    )
    assert told.stdout.split() == ["0", "True"]


def test_what_was_found_compares_by_value(robots: dict[str, umbmark.Dataset]) -> None:
    found = umbmark.each(umbmark.score, robots)
    assert found == umbmark.each(umbmark.score, robots)
    assert pickle.loads(pickle.dumps(found)) == found
    assert found != umbmark.each(umbmark.score, robots, level=0.9)
    assert found != umbmark.each(umbmark.score, {**robots, "none": "there is no such place"})


def test_a_single_robot_is_not_many(robots: dict[str, umbmark.Dataset]) -> None:
    single: Any
    for single in ("my_robot", robots["cart 1"], 3):
        with pytest.raises(TypeError, match="robots must be a mapping or a sequence of data, got"):
            umbmark.each(umbmark.score, single)
    with pytest.raises(ValueError, match="workers must be between 1 and"):
        umbmark.each(umbmark.score, robots, workers=0)


FROM_THREADS = """
import sys
import threading

import umbmark

data = umbmark.simulate(umbmark.Model(), runs=2, reference_rate_hz=0, seed=1)
sys.setswitchinterval(1e-6)
gate = threading.Barrier(4)
made = []


def make():
    gate.wait()
    made.append(umbmark.inspect(data))


threads = [threading.Thread(target=make) for _ in range(4)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(len(made))
"""


def test_the_first_results_of_a_class_may_be_made_by_several_threads() -> None:
    for _ in range(3):
        command = [sys.executable, "-c", FROM_THREADS]
        ended = subprocess.run(command, capture_output=True, text=True)
        assert (ended.returncode, ended.stdout) == (0, "4\n"), ended.stderr
