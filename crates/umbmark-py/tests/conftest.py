"""Settings and fixtures of all tests."""

from pathlib import Path

import matplotlib as mpl
import pytest
from hypothesis import settings

# A machine under load is slow, not wrong.
settings.register_profile("umbmark", deadline=None)
settings.load_profile("umbmark")
mpl.use("Agg")

COMMAND = Path(__file__).parents[3] / "target/debug/umbmark"


@pytest.fixture(scope="session")
def command() -> Path:
    """Return the command."""
    if not COMMAND.exists():
        pytest.skip(f"{COMMAND} is not built (cargo build)")
    return COMMAND
