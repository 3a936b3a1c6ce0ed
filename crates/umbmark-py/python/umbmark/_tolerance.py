"""How many robots are good enough, and the cheapest tolerances that make it enough."""

from __future__ import annotations

from typing import TYPE_CHECKING

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed, real, whole
from umbmark._parameters import Correlations, Parameters, keys_of
from umbmark._progress import Bar, Progress
from umbmark._result import Printed, Row
from umbmark._scores import model_of
from umbmark._umbmark import Model, Path, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Tolerance(_documents.Tolerance, Printed, frozen=True):
    """How many robots keep a target, and the cheapest tolerances with which enough do.

    Attributes
    ----------
    sizes : tuple[float, ...]
        The metric of the robots as they are now, in order.
    """

    sizes: tuple[float, ...]
    text: str

    def table(self) -> list[Row]:
        """Give the choices with their costs and intervals, one dict a row."""
        named = [("now", self.now)]
        named += [(self._changes(choice), choice) for choice in self.alone]
        named.append(("last", self.last))
        if self.cheapest is not None:
            named.append(("cheapest", self.cheapest))
        return [
            {
                "grades": name,
                "cost": choice.cost,
                "share_within": choice.share_within.value,
                "share_low": choice.share_within.interval[0],
                "share_high": choice.share_within.interval[1],
                "quantile": choice.quantile.value,
                "quantile_low": choice.quantile.interval[0],
                "quantile_high": choice.quantile.interval[1],
            }
            for name, choice in named
        ]

    def _changes(self, choice: _documents.Choice) -> str:
        changed = [
            f"{name}: grade {grade.grade}"
            for name, grade in choice.grades.items()
            if grade != self.now.grades[name]
        ]
        return ", ".join(changed)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the robots as they are now and the target, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.tolerance(self, ax)


def tolerance(
    parameters: Parameters,
    model: Model | None = None,
    path: Path | None = None,
    *,
    target: float = 0.05,
    share: float = 0.95,
    metric: str = "e_max_sys_m",
    robots: int = 10_000,
    with_noise: bool = False,
    correlations: Correlations | None = None,
    runs: int | tuple[int, int] = 5,
    seed: Seed = 1,
    odometry: str = "robot",
    update: str = "arc",
    phase: str = "random",
    threads: int = 0,
    progress: Progress = None,
) -> Tolerance:
    """Find the cheapest tolerances with which enough robots keep a target.

    Parameters
    ----------
    parameters : path-like or sequence of dict
        A file of parameters with their grades, or its tables: {"name": "ed", "grades": [{"mean":
        1, "sd": 0.001, "cost": 0}, {"mean": 1, "sd": 0.0002, "cost": 8}]}. The first grade is what
        is bought now.
    model : Model, optional
        The robot that they are parameters of; the paper's LabMate where none is given.
    path : Path, optional
        The path; the paper's 4 x 4 m square where none is given.
    target : float, default 0.05
        The most that the size of the metric may be, in m or rad.
    share : float, default 0.95
        The share of robots that must keep it.
    metric : str, default "e_max_sys_m"
        The metric of the target.
    robots : int, default 10000
        Robots drawn for each choice of grades.
    with_noise : bool, default False
        Judge what a whole test with its noise shows of each robot, not the robot itself.
    correlations : dict of (str, str) to float, optional
        Correlations of the normal scores of two parameters.
    runs, seed, odometry, update, phase, threads, progress
        As of ``monte_carlo``.

    Returns
    -------
    Tolerance

    Raises
    ------
    ValueError
        If there is no such parameter or metric, or a number is out of range.

    Examples
    --------
    >>> import umbmark
    >>> grades = [{"mean": 1, "sd": 0.01, "cost": 0}, {"mean": 1, "sd": 0.0005, "cost": 8}]
    >>> found = umbmark.tolerance([{"name": "eb", "grades": grades}], robots=1000)
    >>> found.now.share_within.value < 0.5, found.cheapest.cost
    (True, 8.0)
    """
    study = Study(
        model_of(model) or Model(),
        path,
        n=1,
        runs=runs,
        seed=seed,
        odometry=odometry,
        update=update,
        phase=phase,
    )
    keys = keys_of(parameters, correlations)
    wanted = (real("target", target), real("share", share))
    robots = whole("robots", robots, 0, (1 << 32) - 1)
    with Bar(progress, 1000, "steps") as bar:
        document, text, sizes = _umbmark.tolerance(
            study, keys, metric, wanted, robots, with_noise, threads, bar.at
        )
    return Tolerance._of(document, sizes=sizes, text=text)
