"""A small figure of a result, as notebooks show it beside its table."""

from __future__ import annotations

import base64
from importlib.util import find_spec
from io import BytesIO
from typing import Any

INCHES = (4.2, 2.8)
INCHES_A_NAME = 0.17


def small(result: Any) -> str:
    """Draw what ``plot`` draws as HTML; nothing without matplotlib, or where it cannot be drawn."""
    if not hasattr(result, "plot") or find_spec("matplotlib") is None:
        return ""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    written = BytesIO()
    # Text stays text; with this salt, equal results give equal bytes.
    with rc_context({"font.size": 8, "svg.fonttype": "none", "svg.hashsalt": "umbmark"}):
        # No figure of pyplot, which would be shown once more.
        figure = Figure(figsize=INCHES)
        try:
            ax = result.plot(figure.subplots())
        except ValueError:
            return ""
        figure.set_figheight(max(INCHES[1], INCHES_A_NAME * len(ax.get_yticks())))
        # As much larger as the words beside the axes need.
        figure.savefig(written, format="svg", bbox_inches="tight", metadata={"Date": None})
    data = base64.b64encode(written.getvalue()).decode()
    return f'<img alt="{type(result).__name__}" src="data:image/svg+xml;base64,{data}">'
