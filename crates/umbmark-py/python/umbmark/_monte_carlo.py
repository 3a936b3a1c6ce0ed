"""Monte Carlo of whole UMBmark tests."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed
from umbmark._errors import needs
from umbmark._progress import Bar, Progress
from umbmark._result import Printed, Row
from umbmark._umbmark import Ensemble, Model, Path, Study

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

# The most trials of a study that stops by precision.
MOST_UNTIL = 1_000_000_000


class MonteCarlo(_documents.MonteCarlo, Printed, frozen=True):
    """What a study found.

    Attributes
    ----------
    ensemble : Ensemble
        The statistics themselves: any quantile, and what merges with others.
    trials : mapping of str to ndarray of float64, shape (n,), or None
        The metrics of every trial, where they were kept.
    """

    _of_row: ClassVar[tuple[str, ...]] = ("mean", "std_error", "std_dev", "q*")
    _uncompared: ClassVar[tuple[str, ...]] = ("trials_per_s", "text")

    ensemble: Ensemble
    trials: Mapping[str, NDArray[np.float64]] | None
    text: str

    def table(self) -> list[Row]:
        """Give the statistics of each metric, one dict a row."""
        return [
            {"metric": name, "mean": m.mean, "std_error": m.std_error, "std_dev": m.std_dev}
            | {f"q{share}": value for share, value in m.quantiles.items()}
            for name, m in self.metrics.items()
        ]

    def to_xarray(self) -> xr.Dataset:
        """Give the metrics of every trial as an xarray Dataset along ``trial``.

        Raises
        ------
        ValueError
            If they were not kept: say ``keep=True``.
        """
        with needs("frames"):
            import xarray as xr

        if self.trials is None:
            raise ValueError("the metrics of single trials were not kept; say keep=True")
        variables = {name: ("trial", values) for name, values in self.trials.items()}
        return xr.Dataset(variables, attrs={"seed": self.seed})

    def plot(self, ax: Axes | None = None, *, metric: str = "e_max_sys_m") -> Axes:
        """Draw the distribution of a metric over the trials, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.monte_carlo(self, ax, metric)


def monte_carlo(
    model: Model,
    path: Path | None = None,
    *,
    n: int | None = None,
    runs: int | tuple[int, int] = 5,
    seed: Seed = 1,
    until_std_error_m: float | None = None,
    odometry: str = "robot",
    update: str = "arc",
    phase: str = "random",
    keep: bool = False,
    checkpoint: str | PathLike[str] | None = None,
    resume: bool = False,
    replace: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> MonteCarlo:
    """Simulate whole UMBmark tests by the thousand.

    Parameters
    ----------
    model : Model
        The robot and its effects; parameters with a distribution are drawn anew for each trial.
    path : Path, optional
        The path; the paper's 4 x 4 m square where none is given.
    n : int, optional
        Trials: whole tests, each with all its runs. 1000, or as many as it takes with
        ``until_std_error_m``.
    runs : int or tuple of int, default 5
        Runs in each direction, or (cw, ccw).
    seed : int, numpy Generator, BitGenerator or SeedSequence, or None, default 1
        Seed of all random numbers: the same seed gives the same bits for any number of threads.
        None draws a fresh one, which the result has.
    until_std_error_m : float, optional
        Stop as soon as the standard error of the mean E_max,sys is this small, in m.
    odometry, update, phase : str
        As of ``Study``.
    keep : bool, default False
        Whether to keep the metrics of every trial.
    checkpoint : path-like, optional
        Write what is done to this file every two seconds and at the end, Ctrl-C included: the file
        of ``umbmark mc --checkpoint``.
    resume, replace : bool, default False
        Where that file is there: go on with its study, or begin anew. Else it is refused.
    threads : int, default 0
        Threads to use; 0 for all processors.
    progress : bool or callable, optional
        True for a bar of tqdm; or a function of the trials done and of all.

    Returns
    -------
    MonteCarlo

    Raises
    ------
    ValueError
        If the test cannot be driven, a number is out of range, or the checkpoint is of another
        study.

    Examples
    --------
    >>> import umbmark
    >>> model = umbmark.Model().add("wheel_diameter_ratio", e_d=1.00121)
    >>> model = model.add("wheelbase", e_b=337.2 / 340)
    >>> found = umbmark.monte_carlo(model, n=200)
    >>> print(f"{found.metrics['e_max_sys_m'].mean:.3f} m")
    0.306 m
    """
    if n is None:
        n = 1000 if until_std_error_m is None else MOST_UNTIL
    study = Study(
        model, path, n=n, runs=runs, seed=seed, odometry=odometry, update=update, phase=phase
    )
    with Bar(progress, n, "trials") as bar:
        ensemble, trials, trials_per_s = study.run(
            checkpoint=checkpoint,
            resume=resume,
            replace=replace,
            threads=threads,
            until_std_error_m=until_std_error_m,
            keep=keep,
            progress=bar.at,
        )
    precise = is_precise(ensemble, until_std_error_m)
    partial = ensemble.trials < n and not precise
    return result_of(study, ensemble, partial, trials_per_s, trials)


def merge(
    *files: str | PathLike[str],
    output: str | PathLike[str] | None = None,
    replace: bool = False,
) -> MonteCarlo:
    """Put shards or checkpoints of one study together, in any order, to the bits of one run.

    Parameters
    ----------
    *files : path-like
        Files of ``umbmark mc --checkpoint``, ``monte_carlo(checkpoint=...)`` or ``Study.run``.
    output : path-like, optional
        Write the merged checkpoint to this file.
    replace : bool, default False
        Whether that file is replaced where it is there.

    Returns
    -------
    MonteCarlo
        ``partial`` where trials are missing; ``ensemble.missing`` says which.

    Raises
    ------
    ValueError
        If a file is no checkpoint, they are of different studies, or have trials in common.

    Examples
    --------
    >>> import pathlib, tempfile, umbmark
    >>> model = umbmark.Model().add("wheel_noise", k_sqrt_m=0.001)
    >>> study = umbmark.Study(model, n=1000)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     files = [pathlib.Path(folder) / f"{index}.json" for index in range(2)]
    ...     for index, file in enumerate(files):
    ...         _ = study.run((index, 2), checkpoint=file)
    ...     merged = umbmark.merge(*files)
    >>> merged.n, merged.partial, merged.metrics == umbmark.monte_carlo(model, n=1000).metrics
    (1000, False, True)
    """
    document, text, ensemble = _umbmark.merge([*files], output, replace)
    return MonteCarlo._of(document, ensemble=ensemble, trials=None, text=text)


def is_precise(ensemble: Ensemble, until_std_error_m: float | None) -> bool:
    """Whether the standard error of the mean E_max,sys is as small as was asked for."""
    wanted = until_std_error_m
    return wanted is not None and ensemble.std_error("e_max_sys_m") <= wanted


def result_of(
    study: Study,
    ensemble: Ensemble,
    partial: bool,
    trials_per_s: float | None,
    trials: Mapping[str, NDArray[np.float64]] | None = None,
) -> MonteCarlo:
    """Give an ensemble of a study as a result."""
    document, text = study._document(ensemble, partial, trials_per_s)
    return MonteCarlo._of(document, ensemble=ensemble, trials=trials, text=text)
