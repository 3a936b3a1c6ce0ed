"""Many robots of one kind: a row each, and how far they are apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed, options_of
from umbmark._each import named
from umbmark._progress import Bar, Progress
from umbmark._result import Printed, Row
from umbmark._scores import Data, data_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Survey(_documents.Survey, Printed, frozen=True):
    """Many robots of one kind."""

    text: str

    def table(self) -> list[Row]:
        """Give a row for each robot: numbers with errors, score, verdict, what stands out."""
        keys = list(dict.fromkeys(one.parameter for robot in self.robots for one in robot.fitted))
        rows: list[Row] = []
        for robot in self.robots:
            row: Row = {"robot": robot.robot, "runs": robot.runs}
            fitted = {one.parameter: one for one in robot.fitted}
            for key in keys:
                row[key] = fitted[key].value if key in fitted else None
                row[f"{key}_standard_error"] = fitted[key].standard_error if key in fitted else None
            row["e_max_sys_m"] = robot.e_max_sys_m
            row["verdict"] = robot.verdict
            row["missing"] = " or ".join(robot.missing)
            row["stands_out"] = ", ".join(one.key for one in robot.stands_out)
            rows.append(row)
        return rows

    def plot(self, ax: Axes | None = None, *, number: str | None = None) -> Axes:
        """Draw a number of every robot, and how far they are apart, on new axes or ``ax``.

        The first number where none is named; ``among`` has their keys.
        """
        from umbmark import _plots

        return _plots.survey(self, ax, number)


def survey(
    robots: Mapping[str, Data] | Sequence[Data],
    *,
    diagnosis: bool = True,
    size: float = 0.05,
    draws: int = 999,
    seed: Seed = 1,
    return_poses: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Survey:
    """Fit and diagnose many robots of one kind, and find how far they are apart.

    Parameters
    ----------
    robots : mapping of str to Dataset or path-like, or sequence of these
        The measurements of each robot, as of ``each``; ``fleet`` makes them of arrays.
    diagnosis : bool, default True
        Whether to ask of each robot if its numbers explain its runs.
    size : float, default 0.05
        False-alarm rate: of the verdict on one robot, and of all robots that stand out together;
        intervals hold with the rest.
    draws, seed, return_poses, threads
        As of ``diagnose``.
    progress : bool or callable, optional
        True for a bar of tqdm; or a function of the steps done and of all, in thousandths.

    Returns
    -------
    Survey
        ``robots`` has a row for each, ``among`` how far they are apart without the errors of their
        tests: the spread that ``tolerance`` takes as given.

    Examples
    --------
    >>> import numpy as np
    >>> import umbmark
    >>> draw = np.random.default_rng(1)
    >>> cw = draw.normal([-0.20, -0.21, -0.05], 0.01, (20, 5, 3))
    >>> ccw = draw.normal([0.01, 0.00, 0.01], 0.01, (20, 5, 3))
    >>> robot, path = umbmark.Model().robot, umbmark.Path.umbmark()
    >>> robots = umbmark.fleet(cw, ccw, robot=robot, path=path)
    >>> found = umbmark.survey(robots, diagnosis=False)
    >>> len(found.robots), [one.key for one in found.among]
    (20, ['wheel_diameter_ratio.e_d', 'wheelbase.e_b'])
    """
    loaded = [(name, data_of(data)) for name, data in named(robots).items()]
    options = options_of(size, draws, seed)
    with Bar(progress, 1000, "steps") as bar:
        document, text = _umbmark.survey(loaded, diagnosis, options, return_poses, threads, bar.at)
    return Survey._of(document, text=text)
