"""What every world has: robot, drives, log and reference, drawn from wide ranges."""

from math import cos, pi, sin

import numpy as np
from plans import FREE, ROUND, WITHOUT_PLAN, Random
from setting import Drive, Recording, Reference, Robot, Setting


def log_uniform(random: Random, low: float, high: float) -> float:
    """A number as likely between 1 and 2 as between 2 and 4."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def signed(random: Random, size: float) -> float:
    """The size or its negative."""
    return size if random.random() < 0.5 else -size


def chance(random: Random, probability: float) -> bool:
    """True that often."""
    return bool(random.random() < probability)


def pick(random: Random, choices: list[str]) -> str:
    """One of them."""
    return choices[int(random.integers(len(choices)))]


def around(random: Random, size: float) -> tuple[float, float]:
    """A vector of the given length in any direction."""
    angle = random.uniform(-pi, pi)
    return size * cos(angle), size * sin(angle)


def robot(random: Random) -> Robot:
    """A robot between a toy and a transporter."""
    wheelbase = log_uniform(random, 0.1, 0.8)
    speed = log_uniform(random, max(0.06, 0.4 * wheelbase), min(1.5, 5 * wheelbase))
    turn = random.uniform(0.4, 1.6)
    perfect = chance(random, 0.1)
    ratios = [random.uniform(1 - w, 1 + w) for w in (0.015, 0.06, 0.02)]
    return Robot(
        wheelbase_m=round(wheelbase, 4),
        wheel_diameter_m=round(float(np.clip(wheelbase * random.uniform(0.15, 0.6), 0.03, 0.3)), 4),
        ticks_per_revolution=round(log_uniform(random, 200, 50_000)),
        e_d=1.0 if perfect else ratios[0],
        e_b=1.0 if perfect else ratios[1],
        e_s=1.0 if perfect else ratios[2],
        motor_lag_s=random.uniform(0.02, 0.15),
        top_speed_m_s=speed,
        top_turn_rad_s=turn,
        acceleration_m_s2=speed / random.uniform(0.3, 1.5),
        turn_acceleration_rad_s2=turn / random.uniform(0.2, 0.8),
        wheel_noise_sqrt_m=log_uniform(random, 1e-4, 1e-3) * min(1.0, wheelbase / 0.3),
        heading_noise_rad_sqrt_m=random.uniform(0, 2e-3) if chance(random, 0.5) else 0.0,
    )


def drive(random: Random) -> Drive:
    """A few runs, or a long one."""
    kind = pick(random, FREE + ROUND)
    controller = pick(random, ["open", "odometry", "truth"])
    is_long = chance(random, 0.15) and kind in FREE
    runs = 2 * random.integers(1, 7) if kind in ROUND else random.integers(2, 13)
    return Drive(
        kind=kind,
        controller="open" if kind in WITHOUT_PLAN else controller,
        control_period_s=0.05 if is_long else 0.02,
        feedback_delay_s=random.uniform(0.05, 0.2),
        runs=1 if is_long else int(runs),
        run_s=random.uniform(300, 1200) if is_long else random.uniform(20, 120),
        rest_s=random.uniform(1, 4),
        pause_s=random.uniform(0.2, 2) if chance(random, 0.6) else 0.0,
    )


def recording(random: Random) -> Recording:
    """A log between 10 and 200 Hz, poses between 5 and 100 Hz."""
    reference_rate = log_uniform(random, 5, 100)
    tick_rate = log_uniform(random, 10, 200)
    layout = pick(random, ["same", "nearest", "interleaved"])
    if layout == "nearest":
        tick_rate = max(tick_rate, 30.0, reference_rate)
    return Recording(
        tick_rate_hz=tick_rate,
        tick_jitter=float(random.choice([0.0, 0.02, 0.1, 0.4])),
        stamp_noise_s=random.uniform(0, 1e-3) if chance(random, 0.5) else 0.0,
        reference_rate_hz=reference_rate,
        layout=layout,
        start="room" if chance(random, 0.6) else "origin",
        wrap=chance(random, 0.7),
        first_count=int(random.integers(-(10**6), 10**6)) if chance(random, 0.5) else 0,
    )


def reference(random: Random) -> Reference:
    """Anything between motion capture and laser scans."""
    return Reference(
        position_noise_m=log_uniform(random, 2e-4, 5e-3),
        heading_noise_rad=log_uniform(random, 2e-4, 5e-3),
        noise=pick(random, ["gaussian", "gaussian", "t4", "correlated"]),
        correlation_s=log_uniform(random, 0.1, 2),
    )


def draw(random: Random) -> Setting:
    """A robot and its drives with nothing wrong but E_d, E_b and E_s."""
    return Setting(robot(random), drive(random), recording(random), reference(random))
