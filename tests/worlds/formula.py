"""Formulas of the command, read and looked at: waves, thresholds, powers and places in them."""

import ast
import math
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

from setting import Pose

Place: TypeAlias = tuple[float, float]
"""x and y in the room."""

VARIABLES = {
    "speed",
    "turn_rate",
    "acceleration",
    "turn_acceleration",
    "heading",
    "wheel_angle_left",
    "wheel_angle_right",
    "distance",
    "time",
    "session_distance",
    "since_turn",
    "last_turn",
    "direction",
    "x",
    "y",
}
"""All others are parameters."""
FUNCTIONS: dict[str, Callable[..., float]] = {
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "exp": math.exp,
    "log": math.log,
    "sqrt": math.sqrt,
    "abs": abs,
    "sign": lambda value: math.copysign(1.0, value) if value else 0.0,
    "min": min,
    "max": max,
    "tanh": math.tanh,
}
OPERATIONS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
    ast.Pow: lambda a, b: a**b,
}
NEAR = 1e-4
"""Derivatives are taken over this."""
FARTHEST, FINE = 10.0, 2001
"""Thresholds and places are looked for up to this value, at so many values."""


@dataclass(frozen=True)
class Formula:
    """A formula with values for its parameters."""

    tree: ast.expr
    numbers: Mapping[str, float]
    origin: Pose = (0.0, 0.0, 0.0)
    """Where the frame of its x and y is in the room."""

    @property
    def variables(self) -> set[str]:
        """What its value depends on; `sign(speed)` alone is a sense, and no dependence."""
        senses = {id(call.args[0]) for call in self.calls("sign")}
        names = [node for node in ast.walk(self.tree) if isinstance(node, ast.Name)]
        return {node.id for node in names if id(node) not in senses} & VARIABLES

    def calls(self, *names: str) -> list[ast.Call]:
        """Every use of these functions."""
        calls = [node for node in ast.walk(self.tree) if isinstance(node, ast.Call)]
        return [one for one in calls if isinstance(one.func, ast.Name) and one.func.id in names]

    def part(self, tree: ast.expr) -> "Formula":
        """A part of it."""
        return Formula(tree, self.numbers, self.origin)

    def at(self, **values: float) -> float:
        """Its value where variables have these values, and others are 1; NaN where it has none.

        x and y are places in the room.
        """
        if "x" in values:
            x0, y0, heading = self.origin
            dx, dy = values["x"] - x0, values["y"] - y0
            cos, sin = math.cos(heading), math.sin(heading)
            values |= {"x": cos * dx + sin * dy, "y": cos * dy - sin * dx}
        try:
            return value_of(self.tree, {"pi": math.pi, **self.numbers, **values})
        except (ValueError, ZeroDivisionError, OverflowError, TypeError):
            return math.nan

    def slope(self, variable: str) -> float:
        """How fast it grows with a variable, far from places and thresholds."""
        change = self.at(**{variable: FARTHEST + NEAR}) - self.at(**{variable: FARTHEST})
        return change / NEAR

    def slopes_in(self, variable: str, *names: str) -> list[float]:
        """How fast the arguments of these functions grow with a variable, where they do."""
        slopes = [self.part(call.args[0]).slope(variable) for call in self.calls(*names)]
        return [one for one in slopes if abs(one) > NEAR]

    def frequencies(self, variable: str) -> list[float]:
        """Of its waves of a variable [rad per unit of it]."""
        return [abs(one) for one in self.slopes_in(variable, "sin", "cos")]

    def thresholds(self, variable: str) -> list[float]:
        """Where a step of it is, along a variable."""
        found = []
        for call in self.calls("sign"):
            steps = crossings(self.part(call.args[0]), variable)
            found += [one for one in steps if abs(one) > FARTHEST / FINE]
        return found

    def degree(self, variable: str) -> float:
        """The power of a variable that it is in proportion to, but for a constant."""
        none, one, two = (self.at(**{variable: value}) for value in (0.0, 1.0, 2.0))
        if not (two - none) * (one - none) > 0:
            return math.nan
        return math.log2((two - none) / (one - none))

    def is_even(self, variable: str) -> bool:
        """Whether it is the same for a value and its negative."""
        return all(
            math.isclose(self.at(**{variable: value}), self.at(**{variable: -value}))
            for value in (0.3, 1.1, 2.7)
        )

    def place(self) -> Place:
        """Where in the room it differs most from what it is far away."""
        far = self.at(x=1e3, y=1e3)

        def differs(place: Place) -> float:
            value = abs(self.at(x=place[0], y=place[1]) - far)
            return 0.0 if math.isnan(value) else value

        found = (0.0, 0.0)
        for reach, count in ((12.0, 60), (0.2, 5), (0.04, 5)):
            found = max(grid(found, reach, count), key=differs)
        return found


def grid(about: Place, reach: float, count: int) -> Iterator[Place]:
    """Places about one, up to so far away along x and y, in so many steps either way."""
    steps = [reach * (i / count - 1) for i in range(2 * count + 1)]
    return ((about[0] + dx, about[1] + dy) for dx in steps for dy in steps)


def crossings(formula: Formula, variable: str) -> Iterator[float]:
    """Where a formula changes its sign along a variable."""
    values = [FARTHEST * (2 * i / (FINE - 1) - 1) + NEAR for i in range(FINE)]
    for low, high in pairwise(values):
        if formula.at(**{variable: low}) * formula.at(**{variable: high}) < 0:
            yield (low + high) / 2


def value_of(node: ast.expr, values: Mapping[str, float]) -> float:
    """The value of a formula."""
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        return float(node.value)
    if isinstance(node, ast.Name):
        return values.get(node.id, 1.0)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return -value_of(node.operand, values)
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATIONS:
        sides = value_of(node.left, values), value_of(node.right, values)
        return OPERATIONS[type(node.op)](*sides)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return FUNCTIONS[node.func.id](*(value_of(one, values) for one in node.args))
    raise ValueError(f"no formula: {ast.unparse(node)}")


def read(text: str, numbers: Mapping[str, float], origin: Pose) -> Formula | None:
    """A formula in the command's language; none where it cannot be read."""
    try:
        tree = ast.parse(text.replace("^", "**"), mode="eval").body
        formula = Formula(tree, numbers, origin)
        value_of(tree, {"pi": math.pi, **formula.numbers})
    except (SyntaxError, ValueError, KeyError, TypeError):
        return None
    except (ZeroDivisionError, OverflowError):
        pass  # at ones alone
    return formula


def effects_in(toml: str) -> list[dict[str, object]]:
    """The effects that a model in TOML has."""
    try:
        return list(tomllib.loads(toml).get("effect", []))
    except tomllib.TOMLDecodeError:
        return []
