"""The same tick log read by Python's csv module with numpy, by numpy, by pandas and by umbmark.

Writes a log, has every reader turn it into arrays a few times in turn, checks that all found the
same rows and poses, and prints a table in Markdown. The Python readers only make arrays; umbmark
also checks every row, undoes roll-overs and computes the return error, and its start counts too.
Seconds are those of the processor, system calls included. Needs numpy and pandas.
"""

import argparse
import csv
import resource
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import pandas as pd

ROOT = Path(__file__).resolve().parents[2]


def with_csv(file: Path) -> tuple[int, int]:
    """Rows and poses, by the csv module and lists made into arrays."""
    with file.open(newline="") as lines:
        reader = csv.reader(lines)
        next(reader)
        rows = [[float(cell) if cell else np.nan for cell in row] for row in reader]
    table = np.array(rows)
    return len(table), int(np.isfinite(table[:, 3]).sum())


def with_numpy(file: Path) -> tuple[int, int]:
    """The same by numpy.genfromtxt, which knows empty cells."""
    table = np.genfromtxt(file, delimiter=",", skip_header=1)
    return len(table), int(np.isfinite(table[:, 3]).sum())


def with_pandas(file: Path) -> tuple[int, int]:
    """The same by pandas.read_csv with its C parser."""
    table = pd.read_csv(file).to_numpy()
    return len(table), int(np.isfinite(table[:, 3]).sum())


READERS = {"csv + numpy": with_csv, "numpy.genfromtxt": with_numpy, "pandas.read_csv": with_pandas}


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=500_000)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    build = ["cargo", "build", "--release", "-q", "-p", "umbmark-benches", "--example", "read"]
    subprocess.run(build, cwd=ROOT, check=True)
    program = ROOT / "target" / "release" / "examples" / "read"
    seconds: dict[str, list[float]] = {name: [] for name in (*READERS, "umbmark")}
    found = set()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "log"
        subprocess.run([program, "--write", folder, str(options.rows)], check=True)
        file = folder / "runs" / "ccw_01.csv"
        size = file.stat().st_size / 1e6
        for _ in range(options.rounds):
            for name, read in READERS.items():
                began = time.process_time()
                found.add(read(file))
                seconds[name].append(time.process_time() - began)
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            said = subprocess.run([program, "--read", folder, "1"], check=True, capture_output=True, text=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            rows, poses = said.stdout.split()
            found.add((int(rows), int(poses)))
            seconds["umbmark"].append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    if len(found) != 1:
        raise SystemExit(f"the readers found different rows and poses: {found}")
    median = {name: statistics.median(times) for name, times in seconds.items()}
    print(f"{size:.1f} MB, {options.rows} rows, medians of {options.rounds} rounds\n")
    print("| reader | s | MB/s | umbmark is faster by |\n|---|---|---|---|")
    for name, took in median.items():
        print(f"| {name} | {took:.3f} | {size / took:.0f} | {took / median['umbmark']:.1f} |")


if __name__ == "__main__":
    main()
