"""The loop one writes by hand, compiled."""

import math

import numba
import numpy as np
from work import MOVES, Array, Program, Work, measure


def make(work: Work) -> Program:
    """Odometry by the midpoint rule."""
    all_readings, tick_m, rad_per_tick = work.readings, work.tick_m, work.rad_per_tick

    def program(segments: Array) -> tuple[Array, Array]:
        runs = segments.shape[2]
        xs, ys = np.empty(runs), np.empty(runs)
        for run in range(runs):
            x, y, heading = 0.0, 0.0, 0.0
            for move in range(MOVES):
                start_left, start_right = segments[move, 0, run], segments[move, 1, run]
                left, right = segments[move, 2, run], segments[move, 3, run]
                count_left, count_right = 0.0, 0.0
                for k in range(1, all_readings[move] + 1):
                    next_left = math.floor(start_left + left * k)
                    next_right = math.floor(start_right + right * k)
                    change_left, change_right = next_left - count_left, next_right - count_right
                    count_left, count_right = next_left, next_right
                    distance = 0.5 * tick_m * (change_left + change_right)
                    turn = rad_per_tick * (change_right - change_left)
                    middle = heading + 0.5 * turn
                    x += distance * math.cos(middle)
                    y += distance * math.sin(middle)
                    heading += turn
            xs[run], ys[run] = x, y
        return xs, ys

    compiled: Program = numba.njit(fastmath=True)(program)
    return compiled


if __name__ == "__main__":
    measure(make, chunk=10**9)
