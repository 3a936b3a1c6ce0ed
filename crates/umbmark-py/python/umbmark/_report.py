"""Figures of a report, and the report itself."""

from __future__ import annotations

import html
from collections.abc import Mapping
from os import PathLike
from pathlib import PurePath
from typing import TypeAlias

from umbmark import _documents, _umbmark
from umbmark._arguments import Seed, options_of
from umbmark._progress import Bar, Progress
from umbmark._result import Row
from umbmark._scores import Data, a_model, data_of, model_of, places_of
from umbmark._umbmark import Dataset, Figure, Model

# A study: its name, its data, and the model with its name.
Asked: TypeAlias = tuple[str, Dataset, tuple[str, Model] | None]


class Report(_documents.Report, frozen=True):
    """A page of everything: a single file that needs no network. Notebooks show it.

    Attributes
    ----------
    html : str
        The page.
    """

    html: str

    def table(self) -> list[Row]:
        """Give the verdicts, one dict a row."""
        return [{"name": study.name, "verdict": study.verdict} for study in self.studies]

    def save(self, place: str | PathLike[str], *, replace: bool = False) -> None:
        """Write the page to a file, which is replaced only where ``replace`` says so."""
        _umbmark.write(place, self.html.encode(), replace)

    def __repr__(self) -> str:
        said = "".join(f"    {study.name}: {study.verdict}\n" for study in self.studies)
        return f"Report({self.bytes / 1e6:.1f} MB\n{said})"

    def _repr_html_(self) -> str:
        page = html.escape(self.html)
        return f'<iframe srcdoc="{page}" style="width:100%;height:800px;border:0"></iframe>'


def plot(
    kind: str,
    data: Data,
    model: Model | None = None,
    *,
    n: int = 1000,
    size: float = 0.05,
    draws: int = 999,
    seed: Seed = 1,
    return_poses: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Figure:
    """Draw a figure of a report: the same drawing as SVG, PNG, PDF and for Plotly.

    Parameters
    ----------
    kind : str
        What to draw; ``figures`` has the kinds.
    data : Dataset or path-like
        The measurements.
    model : Model, optional
        A model with the values that it has, its free effects fitted; the one that the data teaches
        where none is given.
    n : int, default 1000
        Simulated tests of the model, 100 or more.
    size, draws, seed, return_poses, threads
        As of ``diagnose``.
    progress : bool or callable, optional
        As of ``learn``.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If there is no such kind, the data does not give it, or a number is out of range.

    Examples
    --------
    >>> import umbmark
    >>> truth = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=0.0003)
    >>> data = umbmark.simulate(truth, reference_rate_hz=0)
    >>> figure = umbmark.plot("return_errors", data, truth)
    >>> figure.title, figure.to_svg()[:4]
    ('Return errors', '<svg')
    """
    asked = (
        ", ".join(places_of(data)) or "the data",
        data_of(data),
        None if model is None else ("the model", a_model(model)),
    )
    how = (options_of(size, draws, seed), return_poses, n)
    with Bar(progress, 1000, "steps") as bar:
        return _umbmark.figure(kind, asked, how, threads, bar.at)


def figures() -> dict[str, str]:
    """Give the kinds of figures that ``plot`` draws, and what each shows.

    Examples
    --------
    >>> import umbmark
    >>> umbmark.figures()["parameters"]
    "the model's numbers with their intervals"
    """
    return _umbmark.kinds()


def report(
    data: Data | Mapping[str, Data],
    model: Model | Mapping[str, Model] | None = None,
    *,
    n: int = 1000,
    size: float = 0.05,
    draws: int = 999,
    seed: Seed = 1,
    return_poses: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Put everything on one page: a report to send.

    Parameters
    ----------
    data : Dataset or path-like, or dict of str to these
        The measurements; two named ones are put side by side, as before and after a calibration.
    model : Model, or dict of str to Model, optional
        A model with the values that it has, its free effects fitted; two named ones are put side by
        side. The one that the data teaches where none is given.
    n : int, default 1000
        Simulated tests of the model, 100 or more.
    size, draws, seed, return_poses, threads
        As of ``diagnose``.
    progress : bool or callable, optional
        As of ``learn``.

    Returns
    -------
    Report

    Raises
    ------
    ValueError
        If more than two studies are asked for, or a number is out of range.

    Examples
    --------
    >>> import umbmark
    >>> truth = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=0.0003)
    >>> data = umbmark.simulate(truth, reference_rate_hz=0)
    >>> page = umbmark.report({"my robot": data}, truth)
    >>> page.studies[0].verdict.split("; ")[1]
    'the model fully accounts for the measured error, with no sign of a further effect'
    """
    asked = _studies(data, model)
    places = [place for one in _named(data).values() for place in places_of(one)]
    options = options_of(size, draws, seed)
    how = (options, return_poses, n)
    call = f"umbmark.report({', '.join([*map(repr, places), f'seed={options[2]}'])})"
    with Bar(progress, 1000, "steps") as bar:
        document, page = _umbmark.report(asked, how, call, places, threads, bar.at)
    return Report._of(document, html=page)


def _studies(
    data: Data | Mapping[str, Data], model: Model | Mapping[str, Model] | None
) -> list[Asked]:
    read = {name: data_of(one) for name, one in _named(data).items()}
    given = model if isinstance(model, Mapping) else {"the model": model}
    models = {name: model_of(one) for name, one in given.items()}
    if len(read) == 1 and len(models) > 1:
        ((_, only),) = read.items()
        asked: list[Asked] = [(name, only, (name, one)) for name, one in models.items() if one]
    elif len(models) in (1, len(read)):
        paired = [*models.items()] * (len(read) if len(models) == 1 else 1)
        asked = [
            (name, one, None if of is None else (called, of))
            for (name, one), (called, of) in zip(read.items(), paired, strict=True)
        ]
    else:
        raise ValueError(f"{len(models)} models and {len(read)} datasets do not go together")
    if not 1 <= len(asked) <= 2:
        raise ValueError(f"one study stands on a page, or two side by side, got {len(asked)}")
    return asked


def _named(data: Data | Mapping[str, Data]) -> Mapping[str, Data]:
    if isinstance(data, Mapping):
        return data
    names = [PurePath(place).name for place in places_of(data)]
    return {", ".join(names) or "the data": data}
