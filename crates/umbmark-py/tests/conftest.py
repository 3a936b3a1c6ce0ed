"""Settings and fixtures of all tests."""

import subprocess
from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl
import pytest
from hypothesis import settings
from matplotlib import pyplot
from recorded import TICKS_PER_REVOLUTION

# A machine under load is slow, not wrong.
settings.register_profile("umbmark", deadline=None)
settings.load_profile("umbmark")
mpl.use("Agg")

COMMAND = Path(__file__).parents[3] / "target/release/umbmark"


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    """Close all figures."""
    yield
    pyplot.close("all")


@pytest.fixture(scope="session")
def command() -> Path:
    """Return the command."""
    if not COMMAND.exists():
        pytest.skip(f"{COMMAND} is not built (cargo build --release)")
    return COMMAND


@pytest.fixture(scope="session")
def measured(command: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a dataset in CSV."""
    folder = tmp_path_factory.mktemp("measured") / "robot"
    flags = [
        "--side",
        "0.5",
        "--runs",
        "3",
        "--eb",
        "1.01",
        "--ed",
        "1.002",
        "--ticks-per-revolution",
        str(TICKS_PER_REVOLUTION),
    ]
    subprocess.run([command, "simulate", "-o", folder, *flags], check=True, capture_output=True)
    return folder
