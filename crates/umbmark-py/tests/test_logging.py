"""What goes to the log: nothing unasked; long work, mended data; warnings of classes of our own."""

import logging
import subprocess
import sys
from pathlib import Path

import pytest
import umbmark
from umbmark._progress import Bar

MODEL = umbmark.Model().add("wheel_noise", k_sqrt_m=1e-3)


def test_nothing_is_printed_unless_a_program_asks_for_it(rolled: Path) -> None:
    code = f"import umbmark; umbmark.score({str(rolled)!r})"
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert (run.stdout, run.stderr) == ("", "")
    assert any(isinstance(h, logging.NullHandler) for h in logging.getLogger("umbmark").handlers)


def test_the_end_of_long_work_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, "umbmark"):
        umbmark.monte_carlo(MODEL, n=20)
        umbmark.sweep(MODEL, {"eb": (0.99, 1.01, 3)}, n=5)
    assert [record.name for record in caplog.records] == 2 * ["umbmark.progress"]
    trials, points = (record.getMessage() for record in caplog.records)
    assert trials.startswith("20 of 20 trials in ")
    assert points.startswith("3 of 3 points in ")


def test_long_work_has_a_line_every_ten_seconds(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [100.0]
    monkeypatch.setattr("umbmark._progress.time.monotonic", lambda: now[0])
    with caplog.at_level(logging.INFO, "umbmark"), Bar(None, 100, "trials") as bar:
        for done in range(1, 26):
            now[0] += 1.0
            bar.at(done)
    said = [record.getMessage() for record in caplog.records]
    assert said == [f"{done} of 100 trials in {done}.0 s" for done in (10, 20, 25)]


@pytest.fixture
def rolled(tmp_path: Path) -> Path:
    """Return a dataset in files whose counters roll over."""
    robot = umbmark.Robot.labmate()
    text = robot.to_toml().replace("[robot]", "[robot]\ncounter_bits = 12")
    model = umbmark.Model(umbmark.Robot.from_toml(text)).add("wheelbase", e_b=1.01)
    umbmark.simulate(model, umbmark.Path(side_m=1.0), runs=2).save(tmp_path / "robot")
    assert umbmark.load_dataset(tmp_path / "robot").warnings
    return tmp_path / "robot"


def test_what_was_mended_in_files_is_logged(rolled: Path, caplog: pytest.LogCaptureFixture) -> None:
    umbmark.score(rolled)
    expected = [f"{rolled}: {said}" for said in umbmark.load_dataset(rolled).warnings]
    assert [record.getMessage() for record in caplog.records] == expected
    assert {(record.name, record.levelname) for record in caplog.records} == {
        ("umbmark.data", "WARNING")
    }


def test_warnings_are_of_one_class_of_this_package() -> None:
    assert issubclass(umbmark.ConversionWarning, umbmark.UmbmarkWarning)
    assert issubclass(umbmark.UmbmarkWarning, UserWarning)
    robot = umbmark.Robot(wheelbase_m=0.5, wheel_diameter_m=0.2, ticks_per_revolution=2000)
    text = umbmark.Model().add("wheelbase", e_b=1.01).to_toml()
    with pytest.warns(umbmark.UmbmarkWarning):
        umbmark.Model.from_toml(text, robot)
