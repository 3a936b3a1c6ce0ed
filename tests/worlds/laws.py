"""Physical laws besides wheels and wheelbase, as functions of arrays.

The simulation and the replay of ticks both call them, the one with steps of 1 ms, the other with
the rows of a log. Wheels are the first axis (left, right); time is the last.
"""

from math import pi

import numpy as np
from setting import Array, Laws

MOVING_M_S = 1e-3
"""Wheels slower than this are at rest."""


def wheel_travel(
    laws: Laws, rolled: Array, angle: Array, radii: Array, step_s: Array | float
) -> Array:
    """True travel of each wheel [m] that rolls by `rolled` [rad] around the given `angle` [rad]."""
    travel = rolled * radii
    if laws.slip_s_m:
        travel = travel * (1 - laws.slip_s_m * np.abs(travel) / step_s)
    if laws.eccentricity_left_m or laws.eccentricity_right_m:
        amplitude = np.array([laws.eccentricity_left_m, laws.eccentricity_right_m])
        amplitude = amplitude.reshape(-1, *[1] * (rolled.ndim - 1))
        travel = travel + amplitude * np.cos(angle + laws.eccentricity_phase_rad) * rolled
    return travel


def scrubbed(
    laws: Laws, forward: Array, turn: Array, wheelbase_m: float, step_s: Array | float
) -> Array:
    """The turn of each step [rad] that is left of the one that the wheels' travel makes."""
    if not laws.scrub_s_rad:
        return turn
    rim = np.abs(turn) * wheelbase_m / 2
    on_the_spot = rim / np.maximum(rim + np.abs(forward), 1e-12)
    return turn * (1 - laws.scrub_s_rad * np.abs(turn) / step_s * on_the_spot)


def added_turn(
    laws: Laws, travel: Array, forward: Array, heading: Array, time_s: Array, step_s: Array | float
) -> Array:
    """The turn of each step [rad] that does not come from a difference of the wheels."""
    turn = np.zeros_like(forward)
    if laws.slope_cosine_rad_m or laws.slope_sine_rad_m:
        slope = laws.slope_cosine_rad_m * np.cos(heading) + laws.slope_sine_rad_m * np.sin(heading)
        turn = turn + np.abs(forward) * slope
    if laws.wave_rad_s:
        moves = np.abs(travel).max(axis=0) > MOVING_M_S * step_s
        wave = laws.wave_rad_s * np.sin(2 * pi * time_s / laws.wave_period_s)
        turn = turn + np.where(moves, wave * step_s, 0.0)
    return turn
