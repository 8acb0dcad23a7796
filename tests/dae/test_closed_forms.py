"""Problems with closed solutions: accuracy, dense output, events, direction of time."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fricmb.dae import solve_dae


def coupled(t, y, yp):
    """Linear, index 1, with dF/dyp of rank 1 in a row that mixes: y = (exp(-t) + t sin t, sin t)."""
    return np.array([yp[0] - t * yp[1] + y[0] - (1.0 + t) * y[1], y[1] - np.sin(t)])


def coupled_solution(t):
    return np.array([np.exp(-t) + t * np.sin(t), np.sin(t)])


@pytest.mark.parametrize("rtol", [1e-3, 1e-5, 1e-7, 1e-9, 1e-11])
def test_linear_problem_keeps_the_tolerance(rtol):
    sol = solve_dae(coupled, (0.0, 10.0), [1.0, 0.0], rtol=rtol, atol=rtol, dense_output=True)
    assert sol.success, sol.message
    scale = 1.0 + np.abs(coupled_solution(sol.t))
    assert np.max(np.abs(sol.y - coupled_solution(sol.t)) / scale) < 100.0 * rtol
    t = np.linspace(0.0, 10.0, 2001)
    assert np.max(np.abs(sol.sol(t) - coupled_solution(t)) / (1.0 + np.abs(coupled_solution(t)))) < 100.0 * rtol


def test_error_falls_with_the_tolerance():
    errors, steps = [], []
    for rtol in (1e-4, 1e-6, 1e-8, 1e-10):
        sol = solve_dae(coupled, (0.0, 10.0), [1.0, 0.0], rtol=rtol, atol=rtol)
        errors.append(np.max(np.abs(sol.y - coupled_solution(sol.t))))
        steps.append(sol.nsteps)
    rate = np.diff(np.log(errors)) / np.log(1e-2)
    assert np.all(rate > 0.7)
    assert steps[-1] < 12 * steps[0]  # high orders are reached: order 1 would need 1000 times the steps


def test_dense_output_and_derivative_between_steps():
    sol = solve_dae(coupled, (0.0, 5.0), [1.0, 0.0], rtol=1e-9, atol=1e-9, dense_output=True)
    t = np.linspace(1.0, 5.0, 333)
    exact = np.array([-np.exp(-t) + np.sin(t) + t * np.cos(t), np.cos(t)])
    np.testing.assert_allclose(sol.sol.derivative(t), exact, atol=2e-6)
    assert sol.sol(2.0).shape == (2,)
    np.testing.assert_allclose(sol.sol(sol.t), sol.y, rtol=0, atol=1e-14)


def test_t_eval_is_the_dense_output():
    times = np.linspace(0.0, 5.0, 77)
    sol = solve_dae(coupled, (0.0, 5.0), [1.0, 0.0], rtol=1e-8, atol=1e-8, t_eval=times, dense_output=True)
    free = solve_dae(coupled, (0.0, 5.0), [1.0, 0.0], rtol=1e-8, atol=1e-8, t_eval=times)
    np.testing.assert_array_equal(sol.t, times)
    np.testing.assert_array_equal(sol.y, sol.sol(times))
    np.testing.assert_array_equal(sol.y, free.y)
    assert sol.y.shape == sol.yp.shape == (2, 77)


def test_backward_in_time():
    end = coupled_solution(3.0)
    sol = solve_dae(coupled, (3.0, 1.0), end, rtol=1e-8, atol=1e-8, dense_output=True)
    assert sol.t[0] == 3.0
    assert sol.t[-1] == 1.0
    t = np.linspace(1.0, 3.0, 50)
    np.testing.assert_allclose(sol.sol(t), coupled_solution(t), atol=2e-6)


def pendulum(t, y, yp):
    """Positions, velocities and the rod's force; the constraint differentiated twice (index 1)."""
    x, z, u, w, force = y
    return np.array([yp[0] - u, yp[1] - w, yp[2] + force * x, yp[3] + force * z + 9.81, u**2 + w**2 - force - 9.81 * z])


def test_pendulum_against_its_angle():
    sol = solve_dae(pendulum, (0.0, 3.0), [1.0, 0.0, 0.0, 0.0, 7.0], rtol=1e-9, atol=1e-9)
    assert sol.success, sol.message
    assert abs(sol.y[4, 0]) < 1e-9  # no force at the start; 7 was a guess
    angle = solve_ivp(
        lambda t, a: [a[1], -9.81 * np.sin(a[0])], (0.0, 3.0), [np.pi / 2, 0.0], method="DOP853", rtol=1e-12, atol=1e-12
    ).y[0, -1]
    np.testing.assert_allclose(sol.y[:2, -1], [np.sin(angle), -np.cos(angle)], atol=1e-6)


def ladder(t, y, yp):
    """Two RC stages behind a source; the source's current is algebraic."""
    u1, u2, current = y
    source = np.sin(3.0 * t)
    return np.array([current - (source - u1), yp[0] - current + (u1 - u2), 0.5 * yp[1] - (u1 - u2)])


def test_rc_circuit_against_its_matrix():
    from scipy.linalg import expm

    a = np.array([[-2.0, 1.0], [2.0, -2.0]])
    # u' = A u + b sin 3t has the particular solution Im(p exp(3 i t))
    p = np.linalg.solve(3j * np.eye(2) - a, np.array([1.0, 0.0]))
    exact = expm(4.0 * a) @ (np.array([0.3, -0.2]) - p.imag) + (p * np.exp(12j)).imag
    sol = solve_dae(ladder, (0.0, 4.0), [0.3, -0.2, 99.0], rtol=1e-9, atol=1e-10)
    np.testing.assert_allclose(sol.y[:2, -1], exact, atol=2e-7)
    np.testing.assert_allclose(sol.y[2, 0], -0.3, atol=1e-12)


def test_jump_of_the_source_is_stepped_over():
    """An algebraic component jumps with its input; the capacitor does not."""

    def fun(t, y, yp):
        source = 1.0 if t >= 1.0 else 0.0
        return np.array([yp[0] - y[1], y[1] - (source - y[0])])

    sol = solve_dae(fun, (0.0, 3.0), [0.0, 0.0], rtol=1e-8, atol=1e-10)
    assert sol.success, sol.message
    after = sol.t > 1.0
    exact = 1.0 - np.exp(-(sol.t[after] - 1.0))
    np.testing.assert_allclose(sol.y[0, after], exact, atol=1e-6)
    np.testing.assert_allclose(sol.y[1, after], 1.0 - exact, atol=1e-6)
    assert sol.nrestarts >= 1


def test_events_to_ten_digits():
    def crosses(t, y):
        return y[1]

    def falls(t, y):
        return y[1] - 0.5

    falls.direction = -1.0

    def fast(t, y, yp):
        return yp[1]

    sol = solve_dae(coupled, (0.1, 10.0), coupled_solution(0.1), rtol=1e-12, atol=1e-12, events=[crosses, falls, fast])
    np.testing.assert_allclose(sol.t_events[0], np.pi * np.array([1, 2, 3]), rtol=0, atol=1e-10)
    np.testing.assert_allclose(sol.t_events[1], [np.pi * 5 / 6, np.pi * 17 / 6], rtol=0, atol=1e-10)
    np.testing.assert_allclose(sol.t_events[2], np.pi * np.array([0.5, 1.5, 2.5]), rtol=0, atol=1e-8)
    np.testing.assert_allclose(sol.y_events[1][:, 1], 0.5, atol=1e-10)


@pytest.mark.parametrize(("terminal", "end"), [(True, np.pi), (2, 2.0 * np.pi)])
def test_terminal_event_ends_the_run(terminal, end):
    def crosses(t, y):
        return y[1]

    crosses.terminal = terminal
    sol = solve_dae(
        coupled, (0.1, 10.0), coupled_solution(0.1), rtol=1e-10, atol=1e-10, events=crosses, dense_output=True
    )
    assert sol.status == 1
    assert sol.message == "A termination event occurred."
    np.testing.assert_allclose(sol.t[-1], end, atol=1e-8)
    np.testing.assert_allclose(sol.y[:, -1], coupled_solution(end), atol=1e-7)
    assert sol.sol.t_max == sol.t[-1]
    assert np.all(np.diff(sol.t) > 0.0)


def test_terminal_event_with_t_eval():
    def crosses(t, y):
        return y[1]

    crosses.terminal = True
    times = np.linspace(0.1, 10.0, 100)
    sol = solve_dae(coupled, (0.1, 10.0), coupled_solution(0.1), t_eval=times, rtol=1e-9, atol=1e-9, events=crosses)
    np.testing.assert_array_equal(sol.t, times[times <= np.pi])


@pytest.mark.parametrize("max_order", [1, 2, 3, 4, 5])
def test_every_order_converges(max_order):
    """The error of the run is that of a step times the steps in the memory of the problem: more at low order."""
    rtol = 1e-5 if max_order == 1 else 1e-7
    sol = solve_dae(coupled, (0.0, 3.0), [1.0, 0.0], rtol=rtol, atol=rtol, max_order=max_order)
    assert np.max(np.abs(sol.y - coupled_solution(sol.t))) < (1000.0 if max_order < 3 else 100.0) * rtol


def test_step_options():
    sol = solve_dae(coupled, (0.0, 3.0), [1.0, 0.0], first_step=1e-3, max_step=0.01)
    assert sol.t[1] <= 1e-3
    assert np.max(np.diff(sol.t)) <= 0.01 * (1.0 + 1e-12)
