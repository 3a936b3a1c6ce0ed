"""The command against causes it does not know of: `diagnose` and `learn` on return poses alone.

UMBMARK_TEST_CASES says how many datasets of each cause; 40 where it is silent.
"""

import json
import os
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path as File
from typing import Any

import pytest
from generate import main

COMMAND = File(__file__).parents[2] / "target/release/umbmark"
SETS = int(os.environ.get("UMBMARK_TEST_CASES", "40"))
SIZE = 0.05

pytestmark = pytest.mark.skipif(
    not COMMAND.exists(), reason=f"{COMMAND} is not built (cargo build --release)"
)


def margin(share: float, n: int) -> float:
    """3.5 standard errors of a share."""
    return float(3.5 * (share * (1 - share) / n) ** 0.5)


def made(case: str, folder: File, seed: int) -> list[File]:
    """Datasets of a case."""
    main([case, str(folder), "--returns-only", "--sets", str(SETS), "--seed", str(seed)])
    return sorted(path for path in folder.iterdir() if path.is_dir())


def answers(verb: str, folders: list[File]) -> list[dict[str, Any]]:
    """What the command says of each, in the order of the folders."""

    def answer(folder: File) -> dict[str, Any]:
        words = [str(COMMAND), verb, str(folder), "--json", "--threads", "1", "--draws", "499"]
        done = subprocess.run(words, capture_output=True, check=True, text=True)
        document: dict[str, Any] = json.loads(done.stdout)
        return document

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(answer, folders))


def truth(folder: File) -> dict[str, Any]:
    """The sealed answer beside a dataset."""
    document: dict[str, Any] = json.loads(folder.with_name(f"{folder.name}.truth.json").read_text())
    return document


def test_a_floor_slope_of_3_mm_a_metre_is_found_and_its_class_is_right(tmp_path: File) -> None:
    folders = made("floor_slope_x", tmp_path / "slope", 1000)
    found = [
        (folder, answer["ranking"][0]["class"])
        for folder, answer in zip(folders, answers("diagnose", folders), strict=True)
        if answer["certified"] > 0
    ]
    right = [
        any(name in truth(folder)["causes"][0]["acceptable"] for name in named)
        for folder, named in found
    ]
    print(f"floor slope: found {len(found)} of {SETS}, class right {sum(right)}")
    assert len(found) / SETS > 0.9 - margin(0.9, SETS)
    assert sum(right) / len(found) > 0.95 - margin(0.95, len(found))


def test_a_wheelbase_that_depends_on_the_direction_is_not_claimed(tmp_path: File) -> None:
    folders = made("direction_dependent_wheelbase_alone", tmp_path / "wheelbase", 3000)
    said = answers("diagnose", folders)
    hidden = truth(folders[0])["causes"][0]["name"]
    assert all(hidden in answer["invisible"] for answer in said)
    assert all(answer["absorbed"][hidden] == ["wheel_diameter_ratio"] for answer in said)
    claimed = sum(answer["verdict"] != "explained" for answer in said)
    print(f"direction-dependent wheelbase: something claimed in {claimed} of {SETS}")
    assert claimed / SETS < SIZE + margin(SIZE, SETS)


def test_nothing_is_learnt_where_nothing_is_hidden(tmp_path: File) -> None:
    folders = made("none", tmp_path / "none", 5000)
    added = sum(len(answer["steps"]) > 3 for answer in answers("learn", folders))
    print(f"false additions: {added} of {SETS}")
    assert added / SETS < SIZE + margin(SIZE, SETS)
