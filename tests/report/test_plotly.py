"""Every kind of figure as Plotly reads it."""

import json
import re
import subprocess
from pathlib import Path

import plotly.graph_objects as go
import pytest
from conftest import COMMAND, DATA, umbmark

pytestmark = pytest.mark.skipif(
    not COMMAND.exists(), reason=f"{COMMAND} is not built (cargo build)"
)

UNNAMED = Path(__file__).parents[2] / "examples" / "unnamed"
"""Runs with a law that no catalogue lists."""


def kinds() -> list[str]:
    if not COMMAND.exists():
        return []
    listed = umbmark("plot", "--help").split("Kinds:\n")[1]
    return re.findall(r"^  (\w+)", listed, re.MULTILINE)


@pytest.fixture(scope="session")
def tracks(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Runs enough to say what their errors depend on."""
    folder = tmp_path_factory.mktemp("tracks") / "data"
    umbmark("simulate", "--runs", "4", "--side", "1", "--wheel-noise", "0.001", "-o", folder)
    runs = [f"{sense}_{number:02}" for number in range(1, 5) for sense in ("cw", "ccw")]
    floors = [f"{run},{('tile', 'carpet')[number // 2 % 2]}" for number, run in enumerate(runs)]
    (folder / "conditions.csv").write_text("\n".join(["run,floor", *floors, ""]))
    return folder


@pytest.mark.parametrize("kind", kinds())
def test_plotly_knows_every_attribute_of_every_kind(
    kind: str, tracks: Path, tmp_path: Path
) -> None:
    drawn = 0
    sets = [UNNAMED] if kind == "laws" else [DATA / "slope", DATA / "tracked", tracks]
    for number, data in enumerate(sets):
        file = tmp_path / f"{number}.json"
        words = [
            str(COMMAND),
            "plot",
            kind,
            str(data),
            "-o",
            str(file),
            "-n",
            "200",
            "--draws",
            "99",
        ]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode == 1 and f"{kind} cannot be drawn from" in done.stderr:
            continue
        assert done.returncode == 0, done.stderr
        figure = go.Figure(json.loads(file.read_text()))
        assert len(figure.data) > 0
        assert all(len(trace.x) == len(trace.y) > 0 for trace in figure.data)
        drawn += 1
    assert drawn > 0
