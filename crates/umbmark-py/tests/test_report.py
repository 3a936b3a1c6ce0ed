"""Figures and reports: those of the command, in hand and in files."""

import json
import pickle
import subprocess
from collections.abc import Callable
from html import unescape
from pathlib import Path
from typing import Any

import plotly.graph_objects as go
import pytest
import umbmark

TRUTH = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=3e-4)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a robot by its return poses, in files."""
    place = tmp_path_factory.mktemp("data") / "robot"
    umbmark.simulate(TRUTH, umbmark.Path(side_m=1.0), runs=4, reference_rate_hz=0).save(place)
    return place


@pytest.fixture(scope="module")
def figure(folder: Path) -> umbmark.Figure:
    """Return the paper's Fig. 5 of it."""
    return umbmark.plot("return_errors", folder, draws=99)


def run(command: Path, *words: str | Path) -> Any:
    told = subprocess.run([command, *words, "--json"], check=True, capture_output=True, text=True)
    return json.loads(told.stdout)


@pytest.mark.parametrize("kind", ["return_errors", "learning", "monte_carlo"])
def test_a_figure_has_the_bytes_of_the_command(
    kind: str, command: Path, folder: Path, tmp_path: Path
) -> None:
    figure = umbmark.plot(kind, folder, n=200, draws=99)
    for ending in ("svg", "png", "pdf", "json"):
        theirs, ours = tmp_path / f"theirs.{ending}", tmp_path / f"ours.{ending}"
        told = run(
            command, "plot", kind, folder, "-o", theirs, "-n", "200", "--draws", "99",
            "--width", "100", "--dpi", "90",
        )  # fmt: skip
        figure.save(ours, width_mm=100, dpi=90)
        assert ours.read_bytes() == theirs.read_bytes(), ending
        expected = {"shows": figure.shows, "good": figure.good, "says": figure.says}
        assert told["told"] == expected
        assert [list(row.values()) for row in figure.table()] == told["table"]["rows"]


def test_every_kind_is_drawn_or_says_why_not(folder: Path) -> None:
    drawn = []
    for kind, about in umbmark.figures().items():
        assert about
        try:
            drawn.append(umbmark.plot(kind, folder, TRUTH, draws=99, n=100).kind)
        except ValueError:
            continue
    assert {"return_errors", "circle", "tracks", "monte_carlo"} <= {*drawn}
    with pytest.raises(ValueError, match=r"residuals_along cannot be drawn from .*robot: The runs"):
        umbmark.plot("residuals_along", folder, TRUTH)


def test_a_figure_is_shown_by_notebooks_and_by_plotly_and_can_be_pickled(
    figure: umbmark.Figure,
) -> None:
    assert figure._repr_svg_().startswith("<svg")
    assert repr(figure).startswith("Figure(return_errors: ")
    assert len(go.Figure(figure.to_plotly()).data) > 3
    assert figure.to_png(dpi=50)[:4] == b"\x89PNG"
    assert figure.to_pdf()[:5] == b"%PDF-"
    copy = pickle.loads(pickle.dumps(figure))
    assert copy == figure
    assert copy.to_svg(width_mm=60) == figure.to_svg(width_mm=60) != figure.to_svg()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda f, _: f.save("a.gif"), "a figure is written as NAME.svg, NAME.png, NAME.pdf"),
        (lambda f, _: f.to_svg(width_mm=4), "width_mm must be from 40 to 400, got 4"),
        (lambda f, _: f.to_png(dpi=1), "dpi must be from 30 to 1200, got 1"),
        (lambda _, d: umbmark.plot("pie", d), 'there is no figure "pie"; there are return_errors'),
        (lambda _, d: umbmark.plot("circle", d, n=5), "n must be 100 or more, got 5"),
        (lambda _, d: umbmark.report({}), "one study stands on a page, or two .* got 0"),
        (
            lambda _, d: umbmark.report({"a": d, "b": d}, {"a": TRUTH, "b": TRUTH, "c": TRUTH}),
            "3 models and 2 datasets do not go together",
        ),
    ],
)
def test_what_cannot_be_drawn_is_a_value_error(
    call: Callable[[umbmark.Figure, Path], object], words: str, figure: umbmark.Figure, folder: Path
) -> None:
    with pytest.raises(ValueError, match=words):
        call(figure, folder)


def test_a_file_that_is_there_is_kept_unless_it_may_be_replaced(
    figure: umbmark.Figure, tmp_path: Path
) -> None:
    file = tmp_path / "figure.svg"
    file.write_text("mine")
    with pytest.raises(ValueError, match="exists already; replace=True replaces it"):
        figure.save(file)
    assert file.read_text() == "mine"
    figure.save(file, replace=True)
    assert file.read_text() == figure.to_svg()


def test_a_report_is_the_page_of_the_command(command: Path, folder: Path, tmp_path: Path) -> None:
    page = umbmark.report(folder, n=200, draws=99)
    theirs = tmp_path / "report.html"
    words = ("report", folder, "-o", theirs, "-n", "200", "--draws", "99")
    told = run(command, *words)
    assert [study["verdict"] for study in told["studies"]] == [page.studies[0].verdict]
    assert page.studies[0].name == "robot"
    # All but the line that says how it was asked for.
    ours = [line for line in page.html.splitlines() if "umbmark.report(" not in line]
    lines = theirs.read_text().splitlines()
    differing = [line for line in lines if line not in set(ours)]
    assert len(differing) == 1
    assert "umbmark report " in differing[0]
    assert f"umbmark.report({str(folder)!r}, seed=1)" in unescape(page.html)
    page.save(tmp_path / "ours.html")
    assert (tmp_path / "ours.html").read_text() == page.html
    assert page._repr_html_().startswith("<iframe srcdoc=")
    assert page.table() == [{"name": "robot", "verdict": page.studies[0].verdict}]
    assert pickle.loads(pickle.dumps(page)) == page
    assert len(page.html.encode()) == page.bytes


def test_two_studies_stand_side_by_side(folder: Path) -> None:
    heard: list[int] = []
    data = umbmark.load_dataset(folder)
    how: dict[str, Any] = {"n": 100, "draws": 99}
    page = umbmark.report({"before": data, "after": folder}, TRUTH, **how)
    assert [study.name for study in page.studies] == ["before", "after"]
    page = umbmark.report(data, {"nominal": umbmark.Model(), "true": TRUTH}, **how)
    assert [study.name for study in page.studies] == ["nominal", "true"]
    assert page.studies[0].verdict != page.studies[1].verdict
    umbmark.report(data, progress=lambda done, _: heard.append(done), **how)
    assert heard == sorted(heard)


def test_files_to_fill_in_are_those_of_the_command(command: Path, tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    written = umbmark.init(ours)
    run(command, "init", theirs)
    assert [file.name for file in written] == ["robot.toml", "returns.csv"]
    for file in written:
        assert file.read_bytes() == (theirs / file.name).read_bytes()
    with pytest.raises(ValueError, match="replace=True"):
        umbmark.init(ours)
    umbmark.init(ours, replace=True)


def test_a_robot_proposed_from_logs_is_that_of_the_command(command: Path, tmp_path: Path) -> None:
    umbmark.simulate(umbmark.Model().add("wheelbase", e_b=1.01)).save(tmp_path / "made")
    yaml = tmp_path / "controller.yaml"
    yaml.write_text("base:\n  wheel_separation: 0.34\n  wheel_radius: 0.075\n")
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    ours, theirs = tmp_path / "a" / "mine", tmp_path / "b" / "mine"
    [written] = umbmark.init(ours, logs=tmp_path / "made", controller_yaml=yaml)
    run(command, "init", theirs, "--logs", tmp_path / "made", "--controller-yaml", yaml)
    assert written == ours / "robot.toml"
    assert written.read_bytes() == (theirs / "robot.toml").read_bytes()
    assert len(list((ours / "runs").iterdir())) == len(list((theirs / "runs").iterdir())) > 0
    with pytest.raises(ValueError, match=r"FILL IN|fill in"):
        umbmark.load_dataset(ours)
    with pytest.raises(ValueError, match="need logs"):
        umbmark.init(tmp_path / "c", urdf=yaml)
