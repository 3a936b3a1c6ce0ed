"""Which numbers of a robot depend on the conditions of its runs."""

import pickle
from pathlib import Path

import numpy as np
import pytest
import umbmark


def driven(e_b: float, seed: int) -> umbmark.Dataset:
    robot = umbmark.Model().add("wheel_noise", k_sqrt_m=2e-4).add("wheelbase", e_b=e_b)
    return umbmark.simulate(robot, reference_rate_hz=0, seed=seed)


def two_floors() -> umbmark.Dataset:
    """Five runs each way on tile, and as many on felt."""
    tile, felt = driven(1.0, 1), driven(1.01, 2)
    cw, ccw = ([*tile.returns(way), *felt.returns(way)] for way in ("cw", "ccw"))
    return umbmark.Dataset.from_arrays(cw, ccw, robot=tile.robot, path=tile.path)


def test_a_floor_is_named_its_interval_holds_the_truth_and_print_gives_the_text(
    tmp_path: Path,
) -> None:
    floors = (["tile"] * 5 + ["felt"] * 5) * 2
    data = two_floors().with_conditions(floor=floors, load_kg=np.zeros(20))
    found = umbmark.conditions(data)
    assert found.differs
    assert found.same == ("load_kg",)
    assert [(n.key, n.depends_on) for n in found.numbers] == [
        ("wheel_diameter_ratio.e_d", ()),
        ("wheelbase.e_b", ("floor",)),
    ]
    asked = next(one for one in found.asked if one.differs)
    assert asked.largest is not None
    assert asked.largest.high == "felt"
    low, high = asked.largest.by.interval or (0.0, 0.0)
    assert low < 0.01 < high
    assert str(found) == found.text.rstrip()
    assert found.table()[0]["level"] == "tile"
    assert pickle.loads(pickle.dumps(found)) == found
    data.save(tmp_path / "data")
    assert umbmark.conditions(tmp_path / "data").asked[1].p == asked.p


def test_conditions_are_kept_by_runs_replaced_by_name_and_bad_ones_are_named() -> None:
    data = umbmark.Dataset.from_arrays([[0.1, 0.2, 0.0]] * 3, robot=umbmark.Robot.labmate())
    stated = data.with_conditions(floor=["tile", None, "felt"], load_kg=[1, 2.5, float("nan")])
    assert stated.conditions == {
        "floor": ["tile", None, "felt"],
        "load_kg": [1.0, 2.5, None],
    }
    assert stated != data
    assert data.conditions == {}
    assert pickle.loads(pickle.dumps(stated)) == stated
    assert stated[2:].conditions == {"floor": ["felt"]}
    assert stated.with_conditions(floor="stone").conditions["floor"] == ["stone"] * 3
    with pytest.raises(ValueError, match="floor must have one value for each of 3 runs, got 2"):
        data.with_conditions(floor=["tile", "felt"])
    with pytest.raises(ValueError, match="load_kg must be finite, got inf"):
        data.with_conditions(load_kg=float("inf"))
    with pytest.raises(TypeError, match="floor must be words or numbers"):
        data.with_conditions(floor=[object()] * 3)  # type: ignore[list-item]
    with pytest.raises(umbmark.FitError, match="nothing is stated of the conditions of the runs"):
        umbmark.conditions(two_floors())
    with pytest.raises(ValueError, match="size"):
        umbmark.conditions(stated, size=2)


def test_a_learnt_model_is_held_against_floors_that_were_left_out() -> None:
    floors = (["tile"] * 5 + ["felt"] * 5) * 2
    learnt = umbmark.learn(two_floors().with_conditions(floor=floors), draws=99)
    assert [condition.names for condition in learnt.conditions] == [("floor",)]
    assert set(learnt.conditions[0].levels) == {"tile", "felt"}
    assert learnt.untested == "other paths, speeds and loads than those of these runs"
    assert learnt.verdict == "not_explained"
    assert any("its numbers depend on the floor" in reason for reason in learnt.reasons)
    row = learnt.table()[-1]
    assert row["by_floor_rmse_m"] == learnt.steps[-1].elsewhere_rmse_m[0]
    assert row["by_floor_rmse_m"] > 1.5 * row["heldout_rmse_m"]
    legend = learnt.plot().get_legend()
    assert legend is not None
    labels = [text.get_text() for text in legend.get_texts()]
    assert labels == ["runs fitted to", "runs left out", "runs of each floor left out"]
    assert list(learnt.to_pandas()["by_floor_rmse_m"])[-1] == row["by_floor_rmse_m"]
