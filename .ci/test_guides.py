"""What the guides promise: their commands, one after the other in an empty folder, all succeed."""

import os
import re
import subprocess
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parent.parent
GUIDES = sorted((TOP / "docs" / "guide").glob("*.md"))


def commands(guide: Path) -> list[str]:
    """The lines of its blocks of shell commands."""
    blocks = re.findall(
        r"^```sh\n(.*?)^```", guide.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
    )
    return [line for block in blocks for line in block.splitlines() if line]


def files(guide: Path) -> str:
    """The model that it shows, where it shows one."""
    blocks = re.findall(
        r"^```toml\n(.*?)^```", guide.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
    )
    return "\n".join(blocks)


@pytest.mark.parametrize("guide", GUIDES, ids=lambda guide: guide.stem)
def test_every_command_of_a_guide_does_what_it_is_there_for(guide: Path, tmp_path: Path) -> None:
    umbmark = str(TOP / "target" / "release" / "umbmark")
    assert commands(guide), "a guide without commands"
    if model := files(guide):
        (tmp_path / "model.toml").write_text(model, encoding="utf-8")
    for command in commands(guide):
        done = subprocess.run(
            command.split("#")[0].split(),
            cwd=tmp_path,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            encoding="utf-8",
            env=os.environ | {"NO_COLOR": "1"},
            executable=umbmark,
            check=False,
        )
        assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
        assert done.stdout, command
