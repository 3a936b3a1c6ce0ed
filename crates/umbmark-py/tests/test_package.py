"""The package as a whole: what it exports, its version, and the examples in its docstrings."""

import doctest
import importlib.metadata
import inspect
import os
import subprocess
import sys
import threading
import time
import typing

import numpy as np
import umbmark
from umbmark import _documents
from umbmark._result import Record


def test_the_version_is_the_same_everywhere() -> None:
    assert umbmark.__version__ == importlib.metadata.version("umbmark")


def test_everything_public_has_a_docstring() -> None:
    for name in umbmark.__all__:
        thing = getattr(umbmark, name)
        if typing.get_origin(thing) is not None:
            # What an argument may be; the documentation of the calls says what it means.
            continue
        assert name.startswith("__") or inspect.getdoc(thing), name
        if inspect.isclass(thing):
            # What the attributes of results are, their class says.
            described = getattr(thing, "__struct_fields__", ())
            for attribute in vars(thing):
                if not attribute.startswith("_") and attribute not in described:
                    assert getattr(thing, attribute).__doc__, attribute


def test_every_part_of_a_result_can_be_named_in_an_annotation() -> None:
    parts = {
        name: thing
        for name, thing in vars(_documents).items()
        if inspect.isclass(thing) and issubclass(thing, Record) and thing is not Record
    }
    assert len(parts) > 50
    assert sorted([*parts, "Record", "Result"]) == sorted(umbmark.results.__all__)
    for name, thing in parts.items():
        assert getattr(umbmark.results, name) is thing


def test_the_examples_in_the_docstrings_run() -> None:
    parser, runner = doctest.DocTestParser(), doctest.DocTestRunner()
    for name in umbmark.__all__:
        text = inspect.getdoc(getattr(umbmark, name)) or ""
        runner.run(parser.get_doctest(text, {}, name, None, None))
    tried = runner.summarize()
    assert tried.attempted > 0
    assert tried.failed == 0


def test_another_thread_runs_while_scores_are_computed() -> None:
    """With this switch interval the lock changes hands only where its holder gives it up."""
    errors = np.random.default_rng(1).normal(size=(300_000, 3))
    running, done = threading.Event(), threading.Event()
    count = 0

    def counting() -> None:
        nonlocal count
        while not done.is_set():
            running.set()
            count += 1
            time.sleep(0)

    usual = sys.getswitchinterval()
    sys.setswitchinterval(60)
    try:
        thread = threading.Thread(target=counting)
        thread.start()
        running.wait()
        before = count
        umbmark.score(errors, errors)
        after = count
        done.set()
        thread.join()
    finally:
        done.set()
        sys.setswitchinterval(usual)
    assert after > before


def test_the_import_brings_nothing_heavy_along() -> None:
    heavy = ("numpy", "msgspec", "matplotlib", "pandas", "polars", "distributed", "tqdm", "scipy")
    code = f"import sys, umbmark; print([name for name in {heavy} if name in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert run.stdout == "[]\n"


def test_the_import_costs_little_beside_that_of_numpy() -> None:
    """0.15 s is the aim; on a busy machine what NumPy takes grows as well."""
    code = (
        "import time; began = time.process_time(); import numpy; numpys = time.process_time();"
        "import umbmark; print(numpys - began, time.process_time() - numpys)"
    )
    # The first may compile; it is the least that counts.
    env = {key: of for key, of in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    command = [sys.executable, "-c", code]
    told = [
        subprocess.run(command, check=True, capture_output=True, text=True, env=env)
        for _ in range(5)
    ]
    both = np.array([run.stdout.split() for run in told], float)
    numpys, ours = both.min(axis=0)
    print(f"NumPy {1e3 * numpys:.0f} ms, umbmark {1e3 * ours:.0f} ms more")
    assert ours < 0.45 * numpys
