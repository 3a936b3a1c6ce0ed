"""Parameters that vary, as a file has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from typing import Any, TypeAlias

# A file, or its tables: {"name": "ed", "mean": 1.0, "sd": 0.001}, or with "grades" and their costs.
Parameters: TypeAlias = str | PathLike[str] | Sequence[Mapping[str, Any]]
# Correlations of the normal scores of two parameters.
Correlations: TypeAlias = Mapping[tuple[str, str], float]


def keys_of(parameters: Parameters, correlations: Correlations | None) -> str | dict[str, Any]:
    """Give the place of a file, or the keys that would stand in it."""
    if isinstance(parameters, str | PathLike):
        if correlations:
            raise ValueError("correlations of a file's parameters stand in the file")
        return fspath(parameters)
    if isinstance(parameters, Mapping) or not all(isinstance(one, Mapping) for one in parameters):
        raise TypeError(f"parameters must be a file, or a list of its tables, got {parameters!r}")
    keys: dict[str, Any] = {"parameter": [dict(one) for one in parameters]}
    if correlations:
        keys["correlation"] = [
            {"of": list(pair), "value": value} for pair, value in correlations.items()
        ]
    return keys
