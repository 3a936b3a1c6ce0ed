"""The catalogue of effects."""

from __future__ import annotations

import msgspec

from umbmark import _umbmark
from umbmark._result import Record


class Parameter(Record, frozen=True):
    """A number of an effect: unit, default, usual size, bounds, words where it takes them."""

    name: str
    flag: str
    unit: str
    default: float | str
    typical: float
    bounds: tuple[float | None, float | None]
    choices: tuple[str, ...]
    meaning: str


class Effect(Record, frozen=True):
    """An effect of the catalogue: law, cause, signature, and what looks like it."""

    name: str
    title: str
    acts_on: str
    drives: tuple[str, ...]
    equation: str
    physics: str
    signature: str
    confused_with: tuple[str, ...]
    separated_by: str
    source: str
    parameters: tuple[Parameter, ...]


def effects() -> dict[str, Effect]:
    """Give the catalogue of effects by their names, in the order in which they act.

    Examples
    --------
    >>> import umbmark
    >>> umbmark.effects()["crab"].parameters[0].name
    'angle_rad'
    """
    entries = msgspec.json.decode(_umbmark.effects(), type=tuple[Effect, ...])
    return {entry.name: entry for entry in entries}
