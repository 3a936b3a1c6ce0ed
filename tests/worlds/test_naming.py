"""Answers that name a law, by its class, or not."""

from math import cos, isnan, pi, sin
from typing import Any

import pytest
from formula import Formula, read
from judge import judged
from naming import in_words, named_law, of_effect, worth
from setting import Pose, Setting

ORIGIN = (0.0, 0.0, 0.0)
ROOM = {"law": {"room_m": [-2.0, 3.0, -1.0, 4.0]}}


def formula(text: str, **numbers: float) -> Formula:
    found = read(text, numbers, ORIGIN)
    assert found is not None
    return found


def test_a_formula_is_computed_in_the_language_of_the_command() -> None:
    assert formula("-x^2 + pi").at(x=3.0, y=0.0) == pytest.approx(pi - 9)
    assert formula("k * max(speed - c, 0)", k=2.0, c=0.5).at(speed=1.0) == pytest.approx(1.0)
    assert formula("sign(turn_rate)").at(turn_rate=-2.0) == -1
    assert isnan(formula("sqrt(speed)").at(speed=-1.0))
    assert read("speed +", {}, ORIGIN) is None
    assert read("__import__('os')", {}, ORIGIN) is None


def test_what_a_formula_depends_on_is_more_than_a_sign() -> None:
    assert formula("sign(speed) * a * sin(heading)").variables == {"heading"}
    assert formula("sign(abs(speed) - 0.3)").variables == {"speed"}


def test_waves_thresholds_powers_and_places_are_found() -> None:
    assert formula("sin(2 * pi * time / c)", c=8.0).frequencies("time") == [
        pytest.approx(2 * pi / 8)
    ]
    assert formula("(1 + sign(abs(speed) - 0.3)) / 2").thresholds("speed") == [
        pytest.approx(one, abs=0.01) for one in (-0.3, 0.3)
    ]
    assert formula("1 + 2 * speed^3").degree("speed") == pytest.approx(3)
    assert formula("exp(-((x - 1)^2 + (y + 2)^2))").place() == pytest.approx((1, -2))
    turned = Formula(formula("exp(-((x - 1)^2 + y^2))").tree, {}, (2.0, 3.0, pi / 2))
    assert turned.place() == pytest.approx((2, 4))


def of(kind: str, **numbers: Any) -> Setting:
    """A robot with a law."""
    return Setting().with_(law_kind=kind, law_size=0.01, kind="squares", **numbers)


SPEED = of("speed_squared")
ABOVE = of("speed_above", law_acts_on="forward", law_scale=0.5)
TANH = of("speed_tanh", law_scale=0.3)
WAVE = of("time_wave", law_per="second", law_scale=19.0)
WAY = of("way_wave", law_scale=0.83)
SECOND = of("heading_wave", law_acts_on="forward", law_order=2)
SIDE = of("speed_times_turn_rate", law_acts_on="sideways", law_per="second")
TURNS = of("turn_rate_squared", law_per="second")
FAST_TURNS = of("turn_rate_above", law_acts_on="forward", law_per="radian", law_scale=0.4)
BRAKES = of("braking", law_per="second", law_scale=0.2)
FADES = of("fading", law_scale=35.0)
GROWS = of("growing", law_order=2)
BY_HEADING = of("speed_times_heading")
PULSE = of("wheel_pulse", law_scale=0.3, law_wheel="right")
DISC = of("disc", law_x_m=1.0, law_y_m=2.0, law_scale=0.5)
BY_X = of("place_x", law_acts_on="forward")
BY_Y = of("place_y_squared", law_acts_on="forward")
WALL = of("wall", law_x_m=-2.0, law_scale=0.5)


@pytest.mark.parametrize(
    ("setting", "acts_on", "text", "expected"),
    [
        (SPEED, "heading_per_metre", "a * speed^2", "right"),
        (SPEED, "heading_per_second", "a * abs(speed)^3", "right"),
        (SPEED, "heading_per_metre", "a * abs(speed)", "class"),
        (SPEED, "forward_scale", "a * speed^2", "no"),
        (SPEED, "heading_per_metre", "a * turn_rate^2", "no"),
        (ABOVE, "forward_scale", "a * (1 + sign(abs(speed) - 0.6)) / 2", "right"),
        (ABOVE, "forward_scale", "a * (1 + sign(abs(speed) - 0.7)) / 2", "class"),
        (ABOVE, "forward_scale", "a * max(abs(speed) - 0.5, 0)", "class"),
        (ABOVE, "forward_per_second", "a * (1 + sign(abs(speed) - 0.5)) / 2", "class"),
        (TANH, "heading_per_metre", "a * tanh(abs(speed) / 0.4)", "right"),
        (TANH, "heading_per_metre", "a * sqrt(abs(speed))", "class"),
        (TANH, "right_wheel_scale", "a * tanh(abs(speed) / 0.4)", "right"),
        (WAVE, "heading_per_second", "a * sin(2 * pi * time / 18.9)", "right"),
        (WAVE, "heading_per_second", "a * sin(2 * pi * time / 21)", "class"),
        (WAVE, "heading_per_second", "direction * sin(2 * pi * time / 18.9)", "class"),
        (WAVE, "heading_per_metre", "a * sin(2 * pi * distance / 18.9)", "no"),
        (WAY, "heading_per_metre", "a * cos(2 * pi * distance / 0.84)", "right"),
        (SECOND, "forward_scale", "a * cos(2 * heading) + b * sin(2 * heading)", "right"),
        (SECOND, "forward_scale", "a * cos(heading)", "class"),
        (SECOND, "sideways_per_metre", "a * cos(2 * heading)", "no"),
        (SIDE, "sideways_per_second", "a * speed * turn_rate", "right"),
        (SIDE, "sideways_per_metre", "a * turn_rate", "right"),
        (SIDE, "sideways_per_radian", "a * speed", "right"),
        (SIDE, "sideways_per_radian", "a * speed^2", "class"),
        (SIDE, "sideways_per_second", "a * speed", "no"),
        (TURNS, "turn_scale", "a * abs(turn_rate)", "right"),
        (TURNS, "heading_per_second", "a * turn_rate * abs(turn_rate)", "right"),
        (TURNS, "turn_scale", "a * turn_rate^2", "class"),
        (FAST_TURNS, "forward_per_radian", "a * (1 + sign(abs(turn_rate) - 0.45)) / 2", "right"),
        (FAST_TURNS, "forward_per_radian", "sign(turn_rate) * abs(turn_rate)", "class"),
        (
            BRAKES,
            "heading_per_second",
            "(1 + sign(-acceleration * sign(speed) - 0.22)) / 2",
            "right",
        ),
        (BRAKES, "heading_per_second", "(1 + sign(acceleration - 0.22)) / 2", "class"),
        (FADES, "heading_per_metre", "a * exp(-time / c)", "class"),
        (FADES, "heading_per_metre", "a * exp(-time / 30)", "right"),
        (GROWS, "heading_per_metre", "a * time^2", "right"),
        (GROWS, "heading_per_metre", "a * time", "class"),
        (BY_HEADING, "heading_per_metre", "abs(speed) * sin(heading - h)", "right"),
        (BY_HEADING, "heading_per_metre", "a * sin(heading)", "no"),
        (PULSE, "heading_per_metre", "exp(9 * cos(wheel_angle_right - p))", "right"),
        (PULSE, "heading_per_metre", "sin(2 * wheel_angle_right)", "class"),
        (PULSE, "heading_per_metre", "sin(2 * pi * distance / 0.314)", "class"),
        (PULSE, "heading_per_metre", "sin(2 * pi * distance / 0.5)", "no"),
        (DISC, "heading_per_metre", "exp(-((x - 1.3)^2 + (y - 1.8)^2) / 0.5)", "right"),
        (DISC, "heading_per_metre", "exp(-((x - 1.3)^2 + (y - 1.3)^2) / 0.5)", "no"),
        (DISC, "heading_per_metre", "a * x", "no"),
        (BY_X, "forward_scale", "a * x", "right"),
        (BY_X, "forward_scale", "a * (x + 0.8 * y)", "class"),
        (BY_X, "forward_scale", "a * y", "no"),
        (BY_Y, "forward_scale", "a * y^2", "right"),
        (BY_Y, "forward_scale", "a * y", "class"),
        (WALL, "heading_per_metre", "exp(-(x + 2) / 0.45)", "right"),
        (WALL, "heading_per_metre", "exp(-(x + 2) / 0.1)", "class"),
        (WALL, "heading_per_metre", "a * y", "no"),
    ],
)
def test_a_formula_names_a_law(setting: Setting, acts_on: str, text: str, expected: str) -> None:
    effect = {"acts_on": acts_on, "formula": text, "parameters": {"a": 0.02, "c": 3.0}}
    (said,) = of_effect(effect, ORIGIN)
    assert worth(said, ROOM, setting) == expected


def test_places_are_seen_from_start_of_the_first_run() -> None:
    start: Pose = (0.5, -1.0, 1.1)
    dx, dy = 1.0 - start[0], 2.0 - start[1]
    x, y = cos(1.1) * dx + sin(1.1) * dy, cos(1.1) * dy - sin(1.1) * dx
    text = f"exp(-((x - {x})^2 + (y - ({y}))^2) / 0.5)"
    effect = {"acts_on": "heading_per_metre", "formula": text}
    for origin, expected in ((start, "right"), (ORIGIN, "no")):
        (said,) = of_effect(effect, origin)
        assert worth(said, ROOM, DISC) == expected


def test_a_share_that_turns_over_in_reverse_is_another_law_where_the_robot_drives_back() -> None:
    effect = {"acts_on": "forward_scale", "formula": "sign(speed) * cos(2 * heading)"}
    (said,) = of_effect(effect, ORIGIN)
    assert worth(said, ROOM, SECOND) == "right"
    assert worth(said, ROOM, SECOND.with_(kind="joystick")) == "class"


@pytest.mark.parametrize(
    ("by", "text"),
    [
        ("a wave of 2 times the heading", "sin(2 * heading)"),
        ("a wave of the heading", "sin(1 * heading)"),
        ("a wave of the angle of the left wheel", "sin(1 * wheel_angle_left)"),
        ("a wave of the time with a period of about 18.9 s", "sin(2 * pi * time / 18.9)"),
        ("what dies away within 0.3 m of the least x", "exp(-x / 0.3)"),
        (
            "a place on the floor near (3.3, -0.5) m",
            "exp(-2 * ((x - (3.3))^2 + (y - (-0.5))^2))",
        ),
        ("the moon", None),
    ],
)
def test_words_mean_a_formula(by: str, text: str | None) -> None:
    assert in_words(by) == text


def answers(verdict: str, **learn: Any) -> dict[str, Any]:
    answer = {"verdict": verdict, **learn}
    return {"learn": {"exit": 0, "answer": answer, "stderr": "", "seconds": 1.0}}


def truth_of(setting: Setting) -> dict[str, Any]:
    numbers = setting.with_(start="origin").numbers()
    return {
        **ROOM,
        "world": "unlisted",
        "numbers": numbers,
        "apparent_delay_s": 0.0,
        "faults": [],
        "jumps": [],
        "corrections": [],
        "glitches": {},
        "far_poses": {},
        "e_d": 1.0,
        "e_b": 1.0,
        "e_s": 1.0,
    }


BUMP = {
    "motion": "yaw",
    "per": "metre",
    "by": "a place on the floor near (1.2, 2.1) m",
    "with_sense": False,
    "toml": None,
    "p": 0.002,
}


def test_what_repeats_names_a_law_unless_all_is_said_to_be_explained() -> None:
    said = {one: named_law(answers(one, repeats=BUMP), truth_of(DISC), DISC) for one in VERDICTS}
    assert [said[one]["law_right"] for one in VERDICTS] == ["right", "no"]


VERDICTS = ("not_explained", "explained")
STEP = {"heldout_rmse_m": 0.004, "rmse_m": 0.004, "p_adjusted": 0.01}


def test_a_step_names_a_law_by_its_formula_with_the_values_of_the_model() -> None:
    text = "a * sin(2 * pi * time / c)"
    step = {"added": "law", "class": ["law"], **STEP}
    step["law"] = {"acts_on": "heading_per_second", "formula": text}
    model = {"effect": [{"name": "law", "parameters": {"a": 0.01, "c": 18.5}}]}
    found = judged(
        answers("explained", steps=[step], model=model, fitted=[]), truth_of(WAVE), 0.004
    )
    assert (found["law_right"], found["explained"]) == ("right", "explained")
    assert found["left_out_by_truth"] == pytest.approx(1.0)
    assert (found["added_right"], found["added_wrong"], found["problems"]) == (["law"], [], [])


def test_explained_without_the_law_weighs_most_and_a_doubt_without_it_less() -> None:
    step = {"added": "caster_kick", "class": ["caster_kick"], **STEP}
    for verdict, weight in (("explained", 3), ("not_explained", 2)):
        found = judged(answers(verdict, steps=[step], fitted=[]), truth_of(WAVE), 0.004)
        assert found["law_right"] == "no"
        assert found["added_wrong"] == ["caster_kick"]
        assert max(weights for weights, _ in found["problems"]) == weight


def test_an_effect_of_the_catalogue_names_a_law_where_it_is_the_same() -> None:
    def said(name: str, setting: Setting) -> str:
        step = {"added": name, "class": [name], **STEP}
        learn = answers("explained", steps=[step])
        return str(named_law(learn, truth_of(setting), setting)["law_right"])

    third = of("heading_wave", law_order=3)
    assert said("turn_slip_rate", TURNS) == "class"
    assert said("missed_counts", ABOVE) == "no"
    assert said("floor_slope_yaw", third.with_(start="origin")) == "class"
    assert said("floor_slope_yaw", third.with_(start="room")) == "no"
    assert said("floor_slope_yaw", of("heading_wave", law_order=2, start="origin")) == "no"
