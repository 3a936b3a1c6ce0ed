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
# # The paper in one notebook
#
# J. Borenstein and L. Feng, *UMBmark: A Benchmark Test for Measuring Odometry Errors in Mobile
# Robots* (1995). A robot drives a 4 x 4 m square by its odometry alone, five times in each
# direction; what it misses START by tells what is wrong with it.

# %%
import numpy as np
import umbmark
from matplotlib import pyplot

labmate, square = umbmark.Robot.labmate(), umbmark.Path.umbmark()
MM = 1e3


def robot(e_d: float = 1.0, b_mm: float = 340.0, noise: float = 0.0) -> umbmark.Model:
    """Return a LabMate with a ratio of wheel diameters, a true wheelbase, and wheel noise."""
    model = umbmark.Model(labmate).add("wheel_diameter_ratio", e_d=e_d)
    return model.add("wheelbase", e_b=b_mm / 340.0).add("wheel_noise", k_sqrt_m=noise)


# %% [markdown]
# ## Figs. 2 to 4: one direction hides what two show
#
# An error of the wheelbase turns the robot too little or too much at each corner (dashed in Fig.
# 3), unequal wheels bend each leg (dotted). Either alone shows in both directions. With these two
# together, the robot that drives counter-clockwise comes back to START as if nothing were wrong;
# clockwise the errors add up. Had the right wheel been the smaller one, clockwise runs would hide
# them. The errors are drawn many times too large, as in the paper.

# %%
cases = {
    "$E_b$ alone": robot(b_mm=340 / 0.96),
    "$E_d$ alone": robot(e_d=1.0053),
    "both": robot(e_d=1.0053, b_mm=340 / 0.96),
}
figure, axes = pyplot.subplots(1, 2, figsize=(10, 5), layout="constrained")
ends = {}
for axis, direction in zip(axes, ("cw", "ccw"), strict=True):
    for name, model in cases.items():
        data = umbmark.simulate(model, square, runs=1, reference_rate_hz=5)
        run = next(run for run in data.runs if run.direction == direction)
        pose = run.reference_pose
        axis.plot(pose[:, 0], pose[:, 1], label=name)
        ends[direction, name] = np.hypot(*pose[-1, :2])
    axis.plot(0, 0, "k+", markersize=12)
    axis.set(title=f"driven {direction}", aspect="equal", xlabel="x [m]", ylabel="y [m]")
    axis.legend()
{f"{direction}, {name}": f"{error * MM:.0f} mm" for (direction, name), error in ends.items()}

# %%
single = min(ends[way, name] for way in ("cw", "ccw") for name in ("$E_b$ alone", "$E_d$ alone"))
assert ends["ccw", "both"] < single / 10, "counter-clockwise they cancel"
assert ends["cw", "both"] > 1.9 * single, "clockwise they add up"
mirrored = umbmark.simulate(robot(e_d=1 / 1.0053, b_mm=340 / 0.96), square, runs=1)
cw, ccw = (np.hypot(*mirrored.returns(way)[0, :2]) for way in ("cw", "ccw"))
assert cw < single / 10 < 1.9 * single < ccw, "with the other wheel smaller, clockwise runs hide it"

# %% [markdown]
# ## Fig. 5: two clusters, and the score
#
# The uncalibrated LabMate of Table I. The clusters lie apart by its systematic errors, and scatter
# by the floor's.

# %%
uncalibrated = robot(e_d=1.00121, b_mm=337.2, noise=1e-3)
test = umbmark.simulate(uncalibrated, square, reference_rate_hz=0, seed=3)
score = umbmark.score(test)
score.plot(test.plot())
score

# %%
apart = np.hypot(*np.subtract(score.centroid_cw_m, score.centroid_ccw_m))
smooth = umbmark.simulate(robot(e_d=1.00121, b_mm=337.2), square, reference_rate_hz=0)
print(f"{MM * apart:.0f} mm apart, scatter {MM * score.sigma_m:.0f} mm")
assert apart > 3 * score.sigma_m, "two clusters"
assert umbmark.score(smooth).sigma_m < 0.01 * score.sigma_m, "no floor, no scatter"

# %% [markdown]
# ## Table I: E_max,sys of the LabMate in two configurations
#
# Exact kinematics without noise; to first order, as the paper's companion calculates; and as
# published. The published corrections are themselves estimates, from ten runs.

# %%
published = {"nomod/nocal": (1.00121, 337.2, 310.0), "3loop/nocal": (1.00203, 337.1, 423.0)}
rows = []
for name, (e_d, b_mm, paper) in published.items():
    found = umbmark.monte_carlo(robot(e_d, b_mm, noise=1e-3), square, n=2000)
    e_max, sigma = found.metrics["e_max_sys_m"], found.metrics["sigma_m"]
    rows.append(
        {
            "configuration": name,
            "paper [mm]": paper,
            "exact [mm]": MM * found.noise_free.e_max_sys_m,
            "first order [mm]": MM * found.noise_free.first_order_e_max_sys_m,
            "mean of trials [mm]": MM * e_max.mean,
            "5 % to 95 % of trials [mm]": f"{MM * e_max.quantiles['0.05']:.0f} to "
            f"{MM * e_max.quantiles['0.95']:.0f}",
            "sigma [mm]": MM * sigma.mean,
        }
    )
    assert abs(MM * found.noise_free.first_order_e_max_sys_m - paper) < 3
    assert e_max.quantiles["0.05"] * MM < paper < e_max.quantiles["0.95"] * MM
rows

# %% [markdown]
# Calibrated (rows 3 and 4): correct by what the closed forms of the companion paper find in ten
# noisy runs, and drive again.

# %%
found = umbmark.calibrate(test)
found.to_pandas()[["method", "e_d", "e_b", "e_max_sys_before_m", "e_max_sys_after_m"]]

# %%
corrected = found.methods["closed_form_mean"]
left = robot(1.00121 / corrected.e_d, 337.2 / corrected.e_b, noise=1e-3)
after = umbmark.monte_carlo(left, square, n=1000).metrics["e_max_sys_m"]
print(f"{MM * score.e_max_sys_m:.0f} mm before, {MM * after.mean:.0f} mm after (paper: 310 and 26)")
assert after.mean < score.e_max_sys_m / 4

# %% [markdown]
# ## Fig. 6: bumps move the end by where they lie, and turn it by how many there are
#
# Ten bumps under the inner wheel rob it of 50 mm of travel, at the beginning of the first leg
# (Path A) or at its end (Path B): the return position changes, the return orientation hardly.
# Where the bumps lie is an effect of our own, written as a function.


# %%
def bumps(at, lost, first):
    """Share of its travel that the wheel loses: `lost` metres within one metre from `first` on."""
    return -0.5 * lost * (np.sign(at.distance - first) - np.sign(at.distance - first - 1.0))


bumped = {}
for name, first in (("A", 0.2), ("B", 2.8)):
    parameters = {"lost": 0.05, "first": first}
    model = robot().add(
        "bumps_here", acts_on="left_wheel_scale", formula=bumps, parameters=parameters
    )
    data = umbmark.simulate(model, square, runs=(0, 1), reference_rate_hz=0)
    bumped[name] = x, y, heading = data.returns("ccw")[0]
    print(f"Path {name}: {MM * x:6.0f} {MM * y:6.0f} mm, {np.degrees(heading):.2f} deg")

# %%
here, there = bumped.values()
assert np.hypot(*(here - there)[:2]) > 0.3, "the position tells where"
assert abs(here[2] - there[2]) < 2e-3, "the orientation does not"

# %% [markdown]
# ## Table II: orientation errors with bumps
#
# From the published headings of each run. Eq. 5 as printed adds both directions; the printed
# averages of the Cybermotion and the CLAPPER are half of that, the mean. That of the LabMate, 8.35
# deg, follows from its headings neither way, but if both of them without bumps are exchanged.

# %%
TABLE_II = {
    "TRC LabMate": (
        (0.28, -2.03),
        (7.10, 6.40, 5.60, 6.60, 5.90),
        (-7.50, -8.80, -6.60, -8.80, -8.70),
    ),
    "Cybermotion": (
        (3.77, 0.97),
        (7.78, 4.17, 1.72, 4.23, 3.55),
        (-11.35, -2.48, -4.61, -6.34, -2.31),
    ),
    "CLAPPER": ((-0.2, -0.14), (0.10, 0.10, 0.10, -0.70, 0.20), (-0.60, -0.40, -0.50, 0.10, 0.20)),
}

PRINTED = {"TRC LabMate": 8.35, "Cybermotion": 3.91, "CLAPPER": 0.35}


def headings(*degrees: float) -> np.ndarray:
    """Return return errors with these headings."""
    return np.column_stack([np.zeros((len(degrees), 2)), np.radians(degrees)])


for name, ((cw, ccw), with_bumps_cw, with_bumps_ccw) in TABLE_II.items():
    bumps = {"bumps_cw": headings(*with_bumps_cw), "bumps_ccw": headings(*with_bumps_ccw)}
    mean, both, exchanged = (
        np.degrees(umbmark.score(*runs, **bumps, convention=how).nonsys_orientation_rad)
        for *runs, how in (
            (headings(cw), headings(ccw), "mean"),
            (headings(cw), headings(ccw), "sum"),
            (headings(ccw), headings(cw), "mean"),
        )
    )
    print(f"{name:12} mean {mean:.3f} deg, sum {both:.3f} deg, printed {PRINTED[name]} deg")
    follows = exchanged if name == "TRC LabMate" else mean
    assert abs(follows - PRINTED[name]) < 0.0051
    assert abs(both - PRINTED[name]) > 0.1
