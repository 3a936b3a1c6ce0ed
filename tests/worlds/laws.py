"""Physical laws besides wheels and wheelbase, as functions of arrays.

The simulation and the replay of ticks both call them, the one with steps of 1 ms, the other with
the rows of a log. Wheels are the first axis (left, right); time is the last.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from typing import TypeAlias

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
    if laws.body_slip_s_m:
        travel = travel * (1 - laws.body_slip_s_m * np.abs(travel.mean(axis=0)) / step_s)
    if laws.forward_slip_s_m:
        way = travel.mean(axis=0)
        travel = travel - laws.forward_slip_s_m * np.abs(way) / step_s * way
    if laws.squared_slip_s2_m2:
        speed = travel / step_s
        travel = travel * (1 - laws.squared_slip_s2_m2 * speed**2)
    if laws.squared_forward_slip_s2_m2:
        way = travel.mean(axis=0)
        travel = travel - laws.squared_forward_slip_s2_m2 * (way / step_s) ** 2 * way
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


@dataclass(frozen=True)
class Situation:
    """How and where a robot drives, in the middle of each step."""

    time_s: Array
    """Since the robot was switched on."""
    way_m: Array
    """Driven since then, ahead or back."""
    heading: Array
    x_m: Array
    y_m: Array
    speed_m_s: Array
    """Of the axle's centre, as are the next two; what the wheels do, without hidden laws."""
    turn_rad_s: Array
    acceleration_m_s2: Array
    wheel_angle: Array
    """[2 x ..., rad] left, right."""
    moves: Array
    """1 where a wheel turns, else 0."""


Shape: TypeAlias = Callable[[Laws, Situation], Array]
"""What a law depends on, and how; its size is a factor of it."""


def time_wave(laws: Laws, at: Situation) -> Array:
    """A wave of the time; its scale is the period."""
    return np.asarray(np.sin(2 * pi * at.time_s / laws.law_scale + laws.law_phase_rad))


def way_wave(laws: Laws, at: Situation) -> Array:
    """A wave of the way driven; its scale is the period."""
    return np.asarray(np.sin(2 * pi * at.way_m / laws.law_scale + laws.law_phase_rad))


def heading_wave(laws: Laws, at: Situation) -> Array:
    """A harmonic of the heading in the room."""
    return np.asarray(np.sin(laws.law_order * at.heading + laws.law_phase_rad))


def speed_squared(_: Laws, at: Situation) -> Array:
    """Grows with the square of the speed."""
    return at.speed_m_s**2


def speed_above(laws: Laws, at: Situation) -> Array:
    """Acts above a speed."""
    return np.asarray(np.abs(at.speed_m_s) > laws.law_scale, dtype=float)


def speed_tanh(laws: Laws, at: Situation) -> Array:
    """Grows with the speed up to a limit."""
    return np.asarray(np.tanh(np.abs(at.speed_m_s) / laws.law_scale))


def speed_times_turn_rate(_: Laws, at: Situation) -> Array:
    """Acts in arcs, as a side force does."""
    return at.speed_m_s * at.turn_rad_s


def speed_times_heading(laws: Laws, at: Situation) -> Array:
    """A wave of the heading that grows with the speed."""
    return np.abs(at.speed_m_s) * np.sin(at.heading + laws.law_phase_rad)


def turn_rate_above(laws: Laws, at: Situation) -> Array:
    """Acts above a turn rate, either way."""
    return np.asarray(np.abs(at.turn_rad_s) > laws.law_scale, dtype=float)


def turn_rate_squared(_: Laws, at: Situation) -> Array:
    """Grows with the square of the turn rate, with its sense."""
    return at.turn_rad_s * np.abs(at.turn_rad_s)


def braking(laws: Laws, at: Situation) -> Array:
    """Acts while the robot brakes harder than so."""
    slower = -at.acceleration_m_s2 * np.sign(at.speed_m_s)
    return np.asarray(slower > laws.law_scale, dtype=float)


def fading(laws: Laws, at: Situation) -> Array:
    """Dies out with time."""
    return np.asarray(np.exp(-at.time_s / laws.law_scale))


def growing(laws: Laws, at: Situation) -> Array:
    """Grows with a power of the time in minutes."""
    return np.asarray((at.time_s / 60) ** laws.law_order)


def disc(laws: Laws, at: Situation) -> Array:
    """Acts on a round patch of the floor."""
    away = np.hypot(at.x_m - laws.law_x_m, at.y_m - laws.law_y_m)
    return np.asarray(away < laws.law_scale, dtype=float)


def place_x(_: Laws, at: Situation) -> Array:
    """In proportion to x in the room."""
    return at.x_m


def place_y_squared(_: Laws, at: Situation) -> Array:
    """In proportion to the square of y in the room."""
    return at.y_m**2


def wall(laws: Laws, at: Situation) -> Array:
    """Dies out away from a wall at a given x."""
    return np.asarray(np.exp(-np.maximum(at.x_m - laws.law_x_m, 0.0) / laws.law_scale))


def wheel_pulse(laws: Laws, at: Situation) -> Array:
    """A narrow bump once a turn of a wheel; its scale is the standard deviation of the bump."""
    angle = at.wheel_angle[("left", "right").index(laws.law_wheel)] - laws.law_phase_rad
    return np.asarray(np.exp((np.cos(angle) - 1) / laws.law_scale**2))


SHAPES: dict[str, Shape] = {
    shape.__name__: shape
    for shape in (
        time_wave,
        way_wave,
        heading_wave,
        speed_squared,
        speed_above,
        speed_tanh,
        speed_times_turn_rate,
        speed_times_heading,
        turn_rate_above,
        turn_rate_squared,
        braking,
        fading,
        growing,
        disc,
        place_x,
        place_y_squared,
        wall,
        wheel_pulse,
    )
}
"""Laws that no catalogue lists, by the names that `law_kind` has."""
MOTIONS = ("forward", "sideways", "yaw")
"""What a law may act on."""


def unlisted_motion(
    laws: Laws, at: Situation, forward: Array, turn: Array, step_s: Array | float
) -> Array:
    """What the law that no catalogue lists adds to each step [3 x ...]: forward, sideways, yaw.

    Of the forward motion it adds a share: less way ahead, and less way back.
    """
    per = {
        "metre": forward if laws.law_acts_on == "forward" else np.abs(forward),
        "second": at.moves * step_s,
        "radian": np.abs(turn),
    }
    value = laws.law_size * SHAPES[laws.law_kind](laws, at)
    added = np.zeros((3, *forward.shape))
    added[MOTIONS.index(laws.law_acts_on)] = value * per[laws.law_per]
    return added
