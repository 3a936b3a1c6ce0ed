"""What all results have in common."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeAlias

import msgspec

if TYPE_CHECKING:
    import pandas as pd
    import polars as pl
    import pyarrow as pa

Interval: TypeAlias = tuple[float, float]
Row: TypeAlias = dict[str, Any]


class Record(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A part of a result: attributes under the keys of the command's ``--json``."""


class Result(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A frozen result. Its attributes are the keys of the command's ``--json``.

    Results compare by value, can be pickled, and show themselves as a table in notebooks.
    """

    # Attributes that are no keys of the document.
    _beside: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls) -> None:
        """Document the attributes of the document that a class adds to before its own."""
        super().__init_subclass__()
        rule = "    ----------\n"
        document, own = cls.__mro__[1].__doc__ or "", cls.__doc__
        if own is None:
            cls.__doc__ = document
        elif rule in document:
            (*_, inherited), (about, _, added) = document.partition(rule), own.partition(rule)
            cls.__doc__ = f"{about}{rule}{inherited.rstrip()}\n{added}"

    @classmethod
    def _of(cls, document: str, **beside: object) -> Self:
        """Make a result of a document, and of what stands beside it."""
        return msgspec.convert({**msgspec.json.decode(document), **beside}, cls)

    def to_dict(self) -> dict[str, Any]:
        """Give it as dicts, lists and numbers, under the keys of the command's ``--json``."""
        given = [(key, value) for key, value in _fields(self) if value is not msgspec.UNSET]
        document = {key: value for key, value in given if key not in self._beside}
        encoded = msgspec.json.encode(document, enc_hook=lambda thing: thing.to_dict())
        decoded: dict[str, Any] = msgspec.json.decode(encoded)
        return decoded

    def table(self) -> list[Row]:
        """Give its main numbers, one dict a row: its first list of parts, or its own numbers."""
        values = [value for _, value in _fields(self) if isinstance(value, tuple)]
        lists = [value for value in values if value and isinstance(value[0], Record)]
        return [_plain(row) for row in (lists[0] if lists else (self,))]

    def to_arrow(self) -> pa.Table:
        """Give its ``table`` as an Arrow table."""
        import pyarrow as pa

        return pa.Table.from_pylist(self.table())

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Give its ``table`` to whatever reads Arrow: ``pyarrow.table``, polars, DuckDB."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def to_pandas(self) -> pd.DataFrame:
        """Give its ``table`` as a pandas DataFrame, through Arrow."""
        frame: pd.DataFrame = self.to_arrow().to_pandas()
        return frame

    def to_polars(self) -> pl.DataFrame:
        """Give its ``table`` as a polars DataFrame, through Arrow."""
        import polars as pl

        return pl.DataFrame(self.to_arrow())

    def __repr__(self) -> str:
        shown = [
            (key, _shown(value))
            for key, value in _fields(self)
            if value not in (None, (), msgspec.UNSET)
        ]
        lines = "".join(f"    {key}={text},\n" for key, text in shown)
        return f"{type(self).__name__}(\n{lines})"

    def _repr_html_(self) -> str:
        rows = self.table()
        head = "".join(f"<th>{html.escape(key)}</th>" for key in (rows[0] if rows else ()))
        body = "".join(
            "<tr>" + "".join(f"<td>{html.escape(_shown(v))}</td>" for v in row.values()) + "</tr>"
            for row in rows
        )
        name = type(self).__name__
        return f"<table><caption>{name}</caption><tr>{head}</tr>{body}</table>"


def _plain(part: Result | Record) -> Row:
    """Numbers and words, without what has parts of its own."""
    return {
        key: value
        for key, value in _fields(part)
        if value is None or isinstance(value, str | int | float)
    }


def _fields(result: Result | Record) -> list[tuple[str, Any]]:
    return [(key, getattr(result, key)) for key in result.__struct_fields__]


def _shown(value: Any) -> str:
    """Numbers with six digits, what is long by its size."""
    if value is None:
        return "-"
    if isinstance(value, bool | int):
        return str(value)
    if isinstance(value, float):
        return repr(float(f"{value:.5e}"))
    if isinstance(value, tuple) and value and isinstance(value[0], Record):
        return f"({len(value)} {type(value[0]).__name__})"
    if isinstance(value, tuple):
        inner = ", ".join(_shown(item) for item in value)
        return f"({inner},)" if len(value) == 1 else f"({inner})"
    if isinstance(value, Record):
        keys = [(key, getattr(value, key)) for key in value.__struct_fields__]
        inner = ", ".join(f"{key}={_shown(item)}" for key, item in keys if item not in (None, ()))
        return f"{type(value).__name__}({inner})"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_shown(item)}" for key, item in value.items()) + "}"
    return repr(value)
