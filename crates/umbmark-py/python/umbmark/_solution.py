"""One answer: from measured runs to the numbers on the robot."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed, options_of
from umbmark._explained import Explained
from umbmark._progress import Bar, Progress
from umbmark._result import Row
from umbmark._scores import Data, data_of
from umbmark._umbmark import Dataset

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Solution(_documents.Solution, Explained, frozen=True):
    """The one answer about a measured robot: what to write, what remains, what to do next."""

    _of_row: ClassVar[tuple[str, ...]] = ("old", "new", "low", "high")

    data: Dataset
    text: str

    def table(self) -> list[Row]:
        """Give the new numbers of the robot, one dict a row."""
        keys = ("old", "new", "low", "high", "worth_m")
        return [
            {"number": name} | {key: getattr(change, key) for key in keys}
            for name, change in self.correction.items()
        ]

    def _drawn(self, ax: Axes | None) -> Axes:
        from umbmark import _plots

        return _plots.solution(self, ax)


def solve(
    data: Data,
    *,
    size: float = 0.05,
    draws: int = 999,
    seed: Seed = 1,
    return_poses: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Solution:
    """Answer for a measured robot: what to write into it, what that is worth, what remains.

    Parameters
    ----------
    data : Dataset or path-like
        The measurements.
    size : float, default 0.05
        Probability with which an effect is added to a complete model; intervals hold with the rest.
    draws, seed, return_poses, threads
        As of ``diagnose``.
    progress : bool or callable, optional
        True for a bar of tqdm; or a function of the steps done and of all, in thousandths.

    Returns
    -------
    Solution
        Write ``correction`` into the robot if it is ``needed`` and ``trusted``.

    Raises
    ------
    ValueError
        If there is nothing to learn from, or a number is out of range.

    Examples
    --------
    >>> import umbmark
    >>> truth = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=0.0003)
    >>> answer = umbmark.solve(umbmark.simulate(truth, reference_rate_hz=0), draws=99)
    >>> answer.needed, f"{answer.correction['wheelbase_m'].new:.3f}"
    (True, '0.343')
    """
    data, options = data_of(data), options_of(size, draws, seed)
    with Bar(progress, 1000, "steps") as bar:
        document, text, model = _umbmark.solve(data, options, return_poses, threads, bar.at)
    return Solution._of(document, model=model, data=data, text=text)
