"""What `umbmark learn` wrote, replayed like the laws of the peers."""

import ast
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from drives import AT, Array, Robot, effects_of
from predicted import FORWARD, KNOWN, SIDEWAYS, YAW

FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "exp": np.exp,
    "log": np.log,
    "sqrt": np.sqrt,
    "abs": np.abs,
    "sign": np.sign,
    "min": np.minimum,
    "max": np.maximum,
    "tanh": np.tanh,
}
OPERATIONS: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
}


@dataclass
class Law:
    """The formulas of a model."""

    robot: Robot
    effects: list[dict[str, Any]]

    def rates(self, features: Array) -> Array:
        """Motion that is added per second, [n x 3]."""
        found = np.zeros((len(features), 3))
        for effect in self.effects:
            tree = ast.parse(effect["formula"].replace("^", "**"), mode="eval").body
            named = {name: features[:, column] for name, column in AT.items()}
            values = {"pi": np.pi, **effect["parameters"], **named}
            found += self.acting(effect["acts_on"], features) * np.reshape(
                np.broadcast_to(value_of(tree, values), len(features)), (-1, 1)
            )
        return found

    def acting(self, acts_on: str, features: Array) -> Array:
        """The motion per second of a formula that is one, [n x 3]."""
        speed, turn = features[:, AT["speed"]], features[:, AT["turn_rate"]]
        found = np.zeros((len(features), 3))
        kind, _, per = acts_on.partition("_per_")
        each = {"metre": np.abs(speed), "second": np.ones_like(speed), "radian": np.abs(turn)}
        motions = {"forward": FORWARD, "sideways": SIDEWAYS, "heading": YAW}
        if per:
            found[:, motions[kind]] = each[per]
        elif acts_on == "forward_scale":
            found[:, FORWARD] = speed
        elif acts_on == "turn_scale":
            found[:, YAW] = turn
        else:
            side = 1.0 if acts_on == "right_wheel_scale" else -1.0
            wheel = speed + side * turn * self.robot.wheelbase_m / 2
            found[:, FORWARD] = wheel / 2
            found[:, YAW] = side * wheel / self.robot.wheelbase_m
        return found


def value_of(node: ast.expr, values: dict[str, Any]) -> Any:
    """The value of a formula."""
    if isinstance(node, ast.Constant):
        return node.value
    if isinstance(node, ast.Name):
        return values[node.id]
    if isinstance(node, ast.UnaryOp):
        return -value_of(node.operand, values)
    if isinstance(node, ast.BinOp):
        sides = value_of(node.left, values), value_of(node.right, values)
        return OPERATIONS[type(node.op)](*sides)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return FUNCTIONS[node.func.id](*(value_of(one, values) for one in node.args))
    raise ValueError(f"no formula: {ast.unparse(node)}")


def law_of(robot: Robot, model: Path) -> Law | None:
    """The formulas of a model; none where it has an effect of the catalogue besides."""
    effects = effects_of(model)
    formulas = [one for one in effects.values() if "formula" in one]
    if len(formulas) + len(effects.keys() & KNOWN) < len(effects):
        return None
    return Law(robot, formulas)
