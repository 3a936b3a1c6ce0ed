"""A compiled loop over the readings, vectorised over runs, on the CPU."""

import jax
import jax.numpy as jnp
import numpy as np
from work import Array, Program, Work, measure


def make(work: Work) -> Program:
    """Odometry by the midpoint rule."""

    @jax.jit
    def ends(segments: jax.Array) -> tuple[jax.Array, jax.Array]:
        zero = jnp.zeros(segments.shape[2])
        x, y, heading = zero, zero, zero
        for (start_left, start_right, left, right), readings in zip(
            segments, work.readings, strict=True
        ):

            def read(
                k: int,
                state: tuple[jax.Array, ...],
                start: tuple[jax.Array, jax.Array] = (start_left, start_right),
                travel: tuple[jax.Array, jax.Array] = (left, right),
            ) -> tuple[jax.Array, ...]:
                x, y, heading, count_left, count_right = state
                next_left = jnp.floor(start[0] + travel[0] * (k + 1.0))
                next_right = jnp.floor(start[1] + travel[1] * (k + 1.0))
                change_left, change_right = next_left - count_left, next_right - count_right
                distance = (0.5 * work.tick_m) * (change_left + change_right)
                turn = work.rad_per_tick * (change_right - change_left)
                middle = heading + 0.5 * turn
                x += distance * jnp.cos(middle)
                y += distance * jnp.sin(middle)
                return x, y, heading + turn, next_left, next_right

            state = (x, y, heading, zero, zero)
            x, y, heading, _, _ = jax.lax.fori_loop(0, readings, read, state, unroll=4)
        return x, y

    def program(segments: Array) -> tuple[Array, Array]:
        x, y = ends(jnp.asarray(segments))
        return np.asarray(x), np.asarray(y)

    return program


if __name__ == "__main__":
    measure(make, chunk=5000)
