"""Every kind of figure as Plotly reads it."""

import json
import re
from pathlib import Path

import plotly.graph_objects as go  # type: ignore[import-untyped]
import pytest
from conftest import COMMAND, DATA, umbmark

pytestmark = pytest.mark.skipif(
    not COMMAND.exists(), reason=f"{COMMAND} is not built (cargo build)"
)


def kinds() -> list[str]:
    if not COMMAND.exists():
        return []
    listed = umbmark("plot", "--help").split("Kinds:\n")[1]
    return re.findall(r"^  (\w+)", listed, re.MULTILINE)


# Kinds that say why they cannot be drawn from these runs.
ABSENT = {
    "slope": [kind for kind in kinds() if kind.startswith("residuals")],
    "tracked": ["confusability", "runs", "residuals"],
}


@pytest.mark.parametrize("kind", kinds())
def test_plotly_knows_every_attribute_of_every_kind(kind: str, tmp_path: Path) -> None:
    drawn = 0
    for name in ["slope", "tracked"]:
        if any(kind.startswith(absent) for absent in ABSENT[name]):
            continue
        file = tmp_path / f"{name}.json"
        umbmark("plot", kind, DATA / name, "-o", file, "-n", "200")
        figure = go.Figure(json.loads(file.read_text()))
        assert len(figure.data) > 0
        assert all(len(trace.x) == len(trace.y) > 0 for trace in figure.data)
        drawn += 1
    assert drawn or kind.startswith("residuals")
