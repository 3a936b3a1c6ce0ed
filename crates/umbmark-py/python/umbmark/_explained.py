"""What results do that hold a model and the runs that it is a model of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, overload

import numpy as np
from numpy.typing import NDArray

from umbmark._documents import Estimate
from umbmark._progress import Progress
from umbmark._report import plot
from umbmark._result import Printed
from umbmark._tracks import Tracks, tracks
from umbmark._umbmark import Dataset, Figure, Model

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Explained(Printed):
    """A result with a model and the measured runs that it explains.

    Attributes
    ----------
    data : Dataset
        The measurements.
    text : str
        What the command prints of it; ``print`` and ``str`` give this.
    """

    __slots__ = ()

    data: Dataset
    model: Model
    fitted: tuple[Estimate, ...]
    correlations: tuple[tuple[float, ...], ...]

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance of the parameters in ``fitted``, shape (n, n), in products of their units.

        NaN where the data does not determine them. ``correlations`` has it without units.
        """
        errors = np.array([estimate.standard_error for estimate in self.fitted], np.float64)
        if not self.correlations:
            return np.full((errors.size, errors.size), np.nan)
        covariance: NDArray[np.float64] = np.outer(errors, errors) * np.array(self.correlations)
        return covariance

    def tracks(self) -> Tracks:
        """Give the measured runs beside odometry and the model, as of ``umbmark.tracks``."""
        return tracks(self.data, self.model)

    def fit_report(self) -> str:
        """Write down the fit of its model as text: values, standard errors, rms, chi2, AICc.

        The free parameters in the units of the catalogue, with intervals that hold as the result
        says. On tracks the root mean square of the residuals in mm and deg, and chi2 of the
        whitened ones, which is about their number if the model is right. AICc and BIC of a fit, or
        of the last step of learning; how a fit ended, and what was known before.
        """
        from umbmark._fit_report import report

        try:
            of = self.tracks()
        except ValueError:
            # Return poses alone.
            of = None
        steps = getattr(self, "steps", ())
        return report(self.fitted, len(self.data), of, steps[-1] if steps else self)

    @overload
    def plot(self, ax: Axes | None = None, *, kind: None = None) -> Axes: ...

    @overload
    def plot(
        self,
        ax: Axes | Sequence[Axes] | None = None,
        *,
        kind: str,
        n: int = 1000,
        progress: Progress = None,
    ) -> list[Axes]: ...

    def plot(
        self,
        ax: Axes | Sequence[Axes] | None = None,
        *,
        kind: str | None = None,
        n: int = 1000,
        progress: Progress = None,
    ) -> Axes | list[Axes]:
        """Draw it, or a figure of the report for its model and data, with matplotlib.

        Parameters
        ----------
        ax : matplotlib axes, or a sequence of them, optional
            Where to draw, new axes where none are given. A figure of the report takes as many as
            it has panels.
        kind : str, optional
            A figure of the report; ``umbmark.figures`` has the kinds. Nothing is learnt anew. The
            result's own figure where none is given: the ranking of a diagnosis, the values of a fit
            in standard errors, the error after each step of learning, the new numbers of a
            solution.
        n, progress
            As of ``figure``.

        Returns
        -------
        matplotlib axes, or a list of them
            With ``kind`` a list, with axes for each panel from top to bottom.

        Raises
        ------
        ValueError
            If the data does not give this figure, or there are more or fewer axes than panels.
        MissingDependencyError
            If matplotlib is not installed.
        """
        if kind is not None:
            from umbmark import _panels

            return _panels.draw(self.figure(kind, n=n, progress=progress), ax)
        if isinstance(ax, Sequence):
            raise TypeError("ax must be one axes; a figure of the report takes several: say kind=")
        return self._drawn(ax)

    def _drawn(self, ax: Axes | None) -> Axes:
        """Draw the result's own figure."""
        raise NotImplementedError

    def figure(self, kind: str, *, n: int = 1000, progress: Progress = None) -> Figure:
        """Draw a figure of the report for this model and its data; nothing is learnt anew.

        Notebooks show it as SVG, and its ``to_plotly`` gives it to Plotly.

        Parameters
        ----------
        kind : str
            What to draw; ``umbmark.figures`` has the kinds.
        n : int, default 1000
            Simulated tests of the model, 100 or more.
        progress : bool or callable, optional
            As of ``umbmark.learn``.
        """
        return plot(kind, self.data, self.model, n=n, progress=progress)
