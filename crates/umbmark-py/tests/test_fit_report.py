"""A fit as text: the numbers of the result, rounded, and the residuals in mm and deg."""

import re

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
    assert "AICc" not in text


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
