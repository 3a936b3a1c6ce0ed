"""What all methods learn from: by how much the robot moves otherwise than the fitted robot.

Poses within 3 cm and 0.05 rad of the way are one place, their mean, as in `umbmark compare`. A
step goes on until the robot has driven 10 cm or turned by 0.2 rad.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from drives import POSE, Array, Rows, Run, mean_pose, seen_from
from predicted import Fitted, driven

BLOCK = (0.03, 0.05)
STEP = (0.10, 0.20)
LONGEST_S = 10.0
"""A step that takes longer says nothing of how the robot drove in it."""
PARTS = 4
"""Validation takes each run in so many parts."""


@dataclass
class Increments:
    """Steps of all runs, one below the other."""

    features: Array
    """[steps x variables]; means over the step."""
    moved: Array
    """[steps x 3] forward, sideways [m] and yaw [rad], less those of the fitted robot."""
    seconds: Array
    run: Rows
    part: Rows
    """The quarter of the run, counted through all runs."""

    def take(self, rows: npt.NDArray[np.bool_] | Rows) -> "Increments":
        """Some of the steps."""
        return Increments(
            self.features[rows],
            self.moved[rows],
            self.seconds[rows],
            self.run[rows],
            self.part[rows],
        )

    def summed(self, values: Array) -> Array:
        """Values [steps x ...] of the steps, added up from the beginning of each part.

        Noise of a pose is in two steps, once with each sign: in sums it cancels.
        """
        begins = np.flatnonzero(np.diff(self.part, prepend=-1))
        sums = np.concatenate([np.zeros_like(values[:1]), values.cumsum(axis=0)])
        return np.asarray(sums[1:] - np.repeat(sums[begins], np.diff([*begins, len(values)]), 0))

    def merged(self, count: int) -> "Increments":
        """So many neighbouring steps of a part as one; their features are means."""
        place = np.arange(len(self.part))
        begins = np.flatnonzero(np.diff(self.part, prepend=-1))
        since = place - np.repeat(begins, np.diff([*begins, len(place)]))
        first = np.flatnonzero(since % count == 0)
        seconds = np.add.reduceat(self.seconds, first)
        features = np.add.reduceat(self.features * self.seconds[:, None], first, axis=0)
        moved = np.add.reduceat(self.moved, first, axis=0)
        return Increments(
            features / seconds[:, None], moved, seconds, self.run[first], self.part[first]
        )

    def sample_parts(self, most: int) -> "Increments":
        """Whole parts at random, with not many more steps than so many."""
        drawn = np.random.default_rng(0).permutation(np.unique(self.part))
        counts = np.array([(self.part == part).sum() for part in drawn])
        return self.take(np.isin(self.part, drawn[: np.searchsorted(counts.cumsum(), most) + 1]))

    def sample(self, most: int) -> "Increments":
        """Not more than so many of the steps, at random."""
        if len(self.run) <= most:
            return self
        chosen = np.random.default_rng(0).choice(len(self.run), most, replace=False)
        return self.take(np.sort(chosen))


def blocks_of(run: Run, robot_wheelbase_m: float) -> list[Rows]:
    """The poses of a run, as indices into its measured ones, in places."""
    left, right = np.diff(run.travel)
    way = np.concatenate([[0.0], np.abs((left + right) / 2).cumsum()])[run.seen]
    turned = np.concatenate([[0.0], np.abs((right - left) / robot_wheelbase_m).cumsum()])[run.seen]
    begins = [0]
    for pose in range(len(run.seen)):
        first = begins[-1]
        if way[pose] - way[first] >= BLOCK[0] or turned[pose] - turned[first] >= BLOCK[1]:
            begins.append(pose)
    return np.split(np.arange(len(run.seen)), begins[1:])


def means(poses: Array, blocks: list[Rows]) -> Array:
    """The mean pose of each place."""
    return np.stack([mean_pose(poses[block]) for block in blocks])


def increments_of(runs: list[Run], fitted: Fitted) -> Increments:
    """The steps of some runs."""
    parts = [of_run(run, fitted, number) for number, run in enumerate(runs)]
    return Increments(
        np.concatenate([one.features for one in parts]),
        np.concatenate([one.moved for one in parts]),
        np.concatenate([one.seconds for one in parts]),
        np.concatenate([one.run for one in parts]),
        np.concatenate([one.part for one in parts]),
    )


def of_run(run: Run, fitted: Fitted, number: int) -> Increments:
    """The steps of a run."""
    blocks = blocks_of(run, fitted.robot.wheelbase_m)
    start = run.at_start
    predicted = means(fitted.shown(run, driven(run, fitted, start)), blocks)
    measured = means(run.measured, blocks)
    row = np.array([run.seen[block[len(block) // 2]] for block in blocks])
    features = run.features.copy()
    # The pose of the robot, where it was measured.
    body = [np.interp(run.time, run.time[run.seen], column) for column in run.measured.T]
    poses = np.stack(body, axis=1) - [0.0, 0.0, fitted.yaw]
    features[:, POSE] = (poses[1:] + poses[:-1]) / 2
    ends = steps_of(predicted)
    first, last = ends[:-1], ends[1:]
    own = motions(seen_from(predicted[first], predicted[last]))
    true = motions(seen_from(measured[first], measured[last]))
    moved = true - own
    over = [slice(row[a], max(row[b], row[a] + 1)) for a, b in zip(first, last, strict=True)]
    weight = np.diff(run.time) * run.moves
    moving = np.array([weight[one].sum() for one in over])
    keep = (moving > 0) & (run.time[row[last]] - run.time[row[first]] < LONGEST_S)
    mean = np.stack(
        [np.average(features[one], axis=0, weights=np.maximum(weight[one], 1e-9)) for one in over]
    )
    part = np.arange(len(over)) * PARTS // max(len(over), 1) + PARTS * number
    whole = Increments(mean, moved, moving, np.full(len(over), number), part)
    return whole.take(keep)


def motions(seen: Array) -> Array:
    """Forward, sideways and yaw motion that leads at a steady pace to a pose, as seen before it.

    A yaw that is off moves the robot aside in the same step; as a motion it is yaw alone.
    """
    half = seen[:, 2] / 2
    stretched = half / np.where(np.abs(half) < 1e-9, 1.0, np.tan(half))
    stretched = np.where(np.abs(half) < 1e-9, 1.0, stretched)
    forward = stretched * seen[:, 0] + half * seen[:, 1]
    sideways = stretched * seen[:, 1] - half * seen[:, 0]
    return np.stack([forward, sideways, seen[:, 2]], axis=1)


def steps_of(places: Array) -> Rows:
    """The places at which steps end."""
    ends = [0]
    for place in range(1, len(places)):
        before = places[ends[-1]]
        way = np.hypot(*(places[place] - before)[:2])
        if way >= STEP[0] or abs(places[place, 2] - before[2]) >= STEP[1]:
            ends.append(place)
    return np.array(ends)
