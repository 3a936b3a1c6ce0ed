"""Robots, paths, models, runs and datasets: frozen, picklable, and as the files say."""

import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, get_args

import mypy.api
import numpy as np
import pytest
import umbmark

LABMATE: dict[str, Any] = {
    "wheelbase_m": 0.34,
    "wheel_diameter_m": 0.15,
    "ticks_per_revolution": 2000,
}


Thing = TypeVar("Thing")


def again(thing: Thing) -> Thing:
    made: Thing = pickle.loads(pickle.dumps(thing))
    return made


def test_a_robot_has_the_keys_of_its_file_and_reads_back() -> None:
    robot = umbmark.Robot(name="R", encoder_rate_hz=50, counter_bits=16, **LABMATE)
    assert (robot.name, robot.wheelbase_m, robot.encoder_rate_hz) == ("R", 0.34, 50.0)
    assert robot == umbmark.Robot.from_toml(robot.to_toml()) == again(robot)
    assert robot != umbmark.Robot.labmate()
    assert repr(robot).startswith('Robot(name="R", drive="differential", wheelbase_m=0.34, ')
    assert robot.to_dict()["counter_bits"] == 16
    with pytest.raises(AttributeError):
        robot.wheelbase_m = 0.3  # type: ignore[misc]


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"wheelbase_m": -1.0}, "Robot: wheelbase_m must be between 0.001 and 100 m, got -1.0"),
        ({"wheelbase_m": 500.0}, "wheelbase_m must be between 0.001 and 100 m, got 500.0"),
        ({"encoder_rate_hz": 0.0}, "encoder_rate_hz must be between 0.001 and 1000000 Hz"),
        ({"counter_bits": 63}, "counter_bits must be between 1 and 62, got 63"),
        ({"wheelbse_m": 0.3}, 'unknown key "wheelbse_m" in [robot]; did you mean "wheelbase_m"?'),
        ({"track_width_m": 0.3}, "says what"),
        ({"encoder_rate_hz": "often"}, 'or "every tick", got "often"'),
    ],
)
def test_an_impossible_robot_is_refused_in_the_words_of_its_file(
    keys: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValueError, match=re.escape(words)):
        umbmark.Robot(**{**LABMATE, **keys})


def test_paths_of_every_shape_are_made_of_keys() -> None:
    square = umbmark.Path(side_m=4)
    assert square == umbmark.Path.umbmark() == again(square)
    assert umbmark.Path("rectangle", length_m=7, width_m=4).length_m == pytest.approx(22)
    points = np.array([[4.0, 0.0], [4.0, 4.0]])
    way = umbmark.Path("waypoints", points_m=points, speed_m_s=0.5)
    assert way.length_m == pytest.approx(8)
    assert way == again(way) != square
    assert umbmark.Path("straight", length_m=3).end("cw") == pytest.approx((3, 0, 0))
    assert repr(square).startswith('Path(shape="square", side_m=4.0')
    with pytest.raises(ValueError, match="Path: side_m must be between"):
        umbmark.Path(side_m=-4)
    with pytest.raises(ValueError, match='direction must be one of cw, ccw, got "left"'):
        square.end("left")


def test_the_words_for_drives_and_shapes_are_listed_with_what_they_are() -> None:
    drives, shapes = umbmark.Robot.drives(), umbmark.Path.shapes()
    assert next(iter(drives)) == "differential"
    assert next(iter(shapes)) == "square"
    assert all([*drives.values(), *shapes.values()])
    with pytest.raises(ValueError, match=f"one of {', '.join(map(re.escape, shapes))}"):
        umbmark.Path("sqare")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=f"one of {', '.join(map(re.escape, drives))}"):
        umbmark.Robot(drive="diferential", **LABMATE)  # type: ignore[arg-type]


def test_models_are_changed_by_making_others() -> None:
    nominal = umbmark.Model()
    model = nominal.add("wheelbase", e_b=1.01, free=True)
    assert (nominal.effects, model.effects) == ([], ["wheelbase"])
    both = model.add("wheelbase", e_b={"mean": 1.02, "sd": 0.001}).add(
        "placed_bumps", profile="edge"
    )
    assert both.get("wheelbase", "e_b") == 1.02
    robot, effect = both.to_toml().split("\n\n")[:2]
    assert robot.startswith('[robot]\nname = "TRC LabMate"\ndrive = "differential"\n')
    assert effect.startswith('[[effect]]\nname = "wheelbase"\ne_b = { mean = 1.02, sd')
    assert "free = true" in both.to_toml()
    assert both == again(both) == umbmark.Model.from_toml(both.to_toml()) != model
    assert both.remove("placed_bumps").effects == ["wheelbase"]
    assert both.get("crab", "angle_rad") is None
    assert model.to_dict() == {"effect": [{"name": "wheelbase", "e_b": 1.01, "free": True}]}
    assert repr(model) == "Model(TRC LabMate)\n    wheelbase, e_b = 1.01, free = true"


def test_a_model_of_another_robot_is_converted_with_a_warning(tmp_path: Path) -> None:
    wide = umbmark.Robot(**(LABMATE | {"wheelbase_m": 0.68}))
    text = umbmark.Model(wide).add("wheelbase", e_b=1.01).to_toml()
    (tmp_path / "model.toml").write_text(text)
    assert umbmark.Model.from_toml(text).robot == wide
    labmate = umbmark.Robot.labmate()
    words = r"model\.toml was made for a robot with wheelbase_m = 0\.68, which is 0\.34 here"
    with pytest.warns(umbmark.ConversionWarning, match=words):
        of_text = umbmark.Model.from_toml(text, labmate)
    with pytest.warns(umbmark.ConversionWarning, match=words):
        of_file = umbmark.Model.read(tmp_path / "model.toml", labmate)
    for model in (of_text, of_file):
        assert model.robot == labmate
        assert model.get("wheelbase", "e_b") == pytest.approx(2.02)


@pytest.mark.parametrize(
    ("name", "keys", "words"),
    [
        ("wheelbse", {}, 'got "wheelbse"; did you mean "wheelbase"?'),
        ("wheelbase", {"e_b": 9.0}, "Model: e_b must be between 0.2 and 5, got 9.0"),
        ("wheelbase", {"e_d": 1.0}, 'unknown key "e_d" in [[effect]]; did you mean "e_b"?'),
        ("wheelbase", {"e_b": {"mean": 1.0}}, "e_b has no sd"),
        ("mine", {"acts_on": "forward_scale", "formula": "k *"}, "formula"),
    ],
)
def test_an_impossible_effect_is_refused_in_the_words_of_its_file(
    name: str, keys: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValueError, match=re.escape(words)):
        umbmark.Model().add(name, **keys)


def test_what_no_file_holds_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="e_b must be a number, text, true or false"):
        umbmark.Model().add("wheelbase", e_b=object())  # type: ignore[arg-type]


def driven() -> umbmark.Dataset:
    model = umbmark.Model().add("wheel_noise", k_sqrt_m=1e-3)
    return umbmark.simulate(model, umbmark.Path(side_m=0.5), runs=2, reference_rate_hz=5)


def test_a_run_says_whether_its_poses_tell_motion_only(tmp_path: Path) -> None:
    data = driven()
    run = data.runs[0]
    assert run.relative is False
    assert umbmark.Run("cw", 1).relative is None
    steps = umbmark.Run(
        "cw",
        1,
        time_s=run.time_s,
        ticks_left=run.ticks_left,
        ticks_right=run.ticks_right,
        reference_sample=run.reference_sample,
        reference_pose=run.reference_pose,
        relative=True,
    )
    umbmark.Dataset(data.robot, data.path, [steps]).save(tmp_path / "steps")
    assert umbmark.load_dataset(tmp_path / "steps").runs[0].relative is True


def test_a_dataset_is_made_of_its_runs_to_the_last_bit(tmp_path: Path) -> None:
    data = driven()
    assert (
        repr(data) == "Dataset(TRC LabMate, square of 2.000000 m: 2 cw + 2 ccw runs, 4 with ticks)"
    )
    runs = [
        umbmark.Run(
            run.direction,
            run.number,
            name=run.name,
            returned=[value for value in run.returned or () if value is not None],
            time_s=run.time_s,
            ticks_left=run.ticks_left,
            ticks_right=run.ticks_right,
            reference_sample=run.reference_sample,
            reference_pose=run.reference_pose,
        )
        for run in data.runs
    ]
    made = umbmark.Dataset(data.robot, data.path, runs)
    assert data.save(tmp_path / "one") == made.save(tmp_path / "two") == []
    for file in ("robot.toml", "returns.csv", "runs/cw_01.csv"):
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()
    read = umbmark.load_dataset(tmp_path / "one")
    for copy in (again(data), read):
        np.testing.assert_array_equal(copy.returns("ccw"), data.returns("ccw"))
        for one, two in zip(copy.runs, data.runs, strict=True):
            assert (one.name, one.number, one.direction) == (two.name, two.number, two.direction)
            np.testing.assert_array_equal(one.reference_pose, two.reference_pose)
            np.testing.assert_array_equal(one.ticks_left, two.ticks_left)
    with pytest.raises(ValueError, match="choose another folder"):
        data.save(tmp_path / "one")
    data.save(tmp_path / "one", replace=True)


@pytest.mark.parametrize("layout", ["csv", "mcap", "optiodom", "tum", "returns"])
def test_every_layout_is_written_and_says_what_it_loses(layout: str, tmp_path: Path) -> None:
    lost = driven().save(tmp_path / layout, layout=layout)
    assert (lost == []) == (layout == "csv")
    assert any((tmp_path / layout).rglob("*"))


def test_files_that_are_wrong_are_a_value_error_that_names_them(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="nowhere"):
        umbmark.load_dataset(tmp_path / "nowhere")
    (tmp_path / "returns.csv").write_text("direction,run,ex_m\ncw,1,0.1\n")
    with pytest.raises(ValueError, match=r"returns\.csv"):
        umbmark.load_dataset(tmp_path)


TIME = np.arange(3.0)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"ticks_left": TIME[:2]}, "must be alike, got 3, 2 and 3 samples"),
        ({"time_s": TIME[::-1].copy()}, "time_s must increase, got 2 and 1 s at samples 0 and 1"),
        ({"ticks_right": np.full(3, np.nan)}, "ticks_right[0] must be finite, got NaN"),
        ({"reference_sample": np.array([3])}, "reference_sample[0] must be between 0 and 2, got 3"),
        ({"reference_sample": np.array([-1])}, "must be between 0 and 2, got -1"),
        ({"reference_pose": np.zeros((2, 3))}, "reference_pose must have shape (1, 3), got [2, 3]"),
        ({"reference_pose": np.full((1, 3), np.inf)}, "reference_pose[0] must be finite"),
        ({"time_s": None}, "time_s, ticks_left and ticks_right go together"),
        ({"direction": "left"}, 'direction must be one of cw, ccw, got "left"'),
        ({"returned": [1.0]}, "returned must be (x, y) or (x, y, heading), got 1 numbers"),
    ],
)
def test_a_run_that_cannot_have_been_is_refused(keys: dict[str, object], words: str) -> None:
    good = {
        "direction": "cw",
        "number": 1,
        "time_s": TIME,
        "ticks_left": TIME,
        "ticks_right": TIME,
        "reference_sample": np.array([1]),
        "reference_pose": np.zeros((1, 3)),
    }
    umbmark.Run(**good)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=re.escape(words)):
        umbmark.Run(**{**good, **keys})  # type: ignore[arg-type]


def keys_taken(make: Callable[..., object], *words: str, **keys: Any) -> set[str]:
    """Give the keys that a refusal of an unknown one lists."""
    with pytest.raises(ValueError, match=r"it takes (.*)$") as caught:
        make(*words, **keys, qqqqqqqqqqqqqqqqqqqq=1)
    return set(re.split(r", | and ", str(caught.value).split("it takes ")[1]))


def test_a_square_is_a_path_with_sides_of_a_length() -> None:
    assert umbmark.Path.square(4.0) == umbmark.Path(side_m=4.0) == umbmark.Path.square(side_m=4)
    slow = umbmark.Path.square(2, speed_m_s=0.1)
    assert slow == umbmark.Path(side_m=2.0, speed_m_s=0.1)
    with pytest.raises(ValueError, match="side_m"):
        umbmark.Path.square(-1.0)


def test_the_keys_that_are_checked_statically_are_those_that_are_taken() -> None:
    robots = (keys_taken(umbmark.Robot, drive=drive) for drive in umbmark.Robot.drives())
    assert set().union(*robots) == set(umbmark.RobotKeys.__annotations__)
    paths = (keys_taken(umbmark.Path, shape) for shape in umbmark.Path.shapes())
    assert set().union(*paths) - {"shape"} == set(umbmark.PathKeys.__annotations__)
    add = umbmark.Model().add
    effects = (keys_taken(add, effect) for effect in umbmark.effects())
    own = keys_taken(add, "own", acts_on="forward_scale", formula="k", parameters={"k": 1})
    assert set().union(own, *effects) - {"name"} == set(umbmark.EffectKeys.__annotations__)


def test_the_words_that_are_checked_statically_are_those_that_are_taken() -> None:
    assert get_args(umbmark.Drive) == tuple(umbmark.Robot.drives())
    assert get_args(umbmark.Shape) == tuple(umbmark.Path.shapes())
    assert get_args(umbmark.EffectName) == tuple(umbmark.effects())
    with pytest.raises(ValueError, match="acts_on must be one of") as caught:
        umbmark.Model().add("own", acts_on="nothing", formula="k", parameters={"k": 1})  # type: ignore[arg-type]
    for word in get_args(umbmark.ActsOn):
        assert word in str(caught.value)


def test_misspelt_keys_and_words_are_found_by_a_type_checker(tmp_path: Path) -> None:
    """A user's script in strict mode: clean as it is, and an error in each line that is wrong."""
    good = """
import umbmark

robot = umbmark.Robot(wheelbase_m=0.34, wheel_diameter_m=0.15, ticks_per_revolution=2000)
path = umbmark.Path("rectangle", length_m=7, width_m=4)
model = umbmark.Model(robot).add("wheelbase", e_b={"mean": 1.0, "sd": 1e-3}, free=True)
model = model.add("carpet", acts_on="heading_per_metre", formula="k", parameters={"k": 0.1})
data = umbmark.Dataset.from_arrays([[0.1, 0.2, 0.0]], [(0.1, 0.2, None)], robot=robot, path=path)
errors: list[umbmark.results.Step] = list(umbmark.learn(data, seed=None).steps)
residual = umbmark.fit(umbmark.simulate(model, path)).tracks()[0].residual.mean(axis=0)
quantile: float = umbmark.monte_carlo(model, path, n=10).ensemble.quantile("sigma_m", 0.5)
"""
    wrong = """
umbmark.Robot(wheelbse_m=0.34)
umbmark.Path("sqare")
umbmark.Path(sid_m=4)
model.add("wheelbase", e_bb=1.01)
model.add("carpet", acts_on="heading_per_meter")
data[0].wheelbase
"""
    place = tmp_path / "script.py"
    place.write_text(good)
    check = ["--strict", f"--cache-dir={tmp_path / 'cache'}", str(place)]
    report, _, status = mypy.api.run(check)
    assert (status, report) == (0, "Success: no issues found in 1 source file\n")
    place.write_text(good + wrong)
    report, _, status = mypy.api.run(check)
    found = {int(line.split(":")[1]) for line in report.splitlines() if ": error:" in line}
    first = len(good.splitlines()) + 2
    assert found == set(range(first, first + len(wrong.splitlines()) - 1)), report
