"""What all results have in common."""

from __future__ import annotations

import html
import inspect
import math
import re
import threading
from collections.abc import Callable, Mapping, Sequence
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeAlias

import msgspec
import numpy as np

from umbmark._errors import needs

if TYPE_CHECKING:
    import pandas as pd
    import polars as pl
    import pyarrow as pa

Interval: TypeAlias = tuple[float, float]
Row: TypeAlias = dict[str, Any]

_making = threading.Lock()
"""msgspec crashes where two threads make the first result of a class at once."""


class Frame:
    """A table that is handed to whatever reads Arrow, and to pandas and polars."""

    __slots__ = ()

    def to_arrow(self) -> pa.Table:
        """Give it as an Arrow table."""
        raise NotImplementedError

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Give its rows to whatever reads Arrow: ``pyarrow.table``, polars, DuckDB."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def to_pandas(self) -> pd.DataFrame:
        """Give its rows as a pandas DataFrame, through Arrow."""
        with needs("frames"):
            frame: pd.DataFrame = self.to_arrow().to_pandas()
        return frame

    def to_polars(self) -> pl.DataFrame:
        """Give its rows as a polars DataFrame, through Arrow."""
        with needs("frames"):
            import polars as pl

        return pl.DataFrame(self.to_arrow())


class ByValue:
    """A frozen dataclass with arrays: it compares by value, where NaN is equal to NaN."""

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return all(_same(value, getattr(other, key)) for key, value in vars(self).items())

    def __hash__(self) -> int:
        # Arrays can be written to; their shapes stay.
        values = (getattr(value, "shape", value) for value in vars(self).values())
        return hash((type(self).__name__, *values))


class Printed:
    """A result that the command prints.

    Attributes
    ----------
    text : str
        What the command prints of it; ``print`` and ``str`` give this.
    """

    __slots__ = ()


class Record(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A part of a result: attributes under the keys of the command's ``--json``."""


class Result(msgspec.Struct, Frame, frozen=True, forbid_unknown_fields=True):
    """A frozen result. Its attributes are the keys of the command's ``--json``.

    Results compare by value, how long they took left out; they can be hashed and pickled. ``print``
    gives what the command prints, and notebooks show verdict, sentence, table and figure.
    """

    # Attributes that are no keys of the document: those that a class adds to the document's.
    _beside: ClassVar[tuple[str, ...]] = ()
    # Attributes that do not count where results are compared: how long it took, and words.
    _uncompared: ClassVar[tuple[str, ...]] = ("text",)
    # Columns of the table that are no numbers where nothing is known of them in any row.
    _words: ClassVar[Mapping[str, str]] = {}
    # Columns of the table in the unit that a word of the row names, as of "sigma_m"; "q*" is all q.
    _of_row: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls) -> None:
        """Note which attributes a class adds, and document those of its bases before them."""
        super().__init_subclass__()
        if cls.__module__ != "umbmark._documents":
            documents = [base for base in cls.__mro__ if base.__module__ == "umbmark._documents"]
            known = {key for base in documents for key in inspect.get_annotations(base)}
            declared = [
                name
                for name in inspect.get_annotations(cls)
                if name[0] != "_" and name not in known
            ]
            cls._beside = (*cls._beside, *declared)
        rule = "\n    Attributes\n    ----------\n"
        inherited = [(base.__doc__ or "").partition(rule)[2].rstrip() for base in cls.__bases__]
        own = cls.__doc__ if "__doc__" in vars(cls) else cls.__bases__[0].__doc__
        about, _, added = (own or "").partition(rule)
        attributes = [text for text in [*inherited, added.rstrip()] if text]
        if attributes:
            cls.__doc__ = f"{about.rstrip()}\n{rule}" + "\n".join(attributes) + "\n"

    @classmethod
    def _of(cls, document: str, **beside: object) -> Self:
        """Make a result of a document, and of what stands beside it."""
        fields = {**msgspec.json.decode(document), **beside}
        with _making:
            return msgspec.convert(fields, cls)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        compared = (key for key in self.__struct_fields__ if key not in self._uncompared)
        return all(_same(getattr(self, key), getattr(other, key)) for key in compared)

    def __hash__(self) -> int:
        kept = {key: value for key, value in self.to_dict().items() if key not in self._uncompared}
        return hash((type(self).__name__, msgspec.json.encode(kept)))

    def to_dict(self) -> dict[str, Any]:
        """Give it as dicts, lists and numbers, under the keys of the command's ``--json``."""
        given = [(key, value) for key, value in _fields(self) if value is not msgspec.UNSET]
        document = {key: value for key, value in given if key not in self._beside}
        encoded = msgspec.json.encode(document, enc_hook=lambda thing: thing.to_dict())
        decoded: dict[str, Any] = msgspec.json.decode(encoded)
        return decoded

    def table(self) -> list[Row]:
        """Give its main numbers, one dict a row: its first list of parts, or its own numbers."""
        return [_plain(row) for row in self._parts() or (self,)]

    def to_arrow(self) -> pa.Table:
        """Give its ``table`` as an Arrow table; a column in which nothing is known has its type."""
        return arrow_of(self.table(), self._kinds())

    def _kinds(self) -> Mapping[str, str]:
        """Give the types of the columns that may be empty, by their annotations."""
        kinds = dict(self._words)
        for part in (type(self), *(type(row) for row in self._parts()[:1])):
            for field in msgspec.structs.fields(part):
                word = str(field.type).removesuffix(" | None")
                word = word if word in ("bool", "int", "str") else "float"
                kinds.setdefault(field.name, word)
        return kinds

    def _cells(self, row: Row) -> list[str]:
        """Give the cells of a row as people read them.

        A number is in the unit that its column names, or else, in some columns, the words of its
        row.
        """
        named = (_unit(cell)[2] for cell in row.values() if isinstance(cell, str))
        of_row = next((factor for factor in named if factor is not None), 1.0)

        def factor(key: str) -> float:
            is_of_row = any(fnmatchcase(key, pattern) for pattern in self._of_row)
            return _unit(key)[2] or (of_row if is_of_row else 1.0)

        def cell(key: str, value: Any) -> str:
            if isinstance(value, str) and self._of_row and _unit(value)[2]:
                return _title(value)
            return _cell(value, factor(key))

        return [cell(key, value) for key, value in row.items()]

    def _parts(self) -> tuple[Record, ...]:
        """Give its first list of parts."""
        values = [value for _, value in _fields(self) if isinstance(value, tuple)]
        lists = [value for value in values if value and isinstance(value[0], Record)]
        return lists[0] if lists else ()

    def __str__(self) -> str:
        text = getattr(self, "text", None)
        return text.rstrip("\n") if isinstance(text, str) else repr(self)

    def __repr__(self) -> str:
        shown = [
            (key, _shown(value))
            for key, value in _fields(self)
            if key != "text" and value not in (None, (), msgspec.UNSET)
        ]
        lines = "".join(f"    {key}={text},\n" for key, text in shown)
        return f"{type(self).__name__}(\n{lines})"

    def _repr_html_(self) -> str:
        """Give verdict, sentence, table with lengths in mm and angles in deg, and small figure."""
        from umbmark._small import small

        said = [getattr(self, key, None) for key in ("verdict", "sentence")]
        words = [html.escape(word) for word in said if isinstance(word, str)]
        verdict = [f"<p><b>{words[0].replace('_', ' ')}</b></p>"] if said[0] else []
        sentences = [f"<p>{word}</p>" for word in words[len(verdict) :]]
        table = html_table(type(self).__name__, self.table(), self._cells)
        return "".join([*verdict, *sentences, table, small(self)])


def html_table(
    caption: str, rows: Sequence[Row], cells: Callable[[Row], list[str]] | None = None
) -> str:
    """Give rows as a table of HTML, lengths in mm and angles in deg.

    ``cells`` gives the cells of a row, where the names of the columns do not say all units.
    """
    if cells is None:
        cells = _by_column
    head = "".join(f"<th>{html.escape(_title(key))}</th>" for key in (rows[0] if rows else ()))
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells(row)) + "</tr>"
        for row in rows
    )
    return f"<table><caption>{html.escape(caption)}</caption><tr>{head}</tr>{body}</table>"


def _by_column(row: Row) -> list[str]:
    return [_cell(value, _unit(key)[2] or 1.0) for key, value in row.items()]


def arrow_of(rows: list[Row], kinds: Mapping[str, str]) -> pa.Table:
    """Give rows as an Arrow table, with types for the columns in which nothing is known."""
    with needs("frames"):
        import pyarrow as pa

    table = pa.Table.from_pylist(rows)
    named = {"bool": pa.bool_(), "float": pa.float64(), "int": pa.int64(), "str": pa.string()}
    types = {name: named[word] for name, word in kinds.items()}
    fields = (
        types.get(field.name, pa.float64()) if pa.types.is_null(field.type) else field.type
        for field in table.schema
    )
    return table.cast(pa.schema([*zip(table.column_names, fields, strict=True)]))


def _same(one: Any, other: Any) -> bool:
    """Whether values are equal, arrays element by element."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return [*one] == [*other] and all(_same(one[key], other[key]) for key in one)
    if isinstance(one, np.ndarray):
        return isinstance(other, np.ndarray) and np.array_equal(one, other, equal_nan=True)
    return bool(one == other)


def _plain(part: Result | Record) -> Row:
    """Numbers and words, without what has parts of its own."""
    return {
        key: value
        for key, value in _fields(part)
        if value is None or isinstance(value, str | int | float)
    }


# What lengths and angles are shown in, by the end of their names; a rate has no such end.
_UNITS = {
    re.compile(r"(?<!_per)(?<!_sqrt)_m$"): (" [mm]", 1e3),
    re.compile(r"(?<!_per)(?<!_sqrt)_rad$"): (" [deg]", 180 / math.pi),
}


def _unit(name: str) -> tuple[str, str, float | None]:
    """Give a name without its unit, the unit that it is shown in, and the factor to that."""
    for end, (unit, factor) in _UNITS.items():
        if end.search(name):
            return end.sub("", name), unit, factor
    return name, "", None


def _title(name: str) -> str:
    bare, unit, _ = _unit(name)
    return bare.replace("_", " ") + unit


def _cell(value: Any, factor: float) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        # Ratios are near 1, where six digits say what five of a length do.
        return f"{value:.6g}" if factor == 1.0 else f"{factor * value:.5g}"
    if isinstance(value, tuple):
        return f"({', '.join(_cell(item, factor) for item in value)})"
    if isinstance(value, str):
        return value
    return "-" if value is None else _shown(value)


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
