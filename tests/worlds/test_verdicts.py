"""The command on a few small worlds; `study.py` runs it on hundreds."""

import json
import subprocess
from pathlib import Path as File
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from files import write
from judge import broken, judged
from make import make
from replay import left, read_truth, rms_m
from study import ROOT, Task, ask, shortened, study

COMMAND = ROOT / "target/release/umbmark"
SMALL = ("runs=4", "run_s=30", "reference_rate_hz=20", "layout=same", "kind=random_commands")

pytestmark = pytest.mark.skipif(
    not COMMAND.exists(), reason=f"{COMMAND} is not built (cargo build --release)"
)


def task(world: str, seed: int, *overrides: str) -> Task:
    """A small world."""
    return Task(world, seed, SMALL + overrides, File(COMMAND), None, 300.0)


def found(world: str, seed: int, *overrides: str, inspected: bool = False) -> dict[str, Any]:
    """What `learn` says of a small world, and `inspect` where asked, held against the truth."""
    asked = task(world, seed, *overrides)
    with TemporaryDirectory() as place:
        # The command must not read the answer in the name of the folder.
        folder = File(place) / "data"
        write(make(world, seed, list(asked.overrides)), folder)
        verbs = ("inspect", "learn") if inspected else ("learn",)
        answers = {verb: shortened(verb, ask(asked, verb, str(folder))) for verb in verbs}
        assert not broken(answers), broken(answers)
        return judged(answers, read_truth(folder), rms_m(left(folder)))


@pytest.mark.parametrize(
    "world",
    [
        *("exchanged", "left_reversed", "right_reversed", "left_doubled"),
        *("heading_clockwise", "mirrored", "mm_as_m"),
    ],
)
def test_a_fault_of_columns_or_frames_is_named_and_nothing_is_called_explained(world: str) -> None:
    said = found(world, 1, inspected=True)
    assert said["faults"]
    assert all(said["faults"].values()), said["faults"]
    assert all(said["faults_inspected"].values()), said["faults_inspected"]
    assert said["verdict"] == "not_explained"
    assert (said["added_right"], said["added_wrong"]) == ([], [])


def test_a_robot_that_drives_tail_first_may_be_wired_so_and_is_not_explained() -> None:
    said = found("exchanged_reversed", 1)
    assert all(said["faults"].values()), said["faults"]
    assert said["verdict"] == "not_explained"


def test_wheels_that_follow_commands_late_are_found_with_their_lag_and_sizes() -> None:
    # Taken for a delay, the lag moves E_b by 4 standard errors, and noise grows to hold it.
    said = found("command", 12002)
    assert (said["verdict"], said["added_wrong"]) == ("explained", [])
    assert "wheel_lag" in said["added_right"]
    assert said["delay"]["within"], said["delay"]
    assert all(abs(one["standard_errors"]) < 4 for one in said["ratios"].values()), said["ratios"]


def test_a_lag_longer_than_the_catalogue_has_is_not_explained_by_noise_that_grows(
    tmp_path: File,
) -> None:
    write(make("command", 12002, ["motor_lag_s=1.2"]), tmp_path)
    words = [str(COMMAND), "learn", str(tmp_path), "--json"]
    said = json.loads(subprocess.run(words, capture_output=True, check=True, text=True).stdout)
    assert said["verdict"] == "not_explained"
    assert "absorbed something that the model lacks" in said["reasons"][-1]


def test_a_law_that_no_catalogue_lists_is_added_with_its_period(tmp_path: File) -> None:
    made = make("time_wave", 3, [*SMALL, "wave_period_s=7.3", "wave_rad_s=0.02"])
    write(made, tmp_path)
    words = [str(COMMAND), "learn", str(tmp_path), "--json"]
    said = json.loads(subprocess.run(words, capture_output=True, check=True, text=True).stdout)
    assert said["verdict"] == "unlisted_effect"
    before, last = said["steps"][-2:]
    assert last["added"] == "periodic_yaw"
    assert (last["law"]["motion"], last["law"]["per"]) == ("yaw", "second")
    period = next(one for one in said["fitted"] if one["parameter"] == "c")
    assert period["value"] == pytest.approx(7.3, rel=0.01)
    assert last["heldout_rmse_m"] < 0.5 * before["heldout_rmse_m"]
    assert all(law["heldout_rmse_with_law_m"] > 0 for law in last["law"]["others"])


@pytest.mark.parametrize("delay_s", [-0.12, 0.06])
def test_a_delay_is_found_with_its_sign(delay_s: float) -> None:
    said = found("delay", 2, f"delay_s={delay_s}")
    assert said["delay"]["within"], said["delay"]


def test_runs_whose_poses_have_clocks_of_their_own_are_laid_on_them() -> None:
    said = found("clocks", 2, "delay_scatter_s=0.15")
    assert (said["verdict"], said["added_wrong"]) == ("explained", [])
    assert said["delay"]["within"], said["delay"]
    assert all(abs(one["standard_errors"]) < 4 for one in said["ratios"].values()), said["ratios"]


@pytest.mark.parametrize(
    ("world", "size", "effect"),
    [
        ("body_slip", "body_slip_s_m=0.06", "body_speed_slip"),
        ("forward_slip", "forward_slip_s_m=0.06", "forward_slip"),
        ("null", "squared_slip_s2_m2=0.15", "squared_speed_slip"),
        ("null", "squared_forward_slip_s2_m2=0.15", "squared_forward_slip"),
    ],
)
def test_slip_is_told_by_whose_speed_it_grows_and_by_its_power(
    world: str, size: str, effect: str
) -> None:
    said = found(world, 2, size, "run_s=60")
    assert (said["verdict"], said["added_wrong"]) == ("explained", [])
    assert effect in said["added_right"]
    assert all(abs(one["standard_errors"]) < 4 for one in said["ratios"].values()), said["ratios"]


def test_a_filter_of_the_reference_is_found_and_the_robot_keeps_its_size() -> None:
    # Taken for wheels that follow late, it moves E_b and E_s by more than a per cent.
    said = found("low_pass", 2, "filter_s=0.3")
    assert (said["verdict"], said["added_wrong"]) == ("explained", [])
    assert "reference_filter" in said["added_right"]
    assert said["delay"]["within"], said["delay"]
    assert all(abs(one["standard_errors"]) < 4 for one in said["ratios"].values()), said["ratios"]


@pytest.mark.parametrize("world", ["jumps", "carried", "spinning"])
def test_jumps_are_named_and_the_robot_is_not_blamed(world: str) -> None:
    said = found(world, 3)
    assert said["jumps"]["there"] > 0
    assert said["jumps"]["named"] == said["jumps"]["there"]
    assert all(abs(one["standard_errors"]) < 4 for one in said["ratios"].values())


def test_headings_that_drift_beside_positions_are_doubted_and_positions_alone_are_explained(
    tmp_path: File,
) -> None:
    drifting = [*SMALL, "heading_walk_rad_sqrt_s=0.01", "run_s=60"]
    said = {}
    for name, more in [("with", []), ("without", ["has_heading=false"])]:
        write(make("heading_walk", 2, drifting + more), tmp_path / name)
        words = [str(COMMAND), "learn", str(tmp_path / name), "--json"]
        told = subprocess.run(words, capture_output=True, check=True, text=True).stdout
        said[name] = json.loads(told)
    assert said["with"]["verdict"] == "not_explained"
    assert any("the measured headings wander by" in one for one in said["with"]["reasons"])
    assert said["without"]["verdict"] == "explained"


def test_axes_of_unequal_scale_are_named_and_leave_the_scale_open(tmp_path: File) -> None:
    write(make("stretched", 3, [*SMALL, "stretch_along=0.008", "run_s=60"]), tmp_path)
    words = [str(COMMAND), "learn", str(tmp_path), "--json"]
    learnt = json.loads(subprocess.run(words, capture_output=True, check=True, text=True).stdout)
    assert "reference_stretch" in [step["added"] for step in learnt["steps"]]
    assert learnt["verdict"] == "not_explained"
    assert any("E_s and E_b may be 0." in reason for reason in learnt["reasons"])
    assert learnt["sentence"].endswith("do not write the new numbers below into the robot yet.")


def test_poses_that_were_filled_in_are_left_out_and_the_robot_is_explained() -> None:
    said = found("filled_in", 2, "filled_in_poses=6", "run_s=60")
    assert (said["verdict"], said["added_wrong"]) == ("explained", [])
    assert all(abs(one["standard_errors"]) < 4 for one in said["ratios"].values()), said["ratios"]


def test_what_jumps_leave_is_not_called_chance(tmp_path: File) -> None:
    small = [*SMALL, "run_s=60", "jump_m=0.006,0.012", "jump_rad=0.01,0.03"]
    write(make("jumps", 5, [*small, "position_noise_m=0.001"]), tmp_path)
    words = [str(COMMAND), "solve", str(tmp_path), "--json"]
    solved = json.loads(subprocess.run(words, capture_output=True, check=True, text=True).stdout)
    assert "4 jumps that only the fit shows make a part" in solved["sentence"], solved["sentence"]
    assert "no more than chance" not in solved["sentence"]
    assert any(step.startswith("Find the cause of") for step in solved["next"]), solved["next"]


def test_a_filter_and_an_early_reference_that_only_smooth_the_counts_are_not_added(
    tmp_path: File,
) -> None:
    # Counts of 3.5 mm beside poses of 0.5 mm: a mean of the poses over 0.1 s would be nearer.
    write(make("gaps", 9102, []), tmp_path)
    words = [str(COMMAND), "learn", str(tmp_path), "--json"]
    learnt = json.loads(subprocess.run(words, capture_output=True, check=True, text=True).stdout)
    added = [step["added"] for step in learnt["steps"]]
    assert added == [None, "wheel_diameter_ratio", "wheelbase", "scale"]
    assert learnt["verdict"] == "explained"


def test_a_delay_of_the_motion_gives_way_to_the_filter_that_is_there(tmp_path: File) -> None:
    # Beside a delay of -77 ms, 138 % of the poses would be filtered.
    write(make("low_pass", 9104, []), tmp_path)
    truth = json.loads((tmp_path / "truth.json").read_text())
    words = [str(COMMAND), "learn", str(tmp_path), "--json"]
    learnt = json.loads(subprocess.run(words, capture_output=True, check=True, text=True).stdout)
    added = [step["added"] for step in learnt["steps"]]
    assert added == [None, "wheel_diameter_ratio", "wheelbase", "scale", "reference_filter"]
    assert learnt["verdict"] == "explained"
    kept = next(one for one in learnt["model"]["effect"] if one["name"] == "reference_filter")
    assert (kept["share"], kept["fixed"]) == (1.0, ["share"])
    fitted = {one["parameter"]: one for one in learnt["fitted"]}
    time = truth["numbers"]["reference"]["filter_s"]
    for name, true in [("e_b", truth["e_b"]), ("e_s", truth["e_s"]), ("time_constant_s", time)]:
        assert abs(fitted[name]["value"] - true) < 3 * fitted[name]["standard_error"], fitted[name]


def test_a_filter_that_two_runs_cannot_certify_is_a_reason_for_doubt(tmp_path: File) -> None:
    # A delay leaves 15 mm where the filter that is there leaves 4.5, which two runs cannot certify.
    write(make("low_pass", 9107, []), tmp_path)
    words = [str(COMMAND), "learn", str(tmp_path), "--json"]
    learnt = json.loads(subprocess.run(words, capture_output=True, check=True, text=True).stdout)
    assert learnt["verdict"] == "not_explained"
    assert any(
        "predicted 71 % better with wheel_lag or reference_filter" in reason
        for reason in learnt["reasons"]
    )


def test_a_true_model_is_not_compared_beside_a_clock_that_the_drive_hardly_shows(
    tmp_path: File,
) -> None:
    # The motion alone says 0.64 s late and 1800 ppm slow, which carries whole runs 21 mm away.
    write(make("no_heading", 9202, []), tmp_path)
    truth = json.loads((tmp_path / "truth.json").read_text())
    values = {"wheel_diameter_ratio": "e_d", "scale": "e_s"}
    model = tmp_path / "model.toml"
    effects = (f'[[effect]]\nname = "{name}"\n{e} = {truth[e]}\n' for name, e in values.items())
    model.write_text("\n".join(effects))
    words = [str(COMMAND), "compare", str(tmp_path), "--model", str(model), "--json"]
    compared = json.loads(subprocess.run(words, capture_output=True, check=True, text=True).stdout)
    assert compared["models"][0]["taken"] == []
    assert compared["models"][0]["along"]["rmse_m"] < 0.001


def test_turns_on_the_spot_show_the_wheelbase_beside_a_scale_that_is_kept(tmp_path: File) -> None:
    # Counts of 1.4 mm make ways that the robot does not drive: E_s would be 0.2, and E_b with it.
    write(make("spins", 9101, []), tmp_path)
    truth = json.loads((tmp_path / "truth.json").read_text())
    words = [str(COMMAND), "fit", str(tmp_path), "--json"]
    told = json.loads(subprocess.run(words, capture_output=True, check=True, text=True).stdout)
    assert told["not_shown"] == ["scale"]
    e_b = next(one for one in told["fitted"] if one["parameter"] == "e_b")
    off = e_b["value"] - truth["e_b"] / truth["e_s"]
    assert abs(off) < 4 * e_b["standard_error"] < 1e-3
    words[1] = "learn"
    learnt = json.loads(subprocess.run(words, capture_output=True, check=True, text=True).stdout)
    added = [step["added"] for step in learnt["steps"]]
    assert added == [None, "wheel_diameter_ratio", "wheelbase"]


def test_where_nothing_is_hidden_nothing_is_accused() -> None:
    row = study(task("null", 4))
    said = judged(row["answers"], row["truth"], row["truth_leaves_m"])
    assert (said["verdict"], said["added_wrong"]) == ("explained", [])
    assert said["problems"] == []
