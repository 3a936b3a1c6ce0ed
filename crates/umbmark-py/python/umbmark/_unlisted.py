"""A missing effect that the catalogue does not have."""

from __future__ import annotations

from typing import TYPE_CHECKING

from umbmark import _documents

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Unlisted(_documents.Unlisted, frozen=True):
    __doc__ = _documents.Unlisted.__doc__

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw its curve with the 95 % band, over what it depends on, on new axes or ``ax``."""
        from umbmark import _plots

        return _plots.unlisted(self, ax)
