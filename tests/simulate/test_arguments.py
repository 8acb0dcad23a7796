import numpy as np
import pytest

from fricmb._simulate._arguments import check_span, check_step, check_tolerance
from fricmb.errors import FricmbError, SceneError


@pytest.mark.parametrize("t_end", [0.0, -1.0, np.nan, np.inf, "10", None, True, 1e-324 * 5, [1.0]])
def test_t_end_is_a_time_after_the_start(t_end):
    with pytest.raises(SceneError, match="t_end: got"):
        check_span(0.0, t_end, None)


@pytest.mark.parametrize(
    "t_eval", [[], [1.0, 0.5], [0.0, np.nan], [0.0, 10.1], [-0.1, 1.0], [[0.0, 1.0]], "all", [None]]
)
def test_t_eval_is_ordered_finite_and_inside(t_eval):
    with pytest.raises(SceneError, match="t_eval: ") as caught:
        check_span(0.0, 10.0, t_eval)
    assert "\n" not in str(caught.value)


def test_t_eval_outside_by_round_off_counts_as_the_end():
    times = np.cumsum(np.full(7000, 0.1))
    assert times[-1] != 700.0
    span = check_span(0.0, 700.0, times)
    assert span.t_eval.max() <= 700.0
    assert np.abs(span.t_eval - times).max() < 1e-8
    assert check_span(0.0, 1.0, [0, 1]).t_eval.dtype == float


@pytest.mark.parametrize("rtol", [0.0, -1e-3, 1.0, 1e-17, np.nan, "tight", None])
def test_rtol_has_a_range(rtol):
    with pytest.raises(SceneError, match=r"rtol: got .* expected a number from"):
        check_tolerance(rtol, None, 2)


def test_atol_for_all_for_each_and_for_each_position_and_velocity():
    assert check_tolerance(1e-6, None, 2).atol_q is None
    one = check_tolerance(1e-6, 1e-9, 2)
    assert one.atol_q.tolist() == one.atol_v.tolist() == [1e-9, 1e-9]
    each = check_tolerance(1e-6, [1e-9, 1e-8], 2)
    assert each.atol_q.tolist() == each.atol_v.tolist() == [1e-9, 1e-8]
    both = check_tolerance(1e-6, [1.0, 2.0, 3.0, 4.0], 2)
    assert (both.atol_q.tolist(), both.atol_v.tolist()) == ([1.0, 2.0], [3.0, 4.0])
    single = check_tolerance(1e-6, [3.0], 1)
    assert single.atol_q.tolist() == single.atol_v.tolist() == [3.0]


@pytest.mark.parametrize("atol", [0.0, -1.0, [1.0, 2.0, 3.0], [1.0, np.nan], "small", {"pad.x": 1.0}])
def test_atol_that_cannot_be(atol):
    with pytest.raises(SceneError, match="atol: got"):
        check_tolerance(1e-6, atol, 2)


def test_a_step_is_for_methods_of_fixed_step_alone():
    assert check_step(None, True, "bdf", 10.0) is None
    assert check_step(0.5, False, "bdf2-paper", 10.0) == 0.5
    with pytest.raises(FricmbError, match="chooses its steps itself"):
        check_step(0.5, True, "bdf", 10.0)
    for step in (None, 0.0, -1.0, 11.0, np.nan, "small"):
        with pytest.raises(SceneError, match=r"step: got .*'bdf2-paper' needs"):
            check_step(step, False, "bdf2-paper", 10.0)


def test_a_time_outside_is_said_as_it_was_given():
    with pytest.raises(SceneError, match=r"the time 0\.4 is outside the run, which goes from 0\.0 to 0\.3$"):
        check_span(0.0, 0.3, [0.0, 0.4])


def test_no_name_to_observe_is_refused():
    import fricmb as fm

    with pytest.raises(SceneError, match="observe: got no name; expected one or more"):
        fm.simulate(fm.models.belt_oscillator(), t_end=1.0, observe=[])


def test_a_method_that_is_gone_is_refused_with_advice():
    import fricmb as fm

    with pytest.raises(SceneError, match=r"method: 'timestepping': .* take 'auto', or 'radau'"):
        fm.simulate(fm.models.belt_oscillator(), t_end=1.0, method="timestepping")
