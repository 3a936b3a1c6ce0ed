"""Pages and figures to look at, and the browser to look with."""

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

ROOT = Path(__file__).parents[2]
COMMAND = ROOT / "target/release/umbmark"
DATA = ROOT / "crates/umbmark-cli/tests/data"
OPTIONS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
]
# Does what breaking out of a page would do, as the name of a run, a robot and a folder.
HOSTILE = "<img src=x onerror=window.broken=1>"


def umbmark(*words: str | Path) -> str:
    """What the command prints."""
    done = subprocess.run([COMMAND, *words], check=True, capture_output=True, text=True)
    return done.stdout


@pytest.fixture(scope="session")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of reports."""
    if not COMMAND.exists():
        pytest.skip(f"{COMMAND} is not built (cargo build --release)")
    folder = tmp_path_factory.mktemp("pages")
    for name in ["labmate", "slope", "tracked"]:
        umbmark("report", DATA / name, "-o", folder / f"{name}.html", "-n", "200")
    both = [DATA / "slope", DATA / "labmate"]
    umbmark("report", *both, "-o", folder / "both.html", "-n", "200")
    umbmark("report", hostile(folder), "-o", folder / "hostile.html", "-n", "200")
    return folder


def hostile(folder: Path) -> Path:
    """A dataset of which every name would break a careless page."""
    data = folder / HOSTILE
    shutil.copytree(DATA / "tracked", data)
    for run in sorted((data / "runs").iterdir()):
        run.rename(run.with_name(f"{run.stem} {HOSTILE}.csv"))
    robot = data / "robot.toml"
    named = [
        line
        if not line.startswith("name")
        else 'name = "</script><script>window.broken=1</script>"'
        for line in robot.read_text().splitlines()
    ]
    robot.write_text("\n".join(named))
    return data


@pytest.fixture(scope="session")
def browser() -> Iterator[webdriver.Chrome]:
    """A Chromium without a window."""
    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not chromium or not driver:
        pytest.skip("chromium and chromium-driver are not installed")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        for option in [*OPTIONS, f"--user-data-dir={profile}"]:
            options.add_argument(option)
        service = Service(driver, env={**os.environ, "HOME": profile})
        window = webdriver.Chrome(options=options, service=service)
        yield window
        window.quit()


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


def opened(folder: Path, data: str | None = None) -> Iterator[Server]:
    """A workbench in a folder, with a copy of some data or without any."""
    if not COMMAND.exists():
        pytest.skip(f"{COMMAND} is not built (cargo build)")
    if data is not None:
        shutil.copytree(DATA / data, folder / data)
    running = Server(*[data] if data else [], folder=folder)
    yield running
    running.kill()


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    """A workbench without data."""
    yield from opened(tmp_path)


@pytest.fixture
def slope(tmp_path: Path) -> Iterator[Server]:
    """A workbench with return poses."""
    yield from opened(tmp_path, "slope")


@pytest.fixture
def tracked(tmp_path: Path) -> Iterator[Server]:
    """A workbench with a tracked run each way."""
    yield from opened(tmp_path, "tracked")
