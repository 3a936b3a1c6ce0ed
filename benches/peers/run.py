"""The same sampled odometry in numpy, numba, JAX and Rust, one after the other, on one thread.

Makes its own environment under target/peers, has the Rust side export the segments of whole
UMBmark tests, runs every program on them in rounds, checks that all end at the same places, and
prints a table in Markdown. Needs Python 3.11 or newer, Rust, and the package registries at first.
"""

import argparse
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import venv
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
ENVIRONMENT = ROOT / "target" / "peers"
REQUIREMENTS = HERE / "requirements.txt"

SETTINGS = {
    "NUMBA_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "JAX_PLATFORMS": "cpu",
    "JAX_ENABLE_X64": "1",
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1",
}

PROGRAMS = {
    "numpy_loop.py": "numpy, loop over readings",
    "numba_plain.py": "numba, plain loop",
    "numba_expert.py": "numba, expert: no trigonometry",
    "jax_loop.py": "JAX (CPU), compiled loop",
}
MIDPOINT = ("numpy_loop.py", "numba_plain.py", "jax_loop.py")
MIDPOINT_ERROR_M = 2e-7
"""The midpoint rule and the arc differ by less over a run of 17 m."""
ROUNDING_ERROR_M = 1e-10
"""What rounding may do to the others."""

READINGS_PER_RUN = 4 * (2000 + 134)
RUNS_PER_TRIAL = 10


@dataclass
class Result:
    """What one program took, once a round."""

    seconds: list[float] = field(default_factory=list)
    error_m: float = float("nan")

    def median(self) -> float:
        """The median of the rounds, in CPU seconds."""
        return statistics.median(self.seconds)


def say(text: str) -> None:
    """Tell the user, apart from the table."""
    print(text, file=sys.stderr, flush=True)


def install() -> Path:
    """Make the environment where it is not complete, and return its interpreter."""
    folder = "Scripts" if os.name == "nt" else "bin"
    python = ENVIRONMENT / folder / "python"
    installed = ENVIRONMENT / "installed.txt"
    wanted = REQUIREMENTS.read_text()
    if installed.exists() and installed.read_text() == wanted:
        return python
    say("installing numpy, numba, JAX and readers of MCAP")
    venv.create(ENVIRONMENT, clear=True, with_pip=True)
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    names = [line for line in wanted.splitlines() if not line.startswith("#")]
    # JAX has no wheels for some machines: the others must not fail with it.
    subprocess.run([*pip, *(name for name in names if not name.startswith("jax"))], check=True)
    jax = subprocess.run([*pip, *(name for name in names if name.startswith("jax"))], check=False)
    if jax.returncode == 0:
        installed.write_text(wanted)
    return python


def has_jax(python: Path) -> bool:
    """Whether JAX is there."""
    probe = [str(python), "-c", "import jax"]
    return subprocess.run(probe, check=False, capture_output=True).returncode == 0


def build() -> Path:
    """Compile the Rust side and return its program."""
    cargo = ["cargo", "build", "--release", "--package", "umbmark-benches", "--example", "peers"]
    subprocess.run(cargo, check=True, cwd=ROOT)
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    return target / "release" / "examples" / ("peers.exe" if os.name == "nt" else "peers")


def output_of(command: list[str]) -> list[list[str]]:
    """The words of each line that a program prints."""
    environment = os.environ | SETTINGS
    done = subprocess.run(command, check=True, env=environment, text=True, stdout=subprocess.PIPE)
    return [line.split("\t") for line in done.stdout.splitlines()]


def measure(rust: Path, python: Path, programs: list[str], trials: int, rounds: int) -> None:
    """Run everything `rounds` times in turn and print the table."""
    results: dict[str, Result] = {}
    with tempfile.TemporaryDirectory() as folder:
        say(f"exporting {trials} trials, with their exact ends")
        subprocess.run([rust, "export", folder, str(trials)], check=True)
        for number in range(rounds):
            for program in programs:
                say(f"round {number + 1} of {rounds}: {PROGRAMS[program]}")
                [[seconds, error]] = output_of([str(python), str(HERE / program), folder])
                result = results.setdefault(PROGRAMS[program], Result())
                result.seconds.append(float(seconds))
                result.error_m = float(error)
            say(f"round {number + 1} of {rounds}: umbmark")
            for name, seconds, error in output_of([str(rust), "measure", folder, str(trials)]):
                result = results.setdefault(name, Result())
                result.seconds.append(float(seconds))
                result.error_m = float(error)
    midpoint = [PROGRAMS[program] for program in MIDPOINT]
    for name, result in results.items():
        allowed = MIDPOINT_ERROR_M if name in midpoint else ROUNDING_ERROR_M
        if result.error_m > allowed:
            sys.exit(f"{name} ends {result.error_m:.1e} m from where it should")
    print_table(results, trials, rounds)


def print_table(results: dict[str, Result], trials: int, rounds: int) -> None:
    """Print one row for each program, and how many times faster each kind of umbmark is."""
    readings = trials * RUNS_PER_TRIAL * READINGS_PER_RUN
    sampled = [name for name in results if name.startswith("sampled")]
    exact = [name for name in results if name.startswith("tick-exact")]
    # The widest registers come last.
    columns = dict.fromkeys([sampled[-1], exact[0], exact[-1]])
    print(
        f"{trials} trials, {readings / 1e6:.1f} million readings, one thread; {platform.machine()}"
    )
    print(f"CPU seconds, median of {rounds}; the columns say how many times faster umbmark is\n")
    head = ["program", "CPU s", "ns/reading", "error (m)", *columns]
    print("| " + " | ".join(head) + " |")
    print("|---" * len(head) + "|")
    for name, result in results.items():
        own = name not in PROGRAMS.values()
        seconds = result.median()
        is_sampled = name.startswith(("sampled", "whole trials, sampled")) or not own
        cells = [
            f"umbmark, {name}" if own else name,
            f"{seconds:.3g}",
            f"{1e9 * seconds / readings:.3g}" if is_sampled else "",
            f"{result.error_m:.0e}" if result.error_m == result.error_m else "",
            *(f"{seconds / results[column].median():.3g}" for column in columns),
        ]
        print("| " + " | ".join(cells) + " |")


def main() -> None:
    """Parse the flags and go."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="1000 trials once, not 10,000 thrice")
    quick = parser.parse_args().quick
    python, rust = install(), build()
    programs = list(PROGRAMS)
    if not has_jax(python):
        say("JAX is not there: going on without it")
        programs.remove("jax_loop.py")
    measure(rust, python, programs, trials=1000 if quick else 10_000, rounds=1 if quick else 3)


if __name__ == "__main__":
    main()
