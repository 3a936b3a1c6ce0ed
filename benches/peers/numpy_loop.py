"""A loop over the readings, vectorised over runs; chunks that stay in the cache."""

import numpy as np
from work import Array, Program, Work, measure


def make(work: Work) -> Program:
    """Odometry by the midpoint rule."""

    def program(segments: Array) -> tuple[Array, Array]:
        runs = segments.shape[2]
        x, y, heading = np.zeros(runs), np.zeros(runs), np.zeros(runs)
        for (start_left, start_right, left, right), readings in zip(
            segments, work.readings, strict=True
        ):
            count_left, count_right = np.zeros(runs), np.zeros(runs)
            for k in range(1, readings + 1):
                next_left = np.floor(start_left + left * k)
                next_right = np.floor(start_right + right * k)
                change_left, change_right = next_left - count_left, next_right - count_right
                count_left, count_right = next_left, next_right
                distance = (0.5 * work.tick_m) * (change_left + change_right)
                turn = work.rad_per_tick * (change_right - change_left)
                middle = heading + 0.5 * turn
                x += distance * np.cos(middle)
                y += distance * np.sin(middle)
                heading += turn
        return x, y

    return program


if __name__ == "__main__":
    measure(make, chunk=4096)
