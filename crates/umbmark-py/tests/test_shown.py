"""What notebooks show: numbers in the unit that stands beside them, and a small figure."""

import base64
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import umbmark
from matplotlib import pyplot

PATH = umbmark.Path(side_m=1.0)
MODEL = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=3e-4)


@pytest.fixture(scope="module")
def data() -> umbmark.Dataset:
    """Return a robot by its return poses."""
    return umbmark.simulate(MODEL, PATH, runs=4, reference_rate_hz=0)


def rows(result: Any) -> list[dict[str, str]]:
    """Return the cells of the table that a notebook shows, by the titles of their columns."""
    page = result._repr_html_().split("</table>")[0]
    titles = re.findall("<th>(.*?)</th>", page)
    cells = [re.findall("<td>(.*?)</td>", row) for row in re.findall("<tr>(.*?)</tr>", page)[1:]]
    return [dict(zip(titles, row, strict=True)) for row in cells]


def test_a_probability_stays_one_beside_lengths_and_angles(data: umbmark.Dataset) -> None:
    found = umbmark.compare(data, {"nominal": umbmark.Model()}, draws=99)
    shown = rows(found)
    assert shown[2]["quantity"] == "mean heading [deg]"
    for row, of in zip(shown, found.table(), strict=True):
        scale = {"_m": 1e3, "ad": np.degrees(1.0)}.get(of["quantity"][-2:], 1.0)
        assert float(row["p"]) == pytest.approx(of["p"])
        assert float(row["measured"]) == pytest.approx(scale * of["measured"], rel=1e-4)
        assert float(row["predicted"]) == pytest.approx(scale * of["predicted"], rel=1e-4)


def test_what_is_swept_stays_what_it_is_beside_millimetres() -> None:
    found = umbmark.sweep(MODEL, {"eb": (0.99, 1.01, 3)}, PATH, n=20)
    for row, of in zip(rows(found), found.table(), strict=True):
        assert float(row["eb"]) == of["eb"]
        scale = np.degrees(1.0) if "[deg]" in row["metric"] else 1e3
        assert float(row["mean"]) == pytest.approx(scale * of["mean"], rel=1e-4)
        assert float(row["q0.95"]) == pytest.approx(scale * of["q0.95"], rel=1e-4)


def test_an_index_of_sensitivity_is_no_length() -> None:
    varied = [{"name": "eb", "mean": 1, "sd": 0.01}]
    found = umbmark.sensitivity(MODEL, PATH, parameters=varied, effort=64)
    for row, of in zip(rows(found), found.table(), strict=True):
        assert row["metric"] == of["metric"]
        assert float(row["value"]) == pytest.approx(of["value"], rel=1e-5)


def test_values_and_intervals_of_a_fit_have_one_unit_and_the_digits_of_a_ratio() -> None:
    watched = umbmark.simulate(MODEL, PATH, runs=3, reference_rate_hz=5)
    model = umbmark.Model().add("wheelbase", free=True).add("marker_offset", free=True)
    found = umbmark.fit(watched, model)
    assert {estimate.parameter for estimate in found.fitted} >= {"e_b", "forward_m"}
    for row, of in zip(rows(found), found.table(), strict=True):
        scale = 1e3 if of["parameter"].endswith("_m") else 1.0
        assert row["parameter"].endswith("[mm]") == (scale == 1e3)
        low, high = (float(end) for end in row["interval"].strip("()").split(", "))
        told = (float(row["value"]), float(row["standard error"]), low, high)
        exact = (of["value"], of["standard_error"], *of["interval"])
        np.testing.assert_allclose(told, scale * np.array(exact), rtol=1e-4)
        if scale == 1.0:
            assert abs(told[0] - exact[0]) <= 5e-6


RESULTS: dict[str, Callable[[umbmark.Dataset], Any]] = {
    "score": umbmark.score,
    "calibrate": umbmark.calibrate,
    "compare": lambda data: umbmark.compare(data, draws=99),
    "diagnose": lambda data: umbmark.diagnose(data, draws=99),
    "fit": umbmark.fit,
    "learn": lambda data: umbmark.learn(data, draws=99),
    "solve": lambda data: umbmark.solve(data, draws=99),
    "inspect": umbmark.inspect,
    "monte_carlo": lambda _: umbmark.monte_carlo(MODEL, PATH, n=50),
    "changed": lambda data: umbmark.changed(data, data, draws=99),
    "conditions": lambda data: umbmark.conditions(
        data.with_conditions(floor=["tile", "felt"] * (len(data) // 2))
    ),
    "survey": lambda data: umbmark.survey({"a": data, "b": data}, diagnosis=False),
    "watch": umbmark.watch,
    "plan": lambda _: umbmark.plan(see={"eb": 1.005}, draws=99, numbers=[5]),
}


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_is_shown_with_a_small_figure(name: str, data: umbmark.Dataset) -> None:
    result = RESULTS[name](data)
    page = result._repr_html_()
    images = re.findall('<img alt="(.*?)" src="data:image/svg.xml;base64,(.*?)">', page)
    [(alternative, drawn)] = images
    assert alternative == type(result).__name__
    assert b"<svg" in base64.b64decode(drawn)
    assert result._repr_html_() == page
    assert pyplot.get_fignums() == []


def test_tracks_are_shown_by_the_residuals_of_each_run() -> None:
    tracks = umbmark.tracks(umbmark.simulate(MODEL, PATH, runs=2, reference_rate_hz=2))
    shown = rows(tracks)
    assert [row["run"] for row in shown] == [track.run for track in tracks]
    for row, track in zip(shown, tracks, strict=True):
        rms = np.sqrt(np.mean(track.residual**2, axis=0))
        assert float(row["rms [mm]"]) == pytest.approx(1e3 * np.hypot(*rms[:2]), rel=1e-4)
        assert float(row["rms [deg]"]) == pytest.approx(np.degrees(rms[2]), rel=1e-4)


def test_many_robots_are_shown_in_one_table_in_the_units_of_each(data: umbmark.Dataset) -> None:
    """The names of robots, which are a user's, are neither units nor HTML."""
    robots: dict[str, umbmark.Dataset | str] = {
        "sigma_m": data,
        "<b>": data,
        "lost": "there is no such place",
    }
    found = umbmark.each(umbmark.score, robots)
    page = found._repr_html_()
    assert "there is no such place" in page
    assert "<b>" not in page
    shown, alone = rows(found), rows(found["sigma_m"])
    assert [row.pop("robot") for row in shown[: len(alone)]] == ["sigma_m"] * len(alone)
    assert shown[: len(alone)] == alone


def test_without_matplotlib_and_where_nothing_can_be_drawn_there_is_no_figure(
    data: umbmark.Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    axes = {name: (1.0, 1.01, 2) for name in ("ed", "eb", "es")}
    swept = umbmark.sweep(MODEL, axes, PATH, n=5)
    assert "<img" not in swept._repr_html_()
    assert "<table>" in swept._repr_html_()
    monkeypatch.setattr("umbmark._small.find_spec", lambda _: None)
    assert "<img" not in umbmark.score(data)._repr_html_()
