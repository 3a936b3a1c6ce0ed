"""What the README promises of a fresh clone: `umbmark mc` with one command, after `./test.sh`."""

import json
import os
import re
import subprocess
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
COMMAND = "cargo run --release -- mc --ed 1.002 --eb 1.01 -n 10000"
# What it builds is built already, with all other crates; `.ci/run` checks that it compiles alone.
UMBMARK = TOP / "target" / "release" / "umbmark"


def run(*more: str) -> str:
    """Standard output of the README's command, once it is built, with further arguments."""
    done = subprocess.run(
        [UMBMARK, *COMMAND.partition(" -- ")[2].split(), *more],
        cwd=TOP,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        encoding="utf-8",
        env=os.environ | {"NO_COLOR": "1"},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_readme_names_both_commands() -> None:
    text = (TOP / "README.md").read_text(encoding="utf-8")
    for command in (COMMAND, "./test.sh"):
        assert re.search(rf"^{re.escape(command)}\b", text, re.MULTILINE), command


def test_the_first_command_prints_a_table_a_histogram_and_the_seed() -> None:
    text = run()
    assert re.search(r"E_max,sys .*\d", text), text
    assert re.search(r"centroid ccw, y .*\d", text), text
    assert len(re.findall(r"^.*[█▉▊▋▌▍▎▏#*]+.*$", text, re.MULTILINE)) >= 5, text
    assert re.search(r"\bseed \d+", text), text


def test_the_same_as_json_is_one_document_and_the_same_for_the_same_seed() -> None:
    first, second = (json.loads(run("--json", "--seed", "7")) for _ in range(2))
    assert (first["n"], first["seed"], first["partial"]) == (10000, 7, False)
    assert first["metrics"] == second["metrics"]
    e_max = first["metrics"]["e_max_sys_m"]
    assert 0 < e_max["quantiles"]["0.05"] < e_max["mean"] < e_max["quantiles"]["0.95"]
