"""Which parameter drives which metric."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed
from umbmark._parameters import Correlations, Parameters, keys_of
from umbmark._progress import Bar, Progress
from umbmark._result import Printed, Row
from umbmark._umbmark import Model, Path, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# What is spent where nothing is said: base points, trajectories, tests on each side.
EFFORT = {"sobol": 4096, "morris": 100, "local": 1000}


class Sensitivity(_documents.Sensitivity, Printed, frozen=True):
    """Which parameter drives which metric."""

    text: str

    def table(self) -> list[Row]:
        """Give every sensitivity of every metric, one dict a row."""
        rows: list[Row] = []
        for metric, of in self.metrics.items():
            for index in ("first", "total", "mu", "mu_star", "sigma", "per_unit", "per_spread"):
                estimates: Any = getattr(of, index)
                if isinstance(estimates, dict):
                    rows += [_row(metric, index, name, e) for name, e in estimates.items()]
        return rows

    def plot(self, ax: Axes | None = None, *, metric: str = "e_max_sys_m") -> Axes:
        """Draw the sensitivities of a metric, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.sensitivity(self, ax, metric)


def _row(metric: str, index: str, parameter: str, estimate: _documents.WithInterval) -> Row:
    low, high = estimate.interval
    named = {"metric": metric, "index": index, "parameter": parameter}
    return named | {"value": estimate.value, "low": low, "high": high}


def sensitivity(
    model: Model,
    path: Path | None = None,
    *,
    method: str = "sobol",
    effort: int | None = None,
    second_order: bool = False,
    noise_free: bool = False,
    runs: int | tuple[int, int] = 5,
    parameters: Parameters | None = None,
    correlations: Correlations | None = None,
    seed: Seed = 1,
    odometry: str = "robot",
    update: str = "arc",
    phase: str = "random",
    threads: int = 0,
    progress: Progress = None,
) -> Sensitivity:
    """Find which parameter drives which metric of whole UMBmark tests.

    Parameters
    ----------
    model : Model
        The robot; what varies are the parameters that have a distribution, and ``parameters``.
    path : Path, optional
        The path; the paper's 4 x 4 m square where none is given.
    method : str, default "sobol"
        "sobol" (shares of the variance), "morris" (a first screening) or "local" (derivatives).
    effort : int, optional
        Base points of Sobol indices, a power of two (4096); trajectories of Morris (100); tests on
        each side for derivatives (1000).
    second_order : bool, default False
        Sobol indices of pairs too.
    noise_free : bool, default False
        Whether to ask the return of exact kinematics, and not whole tests.
    runs : int or tuple of int, default 5
        Runs in each direction, or (cw, ccw).
    parameters : path-like or sequence of dict, optional
        A file of parameters that vary too, or its tables: {"name": "side", "min": 2, "max": 5}.
        What ``umbmark mc`` has a flag with a number for can be varied.
    correlations : dict of (str, str) to float, optional
        Correlations of the normal scores of two of them.
    seed, odometry, update, phase, threads, progress
        As of ``monte_carlo``.

    Raises
    ------
    ValueError
        If nothing is varied, or a number is out of range.

    Examples
    --------
    >>> import umbmark
    >>> model = umbmark.Model().add("wheel_diameter_ratio", e_d={"mean": 1, "sd": 1e-4})
    >>> model = model.add("wheelbase", e_b={"mean": 1, "sd": 5e-3})
    >>> found = umbmark.sensitivity(model, noise_free=True, effort=256)
    >>> found.metrics["return_heading_cw_rad"].first["wheelbase.e_b"].value > 0.9
    True
    """
    if effort is None:
        effort = EFFORT.get(method, 1)
    study = Study(
        model,
        path,
        n=effort,
        runs=runs,
        seed=seed,
        odometry=odometry,
        update=update,
        phase=phase,
    )
    keys = None if parameters is None else keys_of(parameters, correlations)
    with Bar(progress, 1000, "steps") as bar:
        document, text = _umbmark.sensitivity(
            study, keys, method, effort, second_order, noise_free, threads, bar.at
        )
    return Sensitivity._of(document, text=text)
