"""Monte Carlo: the command's bits, whatever the threads, shards and stops; progress and Ctrl-C."""

import _thread
import json
import pickle
import signal
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import umbmark

MODEL = (
    umbmark.Model()
    .add("wheel_diameter_ratio", e_d=1.002)
    .add("wheelbase", e_b={"mean": 1.01, "sd": 0.002})
    .add("wheel_noise", k_sqrt_m=1e-3)
)


def test_a_study_is_that_of_the_command(command: Path, tmp_path: Path) -> None:
    model = tmp_path / "model.toml"
    model.write_text(MODEL.to_toml())
    run: list[str | Path] = [command, "mc", "-n", "600", "--seed", "7", "--model", model, "--json"]
    told = json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)
    found = umbmark.monte_carlo(MODEL, n=600, seed=7).to_dict()
    for document in (told, found):
        assert document.pop("trials_per_s") > 0
        # Flags that were not said: the command names the LabMate's.
        document.pop("assumed")
    assert found == told


def test_threads_shards_and_their_order_give_the_same_bits() -> None:
    study = umbmark.Study(MODEL, n=2000, seed=3, runs=2)
    whole, trials, _ = study.run(threads=1, keep=True)
    assert trials is not None
    parts = [study.run((index, 3), threads=2)[0] for index in (2, 0, 1)]
    merged = parts[0].merge(*parts[1:])
    assert (merged.trials, merged.missing) == (2000, [])
    shares = np.linspace(0, 1, 11)
    for metric in study.metrics:
        assert trials[metric].shape == (2000,)
        assert merged.mean(metric) == whole.mean(metric)
        assert merged.std_dev(metric) == whole.std_dev(metric)
        np.testing.assert_array_equal(
            merged.quantile(metric, shares), whole.quantile(metric, shares)
        )
        assert trials[metric].mean() == pytest.approx(whole.mean(metric), abs=1e-9)
    with pytest.raises(ValueError, match="trials 0 to 511 are in both"):
        parts[1].merge(parts[1])
    other = umbmark.Study(MODEL, n=2000, seed=4, runs=2).run((0, 3))[0]
    with pytest.raises(ValueError, match="different studies"):
        parts[1].merge(other)
    with pytest.raises(KeyError, match="there is no metric"):
        whole.mean("speed")


def test_studies_and_ensembles_can_be_pickled() -> None:
    study = umbmark.Study(MODEL, umbmark.Path(side_m=1.0), n=300, runs=(2, 3), odometry="ticks")
    copy = pickle.loads(pickle.dumps(study))
    assert repr(copy) == repr(study)
    one, two = study.run()[0], pickle.loads(pickle.dumps(copy.run()[0]))
    assert repr(two) == "Ensemble(300 trials, 0 missing)"
    assert one.quantile("sigma_m", np.array([0.3])) == two.quantile("sigma_m", np.array([0.3]))


def test_a_study_of_one_direction_has_no_e_max_sys() -> None:
    found = umbmark.monte_carlo(MODEL, n=20, runs=(3, 0))
    assert "e_max_sys_m" not in found.metrics
    assert (found.runs.cw, found.runs.ccw) == (3, 0)


def test_a_study_stops_when_it_is_precise() -> None:
    found = umbmark.monte_carlo(MODEL, until_std_error_m=3e-4, runs=1)
    assert not found.partial
    assert found.n % 16384 == 0
    assert (found.metrics["e_max_sys_m"].std_error or 1) <= 3e-4


def test_progress_is_told_as_far_as_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    heard: list[tuple[int, int]] = []
    umbmark.monte_carlo(MODEL, n=40_000, runs=1, progress=lambda *told: heard.append(told))
    assert heard[-1] == (40_000, 40_000)
    assert [done for done, _ in heard] == sorted(done for done, _ in heard)
    umbmark.monte_carlo(MODEL, n=10, progress=True)


def test_a_progress_function_that_fails_stops_the_study() -> None:
    def fail(*_: int) -> None:
        raise RuntimeError("enough")

    began = time.perf_counter()
    with pytest.raises(RuntimeError, match="enough"):
        umbmark.monte_carlo(MODEL, n=10_000_000, progress=fail)
    assert time.perf_counter() - began < 5


@pytest.mark.parametrize(
    "work",
    [
        lambda: umbmark.monte_carlo(MODEL, n=100_000_000),
        lambda: umbmark.compare(
            umbmark.simulate(MODEL, reference_rate_hz=0), MODEL.remove("wheelbase"), draws=99_999
        ),
    ],
)
def test_ctrl_c_is_heard_at_once(work: object) -> None:
    assert callable(work)
    # A process that was started in the background ignores the signal.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(1.0, _thread.interrupt_main)
    timer.start()
    began = time.perf_counter()
    try:
        with pytest.raises(KeyboardInterrupt):
            work()
    finally:
        timer.join()
        signal.signal(signal.SIGINT, before)
    assert time.perf_counter() - began < 4


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"n": 10**15}, "number of trials must be between 1 and 1000000000000, got"),
        ({"runs": (0, 0)}, "number of runs must be between 1"),
        ({"odometry": "wheels"}, "odometry must be one of robot, ticks, tick_by_tick, continuous"),
        ({"phase": "edgy"}, 'phase must be one of random, edge, got "edgy"'),
    ],
)
def test_an_impossible_study_is_a_value_error(keys: dict[str, int], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        umbmark.monte_carlo(MODEL, **keys)  # type: ignore[arg-type]
