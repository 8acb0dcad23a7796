from dataclasses import replace

import numpy as np
import pytest

from fricmb.errors import SceneError
from fricmb.solution import Solution


def test_joined_runs_are_the_whole_run(make):
    whole = make()
    joined = Solution.join([make(0.0, 7.0), make(7.0, 12.0), make(12.0, 20.0)])
    assert (joined.t_start, joined.t_end) == (0.0, 20.0)
    assert (np.diff(joined.t) >= 0).all()
    assert joined.events == whole.events
    t = np.array([13.0, 7.0, 3.0, 12.0, 0.0, 20.0])
    np.testing.assert_allclose(joined(t), whole(t), atol=1e-15)
    np.testing.assert_allclose(joined.at(t).energy.friction_loss, whole.at(t).energy.friction_loss, atol=1e-14)
    assert np.abs(joined.energy.residual).max() < 1e-14
    assert joined.stats.n_steps == 3 * 41
    assert joined.stats.wall_s == 1.5
    np.testing.assert_allclose(joined.at(t)["base.x"], 0.1 * t)


def test_a_value_changed_between_the_runs_counts_as_input(make):
    joined = Solution.join([make(0.0, 7.0), make(7.0, 20.0, stiffness=3.0)])
    added = joined.q[0, joined.t == 7.0][0] ** 2
    np.testing.assert_allclose(joined.energy.input, np.repeat([0.0, added], [41 + 4, 41 + 6]), atol=1e-14)
    two = np.flatnonzero(joined.t == 7.0)
    assert joined.energy.potential[two[1]] == pytest.approx(3 * joined.energy.potential[two[0]])
    assert np.abs(joined.energy.residual[: two[1] + 1]).max() < 1e-14


def test_joined_runs_keep_their_times(make):
    joined = Solution.join([make(0.0, 7.0, times=np.array([1.0, 2.0])), make(7.0, 9.0, times=np.array([7.0, 8.0]))])
    assert joined.t.tolist() == [1.0, 2.0, 7.0, 8.0]
    assert Solution.join([joined]) is joined


@pytest.mark.parametrize("given", [None, 3, [3], "ab"])
def test_what_is_no_solution_is_refused(given):
    with pytest.raises(SceneError, match=r"Solution.join: .*expected a (list of solutions|Solution)"):
        Solution.join(given)


def test_runs_that_do_not_go_on_are_refused(make):
    with pytest.raises(SceneError, match="expected one that goes on"):
        Solution.join([make(0.0, 7.0), make(8.0, 9.0)])
    with pytest.raises(SceneError, match="no solution"):
        Solution.join([])
    other = make(7.0, 9.0)
    other.names = replace(other.names, dofs=("block.x",))
    with pytest.raises(SceneError, match="different dofs"):
        Solution.join([make(0.0, 7.0), other])
