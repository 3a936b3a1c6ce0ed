"""Results: the documents of the command, typed; tables, frames, figures, pickles."""

import json
import pickle
import re
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import umbmark
from umbmark._result import Record, Result

SIDE = 0.5


class Part(Record, frozen=True):
    name: str
    sizes_m: tuple[float, ...]


class Whole(Result, frozen=True):
    seed: int
    parts: tuple[Part, ...]


def test_a_result_without_a_table_of_its_own_has_that_of_its_first_list_or_of_its_numbers() -> None:
    part = {"name": "left", "sizes_m": [0.1]}
    assert Whole._of(json.dumps({"seed": 1, "parts": [part]})).table() == [{"name": "left"}]
    empty = Whole._of('{"seed": 1, "parts": []}')
    assert empty.table() == [{"seed": 1}]
    assert "<td>1</td>" in empty._repr_html_()


@pytest.fixture(scope="module")
def data() -> umbmark.Dataset:
    """Return a robot on a slope, by its return poses."""
    model = umbmark.Model().add("wheel_diameter_ratio", e_d=1.002).add("wheelbase", e_b=1.01)
    model = model.add("wheel_noise", k_sqrt_m=3e-4).add("floor_slope", drift_x=0.01)
    return umbmark.simulate(model, umbmark.Path(side_m=SIDE), runs=6, reference_rate_hz=0, seed=3)


@pytest.fixture(scope="module")
def folder(data: umbmark.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the same in files."""
    place = tmp_path_factory.mktemp("data") / "robot"
    data.save(place)
    return place


@pytest.fixture(scope="module")
def tracks(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a robot that was watched, in files."""
    model = umbmark.Model().add("wheel_noise", k_sqrt_m=3e-4).add("crab", angle_rad=0.01)
    place = tmp_path_factory.mktemp("data") / "robot"
    path = umbmark.Path(side_m=SIDE)
    umbmark.simulate(model, path, runs=3, reference_rate_hz=5, seed=3).save(place)
    return place


CALLS: dict[str, tuple[Callable[[Path], Result], tuple[str, ...]]] = {
    "score": (lambda place: umbmark.score(place), ("score",)),
    "calibrate": (lambda place: umbmark.calibrate(place), ("calibrate",)),
    "compare": (lambda place: umbmark.compare(place, draws=99), ("compare", "--draws", "99")),
    "diagnose": (lambda place: umbmark.diagnose(place, draws=99), ("diagnose", "--draws", "99")),
    "fit": (
        lambda place: umbmark.fit(place, add=["floor_slope"]),
        ("fit", "--add", "floor_slope"),
    ),
    "learn": (lambda place: umbmark.learn(place, draws=99), ("learn", "--draws", "99")),
    "inspect": (lambda place: umbmark.inspect(place), ("inspect",)),
    "plan": (
        lambda place: umbmark.plan(place, see={"eb": 1.005, "es": 1.01}, draws=99),
        ("plan", "--see", "eb=1.005", "--see", "es=1.01", "--draws", "99"),
    ),
    "separate": (
        lambda place: umbmark.separate("wheelbase", "crab", place),
        ("plan", "--separate", "wheelbase", "crab"),
    ),
}
# Results that are told as the command tells them, and the words of the command.
TOLD = {name: CALLS[name] for name in CALLS if name not in ("plan", "separate")} | {
    "solve": (lambda place: umbmark.solve(place, draws=99), ("solve", "--draws", "99"))
}


@cache
def result_of(verb: str, place: Path) -> Result:
    """Return what the call gives, worked out once."""
    return (CALLS | TOLD)[verb][0](place)


def told(command: Path, *arguments: str | Path) -> Any:
    run = [command, *arguments, "--json"]
    return json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)


@pytest.mark.parametrize("verb", CALLS)
@pytest.mark.parametrize("observed", ["folder", "tracks"])
def test_a_result_is_the_document_of_the_command(
    verb: str, observed: str, command: Path, request: pytest.FixtureRequest
) -> None:
    place: Path = request.getfixturevalue(observed)
    words = CALLS[verb][1]
    assert result_of(verb, place).to_dict() == told(command, words[0], place, *words[1:])


GRADES: list[dict[str, Any]] = [
    {"name": "ed", "mean": 1.0, "sd": 0.001},
    {
        "name": "eb",
        "grades": [{"mean": 1, "sd": 0.01, "cost": 0}, {"min": 0.998, "max": 1.002, "cost": 8}],
    },
]
GRADES_FILE = """
[[parameter]]
name = "ed"
mean = 1.0
sd = 0.001

[[parameter]]
name = "eb"
grades = [{ mean = 1, sd = 0.01, cost = 0 }, { min = 0.998, max = 1.002, cost = 8 }]

[[correlation]]
of = ["ed", "eb"]
value = 0.3
"""


@pytest.fixture(scope="module")
def grades(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a file of parameters with their grades."""
    place = tmp_path_factory.mktemp("grades") / "parameters.toml"
    place.write_text(GRADES_FILE)
    return place


NOISE = umbmark.Model().add("wheel_noise", k_sqrt_m=1e-3)

# What is asked without data; the words of the command, {} being the file of grades.
STUDIES: dict[str, tuple[Callable[[Path], Result], str]] = {
    "tolerance": (
        lambda _: umbmark.tolerance(GRADES, robots=2000, correlations={("ed", "eb"): 0.3}),
        "tolerance {} -n 2000",
    ),
    "tolerance of a file": (
        lambda file: umbmark.tolerance(file, NOISE, robots=500, target=0.04, with_noise=True),
        "tolerance {} -n 500 --target 40mm --with-noise",
    ),
    "sweep of one axis": (
        lambda _: umbmark.sweep(NOISE, {"eb": (0.99, 1.01, 3)}, n=20, seed=4),
        "mc --sweep eb=0.99:1.01:3 -n 20 --seed 4",
    ),
    "sweep of two": (
        lambda _: umbmark.sweep(NOISE, {"ed": (1.0, 1.002, 2), "side": (2, 4, 3)}, n=20),
        "mc --sweep ed=1.0:1.002:2 --sweep side=2:4:3 -n 20",
    ),
    "sensitivity": (
        lambda file: umbmark.sensitivity(NOISE, parameters=file, effort=64),
        "sensitivity --parameters {} -n 64",
    ),
    "sensitivity to what is given": (
        lambda _: umbmark.sensitivity(
            NOISE,
            effort=64,
            parameters=[
                {"name": "ed", "mean": 1.0, "sd": 0.001},
                {"name": "side", "min": 2, "max": 5},
            ],
            correlations={("ed", "side"): 0.5},
        ),
        "sensitivity -n 64 --vary ed=normal:1:0.001 --vary side=uniform:2:5"
        " --correlate ed,side=0.5",
    ),
    "plan": (
        lambda _: umbmark.plan(see={"floor_slope.drift_x": 0.004}, draws=99, runs=4),
        "plan --see slope-x=0.004 --draws 99 --runs 4",
    ),
    "separate": (lambda _: umbmark.separate("crab", "scale"), "plan --separate crab scale"),
    "paper": (lambda _: umbmark.paper(n=20, seed=3), "paper -n 20 --seed 3"),
    "a table of the paper": (lambda _: umbmark.paper("table_1", n=10), "paper table-1 -n 10"),
    "a figure of the paper": (lambda _: umbmark.paper("figure_2"), "paper figure-2"),
}


@cache
def study_of(name: str, grades: Path) -> Result:
    """Return what the call gives, worked out once."""
    return STUDIES[name][0](grades)


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_is_the_document_of_the_command(name: str, command: Path, grades: Path) -> None:
    words = STUDIES[name][1]
    expected = told(command, *words.format(grades).split())
    # What the command assumes, Python is told.
    assumed = {"assumed": expected["assumed"]} if "assumed" in expected else {}
    assert study_of(name, grades).to_dict() | assumed == expected


def printed(command: Path, *arguments: str | Path) -> str:
    """Return what the command prints, without what it assumed."""
    run = [command, *arguments]
    text = subprocess.run(run, check=True, capture_output=True, text=True).stdout
    return re.sub(r"^  assumed: .*\n(?:    .*\n)*", "", text, flags=re.MULTILINE)


@pytest.mark.parametrize("name", [name for name in STUDIES if "paper" not in name])
def test_a_study_is_printed_as_by_the_command(name: str, command: Path, grades: Path) -> None:
    words = STUDIES[name][1]
    assert f"{study_of(name, grades)}\n" == printed(command, *words.format(grades).split())


def test_trials_are_printed_as_by_the_command_but_for_their_speed(
    command: Path, tmp_path: Path
) -> None:
    words = ("mc", "--ed", "1.002", "--wheel-noise", "0.001", "-n", "100")
    expected = re.sub(r", \d+ trials/s", "", printed(command, *words))
    model = umbmark.Model().add("wheel_diameter_ratio", e_d=1.002)
    study = umbmark.Study(model.add("wheel_noise", k_sqrt_m=0.001), n=100)
    found = umbmark.monte_carlo(study.model, n=100)
    assert f"{found}\n" == expected
    for shard in range(2):
        study.run((shard, 2), checkpoint=tmp_path / f"{shard}.json")
    merged = umbmark.merge(tmp_path / "0.json", tmp_path / "1.json")
    assert f"{merged}\n" == expected


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_has_a_table_a_figure_and_a_pickle(name: str, grades: Path) -> None:
    has_all(study_of(name, grades))


@pytest.mark.parametrize("verb", CALLS)
def test_a_result_has_a_table_a_figure_and_a_pickle(verb: str, folder: Path) -> None:
    has_all(result_of(verb, folder))


def has_all(result: Any) -> None:
    from matplotlib import pyplot

    rows = result.table()
    assert len(rows) > 0
    assert list(result.to_pandas().columns) == list(rows[0]) == result.to_polars().columns
    assert len(result.to_pandas()) == len(rows)
    assert f"<table><caption>{type(result).__name__}" in result._repr_html_()
    assert repr(result).startswith(f"{type(result).__name__}(\n")
    assert pickle.loads(pickle.dumps(result)) == result
    axes = result.plot()
    assert result.plot(axes) is axes
    assert axes.lines or axes.patches or axes.collections
    pyplot.close("all")


def test_models_are_compared_along_tracks(tracks: Path) -> None:
    from matplotlib import pyplot

    found = umbmark.compare(tracks, {"nominal": umbmark.Model()}, draws=99)
    assert isinstance(found, umbmark.TrackComparison)
    (nominal,) = found.models
    assert not nominal.explains
    assert found.table()[0]["rmse_m"] == nominal.along.rmse_m
    assert pickle.loads(pickle.dumps(found)) == found
    assert len(found.plot().patches) == 2
    assert isinstance(umbmark.compare(tracks, return_poses=True, draws=99), umbmark.Comparison)
    pyplot.close("all")


def test_a_dataset_is_drawn_by_returns_and_by_tracks(tracks: Path) -> None:
    from matplotlib import pyplot

    data = umbmark.load_dataset(tracks)
    runs = [len(data.returns(direction)) for direction in ("cw", "ccw")]
    axes = data.plot()
    assert [np.size(line.get_xdata()) for line in axes.lines][:2] == runs
    tracked = data.plot(tracks=True)
    assert len(tracked.lines) == len(data.runs) + 1
    pyplot.close("all")


def test_the_catalogue_is_that_of_the_command(command: Path) -> None:
    listed = told(command, "effects")["effects"]
    assert [*umbmark.effects()] == [entry["name"] for entry in listed]
    crab = umbmark.effects()["crab"]
    assert (crab.title, crab.parameters[0].unit) == (
        listed[[*umbmark.effects()].index("crab")]["title"],
        "rad",
    )


def test_a_calibration_is_put_to_use(data: umbmark.Dataset, folder: Path, tmp_path: Path) -> None:
    found = umbmark.calibrate(data)
    assert found.exact.e_d == pytest.approx(1.002, abs=2e-3)
    exact = umbmark.Robot.from_toml(found.export("robot_toml", method="exact"))
    assert exact.wheelbase_m == pytest.approx(found.exact.wheelbase_m)
    # Without a method it is the learnt model, which calibrate's row and solve say too.
    robot = umbmark.Robot.from_toml(found.export("robot_toml"))
    assert found.exported == "model"
    row = found.methods["model"]
    assert row is not None
    assert robot.wheelbase_m == pytest.approx(row.wheelbase_m)
    answer = umbmark.solve(data).correction["wheelbase_m"]
    assert robot.wheelbase_m == pytest.approx(answer.new)
    assert answer.low is not None
    assert answer.high is not None
    assert answer.low < 0.34 * 1.01 < answer.high
    assert "diff_drive_controller" in found.export("ros2_control")
    assert "#define" in found.export("c_header", method="closed_form_mean")
    with pytest.raises(ValueError, match=r'format must be one of ros2_control, .* got "xml"'):
        found.export("xml")
    with pytest.raises(ValueError, match='there is no correction by "best"'):
        found.export("c_header", method="best")


def test_a_run_far_from_the_others_is_told_first_and_puts_the_lengths_in_doubt(
    data: umbmark.Dataset, tmp_path: Path
) -> None:
    x, y, heading = data.returns("cw")[0]
    typed = umbmark.Run("cw", 1, returned=(x + 1.0, y, heading))
    odd = umbmark.Dataset(data.robot, data.path, [typed, *data.runs[1:]])
    score, found = umbmark.score(odd), umbmark.calibrate(odd)
    assert score.setup == found.setup
    (outlying,) = score.setup.returns
    assert (outlying.run, outlying.direction, outlying.others) == (typed.name, "cw", 5)
    assert outlying.deviants[0].coordinate == "x"
    assert outlying.moved_m == pytest.approx(1.0, abs=0.1)
    for warnings in (score.warnings, found.warnings):
        assert outlying.said[1:] in warnings[0]
    (page,) = umbmark.report(odd, umbmark.Model(), n=100, draws=99).studies
    assert any(outlying.said[1:] in notice for notice in page.notices)
    assert outlying.said[1:] in found.doubts[0]
    with pytest.raises(ValueError, match="the lengths are in doubt; force=True gives them"):
        found.export("c_header")
    assert "#define" in found.export("c_header", force=True)
    assert umbmark.diagnose(odd, draws=99).reasons


def test_what_is_taken_from_the_motion_is_told_with_its_size() -> None:
    truth = umbmark.Model().add("wheel_noise", k_sqrt_m=3e-4)
    truth = truth.add("marker_offset", forward_m=0.1)
    data = umbmark.simulate(truth, umbmark.Path(side_m=SIDE), runs=3, reference_rate_hz=5)
    found = umbmark.fit(data)
    assert found.setup.reference is not None
    ahead = found.setup.reference.ahead_m
    assert ahead is not None
    assert ahead.value == pytest.approx(0.1, abs=5e-3)
    (taken,) = found.taken
    assert (taken.effect, taken.p < 0.01) == ("marker_offset", True)
    assert taken.parameters["forward_m"].value == pytest.approx(0.1, abs=5e-3)


def test_a_robot_of_another_drive_is_calibrated_as_by_the_command(
    command: Path, tmp_path: Path
) -> None:
    robot = umbmark.Robot(
        drive="synchro",
        wheel_circle_m=0.5,
        wheel_diameter_m=0.15,
        ticks_per_revolution=2000,
        steering_ticks_per_revolution=10_000,
    )
    truth = umbmark.Model(robot).add("wheel_noise", k_sqrt_m=3e-4).add("scale", e_s=1.01)
    data = umbmark.simulate(truth, umbmark.Path(side_m=SIDE), runs=3, reference_rate_hz=5)
    data.save(tmp_path / "synchro")
    found = umbmark.calibrate_gears(data)
    # The folder knows its times to a microsecond only.
    expected = told(command, "calibrate", tmp_path / "synchro")
    assert found.to_dict().keys() == expected.keys()
    read = umbmark.calibrate_gears(tmp_path / "synchro")
    assert read.to_dict() == expected
    scale = found.fitted[0]
    assert scale.effect == "drive_scale"
    assert scale.interval is not None
    assert scale.interval[0] < 1.01 < scale.interval[1]
    assert found.corrected["wheel_diameter_m"] == pytest.approx(0.15 * scale.value)
    has_all(read)
    with pytest.raises(ValueError, match='got drive = "synchro"; use calibrate_gears'):
        umbmark.calibrate(data)


def test_learning_begins_with_the_model_that_is_given(
    folder: Path, command: Path, tmp_path: Path
) -> None:
    start = umbmark.Model().add("floor_slope", free=True)
    (tmp_path / "start.toml").write_text(start.to_toml())
    learnt = umbmark.learn(folder, start, draws=99)
    words = ("learn", folder, "--draws", "99", "--model", tmp_path / "start.toml")
    assert learnt.to_dict() == told(command, *words)
    added = [step.added for step in learnt.steps]
    assert added[:4] == [None, "wheel_diameter_ratio", "wheelbase", "floor_slope"]


def test_the_sheet_of_a_plan_is_that_of_the_command(command: Path, tmp_path: Path) -> None:
    files = [tmp_path / "sheet.md", tmp_path / "sheet.html"]
    written = ("-o", files[0], "-o", files[1], "--order", "blocks", "--runs", "4", "--draws", "99")
    told(command, "plan", *written)
    found = umbmark.plan(runs=4, order="blocks", numbers=[], draws=99)
    assert [found.sheet("md"), found.sheet("html")] == [file.read_text() for file in files]
    with pytest.raises(ValueError, match='format must be one of md, html, got "pdf"'):
        found.sheet("pdf")


def test_a_model_that_was_learnt_explains_the_data(folder: Path) -> None:
    learnt = result_of("learn", folder)
    assert isinstance(learnt, umbmark.Learnt)
    assert learnt.steps[0].added is None
    errors = [step.heldout_rmse_m for step in learnt.steps]
    assert errors[-1] is not None
    assert errors[0] is not None
    assert errors[-1] < errors[0] / 3
    judged = umbmark.compare(
        folder, {"nominal": umbmark.Model(), "learnt": learnt.model}, draws=199
    )
    assert [model.explains for model in judged.models] == [False, True]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda data: umbmark.diagnose(data, size=0),
            "size must be between 0 and 1, both excluded",
        ),
        (lambda data: umbmark.learn(data, draws=5), "draws must be between 99 and 99999, got 5"),
        (lambda data: umbmark.fit(data, umbmark.Model()), "no effect of the model is free"),
        (lambda data: umbmark.fit(data, add=["slop"]), 'there is no effect "slop"'),
        (lambda data: umbmark.calibrate(data, level=95), "level must be between 0 and 1"),
        (
            lambda data: umbmark.diagnose(umbmark.Dataset(None, None, data.runs)),
            "the nominal robot is not known",
        ),
        (lambda _: umbmark.inspect(umbmark.Dataset()), "there are no runs"),
        (lambda _: umbmark.plan(see={"e_bb": 1.0}), 'no effect has a size "e_bb"'),
        (lambda _: umbmark.plan(runs=2), "runs a direction must be between 3 and 1000, got 2"),
        (lambda _: umbmark.plan(power=0.04), r"power must be greater than size, 0\.05"),
        (lambda _: umbmark.plan(sigma_m=-1), "sigma_m must be positive and finite"),
        (lambda _: umbmark.plan(order="random"), "order must be one of mirrored, alternating"),
        (
            lambda _: umbmark.separate("crab", "crab"),
            "two different effects are needed, got crab twice",
        ),
        (lambda _: umbmark.tolerance([{"name": "e_dd", "mean": 1, "sd": 1}]), "e_dd"),
        (lambda _: umbmark.tolerance(GRADES, target=-1), "target must be positive and finite"),
        (lambda _: umbmark.tolerance(GRADES, metric="e_max"), 'there is no metric "e_max"'),
        (lambda _: umbmark.sweep(NOISE, {"e_dd": (0, 1, 2)}), 'there is no parameter "e_dd"'),
        (lambda _: umbmark.sweep(NOISE, {"ed": (0.9, 1, 0)}), "a sweep has between 1 and"),
        (lambda _: umbmark.sensitivity(NOISE), "nothing is varied"),
        (
            lambda _: umbmark.paper("table_3"),
            "experiment must be one of table_1, table_2, figure_2",
        ),
        (lambda _: umbmark.paper(n=1), "n must be between 10 and 10000000, got 1"),
        (lambda _: umbmark.paper("figure_2").plot(quantity="x"), "there is no quantity 'x'; there"),
    ],
)
def test_what_cannot_be_answered_is_a_value_error(
    call: Callable[[umbmark.Dataset], object], words: str, data: umbmark.Dataset
) -> None:
    with pytest.raises(ValueError, match=words):
        call(data)


def test_tables_have_the_numbers_of_their_result(data: umbmark.Dataset) -> None:
    result = umbmark.score(data)
    rows = {row["score"]: row["value"] for row in result.table()}
    assert rows["e_max_sys_m"] == result.e_max_sys_m
    assert np.isclose(rows["centroid_cw_x_m"], data.returns("cw")[:, 0].mean(), rtol=0, atol=1e-12)


def test_results_are_equal_and_hashed_by_value_without_how_long_they_took() -> None:
    one, two = (umbmark.monte_carlo(NOISE, n=300) for _ in range(2))
    assert one.trials_per_s != two.trials_per_s
    assert one == two
    assert len({one, two}) == 1
    assert one != umbmark.monte_carlo(NOISE, n=300, seed=2)
    kept = [umbmark.monte_carlo(NOISE, n=300, keep=True) for _ in range(2)]
    assert kept[0] == kept[1] != one
    assert kept[0].trials is not None
    kept[0].trials["sigma_m"][0] += 1.0
    assert kept[0] != kept[1]


def test_what_is_merged_in_any_order_equals_the_whole_study() -> None:
    study = umbmark.Study(NOISE, n=1000)
    parts = [study.run((index, 3))[0] for index in range(3)]
    whole, _, _ = study.run()
    for first, *rest in ((0, 1, 2), (2, 1, 0), (1, 2, 0)):
        merged = parts[first].merge(*(parts[index] for index in rest))
        assert merged == whole
        assert hash(merged) == hash(whole)
        assert pickle.dumps(merged) == pickle.dumps(whole)
    assert parts[0] != whole


def test_a_column_in_which_nothing_is_known_has_its_type(tmp_path: Path) -> None:
    runs = [
        umbmark.Run(way, number, returned=(0.01 * number, 0.02))
        for way in ("cw", "ccw")
        for number in (1, 2)
    ]
    without_headings = umbmark.Dataset(None, None, runs)
    bare = [umbmark.score(without_headings), umbmark.score([[0.1, 0.2, 0.3]], [[0.1, 0.2, 0.3]])]
    assert bare[0].return_heading_cw_rad is None
    kinds = {str(score.to_arrow().schema.field("low").type) for score in bare}
    assert kinds == {"double"}
    assert bare[1].to_pandas()["low"].dtype == bare[1].to_polars()["low"].to_numpy().dtype == float
    path = umbmark.Path(side_m=SIDE)
    learnt = umbmark.learn(umbmark.simulate(NOISE, path, runs=3, reference_rate_hz=0), draws=99)
    assert str(learnt.to_arrow().schema.field("heldout_rmse_m").type) == "double"
    few = umbmark.compare(
        umbmark.simulate(NOISE, path, runs=1, reference_rate_hz=5), umbmark.Model()
    )
    assert isinstance(few, umbmark.TrackComparison)
    assert few.models[0].explains is None
    assert str(few.to_arrow().schema.field("explains").type) == "bool"
    assert (
        str(Whole._of('{"seed": 1, "parts": []}').to_arrow().schema.field("seed").type) == "int64"
    )


@pytest.mark.parametrize("verb", TOLD)
@pytest.mark.parametrize("observed", ["folder", "tracks"])
def test_a_result_is_printed_as_the_command_prints_it(
    verb: str, observed: str, command: Path, request: pytest.FixtureRequest
) -> None:
    place: Path = request.getfixturevalue(observed)
    word, *flags = TOLD[verb][1]
    run = subprocess.run([command, word, place, *flags], check=True, capture_output=True, text=True)
    assert len(run.stdout) > 200
    assert f"{result_of(verb, place)}\n" == run.stdout


def test_a_score_of_arrays_is_printed_without_a_figure(data: umbmark.Dataset) -> None:
    whole = str(umbmark.score(data))
    alone = str(umbmark.score(data.returns("cw"), data.returns("ccw")))
    assert whole.startswith(alone)
    assert alone.startswith("UMBmark score of 6 cw + 6 ccw runs\n")
    assert len(whole) > len(alone)


def test_notebooks_show_verdict_sentence_and_a_table_in_millimetres_and_degrees(
    data: umbmark.Dataset, folder: Path
) -> None:
    learnt, answer = (result_of(verb, folder) for verb in ("learn", "solve"))
    assert isinstance(learnt, umbmark.Learnt)
    assert isinstance(answer, umbmark.Solution)
    html = learnt._repr_html_()
    assert html.startswith(f"<p><b>{learnt.verdict}</b></p><p>The robot comes back ")
    assert "<th>added</th><th>p adjusted</th><th>rmse [mm]</th>" in html
    assert "<th>heldout heading rmse [deg]</th>" in html
    last = learnt.steps[-1]
    assert last.rmse_m is not None
    assert f"<td>{1e3 * last.rmse_m:.5g}</td>" in html
    assert f"<td>{last.added}</td>" in html
    solved = answer._repr_html_()
    new = 1e3 * answer.correction["wheelbase_m"].new
    assert f"<td>wheelbase [mm]</td><td>340</td><td>{new:.5g}</td>" in solved
    heading = umbmark.score(data).return_heading_cw_rad
    assert heading is not None
    shown = umbmark.score(data)._repr_html_()
    assert f"<td>return heading cw [deg]</td><td>{np.degrees(heading):.5g}</td>" in shown
    rates = result_of("fit", folder)._repr_html_()
    assert "<td>drift_x</td>" in rates
    found = umbmark.monte_carlo(NOISE, n=100)
    assert str(found).startswith("Monte Carlo of UMBmark: 100 trials of ")


def test_a_sweep_is_a_grid_of_xarray() -> None:
    found = umbmark.sweep(NOISE, {"eb": (0.99, 1.01, 3), "ed": (1.0, 1.002, 2)}, n=40, runs=2)
    grid = found.to_xarray()
    assert dict(grid.sizes) == {"eb": 3, "ed": 2, "share": 5}
    for point in found.points:
        eb, ed = point.values
        here = grid.sel(eb=eb, ed=ed, method="nearest")
        assert (float(here.eb), float(here.ed)) == pytest.approx(point.values)
        of = point.metrics["sigma_m"]
        assert float(here.sigma_m) == of.mean
        assert float(here.sigma_m_std_error) == of.std_error
        assert float(here.sigma_m_std_dev) == of.std_dev
        assert float(here.sigma_m_quantile.sel(share=0.95)) == of.quantiles["0.95"]
    stopped = msgspec.structs.replace(found, points=found.points[:4], partial=True).to_xarray()
    assert int(stopped.e_max_sys_m.isnull().sum()) == 2
    assert stopped.attrs["seed"] == found.seed


def test_the_trials_of_a_study_are_a_dataset_of_xarray() -> None:
    found = umbmark.monte_carlo(NOISE, n=30, keep=True)
    assert found.trials is not None
    trials = found.to_xarray()
    assert dict(trials.sizes) == {"trial": 30}
    assert set(trials) == set(found.trials)
    np.testing.assert_array_equal(trials.sigma_m, found.trials["sigma_m"])
    with pytest.raises(ValueError, match="say keep=True"):
        umbmark.monte_carlo(NOISE, n=3).to_xarray()
