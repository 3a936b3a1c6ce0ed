"""The report page, as a reader would meet it."""

import base64
import time
from pathlib import Path
from typing import Any

import pytest
from conftest import umbmark
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

NAMES = ["labmate", "slope", "tracked", "both"]
WIDTHS = [("slope", 320), ("slope", 1280), ("labmate", 1920)]
WIDTHS += [(name, width) for name in ["tracked", "both"] for width in [320, 768, 1280, 3840]]

# Pairs of texts that lie on one another, as seen: what is clipped or hidden does not count.
OVERLAPS = """
const seen = [];
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
while (walker.nextNode()) {
  const node = walker.currentNode, owner = node.parentElement;
  if (!node.data.trim() || owner.closest("script, style, .modebar, .print, .skip")) continue;
  if (!owner.checkVisibility({ visibilityProperty: true, opacityProperty: true })) continue;
  const clips = [];
  for (let e = owner; e; e = e.parentElement) {
    if (/auto|hidden|scroll/.test(getComputedStyle(e).overflow)) clips.push(e.getBoundingClientRect());
  }
  const range = document.createRange();
  range.selectNodeContents(node);
  for (const box of range.getClientRects()) {
    let [l, t, r, b] = [box.left, box.top, box.right, box.bottom];
    for (const c of clips) {
      [l, t, r, b] = [Math.max(l, c.left), Math.max(t, c.top), Math.min(r, c.right), Math.min(b, c.bottom)];
    }
    if (r - l > 1 && b - t > 1) seen.push([l, t, r, b, node.data.trim().slice(0, 40)]);
  }
}
seen.sort((a, b) => a[1] - b[1]);
const pairs = [];
for (let i = 0; i < seen.length; i++) {
  for (let j = i + 1; j < seen.length && seen[j][1] < seen[i][3]; j++) {
    const across = Math.min(seen[i][2], seen[j][2]) - Math.max(seen[i][0], seen[j][0]);
    const down = Math.min(seen[i][3], seen[j][3]) - Math.max(seen[i][1], seen[j][1]);
    if (across > 2 && down > 4) pairs.push([seen[i][4], seen[j][4], across, down]);
  }
}
return pairs;
"""


def size(browser: webdriver.Chrome, width: int, height: int = 900) -> None:
    metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)


def prefer(browser: webdriver.Chrome, scheme: str, media: str = "") -> None:
    features = [{"name": "prefers-color-scheme", "value": scheme}]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": media, "features": features})


def open_page(browser: webdriver.Chrome, page: Path, width: int = 1280) -> None:
    """Opens a page and scrolls through it until every figure is drawn."""
    size(browser, width)
    browser.get_log("browser")
    browser.get(page.absolute().as_uri())
    for plot in browser.find_elements(By.CSS_SELECTOR, ".plot"):
        browser.execute_script("arguments[0].scrollIntoView({ block: 'center' })", plot)
        wait_for(browser, "return arguments[0].dataset.drawn === '1'", plot)


def wait_for(browser: webdriver.Chrome, script: str, *words: Any) -> None:
    until = time.monotonic() + 10
    while not browser.execute_script(script, *words):
        assert time.monotonic() < until, script
        time.sleep(0.02)


def marks(browser: webdriver.Chrome, plot: str) -> int:
    """How many points, lines and bars with something in them a figure shows."""
    script = """
    const inside = document.getElementById(arguments[0]).querySelectorAll(
      '.scatterlayer .point, .scatterlayer path.js-line, .barlayer .point path');
    return [...inside].filter((mark) => (mark.getAttribute('d') ?? '').length > 4).length;
    """
    return int(browser.execute_script(script, plot))


@pytest.mark.parametrize("name", NAMES)
def test_every_figure_is_drawn_with_data_and_the_console_is_silent(
    browser: webdriver.Chrome, pages: Path, name: str
) -> None:
    open_page(browser, pages / f"{name}.html")
    plots = [plot.get_attribute("id") for plot in browser.find_elements(By.CSS_SELECTOR, ".plot")]
    assert len(plots) >= 8
    assert all(marks(browser, str(plot)) > 0 for plot in plots)
    assert browser.get_log("browser") == []


@pytest.mark.parametrize(("name", "width"), WIDTHS)
def test_no_text_overlaps_and_nothing_leaves_the_page_at_any_width(
    browser: webdriver.Chrome, pages: Path, name: str, width: int
) -> None:
    open_page(browser, pages / f"{name}.html", width)
    browser.execute_script("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    time.sleep(0.3)
    wide = browser.execute_script("return document.documentElement.scrollWidth")
    assert wide <= width
    assert browser.execute_script(OVERLAPS) == []


def test_a_tooltip_names_the_run(browser: webdriver.Chrome, pages: Path) -> None:
    open_page(browser, pages / "slope.html")
    plot = browser.find_element(By.ID, "return_errors-0")
    browser.execute_script("arguments[0].scrollIntoView({ block: 'center' })", plot)
    said = []
    for point in plot.find_elements(By.CSS_SELECTOR, ".scatterlayer .point"):
        ActionChains(browser).move_to_element(point).perform()
        time.sleep(0.15)
        said += [text.text for text in plot.find_elements(By.CSS_SELECTOR, ".hoverlayer .hovertext")]
    assert any(text.startswith("ccw_0") and "mm" in text for text in said), said


def test_directions_and_runs_can_be_hidden_and_come_back(
    browser: webdriver.Chrome, pages: Path
) -> None:
    open_page(browser, pages / "slope.html")
    everything = marks(browser, "return_errors-0")
    cw = browser.find_element(By.CSS_SELECTOR, "input[name=direction][value=cw]")
    cw.click()
    shown = "return document.querySelectorAll('#return_errors-0 .scatterlayer .trace').length"
    wait_for(browser, f"{shown} < arguments[0]", browser.execute_script(shown) + 1)
    time.sleep(0.2)
    # Five runs, their centre with its ellipse, and what the model predicts.
    assert marks(browser, "return_errors-0") == everything - 8
    cw.click()
    time.sleep(0.2)
    assert marks(browser, "return_errors-0") == everything
    browser.find_element(By.CSS_SELECTOR, "fieldset summary").click()
    browser.find_element(By.CSS_SELECTOR, "input[name=run][value='0']").click()
    time.sleep(0.2)
    assert marks(browser, "return_errors-0") == everything - 1
    browser.find_element(By.CSS_SELECTOR, "button[data-all='']").click()
    time.sleep(0.2)
    assert marks(browser, "return_errors-0") == everything - 10
    browser.find_element(By.CSS_SELECTOR, "button[data-all='1']").click()
    time.sleep(0.2)
    assert marks(browser, "return_errors-0") == everything
    assert browser.get_log("browser") == []


def test_dark_mode_follows_the_system_and_the_button(
    browser: webdriver.Chrome, pages: Path
) -> None:
    def light() -> tuple[float, float]:
        """How light the paper and a label of a figure are, from 0 to 1."""
        script = """
        const light = (colour) => colour.match(/[\\d.]+/g).slice(0, 3).reduce((s, v) => s + v / 765, 0);
        const label = document.querySelector('#return_errors-0 .xtick text');
        return [light(getComputedStyle(document.body).backgroundColor), light(getComputedStyle(label).fill)];
        """
        paper, label = browser.execute_script(script)
        return float(paper), float(label)

    prefer(browser, "dark")
    open_page(browser, pages / "slope.html")
    paper, label = light()
    assert paper < 0.2
    assert label > 0.7
    browser.find_element(By.ID, "theme").click()
    time.sleep(0.3)
    paper, label = light()
    assert paper > 0.9
    assert label < 0.3
    prefer(browser, "light")
    open_page(browser, pages / "slope.html")
    assert light()[0] > 0.9


def test_print_has_every_figure_on_white_paper(browser: webdriver.Chrome, pages: Path) -> None:
    prefer(browser, "dark", "print")
    open_page_without_drawing(browser, pages / "slope.html")
    script = """
    const shown = (e) => e.checkVisibility() && e.getBoundingClientRect().height > 50;
    return [[...document.querySelectorAll('.print svg')].filter(shown).length,
            document.querySelectorAll('figure').length,
            [...document.querySelectorAll('.plot, .tools, nav')].filter((e) => e.checkVisibility()).length,
            getComputedStyle(document.body).backgroundColor];
    """
    drawings, figures, others, paper = browser.execute_script(script)
    assert drawings == figures > 5
    assert others == 0
    assert paper == "rgb(255, 255, 255)"
    prefer(browser, "light")
    pdf = base64.b64decode(browser.execute_cdp_cmd("Page.printToPDF", {})["data"])
    assert pdf.startswith(b"%PDF")
    assert 2 <= pdf.count(b"/Type /Page\n") <= 12


def open_page_without_drawing(browser: webdriver.Chrome, page: Path) -> None:
    size(browser, 1280)
    browser.get(page.absolute().as_uri())


def test_hostile_names_are_words_and_nothing_more(browser: webdriver.Chrome, pages: Path) -> None:
    open_page(browser, pages / "hostile.html")
    for box in browser.find_elements(By.CSS_SELECTOR, "#tracks-0 .point, #tracks-0 .js-line")[:4]:
        ActionChains(browser).move_to_element(box).perform()
    assert browser.execute_script("return window.broken") is None
    assert browser.execute_script("return document.images.length") == 0
    assert "onerror" in browser.find_element(By.TAG_NAME, "h1").text
    assert browser.get_log("browser") == []


def test_keyboard_and_reader_find_their_way(browser: webdriver.Chrome, pages: Path) -> None:
    open_page_without_drawing(browser, pages / "slope.html")
    script = """
    const named = [...document.querySelectorAll('[role=img].plot')].filter((e) => e.ariaLabel.length > 20);
    const tables = [...document.querySelectorAll('figure')].filter((e) => e.querySelector('details table'));
    const levels = [...document.querySelectorAll('h1, h2, h3, h4')].map((h) => Number(h.tagName[1]));
    const jumps = levels.filter((level, i) => i > 0 && level > levels[i - 1] + 1);
    const targets = [...document.querySelectorAll('nav a')].filter((a) => document.querySelector(a.hash));
    return [named.length, tables.length, document.querySelectorAll('figure').length, jumps.length,
            targets.length, document.querySelectorAll('nav a').length, document.documentElement.lang];
    """
    named, tables, figures, jumps, targets, links, language = browser.execute_script(script)
    assert named == tables == figures
    assert jumps == 0
    assert targets == links
    assert language == "en"


def test_two_million_samples_open_in_three_seconds(
    browser: webdriver.Chrome, tmp_path: Path
) -> None:
    """200 runs of 10 000 samples each, and a spike in one of them."""
    data, model, page = tmp_path / "big", tmp_path / "model.toml", tmp_path / "big.html"
    noisy = ["--wheel-noise", "0.001", "--ed", "1.002"]
    rate = ["--encoder-rate", "100", "--reference-rate", "2"]
    umbmark("simulate", "--runs", "100", *rate, *noisy, "-o", data)
    samples = sum(len(file.read_text().splitlines()) - 1 for file in (data / "runs").iterdir())
    assert samples >= 2_000_000
    model.write_text('[[effect]]\nname = "wheel_diameter_ratio"\ne_d = 1.002\nfree = true\n')
    umbmark("report", data, "--model", model, "--return-poses", "-o", page, "-n", "200")
    assert page.stat().st_size < 5e6
    began = time.monotonic()
    open_page_without_drawing(browser, page)
    wait_for(browser, "return document.querySelectorAll('.plot[data-drawn]').length >= 2")
    assert time.monotonic() - began < 3
    open_page(browser, page)
    assert browser.get_log("browser") == []
