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
# # Monte Carlo and tolerances
#
# How well must a robot be built so that 95 of 100 of them pass a UMBmark test with E_max,sys below
# 100 mm? Each trial is a whole test of ten runs by another robot of the series.

# %%
import numpy as np
import umbmark
from matplotlib import pyplot


def series(diameter_sd: float, wheelbase_sd: float) -> umbmark.Model:
    """Return a series of robots: scatter of the ratios from robot to robot, and a usual floor."""
    model = umbmark.Model().add("wheel_diameter_ratio", e_d={"mean": 1.0, "sd": diameter_sd})
    model = model.add("wheelbase", e_b={"mean": 1.0, "sd": wheelbase_sd})
    return model.add("wheel_noise", k_sqrt_m=5e-4)


# %%
found = umbmark.monte_carlo(series(5e-4, 2e-3), n=20_000)
found

# %% [markdown]
# The share that passes, for a grid of tolerances:

# %%
diameters, wheelbases = np.array([1e-4, 2e-4, 5e-4, 1e-3]), np.array([1e-3, 2e-3, 5e-3])


def share(diameter_sd: float, wheelbase_sd: float) -> float:
    """Return the share of a series that passes."""
    found = umbmark.monte_carlo(series(diameter_sd, wheelbase_sd), n=2000)
    return found.ensemble.share_below("e_max_sys_m", 0.100)


passes = np.array([[share(d, b) for d in diameters] for b in wheelbases])
figure, axes = pyplot.subplots(layout="constrained")
image = axes.imshow(100 * passes, origin="lower", vmin=0, vmax=100)
axes.set_xticks(range(len(diameters)), [f"{d:g}" for d in diameters])
axes.set_yticks(range(len(wheelbases)), [f"{b:g}" for b in wheelbases])
axes.set(xlabel="sd of E_d", ylabel="sd of E_b")
for (row, column), share in np.ndenumerate(passes):
    axes.text(column, row, f"{100 * share:.0f} %", ha="center", va="center")

# %%
assert (np.diff(passes, axis=1) <= 0.02).all(), "worse wheels, fewer that pass"
assert (np.diff(passes, axis=0) <= 0.02).all(), "worse wheelbases, fewer that pass"

# %% [markdown]
# So 95 of 100 pass with a standard deviation of 2e-4 in the ratio of the wheel diameters and 1e-3
# in the wheelbase, or of 1e-4 and 2e-3; with 5e-4 in the wheels no wheelbase of the grid is enough.

# %%
enough = {(d, b) for (b, d) in np.ndindex(passes.shape) if passes[b, d] >= 0.95}
assert enough == {(0, 0), (1, 0), (0, 1)}

# %% [markdown]
# ## The same in NumPy
#
# Are these numbers right? Here is the code that one would write: all runs at once, without encoder
# ticks, and with the noise of a leg drawn at its end only. It has less physics, but the errors of
# wheels and wheelbase dominate here, so both must find the same distribution of E_max,sys.

# %%
N, SIDE, BASE, K = 20_000, 4.0, 0.340, 5e-4


def in_numpy(rng: np.random.Generator) -> np.ndarray:
    """Return E_max,sys in m of N tests."""
    shape = (N, 5)
    e_d = rng.normal(1.0, 5e-4, (N, 1))
    base = BASE * rng.normal(1.0, 2e-3, (N, 1))
    left, right = 2 / (1 + e_d), 2 * e_d / (1 + e_d)
    distances = []
    for sign in (-1, 1):
        x, y, heading = np.zeros(shape), np.zeros(shape), np.zeros(shape)
        turn = sign * np.pi / 2 * BASE / 2
        for believed in 4 * [(SIDE, SIDE), (-turn, turn)]:
            rolled = [
                factor * s + K * np.sqrt(abs(s)) * rng.normal(size=shape)
                for factor, s in zip((left, right), believed, strict=True)
            ]
            forward, turned = (rolled[0] + rolled[1]) / 2, (rolled[1] - rolled[0]) / base
            chord = forward * np.sinc(turned / 2 / np.pi)
            x += chord * np.cos(heading + turned / 2)
            y += chord * np.sin(heading + turned / 2)
            heading += turned
        distances.append(np.hypot(x.mean(axis=1), y.mean(axis=1)))
    return np.maximum(*distances)


plain = in_numpy(np.random.default_rng(1))
ours = umbmark.monte_carlo(series(5e-4, 2e-3), n=N, odometry="continuous")
ensemble = ours.ensemble
print("E_max,sys [mm]   NumPy  umbmark")
print(f"mean           {1e3 * plain.mean():7.2f}  {1e3 * ensemble.mean('e_max_sys_m'):7.2f}")
for part in (0.05, 0.5, 0.95):
    quantiles = np.quantile(plain, part), ensemble.quantile("e_max_sys_m", part)
    print(f"{100 * part:3.0f} % below    {1e3 * quantiles[0]:7.2f}  {1e3 * quantiles[1]:7.2f}")
    assert abs(quantiles[0] - quantiles[1]) < 3e-3
chance = np.sqrt(2) * ensemble.std_error("e_max_sys_m")
assert abs(plain.mean() - ensemble.mean("e_max_sys_m")) < 4 * chance
