"""Functions as formulas: an effect of the user's own, written with NumPy.

A function is called once, with symbols in place of numbers, and what it does to them is written
down as a formula. So it runs where formulas run: on every thread, with exact derivatives, in fits
and in files. ``np.where``, ``np.clip``, ``np.interp`` and comparisons are written with signs and
extremes; an ``if`` on a value cannot be seen and is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np

from umbmark import _umbmark

# What a formula may depend on, as the core has it.
VARIABLES = tuple(_umbmark.formula_variables())

# Formulas of NumPy's functions; a number is how tightly what it makes holds together.
_ATOM, _POWER, _MINUS, _PRODUCT, _SUM = 5, 4, 3, 2, 1
_FUNCTIONS = {
    name: f"{word}({{}}{', {}' if word in ('min', 'max') else ''})"
    for name, word in (
        *((name, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "sign", "tanh")),
        *(("absolute", "abs"), ("fabs", "abs")),
        *(("minimum", "min"), ("maximum", "max"), ("fmin", "min"), ("fmax", "max")),
    )
}


class Symbol:
    """A quantity, or what was made of quantities: a formula and how tightly it holds together."""

    __slots__ = ("_tight", "text")

    def __init__(self, text: str, tight: int = _ATOM) -> None:
        """Write a formula."""
        self.text = text
        self._tight = tight

    def _within(self, tight: int) -> str:
        return self.text if self._tight >= tight else f"({self.text})"

    def _with(self, sign: str, other: Any, tight: int, reflected: bool = False) -> Symbol:
        other = _symbol(other)
        left, right = (other, self) if reflected else (self, other)
        # Signs work from the left: a - (b - c) keeps its parentheses.
        text = f"{left._within(tight)} {sign} {right._within(tight + 1)}"
        return Symbol(text, tight)

    def __add__(self, other: Any) -> Symbol:
        return self._with("+", other, _SUM)

    def __radd__(self, other: Any) -> Symbol:
        return self._with("+", other, _SUM, True)

    def __sub__(self, other: Any) -> Symbol:
        return self._with("-", other, _SUM)

    def __rsub__(self, other: Any) -> Symbol:
        return self._with("-", other, _SUM, True)

    def __mul__(self, other: Any) -> Symbol:
        return self._with("*", other, _PRODUCT)

    def __rmul__(self, other: Any) -> Symbol:
        return self._with("*", other, _PRODUCT, True)

    def __truediv__(self, other: Any) -> Symbol:
        return self._with("/", other, _PRODUCT)

    def __rtruediv__(self, other: Any) -> Symbol:
        return self._with("/", other, _PRODUCT, True)

    def __neg__(self) -> Symbol:
        return Symbol(f"-{self._within(_POWER)}", _MINUS)

    def __pos__(self) -> Symbol:
        return self

    def __abs__(self) -> Symbol:
        return Symbol(f"abs({self.text})")

    def __pow__(self, exponent: Any) -> Symbol:
        if isinstance(exponent, Symbol) or float(exponent) != int(exponent):
            raise TypeError("a formula has whole exponents only; write exp(n * log(x)) for others")
        return Symbol(f"{self._within(_ATOM)}^{int(exponent)}", _POWER)

    def __bool__(self) -> bool:
        raise TypeError(
            "a formula cannot branch on a value: write it with np.where, or with np.sign,"
            " np.minimum, np.maximum or np.tanh"
        )

    def __gt__(self, other: Any) -> Condition:
        return _positive(self - other)

    def __lt__(self, other: Any) -> Condition:
        return _positive(_symbol(other) - self)

    def __ge__(self, other: Any) -> Condition:
        return _positive(_symbol(other) - self).__invert__()

    def __le__(self, other: Any) -> Condition:
        return _positive(self - other).__invert__()

    def __ne__(self, other: object) -> Condition:  # type: ignore[override]
        return Condition(f"abs(sign({(self - other).text}))")

    def __eq__(self, other: object) -> Condition:  # type: ignore[override]
        return self.__ne__(other).__invert__()

    __hash__ = None  # type: ignore[assignment]

    def __float__(self) -> float:
        raise TypeError("a formula is made of NumPy's functions; one of another module was called")

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **_: Any) -> Symbol:
        """Write down what a function of NumPy would do."""
        name = ufunc.__name__
        signs = {"add": "+", "subtract": "-", "multiply": "*", "divide": "/"}
        if method == "__call__" and name in signs:
            tight = _SUM if name in ("add", "subtract") else _PRODUCT
            return _symbol(inputs[0])._with(signs[name], inputs[1], tight)
        if method == "__call__" and name in ("power", "negative", "positive", "square"):
            of = {"power": "__pow__", "negative": "__neg__", "positive": "__pos__"}
            first = _symbol(inputs[0])
            made = first**2 if name == "square" else getattr(first, of[name])(*inputs[1:])
            return made if isinstance(made, Symbol) else _symbol(made)
        if method == "__call__" and name in _COMPARISONS:
            compare: Condition = getattr(_symbol(inputs[0]), _COMPARISONS[name])(*inputs[1:])
            return compare
        if method == "__call__" and name in _FUNCTIONS:
            return Symbol(_FUNCTIONS[name].format(*(_symbol(item).text for item in inputs)))
        raise _unknown(name)

    def __array_function__(
        self, function: Callable[..., Any], _: Any, inputs: tuple[Any, ...], keys: dict[str, Any]
    ) -> Symbol:
        """Write down what a function of NumPy that is no ``ufunc`` would do."""
        written = _PIECEWISE.get(function.__name__)
        if written is None:
            raise _unknown(function.__name__)
        return written(*inputs, **keys)


class Condition(Symbol):
    """What holds or does not: 1 or 0, as NumPy has it."""

    __slots__ = ("_opposite",)

    def __init__(self, text: str, tight: int = _ATOM, opposite: Condition | None = None) -> None:
        """Write a condition; ``opposite`` is what it was made of by ``~``."""
        super().__init__(text, tight)
        self._opposite = opposite

    def __and__(self, other: Any) -> Condition:
        return Condition((self * _condition(other)).text, _PRODUCT)

    __rand__ = __and__

    def __or__(self, other: Any) -> Condition:
        return Condition(f"max({self.text}, {_condition(other).text})")

    __ror__ = __or__

    def __invert__(self) -> Condition:
        if self._opposite is not None:
            return self._opposite
        return Condition((1 - Symbol(self.text, self._tight)).text, _SUM, self)


def _unknown(name: str) -> TypeError:
    known = ", ".join(sorted([*_FUNCTIONS, *_PIECEWISE]))
    return TypeError(f"a formula has no np.{name}; it has + - * / **, comparisons, {known}")


def _positive(difference: Symbol) -> Condition:
    return Condition(f"max(sign({difference.text}), 0.0)")


def _condition(thing: Any) -> Condition:
    if isinstance(thing, Condition):
        return thing
    return _symbol(thing) != 0


def _where(condition: Any, holds: Any, fails: Any) -> Symbol:
    """Write ``np.where``: each side times 1 or 0, so that it is itself to the last bit."""
    condition = _condition(condition)
    sides: list[Symbol] = []
    for side, switch in ((holds, condition), (fails, ~condition)):
        if isinstance(side, Symbol) or float(side) != 0.0:
            sides.append(_symbol(side) * switch)
    return sides[0] + sides[1] if len(sides) == 2 else (sides or [_symbol(0.0)])[0]


def _clip(thing: Any, low: Any = None, high: Any = None) -> Symbol:
    """Write ``np.clip``."""
    made = _symbol(thing)
    if low is not None:
        made = Symbol(f"max({made.text}, {_symbol(low).text})")
    if high is not None:
        made = Symbol(f"min({made.text}, {_symbol(high).text})")
    return made


def _interp(at: Any, places: Any, values: Any) -> Symbol:
    """Write ``np.interp``: a table as the sum of its slopes, flat beyond its ends."""
    places = [float(place) for place in places]
    values = [*values]
    if len(places) != len(values) or not places:
        raise TypeError("np.interp needs as many places as values, one at least")
    if any(here >= there for here, there in pairwise(places)):
        raise TypeError("np.interp needs places that increase")
    made = _symbol(values[0])
    for (here, there), (low, high) in zip(pairwise(places), pairwise(values), strict=True):
        within = _clip(at, here, there) - here
        made = made + (high - low) / (there - here) * within
    return made


_PIECEWISE: dict[str, Callable[..., Symbol]] = {"where": _where, "clip": _clip, "interp": _interp}
_COMPARISONS = {
    "greater": "__gt__",
    "greater_equal": "__ge__",
    "less": "__lt__",
    "less_equal": "__le__",
    "equal": "__eq__",
    "not_equal": "__ne__",
    "logical_and": "__and__",
    "bitwise_and": "__and__",
    "logical_or": "__or__",
    "bitwise_or": "__or__",
    "logical_not": "__invert__",
    "invert": "__invert__",
}


def _symbol(thing: Any) -> Symbol:
    if isinstance(thing, Symbol):
        return thing
    number = float(thing)
    return Symbol(repr(number), _ATOM if number >= 0 else _MINUS)


def formula_of(function: Callable[..., Any], parameters: Mapping[str, float]) -> str:
    """Write a function of the quantities and the parameters as a formula.

    Parameters
    ----------
    function : callable
        ``function(at, **parameters)``: ``at`` has the quantities that an effect may depend on
        (``at.speed``, ``at.heading``, ``at.x``, ...), as arrays or numbers. `umbmark effects` lists
        them.
    parameters : mapping of str to float
        Its parameters.

    Raises
    ------
    TypeError
        If it does what a formula cannot.
    """
    at = SimpleNamespace(**{name: Symbol(name) for name in VARIABLES})
    try:
        made = function(at, **{name: Symbol(name) for name in parameters})
    except AttributeError as error:
        missing = error.name if error.obj is at else None
        if missing is None:
            raise
        known = ", ".join(VARIABLES)
        raise TypeError(f"there is no quantity {missing!r}; there are {known}") from None
    return _symbol(made).text


def as_text(keys: dict[str, Any]) -> dict[str, Any]:
    """Give the keys of an effect with its function, where it has one, as a formula."""
    formula = keys.get("formula")
    if not callable(formula):
        return keys
    return {**keys, "formula": formula_of(formula, keys.get("parameters") or {})}
