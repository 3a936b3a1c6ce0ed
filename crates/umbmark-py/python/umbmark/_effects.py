"""The catalogue of effects."""

from __future__ import annotations

import msgspec

from umbmark import _umbmark
from umbmark._documents import Effect


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
