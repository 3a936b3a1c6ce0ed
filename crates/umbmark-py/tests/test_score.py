"""`umbmark.score` against NumPy code of its own.

| paper, equation                 | here            | umbmark                              |
|---------------------------------|-----------------|--------------------------------------|
| 1, absolute - computed          | `return_errors` | what `score` takes                   |
| 2, centre of gravity            | `centroid`      | `centroid_cw_m`, `.._ccw_m`          |
| 3 and 4, E_max,sys              | `e_max_sys`     | `e_max_sys_m`                        |
| section 3.3, sigma              | `sigma`         | `sigma_m`                            |
| 5, orientation error with bumps | `eq_5`          | `nonsys_orientation_sum_rad`, or     |
|                                 |                 | half of it, `nonsys_orientation_rad` |
| 6, mean return heading          | `mean_heading`  | `return_heading_cw_rad`, `.._ccw_..` |

The paper numbers only Eqs. 1, 5 and 6; 2 to 4 are the displays between them.
"""

import re
from pathlib import Path
from typing import Any

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
import umbmark
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Values are of order 10 m and 1 rad.
TOLERANCE = 1e-12


def return_errors(absolute: Array, computed: Array) -> Array:
    return absolute - computed


def centroid(errors: Array) -> Array:
    mean: Array = errors[:, :2].mean(axis=0)
    return mean


def e_max_sys(cw: Array, ccw: Array) -> float:
    return float(max(np.hypot(*centroid(cw)), np.hypot(*centroid(ccw))))


def sigma(cw: Array, ccw: Array) -> float:
    squares = sum(((errors[:, :2] - centroid(errors)) ** 2).sum() for errors in (cw, ccw))
    return float(np.sqrt(squares / (2 * (len(cw) + len(ccw) - 2))))


def turned(angle: Any) -> Any:
    """The same direction in (-pi, pi], by way of the complex plane."""
    return np.angle(np.exp(1j * angle))


def mean_heading(errors: Array) -> float:
    return float(errors[:, 2].mean())


def eq_5(bumps: tuple[Array, Array], systematic: tuple[float, float]) -> float:
    return float(
        sum(
            np.abs(turned(errors[:, 2] - s)).mean()
            for errors, s in zip(bumps, systematic, strict=True)
        )
    )


def runs(fewest: int = 2, heading: float = 0.7) -> st.SearchStrategy[Array]:
    """Return errors of a direction; headings within `heading` of zero, away from the cut."""
    positions = st.floats(-10, 10)
    shape = st.integers(fewest, 8)
    rows = st.tuples(positions, positions, st.floats(-heading, heading))
    return shape.flatmap(lambda n: st.lists(rows, min_size=n, max_size=n)).map(np.array)


def known(value: float | None) -> float:
    assert value is not None
    return value


@given(absolute=runs(), computed=runs(), ccw=runs())
def test_centroids_e_max_sys_sigma_and_headings_are_those_of_numpy(
    absolute: Array, computed: Array, ccw: Array
) -> None:
    n = min(len(absolute), len(computed))
    cw = return_errors(absolute[:n], computed[:n])
    result = umbmark.score(cw, ccw)
    assert (result.n_cw, result.n_ccw) == (len(cw), len(ccw))
    assert result.centroid_cw_m == pytest.approx(centroid(cw), abs=TOLERANCE)
    assert result.centroid_ccw_m == pytest.approx(centroid(ccw), abs=TOLERANCE)
    assert result.e_max_sys_m == pytest.approx(e_max_sys(cw, ccw), abs=TOLERANCE)
    assert result.sigma_m == pytest.approx(sigma(cw, ccw), abs=TOLERANCE)
    assert result.return_heading_cw_rad == pytest.approx(mean_heading(cw), abs=TOLERANCE)
    assert result.return_heading_ccw_rad == pytest.approx(mean_heading(ccw), abs=TOLERANCE)


@given(cw=runs(), ccw=runs(), bumps_cw=runs(1, 3.0), bumps_ccw=runs(1, 3.0))
def test_the_orientation_error_with_bumps_is_that_of_numpy(
    cw: Array, ccw: Array, bumps_cw: Array, bumps_ccw: Array
) -> None:
    result = umbmark.score(cw, ccw, bumps_cw=bumps_cw, bumps_ccw=bumps_ccw)
    expected = eq_5((bumps_cw, bumps_ccw), (mean_heading(cw), mean_heading(ccw)))
    as_printed = umbmark.score(cw, ccw, bumps_cw=bumps_cw, bumps_ccw=bumps_ccw, convention="sum")
    assert as_printed.nonsys_orientation_rad == pytest.approx(expected, abs=TOLERANCE)
    assert result.nonsys_orientation_rad == pytest.approx(expected / 2, abs=TOLERANCE)
    assert umbmark.score(cw, ccw).e_max_sys_m == result.e_max_sys_m


# Table II of the paper, degrees: systematic means cw and ccw, the runs, and what the table prints.
TABLE_II = {
    "LabMate": (
        (0.28, -2.03),
        (7.10, 6.40, 5.60, 6.60, 5.90),
        (-7.50, -8.80, -6.60, -8.80, -8.70),
        6.045,
    ),
    "Cybermotion": (
        (3.77, 0.97),
        (7.78, 4.17, 1.72, 4.23, 3.55),
        (-11.35, -2.48, -4.61, -6.34, -2.31),
        3.908,
    ),
    "CLAPPER": (
        (-0.2, -0.14),
        (0.10, 0.10, 0.10, -0.70, 0.20),
        (-0.60, -0.40, -0.50, 0.10, 0.20),
        0.346,
    ),
}


def headings(degrees: tuple[float, ...]) -> Array:
    return np.column_stack([np.zeros((len(degrees), 2)), np.radians(degrees)])


@pytest.mark.parametrize("robot", TABLE_II)
def test_table_ii_follows_the_mean_and_twice_that_is_eq_5_as_printed(robot: str) -> None:
    (systematic_cw, systematic_ccw), cw, ccw, mean = TABLE_II[robot]
    for convention, times in (("mean", 1), ("sum", 2)):
        result = umbmark.score(
            headings((systematic_cw,)),
            headings((systematic_ccw,)),
            bumps_cw=headings(cw),
            bumps_ccw=headings(ccw),
            convention=convention,
        )
        orientation = np.degrees(known(result.nonsys_orientation_rad))
        assert orientation == pytest.approx(times * mean, abs=1e-9)


CW = np.array([[-0.21, -0.19, -0.05], [-0.19, -0.21, -0.06], [-0.20, -0.23, -0.04]])
CCW = np.array([[0.02, 0.01, 0.01], [0.01, -0.02, 0.02], [0.00, -0.02, 0.00]])


@given(cw=runs(3), level=st.floats(0.01, 0.999))
def test_intervals_hold_the_estimate_and_the_noise_band_has_its_closed_form(
    cw: Array, level: float
) -> None:
    ccw = cw[::-1] * [-1.0, 0.5, 0.3]
    result = umbmark.score(cw, ccw, level=level)
    assert result.level == level
    low, high = result.e_max_sys_interval_m or (np.inf, -np.inf)
    assert low <= known(result.e_max_sys_m) + TOLERANCE
    assert high >= known(result.e_max_sys_m) - TOLERANCE
    # Both of two centres within r: (1 - exp(-n r^2 / 2 sigma^2))^2 = level.
    band = sigma(cw, ccw) * np.sqrt(-2 * np.log1p(-np.sqrt(level)) / len(cw))
    assert result.noise_band_m == pytest.approx(band, rel=1e-9, abs=TOLERANCE)


def test_sigma_lies_within_its_interval_and_a_higher_level_widens_it() -> None:
    def width(level: float) -> float:
        result = umbmark.score(CW, CCW, level=level)
        low, high = result.sigma_interval_m or (np.inf, -np.inf)
        assert low < known(result.sigma_m) < high
        return high - low

    assert width(0.5) < width(0.95) < width(0.99)


def test_headings_not_measured_are_left_out_whether_nan_or_no_column() -> None:
    some = CW.copy()
    some[1, 2] = np.nan
    assert umbmark.score(some, CCW).return_heading_cw_rad == pytest.approx(-0.045, abs=TOLERANCE)
    none = CW.copy()
    none[:, 2] = np.nan
    result = umbmark.score(none, CCW)
    assert result.return_heading_cw_rad is None
    assert result == umbmark.score(CW[:, :2], CCW)
    assert result.e_max_sys_m == umbmark.score(CW, CCW).e_max_sys_m


def test_bumps_without_headings_have_no_orientation_error_and_the_warning_says_so() -> None:
    result = umbmark.score(CW, CCW, bumps_cw=CW[:, :2], bumps_ccw=CCW)
    assert result.nonsys_orientation_rad is None
    assert result.nonsys_orientation_interval_rad is None
    assert "Eq. 5 needs return headings of both directions" in result.warnings[0]


def test_bumps_that_turn_the_robot_the_wrong_way_are_pointed_out() -> None:
    turn = np.array([0.0, 0.0, 0.1])
    right = umbmark.score(CW, CCW, bumps_cw=CW - turn, bumps_ccw=CCW + turn)
    assert right.warnings == ()
    low, high = right.nonsys_orientation_interval_rad or (np.inf, -np.inf)
    assert low < 0.1 < high
    wrong = umbmark.score(CW, CCW, bumps_cw=CW + turn, bumps_ccw=CCW + turn)
    assert "the cw runs turned the other way" in wrong.warnings[0]


def test_one_direction_alone_has_a_centroid_and_no_e_max_sys() -> None:
    result = umbmark.score(CW, np.empty((0, 3)))
    assert result.centroid_cw_m == pytest.approx((-0.2, -0.21), abs=TOLERANCE)
    assert (result.e_max_sys_m, result.centroid_ccw_m, result.n_ccw) == (None, None, 0)
    assert (result.e_max_sys_interval_m, result.noise_band_m) == (None, None)
    assert result.return_heading_ccw_rad is None
    assert "no counter-clockwise (ccw) runs" in result.warnings[0]
    assert result.sigma_interval_m is not None


def test_two_runs_a_direction_have_no_intervals() -> None:
    result = umbmark.score(CW[:2], CCW[:2])
    assert (result.e_max_sys_interval_m, result.sigma_interval_m) == (None, None)
    assert result.noise_band_m is None
    assert "got 2 cw and 2 ccw" in result.warnings[0]


NO_Y = np.array([1.0, np.nan, 1.0])
NO_HEADING = np.array([0.0, 0.0, np.inf])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((CW[:0], CCW[:0]), "none of 0 runs has both a direction (cw or ccw) and a return error"),
        ((CW, CCW + np.inf), "return error of run ccw[0] must be finite, got (inf, inf) m"),
        ((CW * NO_Y, CCW), "return error of run cw[0] must be finite, got (-0.21, NaN) m"),
        ((CW, CCW - NO_HEADING), "return error of run ccw[0] must be finite, got (0.02, 0.01) m"),
        ((CW, CCW[0]), "ccw must have shape (n, 3), or (n, 2) without heading, got"),
        ((CW, CCW[0]), "got shape (3,)"),
        ((CW[:, :1], CCW), "got shape (3, 1)"),
        ((CW[None], CCW), "got shape (1, 3, 3)"),
    ],
)
def test_data_that_cannot_be_scored_is_a_value_error_in_the_words_of_the_core(
    arguments: tuple[Array, Array], words: str
) -> None:
    with pytest.raises(ValueError, match=re.escape(words)):
        umbmark.score(*arguments)


@pytest.mark.parametrize("level", [0.0, 1.0, -0.5, 95, np.nan])
def test_an_impossible_level_is_a_value_error_with_its_value(level: float) -> None:
    with pytest.raises(ValueError, match="between 0 and 1, both excluded, got") as caught:
        umbmark.score(CW, CCW, level=level)
    assert str(caught.value).lower().endswith(f"got {level:g}")


def test_a_run_that_is_no_number_is_named_by_its_row() -> None:
    broken = CCW.copy()
    broken[2, 0] = np.nan
    with pytest.raises(ValueError, match=r"run bumps_ccw\[2\] must be finite"):
        umbmark.score(CW, CCW, bumps_cw=CW, bumps_ccw=broken)


@pytest.mark.parametrize(
    ("value", "got"),
    [
        (
            None,
            "cw must be numbers of shape (n, 3), or (n, 2) without heading, got None (NoneType)",
        ),
        (1.0, "got 1.0 (float)"),
        (np.ma.masked_less(CW, -0.2), "cw must not be masked"),
    ],
)
def test_what_holds_no_rows_of_numbers_is_a_type_error_that_says_what_it_is(
    value: Any, got: str
) -> None:
    with pytest.raises(TypeError, match=re.escape(got)):
        umbmark.score(value, CCW)


def test_any_memory_layout_is_read_and_left_as_it_was() -> None:
    expected = umbmark.score(CW, CCW)
    wide = np.zeros((6, 5))
    wide[::2, 1:4] = CW
    unaligned = np.zeros(CW.nbytes + 1, np.uint8)[1:].view(np.float64).reshape(CW.shape)
    unaligned[:] = CW
    assert not unaligned.flags.aligned
    locked = CW.copy()
    locked.flags.writeable = False
    for same in (np.asfortranarray(CW), wide[::2, 1:4], CW[::-1][::-1], unaligned, locked):
        assert umbmark.score(same, CCW) == expected
        np.testing.assert_array_equal(same, CW)


FINITE = st.floats(allow_nan=False, allow_infinity=False)
ANY_RUNS = hnp.arrays(
    np.float64, st.tuples(st.integers(0, 6), st.sampled_from([2, 3])), elements=FINITE
)


@given(
    cw=ANY_RUNS,
    ccw=ANY_RUNS,
    bumps_cw=st.none() | ANY_RUNS,
    bumps_ccw=st.none() | ANY_RUNS,
    level=st.floats(0, 1, exclude_min=True, exclude_max=True),
)
def test_any_finite_floats_are_scored_and_no_run_at_all_is_a_value_error(
    cw: Array, ccw: Array, bumps_cw: Array | None, bumps_ccw: Array | None, level: float
) -> None:
    def scored() -> umbmark.Score:
        return umbmark.score(cw, ccw, bumps_cw=bumps_cw, bumps_ccw=bumps_ccw, level=level)

    if len(cw) + len(ccw) == 0:
        with pytest.raises(ValueError, match="runs has both a direction"):
            scored()
        return
    result = scored()
    assert (result.n_cw, result.n_ccw) == (len(cw), len(ccw))
    assert repr(result).startswith("Score(\n")


def test_scores_are_compared_by_value_and_cannot_be_changed() -> None:
    result = umbmark.score(CW, CCW)
    assert result == umbmark.score(CW, CCW)
    assert result != umbmark.score(CW, CCW, level=0.9)
    with pytest.raises(AttributeError, match="immutable"):
        result.e_max_sys_m = 0.0  # type: ignore[misc]


def test_the_repr_shows_what_is_known_with_six_digits() -> None:
    assert repr(umbmark.score(CW[:1], np.array([[1 / 3, 2e-9, -1.23456789]]))) == (
        "Score(\n"
        "    e_max_sys_m=0.333333,\n"
        "    n_cw=1,\n"
        "    centroid_cw_m=(-0.21, -0.19),\n"
        "    return_heading_cw_rad=-0.05,\n"
        "    n_ccw=1,\n"
        "    centroid_ccw_m=(0.333333, 2e-09),\n"
        "    return_heading_ccw_rad=-1.23457,\n"
        "    n_bumps_cw=0,\n"
        "    n_bumps_ccw=0,\n"
        "    level=0.95,\n"
        "    setup=Setup(),\n"
        "    warnings=('No intervals: 3 or more runs a direction are needed, got 1 cw and 1 ccw. "
        "The paper drives 5.',),\n"
        f"    version='{umbmark.__version__}',\n"
        ")"
    )


def test_several_places_are_scored_as_one_dataset(tmp_path: Path) -> None:
    cw, ccw = np.zeros((3, 3)), np.full((3, 3), 0.1)
    places = [tmp_path / "one", tmp_path / "two"]
    for place in places:
        umbmark.Dataset.from_arrays(cw, ccw, robot=umbmark.Robot.labmate()).save(place)
    found = umbmark.score(places)
    assert found == umbmark.score(umbmark.load_dataset(places))
    assert found == umbmark.score([str(place) for place in places])
    assert found.n_cw == 6


def test_arrays_beside_a_dataset_are_refused(tmp_path: Path) -> None:
    robot = umbmark.Robot.labmate()
    data = umbmark.Dataset.from_arrays(np.zeros((3, 3)), np.full((3, 3), 0.1), robot=robot)
    data.save(tmp_path)
    scored: Any
    for scored in (data, tmp_path, str(tmp_path), [tmp_path]):
        with pytest.raises(TypeError, match="ccw goes with return errors in arrays, but the first"):
            umbmark.score(scored, np.ones((3, 3)))
        with pytest.raises(TypeError, match="bumps_cw goes with return errors in arrays"):
            umbmark.score(scored, bumps_cw=np.ones((3, 3)))  # type: ignore[call-overload]
