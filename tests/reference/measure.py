"""Datasets side by side: draws from their seeds, robots as they are, runs driven and measured."""

from dataclasses import dataclass, field, replace
from math import ceil

import causes as law
import numpy as np
import numpy.typing as npt
from cases import Case
from catalogue import Setup, Sizes, laws
from drive import drive
from motion import Cause, TrueMotion
from robot import Array, Robot
from schedule import PERIOD_S, Pace, Schedule, schedule, wheel_rates
from sensors import Counts, Encoders, Odometry, Reference

PURPOSES = (
    "base",
    "wheel_noise",
    "reference",
    "bumps",
    "start",
    "within_tick",
    "tails",
    "reference_tails",
)
NOISE_MODELS = ("gaussian", "t4", "correlated")
CORRELATION_PERIODS = 1000
"""Control periods over which correlated wheel noise forgets: 10 s, 2 m at 0.2 m/s."""


@dataclass(frozen=True)
class Terms:
    """What is common to all datasets: runs per direction and noise."""

    runs_each: int = 5
    k_sqrt_m: float = 4e-4
    noise_model: str = "gaussian"
    reference: Reference = field(default_factory=Reference)
    base: dict[str, float] | None = None
    """E_d, E_b, E_s where they are not drawn; keys e_d, e_b, e_s."""

    @property
    def directions(self) -> Array:
        """+1 for each ccw run, then -1 for each cw run of one dataset."""
        return np.repeat([1.0, -1.0], self.runs_each)


@dataclass(frozen=True)
class Run:
    """One run as measured. `reference` has a row for each row of `ticks`, not a number where
    nothing was measured.
    """

    direction: str
    number: int
    t_s: Array
    ticks: Counts
    reference: Array
    absolute: Array
    computed: Array


@dataclass(frozen=True)
class Dataset:
    """All runs of a seed, and what was put in besides the case: E_d, E_b, E_s."""

    seed: int
    robot: Robot
    runs: list[Run]
    base: dict[str, float]


def stream(seed: int, purpose: str) -> np.random.Generator:
    """Draws for one purpose: a cause more moves no draw of another."""
    key = np.array([seed, PURPOSES.index(purpose)], dtype=np.uint64)
    return np.random.Generator(np.random.Philox(key=key))


def drawn(seeds: list[int], purpose: str, shape: tuple[int, ...], normal: bool = True) -> Array:
    """Draws of all datasets side by side in the last axis."""
    generators = [stream(seed, purpose) for seed in seeds]
    draws = [g.standard_normal(shape) if normal else g.random(shape) for g in generators]
    return np.concatenate(draws, axis=-1)


def base_errors(seeds: list[int], terms: Terms) -> dict[str, Array]:
    """E_d, E_b, E_s of each dataset, near the sizes of a careful owner's robot."""
    z = drawn(seeds, "base", (3, 1))
    centres, spreads = (1.0015, 0.995, 1.002), (5e-4, 2e-3, 1e-3)
    errors = {
        k: c + s * z[i]
        for i, (k, c, s) in enumerate(zip(("e_d", "e_b", "e_s"), centres, spreads, strict=True))
    }
    return errors | {key: np.full(len(seeds), value) for key, value in (terms.base or {}).items()}


def wheel_draws(seeds: list[int], terms: Terms, stretches: int) -> Array:
    """Wheel noise [stretches x 2 x runs] of unit long-run variance, as the noise model says."""
    runs = len(terms.directions)
    z = drawn(seeds, "wheel_noise", (stretches, 2, runs))
    if terms.noise_model == "t4":
        tails = [stream(seed, "tails").chisquare(4, runs) for seed in seeds]
        return np.asarray(z * np.sqrt(2 / np.concatenate(tails)), dtype=np.float64)
    if terms.noise_model == "correlated":
        keep = 1 - 1 / CORRELATION_PERIODS
        state = z[0] * np.sqrt((1 - keep) / (1 + keep))
        for i in range(stretches):
            state = keep * state + (1 - keep) * z[i]
            z[i] = state
    return z


def bump_places(seeds: list[int], runs: int, metres: float, rate_per_m: float) -> Array:
    """Places [2 x runs x bumps] by the rim travel of each wheel, a Poisson process."""
    most = ceil(2 * rate_per_m * metres + 20)
    gaps = [stream(seed, "bumps").exponential(1 / rate_per_m, (2, runs, most)) for seed in seeds]
    return np.asarray(np.cumsum(np.concatenate(gaps, axis=1), axis=2), dtype=np.float64)


def add(setup: Setup, name: str, sizes: Sizes, seeds: list[int], metres: float, runs: int) -> None:
    """Make the robot, its encoders or its reference so. Wheel noise is of the terms."""
    reference = setup.reference
    if name in (by_name := laws(setup.robot, runs * len(seeds))):
        setup.causes.append(by_name[name](**sizes))
    elif name == "bumps":
        places = bump_places(seeds, runs, metres, sizes["rate_per_m"])
        setup.causes.append(law.Bumps(places, setup.robot.radius_m, sizes["height_m"]))
    elif name == "encoder_skew":
        setup.right_delay_s = sizes["delay_s"]
    elif name == "encoder_resolution":
        setup.robot = setup.robot.with_ticks(round(sizes["ticks_per_revolution"]))
    elif name == "encoder_sampling":
        setup.euler_readings = round(sizes["period_s"] / PERIOD_S)
    elif name == "reference_delay":
        setup.reference = replace(reference, delay_s=sizes["delay_s"])
    elif name == "reference_clock_rate":
        setup.reference = replace(reference, rate=sizes["rate"])
    elif name == "marker_offset":
        setup.reference = replace(reference, forward_m=sizes["forward_m"], left_m=sizes["left_m"])
    elif name == "marker_yaw":
        setup.reference = replace(reference, yaw_rad=sizes["angle_rad"])
    elif name == "start_pose":
        sd = np.array([sizes["position_sd_m"]] * 2 + [sizes["heading_sd_rad"]])[:, None]
        mean = np.array([sizes["x_m"], sizes["y_m"], sizes["heading_rad"]])[:, None]
        setup.start = mean + sd * drawn(seeds, "start", (3, runs))
    elif name != "wheel_noise":
        raise KeyError(f"no such cause: {name}")


def metres_rolled(case: Case) -> float:
    """The most that a wheel rolls in a run."""
    half = case.robot.wheelbase_m / 2
    return sum(move.length_m + half * abs(move.angle_rad) for move in case.path.moves())


def set_up(
    case: Case, seeds: list[int], terms: Terms, stretches: int
) -> tuple[Setup, dict[str, Array]]:
    """The robots of all datasets with E_d, E_b, E_s, the causes of the case and wheel noise; and
    E_d, E_b, E_s.
    """
    each = len(terms.directions)
    base = base_errors(seeds, terms)
    for name in ("wheel_diameter_ratio", "wheelbase", "scale"):
        for key, value in case.causes.get(name, {}).items():
            base[key] = np.full(len(seeds), value)
    by_run = {key: np.repeat(values, each) for key, values in base.items()}
    true_base: list[Cause] = [
        law.WheelDiameterRatio(by_run["e_d"]),
        law.Wheelbase(by_run["e_b"]),
        law.Scale(by_run["e_s"]),
    ]
    setup = Setup(case.robot, true_base, terms.reference, np.zeros((3, each * len(seeds))))
    for name, sizes in case.causes.items():
        if name not in ("wheel_diameter_ratio", "wheelbase", "scale"):
            add(setup, name, sizes, seeds, metres_rolled(case), each)
    k_sqrt_m = case.causes.get("wheel_noise", {}).get("k_sqrt_m", terms.k_sqrt_m)
    if k_sqrt_m > 0:
        setup.causes.append(law.WheelNoise(wheel_draws(seeds, terms, stretches), k_sqrt_m))
    return setup, base


def plan_of(case: Case, terms: Terms, datasets: int) -> Schedule:
    """The schedule of all runs of all datasets."""
    paces: list[Pace] = [case.paces[i % len(case.paces)] for i in range(terms.runs_each)]
    return schedule(case.path, np.tile(terms.directions, datasets), paces * 2 * datasets)


def reference_noise(seed: int, terms: Terms, runs: int, samples: int) -> Array:
    """[runs x samples x 3] of unit variance; heavy-tailed where the wheel noise is."""
    z = stream(seed, "reference").standard_normal((runs, samples, 3))
    if terms.noise_model == "t4":
        z *= np.sqrt(2 / stream(seed, "reference_tails").chisquare(4, (runs, samples, 1)))
    return z


def measure(case: Case, seeds: list[int], terms: Terms, kept: str) -> list[Dataset]:
    """Drive and measure a dataset for each seed; the reference is `kept` dense, at stops, or at
    ends.
    """
    plan = plan_of(case, terms, len(seeds))
    setup, base = set_up(case, seeds, terms, len(plan.forward))
    runs = plan.forward.shape[1]
    truth = TrueMotion(setup.robot, setup.causes, runs)
    truth.pose = truth.pose + setup.start
    within_tick = drawn(seeds, "within_tick", (2, len(terms.directions)), normal=False)
    encoders = Encoders(setup.robot, within_tick, setup.right_delay_s)
    seen = drive(
        setup.robot, plan, truth, encoders, Odometry(setup.robot, runs, setup.euler_readings)
    )
    every = round(1 / (PERIOD_S * setup.robot.log_rate_hz))
    datasets = []
    for i, seed in enumerate(seeds):
        each = len(terms.directions)
        noise = reference_noise(seed, terms, each, len(seen.track) // every + 1)
        measured = []
        for j in range(each):
            run = i * each + j
            rows = np.arange(0, plan.periods[run] + 1, every)
            t_s = rows.astype(np.float64) * PERIOD_S
            poses = setup.reference.see(t_s, seen.track[:, :, run], noise[j, : len(rows)])
            absolute = poses[-1].copy()
            poses[~rows_kept(rows, plan.stops[run], kept)] = np.nan
            measured.append(
                Run(
                    "ccw" if terms.directions[j] > 0 else "cw",
                    j % terms.runs_each + 1,
                    t_s,
                    seen.ticks[rows, :, run],
                    poses,
                    absolute,
                    seen.computed[rows[-1], :, run],
                )
            )
        errors = {key: float(values[i]) for key, values in base.items()}
        datasets.append(Dataset(seed, setup.robot, measured, errors))
    return datasets


def rows_kept(rows: npt.NDArray[np.int64], stops: list[int], kept: str) -> npt.NDArray[np.bool_]:
    """Which rows of a log have a reference: all, START and one in each rest, or the last."""
    at = np.zeros(len(rows), dtype=bool)
    if kept == "tracks":
        at[:] = True
    elif kept == "stops":
        at[0] = True
        at[np.searchsorted(rows, stops[:-1])] = True
    at[-1] = True
    return at


def end_poses(case: Case, seeds: list[int], terms: Terms) -> tuple[Array, Array, dict[str, Array]]:
    """Absolute and computed end poses [3 x runs of all datasets].

    The robot believes to drive its schedule exactly.
    """
    reading = {
        "missed_counts",
        "encoder_skew",
        "encoder_resolution",
        "encoder_sampling",
    } & case.causes.keys()
    if reading:
        raise ValueError(
            f"{', '.join(sorted(reading))}: the encoders' effects need tracks, not returns only"
        )
    steps = 20
    plan = plan_of(case, terms, len(seeds))
    stretches = ceil(len(plan.forward) / steps)
    setup, base = set_up(case, seeds, terms, stretches)
    runs = plan.forward.shape[1]
    truth = TrueMotion(setup.robot, setup.causes, runs)
    truth.pose = truth.pose + setup.start
    for i in range(stretches):
        part = slice(i * steps, (i + 1) * steps)
        truth.advance(wheel_rates(setup.robot, plan.forward[part], plan.turning[part]), PERIOD_S)
    each = len(terms.directions)
    noise = np.concatenate([reference_noise(seed, terms, each, 1)[:, 0] for seed in seeds])
    see = setup.reference.see
    absolute = [
        see(np.zeros(1), truth.pose[None, :, run], noise[None, run])[0] for run in range(runs)
    ]
    computed = np.stack([plan.x[-1], plan.y[-1], plan.heading[-1]])
    return np.array(absolute).T, computed, base
