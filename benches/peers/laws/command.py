"""The command `umbmark`, on one thread."""

import json
import os
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FITS = ("wheel_diameter_ratio", "wheelbase", "scale")
UNEXPLAINED = 3
"""Exit code of an answer that says that something is missing."""


@dataclass(frozen=True)
class Command:
    """The program to run."""

    program: Path

    def ask(self, *words: str | Path) -> dict[str, Any]:
        """What it answers, in JSON."""
        call = [self.program, *words, "--json", "--threads", "1", "--quiet"]
        done = subprocess.run(call, check=False, text=True, capture_output=True, env=os.environ)
        if done.returncode not in (0, UNEXPLAINED):
            raise RuntimeError(f"umbmark {words[0]} ended with {done.returncode}: {done.stderr}")
        answer: dict[str, Any] = json.loads(done.stdout)
        return answer

    def fit(self, folder: Path, model: Path, more: tuple[str, ...] = ()) -> None:
        """Fit E_d, E_b and E_s, what the motion shows of the reference, and more effects of it."""
        added = [word for effect in (*FITS, *more) for word in ("--add", effect)]
        self.ask("fit", folder, *added, "-o", model, "--force")

    def learn(self, folder: Path, model: Path) -> tuple[dict[str, Any], float]:
        """Learn a model; the answer, and how long it took [s]."""
        begin = time.perf_counter()
        answer = self.ask("learn", folder, "-o", model, "--force")
        return answer, time.perf_counter() - begin

    def inspect(self, folder: Path) -> dict[str, Any]:
        """What it sees in a dataset."""
        return self.ask("inspect", folder)

    def compare(self, folder: Path, models: list[Path]) -> dict[str, Any]:
        """How models predict a dataset."""
        words = [word for model in models for word in ("--model", model)]
        return self.ask("compare", folder, *words)

    def convert(self, folder: Path, out: Path) -> None:
        """A dataset of another layout as CSV."""
        call: list[str | Path] = [self.program, "convert", folder, "-o", out, "--to", "csv"]
        subprocess.run(call, check=True, capture_output=True)
