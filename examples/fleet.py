"""How many robots of a series pass, against how well their wheels match.

Each trial is a whole UMBmark test of another robot; drawn is the share with E_max,sys below 50 mm.
Run it as `python examples/fleet.py`.
"""

import numpy as np
import umbmark
from matplotlib import pyplot

TARGET_M = np.array([0.050])
SPREADS = np.geomspace(5e-5, 1e-3, 9)

figure, axes = pyplot.subplots(figsize=(5, 3.2), layout="constrained")
for noise in (2e-4, 5e-4, 1e-3):
    shares = []
    for spread in SPREADS:
        robots = umbmark.Model().add("wheel_diameter_ratio", e_d={"mean": 1.0, "sd": float(spread)})
        robots = robots.add("wheel_noise", k_sqrt_m=noise)
        tests = umbmark.monte_carlo(robots, n=4000, seed=1)
        shares.append(tests.ensemble.share_below("e_max_sys_m", TARGET_M)[0])
    axes.semilogx(SPREADS, 100 * np.array(shares), ".-", label=f"noise k = {noise:g} m$^{{1/2}}$")
    print(f"noise {noise:g}: {100 * shares[0]:.0f} % pass, of the worst {100 * shares[-1]:.0f} %")
axes.set(
    xlabel="standard deviation of E_d from robot to robot",
    ylabel="tests below 50 mm [%]",
    ylim=(0, 101),
)
axes.legend(frameon=False)
figure.savefig("fleet.svg")
