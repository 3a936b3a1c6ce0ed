"""Figures of the report with matplotlib: what ``Figure.to_plotly`` describes, on axes.

Ends of axes, colours and marks are read from that description, so they are those of the report.
"""

from __future__ import annotations

import html
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from umbmark._errors import needs

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from umbmark._umbmark import Figure

# What Plotly and matplotlib call the same marks; "-open" is not filled.
MARKS = {"circle": "o", "diamond": "D", "cross-thin": "+"}
# Of a pixel, in which Plotly measures: points, and inches of a new figure.
POINT = 0.75
INCH = 0.01
WIDTH_INCHES, LETTER_INCHES = 6.4, 0.08


def draw(figure: Figure, ax: Axes | Sequence[Axes] | None) -> list[Axes]:
    """Draw a figure, each panel on axes of its own, from top to bottom."""
    described = figure.to_plotly()
    layout = described["layout"]
    panels = [key.removeprefix("xaxis") for key in layout if key.startswith("xaxis")]
    axes = _axes(figure.kind, layout, panels, ax)
    named = dict(zip(panels, axes, strict=True))
    entries: dict[tuple[str, str], Any] = {}
    for place, trace in enumerate(described["data"]):
        on = named[trace["xaxis"].removeprefix("x")]
        drawn = _trace(on, trace, 2 + 1e-3 * place)
        if trace["name"] and drawn is not None:
            entries.setdefault((html.unescape(trace["name"]), trace["meta"]["tone"]), drawn)
    titles = {title["y"]: title["text"] for title in layout["annotations"]}
    for panel, on in named.items():
        x, y = layout[f"xaxis{panel}"], layout[f"yaxis{panel}"]
        on.set(xlabel=_words(x["title"]["text"]), ylabel=_words(y["title"]["text"]))
        on.set_title(_words(titles.get(y["domain"][1], "")), loc="left")
        if "tickvals" in x:
            on.set_xticks(x["tickvals"], [_words(name) for name in x["ticktext"]])
            on.tick_params(axis="x", rotation=-x.get("tickangle", 0))
        if "tickvals" in y:
            on.set_yticks(y["tickvals"], [_words(name) for name in y["ticktext"]])
        is_equal = "scaleanchor" in y
        if "tickvals" in x and "tickvals" in y:
            on.set_aspect("equal")
        # Ends that may still be widened, where a unit is as long on both axes.
        on.set_xlim(*x["range"], auto=is_equal)
        on.set_ylim(*y["range"], auto=is_equal)
        if is_equal:
            on.set_aspect("equal", adjustable="datalim")
    _legend(axes, entries, ax is None)
    return axes


def _axes(
    kind: str, layout: dict[str, Any], panels: list[str], ax: Axes | Sequence[Axes] | None
) -> list[Axes]:
    """Give axes for each panel: those that are given, or new ones one above the other."""
    if ax is not None:
        given = list(ax) if isinstance(ax, Sequence | np.ndarray) else [ax]
        if len(given) != len(panels):
            raise ValueError(f"{kind} has {len(panels)} panels, ax has {len(given)} axes")
        return given
    with needs("plot"):
        from matplotlib import pyplot

    domains = (layout[f"yaxis{panel}"]["domain"] for panel in panels)
    # Names below the last panel stand upright.
    below = layout[f"xaxis{panels[-1]}"].get("ticktext", ())
    names = LETTER_INCHES * max((len(name) for name in below), default=0)
    made = pyplot.subplots(
        len(panels),
        squeeze=False,
        layout="constrained",
        figsize=(WIDTH_INCHES, INCH * layout["height"] + names),
        height_ratios=[high - low for low, high in domains],
    )[1]
    return [*made.flat]


def _trace(ax: Axes, trace: dict[str, Any], order: float) -> Any:
    """Draw the places that are drawn alike, and give what a legend shows of them."""
    x, y = _numbers(trace["x"]), _numbers(trace["y"])
    if trace["type"] == "bar":
        base = _numbers(trace["base"]) if "base" in trace else 0.0
        colour = trace["marker"]["color"]
        return ax.bar(x, y, trace["width"], base, color=colour, zorder=order)
    if trace["mode"] == "text":
        for at, up, word in zip(x, y, trace["text"], strict=True):
            ax.text(at, up, _words(word), size="x-small", va="center", zorder=order, clip_on=True)
        return None
    if trace["mode"] == "lines":
        line = trace["line"]
        style = "--" if line.get("dash") == "dash" else "-"
        width = POINT * line["width"]
        return ax.plot(x, y, style, color=line["color"], linewidth=width, zorder=order)[0]
    return _markers(ax, x, y, trace, order)


def _markers(
    ax: Axes, x: NDArray[np.float64], y: NDArray[np.float64], trace: dict[str, Any], order: float
) -> Any:
    marker = trace["marker"]
    shape = marker["symbol"].removesuffix("-open")
    style = {
        "color": marker["color"],
        "marker": MARKS[shape],
        "markerfacecolor": marker["color"] if shape == marker["symbol"] else "none",
        "markersize": POINT * marker["size"],
        "linestyle": "none",
        "zorder": order,
    }
    if "error_x" not in trace:
        return ax.plot(x, y, **style)[0]
    ends = np.array([_numbers(trace["error_x"][end]) for end in ("arrayminus", "array")])
    return ax.errorbar(x, y, xerr=ends, capsize=3, **style)


def _legend(axes: list[Axes], entries: dict[tuple[str, str], Any], own: bool) -> None:
    """Say what the marks stand for: below a new figure, or within the first axes that are given."""
    if not entries:
        return
    names, marks = [name for name, _ in entries], [*entries.values()]
    if own:
        columns = min(3, len(names))
        axes[0].figure.legend(marks, names, loc="outside lower center", ncols=columns)
    else:
        axes[0].legend(marks, names)


def _numbers(values: Sequence[float | None]) -> NDArray[np.float64]:
    """Give numbers with gaps as an array with NaN."""
    return np.array(values, np.float64)


def _words(text: str) -> str:
    """Give the words of a label that Plotly would read as HTML."""
    for tag, instead in (("<b>", ""), ("</b>", ""), ("<br>", " ")):
        text = text.replace(tag, instead)
    return html.unescape(text)
