"""The page of the workbench in the browser."""

import json
import time
from typing import Any

from conftest import Server
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from test_page import complaints, size


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
