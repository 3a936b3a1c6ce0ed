"""Functions as formulas: an effect of the user's own, written with NumPy.

A function is called once, with symbols in place of numbers, and what it does to them is written
down as a formula. So it runs where formulas run: on every thread, with exact derivatives, in fits
and in files. What has no formula (a branch on a value, a table) is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

VARIABLES = (
    "speed turn_rate acceleration heading wheel_angle_left wheel_angle_right distance time"
    " session_distance since_turn last_turn direction"
).split()

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
            "a formula cannot branch on a value: write it with np.sign, np.minimum, np.maximum"
            " or np.tanh"
        )

    def _compared(self, _: Any) -> bool:
        return bool(self)

    __lt__ = __le__ = __gt__ = __ge__ = _compared

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
        if method == "__call__" and name in _FUNCTIONS:
            return Symbol(_FUNCTIONS[name].format(*(_symbol(item).text for item in inputs)))
        known = ", ".join(sorted(_FUNCTIONS))
        raise TypeError(f"a formula has no np.{name}; it has + - * / **, {known}")


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
        (``at.speed``, ``at.heading``, ...), as arrays or numbers.
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
