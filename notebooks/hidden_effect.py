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
# explain. It was watched by motion capture while it drove, so there are tracks.

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
umbmark.compare(data, {"nominal": umbmark.Model(), "calibrated": calibrated.model}).models[
    1
].sentences

# %% [markdown]
# ## Which class of effects is missing?

# %%
diagnosis = umbmark.diagnose(data)
diagnosis.plot()
print(diagnosis.verdict, diagnosis.ranking[0].class_, diagnosis.ranking[0].p_adjusted)

# %% [markdown]
# ## The whole loop
#
# Fit, diagnose, add, until nothing is missing: the error falls, in runs that neither choice nor
# fit saw as well.

# %%
learnt = umbmark.learn(data)
learnt.plot()
learnt

# %%
print(learnt.verdict)
print(learnt.model.to_toml())
assert any("floor_slope" in step.class_ for step in learnt.steps)
assert learnt.steps[-1].heldout_rmse_m < 0.5 * learnt.steps[3].heldout_rmse_m
