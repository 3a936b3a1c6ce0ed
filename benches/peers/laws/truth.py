"""What is known of a made set: what its truth leaves, and what a method should have found."""

import sys
from typing import Any

import numpy as np
from drives import AT, VARIABLES, Array, Run
from increments import Increments
from predicted import MOTIONS, Law
from sets import WORLDS, Split

sys.path.append(str(WORLDS))

import judge
import naming
import replay
import words

ALWAYS = words.ALWAYS
"""Steps of `umbmark learn` on every robot."""
EXPOSURES = {"speed", "turn_rate"}
"""Variables that every law per metre or radian has in it when it is written per second."""
ALIKE = ({"x", "y"}, {"wheel_angle_left", "wheel_angle_right"})
"""Either of these stands for the other."""


class Truth:
    """The truth of a set."""

    def __init__(self, split: Split) -> None:
        """Read it from what was made."""
        assert split.made
        self.folder = split.made
        self.about: dict[str, Any] = replay.read_truth(split.made)
        self.setting = replay.setting_in(self.about)

    @property
    def law(self) -> str | None:
        """The hidden law in a few words."""
        return judge.law_of(self.about) if self.setting.laws.law_kind else None

    def shown(self, run: Run) -> Array:
        """The poses that the true robot has, at the rows that have one."""
        rows = replay.read_log(self.folder / "runs" / f"{run.name}.csv")
        about, stamp_s = self.about["logs"][run.name], rows[:, 0]
        start = np.array(about["start_in_room"])
        angle = replay.wheels_of(rows, self.setting)
        body = replay.replayed(stamp_s + about["begin_s"], angle, self.setting, start)
        when_s = stamp_s[run.seen] * (1 - self.setting.reference.clock_rate) - about["delay_s"]
        return np.asarray(replay.shown(stamp_s, body, when_s, self.setting))

    @property
    def variables(self) -> set[str]:
        """What the hidden law depends on."""
        kind = self.setting.laws.law_kind
        return {"x", "y"} if kind in naming.OF_PLACE else set(naming.RIGHT[kind].variables)

    def is_found(self, law: Law, data: Increments) -> bool:
        """Whether the variable that matters most to the right motion of a learnt law is right."""
        motion = MOTIONS.index(self.setting.laws.law_acts_on)
        return most_relevant(law, data, motion, self.variables - EXPOSURES) in self.variables

    def named(self, answers: dict[str, Any]) -> str:
        """How well umbmark named the law: no, class or right."""
        return str(naming.named_law(answers, self.about, self.setting)["law_right"])

    def wrong(self, answer: dict[str, Any]) -> list[str]:
        """What umbmark added to a robot without a law."""
        return judge.additions(answer, self.about, {})[1]


def most_relevant(law: Law, data: Increments, motion: int, wanted: set[str]) -> str | None:
    """The variable whose shuffling changes a law of one motion most; none without a law.

    Where the true law depends on more than speeds, these do not count: any law per second has them.
    """
    data = data.sample(1500)
    before = law.rates(data.features)[:, motion]
    if not before.any():
        return None
    random = np.random.default_rng(0)
    changes: dict[str, float] = {}
    for name in VARIABLES:
        if wanted and name in EXPOSURES:
            continue
        group = next((alike for alike in ALIKE if name in alike), {name})
        columns = [AT[one] for one in group]
        features = data.features.copy()
        features[:, columns] = features[random.permutation(len(features))][:, columns]
        after = law.rates(features)[:, motion]
        changes[name] = float((((after - before) * data.seconds) ** 2).mean())
    best = max(changes, key=lambda name: changes[name])
    return best if changes[best] > 0 else None
