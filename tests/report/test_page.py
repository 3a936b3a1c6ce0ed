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

LOOK = Path(__file__).with_name("look.js").read_text()


def look(browser: webdriver.Chrome, what: str, *words: Any) -> Any:
    """What a function of look.js says."""
    return browser.execute_script(f"{LOOK}; return {what}(...arguments)", *words)


def complaints(browser: webdriver.Chrome) -> list[Any]:
    """What the console has said since it was last asked."""
    return list(browser.get_log("browser"))  # type: ignore[no-untyped-call]


def size(browser: webdriver.Chrome, width: int, height: int = 900) -> None:
    metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)


def prefer(browser: webdriver.Chrome, scheme: str, media: str = "") -> None:
    features = [{"name": "prefers-color-scheme", "value": scheme}]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": media, "features": features})


def open_page(browser: webdriver.Chrome, page: Path, width: int = 1280) -> None:
    """Opens a page and scrolls through it until every figure is drawn."""
    size(browser, width)
    complaints(browser)
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
    return int(look(browser, "marks", plot))


@pytest.mark.parametrize("name", NAMES)
def test_every_figure_is_drawn_with_data_and_the_console_is_silent(
    browser: webdriver.Chrome, pages: Path, name: str
) -> None:
    open_page(browser, pages / f"{name}.html")
    plots = [plot.get_attribute("id") for plot in browser.find_elements(By.CSS_SELECTOR, ".plot")]
    assert len(plots) >= 7
    assert all(marks(browser, str(plot)) > 0 for plot in plots)
    assert complaints(browser) == []


@pytest.mark.parametrize(("name", "width"), WIDTHS)
def test_no_text_overlaps_or_is_cut_and_nothing_leaves_the_page_at_any_width(
    browser: webdriver.Chrome, pages: Path, name: str, width: int
) -> None:
    open_page(browser, pages / f"{name}.html", width)
    browser.execute_script(
        "document.querySelectorAll('details').forEach((d) => { d.open = true; })"
    )
    time.sleep(0.3)
    wide = browser.execute_script("return document.documentElement.scrollWidth")
    assert wide <= width
    assert look(browser, "overlaps") == []
    assert look(browser, "cut") == []
    assert look(browser, "covered") == []


def test_a_tooltip_names_the_run(browser: webdriver.Chrome, pages: Path) -> None:
    open_page(browser, pages / "slope.html")
    plot = browser.find_element(By.ID, "return_errors-0")
    browser.execute_script("arguments[0].scrollIntoView({ block: 'center' })", plot)
    said = []
    for point in plot.find_elements(By.CSS_SELECTOR, ".scatterlayer .point"):
        ActionChains(browser).move_to_element(point).perform()
        time.sleep(0.15)
        said += [
            text.text for text in plot.find_elements(By.CSS_SELECTOR, ".hoverlayer .hovertext")
        ]
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
    assert complaints(browser) == []


def test_dark_mode_follows_the_system_and_the_button(
    browser: webdriver.Chrome, pages: Path
) -> None:
    prefer(browser, "dark")
    open_page(browser, pages / "slope.html")
    paper, label = look(browser, "light")
    assert paper < 0.2
    assert label > 0.7
    browser.find_element(By.ID, "theme").click()
    time.sleep(0.3)
    paper, label = look(browser, "light")
    assert paper > 0.9
    assert label < 0.3
    prefer(browser, "light")
    open_page(browser, pages / "slope.html")
    assert look(browser, "light")[0] > 0.9


def test_print_has_every_figure_on_white_paper(browser: webdriver.Chrome, pages: Path) -> None:
    prefer(browser, "dark", "print")
    open_page_without_drawing(browser, pages / "slope.html")
    drawings, figures, others, paper = look(browser, "onPaper")
    assert drawings == figures > 5
    assert others == 0
    assert paper == 1
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
    assert complaints(browser) == []


def test_keyboard_and_reader_find_their_way(browser: webdriver.Chrome, pages: Path) -> None:
    open_page_without_drawing(browser, pages / "slope.html")
    named, tables, figures, jumps, lost = look(browser, "toRead")
    assert named == tables == figures > 5
    assert (jumps, lost) == (0, 0)


def simulate_page(folder: Path, runs: int, encoder_rate: int) -> tuple[Path, int]:
    """The page of runs in both senses, and the number of samples of them all."""
    data, model, page = folder / "data", folder / "model.toml", folder / "page.html"
    noisy = ["--wheel-noise", "0.001", "--ed", "1.002"]
    rate = ["--encoder-rate", str(encoder_rate), "--reference-rate", "2"]
    umbmark("simulate", "--runs", str(runs), *rate, *noisy, "-o", data)
    samples = sum(len(file.read_text().splitlines()) - 1 for file in (data / "runs").iterdir())
    model.write_text('[[effect]]\nname = "wheel_diameter_ratio"\ne_d = 1.002\nfree = true\n')
    umbmark("report", data, "--model", model, "--return-poses", "-o", page, "-n", "200")
    return page, samples


def seconds_to_first_figures(browser: webdriver.Chrome, page: Path) -> float:
    began = time.monotonic()
    open_page_without_drawing(browser, page)
    wait_for(browser, "return document.querySelectorAll('.plot[data-drawn]').length >= 2")
    return time.monotonic() - began


def test_two_million_samples_open_nearly_as_fast_as_ten_thousand(
    browser: webdriver.Chrome, tmp_path: Path
) -> None:
    """200 runs of 10 000 samples each, and a spike in one of them; both pages in turn."""
    for name in ["small", "large"]:
        (tmp_path / name).mkdir()
    small, few = simulate_page(tmp_path / "small", 5, 10)
    large, many = simulate_page(tmp_path / "large", 100, 100)
    assert many >= 2_000_000 >= 100 * few
    assert large.stat().st_size < 5e6
    times = [[seconds_to_first_figures(browser, page) for page in (small, large)] for _ in range(5)]
    fastest = [min(column) for column in zip(*times, strict=True)]
    assert fastest[1] < 4 * fastest[0]
    open_page(browser, large)
    assert complaints(browser) == []
