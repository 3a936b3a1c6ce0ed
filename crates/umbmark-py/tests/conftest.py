"""Settings and fixtures of all tests."""

import json
import subprocess
from pathlib import Path

import matplotlib as mpl
import pytest
from hypothesis import settings

# A machine under load is slow, not wrong.
settings.register_profile("umbmark", deadline=None)
settings.load_profile("umbmark")
mpl.use("Agg")

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="session")
def command() -> Path:
    """Return the command, built."""
    build = ["cargo", "build", "--package", "umbmark-cli", "--message-format", "json"]
    lines = subprocess.run(build, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    messages = [json.loads(line) for line in lines.splitlines()]
    return Path(next(m["executable"] for m in reversed(messages) if m.get("executable")))
