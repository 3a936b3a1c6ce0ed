"""The files, the sealed answers, and that a seed decides both."""

import csv
import json
from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest
from cases import ALONE, CASES, UNLISTED, Case
from catalogue import OUTSIDE, TYPICAL, acceptable
from generate import main
from measure import NOISE_MODELS, Dataset, Terms, measure
from robot import SQUARE, Path

SHORT = Path("square", {"side_m": 1.5})
CONTRACT = """
wheel_diameter_ratio wheelbase scale crab wheel_eccentricity_left wheel_eccentricity_right
turn_slip turn_slip_rate speed_slip speed_slip_left speed_slip_right acceleration_slip
direction_dependent_wheelbase caster_kick leg_kick backlash floor_slope floor_slope_yaw
carpet_nap diameter_drift centripetal_load missed_counts bumps wheel_noise encoder_skew
encoder_resolution encoder_sampling reference_delay reference_clock_rate marker_offset
marker_yaw start_pose
""".split()


def files(folder: File) -> dict[str, bytes]:
    return {
        str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()
    }


def reference_rows(folder: File) -> list[int]:
    """Rows with a measured pose in each log."""
    logs = sorted((folder / "runs").iterdir())
    rows = [csv.DictReader(log.read_text().splitlines()) for log in logs]
    return [sum(row["x_ref_m"] != "" for row in each) for each in rows]


def measured(case: Case) -> Dataset:
    """A cw and a ccw run."""
    return measure(case, [3], Terms(runs_each=1), "tracks")[0]


def test_every_effect_of_the_catalogue_and_three_outside_it_have_a_case() -> None:
    assert set(ALONE) == set(CONTRACT)
    assert len(UNLISTED) >= 3
    assert not set(UNLISTED) & set(CONTRACT)
    assert len(CASES) >= 24


def test_acceptable_names_are_names_of_the_catalogue_and_hold_the_cause_itself() -> None:
    for name in TYPICAL:
        for level in ("ends", "stops", "tracks"):
            names = acceptable(name, level)
            assert set(names) <= set(CONTRACT)
            assert (name in names) == (name not in OUTSIDE)


@pytest.mark.parametrize(
    "name", [name for name in TYPICAL if name not in ("encoder_sampling", "wheel_noise")]
)
def test_every_cause_changes_what_is_measured(name: str) -> None:
    case = CASES[name]
    path = SHORT if case.path == SQUARE else case.path
    changed = measured(replace(case, path=path, paces=case.paces[-1:]))
    plain = measured(Case(path=path, paces=case.paces[-1:]))
    pairs = zip(changed.runs, plain.runs, strict=True)
    assert any(
        np.abs(a.reference - b.reference).max() > 4e-4 or (a.ticks != b.ticks).any()
        for a, b in pairs
    )


def test_a_seed_decides_every_byte_and_another_seed_changes_them(tmp_path: File) -> None:
    for folder, seed in (("a", "7"), ("b", "7"), ("c", "8")):
        main(["bumps", str(tmp_path / folder / "set"), "--seed", seed, "--runs", "1"])
    a, b, c = (files(tmp_path / folder) for folder in "abc")
    assert a == b
    assert all(a[name] != c[name] for name in a if not name.endswith("robot.toml"))


def test_a_dataset_is_the_same_alone_and_beside_others(tmp_path: File) -> None:
    main(["caster_kick", str(tmp_path / "alone"), "--seed", "12", "--runs", "1"])
    main(["caster_kick", str(tmp_path / "many"), "--seed", "11", "--runs", "1", "--sets", "3"])
    alone, beside = files(tmp_path / "alone"), files(tmp_path / "many" / "0002")
    del alone["robot.toml"], beside["robot.toml"]
    assert alone == beside


def test_the_reference_is_dense_or_at_stops_or_at_ends(tmp_path: File) -> None:
    for kept in ("dense", "stops", "ends"):
        main(["none", str(tmp_path / kept), "--reference", kept, "--runs", "1"])
    assert min(reference_rows(tmp_path / "dense")) > 2000
    assert reference_rows(tmp_path / "stops") == [9, 9]
    assert reference_rows(tmp_path / "ends") == [1, 1]


def test_the_truth_stands_beside_the_folder_and_not_in_it(tmp_path: File) -> None:
    main(["tyre_seam", str(tmp_path / "hidden"), "--runs", "1"])
    truth = json.loads((tmp_path / "hidden.truth.json").read_text())
    assert truth["causes"][0]["kind"] == "outside"
    assert truth["causes"][0]["acceptable"] == []
    assert 0.99 < truth["base"]["e_b"] < 1.01
    assert not any(b"seam" in content for content in files(tmp_path / "hidden").values())


@pytest.mark.parametrize("model", NOISE_MODELS)
def test_nulls_have_no_cause_whatever_their_noise(tmp_path: File, model: str) -> None:
    main(["--nulls", "2", str(tmp_path), "--noise", model, "--runs", "2", "--returns-only"])
    for name in ("0001", "0002"):
        truth = json.loads((tmp_path / f"{name}.truth.json").read_text())
        assert truth["causes"] == []
        assert truth["noise_model"] == model
        assert len((tmp_path / name / "returns.csv").read_text().splitlines()) == 5


def test_encoder_effects_cannot_be_asked_of_returns_only(tmp_path: File) -> None:
    with pytest.raises(ValueError, match="need tracks"):
        main(["encoder_skew", str(tmp_path / "set"), "--returns-only"])
