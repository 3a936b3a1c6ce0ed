"""Tests of one or two runs: whatever is asked of them is answered, and nothing is claimed."""

import numpy as np
import pytest
import umbmark


@pytest.mark.parametrize("runs", [(1, 0), (2, 0), (1, 1), (2, 1), (2, 2)])
@pytest.mark.parametrize("error", [(0.0, 0.0, 0.0), (0.1, 0.02, 0.01), (0.1, 0.02, np.nan)])
def test_few_runs_are_not_enough_data_whatever_is_asked(
    runs: tuple[int, int], error: tuple[float, float, float]
) -> None:
    robot, path = umbmark.Model().robot, umbmark.Path.square(1.0)
    cw, ccw = ([error] * count if count else np.empty((0, 3)) for count in runs)
    data = umbmark.Dataset.from_arrays(cw, ccw, robot=robot, path=path)
    assert umbmark.score(data).n_cw == runs[0]
    assert umbmark.diagnose(data, draws=99).verdict == "not_enough_data"
    assert umbmark.learn(data, draws=99).verdict == "not_enough_data"
    assert umbmark.solve(data, draws=99).correction is not None
    assert len(umbmark.compare(data, draws=99).table()) > 0
    assert umbmark.inspect(data).text
