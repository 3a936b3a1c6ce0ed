"""Exceptions of this package, so that callers can name them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


class MissingDependencyError(ImportError):
    """A package that only this call needs is not installed; the message says how to install it."""


@contextmanager
def needs(extra: str) -> Iterator[None]:
    """Import what belongs to an extra of this package; where it is missing, name the extra."""
    try:
        yield
    except ModuleNotFoundError as error:
        raise MissingDependencyError(
            f'{error.name} is not installed: pip install "umbmark[{extra}]"', name=error.name
        ) from None
