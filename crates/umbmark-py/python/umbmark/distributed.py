"""Studies past one process, on any executor: Dask, Ray, joblib, ``concurrent.futures``.

A study is cut into chunks by its number of trials alone, never by the workers. A chunk is the study
(with its seed) and its place; whichever worker runs it, it gives the same bits, and results are
taken in the order of the chunks. So the answer is that of one process, whatever the workers, their
order, or how many of them die on the way.

Give it an ``Executor``: anything with ``submit(function, *arguments)`` that returns something with
``result()``. A Dask client and the pools of ``concurrent.futures`` are executors;
docs/distributed.md has recipes for Ray and joblib. Work holds one thread; start as many threads or
processes as there are cores.
"""

from __future__ import annotations

import functools
from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from umbmark._arguments import Seed, seed_of
from umbmark._diagnosis import diagnose, learn
from umbmark._executor import Executor, Future, in_order
from umbmark._monte_carlo import MonteCarlo, is_precise, result_of
from umbmark._parameters import Correlations, Parameters, keys_of
from umbmark._progress import Bar, Progress
from umbmark._result import Interval, Record, Row
from umbmark._sensitivity import Sensitivity
from umbmark._umbmark import Ensemble, Model, Path, Sobol, Study, __version__
from umbmark._umbmark import simulate as _simulate

__all__ = ["Executor", "Future", "Verdicts", "monte_carlo", "sensitivity", "verdicts"]


def monte_carlo(
    executor: Executor,
    study: Study,
    *,
    until_std_error_m: float | None = None,
    chunk: int = 65536,
    workers: int | None = None,
    progress: Progress = None,
) -> MonteCarlo:
    """Run a study on an executor: the bits of one process.

    Parameters
    ----------
    executor : Executor
        What runs the chunks: a Dask client, a pool of ``concurrent.futures``, and the like.
    study : Study
        The study: robot, path, number of trials, seed.
    until_std_error_m : float, optional
        Stop at the first chunk after which the standard error of the mean E_max,sys is this small,
        in m, with all chunks before it; at ``study.n`` trials at the latest.
    chunk : int, default 65536
        Trials of a chunk, about; with ``until_std_error_m`` the number of trials depends on it.
    workers : int, optional
        How many chunks the executor runs at a time; four times as many are submitted ahead. The
        threads of a Dask cluster, else the processors of this machine, where none is given. No
        number depends on it.
    progress : bool or callable, optional
        As of ``umbmark.monte_carlo``.

    Returns
    -------
    MonteCarlo
        Without the metrics of single trials.

    Raises
    ------
    ValueError
        If a number is out of range.
    Exception
        What the executor raises where it is broken, or a chunk failed four times.
    """
    count = _chunks(study.n, chunk)
    parts = in_order(executor, functools.partial(_shard, study, count), range(count), workers)
    merged: Ensemble | None = None
    with Bar(progress, study.n, "trials") as bar:
        for part in parts:
            merged = part if merged is None else merged.merge(part)
            bar.at(merged.trials)
            if is_precise(merged, until_std_error_m):
                parts.close()
                break
    assert merged is not None, "a study has at least one chunk"
    partial = merged.trials < study.n and not is_precise(merged, until_std_error_m)
    return result_of(study, merged, partial, None)


def _shard(study: Study, count: int, index: int) -> Ensemble:
    return study.run((index, count), threads=1)[0]


def sensitivity(
    executor: Executor,
    study: Study,
    *,
    parameters: Parameters | None = None,
    correlations: Correlations | None = None,
    base_points: int = 4096,
    second_order: bool = False,
    noise_free: bool = False,
    chunk: int = 8,
    workers: int | None = None,
    progress: Progress = None,
) -> Sensitivity:
    """Find Sobol indices on an executor: the bits of ``umbmark.sensitivity``.

    Parameters
    ----------
    executor, workers
        As of ``monte_carlo``.
    study : Study
        The robot, its path and its runs; what varies are the parameters of the model that have a
        distribution, and ``parameters``.
    parameters, correlations, second_order, noise_free
        As of ``umbmark.sensitivity``.
    base_points : int, default 4096
        Base points, a power of two.
    chunk : int, default 8
        Blocks of a chunk, of which there are 1024 at most; no number depends on it.
    progress : bool or callable, optional
        As of ``umbmark.monte_carlo``.

    Returns
    -------
    Sensitivity

    Raises
    ------
    ValueError
        If nothing is varied, or a number is out of range.
    """
    if chunk < 1:
        raise ValueError(f"chunk must be 1 or more, got {chunk}")
    keys = None if parameters is None else keys_of(parameters, correlations)
    asked = (study, keys, base_points, second_order, noise_free)
    design = Sobol(*asked)
    sums = []
    with Bar(progress, design.blocks, "blocks") as bar:
        work = functools.partial(_blocks, asked, design.blocks, chunk)
        for part in in_order(executor, work, range(-(-design.blocks // chunk)), workers):
            sums.append(part)
            bar.at(min(design.blocks, chunk * len(sums)))
    document, text = design.document(np.concatenate(sums))
    return Sensitivity._of(document, text=text)


def _blocks(
    asked: tuple[Study, str | dict[str, Any] | None, int, bool, bool],
    blocks: int,
    chunk: int,
    index: int,
) -> NDArray[np.float64]:
    """Give the sums of the blocks of one chunk; the design is the same everywhere."""
    return Sobol(*asked).sums(index * chunk, min(blocks, (index + 1) * chunk))


class Verdicts(Record, frozen=True):
    """What was said of simulated tests of one robot, of which the truth is known.

    Attributes
    ----------
    n : int
        Number of tests.
    counts : dict of str to int
        How often each verdict was given.
    named : dict of str to int
        How often each class of effects was the first that was certified, or added.
    seed : int
        Seed of all random numbers.
    """

    n: int
    counts: dict[str, int]
    named: dict[str, int]
    seed: int
    version: str = __version__

    def share(self, verdict: str, level: float = 0.95) -> tuple[float, Interval]:
        """Give the share of a verdict, and its interval with probability ``level`` (Wilson).

        Source: Wilson (1927), J. American Statistical Association 22.
        """
        from statistics import NormalDist

        z = NormalDist().inv_cdf(0.5 + 0.5 * level)
        share = self.counts.get(verdict, 0) / self.n
        middle = (share + z * z / (2 * self.n)) / (1 + z * z / self.n)
        spread = (share * (1 - share) / self.n + z * z / (4 * self.n**2)) ** 0.5
        half = z * spread / (1 + z * z / self.n)
        return share, (max(0.0, middle - half), min(1.0, middle + half))

    def table(self) -> list[Row]:
        """Give the verdicts with their shares and intervals, one dict a row."""
        rows = []
        for verdict, count in sorted(self.counts.items()):
            share, (low, high) = self.share(verdict)
            row = {"verdict": verdict, "count": count, "share": share, "low": low, "high": high}
            rows.append(row)
        return rows


def verdicts(
    executor: Executor,
    truth: Model,
    path: Path | None = None,
    *,
    n: int,
    ask: str = "diagnose",
    runs: int | tuple[int, int] = 5,
    reference_rate_hz: float = 0.0,
    size: float = 0.05,
    draws: int = 999,
    seed: Seed = 1,
    chunk: int = 16,
    workers: int | None = None,
    progress: Progress = None,
) -> Verdicts:
    """Ask many simulated tests of one robot what is missing: false alarms, or power.

    Of a robot with E_d and E_b alone, every verdict but "explained" is a false alarm; of one with a
    hidden effect, ``named`` says how often it was found.

    Parameters
    ----------
    executor, workers
        As of ``monte_carlo``.
    truth : Model
        The robot; parameters with a distribution are drawn anew for each test.
    path : Path, optional
        The path; the paper's 4 x 4 m square where none is given.
    n : int
        Number of tests.
    ask : str, default "diagnose"
        "diagnose", or "learn".
    runs, reference_rate_hz
        As of ``umbmark.simulate``; 0 Hz for return poses alone.
    size, draws
        As of ``umbmark.diagnose``.
    seed : int, numpy Generator, BitGenerator or SeedSequence, or None, default 1
        Seed of all random numbers.
    chunk : int, default 16
        Tests of a chunk; no number depends on it.
    progress : bool or callable, optional
        As of ``umbmark.monte_carlo``.

    Raises
    ------
    ValueError
        If a test cannot be driven, or a number is out of range.
    """
    if ask not in ("diagnose", "learn"):
        raise ValueError(f'ask must be one of diagnose, learn, got "{ask}"')
    if n < 1 or chunk < 1:
        raise ValueError(f"n and chunk must be 1 or more, got {n} and {chunk}")
    seed = seed_of(seed)
    both = (runs, runs) if isinstance(runs, int) else runs

    work = functools.partial(
        _asked, ask, truth, path, both, reference_rate_hz, size, draws, seed, n, chunk
    )
    counts: Counter[str] = Counter()
    named: Counter[str] = Counter()
    with Bar(progress, n, "tests") as bar:
        for said, first in in_order(executor, work, range(-(-n // chunk)), workers):
            counts.update(said)
            named.update(first)
            bar.at(counts.total())
    return Verdicts(n, dict(sorted(counts.items())), dict(sorted(named.items())), seed)


def _asked(
    ask: str,
    truth: Model,
    path: Path | None,
    runs: tuple[int, int],
    reference_rate_hz: float,
    size: float,
    draws: int,
    seed: int,
    n: int,
    chunk: int,
    index: int,
) -> tuple[Counter[str], Counter[str]]:
    """Give verdicts, and the classes first named, of the tests of one chunk."""
    counts: Counter[str] = Counter()
    named: Counter[str] = Counter()
    for trial in range(index * chunk, min(n, (index + 1) * chunk)):
        data = _simulate(
            truth, path, runs=runs, reference_rate_hz=reference_rate_hz, seed=seed, trial=trial
        )
        if ask == "diagnose":
            told = diagnose(data, size=size, draws=draws, seed=trial, threads=1)
            first = [" or ".join(suspect.class_) for suspect in told.ranking[: told.certified]]
            verdict = told.verdict
        else:
            learnt = learn(data, size=size, draws=draws, seed=trial, threads=1)
            first = [
                " or ".join(step.class_) for step in learnt.steps if step.p_adjusted is not None
            ]
            verdict = learnt.verdict
        counts[verdict] += 1
        named.update(first[:1])
    return counts, named


def _chunks(n: int, chunk: int) -> int:
    if chunk < 1:
        raise ValueError(f"chunk must be 1 or more, got {chunk}")
    # The most shards that a study may have.
    return max(1, min(-(-n // chunk), 1_000_000))
