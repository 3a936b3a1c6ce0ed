"""Monte Carlo: the command's bits, whatever the threads, shards and stops; progress and Ctrl-C."""

import _thread
import json
import pickle
import signal
import subprocess
import threading
import time
from pathlib import Path
from typing import Any

import msgspec
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


def test_a_study_that_was_broken_off_goes_on_to_the_same_bits_here_and_in_the_command(
    command: Path, tmp_path: Path
) -> None:
    file, model = tmp_path / "study.json", tmp_path / "model.toml"
    model.write_text(MODEL.to_toml())
    keys: dict[str, Any] = {"n": 60_000, "runs": 1, "seed": 7}

    def enough(done: int, _: int) -> None:
        if done > 0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        umbmark.monte_carlo(MODEL, checkpoint=file, progress=enough, **keys)
    half = umbmark.merge(file)
    assert half.partial
    assert 0 < half.n < 60_000
    assert half.ensemble.missing == [(half.n, 60_000)]
    copy = tmp_path / "copy.json"
    copy.write_bytes(file.read_bytes())
    whole = umbmark.monte_carlo(MODEL, **keys)
    resumed = umbmark.monte_carlo(MODEL, checkpoint=file, resume=True, **keys)
    assert (resumed.n, resumed.partial, resumed.metrics) == (60_000, False, whole.metrics)
    flags = "mc -n 60000 --runs 1 --seed 7 --resume --json --checkpoint".split()
    run: list[str | Path] = [command, *flags, copy, "--model", model]
    told = json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)
    assert told["metrics"] == whole.to_dict()["metrics"]
    merged = umbmark.merge(copy, output=tmp_path / "again.json")
    assert merged.metrics == whole.metrics
    assert umbmark.merge(tmp_path / "again.json") == merged


def test_shards_are_written_down_and_merged(tmp_path: Path) -> None:
    study = umbmark.Study(MODEL, n=2000, seed=3, runs=2)
    files = [tmp_path / f"{index}.json" for index in range(3)]
    for index, file in enumerate(files):
        study.run((index, 3), checkpoint=file)
    partial = umbmark.merge(files[2], files[0])
    assert (partial.partial, len(partial.ensemble.missing)) == (True, 1)
    merged = umbmark.merge(*files[::-1])
    assert (merged.partial, merged.trials) == (False, None)
    whole = umbmark.monte_carlo(MODEL, n=2000, seed=3, runs=2)
    assert merged.metrics == whole.metrics
    assert merged.to_dict() | {"trials_per_s": None} == whole.to_dict() | {"trials_per_s": None}


def test_a_checkpoint_is_neither_lost_nor_taken_for_another_study(tmp_path: Path) -> None:
    file = tmp_path / "study.json"
    keys: dict[str, Any] = {"n": 500, "runs": 1, "checkpoint": file}
    umbmark.monte_carlo(MODEL, **keys)
    with pytest.raises(ValueError, match="exists already; resume=True goes on with it, replace="):
        umbmark.monte_carlo(MODEL, **keys)
    with pytest.raises(ValueError, match="is of another study or shard; give the robot, path"):
        umbmark.monte_carlo(MODEL, seed=2, resume=True, **keys)
    with pytest.raises(ValueError, match="leave known, or keep, out"):
        umbmark.monte_carlo(MODEL, keep=True, resume=True, **keys)
    assert umbmark.monte_carlo(MODEL, seed=2, replace=True, **keys).seed == 2
    with pytest.raises(ValueError, match=r"cannot merge .* trials 0 to 499 are in both"):
        umbmark.merge(file, file)
    (tmp_path / "again.json").write_text("")
    with pytest.raises(ValueError, match=r"again\.json exists already; replace=True replaces it"):
        umbmark.merge(file, output=tmp_path / "again.json")
    with pytest.raises(ValueError, match="there is no file to merge; give one"):
        umbmark.merge()
    file.write_text("{}")
    with pytest.raises(ValueError, match="is no checkpoint of a study by this version"):
        umbmark.merge(file)


def test_a_shard_without_trials_is_written_down_and_merged(tmp_path: Path) -> None:
    """Shards are of whole chunks: of ten trials the second of two has none."""
    study, files = umbmark.Study(MODEL, n=10), [tmp_path / "1.json", tmp_path / "2.json"]
    parts = [study.run((index, 2), checkpoint=file)[0] for index, file in enumerate(files)]
    assert sorted(pickle.loads(pickle.dumps(part)).trials for part in parts) == [0, 10]
    merged = umbmark.merge(*files)
    assert (merged.n, merged.partial) == (10, False)


def test_a_sweep_goes_on_where_its_checkpoint_ends(tmp_path: Path) -> None:
    file, axes = tmp_path / "sweep.json", {"eb": (0.99, 1.01, 40)}
    whole = umbmark.sweep(MODEL, axes, n=200, runs=1)
    written = umbmark.sweep(MODEL, axes, n=200, runs=1, checkpoint=file)
    assert written == whole
    # As the first format has it: without the line of the checksum.
    document = json.loads(file.read_text().splitlines()[1])
    document["points"] = document["points"][:7]
    document["points"][3]["metrics"][0]["mean"] = 12.5
    file.write_text(json.dumps(document))
    resumed = umbmark.sweep(MODEL, axes, n=200, runs=1, checkpoint=file, resume=True)
    assert resumed.points[3].metrics["e_max_sys_m"].mean == 12.5
    assert resumed.points[4:] == whole.points[4:]
    with pytest.raises(ValueError, match="exists already; resume=True"):
        umbmark.sweep(MODEL, axes, n=200, runs=1, checkpoint=file)
    with pytest.raises(ValueError, match="is of another sweep"):
        umbmark.sweep(MODEL, axes, n=201, runs=1, checkpoint=file, resume=True)


def test_sampled_odometry_is_asked_for_everywhere() -> None:
    sizes: dict[str, Any] = {
        "wheelbase_m": 0.34,
        "wheel_diameter_m": 0.15,
        "ticks_per_revolution": 2000,
    }
    fast = umbmark.Model(umbmark.Robot(**sizes, encoder_rate_hz=20.0)).add("wheelbase", e_b=1.01)
    how: dict[str, Any] = {"runs": 1, "update": "euler", "phase": "edge"}
    one = umbmark.monte_carlo(fast, n=1, **how).metrics["e_max_sys_m"].mean
    swept = umbmark.sweep(fast, {"eb": (1.01, 1.02, 2)}, n=1, **how)
    assert swept.points[0].metrics["e_max_sys_m"].mean == one
    how["update"] = "arc"
    assert umbmark.sweep(fast, {"eb": (1.01, 1.02, 2)}, n=1, **how) != swept
    grades = [{"name": "eb", "mean": 1.01, "sd": 1e-3}]
    keys: dict[str, Any] = {"parameters": grades, "model": fast, "runs": 1}
    for work in (
        lambda **how: umbmark.tolerance(robots=200, **keys, **how),
        lambda **how: umbmark.sensitivity(effort=32, **keys, **how),
    ):
        work(update="euler")
        with pytest.raises(ValueError, match="update must be one of arc, midpoint, euler"):
            work(update="middle")


def test_results_compare_by_value_with_all_trials_and_bins() -> None:
    study = umbmark.Study(MODEL, n=300, runs=1)
    one, two = (study.run()[0] for _ in range(2))
    assert one == two
    assert one != umbmark.Study(MODEL, n=300, runs=1, seed=2).run()[0]
    kept = [umbmark.monte_carlo(MODEL, n=300, runs=1, keep=True) for _ in range(2)]
    same = [msgspec.structs.replace(found, trials_per_s=None) for found in kept]
    assert same[0] == same[1]
    assert pickle.loads(pickle.dumps(same[0])) == same[1]
    assert same[0].trials is not None
    other = {key: value + 1 for key, value in same[0].trials.items()}
    assert msgspec.structs.replace(same[0], trials=other) != same[1]
    assert msgspec.structs.replace(same[0], trials=None) != same[1]
    assert same[0] != "a study"


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
            umbmark.simulate(MODEL, runs=30, reference_rate_hz=0),
            MODEL.remove("wheelbase"),
            draws=99_999,
        ),
    ],
)
def test_ctrl_c_is_heard_at_once(work: object) -> None:
    assert callable(work)
    # A process that was started in the background ignores the signal.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.5, _thread.interrupt_main)
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
        ({"n": 10**15}, "n must be between 1 and 1000000000000, got"),
        ({"runs": (0, 0)}, "number of runs must be between 1"),
        ({"odometry": "wheels"}, "odometry must be one of robot, ticks, tick_by_tick, continuous"),
        ({"phase": "edgy"}, 'phase must be one of random, edge, got "edgy"'),
    ],
)
def test_an_impossible_study_is_a_value_error(keys: dict[str, int], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        umbmark.monte_carlo(MODEL, **keys)  # type: ignore[arg-type]
