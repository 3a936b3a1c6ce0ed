"""Functions as formulas."""

import math
import re
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
import umbmark
from hypothesis import given
from hypothesis import strategies as st
from umbmark import _umbmark

PARAMETERS = {"k": 0.25, "q": 2.0}


@pytest.mark.parametrize(
    ("function", "formula"),
    [
        (lambda at, k, q: k * np.sin(at.heading - q), "k * sin(heading - q)"),
        (lambda at, k, q: k - (at.heading - q), "k - (heading - q)"),
        (lambda at, k, q: k / (q * at.heading), "k / (q * heading)"),
        (lambda at, k, q: -((at.heading + k) ** 2) * q, "-(heading + k)^2 * q"),
        (lambda at, k, q: (-at.heading) ** 2 + 2 * k + q, "(-heading)^2 + 2.0 * k + q"),
        (lambda at, k, q: np.maximum(at.heading, 0) * k - q, "max(heading, 0.0) * k - q"),
        (lambda at, k, q: np.float64(2) * at.heading * k + -3 * q, "2.0 * heading * k + -3.0 * q"),
        (
            lambda at, k, q: np.square(at.heading) * abs(k) - np.abs(q),
            "heading^2 * abs(k) - abs(q)",
        ),
        (lambda at, k, q: 1 - k - np.negative(at.heading) * q, "1.0 - k - -heading * q"),
        (lambda at, k, q: np.power(at.heading, 3) * k / q, "heading^3 * k / q"),
    ],
)
def test_a_function_is_written_as_a_formula_that_means_the_same(
    function: Callable[..., Any], formula: str
) -> None:
    assert umbmark.formula_of(function, PARAMETERS) == formula
    for heading in (-2.0, 0.0, 0.7):
        python = formula.replace("^", "**")
        words = {"sin": math.sin, "max": max, "abs": abs, "heading": heading, **PARAMETERS}
        at = SimpleNamespace(heading=heading)
        if "/ (q * heading)" in formula and heading == 0:
            continue
        assert function(at, **PARAMETERS) == pytest.approx(eval(python, words))


@pytest.mark.parametrize(
    ("function", "formula"),
    [
        (
            lambda at, k, q: np.where(at.heading > q, k, 0),
            "k * max(sign(heading - q), 0.0)",
        ),
        (
            lambda at, k, q: np.where(at.heading <= 0.5, k, q),
            "k * (1.0 - max(sign(heading - 0.5), 0.0)) + q * max(sign(heading - 0.5), 0.0)",
        ),
        (lambda at, k, q: k * (at.heading == q), "k * (1.0 - abs(sign(heading - q)))"),
        (lambda at, k, q: k * (np.float64(1) != at.heading), "k * abs(sign(1.0 - heading))"),
        (
            lambda at, k, q: k * ((at.heading >= -1) & (at.heading < q)),
            "k * ((1.0 - max(sign(-1.0 - heading), 0.0)) * max(sign(q - heading), 0.0))",
        ),
        (
            lambda at, k, q: np.where((at.heading > q) | (at.heading < -q), k, -k),
            None,
        ),
        (lambda at, k, q: np.where(~(at.heading > 0), 0, k * q), None),
        (lambda at, k, q: np.where(np.logical_not(at.heading > 0), q, k), None),
        (lambda at, k, q: np.where(np.logical_and(at.heading > 0, k < q), q, k), None),
        (lambda at, k, q: k * np.clip(at.heading, -0.5, q), "k * min(max(heading, -0.5), q)"),
        (lambda at, k, q: np.interp(at.heading, [-1, 0, 0.5, 2], [k, 0, q, -q]), None),
        (lambda at, k, q: k + np.interp(at.heading, [0, 1], [0.0, 0.25]) * q, None),
    ],
)
def test_choices_and_tables_of_numpy_mean_the_same_as_formulas(
    function: Callable[..., Any], formula: str | None
) -> None:
    made = umbmark.formula_of(function, PARAMETERS)
    assert formula in (None, made)
    words = {"sign": np.sign, "max": max, "min": min, "abs": abs, **PARAMETERS}
    for heading in (-3.0, -2.0, -1.0, -0.4, 0.0, 0.2, 0.5, 1.0, 1.7, 2.0, 2.5):
        expected = function(SimpleNamespace(heading=np.float64(heading)), **PARAMETERS)
        value = eval(made, {**words, "heading": heading})
        assert value == pytest.approx(float(expected), rel=1e-12, abs=1e-15)


def test_a_choice_is_driven_and_its_size_is_fitted_back() -> None:
    """A floor that pushes one way only while the robot drives fast."""
    own: dict[str, Any] = {
        "acts_on": "heading_per_metre",
        "formula": lambda at, k: np.where(at.speed > 0.1, k * np.clip(at.heading, -1, 1), 0),
    }
    noisy = umbmark.Model().add("wheel_noise", k_sqrt_m=1e-4)
    truth = noisy.add("push", parameters={"k": 0.004}, **own)
    data = umbmark.simulate(truth, umbmark.Path(side_m=2.0), runs=3, reference_rate_hz=2)
    start = umbmark.Model().add("push", parameters={"k": 0.0}, free=True, **own)
    (found,) = umbmark.fit(data, start).fitted
    assert found.standard_error is not None
    assert abs(found.value - 0.004) < 5 * found.standard_error < 0.002


# Expressions as trees: a number of Python, a symbol, or an operator with two of them.
TREES = st.recursive(
    st.sampled_from(["at.heading", "k", "q", "1.5", "-2.0"]),
    lambda inner: st.builds(
        lambda a, sign, b: f"({a} {sign} {b})", inner, st.sampled_from("+-*"), inner
    ),
    max_leaves=12,
)


@given(tree=TREES)
def test_any_expression_keeps_its_value_without_its_own_parentheses(tree: str) -> None:
    def function(at: Any, k: Any, q: Any) -> Any:
        return eval(tree, {"at": at, "k": k, "q": q})

    heading, formula = 0.3, umbmark.formula_of(function, PARAMETERS)
    at = SimpleNamespace(heading=heading)
    value = eval(formula, {"heading": heading, **PARAMETERS})
    assert value == pytest.approx(function(at, **PARAMETERS), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda at, k, q: k if at.heading > 0 else q, "cannot branch on a value"),
        (lambda at, k, q: k if at.direction == 1 else q, "cannot branch on a value"),
        (lambda at, k, q: k * q if 0 < at.speed < 1 else 0.0, "cannot branch on a value"),
        (lambda at, k, q: np.median(at.heading) * k * q, "a formula has no np.median; it has"),
        (lambda at, k, q: np.interp(at.speed, [0, 0], [k, q]), "needs places that increase"),
        (lambda at, k, q: np.interp(at.speed, [0, 1], [k]), "as many places as values"),
        (lambda at, k, q: k * q if at.heading else 0.0, "cannot branch on a value"),
        (lambda at, k, q: k * math.sin(at.heading) * q, "one of another module was called"),
        (lambda at, k, q: k * np.arctan(at.heading) * q, "a formula has no np.arctan; it has"),
        (lambda at, k, q: k * at.hedding * q, "there is no quantity 'hedding'; there are speed"),
        (lambda at, k, q: k * at.heading**0.5 * q, "whole exponents only"),
        (lambda at, k, q: k * at.heading**q, "whole exponents only"),
    ],
)
def test_what_a_formula_cannot_do_is_a_type_error_that_says_so(
    function: Callable[..., Any], words: str
) -> None:
    with pytest.raises(TypeError, match=re.escape(words)):
        umbmark.Model().add(
            "mine", acts_on="heading_per_metre", formula=function, parameters=PARAMETERS
        )


def test_every_variable_of_a_formula_can_be_traced() -> None:
    names = _umbmark.formula_variables()
    assert {"speed", "turn_acceleration", "x", "y"} <= set(names)
    assert len(set(names)) == len(names)
    for name in names:

        def law(at: Any, k: Any, name: str = name) -> Any:
            return k * getattr(at, name)

        assert umbmark.formula_of(law, {"k": 1.0}) == f"k * {name}"
        model = umbmark.Model().add(
            "mine", acts_on="forward_scale", formula=law, parameters={"k": 0.0}
        )
        assert f'formula = "k * {name}"' in model.to_toml()
    with pytest.raises(TypeError, match="there are " + ", ".join(names)):
        umbmark.formula_of(lambda at: at.hedding, {})


def test_a_function_of_the_place_drives_as_its_law_says() -> None:
    model = umbmark.Model().add(
        "mine", acts_on="forward_scale", formula=lambda at, k: k * at.x, parameters={"k": 0.02}
    )
    path = umbmark.Path(side_m=4.0)
    data = umbmark.simulate(model, path, runs=1, seed=1, reference_rate_hz=2)
    returned = next(run for run in data.runs if run.direction == "ccw").returned
    assert returned is not None
    # The second leg is longer than the fourth by (e^(kL) - 1) L; ticks round.
    assert returned[1] == pytest.approx(math.expm1(0.02 * 4.0) * 4.0, abs=1e-3)


def test_a_function_and_its_formula_drive_to_the_same_bits_and_are_fitted_back() -> None:
    def carpet(at: Any, k: Any) -> Any:
        return k * np.sin(at.heading + 0.5)

    own: dict[str, Any] = {"acts_on": "heading_per_metre", "parameters": {"k": 0.004}}
    noisy = umbmark.Model().add("wheel_noise", k_sqrt_m=1e-4)
    by_function = noisy.add("carpet", formula=carpet, **own)
    by_text = noisy.add("carpet", formula="k * sin(heading + 0.5)", **own)
    assert by_function == by_text
    data = umbmark.simulate(by_function, umbmark.Path(side_m=2.0), runs=3, reference_rate_hz=2)
    start = umbmark.Model().add(
        "carpet", acts_on="heading_per_metre", formula=carpet, parameters={"k": 0.0}, free=True
    )
    (found,) = umbmark.fit(data, start).fitted
    assert found.standard_error is not None
    assert abs(found.value - 0.004) < 5 * found.standard_error < 0.002


def test_parallel_trials_take_a_function() -> None:
    model = umbmark.Model().add(
        "push",
        acts_on="sideways_per_metre",
        formula=lambda at, k: k * np.tanh(at.heading),
        parameters={"k": 0.01},
    )
    one, two = (umbmark.monte_carlo(model, n=8, runs=1, threads=n) for n in (1, 2))
    assert one.metrics == two.metrics
    assert (one.metrics["e_max_sys_m"].mean or 0) > 0.01


@pytest.fixture(scope="module")
def with_a_law() -> umbmark.Learnt:
    """Return what is learnt of a robot that a law of its place turns."""
    truth = umbmark.Model().add("wheel_noise", k_sqrt_m=1e-4)
    truth = truth.add("reference_noise", position_sd_m=5e-4, heading_sd_rad=5e-4)
    truth = truth.add("cable", acts_on="heading_per_metre", formula="k * x", parameters={"k": 0.03})
    data = umbmark.simulate(truth, umbmark.Path(side_m=1.5), runs=5, reference_rate_hz=4)
    return umbmark.learn(data, draws=99)


def test_a_law_of_a_result_is_added_to_a_model(with_a_law: umbmark.Learnt) -> None:
    law = next(step.law for step in with_a_law.steps if step.law)
    start = umbmark.fit(with_a_law.data).model
    fitted = umbmark.fit(with_a_law.data, start.add(law))
    assert fitted.model.effects == with_a_law.model.effects
    assert fitted.tracks().rms_m < 0.2 * umbmark.tracks(with_a_law.data, start).rms_m
    fixed = start.add(law, free=False)
    assert fixed.effects == [*start.effects, fixed.effects[-1]]
    assert "free = true" not in fixed.to_toml().split("[[effect]]")[-1].split("[noise]")[0]
    twice = start.add(law).add(law)
    assert twice == start.add(law)
    other = next(one for one in law.others if one.toml)
    assert len(start.add(other).effects) == len(start.effects) + 1


def test_a_law_without_a_formula_is_refused(with_a_law: umbmark.Learnt) -> None:
    law = next(step.law for step in with_a_law.steps if step.law)
    with pytest.raises(ValueError, match="this law has no formula that a model could hold"):
        umbmark.Model().add(msgspec.structs.replace(law, toml=None))


def test_a_figure_of_a_result_is_that_of_its_data_and_model(with_a_law: umbmark.Learnt) -> None:
    figure = with_a_law.figure("parameters")
    assert figure == umbmark.plot("parameters", with_a_law.data, with_a_law.model)
    assert figure.to_plotly()["data"]
    with pytest.raises(ValueError, match='there is no figure "portrait"; there are'):
        with_a_law.figure("portrait")
