"""Before the robot is driven: what a test would show, and how many runs it takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed, by_name, indices, options_of, real, whole
from umbmark._progress import Bar, Progress
from umbmark._result import Printed, Row
from umbmark._scores import Data, data_of, model_of
from umbmark._umbmark import Dataset, Model, Path

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# As many as the core counts.
MOST_RUNS = (1 << 32) - 1


class Plan(_documents.Plan, Printed, frozen=True):
    """What a test would show before it is driven.

    Attributes
    ----------
    sheets : dict[str, str]
        The sheet to drive by, as "md" and as "html".
    """

    sheets: dict[str, str]
    text: str

    def sheet(self, format: str = "md") -> str:
        """Give the sheet to drive by, steps and the table to fill in, as "md" or "html"."""
        if format not in self.sheets:
            raise ValueError(f'format must be one of {", ".join(self.sheets)}, got "{format}"')
        return self.sheets[format]

    def table(self) -> list[Row]:
        """Give what each number of runs shows, one dict a row."""
        return [
            {
                "runs": row.runs,
                "minutes": row.minutes,
                "e_max_sys_mean_m": row.e_max_sys_m.mean,
                "e_max_sys_std_dev_m": row.e_max_sys_m.std_dev,
                "interval_half_width_m": row.e_max_sys_m.interval_half_width_m,
                "noise_band_m": row.e_max_sys_m.noise_band_m,
            }
            | {f"least_{least.effect}.{least.parameter}": least.size for least in _first(row)}
            for row in self.by_runs
        ]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw what E_max,sys would read, by the number of runs, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.plan(self, ax)


def _first(row: _documents.OfRuns) -> tuple[_documents.LeastSize, ...]:
    """Give the least E_d and E_b."""
    return row.minimum_detectable[:2]


class Separation(_documents.Separation, Printed, frozen=True):
    """Experiments that separate two effects, the most informative per minute first."""

    text: str

    def table(self) -> list[Row]:
        """Give the experiments, one dict a row."""
        return [
            {
                "experiment": e.experiment,
                "sd": e.sd,
                "minutes": e.minutes,
                "sd2_a_minute": e.sd**2 / e.minutes,
            }
            for e in self.next_experiments
        ]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw what each experiment tells, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.separation(self, ax)


@dataclass(frozen=True)
class _Whose:
    """Whose test is planned, as the extension reads it."""

    data: Dataset | None
    model: Model | None
    path: Path | None
    sigma_m: float | None
    with_heading: bool
    seed: int


def plan(
    data: Data | None = None,
    *,
    model: Model | None = None,
    path: Path | None = None,
    runs: int = 5,
    see: Mapping[str, float] | None = None,
    sigma_m: float | None = None,
    power: float = 0.9,
    size: float = 0.05,
    with_heading: bool = True,
    numbers: Sequence[int] = tuple(range(3, 31)),
    order: str = "mirrored",
    draws: int = 999,
    seed: Seed = 1,
    threads: int = 0,
    progress: Progress = None,
) -> Plan:
    """Plan a test: how many runs, what they would show, and the sheet to drive by.

    Parameters
    ----------
    data : Dataset or path-like, optional
        Measured runs of the robot, whose errors and scatter are planned with.
    model : Model, optional
        The robot in place of the data's; without data the paper's LabMate with a wheel noise of
        0.001 m^0.5 where none is given.
    path : Path, optional
        The path; the data's, or the paper's 4 x 4 m square.
    runs : int, default 5
        Runs in each direction that are planned.
    see : dict of str to float, optional
        Sizes that are to be seen: {"eb": 1.005, "floor_slope.drift_x": 0.002}.
    sigma_m : float, optional
        Scatter of the return positions, one coordinate, in m; that of the noise or of the data.
    power : float, default 0.9
        Probability with which it is to be seen.
    size : float, default 0.05
        False-alarm rate: probability of detecting an effect that the robot lacks.
    with_heading : bool, default True
        Whether return headings are measured.
    numbers : sequence of int, default 3 to 30
        Numbers of runs a direction to look at.
    order : str, default "mirrored"
        Order of the runs on the sheet: "mirrored", "alternating" or "blocks".
    draws : int, default 999
        Simulated tests behind every figure that has no closed form.
    seed, threads, progress
        As of ``monte_carlo``.

    Returns
    -------
    Plan

    Raises
    ------
    ValueError
        If the test cannot be planned, or a number is out of range.

    Examples
    --------
    >>> import umbmark
    >>> found = umbmark.plan(see={"eb": 1.005}, sigma_m=0.05, numbers=[5], draws=99)
    >>> found.see[0].runs, found.see[0].power > 0.99
    (4, True)
    >>> print(found.sheet().splitlines()[0])
    # UMBmark test sheet: TRC LabMate
    """
    asked = by_name("see", {} if see is None else see, "sizes")
    sizes = [(name, real(f'see["{name}"]', value)) for name, value in asked]
    options = options_of(size, draws, seed)
    whose = _Whose(_read(data), model_of(model), path, sigma_m, with_heading, options[2])
    with Bar(progress, 1000, "steps") as bar:
        document, text, markdown, html = _umbmark.plan(
            whose,
            whole("runs", runs, 0, MOST_RUNS),
            sizes,
            real("power", power),
            [whole("numbers", number, 0, MOST_RUNS) for number in indices("numbers", numbers)],
            order,
            options,
            threads,
            bar.at,
        )
    return Plan._of(document, sheets={"md": markdown, "html": html}, text=text)


def separate(
    first: str,
    second: str,
    data: Data | None = None,
    *,
    model: Model | None = None,
    path: Path | None = None,
    runs: int = 5,
    sigma_m: float | None = None,
    with_heading: bool = True,
    seed: Seed = 1,
    threads: int = 0,
) -> Separation:
    """Rank experiments by how well they tell two effects apart, per minute.

    Parameters
    ----------
    first, second : str
        The two effects.
    data : Dataset or path-like, optional
        What is measured already: return poses, or tracks.
    model, path, runs, sigma_m, with_heading, seed, threads
        As of ``plan``: the test that is planned, where there is no data.

    Returns
    -------
    Separation

    Raises
    ------
    ValueError
        If there is no such effect, or nothing to judge by.

    Examples
    --------
    >>> import umbmark
    >>> umbmark.separate("wheelbase", "scale").next_experiments[0].sd > 3
    True
    """
    options = options_of(0.05, 999, seed)
    whose = _Whose(_read(data), model_of(model), path, sigma_m, with_heading, options[2])
    document, text = _umbmark.separate(
        (first, second), whose, whole("runs", runs, 0, MOST_RUNS), options, threads
    )
    return Separation._of(document, text=text)


def _read(data: Data | None) -> Dataset | None:
    return None if data is None else data_of(data)
