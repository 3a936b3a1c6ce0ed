"""Installs the Python package into an empty environment and runs the notebooks' first cells.

``python .ci/try_wheel.py FOLDER`` takes the wheel (or the source) that it finds there; without a
folder it builds both in one of its own, by the maturin of `.venv`.
"""

import os
import re
import subprocess
import sys
import venv
from pathlib import Path
from tempfile import TemporaryDirectory

TOP = Path(__file__).resolve().parent.parent
PACKAGE = TOP / "crates" / "umbmark-py"
FIRST = 3


def cells(source: Path) -> list[str]:
    """The first cells of code of a notebook in the percent format."""
    parts = re.split(r"^# %%", source.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    return [part.partition("\n")[2] for part in parts if not part.startswith(" [")][:FIRST]


def build(folder: Path) -> None:
    """Build the source and the wheel."""
    subprocess.run(
        [
            *(TOP / ".venv" / "bin" / "python", "-m", "maturin", "build", "--release", "--sdist"),
            *("--out", folder, "--manifest-path", PACKAGE / "Cargo.toml"),
        ],
        check=True,
    )


def install(folder: Path, environment: Path) -> Path:
    """Install what the folder has into a new environment, and give its Python."""
    venv.create(environment, with_pip=True)
    inside = "Scripts/python.exe" if sys.platform == "win32" else "bin/python"
    python = environment / inside
    found = sorted(folder.glob("umbmark-*.whl")) or sorted(folder.glob("umbmark-*.tar.gz"))
    assert len(found) == 1, f"one wheel or one source is needed: {found}"
    what = f"umbmark[plot,frames] @ {found[0].resolve().as_uri()}"
    quiet = ["--quiet", "--disable-pip-version-check"]
    subprocess.run([python, "-m", "pip", "install", *quiet, what], check=True)
    return python


def main() -> None:
    """Build where no folder is named, install, run."""
    with TemporaryDirectory() as made:
        folder = Path(made)
        if len(sys.argv) > 1:
            place = Path(sys.argv[1])
        else:
            place = folder / "dist"
            build(place)
        python = install(place, folder / "environment")
        for source in sorted((TOP / "notebooks").glob("*.py")):
            program = folder / source.name
            program.write_text("\n".join(cells(source)), encoding="utf-8")
            # Notebooks name the examples from where they stand.
            subprocess.run(
                [python, "-W", "ignore", program],
                cwd=source.parent,
                env=os.environ | {"MPLBACKEND": "agg"},
                check=True,
            )
            print(f"{source.name}: the first {FIRST} cells run", flush=True)
        example = re.findall(
            r"^```python\n(.*?)^```",
            (PACKAGE / "README.md").read_text(encoding="utf-8"),
            re.DOTALL | re.MULTILINE,
        )
        subprocess.run([python, "-c", "\n".join(example)], cwd=TOP, check=True)
        print("README.md of the package: its example runs")


if __name__ == "__main__":
    main()
