"""What an expert writes: a reading is one of four rigid motions, worked out beforehand.

At constant speed a wheel's count changes by one of two neighbouring numbers, whichever its phase
carries to. No trigonometry is left in the loop.
"""

import math

import numba
import numpy as np
from work import MOVES, Array, Program, Work, measure


def make(work: Work) -> Program:
    """Odometry by exact arcs."""
    all_readings, tick_m, rad_per_tick = work.readings, work.tick_m, work.rad_per_tick

    def program(segments: Array) -> tuple[Array, Array]:
        runs = segments.shape[2]
        xs, ys = np.empty(runs), np.empty(runs)
        chord, cosine_half, sine_half = np.empty(4), np.empty(4), np.empty(4)
        for run in range(runs):
            x, y, cosine, sine = 0.0, 0.0, 1.0, 0.0
            for move in range(MOVES):
                phase_left, phase_right = segments[move, 0, run], segments[move, 1, run]
                left, right = segments[move, 2, run], segments[move, 3, run]
                whole_left, whole_right = math.floor(left), math.floor(right)
                rest_left, rest_right = left - whole_left, right - whole_right
                for kind in range(4):
                    change_left = whole_left + (kind & 1)
                    change_right = whole_right + (kind >> 1)
                    half = 0.5 * rad_per_tick * (change_right - change_left)
                    sinc = math.sin(half) / half if half != 0.0 else 1.0
                    chord[kind] = 0.5 * tick_m * (change_left + change_right) * sinc
                    cosine_half[kind], sine_half[kind] = math.cos(half), math.sin(half)
                for _ in range(all_readings[move]):
                    phase_left += rest_left
                    phase_right += rest_right
                    kind = 0
                    if phase_left >= 1.0:
                        phase_left -= 1.0
                        kind = 1
                    if phase_right >= 1.0:
                        phase_right -= 1.0
                        kind += 2
                    c, s = cosine_half[kind], sine_half[kind]
                    cosine_middle, sine_middle = cosine * c - sine * s, sine * c + cosine * s
                    x += chord[kind] * cosine_middle
                    y += chord[kind] * sine_middle
                    cosine = cosine_middle * c - sine_middle * s
                    sine = sine_middle * c + cosine_middle * s
            xs[run], ys[run] = x, y
        return xs, ys

    compiled: Program = numba.njit(fastmath=True)(program)
    return compiled


if __name__ == "__main__":
    measure(make, chunk=10**9)
