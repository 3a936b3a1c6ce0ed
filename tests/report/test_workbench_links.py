"""What the workbench links: places of runs in drive and figures, held numbers and fitted ones."""

import json
from pathlib import Path
from typing import Any

import pytest
from conftest import Server, umbmark
from selenium import webdriver
from selenium.webdriver.common.keys import Keys
from test_page import complaints
from workbench import Page


def middle(figure: dict[str, Any], trace: int, run: int) -> int:
    """The place in the middle of a run in a trace."""
    runs = figure["plot"]["data"][trace]["customdata"]
    own = [i for i, of in enumerate(runs) if of == run and figure["rolled"][trace][i] is not None]
    return own[len(own) // 2]


def test_a_place_that_is_chosen_in_a_figure_is_marked_in_the_drive_and_in_every_other_figure(
    browser: webdriver.Chrome, tracked: Server
) -> None:
    page = Page(browser, tracked)
    along, tracks = page.show("residuals_along", "tracks")
    run = along["plot"]["data"][0]["customdata"][0]
    name, place = along["runs"][run], middle(along, 0, run)
    rolled = along["rolled"][0][place]
    page.mouse(".plot", *page.at(0, 0, place), click=True)
    page.wait("return document.getElementById('marked').textContent.startsWith('Chosen')")
    assert page.text("marked").startswith(f"Chosen: {name}, ")
    # Forward, to the left and heading; computed, modelled and measured.
    for card, figure in enumerate([along, tracks]):
        rings = page.rings(card)
        assert len(rings) == 3
        for trace, ring in rings:
            assert figure["plot"]["data"][trace]["customdata"][ring] == run
            near = [
                r
                for r, of in zip(
                    figure["rolled"][trace],
                    figure["plot"]["data"][trace]["customdata"],
                    strict=True,
                )
                if of == run and r is not None
            ]
            least = min(abs(own - rolled) for own in near)
            assert abs(figure["rolled"][trace][ring] - rolled) == pytest.approx(least)
            assert least < 0.1
    # The drive shows the same place, and a ring is where the place is drawn.
    x, y = page.at(0, 0, place)
    shown = page.run("const r = document.querySelector('.ring').style; return [r.left, r.top]")
    assert [float(end.removesuffix("px")) for end in shown] == pytest.approx([x, y], abs=0.1)
    page.mouse("#marked", 2, 2)
    page.click("tab-work")
    page.wait("return document.getElementById('drive-says').textContent.includes('chosen')")
    words = page.text("drive-says")
    assert words.startswith(f"{name}, ")
    assert abs(float(words.split(", ")[-1].split(" m:")[0]) - rolled) < 0.1
    page.press(Keys.ESCAPE)
    page.wait("return !document.getElementById('drive-says').textContent.includes('chosen')")
    page.click("tab-figures")
    assert page.rings(0) == page.rings(1) == []
    assert complaints(browser) == []


def test_a_place_of_the_strip_is_chosen_by_mouse_and_keys_and_marked_in_the_figures(
    browser: webdriver.Chrome, tracked: Server
) -> None:
    page = Page(browser, tracked)
    along, _ = page.show("residuals_along", "tracks")
    page.click("tab-work")
    page.mouse("#strip", 200, 60)
    says = "return document.getElementById('drive-says').textContent"
    page.wait(says + ".startsWith('c')")
    page.mouse("#strip", 200, 60, click=True)
    first = page.wait(says + ".includes('chosen') && " + says[7:])
    # The same place again clears it.
    page.mouse("#strip", 200, 60, click=True)
    page.wait(says + ".includes('chosen') === false")
    page.mouse("#strip", 200, 60, click=True)
    page.wait(says + ".includes('chosen')")
    page.mouse("#place", 1, 1)
    page.run("document.getElementById('strip').focus()")
    page.press(Keys.ARROW_RIGHT)
    second = page.wait(says + f" !== {first!r} && " + says[7:])
    assert second.split(", ")[0] == first.split(", ")[0]
    assert page.run("return document.getElementById('strip').ariaValueText") == second
    seconds = [float(words.split(", ")[1].removesuffix(" s")) for words in [first, second]]
    assert 0.0 < seconds[1] - seconds[0] < 1.5
    page.press(Keys.END)
    page.wait(says + ".includes('79.7 s')")
    page.press(Keys.ARROW_UP if "ccw" in first else Keys.ARROW_DOWN)
    page.wait(f"return !({says[7:]}).startsWith({first.split(', ')[0]!r})")
    name = page.text("drive-says").split(", ")[0]
    page.click("tab-figures")
    page.wait("return document.querySelectorAll('.ring').length === 6")
    run = along["runs"].index(name)
    for trace, place in page.rings(0):
        data = along["plot"]["data"][trace]
        assert data["customdata"][place] == run
        ends = [
            i for i, of in enumerate(data["customdata"]) if of == run and data["y"][i] is not None
        ]
        assert place == ends[-1]
    assert complaints(browser) == []


def test_a_bar_of_the_strip_marks_the_run_and_a_place_of_the_plan_its_end(
    browser: webdriver.Chrome, slope: Server
) -> None:
    page = Page(browser, slope)
    (returns,) = page.show("return_errors")
    page.click("tab-work")
    wide = page.run("return document.getElementById('strip').clientWidth")
    page.mouse("#strip", wide - 30, 60, click=True)
    says = "return document.getElementById('drive-says').textContent"
    page.wait(says + ".includes('chosen')")
    name = page.text("drive-says").split(", ")[0]
    assert name == returns["runs"][-1]
    page.mouse("#place", 1, 1)
    page.click("tab-figures")
    sizes = """const traces = document.querySelector(".plot").data.filter((t) => t.customdata);
    return traces.flatMap((t) => t.customdata.map((run, i) =>
      [run, Array.isArray(t.marker.size) ? t.marker.size[i] : t.marker.size]));"""
    large = page.wait(f"const s = (() => {{ {sizes} }})(); return s.some((o) => o[1] > 9) && s")
    assert [run for run, size in large if size > 9] == [returns["runs"].index(name)]
    # A figure of ends of runs marks the end in the drive.
    other = next(i for i, t in enumerate(returns["plot"]["data"]) if "customdata" in t)
    run = returns["plot"]["data"][other]["customdata"][0]
    page.mouse(".plot", *page.at(0, other, 0), click=True)
    page.click("tab-work")
    page.wait(says + f".startsWith({returns['runs'][run]!r})")


def test_a_figure_follows_one_that_cannot_be_drawn(
    browser: webdriver.Chrome, tracked: Server
) -> None:
    page = Page(browser, tracked)
    page.show("tracks")
    page.put("figure-0", "conditions")
    first = "return document.querySelector('.frame .plot')"
    page.wait(f"{first}.ariaLabel === 'No figure' && !{first[7:]}.children.length")
    page.show("residuals_along")
    page.wait(f"{first}.querySelectorAll('.xy, .x2y2, .x3y3').length >= 3")
    assert page.run(f"{first}.ariaLabel").startswith("Residuals along the way")
    # Residuals can be drawn against whatever is tested.
    script = "return [...document.getElementById('figure-0').options].map((o) => o.value)"
    offered = page.run(script)
    for covariate in ["speed", "time", "acceleration", "heading", "last_turn", "run"]:
        assert f"residuals_by_{covariate}" in offered


def test_a_number_is_held_where_its_slider_is_released_and_the_others_fitted_as_the_command_does(
    browser: webdriver.Chrome, slope: Server, tmp_path: Path
) -> None:
    page = Page(browser, slope)
    page.click("first")
    page.wait("return document.getElementById('draft')")
    (tmp_path / "before.toml").write_text(page.fetch("api/model.toml"))
    release = """const e = document.getElementById('r-wheelbase-e_b');
    e.value = arguments[0];
    for (const name of ['input', 'change']) e.dispatchEvent(new Event(name));
    return document.getElementById('n-wheelbase-e_b').value;"""
    value = page.run(release, 1.02)
    words = "return (document.getElementById('draft')?.textContent ?? '')"
    page.wait(words + f".includes('e_b of wheelbase held at {value} fitted')")
    fix = ["--fix", f"wheelbase.e_b={value}"]
    model, before = tmp_path / "after.toml", tmp_path / "before.toml"
    told = json.loads(
        umbmark("fit", tmp_path / "slope", "--model", before, *fix, "-o", model, "--json")
    )
    assert page.fetch("api/model.toml") == model.read_text()
    assert f"fitted runs: {1e3 * told['rmse_m']:.1f} mm" in page.text("error")
    # The next slider holds its own number, and the one before is free again.
    page.run(release.replace("wheelbase-e_b", "wheel_diameter_ratio-e_d"), 1.001)
    page.wait(words + ".includes('e_d of wheel_diameter_ratio held at')")
    assert "e_b of wheelbase held" not in page.text("draft")
    assert not page.run("return document.getElementById('n-wheelbase-e_b').value") == value
    page.click("fit")
    page.wait("return !document.getElementById('draft').textContent.includes('held')")
    best = tmp_path / "best.toml"
    umbmark("fit", tmp_path / "slope", "-o", best)
    kept = [line for line in page.fetch("api/model.toml").splitlines() if line.startswith("fixed")]
    assert (
        kept == [line for line in best.read_text().splitlines() if line.startswith("fixed")] == []
    )
    page.click("undo")
    page.accepted(1)
    assert "nothing is added" in page.text("parts")


def test_a_number_that_the_user_holds_keeps_its_value_in_fits(
    browser: webdriver.Chrome, slope: Server
) -> None:
    page = Page(browser, slope)
    page.put("effect", "carpet_nap")
    page.click("add")
    page.wait("return document.getElementById('n-carpet_nap-drift_x')")
    page.click("fit-others")
    page.put("n-carpet_nap-drift_x", "0.001")
    value = "return document.getElementById('n-carpet_nap-drift_x').value"
    words = "return (document.getElementById('draft')?.textContent ?? '')"
    page.wait(f"{value} === '0.001' && ({words[7:]}).includes('not fitted')")
    page.click("h-carpet_nap-drift_x")
    page.wait(words + ".includes('drift_x of carpet_nap held at 0.001')")
    page.click("fit")
    page.wait("return document.getElementById('accept').className === 'main'")
    assert page.run(value) == "0.001"
    other = page.run("return document.getElementById('n-carpet_nap-drift_y').value")
    assert float(other) != 0.0
    # No other number is free: the slider sets its own and nothing is fitted.
    page.click("fit-others")
    page.put("r-carpet_nap-drift_y", "0.002")
    page.wait(words + ".includes('not fitted')")
    assert page.run("return document.getElementById('h-carpet_nap-drift_x').checked")
    page.click("h-carpet_nap-drift_x")
    page.wait(words + ".includes('drift_x of carpet_nap to be fitted')")
    page.click("fit")
    page.wait("return document.getElementById('accept').className === 'main'")
    assert page.run(value) != "0.001"


def test_a_slider_moved_by_keys_keeps_the_focus(browser: webdriver.Chrome, slope: Server) -> None:
    page = Page(browser, slope)
    page.click("first")
    page.wait("return document.getElementById('r-wheelbase-e_b')")
    page.run("document.getElementById('r-wheelbase-e_b').focus()")
    page.press(*[Keys.ARROW_RIGHT] * 5)
    words = "return (document.getElementById('draft')?.textContent ?? '')"
    page.wait(words + ".includes('held at')")
    page.wait("return !document.getElementById('fit').disabled")
    assert page.run("return document.activeElement.id") == "r-wheelbase-e_b"
