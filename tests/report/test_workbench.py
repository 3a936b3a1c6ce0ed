"""The workbench as its user meets it: tour, bad files, killed server, two pages, who is asked."""

import json
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from conftest import COMMAND, DATA, OPTIONS, ROOT, umbmark
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys
from test_page import complaints, look, prefer, size

HIDDEN = ROOT / "examples/hidden"
AXE = "axe_selenium_python/node_modules/axe-core/axe.min.js"
#: What axe is asked for: the rules of WCAG 2, A and AA.
RULES = {"runOnly": ["wcag2a", "wcag2aa"]}


class Server:
    """A workbench that ends with the test."""

    def __init__(self, *words: str | Path, folder: Path) -> None:
        command = [COMMAND, "open", "--no-browser", *words]
        self.process = subprocess.Popen(
            command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        assert self.process.stdout is not None
        self.address = self.process.stdout.readline().strip()
        assert self.address.startswith("http://127.0.0.1:")

    def kill(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.communicate()


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    """A workbench without data."""
    if not COMMAND.exists():
        pytest.skip(f"{COMMAND} is not built (cargo build)")
    running = Server(folder=tmp_path)
    yield running
    running.kill()


@pytest.fixture
def slope(tmp_path: Path) -> Iterator[Server]:
    """A workbench with return poses."""
    if not COMMAND.exists():
        pytest.skip(f"{COMMAND} is not built (cargo build)")
    shutil.copytree(DATA / "slope", tmp_path / "slope")
    running = Server("slope", folder=tmp_path)
    yield running
    running.kill()


@pytest.fixture
def tracked(tmp_path: Path) -> Iterator[Server]:
    """A workbench with a tracked run each way."""
    if not COMMAND.exists():
        pytest.skip(f"{COMMAND} is not built (cargo build)")
    shutil.copytree(DATA / "tracked", tmp_path / "tracked")
    running = Server("tracked", folder=tmp_path)
    yield running
    running.kill()


class Page:
    """The workbench in the browser."""

    def __init__(self, browser: webdriver.Chrome, server: Server, width: int = 1280) -> None:
        self.browser = browser
        size(browser, width)
        # A page that is open still asks its server, which may be gone.
        browser.get("about:blank")
        complaints(browser)
        browser.get(server.address)
        self.wait("return document.body.dataset.ready === '1'")

    def run(self, script: str, *words: Any) -> Any:
        return self.browser.execute_script(script, *words)

    def wait(self, script: str, *words: Any, seconds: float = 60) -> Any:
        until = time.monotonic() + seconds
        while not (found := self.run(script, *words)):
            assert time.monotonic() < until, (script, self.text("alert"))
            time.sleep(0.03)
        return found

    def click(self, element: str) -> None:
        """Clicks a button as soon as it can be clicked."""
        ready = "const e = document.getElementById(arguments[0]); return Boolean(e) && !e.disabled"
        self.wait(ready, element)
        self.run("document.getElementById(arguments[0]).click()", element)

    def text(self, element: str) -> str:
        return str(self.run("return document.getElementById(arguments[0])?.innerText", element))

    def put(self, element: str, value: str) -> None:
        script = """const [id, value] = arguments; const e = document.getElementById(id);
        e.value = value;
        for (const name of ["input", "change"]) e.dispatchEvent(new Event(name));"""
        self.run(script, element, value)

    def drop(self, files: dict[str, bytes]) -> None:
        """Drops files on the page, as a browser hands them over."""
        script = """const transfer = new DataTransfer();
        for (const [name, bytes] of arguments[0]) {
          transfer.items.add(new File([new Uint8Array(bytes)], name));
        }
        const input = document.getElementById("folder");
        const files = [...transfer.files].map((file, i) => {
          Object.defineProperty(file, "webkitRelativePath", { value: arguments[0][i][0] });
          return file;
        });
        Object.defineProperty(input, "files", { value: files, configurable: true });
        input.dispatchEvent(new Event("change"));"""
        self.run(script, [[name, list(text)] for name, text in files.items()])

    def story(self) -> list[str]:
        script = "return [...document.querySelectorAll('#story .value')].map((e) => e.textContent)"
        return list(self.run(script))

    def fetch(self, path: str) -> str:
        """What the server answers."""
        script = """const [path, done] = arguments;
        fetch(path).then((r) => r.text()).then(done, (e) => done(String(e)));"""
        return str(self.browser.execute_async_script(script, path))

    def show(self, *names: str) -> list[dict[str, Any]]:
        """Draws these figures; what the server says of each."""
        self.click("tab-figures")
        for card, name in enumerate(names):
            self.put(f"figure-{card}", name)
        drawn = """return arguments[0].every((name, card) => {
          const choice = document.getElementById(`figure-${card}`);
          const section = choice.closest("section");
          return choice.value === name && section.querySelector(".legend li")
            && !section.textContent.includes("Working it out");
        })"""
        self.wait(drawn, list(names))
        return [json.loads(self.fetch(f"api/figure?name={name}")) for name in names]

    def rings(self, card: int) -> list[tuple[int, int]]:
        """The trace and the place of each ring of a figure."""
        script = """const frame = document.querySelectorAll(".frame")[arguments[0]];
        const of = ({ dataset }) => [Number(dataset.trace), Number(dataset.place)];
        return [...frame.querySelectorAll(".ring")].map(of);"""
        return [(trace, place) for trace, place in self.run(script, card)]

    def mouse(self, element: str, x: float, y: float, *, click: bool = False) -> None:
        """Moves the pointer to a point of an element, from its left upper corner."""
        # Drawings get their height when they are painted.
        script = """const [element, done] = arguments;
        const e = document.querySelector(element);
        requestAnimationFrame(() => requestAnimationFrame(() => {
          e.scrollIntoView({ block: "center" });
          const { left, top } = e.getBoundingClientRect();
          done([left, top]);
        }));"""
        left, top = self.browser.execute_async_script(script, element)
        chain = ActionChains(self.browser)
        pointer: Any = chain.w3c_actions.pointer_action
        pointer.move_to_location(round(left + x), round(top + y))
        chain.perform()
        if click:
            ActionChains(self.browser).click().perform()

    def at(self, card: int, trace: int, place: int) -> tuple[float, float]:
        """Where a place of a figure is drawn, from the left upper corner of the figure."""
        script = """const [card, t, i] = arguments;
        const plot = document.querySelectorAll(".plot")[card];
        const trace = plot.data[t];
        return ["x", "y"].map((name) => {
          const axis = plot._fullLayout[name + "axis" + trace[name + "axis"].slice(1)];
          return axis._offset + axis.l2p(trace[name][i]);
        });"""
        x, y = self.run(script, card, trace, place)
        return float(x), float(y)

    def press(self, *keys: str) -> None:
        for key in keys:
            ActionChains(self.browser).send_keys(key).perform()

    def accepted(self, count: int) -> None:
        self.wait(
            "return document.querySelectorAll('#story button').length === arguments[0]"
            " && !document.getElementById('draft')",
            count,
        )


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
