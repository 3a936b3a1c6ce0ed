"""What changed of a robot between two tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed, options_of
from umbmark._progress import Bar, Progress
from umbmark._result import Printed, Row
from umbmark._scores import Data, data_of, model_of
from umbmark._umbmark import Model

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Changed(_documents.Changed, Printed, frozen=True):
    """What changed of a robot between two tests."""

    text: str

    def table(self) -> list[Row]:
        """Give the numbers of the robot and of the reference, one dict a row."""
        keys = ("key", "of", "before", "after", "change", "p_adjusted", "changed", "seen")
        return [{key: getattr(row, key) for key in keys} for row in (*self.robot, *self.reference)]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw each change in standard errors, with its interval, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.changed(self, ax)


def changed(
    before: Data,
    after: Data,
    model: Model | None = None,
    *,
    size: float = 0.05,
    draws: int = 999,
    seed: Seed = 1,
    return_poses: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Changed:
    """Find what changed of a robot between two tests.

    Parameters
    ----------
    before, after : Dataset or path-like
        The tests.
    model : Model, optional
        Effects that are fitted to both; without it, those that either test shows by itself.
    size : float, default 0.05
        Probability with which something is said to have changed of a robot that did not;
        intervals hold with the rest.
    draws, seed, return_poses, threads
        As of ``diagnose``.
    progress : bool or callable, optional
        True for a bar of tqdm; or a function of the steps done and of all, in thousandths.

    Returns
    -------
    Changed
        ``robot`` has each number before and after; what changed says so.

    Raises
    ------
    ValueError
        If the tests are of two kinds of robots, show nothing in common, or cannot be fitted.

    Examples
    --------
    >>> import umbmark
    >>> noisy = umbmark.Model().add("wheel_noise", k_sqrt_m=0.0002)
    >>> worn = umbmark.Model().add("wheel_noise", k_sqrt_m=0.0002).add("wheelbase", e_b=1.01)
    >>> before, after = (umbmark.simulate(robot, reference_rate_hz=0) for robot in (noisy, worn))
    >>> [row.key for row in umbmark.changed(before, after, draws=99).robot if row.changed]
    ['wheelbase_over_diameter']
    """
    first, second = data_of(before), data_of(after)
    options = options_of(size, draws, seed)
    with Bar(progress, 1000, "steps") as bar:
        document, text = _umbmark.changed(
            first, second, model_of(model), options, return_poses, threads, bar.at
        )
    return Changed._of(document, text=text)
