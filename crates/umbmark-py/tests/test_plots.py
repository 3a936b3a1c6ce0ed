"""Figures with matplotlib: those of the report, those of results, and what is said without it."""

import sys
from collections.abc import Callable
from contextlib import suppress
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import umbmark
from matplotlib import colors, pyplot
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Rectangle
from umbmark import _panels

PATH = umbmark.Path(side_m=1.0)
TRUTH = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=3e-4)


@pytest.fixture(scope="module")
def learnt() -> umbmark.Learnt:
    """Return what was learnt from tracks of a robot on a slope."""
    truth = TRUTH.add("floor_slope", drift_x=0.01)
    truth = truth.add("reference_noise", position_sd_m=5e-4, heading_sd_rad=5e-4)
    return umbmark.learn(umbmark.simulate(truth, PATH, runs=5, reference_rate_hz=5), draws=99)


def without(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Make a package impossible to import."""
    for module in [module for module in sys.modules if module.split(".")[0] == name]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, name, None)


@pytest.fixture(scope="module")
def figures(learnt: umbmark.Learnt) -> dict[str, umbmark.Figure]:
    """Return the figures of the report that a result can draw."""
    drawn = {}
    for kind in umbmark.figures():
        with suppress(ValueError):
            drawn[kind] = learnt.figure(kind, n=100)
    assert {"tracks", "residuals_along", "residuals_by_speed", "correlations"} <= {*drawn}
    assert {"return_errors", "circle", "monte_carlo", "parameters", "runs"} <= {*drawn}
    return drawn


def test_figures_of_the_report_have_the_same_panels_ends_and_words(
    figures: dict[str, umbmark.Figure],
) -> None:
    for kind, figure in figures.items():
        layout = figure.to_plotly()["layout"]
        panels = [key.removeprefix("xaxis") for key in layout if key.startswith("xaxis")]
        axes = _panels.draw(figure, None)
        assert len(axes) == len(panels)
        for panel, ax in zip(panels, axes, strict=True):
            x, y = layout[f"xaxis{panel}"], layout[f"yaxis{panel}"]
            assert (ax.get_xlim(), ax.get_ylim()) == (tuple(x["range"]), tuple(y["range"])), kind
            assert (ax.get_xlabel(), ax.get_ylabel()) == (x["title"]["text"], y["title"]["text"])
            names = [name.replace(":<br>", ": ") for name in y.get("ticktext", [])]
            if names:
                assert [label.get_text() for label in ax.get_yticklabels()] == names
        axes[0].figure.canvas.draw()
        pyplot.close("all")


def test_figures_of_the_report_have_the_same_places_and_colours(
    figures: dict[str, umbmark.Figure],
) -> None:
    for kind, figure in figures.items():
        described = figure.to_plotly()
        axes = _panels.draw(figure, None)
        lines = [trace for trace in described["data"] if trace.get("mode") in ("lines", "markers")]
        bars = [trace for trace in described["data"] if trace["type"] == "bar"]
        ours = [line for ax in axes for line in ax.lines]
        # The ends of an interval are lines of their own.
        ours = [line for line in ours if line.get_marker() != "|"]
        assert len(ours) == len(lines), kind
        for line, trace in zip(ours, lines, strict=True):
            for values, key in ((line.get_xdata(), "x"), (line.get_ydata(), "y")):
                np.testing.assert_array_equal(values, np.array(trace[key], float))
            style = trace["line"] if trace["mode"] == "lines" else trace["marker"]
            assert colors.to_hex(line.get_color()) == style["color"]
        boxes = [patch for ax in axes for patch in ax.patches]
        assert len(boxes) == sum(len(trace["x"]) for trace in bars), kind
        pyplot.close("all")


def test_intervals_reach_as_far_as_in_the_report(figures: dict[str, umbmark.Figure]) -> None:
    described = figures["parameters"].to_plotly()
    (trace,) = [t for t in described["data"] if "error_x" in t]
    # Both sides differ, so that neither can stand for the other.
    trace["error_x"]["arrayminus"] = [0.5 * end for end in trace["error_x"]["arrayminus"]]
    told: Any = SimpleNamespace(kind="parameters", to_plotly=lambda: described)
    (ax,) = _panels.draw(told, None)
    (segments,) = [c.get_segments() for c in ax.collections if isinstance(c, LineCollection)]
    centre = np.array(trace["x"])
    low, high = (np.array(trace["error_x"][end]) for end in ("arrayminus", "array"))
    expected = np.column_stack([centre - low, centre + high])
    np.testing.assert_allclose([np.asarray(line)[:, 0] for line in segments], expected)


def test_words_stand_where_the_report_has_them(figures: dict[str, umbmark.Figure]) -> None:
    described = figures["return_errors"].to_plotly()
    place = {"xaxis": "x", "yaxis": "y", "name": "", "meta": {"tone": "quiet"}}
    words = {"mode": "text", "x": [1.0, 2.0], "y": [3.0, 4.0], "text": ["a &lt; b", "c"]}
    described["data"].append({"type": "scatter", **place, **words})
    told: Any = SimpleNamespace(kind="return_errors", to_plotly=lambda: described)
    (ax,) = _panels.draw(told, None)
    drawn = [(*text.get_position(), text.get_text()) for text in ax.texts]
    assert drawn == [(1.0, 3.0, "a < b"), (2.0, 4.0, "c")]


def test_figures_are_drawn_on_the_axes_that_are_given(learnt: umbmark.Learnt) -> None:
    figure, (left, right) = pyplot.subplots(1, 2)
    assert learnt.plot(left, kind="return_errors") == [left]
    assert len(left.lines) > 3
    assert learnt.plot([left, right], kind="tracks") == [left, right]
    rows = pyplot.subplots(3, 1)[1]
    assert learnt.plot(rows, kind="residuals_along") == [*rows]
    with pytest.raises(ValueError, match="tracks has 2 panels, ax has 1 axes"):
        learnt.plot(left, kind="tracks")
    with pytest.raises(TypeError, match="say kind="):
        learnt.plot([left, right])  # type: ignore[call-overload]
    assert learnt.plot(right) is right
    with pytest.raises(ValueError, match='there is no figure "pie"'):
        learnt.plot(kind="pie")
    assert len(figure.axes) == 2


def test_a_solution_shows_each_number_in_per_cent_of_the_old_one(learnt: umbmark.Learnt) -> None:
    solved = umbmark.solve(learnt.data, draws=99)
    ax = solved.plot()
    wheelbase = [*solved.correction].index("wheelbase_m")
    dots = [line for line in ax.lines if line.get_marker() == "o"]
    new = np.asarray(dots[wheelbase].get_xdata()).item()
    assert new == pytest.approx(1.0, abs=0.2)
    assert [label.get_text() for label in ax.get_yticklabels()][wheelbase] == "wheelbase"


def test_a_missing_effect_outside_the_catalogue_is_drawn_with_its_band() -> None:
    truth = TRUTH.add(
        "wave",
        acts_on="heading_per_metre",
        formula=lambda at, k: k * np.sin(3 * at.heading),
        parameters={"k": 0.02},
    )
    data = umbmark.simulate(truth, PATH, reference_rate_hz=5, seed=4)
    found = umbmark.diagnose(data, draws=99)
    unlisted = found.unlisted
    assert unlisted is not None
    assert isinstance(unlisted, umbmark.Unlisted)
    ax = unlisted.plot()
    points = [(point.at, point.value) for point in unlisted.curve.points]
    np.testing.assert_array_equal(ax.lines[0].get_xydata(), points)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("heading [rad]", "yaw [rad/m]")
    assert found.to_dict()["unlisted"]["depends_on"] == "heading"
    suggestion = unlisted.suggestion
    assert suggestion is not None
    assert suggestion.effect[-1]["name"] in found.model.add(suggestion).effects


def dots(ax: Axes) -> np.ndarray:
    """Give the places of the points that have intervals."""
    return np.array(
        [np.asarray(line.get_xydata())[0] for line in ax.lines if line.get_marker() == "o"]
    )


def test_what_changed_is_drawn_in_standard_errors() -> None:
    before = umbmark.simulate(TRUTH, PATH, reference_rate_hz=0, seed=7)
    after = umbmark.simulate(TRUTH.add("wheelbase", e_b=1.03), PATH, reference_rate_hz=0, seed=8)
    found = umbmark.changed(before, after, draws=99)
    rows = [*found.robot, *found.reference]
    ax = found.plot()
    assert [label.get_text() for label in ax.get_yticklabels()] == [row.key for row in rows]
    for (x, y), row in zip(dots(ax), rows, strict=True):
        error = np.hypot(row.before_standard_error, row.after_standard_error)
        change = np.log(row.change) if row.of == "scatter" else row.change
        assert (x, rows[int(y)].key) == (pytest.approx(change / error), row.key)
        # A 95 % interval of few runs holds zero where |t| is small, and does not where it is large.
        assert not (row.changed and abs(x) < 1.96)
    marked = [line.get_color() for line in ax.lines if line.get_marker() == "o"]
    assert marked == ["tab:red" if row.changed else "tab:blue" for row in rows]
    assert "tab:red" in marked


def test_numbers_under_conditions_are_drawn_by_their_p() -> None:
    tile = umbmark.simulate(TRUTH, PATH, reference_rate_hz=0, seed=1)
    felt = umbmark.simulate(TRUTH.add("wheelbase", e_b=1.03), PATH, reference_rate_hz=0, seed=2)
    cw, ccw = ([*tile.returns(way), *felt.returns(way)] for way in ("cw", "ccw"))
    data = umbmark.Dataset.from_arrays(cw, ccw, robot=tile.robot, path=PATH)
    found = umbmark.conditions(data.with_conditions(floor=(["tile"] * 5 + ["felt"] * 5) * 2))
    ax = found.plot()
    names = [label.get_text() for label in ax.get_yticklabels()]
    assert names == [f"{asked.key} by floor" for asked in found.asked]
    heights = [bar.get_width() for bar in ax.patches if isinstance(bar, Rectangle)]
    told = [min(6.0, -np.log10(asked.p_adjusted)) for asked in found.asked]
    np.testing.assert_allclose(heights, told)


def test_robots_of_a_kind_are_drawn_beside_each_other() -> None:
    draw = np.random.default_rng(1)
    cw = draw.normal([-0.20, -0.21, -0.05], 0.01, (60, 5, 3))
    ccw = draw.normal([0.01, 0.00, 0.01], 0.01, (60, 5, 3))
    cw[3] += (0.4, 0.4, 0.2)
    fleet = umbmark.fleet(cw, ccw, robot=umbmark.Model().robot, path=umbmark.Path.umbmark())
    few = umbmark.survey({name: fleet[name] for name in [*fleet][:12]}, diagnosis=False)
    ax = few.plot()
    assert ax.get_xlabel() == "wheel_diameter_ratio.e_d"
    assert [label.get_text() for label in ax.get_yticklabels()] == [*fleet][:12]
    np.testing.assert_array_equal(dots(ax)[:, 0], [one.fitted[0].value for one in few.robots])
    marked = [line.get_color() for line in ax.lines if line.get_marker() == "o"]
    key = "wheel_diameter_ratio.e_d"
    apart = [key in {one.key for one in robot.stands_out} for robot in few.robots]
    assert marked == ["tab:red" if out else "tab:blue" for out in apart]
    assert few.plot(number="wheelbase.e_b").get_xlabel() == "wheelbase.e_b"
    with pytest.raises(ValueError, match=r'no number "e_b"; there are wheel_diameter_ratio\.e_d, '):
        few.plot(number="e_b")
    many = umbmark.survey(fleet, diagnosis=False).plot()
    assert sum(bar.get_height() for bar in many.patches[:40] if isinstance(bar, Rectangle)) == 60


def test_a_robot_under_watch_is_drawn_run_by_run_beside_the_limits() -> None:
    draw = np.random.default_rng(3)
    cw, ccw = (draw.normal(0.0, (0.02, 0.02, 0.01), (15, 3)) for _ in range(2))
    robot, path = umbmark.Robot.labmate(), umbmark.Path.square(4.0)
    found = umbmark.watch(umbmark.Dataset.from_arrays(cw, ccw, robot=robot, path=path))
    ax = found.plot()
    assert ax.get_title() == "no change"
    numbers, limit = (np.asarray(line.get_ydata(), float) for line in ax.lines[:2])
    told = np.array([run.numbers for run in found.runs], float)
    np.testing.assert_array_equal(numbers, told)
    compared = np.isfinite(numbers)
    assert compared.any()
    assert (numbers[compared] <= limit[compared]).all()


@pytest.mark.parametrize(
    ("package", "call", "extra"),
    [
        ("matplotlib", lambda learnt: learnt.plot(), "plot"),
        ("matplotlib", lambda learnt: learnt.plot(kind="tracks"), "plot"),
        ("pyarrow", lambda learnt: learnt.to_arrow(), "frames"),
        ("pyarrow", lambda learnt: learnt.tracks().to_arrow(), "frames"),
        ("polars", lambda learnt: learnt.to_polars(), "frames"),
        ("xarray", lambda _: umbmark.monte_carlo(TRUTH, n=3, keep=True).to_xarray(), "frames"),
        ("tqdm", lambda _: umbmark.monte_carlo(TRUTH, n=3, progress=True), "progress"),
    ],
)
def test_a_package_that_is_missing_is_named_with_what_installs_it(
    package: str,
    call: Callable[[umbmark.Learnt], object],
    extra: str,
    learnt: umbmark.Learnt,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    without(monkeypatch, package)
    words = rf'{package}.* is not installed: pip install "umbmark\[{extra}\]"'
    with pytest.raises(umbmark.MissingDependencyError, match=words):
        call(learnt)
    with pytest.raises(ImportError):
        call(learnt)
