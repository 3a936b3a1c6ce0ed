"""Which numbers of a robot depend on the conditions of its runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from umbmark import _documents, _umbmark
from umbmark._arguments import real
from umbmark._progress import Bar, Progress
from umbmark._result import Printed, Row
from umbmark._scores import Data, data_of, model_of
from umbmark._umbmark import Model

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Conditions(_documents.Conditions, Printed, frozen=True):
    """Which numbers of a robot depend on which conditions."""

    text: str

    def table(self) -> list[Row]:
        """Give the value of every number at every level of a condition, one dict a row."""
        return [
            {
                "key": asked.key,
                "condition": asked.condition,
                "level": at.level,
                "value": at.own.value,
                "standard_error": at.own.standard_error,
                "pooled": at.pooled,
                "p_adjusted": asked.p_adjusted,
                "differs": asked.differs,
            }
            for asked in self.asked
            for at in asked.levels
        ]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the p of every number under every condition, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.conditions(self, ax)


def conditions(
    data: Data,
    model: Model | None = None,
    *,
    size: float = 0.05,
    return_poses: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Conditions:
    """Find which numbers of a robot depend on session, floor, load or temperature.

    Parameters
    ----------
    data : Dataset, path-like or sequence of path-like
        Runs under several conditions: several datasets, each a session, or
        ``Dataset.with_conditions``, or a dataset with ``conditions.csv``.
    model : Model, optional
        Its free effects are asked for; without it, E_d, E_b and, of tracks, E_s.
    size : float, default 0.05
        Probability with which something is said to differ of a robot that is the same
        everywhere; intervals hold with the rest.
    return_poses, threads
        As of ``diagnose``.
    progress : bool or callable, optional
        True for a bar of tqdm; or a function of the steps done and of all, in thousandths.

    Returns
    -------
    Conditions
        ``asked`` has every number under every condition, ``numbers`` what depends on what.

    Raises
    ------
    ValueError
        If nothing is stated or differs, if the runs are too few, or cannot be fitted.

    Examples
    --------
    >>> import umbmark
    >>> noisy = umbmark.Model().add("wheel_noise", k_sqrt_m=0.0002)
    >>> tile = umbmark.simulate(noisy, reference_rate_hz=0)
    >>> felt = umbmark.simulate(noisy.add("wheelbase", e_b=1.01), reference_rate_hz=0, seed=2)
    >>> cw, ccw = ([*tile.returns(way), *felt.returns(way)] for way in ("cw", "ccw"))
    >>> data = umbmark.Dataset.from_arrays(cw, ccw, robot=tile.robot, path=tile.path)
    >>> floors = (["tile"] * 5 + ["felt"] * 5) * 2
    >>> found = umbmark.conditions(data.with_conditions(floor=floors))
    >>> [number.key for number in found.numbers if number.depends_on]
    ['wheelbase.e_b']
    """
    loaded, model, size = data_of(data), model_of(model), real("size", size)
    with Bar(progress, 1000, "steps") as bar:
        document, text = _umbmark.conditions(loaded, model, size, return_poses, threads, bar.at)
    return Conditions._of(document, text=text)
