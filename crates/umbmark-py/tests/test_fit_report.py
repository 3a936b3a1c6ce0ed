"""A fit as text: the numbers of the result, rounded, and the residuals in mm and deg."""

import re
from typing import Any

import numpy as np
import pytest
import umbmark

PATH = umbmark.Path(side_m=1.0)
TRUTH = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=3e-4)
TRUTH = TRUTH.add("floor_slope", drift_x=0.01)


@pytest.fixture(scope="module")
def watched() -> umbmark.Dataset:
    """Return a robot on a slope that was watched."""
    noisy = TRUTH.add("reference_noise", position_sd_m=5e-4, heading_sd_rad=5e-4)
    return umbmark.simulate(noisy, PATH, runs=3, reference_rate_hz=5)


def test_a_report_of_a_fit_has_its_parameters_in_the_units_of_the_catalogue(
    watched: umbmark.Dataset,
) -> None:
    fitted = umbmark.fit(watched, add=["floor_slope"])
    lines = fitted.fit_report().splitlines()
    assert lines[0] == f"{len(fitted.fitted)} parameters, 6 runs"
    for estimate, line in zip(fitted.fitted, lines[3:], strict=False):
        name, value, error, low, _, high, *unit = line.split()
        assert name == f"{estimate.effect}.{estimate.parameter}"
        assert estimate.standard_error is not None
        assert estimate.interval is not None
        exact = (estimate.value, estimate.standard_error, *estimate.interval)
        for told, of in zip((value, error, low, high), exact, strict=True):
            # Two digits of the standard error.
            assert abs(float(told) - of) <= 0.06 * estimate.standard_error
        known = {p.name: p.unit for p in umbmark.effects()[estimate.effect].parameters}
        assert unit == [known[estimate.parameter]] * bool(known[estimate.parameter])


def test_the_covariance_has_the_standard_errors_and_the_correlations(
    watched: umbmark.Dataset,
) -> None:
    for result in (
        umbmark.fit(watched, add=["floor_slope"]),
        umbmark.diagnose(watched, draws=99),
        umbmark.learn(watched, draws=99),
        umbmark.solve(watched, draws=99),
    ):
        errors = [estimate.standard_error for estimate in result.fitted]
        count = len(errors)
        assert result.covariance.shape == (count, count)
        assert np.sqrt(np.diag(result.covariance)) == pytest.approx(errors)
        assert (np.linalg.eigvalsh(np.array(result.correlations)) > 0).all()


def test_a_covariance_that_the_data_do_not_show_is_nan() -> None:
    once = umbmark.fit(umbmark.simulate(TRUTH, PATH, runs=1, reference_rate_hz=0))
    assert np.isnan(once.covariance).all()


def test_a_parameter_that_is_fixed_keeps_its_value_and_the_others_make_up_for_it(
    watched: umbmark.Dataset,
) -> None:
    free = umbmark.fit(watched, add=["floor_slope"])
    model = free.model
    held = umbmark.fit(watched, model, fix=["floor_slope.drift_y"])
    assert held.model.get("floor_slope", "drift_y") == model.get("floor_slope", "drift_y")
    names = [estimate.parameter for estimate in free.fitted]
    assert [e.parameter for e in held.fitted] == [n for n in names if n != "drift_y"]
    # The conditional standard error is no greater than the marginal one.
    by_name = {e.parameter: e.standard_error for e in free.fitted}
    for estimate in held.fitted:
        assert estimate.standard_error is not None
        assert estimate.standard_error <= 1.02 * (by_name[estimate.parameter] or 0)
    off = umbmark.fit(watched, model, fix={"floor_slope.drift_x": 0.0, "scale.e_s": 1.01})
    assert off.model.get("floor_slope", "drift_x") == 0.0
    assert off.model.get("scale", "e_s") == 1.01
    assert umbmark.Model.from_toml(off.model.to_toml()) == off.model
    assert 'fixed = ["e_s"]' in off.model.to_toml()
    # What is fixed in a model stays fixed; learning fits the numbers of the robot all the same.
    learnt = umbmark.learn(watched, off.model, draws=99).model
    assert learnt.get("floor_slope", "drift_x") == 0.0
    assert learnt.get("scale", "e_s") != 1.01
    again = umbmark.fit(watched, off.model)
    assert [e.parameter for e in again.fitted] == [e.parameter for e in off.fitted]


def test_what_cannot_be_fixed_is_refused(watched: umbmark.Dataset) -> None:
    for name, words in (
        ("drift_x", 'EFFECT.PARAMETER, got "drift_x"'),
        ("wheelbase.e_d", 'no parameter "e_d"'),
        ("no_effect.k", 'there is no effect "no_effect"'),
    ):
        with pytest.raises(ValueError, match=words):
            umbmark.fit(watched, fix=[name])
    every = ["wheel_diameter_ratio.e_d", "wheelbase.e_b", "scale.e_s"]
    with pytest.raises(ValueError, match="no effect of the model is free"):
        umbmark.fit(watched, fix=every)


def test_a_report_of_a_fit_tells_its_residuals(watched: umbmark.Dataset) -> None:
    fitted = umbmark.fit(watched)
    text, frame = fitted.fit_report(), fitted.tracks().to_pandas()
    rms = np.sqrt((frame.x_residual_m**2 + frame.y_residual_m**2).mean())
    headings = np.sqrt((frame.heading_residual_rad**2).mean())
    assert f"positions        {1e3 * rms:.3g} mm rms, {len(frame)} poses\n" in text
    assert f"headings         {np.degrees(headings):.3g} deg rms\n" in text
    whitened = frame.filter(like="whitened").to_numpy()
    whitened = whitened[np.isfinite(whitened)]
    chi2, count = (whitened**2).sum(), whitened.size
    assert f"chi2             {chi2:.1f} of {count} residuals, {chi2 / count:.3f} each" in text
    assert fitted.tracks().reduced_chi2 == pytest.approx(chi2 / count)
    assert f"AICc             {fitted.aicc:.2f}" in text


def test_a_report_of_learning_has_the_criteria_of_its_last_step(watched: umbmark.Dataset) -> None:
    learnt = umbmark.learn(watched, draws=99)
    text = learnt.fit_report()
    for name, value in (("AICc", learnt.steps[-1].aicc), ("BIC", learnt.steps[-1].bic)):
        assert re.search(rf"^{name} +{value:.2f}$", text, re.MULTILINE)
    assert umbmark.solve(watched, draws=99).fit_report() == "\n".join(text.splitlines()[:-2])


def test_a_report_without_tracks_says_so() -> None:
    data = umbmark.simulate(TRUTH, PATH, runs=3, reference_rate_hz=0)
    text = umbmark.diagnose(data, draws=99).fit_report()
    assert text.splitlines()[0] == "2 parameters, 6 runs"
    assert text.endswith("residuals        of return poses alone: see compare")


def test_a_prior_is_weighed_against_the_runs_and_a_contradiction_is_told(
    watched: umbmark.Dataset,
) -> None:
    model = umbmark.Model().add("wheelbase", free=True).add("floor_slope", free=True)
    alone = umbmark.fit(watched, model)
    own = next(one for one in alone.fitted if one.parameter == "e_b")
    error = own.standard_error
    assert error is not None
    mean = own.value + 5 * error
    fitted = umbmark.fit(watched, model, priors={"wheelbase.e_b": (mean, error)})
    both = next(one for one in fitted.fitted if one.parameter == "e_b")
    # Half way between them, and known better by the square root of two.
    assert both.value == pytest.approx(own.value + 2.5 * error, abs=0.3 * error)
    assert both.standard_error == pytest.approx(error / np.sqrt(2), rel=0.15)
    [known] = fitted.known
    assert (known.mean, known.sd, known.low, known.held) == (mean, error, None, False)
    assert known.contradiction == pytest.approx(-5 / np.sqrt(2), abs=0.3)
    assert "The runs contradict" in str(fitted)
    assert "The runs contradict" not in str(
        umbmark.fit(watched, model, priors={"wheelbase.e_b": (own.value, error)})
    )
    assert f"prior {mean:g} ± {error:g}" in fitted.fit_report()


def test_a_parameter_that_ends_at_its_bound_is_said_to_be_held(watched: umbmark.Dataset) -> None:
    fitted = umbmark.fit(watched, bounds={"wheelbase.e_b": (None, 1.005)})
    assert fitted.model.get("wheelbase", "e_b") == 1.005
    assert all(one.parameter != "e_b" for one in fitted.fitted)
    [known] = fitted.known
    assert (known.low, known.high, known.value, known.held) == (None, 1.005, 1.005, True)
    assert "wheelbase" not in fitted.not_shown
    assert "e_b of wheelbase is held at 1.005" in " ".join(str(fitted).split())
    assert "bounds :1.005 (held there)" in fitted.fit_report()
    free = umbmark.fit(watched, bounds={"wheelbase.e_b": (0.5, 2)})
    assert not free.known[0].held
    assert free.fitted[0].value == pytest.approx(umbmark.fit(watched).fitted[0].value, abs=1e-6)


def test_a_fit_says_how_it_ended_and_what_it_leaves(watched: umbmark.Dataset) -> None:
    fitted = umbmark.fit(watched, add=["floor_slope"])
    tracks = fitted.tracks()
    assert fitted.ended.converged
    assert fitted.ended.steps > 0
    assert fitted.chi2 == pytest.approx(tracks.chi2, rel=0.01)
    assert fitted.residual_count == tracks.whitened_count
    assert fitted.rmse_m == pytest.approx(tracks.rms_m, rel=0.05)
    assert f"AICc             {fitted.aicc:.2f}" in fitted.fit_report()
    worse = umbmark.fit(watched)
    assert None not in (fitted.aicc, fitted.bic, worse.aicc, worse.bic)
    assert fitted.aicc < worse.aicc  # type: ignore[operator]
    assert fitted.bic < worse.bic  # type: ignore[operator]
    returns = umbmark.fit(umbmark.simulate(TRUTH, PATH, runs=5, reference_rate_hz=0))
    assert (returns.chi2, returns.residual_count) == (None, None)
    assert returns.aicc is not None
    assert returns.rmse_m is not None


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"bounds": {"e_b": (0, 1)}}, ValueError, 'bounds must name EFFECT.PARAMETER, got "e_b"'),
        (
            {"bounds": {"wheelbase.e_b": 1}},
            TypeError,
            r'bounds\["wheelbase.e_b"\] must be \(low, h',
        ),
        ({"bounds": {"wheelbase.e_b": (2, 1)}}, ValueError, "LOW < HIGH, got 2 and 1"),
        ({"bounds": [("wheelbase.e_b", (0, 1))]}, TypeError, "bounds must be a mapping"),
        ({"priors": {"wheelbase.e_b": (1, 0)}}, ValueError, "above 0, got 1 and 0"),
        (
            {"priors": {"wheelbase.e_b": ("1 m", 0)}},
            TypeError,
            r'priors\["wheelbase.e_b"\]\[0\] must',
        ),
        ({"priors": {"crab.angle_rad": (1, 1)}}, ValueError, "the model lacks its effect; add it"),
        ({"priors": {"crabs.angle_rad": (1, 1)}}, ValueError, 'there is no effect "crabs"'),
    ],
)
def test_bounds_and_priors_that_mean_nothing_are_refused_by_their_names(
    watched: umbmark.Dataset, arguments: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        umbmark.fit(watched, **arguments)
