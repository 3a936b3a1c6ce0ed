"""One test, driven and recorded."""

from __future__ import annotations

from umbmark import _umbmark
from umbmark._umbmark import Dataset, Model, Path


def simulate(
    model: Model,
    path: Path | None = None,
    *,
    runs: int | tuple[int, int] = 5,
    reference_rate_hz: float = 20.0,
    seed: int = 1,
) -> Dataset:
    """Simulate one test and record it as a dataset.

    Parameters
    ----------
    model : Model
        The robot and its effects; parameters with a distribution are drawn once.
    path : Path, optional
        The path; the paper's 4 x 4 m square where none is given.
    runs : int or tuple of int, default 5
        Runs in each direction, or (cw, ccw).
    reference_rate_hz : float, default 20
        How often the absolute pose is measured on the way, in Hz; 0 for the end pose alone.
    seed : int, default 1
        Seed of all random numbers.

    Returns
    -------
    Dataset
        Ticks at the robot's encoder rate, or at 100 Hz, absolute poses and return errors; with
        bumps placed, the extended test too.

    Raises
    ------
    ValueError
        If the test cannot be driven.

    Examples
    --------
    >>> import umbmark
    >>> data = umbmark.simulate(umbmark.Model().add("wheelbase", e_b=1.01), runs=1)
    >>> data.runs[0].name, data.returns("ccw").shape
    ('cw_01', (1, 3))
    """
    both = (runs, runs) if isinstance(runs, int) else runs
    return _umbmark.simulate(model, path, both, reference_rate_hz, seed, 0)
