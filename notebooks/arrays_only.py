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
# # From arrays alone
#
# Your robot recorded its wheel counts, and a tracking system its poses. They are arrays, in a frame
# or in a file of your own. This notebook makes such arrays in NumPy alone, from the equations of
# motion, hides something in the robot, and lets the tool find it. Then it checks what was found on
# another day: another path at another speed, of which the tool has seen nothing.

# %%
import numpy as np
import pandas as pd
import umbmark

ROBOT = umbmark.Robot(
    name="cart", wheelbase_m=0.40, wheel_diameter_m=0.15, ticks_per_revolution=4000
)
TICK = np.pi * 0.15 / 4000
STEP = 0.02

# %% [markdown]
# ## A robot in NumPy
#
# It drives legs and turns on the spot by its own odometry. Its right wheel is 0.1 % larger than the
# left one, and its wheelbase 0.5 % larger than its odometry says. `hidden` is what else is wrong:
# it takes the motion of a step and gives another one.


# %%
def commands(legs, speed, sense):
    """Return the believed travel of the left and the right wheel in each step."""
    parts = []
    for leg in legs:
        for left, right, pace in (
            (leg, leg, speed),
            (-sense * np.pi / 2 * 0.2, sense * np.pi / 2 * 0.2, speed / 2),
        ):
            steps = int(np.ceil(abs(right) / pace / STEP))
            parts.append(np.tile([left / steps, right / steps], (steps, 1)))
            parts.append(np.zeros((25, 2)))
    return np.concatenate([np.zeros((25, 2)), *parts])


def drive(rng, legs, speed, sense, hidden):
    """Return times, counts and true poses of one run."""
    believed = commands(legs, speed, sense)
    pose, poses = np.zeros(3), [np.zeros(3)]
    for left, right in believed:
        noise = 1e-4 * rng.normal(size=2) * np.sqrt(np.abs([left, right]))
        left, right = 0.9995 * left + noise[0], 1.0005 * right + noise[1]
        ahead, aside, turn = hidden((left + right) / 2, (right - left) / (1.005 * 0.4), pose)
        middle = pose[2] + turn / 2
        c, s = np.cos(middle), np.sin(middle)
        pose = pose + np.array([c * ahead - s * aside, s * ahead + c * aside, turn])
        poses.append(pose)
    counts = np.round(np.cumsum(np.vstack([[0, 0], believed]), axis=0) / TICK)
    return STEP * np.arange(len(poses)), counts, np.array(poses)


def recorded(legs, speed, hidden, runs, seed):
    """Return the arrays of some runs in each direction in one frame, as a recorder has them."""
    rng = np.random.default_rng(seed)
    frames = []
    for name, sense in (("cw", -1), ("ccw", 1)):
        for number in range(1, runs + 1):
            t, counts, poses = drive(rng, legs, speed, sense, hidden)
            measured = poses + rng.normal(size=poses.shape) * [5e-4, 5e-4, 5e-4]
            measured[np.arange(len(t)) % 10 != 0] = np.nan
            columns = np.column_stack([t, counts, measured])
            frame = pd.DataFrame(columns, columns=["t", "left", "right", "x", "y", "yaw"])
            frames.append(frame.assign(drive=f"{name}_{number:02}"))
    return pd.concat(frames, ignore_index=True)


def dataset(frame):
    """Return the frame as a dataset: which columns are what is all that has to be said."""
    columns = {"run": "drive", "t": "t", "ticks": ("left", "right"), "pose": ("x", "y", "yaw")}
    return umbmark.Dataset.from_frame(frame, robot=ROBOT, **columns)


SQUARE, RECTANGLE = [2.0, 2.0, 2.0, 2.0], [3.0, 1.2, 3.0, 1.2]

# %% [markdown]
# ## Two hidden effects
#
# The wheels point 0.01 rad to the left of where the body points, and the floor slopes: each metre
# drags the robot by 8 mm along x.

# %%
CRAB, SLOPE = 0.01, 0.008


def crab_on_a_slope(ahead, turn, pose):
    """The motion of a step with both effects."""
    down = SLOPE * abs(ahead)
    c, s = np.cos(pose[2] + turn / 2), np.sin(pose[2] + turn / 2)
    return ahead * np.cos(CRAB) + c * down, ahead * np.sin(CRAB) - s * down, turn


data = dataset(recorded(SQUARE, 0.3, crab_on_a_slope, runs=5, seed=1))
learnt = umbmark.learn(data)
print(learnt)

# %%
found = {step.added: step.class_ for step in learnt.steps if step.added}
assert learnt.verdict == "explained"
assert any("crab" in alike for alike in found.values())
assert any("floor_slope" in alike for alike in found.values())
sizes = {estimate.parameter: estimate for estimate in learnt.fitted}
for name, truth in (("e_d", 1.0005 / 0.9995), ("e_b", 1.005), ("drift_x", SLOPE)):
    low, high = sizes[name].interval
    print(f"{name:8} {sizes[name].value:.5f}, 95 % {low:.5f} to {high:.5f}; true {truth:.5f}")
    assert low < truth < high

# %% [markdown]
# ## Another day
#
# Nothing is fitted now. The models are compared with runs of another path at another speed: that of
# wheels and wheelbase alone, and the learnt one.

# %%
known = umbmark.fit(data).model
again = dataset(recorded(RECTANGLE, 0.5, crab_on_a_slope, runs=3, seed=2))
without, with_them = umbmark.compare(again, {"known": known, "learnt": learnt.model}).models
for model in (without, with_them):
    print(f"{model.name:7} {1e3 * model.along.rmse_m:5.1f} mm left, explains: {model.explains}")
assert (without.explains, with_them.explains) == (False, True)
assert with_them.along.rmse_m < 0.2 * without.along.rmse_m

# %% [markdown]
# The residuals themselves, pose by pose, for a figure or a test of your own:

# %%
tracks = umbmark.tracks(again, learnt.model)
print(tracks)
tracks.to_pandas().groupby("run")[["x_residual_m", "y_residual_m"]].std()

# %% [markdown]
# ## A law that nobody lists
#
# A cable drags on another robot: the farther it is from START, the more each metre turns it. No
# effect of the catalogue does that. The tool tests thousands of laws of the motion and adds the one
# that best predicts runs which were left out.

# %%
PULL = 0.02


def cable(ahead, turn, pose):
    """The motion of a step: each metre turns the robot by PULL rad for each metre of x."""
    return ahead, 0.0, turn + PULL * pose[0] * abs(ahead)


data = dataset(recorded(SQUARE, 0.3, cable, runs=5, seed=3))
learnt = umbmark.learn(data)
law = next(step.law for step in learnt.steps if step.law)
print(law.meaning)
print(f"{law.acts_on} = {law.formula}, {law.parameters}")
learnt.plot()

# %%
assert law.acts_on == "heading_per_metre"
assert abs(law.parameters["a"] / PULL - 1) < 0.02
assert abs(law.parameters["b"]) < 0.02 * PULL

# %% [markdown]
# Compared on another day, again without a fit. The law removes nearly all of the error. Its size
# was estimated from one day and is not exact, so `compare` may find that a part of the small rest
# is the same in every run.

# %%
known = umbmark.fit(data).model
again = dataset(recorded(RECTANGLE, 0.5, cable, runs=3, seed=4))
without, with_it = umbmark.compare(again, {"known": known, "learnt": learnt.model}).models
for model in (without, with_it):
    print(f"{model.name:7} {1e3 * model.along.rmse_m:5.1f} mm left")
assert without.explains is False
assert with_it.along.rmse_m < 0.05 * without.along.rmse_m
