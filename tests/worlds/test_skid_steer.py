"""A robot that skids in turns is one whose wheels seem further apart: its multiplier is learnt."""

import json
import subprocess
import tomllib
from pathlib import Path as File

import pytest
from files import write
from make import make
from test_gyro import COMMAND, needs_command

MULTIPLIER = 1.8
"""Wheels of the world are so many times as far apart as the sides that are entered, times E_b."""


def command(*words: str | File) -> str:
    done = subprocess.run([COMMAND, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@needs_command
@pytest.mark.parametrize("entered", [1.0, 1.7])
def test_the_multiplier_of_a_skid_steered_robot_is_learnt_from_its_log(
    entered: float, tmp_path: File
) -> None:
    data, model = tmp_path / "data", tmp_path / "model.toml"
    write(make("null", 9600, ["runs=2", "run_s=40"]), data)
    truth = json.loads((data / "truth.json").read_text())
    robot = tomllib.loads((data / "robot.toml").read_text())["robot"]
    track_width_m = robot["wheelbase_m"] / MULTIPLIER
    (data / "robot.toml").write_text(
        f'[robot]\ndrive = "skid_steer"\ntrack_width_m = {track_width_m}\n'
        f"wheel_separation_multiplier = {entered}\n"
        f"wheel_diameter_m = {robot['wheel_diameter_m']}\n"
        f"ticks_per_revolution = {robot['ticks_per_revolution']}\n"
    )
    answer = json.loads(command("solve", data, "-o", model, "--json"))
    assert answer["verdict"] == "explained"
    found = answer["correction"]["wheel_separation_multiplier"]
    true = MULTIPLIER * truth["e_b"]
    assert found["new"] == pytest.approx(true, rel=1e-3)
    # The interval at 95 % reaches to 1.96 standard errors; the truth is within 3.
    assert abs(true - found["new"]) < 3 / 1.96 * (found["high"] - found["low"]) / 2
    text = command("export", model, "--to", "ros2_control", "-o", "-")
    (line,) = (line for line in text.splitlines() if "wheel_separation_multiplier" in line)
    assert float(line.split(":")[1]) == pytest.approx(found["new"], rel=1e-8)
