"""Arguments as scientists have them: any numbers, sequences, frames, seeds; errors name them."""

import pickle
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
import umbmark

NOISE = umbmark.Model().add("wheel_noise", k_sqrt_m=1e-3)
CW = np.array([[-0.21, -0.19, -0.05], [-0.19, -0.21, -0.06], [-0.20, -0.23, -0.04]])
CCW = np.array([[0.02, 0.01, 0.01], [0.01, -0.02, 0.02], [0.00, -0.02, 0.00]])
NAMES = ["x", "y", "heading"]

SHAPES: dict[str, Callable[[np.ndarray], Any]] = {
    "lists": lambda rows: rows.tolist(),
    "tuples": lambda rows: tuple(map(tuple, rows.tolist())),
    "Fortran order": np.asfortranarray,
    "every second row": lambda rows: np.repeat(rows, 2, axis=0)[::2],
    "other endian": lambda rows: rows.astype(">f8"),
    "read-only": lambda rows: np.frombuffer(rows.tobytes()).reshape(rows.shape),
    "pandas": lambda rows: pd.DataFrame(rows, columns=NAMES),
    "nullable pandas": lambda rows: pd.DataFrame(rows, columns=NAMES).astype("Float64"),
    "polars": lambda rows: pl.DataFrame(rows, schema=NAMES, orient="row"),
    "Arrow": lambda rows: pa.table(dict(zip(NAMES, rows.T, strict=True))),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_return_errors_are_taken_from_any_sequence_array_and_frame(shape: str) -> None:
    given = umbmark.score(SHAPES[shape](CW), SHAPES[shape](CCW))
    assert given == umbmark.score(CW, CCW)


def test_return_errors_are_taken_in_every_real_type() -> None:
    exact = umbmark.score(CW, CCW)
    assert exact.e_max_sys_m is not None
    for kind, error in ((np.float32, 1e-7), (np.float16, 1e-3), (np.longdouble, 1e-15)):
        found = umbmark.score(CW.astype(kind), CCW.astype(kind)).e_max_sys_m
        assert found == pytest.approx(exact.e_max_sys_m, abs=error)
    whole = umbmark.score([[1, 0, 0], [1, 1, 0]], np.array([[0, 1], [0, 2]], np.int8))
    assert whole.e_max_sys_m == pytest.approx(1.5)


def test_a_heading_that_was_not_measured_may_be_missing_in_every_way() -> None:
    gaps = CW.copy()
    gaps[1, 2] = np.nan
    rows = [[None if np.isnan(value) else value for value in row] for row in gaps]
    frame = pd.DataFrame(rows, columns=NAMES).astype("Float64")
    exact = umbmark.score(gaps, CCW)
    assert exact == umbmark.score(rows, CCW) == umbmark.score(frame, CCW)
    assert umbmark.score(CW[:, :2], CCW[:, :2]) == umbmark.score(
        CW[:, :2].tolist(), pl.DataFrame(CCW[:, :2], schema=NAMES[:2], orient="row")
    )


@pytest.mark.parametrize(
    ("wrong", "kind", "words"),
    [
        ("many", TypeError, "ccw must be numbers of shape (n, 3), or (n, 2) without heading, got"),
        ([["a", "b"]], TypeError, "got list of dtype <U1"),
        ([[1.0, 2.0], [1.0]], TypeError, "ccw must be numbers"),
        (CW > 0, TypeError, "got ndarray of dtype bool"),
        (CW * 1j, TypeError, "got ndarray of dtype complex128"),
        (np.ma.masked_invalid(CW), TypeError, "ccw must not be masked; say ccw.filled(numpy.nan)"),
        (object(), TypeError, "ccw must be numbers of shape (n, 3)"),
        ([1.0, 2.0], ValueError, "ccw must have shape (n, 3), or (n, 2) without heading, got"),
        (CW[:, :1], ValueError, "got shape (3, 1)"),
        (CW[None], ValueError, "got shape (1, 3, 3)"),
        ([[np.inf, 0.0, 0.0]], ValueError, "ccw[0]"),
    ],
)
def test_what_has_no_numbers_is_refused_by_the_name_of_the_argument(
    wrong: Any, kind: type[Exception], words: str
) -> None:
    with pytest.raises(kind, match=re.escape(words)):
        umbmark.score(CW, wrong)


def test_a_run_is_made_of_counts_of_any_type() -> None:
    counts, time = np.array([0, 10, 20]), [0, 0.5, 1]
    columns: list[Callable[[Any], Any]] = [
        list,
        pd.Series,
        pl.Series,
        pa.array,
        np.int32,
        np.uint64,
    ]
    made = [
        umbmark.Run(
            "cw",
            np.int64(1),  # type: ignore[arg-type]
            time_s=pd.Series(time),
            ticks_left=column(counts) if callable(column) else counts.astype(column),
            ticks_right=counts.astype(np.float32),
            reference_sample=[0.0, 2.0],
            reference_pose=[[0.0, 0.0], [0.1, 0.0]],
        )
        for column in columns
    ]
    assert len({run.ticks_left.dtype for run in made if run.ticks_left is not None}) == 1
    assert all(run == made[0] for run in made)
    assert made[0].reference_pose is not None
    np.testing.assert_array_equal(made[0].reference_pose, [[0, 0, np.nan], [0.1, 0, np.nan]])


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"ticks_left": ["a", "b", "c"]}, "ticks_left must be numbers of shape (n,), got list"),
        ({"ticks_right": np.zeros((3, 2))}, "ticks_right must have shape (n,), got (3, 2)"),
        ({"reference_sample": [0.5]}, "reference_sample[0] must be a whole number, got 0.5"),
        ({"reference_pose": [1.0, 2.0]}, "reference_pose must have shape (n, 3)"),
    ],
)
def test_columns_of_a_run_are_refused_by_name(keys: dict[str, Any], words: str) -> None:
    good: dict[str, Any] = {
        "time_s": [0, 1, 2],
        "ticks_left": [0, 1, 2],
        "ticks_right": [0, 1, 2],
        "reference_sample": [1],
        "reference_pose": [[0, 0, 0]],
    }
    with pytest.raises((TypeError, ValueError), match=re.escape(words)):
        umbmark.Run("cw", 1, **{**good, **keys})


def test_quantiles_and_shares_take_one_number_or_many() -> None:
    ensemble = umbmark.monte_carlo(NOISE, n=300).ensemble
    middle = ensemble.quantile("e_max_sys_m", 0.5)
    assert isinstance(middle, float)
    assert ensemble.quantile("e_max_sys_m", [0.5, 1]).tolist()[0] == middle
    assert ensemble.share_below("e_max_sys_m", middle) == pytest.approx(0.5, abs=0.01)
    assert ensemble.share_below("e_max_sys_m", np.array([middle], np.float32)).shape == (1,)
    with pytest.raises(ValueError, match=r"shares must be between 0 and 1, got 1\.5"):
        ensemble.quantile("e_max_sys_m", 1.5)
    with pytest.raises(TypeError, match="shares must be numbers"):
        ensemble.quantile("e_max_sys_m", ["half"])


def test_a_seed_is_a_number_or_drawn_from_what_numpy_draws_from() -> None:
    def seed_of(seed: umbmark.Seed) -> int:
        return umbmark.monte_carlo(NOISE, n=1, seed=seed).seed

    assert seed_of(np.int64(7)) == 7
    sources: list[Callable[[], umbmark.Seed]] = [
        lambda: np.random.default_rng(5),
        lambda: np.random.PCG64(5),
        lambda: np.random.SeedSequence(5),
    ]
    for source in sources:
        assert seed_of(source()) == seed_of(source()) != seed_of(1)
    generator = np.random.default_rng(5)
    assert seed_of(generator) != seed_of(generator)
    fresh = [umbmark.monte_carlo(NOISE, n=1, seed=None) for _ in range(2)]
    assert fresh[0].seed != fresh[1].seed
    assert umbmark.monte_carlo(NOISE, n=1, seed=fresh[0].seed) == fresh[0]


def test_every_call_with_a_seed_takes_none_and_records_it() -> None:
    path = umbmark.Path(side_m=1)
    drawn = umbmark.Model().add("wheelbase", e_b={"mean": 1.0, "sd": 1e-3})
    assert umbmark.simulate(NOISE, path, seed=None) != umbmark.simulate(NOISE, path, seed=None)
    assert umbmark.Study(NOISE, seed=None).seed != umbmark.Study(NOISE, seed=None).seed
    data = umbmark.simulate(NOISE.add("crab", angle_rad=0.01), path, reference_rate_hz=0)
    calls: list[Callable[[], Any]] = [
        lambda: umbmark.diagnose(data, draws=99, seed=None),
        lambda: umbmark.learn(data, draws=99, seed=None),
        lambda: umbmark.solve(data, draws=99, seed=None),
        lambda: umbmark.sweep(NOISE, {"eb": (1, 1.01, 2)}, path, n=1, seed=None),
        lambda: umbmark.sensitivity(drawn, path, effort=32, noise_free=True, seed=None),
        lambda: umbmark.paper("figure_2", seed=None),
    ]
    for call in calls:
        seeds = [call().seed for _ in range(2)]
        assert seeds[0] != seeds[1]


@pytest.mark.parametrize(
    ("keys", "kind", "words"),
    [
        ({"n": 0}, ValueError, "n must be between 1 and 1000000000000, got 0"),
        ({"n": -1}, ValueError, "n must be between 1 and 1000000000000, got -1"),
        ({"n": 1.5}, TypeError, "n must be a whole number, got 1.5 (float)"),
        ({"threads": -1}, ValueError, "threads must be between 0 (all processors) and 65535"),
        ({"threads": "all"}, TypeError, "threads must be a whole number, got 'all' (str)"),
        ({"seed": -1}, ValueError, "seed must be between 0 and 18446744073709551615, got -1"),
        ({"seed": 1.5}, TypeError, "seed must be a whole number, a numpy Generator"),
        ({"runs": "many"}, ValueError, "runs must be a whole number, 0 or more, or two of them"),
        ({"runs": -1}, ValueError, "runs must be a whole number, 0 or more, or two of them"),
    ],
)
def test_a_wrong_number_is_refused_by_the_name_of_its_argument(
    keys: dict[str, Any], kind: type[Exception], words: str
) -> None:
    with pytest.raises(kind, match=re.escape(words)):
        umbmark.monte_carlo(NOISE, **{"n": 1, **keys})


def test_tests_are_refused_by_the_name_of_their_argument() -> None:
    data = umbmark.simulate(NOISE, umbmark.Path(side_m=1), reference_rate_hz=0)
    for keys, words in (
        ({"draws": -1}, "draws must be between 99 and 99999, got -1"),
        ({"draws": 99.5}, "draws must be a whole number, got 99.5 (float)"),
        ({"size": "small"}, "size must be a number, got 'small' (str)"),
        ({"threads": -1}, "threads must be between 0"),
    ):
        with pytest.raises((TypeError, ValueError), match=re.escape(words)):
            umbmark.diagnose(data, **keys)


def test_numpys_numbers_stand_for_pythons() -> None:
    data = umbmark.simulate(NOISE, umbmark.Path(side_m=np.float32(1)), runs=np.int64(2))  # type: ignore[arg-type]
    assert len(data) == 4
    assert umbmark.monte_carlo(NOISE, n=np.int32(3), threads=np.uint8(1)).n == 3  # type: ignore[arg-type]


def test_every_quantity_of_a_formula_is_written_in_python() -> None:
    assert "turn_acceleration" in umbmark._umbmark.formula_variables()
    for name in umbmark._umbmark.formula_variables():
        formula = umbmark.formula_of(lambda at, k, name=name: k * getattr(at, name), {"k": 0.0})
        assert formula == f"k * {name}"


def test_a_dataset_is_a_sequence_of_its_runs() -> None:
    data = umbmark.simulate(NOISE, umbmark.Path(side_m=0.5), runs=2, reference_rate_hz=2)
    assert len(data) == 4
    assert [run.name for run in data] == ["cw_01", "cw_02", "ccw_01", "ccw_02"]
    assert data[-1] == data["ccw_02"] == data.runs[3]
    assert data[0] in data
    assert data[0] != data[1]
    part = data[::2]
    assert [run.name for run in part] == ["cw_01", "ccw_01"]
    assert (part.robot, part.path) == (data.robot, data.path)
    with pytest.raises(IndexError):
        data[4]
    with pytest.raises(KeyError, match='there is no run "cw_03"; there are cw_01, cw_02'):
        data["cw_03"]
    with pytest.raises(TypeError):
        data[1.5]  # type: ignore[call-overload]


def test_datasets_and_runs_are_equal_and_hashed_by_what_they_hold() -> None:
    path = umbmark.Path(side_m=0.5)
    data = umbmark.simulate(NOISE, path, runs=2, reference_rate_hz=2)
    same = umbmark.simulate(NOISE, path, runs=2, reference_rate_hz=2)
    other = umbmark.simulate(NOISE, path, runs=2, reference_rate_hz=2, seed=2)
    again = pickle.loads(pickle.dumps(data))
    assert data == same == again != other
    assert len({data, same, again}) == len({data[0], same[0], again[0]}) == 1
    assert data != umbmark.Dataset(data.robot, umbmark.Path(side_m=0.6), data.runs)
    assert data != data[:3]
    assert {umbmark.Robot.labmate(): 1}[umbmark.Robot.labmate()] == 1
    assert len({path, umbmark.Path(side_m=0.5), NOISE, umbmark.Model()}) == 3


def test_runs_with_the_same_number_or_name_are_refused() -> None:
    def run(number: int, name: str | None = None, test: str = "systematic") -> umbmark.Run:
        return umbmark.Run("cw", number, name=name, test=test, returned=(0.1, 0.2))

    words = re.escape('runs[0] and runs[2] are both number 1 or "third"')
    with pytest.raises(ValueError, match=words):
        umbmark.Dataset(None, None, [run(1), run(2), run(1, "third")])
    with pytest.raises(ValueError, match=r'runs\[0\] and runs\[1\] are both number 2 or "one"'):
        umbmark.Dataset(None, None, [run(1, "one"), run(2, "one")])
    assert len(umbmark.Dataset(None, None, [run(1), run(1, "bumpy", "bumps")])) == 2


def test_a_model_keeps_what_speaks_against_it() -> None:
    text = NOISE.to_toml() + '\n[doubt]\nbecause = "Too few runs."\nalone = true\n'
    model = umbmark.Model.from_toml(text)
    assert model.doubt == "Too few runs."
    assert NOISE.doubt is None
    assert model.to_toml() == text
    for changed in (pickle.loads(pickle.dumps(model)), model.add("wheelbase", e_b=1.01)):
        assert changed.doubt == "Too few runs."
    with pytest.raises(ValueError, match=r"the model is in doubt; force=True .* Too few runs\."):
        umbmark.export(model, to="toml")
    assert umbmark.export(model, to="toml", force=True).notes[0] == "Too few runs."
    assert "Too few runs." not in umbmark.export(model, to="embedded").notes


def test_a_learnt_model_says_what_speaks_against_it() -> None:
    truth = umbmark.Model().add("wheel_noise", k_sqrt_m=1e-4)
    truth = truth.add("reference_noise", position_sd_m=5e-4, heading_sd_rad=5e-4)
    hidden = "0.2 * sin(20 * x) * cos(9 * y)"
    truth = truth.add("hidden", acts_on="heading_per_metre", formula=hidden)
    data = umbmark.simulate(truth, umbmark.Path(side_m=1.0), runs=3, reference_rate_hz=2)
    learnt = umbmark.learn(data, draws=99)
    assert learnt.verdict == "not_explained"
    assert learnt.model.doubt is not None
    assert learnt.model.doubt.startswith("No model explains these runs: ")
    assert umbmark.solve(data, draws=99).model.doubt == learnt.model.doubt


def test_one_name_is_a_name_and_not_its_letters() -> None:
    data = umbmark.simulate(NOISE, runs=3, reference_rate_hz=0)
    one = umbmark.fit(data, add="floor_slope", fix="floor_slope.drift_y")
    assert one == umbmark.fit(data, add=["floor_slope"], fix=["floor_slope.drift_y"])
    parameters = [e.parameter for e in one.fitted if e.effect == "floor_slope"]
    assert "drift_x" in parameters
    assert "drift_y" not in parameters


WRONG: dict[str, tuple[Callable[[umbmark.Dataset], object], str]] = {
    "add": (
        lambda data: umbmark.fit(data, add=[3]),  # type: ignore[list-item]
        "add must be names, got 3 (int)",
    ),
    "add, no sequence": (
        lambda data: umbmark.fit(data, add=3),  # type: ignore[arg-type]
        "add must be names, got 3 (int)",
    ),
    "fix": (
        lambda data: umbmark.fit(data, fix={"wheelbase.e_b": "one"}),  # type: ignore[dict-item]
        """fix["wheelbase.e_b"] must be a number, got 'one' (str)""",
    ),
    "axes": (
        lambda _: umbmark.sweep(NOISE, "ed"),  # type: ignore[arg-type]
        "axes must be a mapping of names to (first, last, count), got 'ed' (str)",
    ),
    "values": (
        lambda _: umbmark.sweep(NOISE, {"ed": np.linspace(0.9, 1.1, 5)}),  # type: ignore[dict-item]
        'axes["ed"] must be (first, last, count), got array(',
    ),
    "count": (
        lambda _: umbmark.sweep(NOISE, {"ed": (0.9, 1.1, 2.5)}),  # type: ignore[dict-item]
        'count of axes["ed"] must be a whole number, got 2.5 (float)',
    ),
    "end": (
        lambda _: umbmark.sweep(NOISE, {"ed": ("low", 1.1, 3)}),  # type: ignore[dict-item]
        """first of axes["ed"] must be a number, got 'low' (str)""",
    ),
    "see": (
        lambda _: umbmark.plan(see="eb"),  # type: ignore[arg-type]
        "see must be a mapping of names to sizes, got 'eb' (str)",
    ),
    "numbers": (
        lambda _: umbmark.plan(numbers=5),  # type: ignore[arg-type]
        "numbers must be numbers of shape (n,), got 5 (int)",
    ),
    "parameters": (
        lambda _: umbmark.tolerance({"name": "eb"}),  # type: ignore[arg-type]
        "parameters must be a file, or a list of its tables, got {'name': 'eb'}",
    ),
    "level": (
        lambda data: umbmark.fit(data, level="x"),  # type: ignore[arg-type]
        "level must be a number, got 'x' (str)",
    ),
    "level of a score": (
        lambda data: umbmark.score(data, level="x"),  # type: ignore[call-overload]
        "level must be a number, got 'x' (str)",
    ),
    "heading_arm_m": (
        lambda data: umbmark.calibrate(data, heading_arm_m="x"),  # type: ignore[arg-type]
        "heading_arm_m must be a number, got 'x' (str)",
    ),
    "size": (
        lambda data: umbmark.conditions(data, size="x"),  # type: ignore[arg-type]
        "size must be a number, got 'x' (str)",
    ),
    "power": (
        lambda _: umbmark.plan(power="x"),  # type: ignore[arg-type]
        "power must be a number, got 'x' (str)",
    ),
    "target": (
        lambda _: umbmark.tolerance([], target="x"),  # type: ignore[arg-type]
        "target must be a number, got 'x' (str)",
    ),
    "data": (
        lambda _: umbmark.fit(CW),  # type: ignore[arg-type]
        "(ndarray); Dataset.from_arrays and from_frame make one",
    ),
    "no data": (
        lambda _: umbmark.fit([]),
        "data must be a Dataset, its place, or several places, got [] (list)",
    ),
    "model": (
        lambda data: umbmark.fit(data, "model.toml"),  # type: ignore[arg-type]
        "model must be a Model, got 'model.toml' (str); Model.read reads a file",
    ),
    "models": (
        lambda data: umbmark.compare(data, {"mine": "model.toml"}),  # type: ignore[dict-item]
        "model must be a Model, got 'model.toml' (str); Model.read reads a file",
    ),
    "model of a study": (
        lambda _: umbmark.monte_carlo("model.toml", n=1),  # type: ignore[arg-type]
        "model must be a Model, got 'model.toml' (str); Model.read reads a file",
    ),
    "model of a sweep": (
        lambda _: umbmark.sweep("model.toml", {"ed": (0.9, 1.1, 3)}),  # type: ignore[arg-type]
        "model must be a Model, got 'model.toml' (str); Model.read reads a file",
    ),
    "model of a report": (
        lambda data: umbmark.report(data, "model.toml"),  # type: ignore[arg-type]
        "model must be a Model, got 'model.toml' (str); Model.read reads a file",
    ),
    "model of a figure": (
        lambda data: umbmark.plot("circle", data, "model.toml"),  # type: ignore[arg-type]
        "model must be a Model, got 'model.toml' (str); Model.read reads a file",
    ),
    "model to export": (
        lambda _: umbmark.export("model.toml", to="toml"),  # type: ignore[arg-type]
        "model must be a Model, got 'model.toml' (str); Model.read reads a file",
    ),
    "model to simulate": (
        lambda _: umbmark.simulate("model.toml"),  # type: ignore[arg-type]
        "model must be a Model, got 'model.toml' (str); Model.read reads a file",
    ),
    "reference_rate_hz": (
        lambda _: umbmark.simulate(NOISE, reference_rate_hz="x"),  # type: ignore[arg-type]
        "reference_rate_hz must be a number, got 'x' (str)",
    ),
    "trial": (
        lambda _: umbmark.simulate(NOISE, trial=0.5),  # type: ignore[arg-type]
        "trial must be a whole number, got 0.5 (float)",
    ),
    "name of an effect": (
        lambda _: umbmark.Model().add(3),  # type: ignore[arg-type]
        "name must be that of an effect, a function, or a suggestion, got 3 (int)",
    ),
    "number of a run": (
        lambda _: umbmark.Run("cw", "one"),  # type: ignore[arg-type]
        "number must be a whole number, got 'one' (str)",
    ),
    "index": (
        lambda data: data[1.5],  # type: ignore[call-overload]
        "index must be a whole number, got 1.5 (float)",
    ),
    "place": (
        lambda _: umbmark.load_dataset(3),  # type: ignore[arg-type]
        "place must be a path, or several, got 3 (int)",
    ),
    "start": (
        lambda data: umbmark.apply(data, NOISE, start="here"),  # type: ignore[arg-type]
        "start must be numbers of shape (n,), got str",
    ),
    "robots": (
        lambda data: umbmark.survey(data),  # type: ignore[arg-type]
        "robots must be a mapping or a sequence of data, got Dataset",
    ),
    "progress": (
        lambda data: umbmark.learn(data, progress="yes"),  # type: ignore[arg-type]
        "progress must be True, False or a function of the steps done and of all, got 'yes' (str)",
    ),
}


@pytest.mark.parametrize("argument", WRONG)
def test_what_is_of_the_wrong_kind_is_refused_by_the_name_of_the_argument(argument: str) -> None:
    call, words = WRONG[argument]
    data = umbmark.simulate(NOISE, runs=2, reference_rate_hz=0)
    with pytest.raises(TypeError, match=re.escape(words)):
        call(data)


def test_a_number_that_is_out_of_range_is_refused_by_the_name_of_the_argument() -> None:
    with pytest.raises(ValueError, match="numbers must be between 0 and"):
        umbmark.plan(numbers=[-1])
    with pytest.raises(ValueError, match="robots must be between 0 and"):
        umbmark.tolerance([], robots=-3)
    with pytest.raises(
        ValueError, match="trial must be between 0 and 18446744073709551615, got -1"
    ):
        umbmark.simulate(NOISE, trial=-1)
    with pytest.raises(ValueError, match="number must be between 0 and 4294967295, got -1"):
        umbmark.Run("cw", -1)
    data = umbmark.simulate(NOISE, runs=2, reference_rate_hz=0)
    for index in (4, -5, 2**70):
        with pytest.raises(IndexError, match=f"index must be between -4 and 3, got {index}"):
            data[index]
    assert data[-1] == data[3]
    with pytest.raises(ValueError, match=f"draws must be between 99 and 99999, got {2**70}"):
        umbmark.diagnose(data, draws=2**70)
    for start in ((1, 2), (0, 0, np.nan)):
        with pytest.raises(ValueError, match="start must be three finite numbers"):
            umbmark.apply(data, NOISE, start=start)  # type: ignore[arg-type]
