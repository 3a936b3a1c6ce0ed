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
# # Your own effect
#
# What the catalogue does not have is a function of what the robot does: of `at.speed`,
# `at.heading`, `at.distance` ... (`docs/files.md` lists them), and of parameters. Written with
# NumPy, it is turned into a formula: it runs on every thread, has exact derivatives, can be
# fitted and written to a file.

# %%
import numpy as np
import umbmark


def slack(at, k):
    """A loose axle settles sideways after each corner, rad per m, for about 0.3 m."""
    return k * at.last_turn * np.exp(-at.since_turn / 0.3)


umbmark.formula_of(slack, {"k": 0.0})

# %% [markdown]
# The function takes arrays as well, so it can be looked at before it is used:

# %%
from types import SimpleNamespace

from matplotlib import pyplot

driven = np.linspace(0, 2, 100)
figure, axes = pyplot.subplots(layout="constrained")
axes.plot(driven, slack(SimpleNamespace(last_turn=np.pi / 2, since_turn=driven), k=0.02))
axes.set(xlabel="since the corner [m]", ylabel="heading per metre [rad/m]")

# %% [markdown]
# ## A robot that has it
#
# Simulated, watched at 5 Hz; then its size is taken from the data again, beside E_d and E_b.

# %%
own = {"acts_on": "heading_per_metre", "formula": slack}
noise = umbmark.Model().add("wheel_noise", k_sqrt_m=2e-4)
truth = noise.add("wheelbase", e_b=1.005).add("slack", parameters={"k": 0.02}, **own)
data = umbmark.simulate(truth, umbmark.Path(side_m=2.0), reference_rate_hz=5, seed=4)

# %%
start = umbmark.Model().add("wheel_diameter_ratio", free=True).add("wheelbase", free=True)
without = umbmark.fit(data, start)
with_it = umbmark.fit(data, start.add("slack", parameters={"k": 0.0}, free=True, **own))
with_it

# %%
k = next(estimate for estimate in with_it.fitted if estimate.effect == "slack")
assert k.interval[0] < 0.02 < k.interval[1]

# %% [markdown]
# ## Does it explain more?

# %%
judged = umbmark.compare(data, {"without": without.model, "with it": with_it.model})
without_it, with_it = judged.models
for model in judged.models:
    print(f"{model.name:9} explains: {model.explains}, {1e3 * model.along.rmse_m:.1f} mm left")
assert with_it.along.rmse_m < 0.5 * without_it.along.rmse_m, "the error falls"
assert (without_it.explains, with_it.explains) == (False, True)

# %% [markdown]
# ## What has no formula is refused
#
# An `if` on a value, or a function of another module: the error says what to write instead. (A
# choice is `np.where`, a table `np.interp`.)

# %%
try:
    umbmark.Model().add(
        "mine",
        acts_on="forward_scale",
        formula=lambda at, k: k if at.speed > 0.2 else 0.0,
        parameters={"k": 0.01},
    )
except TypeError as error:
    refused = str(error)
print(refused)
assert "np.where" in refused
