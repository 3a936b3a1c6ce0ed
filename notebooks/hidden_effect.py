# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Find the hidden effect
#
# A robot was calibrated, and still it errs. Something is wrong with it that E_d and E_b do not
# explain. Motion capture followed it while it drove, so there are tracks. The tool is not told the
# secret: a floor that makes the robot drift.

# %%
import umbmark

path = umbmark.Path(side_m=1.0)
secret = umbmark.Model().add("wheel_diameter_ratio", e_d=1.0015).add("wheelbase", e_b=0.995)
secret = secret.add("floor_slope", drift_x=0.01).add("wheel_noise", k_sqrt_m=2e-4)
secret = secret.add("reference_noise", position_sd_m=5e-4, heading_sd_rad=5e-4)
data = umbmark.simulate(secret, path, runs=3, reference_rate_hz=1, seed=5)
data.plot(tracks=True)

# %% [markdown]
# ## Does the calibrated model explain it?

# %%
calibrated = umbmark.fit(data)
calibrated

# %%
models = {"nominal": umbmark.Model(), "calibrated": calibrated.model}
nominal, judged = umbmark.compare(data, models).models
print(*judged.sentences, sep="\n")
assert judged.along.rmse_m < nominal.along.rmse_m, "calibrated, the robot errs less"
assert judged.explains is False, "but wheels and wheelbase do not explain its error"

# %% [markdown]
# ## Which class of effects is missing?

# %%
diagnosis = umbmark.diagnose(data)
diagnosis.plot()
first = diagnosis.ranking[0]
print(f"{diagnosis.verdict}: {' or '.join(first.class_)}, p = {first.p_adjusted:.4f}")
assert diagnosis.verdict == "missing_effect"
assert first.class_ == ("carpet_nap", "floor_slope")

# %% [markdown]
# ## The whole loop
#
# Fit, diagnose, add, until nothing is missing. The error falls, also in runs that were used neither
# to choose the effects nor to fit them.

# %%
learnt = umbmark.learn(data)
learnt

# %%
print(learnt.model.to_toml())
assert learnt.verdict == "explained"
assert any("floor_slope" in step.class_ for step in learnt.steps)
assert learnt.steps[-1].heldout_rmse_m < 0.5 * learnt.steps[3].heldout_rmse_m

# %% [markdown]
# ## Where did the error come from?
#
# The floor drags the robot towards one side of the room: the error of the nominal robot (grey),
# ahead and sideways, depends on the heading. That of the learnt model (green) does not.

# %%
learnt.plot(kind="residuals_by_heading")
judged = umbmark.compare(data, {"nominal": umbmark.Model(), "learnt": learnt.model}).models
before, after = ({(of.rate, of.covariate): of.p for of in model.against} for model in judged)
for rate in ("forward_m_per_m", "sideways_m_per_m"):
    print(
        f"{rate} against heading: p = {before[rate, 'heading']:.4f}, {after[rate, 'heading']:.4f}"
    )
    assert before[rate, "heading"] < 0.01, "the nominal robot errs by its heading"
    assert after[rate, "heading"] > 0.05, "the learnt model does not"

# %% [markdown]
# ## Does the learnt model explain it?
#
# The same question as before, now to the learnt model. And the drift that it found is the secret
# one. Whether a slope or the nap of a carpet drags the robot, these runs cannot tell: the diagnosis
# names both.

# %%
judged = umbmark.compare(data, learnt.model).models[0]
print(judged.sentences[0])
assert judged.explains is True
drift = next(found for found in learnt.fitted if found.parameter == "drift_x")
assert drift.interval[0] < 0.01 < drift.interval[1]
assert {"carpet_nap", "floor_slope"} <= {*learnt.steps[-1].class_}, "either would do it"
