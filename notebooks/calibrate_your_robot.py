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
# # Calibrate your robot
#
# Drive a square five times clockwise and five times counter-clockwise, and measure with a tape
# where the robot stopped, seen from where it started. That is enough for E_d, the ratio of its
# wheel diameters, and E_b, by how much its wheelbase differs from what its odometry believes.
#
# Here a simulated robot stands in for yours; nothing below knows its secret.

# %%
import numpy as np
import umbmark

robot = umbmark.Robot(
    name="warehouse cart", wheelbase_m=0.52, wheel_diameter_m=0.20, ticks_per_revolution=4096
)
path = umbmark.Path(side_m=3.0, speed_m_s=0.4)
secret = umbmark.Model(robot).add("wheel_diameter_ratio", e_d=0.9985).add("wheelbase", e_b=1.012)
secret = secret.add("wheel_noise", k_sqrt_m=5e-4)
measured = umbmark.simulate(secret, path, reference_rate_hz=0, seed=11)

# %% [markdown]
# Your own measurements come from files (`umbmark.load_dataset("my_robot")`: CSV, MCAP logs of ROS
# 2, OptiOdom), from frames of logs (`umbmark.Dataset.from_frame`), or from arrays: one row per run
# with x, y in m and heading in rad, each where the robot was minus where its odometry says it is.

# %%
cw, ccw = measured.returns("cw"), measured.returns("ccw")
data = umbmark.Dataset.from_arrays(cw, ccw, robot=robot, path=path)
data

# %% [markdown]
# ## Is the data any good, and how large are the errors?

# %%
umbmark.inspect(data)

# %%
score = umbmark.score(data)
axes = score.plot(data.plot())
print(
    f"E_max,sys {1e3 * score.e_max_sys_m:.0f} mm; chance alone: {1e3 * score.noise_band_m:.0f} mm"
)
assert score.e_max_sys_m > score.noise_band_m, "more than chance"

# %% [markdown]
# ## What corrects them
#
# The paper's closed forms and the exact fit, each with its interval.

# %%
found = umbmark.calibrate(data)
found

# %%
exact = found.exact
print(f"E_d {exact.e_d:.5f} {exact.e_d_interval}, E_b {exact.e_b:.5f} {exact.e_b_interval}")
print(f"true wheelbase {exact.wheelbase_m:.4f} m instead of {robot.wheelbase_m} m")
assert exact.e_d_interval[0] < 0.9985 < exact.e_d_interval[1]
assert exact.e_b_interval[0] < 1.012 < exact.e_b_interval[1]

# %% [markdown]
# For the robot's own software: parameters for ros2_control, a robot.toml, or a C header.

# %%
print(found.export("ros2_control"))

# %% [markdown]
# ## Drive again
#
# What is left after the correction: divide the secret by what was found.

# %%
left = umbmark.Model(robot).add("wheel_diameter_ratio", e_d=0.9985 / exact.e_d)
left = left.add("wheelbase", e_b=1.012 / exact.e_b).add("wheel_noise", k_sqrt_m=5e-4)
again = umbmark.score(umbmark.simulate(left, path, reference_rate_hz=0, seed=12))
print(f"{1e3 * score.e_max_sys_m:.0f} mm before, {1e3 * again.e_max_sys_m:.0f} mm after")
assert again.e_max_sys_m < 0.2 * score.e_max_sys_m
assert np.isclose(found.exact.e_max_sys_before_m, score.e_max_sys_m)

# %% [markdown]
# ## To show it to others
#
# A figure of the report, with what it says, as SVG, PNG, PDF or for Plotly; and all of them on one
# page: `umbmark.report(data).save("report.html")`.

# %%
figure = umbmark.plot("return_errors", data)
print(figure.says)
figure
