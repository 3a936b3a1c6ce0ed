"""Studies on a cluster of processes: the bits of one process, a worker killed in the middle.

A long study, 1e8 trials on four workers and on one, runs where UMBMARK_LONG_STUDIES is set.
"""

import os
import signal
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import umbmark
import umbmark.distributed
from distributed import Client, LocalCluster

pytestmark = [
    pytest.mark.filterwarnings("ignore"),
    # Clusters say much while workers come and go.
    pytest.mark.usefixtures("quiet"),
]

MODEL = umbmark.Model().add("wheelbase", e_b={"mean": 1.01, "sd": 0.002})
MODEL = MODEL.add("wheel_noise", k_sqrt_m=1e-3)
SHARES = np.linspace(0, 1, 21)


@pytest.fixture
def quiet() -> None:
    import logging

    for name in ("distributed", "distributed.nanny", "distributed.scheduler"):
        logging.getLogger(name).setLevel(logging.CRITICAL)


def cluster(workers: int) -> Iterator[Client]:
    made: Any = LocalCluster
    with (
        made(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address=None,
        ) as local,
        Client(local) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def client() -> Iterator[Client]:
    """Return a client of three processes."""
    yield from cluster(3)


def bits(found: umbmark.MonteCarlo) -> list[bytes]:
    """Return all that is known of each metric."""
    return [
        np.array([*found.ensemble.quantile(m, SHARES), found.ensemble.mean(m)]).tobytes()
        + np.array([found.ensemble.std_dev(m)]).tobytes()
        for m in found.ensemble.metrics
    ]


def kill_one(client: Client) -> int:
    """Kill the process of one worker, as a machine that fails would."""
    pids = client.run(os.getpid)
    victim = next(iter(pids.values()))
    os.kill(victim, signal.SIGKILL)
    return int(victim)


def test_a_killed_worker_changes_no_bit(client: Client) -> None:
    keys: dict[str, Any] = {"n": 20_000, "runs": 1, "seed": 9}
    killed: list[int] = []

    def at(done: int, _: int) -> None:
        if done > 4000 and not killed:
            killed.append(kill_one(client))

    study = umbmark.Study(MODEL, **keys)
    many = umbmark.distributed.monte_carlo(client, study, chunk=1024, progress=at)
    assert killed
    assert killed[0] not in client.run(os.getpid).values()
    one = umbmark.monte_carlo(MODEL, **keys)
    assert (many.n, many.partial, bits(many)) == (20_000, False, bits(one))
    documents = [found.to_dict() | {"trials_per_s": None} for found in (many, one)]
    assert documents[0] == documents[1]


def test_a_precise_study_ends_at_the_same_trial_whatever_the_chunks_do(client: Client) -> None:
    def found(on: Client) -> umbmark.MonteCarlo:
        study = umbmark.Study(MODEL, runs=1, n=200_000)
        return umbmark.distributed.monte_carlo(on, study, until_std_error_m=2e-3, chunk=512)

    many = found(client)
    assert not many.partial
    assert many.n < 200_000
    assert (many.metrics["e_max_sys_m"].std_error or 1) <= 2e-3
    for alone in cluster(1):
        again = found(alone)
    assert (again.n, bits(again)) == (many.n, bits(many))


def test_sobol_indices_are_those_of_one_process_though_a_worker_is_killed(client: Client) -> None:
    parameters = [{"name": "side", "min": 2, "max": 5}]
    killed: list[int] = []

    def at(done: int, _: int) -> None:
        if done > 20 and not killed:
            killed.append(kill_one(client))

    study = umbmark.Study(MODEL, runs=2, seed=5)
    many = umbmark.distributed.sensitivity(
        client, study, parameters=parameters, base_points=2048, chunk=3, progress=at
    )
    assert killed
    one = umbmark.sensitivity(MODEL, parameters=parameters, effort=2048, runs=2, seed=5)
    assert many == one
    assert not many.partial
    with pytest.raises(ValueError, match="nothing is varied"):
        umbmark.distributed.sensitivity(client, umbmark.Study(umbmark.Model()))


def test_verdicts_on_complete_robots_are_those_of_one_process(client: Client) -> None:
    keys: dict[str, Any] = {"n": 4, "runs": 3, "draws": 99, "path": umbmark.Path(side_m=1.0)}
    many = umbmark.distributed.verdicts(client, MODEL, chunk=2, **keys)
    assert sum(many.counts.values()) == 4
    said = [
        umbmark.diagnose(
            umbmark.simulate(MODEL, keys["path"], runs=3, reference_rate_hz=0, trial=trial),
            draws=99,
            seed=trial,
        ).verdict
        for trial in range(4)
    ]
    assert many.counts == {verdict: said.count(verdict) for verdict in sorted(set(said))}
    assert many == umbmark.distributed.verdicts(client, MODEL, chunk=3, **keys)
    share, (low, high) = many.share("explained")
    assert low <= share <= high
    assert many.table()[0]["count"] == many.counts[many.table()[0]["verdict"]]


def test_a_hidden_effect_is_named(client: Client) -> None:
    sloped = MODEL.add("wheel_noise", k_sqrt_m=2e-4).add("floor_slope", drift_x=0.02)
    keys: dict[str, Any] = {"n": 1, "runs": 3, "draws": 99, "path": umbmark.Path(side_m=1.0)}
    found = umbmark.distributed.verdicts(client, sloped, ask="learn", chunk=1, **keys)
    assert found.named
    assert all("floor_slope" in names for names in found.named)


def test_many_robots_are_learnt_as_one_by_one(client: Client) -> None:
    path = umbmark.Path(side_m=1.0)
    fleet = [
        umbmark.simulate(MODEL, path, runs=3, reference_rate_hz=0, seed=seed) for seed in (1, 2)
    ]
    learnt = umbmark.each(umbmark.learn, fleet, executor=client, draws=99)
    assert [*learnt.values()] == [umbmark.learn(data, draws=99) for data in fleet]


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"ask": "guess", "n": 1}, "ask must be one of diagnose, learn"),
        ({"n": 0}, "n and chunk must be 1 or more, got 0 and 16"),
    ],
)
def test_an_impossible_study_is_a_value_error(
    client: Client, keys: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        umbmark.distributed.verdicts(client, MODEL, **keys)


def test_what_a_chunk_refuses_reaches_the_caller(client: Client) -> None:
    with pytest.raises(ValueError, match="number of runs"):
        umbmark.distributed.monte_carlo(client, umbmark.Study(MODEL, n=10, runs=0))
    with pytest.raises(ValueError, match="chunk must be 1 or more"):
        umbmark.distributed.monte_carlo(client, umbmark.Study(MODEL, n=10), chunk=0)


@pytest.mark.skipif("UMBMARK_LONG_STUDIES" not in os.environ, reason="UMBMARK_LONG_STUDIES")
def test_a_hundred_million_trials_on_four_workers_are_those_on_one() -> None:
    told = []
    for workers in (4, 1):
        for client in cluster(workers):
            began = time.perf_counter()
            study = umbmark.Study(MODEL, n=100_000_000, runs=1, seed=2)
            found = umbmark.distributed.monte_carlo(client, study)
            told.append(bits(found))
            seconds = time.perf_counter() - began
            print(f"{workers} workers: {seconds:.0f} s, E_max {found.metrics['e_max_sys_m']}")
    assert told[0] == told[1]
