"""The workbench as its user meets it: tour, bad files, killed server, two pages, who is asked."""

import json
import shutil
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from conftest import DATA, OPTIONS, ROOT, Server, umbmark
from selenium import webdriver
from test_page import complaints, look, prefer
from workbench import Page

HIDDEN = ROOT / "examples/hidden"
AXE = "axe_selenium_python/node_modules/axe-core/axe.min.js"
#: What axe is asked for: the rules of WCAG 2, A and AA.
RULES = {"runOnly": ["wcag2a", "wcag2aa"]}


def folder_of(data: Path) -> dict[str, bytes]:
    """The files of a dataset, as a folder that is dropped has them."""
    files = [file for file in sorted(data.rglob("*")) if file.is_file()]
    seen = [file for file in files if not file.name.startswith(".")]
    return {str(file.relative_to(data.parent)): file.read_bytes() for file in seen}


def held_out(steps: list[dict[str, Any]]) -> list[str]:
    return [f"{1e3 * step['heldout_rmse_m']:.1f} mm" for step in steps]


def test_the_tour_finds_the_hidden_effect_and_the_error_falls_to_what_learn_says(
    browser: webdriver.Chrome, server: Server
) -> None:
    learnt = json.loads(umbmark("learn", HIDDEN, "--json"))
    page = Page(browser, server)
    page.drop(folder_of(HIDDEN))
    page.wait("return document.querySelectorAll('#story button').length === 1")
    assert page.text("place").endswith("hidden")
    page.click("first")
    page.wait("return document.getElementById('draft')")
    page.click("fit")
    page.wait("return document.getElementById('accept').className === 'main'")
    assert "falls from 49.8 mm" in page.text("falls")
    page.click("accept")
    page.accepted(2)
    page.click("diagnose")
    script = "return document.querySelector('.suggestion strong')?.textContent"
    assert page.wait(script) == learnt["steps"][-1]["added"] == "floor_slope_yaw"
    page.run("document.querySelector('.suggestion button').click()")
    page.wait("return document.getElementById('draft')")
    page.click("fit")
    page.wait("return document.getElementById('accept').className === 'main'")
    page.click("accept")
    page.accepted(3)
    assert page.story()[-1] == held_out(learnt["steps"])[-1] == "5.8 mm"
    page.click("learn")
    page.wait("return document.querySelectorAll('#reached li').length > 1")
    page.wait("return document.querySelectorAll('#story button').length === 5")
    assert page.story() == held_out(learnt["steps"])
    # A step to go back to, and the way forward again.
    page.run("document.querySelector('[data-step=\"1\"]').click()")
    page.wait("return document.querySelector('[aria-current=step]').dataset.step === '1'")
    assert "wheel_diameter_ratio" in page.text("parts")
    assert "floor" not in page.text("parts")
    assert complaints(browser) == []


def test_the_curve_and_the_error_follow_a_slider_and_undo_takes_it_back(
    browser: webdriver.Chrome, slope: Server
) -> None:
    page = Page(browser, slope)
    page.click("first")
    page.wait("return document.getElementById('n-wheelbase-e_b')")
    nominal = page.story()[-1]
    drag = """const e = document.querySelector('[data-part=wheelbase] input[type=range]');
    e.value = e.max; e.dispatchEvent(new Event('input'));"""
    page.run(drag)
    says = "return document.getElementById('error').textContent"
    page.wait(says + f".includes('with these values') && !({says[7:]}).includes({nominal!r})")
    assert page.story()[-1] == nominal
    page.run(drag.replace("'input'", "'change'"))
    page.wait(f"return document.querySelector('#draft .value').textContent !== {nominal!r}")
    page.click("undo")
    page.accepted(1)
    assert "nothing is added" in page.text("parts")


def test_a_formula_is_checked_as_it_is_typed(browser: webdriver.Chrome, slope: Server) -> None:
    page = Page(browser, slope)
    page.run("document.getElementById('own-law').open = true")
    page.put("law-text", "k * sin(speed)")
    says = "return document.getElementById('law-says').textContent"
    page.wait(says + ".includes('sin takes a plain number')")
    assert page.run("return document.getElementById('law-add').disabled")
    page.put("law-text", "k * sin(heading)")
    page.wait(says + ".includes('units agree')")
    page.click("law-add")
    page.wait("return document.querySelector('[data-part=my_law]')")
    assert "heading_per_metre = k * sin(heading)" in page.text("parts")


def test_bad_files_are_refused_with_their_line_and_the_work_is_kept(
    browser: webdriver.Chrome, slope: Server
) -> None:
    page = Page(browser, slope)
    page.click("first")
    page.wait("return document.getElementById('draft')")
    files = folder_of(DATA / "slope")
    broken = {name: text.replace(b"ccw,1,", b"ccw,one,") for name, text in files.items()}
    for bad, why in [({"noise.csv": b"\xff\xfe\x00"}, "noise.csv"), (broken, "returns.csv:")]:
        page.drop(bad)
        page.wait("return document.getElementById('alert').textContent.includes(arguments[0])", why)
    page.wait("return document.getElementById('draft')")


def test_typed_returns_show_each_mistake_at_its_cell(
    browser: webdriver.Chrome, server: Server
) -> None:
    page = Page(browser, server)
    page.run("document.getElementById('typed').open = true")
    fill = """document.querySelectorAll('#returns tbody tr').forEach((row, i) => {
      const [x, y, heading] = row.querySelectorAll('input');
      x.value = i < 5 ? -10 - i : 20 + i;
      y.value = i < 5 ? 30 + 2 * i : -25 - i;
      heading.value = '0.' + i; });
    const fourth = document.querySelectorAll('#returns tbody tr')[3];
    const [x, y] = fourth.querySelectorAll('input');
    x.value = 'far'; y.value = '';"""
    page.run(fill)
    page.click("open-typed")
    script = "return [...document.querySelectorAll('.mistake')].map((e) => e.textContent)"
    page.wait(script + ".length === 2")
    assert page.run(script) == ['"far" is no number', "a number is missing"]
    label = page.run("return document.activeElement.getAttribute('aria-label')")
    assert label == "x in mm of return 4"
    mend = """const fourth = document.querySelectorAll('#returns tbody tr')[3];
    const [x, y] = fourth.querySelectorAll('input');
    x.value = '-13,5'; y.value = '36';"""
    page.run(mend)
    page.click("open-typed")
    page.wait("return document.querySelectorAll('#story button').length === 1")
    assert page.text("place").endswith("typed returns")


def test_two_pages_show_the_same_work(browser: webdriver.Chrome, slope: Server) -> None:
    first = Page(browser, slope)
    one = browser.current_window_handle
    browser.switch_to.new_window("tab")
    try:
        second = Page(browser, slope)
        second.click("first")
        second.wait("return document.getElementById('draft')")
    finally:
        browser.close()
        browser.switch_to.window(one)
    first.wait("return document.getElementById('draft')", seconds=5)
    assert "wheelbase" in first.text("parts")


def test_a_killed_server_is_noticed_and_the_next_one_has_the_work(
    browser: webdriver.Chrome, slope: Server, tmp_path: Path
) -> None:
    page = Page(browser, slope)
    page.click("first")
    page.wait("return document.getElementById('draft')")
    page.click("accept")
    page.accepted(2)
    story = page.story()
    slope.kill()
    says = "return document.getElementById('alert').textContent"
    page.wait(says + ".includes('does not answer')", seconds=5)
    assert ".workbench.json" in page.text("alert")
    following = Server("slope", folder=tmp_path)
    try:
        again = Page(browser, following)
        again.accepted(2)
        assert again.story() == story
    finally:
        following.kill()


def test_no_request_leaves_this_machine(slope: Server) -> None:
    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not chromium or not driver:
        pytest.skip("chromium and chromium-driver are not installed")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    options.set_capability("goog:loggingPrefs", {"performance": "ALL", "browser": "ALL"})
    for option in OPTIONS:
        options.add_argument(option)
    service = webdriver.ChromeService(driver)
    with webdriver.Chrome(options=options, service=service) as window:
        page = Page(window, slope)
        for part in ["data", "figures", "away", "cloud", "work"]:
            page.click(f"tab-{part}")
            page.wait(f"return !document.getElementById('part-{part}').hidden")
        page.click("tab-figures")
        page.wait("return document.querySelectorAll('.plot .main-svg').length > 2")
        log: list[Any] = window.get_log("performance")  # type: ignore[no-untyped-call]
    events = [json.loads(entry["message"])["message"] for entry in log]
    asked = [
        e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"
    ]
    assert len(asked) > 15
    far = [url for url in asked if urlsplit(url).scheme not in ("data", "blob")]
    assert {urlsplit(url).hostname for url in far} == {"127.0.0.1"}
    assert all(url.startswith(slope.address) for url in far)


def test_a_robot_of_the_paper_is_drawn_with_its_numbers_beside_what_was_published(
    browser: webdriver.Chrome, slope: Server
) -> None:
    page = Page(browser, slope)
    page.click("tab-cloud")
    page.wait("return document.getElementById('cloud').dataset.n === '10000'")
    page.run(
        "[...document.querySelectorAll('#part-cloud button')]"
        ".find((b) => b.textContent.startsWith('2.')).click()"
    )
    page.wait("return document.getElementById('cloud-command').textContent.includes('1.00203')")
    told = page.run("return document.getElementById('published').textContent")
    assert "E_max,sys 423.0 mm, sigma 31.0 mm" in told
    mean = page.run("return document.querySelector('#cloud-table tbody td').textContent")
    assert 400.0 < float(mean.split()[0]) < 440.0
    page.run(
        "const s = document.getElementById('mc-e_d'); s.value = 1;"
        "s.dispatchEvent(new Event('input'));"
    )
    page.wait("return document.getElementById('cloud-command').textContent.includes('--ed 1 ')")
    assert page.run("return document.getElementById('published').textContent") == ""


@pytest.mark.parametrize("width", [390, 1280, 3840])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_part_fits_its_width_in_light_and_dark_and_axe_finds_nothing(
    browser: webdriver.Chrome, slope: Server, width: int, scheme: str
) -> None:
    axe = pytest.importorskip("axe_selenium_python")
    script = (Path(axe.__file__).parents[1] / AXE).read_text()
    prefer(browser, scheme)
    page = Page(browser, slope, width)
    try:
        page.click("first")
        page.wait("return document.getElementById('draft')")
        page.click("diagnose")
        page.wait("return document.querySelector('.suggestion')")
        page.run("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
        page.run(script)
        for part in ["data", "work", "figures", "away", "cloud"]:
            page.click(f"tab-{part}")
            if part == "cloud":
                page.wait("return document.getElementById('cloud').dataset.n === '10000'")
            if part == "figures":
                page.wait("return document.querySelectorAll('.plot .main-svg').length > 2")
            room = page.run("return [document.documentElement.scrollWidth, innerWidth]")
            assert room[0] <= room[1], (part, room)
            assert look(browser, "overlaps") == [], part
            found = browser.execute_async_script(
                "const [rules, done] = arguments; axe.run(document, rules).then((r) => done("
                "r.violations.map((v) => [v.id, v.nodes.map((n) => n.html)])),"
                "(e) => done([String(e)]))",
                RULES,
            )
            assert found == [], part
        assert complaints(browser) == []
    finally:
        prefer(browser, "light")


def test_tabs_are_moved_through_by_arrow_keys(browser: webdriver.Chrome, slope: Server) -> None:
    page = Page(browser, slope)
    press = """document.getElementById(arguments[0]).dispatchEvent(
      new KeyboardEvent('keydown', { key: arguments[1], bubbles: true }));"""
    for tab, key, part in [("tab-work", "ArrowRight", "figures"), ("tab-figures", "End", "cloud")]:
        page.run(press, tab, key)
        assert page.run("return document.activeElement.id") == f"tab-{part}"
        assert not page.run(f"return document.getElementById('part-{part}').hidden")
