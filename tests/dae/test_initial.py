"""Consistent initial values, and the messages for problems that have none."""

import numpy as np
import pytest

from fricmb.dae import solve_dae
from fricmb.errors import IntegrationError


def test_kernel_that_no_single_unknown_spans():
    """A capacitor between two nodes: its voltage y0 - y1 is kept, the nodes move together."""

    def fun(t, y, yp):
        charge = yp[0] - yp[1]
        return np.array([charge + y[0] - 1.0, -charge + y[1]])

    sol = solve_dae(fun, (0.0, 1.0), [3.0, 1.0], rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(sol.y[0, 0] - sol.y[1, 0], 2.0, atol=1e-12)
    np.testing.assert_allclose(sol.y[:, 0].sum(), 1.0, atol=1e-12)
    # u = y0 - y1 obeys 2 u' = 1 - u
    np.testing.assert_allclose(sol.y[0, -1] - sol.y[1, -1], 1.0 + np.exp(-0.5), atol=1e-7)


def test_consistent_values_are_left_alone():
    y0, yp0 = [1.0, 0.0], [-1.0, 1.0]
    sol = solve_dae(
        lambda t, y, yp: np.array([yp[0] - t * yp[1] + y[0] - (1.0 + t) * y[1], y[1] - np.sin(t)]), (0.0, 1.0), y0, yp0
    )
    np.testing.assert_array_equal(sol.y[:, 0], y0)
    np.testing.assert_array_equal(sol.yp[:, 0], yp0)


def test_derivative_of_algebraic_unknowns():
    sol = solve_dae(lambda t, y, yp: np.array([yp[0] + y[0], y[1] - y[0] ** 2 - np.sin(t)]), (0.0, 1.0), [1.0, 5.0])
    np.testing.assert_allclose(sol.y[:, 0], [1.0, 1.0], atol=1e-10)
    np.testing.assert_allclose(sol.yp[:, 0], [-1.0, -1.0], atol=1e-6)  # 2 y y' + cos t


def test_inconsistent_derivative_is_a_guess():
    sol = solve_dae(lambda t, y, yp: np.array([yp[0] + y[0], y[1] - y[0]]), (0.0, 1.0), [1.0, 7.0], [5.0, 0.0])
    np.testing.assert_allclose(sol.y[:, 0], [1.0, 1.0], atol=1e-10)
    np.testing.assert_allclose(sol.yp[:, 0], [-1.0, -1.0], atol=1e-6)


def test_hard_algebraic_start_needs_damping():
    """A diode in series with a resistor, started far off: full Newton steps overflow."""

    def fun(t, y, yp):
        with np.errstate(over="ignore"):
            return np.array([yp[0] + y[0], 1e-12 * (np.exp(y[1] / 0.025) - 1.0) + (y[1] - 5.0 * y[0]) / 100.0])

    sol = solve_dae(fun, (0.0, 0.5), [1.0, 3.0])
    u = sol.y[1, 0]
    assert abs(1e-12 * (np.exp(u / 0.025) - 1.0) - (5.0 - u) / 100.0) < 1e-9


def test_index_three_pendulum_is_named():
    def fun(t, y, yp):
        x, z, u, w, force = y
        return np.array([yp[0] - u, yp[1] - w, yp[2] + force * x, yp[3] + force * z + 9.81, x**2 + z**2 - 1.0])

    with pytest.raises(IntegrationError, match=r"equation 4 .*index above 1") as error:
        solve_dae(fun, (0.0, 1.0), [1.0, 0.0, 0.0, 0.0, 0.0])
    assert error.value.t == 0.0


def test_undetermined_unknown_is_named():
    with pytest.raises(IntegrationError, match=r"y\[1\].*index above 1 or singular"):
        solve_dae(lambda t, y, yp: np.array([yp[0] + y[0], y[2] - y[0], y[2] + y[0]]), (0.0, 1.0), [1.0] * 3)


def test_combination_that_is_undetermined():
    """y1 and y2 occur as their sum alone."""

    def fun(t, y, yp):
        return np.array([yp[0] + y[0], y[1] + y[2] - y[0], 2.0 * (y[1] + y[2]) - 2.0 * y[0]])

    with pytest.raises(IntegrationError, match=r"y\[1\], y\[2\]"):
        solve_dae(fun, (0.0, 1.0), [1.0, 0.0, 0.0])


def test_no_solution_nearby():
    with pytest.raises(IntegrationError, match="No consistent initial values at t = 0"):
        solve_dae(lambda t, y, yp: np.array([yp[0] + y[0], y[1] ** 2 + 1.0 + y[0] ** 2]), (0.0, 1.0), [1.0, 0.5])


def test_residual_that_is_not_finite():
    with pytest.raises(IntegrationError, match=r"not finite at the initial values \(component 1 is nan\)"):
        solve_dae(lambda t, y, yp: np.array([yp[0] + y[0], np.nan]), (0.0, 1.0), [1.0, 1.0])


def test_blow_up_is_reported_and_everything_returned_is_finite():
    sol = solve_dae(lambda t, y, yp: np.array([yp[0] - y[0] ** 2, y[1] - y[0]]), (0.0, 2.0), [1.0, 1.0], rtol=1e-6)
    assert not sol.success
    assert sol.status == -1
    assert "too small at t = " in sol.message
    assert np.all(np.isfinite(sol.y))
    assert np.all(np.isfinite(sol.yp))
    assert abs(sol.t[-1] - 1.0) < 1e-4


def test_domain_that_ends_is_reported():
    """y' = -1/(2 sqrt(y)) with y >= 0 ends at t = 2/3 ... y = (1 - 3t/4)^(2/3)."""

    def fun(t, y, yp):
        return np.array([yp[0] + 0.5 / np.sqrt(y[0]) if y[0] > 0.0 else np.nan])

    sol = solve_dae(fun, (0.0, 3.0), [1.0], rtol=1e-8, atol=1e-10)
    assert not sol.success
    np.testing.assert_allclose(sol.t[-1], 4.0 / 3.0, rtol=1e-5)
    assert "\n" not in sol.message


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"y0": [[1.0]]}, "1-D"),
        ({"y0": []}, "at least one component"),
        ({"y0": [np.nan]}, "finite"),
        ({"y0": [1j]}, "real"),
        ({"yp0": [1.0, 2.0]}, "shape of `y0`"),
        ({"t_span": (0.0,)}, "pair"),
        ({"t_span": (0.0, np.inf)}, "finite"),
        ({"rtol": -1.0}, "not be negative"),
        ({"atol": [1.0, 2.0]}, "shape"),
        ({"t_eval": [0.0, 2.0]}, "not within"),
        ({"t_eval": [0.5, 0.2]}, "sorted"),
        ({"max_order": 6}, "1 to 5"),
        ({"max_step": 0.0}, "positive"),
        ({"first_step": 2.0}, "exceeds bounds"),
        ({"bandwidth": (-1, 0)}, "negative"),
        ({"bandwidth": 3}, "pair"),
        ({"jac_sparsity": np.ones((2, 2))}, "shape"),
        ({"jac": 3}, "callable"),
        ({"jac": lambda t, y, yp: np.eye(1)}, "pair"),
        ({"jac": lambda t, y, yp: (np.eye(2), np.eye(2))}, "shape"),
        ({"args": 3}, "tuple"),
        ({"events": 3}, "callable"),
        ({"fun": 3}, "callable"),
        ({"fun": lambda t, y, yp: np.zeros(3)}, "shape"),
        ({"fun": lambda t, y, yp: yp + 1j}, "real"),
    ],
)
def test_bad_arguments(change, message):
    given = {"fun": lambda t, y, yp: yp + y, "t_span": (0.0, 1.0), "y0": [1.0], **change}
    with pytest.raises(ValueError, match=message) as error:
        solve_dae(given.pop("fun"), given.pop("t_span"), given.pop("y0"), **given)
    assert "\n" not in str(error.value)


def test_function_that_changes_its_argument():
    def fun(t, y, yp):
        y += 1.0
        return yp + y

    with pytest.raises(ValueError, match="must not change"):
        solve_dae(fun, (0.0, 1.0), [1.0])


def test_exception_in_fun_is_passed_on():
    def fun(t, y, yp):
        if t > 0.5:
            raise KeyError("mine")
        return yp + y

    with pytest.raises(KeyError, match="mine"):
        solve_dae(fun, (0.0, 1.0), [1.0])


@pytest.mark.parametrize("unit", [1e-100, 1e15, 1e20, 1e250])
@pytest.mark.parametrize("rate", [1e-30, 1.0, 1e18])
def test_units_do_not_make_a_state_algebraic(unit, rate):
    """Beside terms of 1e15 a derivative moved by 1e-3 has no effect: y was solved for, and 0 throughout."""
    result = solve_dae(
        lambda t, y, yp: yp + rate * y, (0.0, 2.0 / rate), [unit], rtol=1e-8, atol=1e-8 * unit, dense_output=True
    )
    assert result.success
    np.testing.assert_allclose(result.y[0] / unit, np.exp(-rate * result.t), atol=1e-6)


@pytest.mark.parametrize("unit", [1e-18, 1e18])
def test_algebraic_components_beside_states_in_any_unit_of_time(unit):
    def swing(t, y, yp):
        return np.array([yp[0] - unit * y[1], yp[1] + unit * y[2], y[2] - y[0]])

    result = solve_dae(swing, (0.0, 2.0 / unit), [0.0, 1.0, 7.0], rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(result.y[:, -1], [np.sin(2.0), np.cos(2.0), np.sin(2.0)], atol=1e-6)
