"""General learners and `umbmark learn` on the same drives, by one command.

Makes its own environment under target/peers-laws, makes sets of drives with `tests/worlds`, gives
the increments of the fitted robot's error to a Gaussian process, a sparse regression and a
symbolic regression, lets `umbmark learn` have the logs, and judges all of them on drives that
nothing was learnt from. Prints tables in Markdown. Needs Python 3.11 or newer, the package
registries at first, and the command (`cargo build --release`).
"""

import argparse
import os
import subprocess
import sys
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
ENVIRONMENT = ROOT / "target" / "peers-laws"
REQUIREMENTS = HERE / "requirements.txt"
ONE_THREAD = {
    "MKL_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "PYTHONWARNINGS": "ignore",
}


def install() -> Path:
    """Make the environment where it is not complete, and return its interpreter."""
    folder = "Scripts" if os.name == "nt" else "bin"
    python = ENVIRONMENT / folder / "python"
    installed = ENVIRONMENT / "installed.txt"
    wanted = REQUIREMENTS.read_text()
    if installed.exists() and installed.read_text() == wanted:
        return python
    print("installing scikit-learn, PySINDy and gplearn", file=sys.stderr, flush=True)
    venv.create(ENVIRONMENT, clear=True, with_pip=True)
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, "-r", str(REQUIREMENTS)], check=True)
    installed.write_text(wanted)
    return python


def main() -> None:
    """Parse the flags and go."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=12, help="with a hidden law")
    parser.add_argument("--nulls", type=int, default=12, help="the same drives with nothing hidden")
    parser.add_argument("--first-seed", type=int, default=101)
    parser.add_argument("--optiodom", action="store_true", help="squares, then circles and others")
    parser.add_argument(
        "--binary", type=Path, default=ROOT / "target" / "release" / "umbmark", help="the command"
    )
    parser.add_argument(
        "--json",
        type=Path,
        default=ROOT / "target" / "peers-laws.jsonl",
        help="all results, one line a set",
    )
    parser.add_argument("--table", action="store_true", help="print the tables of --json again")
    chosen = parser.parse_args()
    if not chosen.binary.exists():
        sys.exit(f"{chosen.binary} is not there: cargo build --release, or say --binary")
    words = [str(install()), str(HERE / "study.py")]
    for name in ("sets", "nulls", "first_seed", "binary", "json"):
        words += [f"--{name.replace('_', '-')}", str(getattr(chosen, name))]
    words += [f"--{name}" for name in ("optiodom", "table") if getattr(chosen, name)]
    sys.exit(subprocess.run(words, check=False, env=os.environ | ONE_THREAD).returncode)


if __name__ == "__main__":
    main()
