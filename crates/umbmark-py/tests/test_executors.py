"""Studies on executors of every kind: the bits of one process, workers that fail, die or are late.

Ray and joblib are tried where they are installed.
"""

import logging
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import (
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
)
from typing import Any

import pytest
import umbmark
import umbmark.distributed

pytestmark = pytest.mark.filterwarnings("ignore")

MODEL = umbmark.Model().add("wheelbase", e_b={"mean": 1.01, "sd": 0.002})
MODEL = MODEL.add("wheel_noise", k_sqrt_m=1e-3)
KEYS: dict[str, Any] = {"n": 8000, "runs": 1, "seed": 9}
STUDY = umbmark.Study(MODEL, **KEYS)
CHUNK: dict[str, Any] = {"chunk": 512, "workers": 2}


@pytest.fixture(scope="module")
def alone() -> umbmark.MonteCarlo:
    """Return the study in one process."""
    return umbmark.monte_carlo(MODEL, **KEYS)


class Here:
    """The least that an executor is: it works at once, and what it returns has a result."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> "Done":
        return Done(function(*arguments))


class Done:
    def __init__(self, part: object) -> None:
        self._part = part

    def result(self) -> Any:
        return self._part


def late(executor: Executor) -> Executor:
    """Let every third chunk come late."""
    submit, begun = executor.submit, iter(range(10**6))

    def slow(function: Callable[..., Any], *arguments: Any) -> Any:
        time.sleep(0.05)
        return function(*arguments)

    def begin(function: Callable[..., Any], /, *arguments: Any) -> Any:
        return submit(*((slow,) if next(begun) % 3 == 0 else ()), function, *arguments)

    executor.submit = begin  # type: ignore[method-assign, assignment]
    return executor


@pytest.fixture(scope="module")
def pool() -> Iterator[ProcessPoolExecutor]:
    """Return a pool of two processes."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(2, mp_context=context) as made:
        yield made


def test_any_executor_gives_the_bits_of_one_process(
    alone: umbmark.MonteCarlo, pool: ProcessPoolExecutor
) -> None:
    with ThreadPoolExecutor(3) as threads:
        for executor in (Here(), threads, pool, late(threads)):
            assert umbmark.distributed.monte_carlo(executor, STUDY, **CHUNK) == alone


def test_sensitivities_and_verdicts_are_those_of_one_process(pool: ProcessPoolExecutor) -> None:
    parameters = [{"name": "side", "min": 2, "max": 5}]
    study = umbmark.Study(MODEL, runs=1, seed=5)
    keys: dict[str, Any] = {"parameters": parameters, "workers": 2}
    many = umbmark.distributed.sensitivity(pool, study, base_points=64, **keys)
    assert many == umbmark.sensitivity(MODEL, parameters=parameters, effort=64, runs=1, seed=5)
    asked: dict[str, Any] = {"n": 3, "runs": 3, "draws": 99, "path": umbmark.Path(side_m=1.0)}
    verdicts = umbmark.distributed.verdicts
    assert verdicts(pool, MODEL, chunk=1, **asked) == verdicts(Here(), MODEL, chunk=2, **asked)


class Counted(ThreadPoolExecutor):
    """Threads that note how many chunks were begun, and how many of them cancelled."""

    def __init__(self, fails: Callable[[int], BaseException | None] = lambda _: None) -> None:
        super().__init__(1)
        self.fails = fails
        self.begun: list[Future[Any]] = []

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **_: Any) -> Future[Any]:
        error = self.fails(len(self.begun))

        def failing() -> None:
            assert error is not None
            raise error

        asked = (function, *arguments) if error is None else (failing,)
        self.begun.append(super().submit(*asked))
        return self.begun[-1]


def test_a_chunk_whose_worker_fails_is_tried_again_and_logged(
    alone: umbmark.MonteCarlo, caplog: pytest.LogCaptureFixture
) -> None:
    with Counted(lambda begun: OSError("no room") if begun in (3, 5) else None) as executor:
        assert umbmark.distributed.monte_carlo(executor, STUDY, **CHUNK) == alone
        assert len(executor.begun) == 16 + 2
    said = [record.getMessage() for record in caplog.records]
    assert said == [f"chunk {i} failed, retry 1 of 3: OSError('no room')" for i in (3, 5)]
    assert {(record.name, record.levelno) for record in caplog.records} == {
        ("umbmark.distributed", logging.WARNING)
    }


def test_a_chunk_that_always_fails_ends_the_study_and_so_does_a_wrong_one_at_once() -> None:
    with (
        Counted(lambda _: OSError("no room")) as executor,
        pytest.raises(OSError, match="no room"),
    ):
        umbmark.distributed.monte_carlo(executor, STUDY, chunk=8000, workers=1)
    assert len(executor.begun) == 1 + 3
    with Counted() as executor, pytest.raises(ValueError, match="number of runs"):
        umbmark.distributed.monte_carlo(executor, umbmark.Study(MODEL, n=10, runs=0))
    assert len(executor.begun) == 1
    with pytest.raises(ValueError, match="workers must be between 1 and 1000000, got 0"):
        umbmark.distributed.monte_carlo(Here(), STUDY, workers=0)


def test_a_precise_study_cancels_what_it_does_not_need() -> None:
    gate = threading.Event()
    with Counted() as executor:

        def at(done: int, _: int) -> None:
            # The only thread waits until the study has ended.
            executor.begun.append(ThreadPoolExecutor.submit(executor, gate.wait))

        found = umbmark.distributed.monte_carlo(
            executor, STUDY, chunk=512, workers=4, until_std_error_m=1.0, progress=at
        )
        cancelled = [future for future in executor.begun if future.cancelled()]
        gate.set()
    assert (found.n, found.partial) == (512, False)
    assert 0 < len(cancelled) <= 15


def test_chunks_ahead_are_four_for_each_worker() -> None:
    most = 0

    class Watched(Here):
        ahead = 0

        def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Done:
            nonlocal most
            self.ahead += 1
            most = max(most, self.ahead)
            return super().submit(function, *arguments)

    executor = Watched()

    def at(done: int, _: int) -> None:
        executor.ahead -= 1

    umbmark.distributed.monte_carlo(executor, STUDY, chunk=256, workers=3, progress=at)
    assert most == 12


def test_a_broken_pool_says_so(caplog: pytest.LogCaptureFixture) -> None:
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(2, mp_context=context) as pool:
        killed = list[int]()

        def at(*_: int) -> None:
            if not killed:
                killed.append(next(iter(pool._processes)))
                os.kill(killed[0], signal.SIGKILL)
                # Until it is seen.
                time.sleep(0.5)

        with pytest.raises(BrokenExecutor):
            umbmark.distributed.monte_carlo(pool, STUDY, progress=at, **CHUNK)
    assert caplog.records == []


def test_joblib_s_processes_are_an_executor(alone: umbmark.MonteCarlo) -> None:
    loky = pytest.importorskip("joblib.externals.loky")
    executor = loky.get_reusable_executor(max_workers=2)
    assert umbmark.distributed.monte_carlo(executor, STUDY, **CHUNK) == alone
    executor.shutdown()


def test_a_worker_of_ray_is_killed_and_no_bit_changes(alone: umbmark.MonteCarlo) -> None:
    ray = pytest.importorskip("ray")

    class OnRay:
        def __init__(self) -> None:
            self._run = ray.remote(lambda function, *arguments: function(*arguments))

        def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Any:
            return self._run.remote(function, *arguments).future()

    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, logging_level="ERROR")
    executor, killed = OnRay(), list[int]()

    def at(done: int, _: int) -> None:
        if not killed:
            killed.append(executor.submit(os.getpid).result())
            os.kill(killed[0], signal.SIGKILL)

    assert umbmark.distributed.monte_carlo(executor, STUDY, progress=at, **CHUNK) == alone
    assert killed[0] != os.getpid()
    ray.shutdown()
