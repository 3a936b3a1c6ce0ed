"""What results do that hold a model and the runs that it is a model of."""

from __future__ import annotations

from umbmark._monte_carlo import Progress
from umbmark._report import plot
from umbmark._result import Printed
from umbmark._tracks import Tracks, tracks
from umbmark._umbmark import Dataset, Figure, Model


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

    def tracks(self) -> Tracks:
        """Give the measured runs beside odometry and the model, as of ``umbmark.tracks``."""
        return tracks(self.data, self.model)

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
