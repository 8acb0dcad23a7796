"""Dense, banded and sparse storage, given and differenced Jacobians, Python and compiled functions: one result."""

import numpy as np
import pytest
from numba import njit
from scipy import sparse

from fricmb.dae import solve_dae


def heat(n):
    """Rod with fixed ends as algebraic unknowns; y = exp(-lambda t) sin(pi x), lambda of the difference formula."""
    x = np.linspace(0.0, 1.0, n)
    width = x[1]
    rate = 4.0 / width**2 * np.sin(0.5 * np.pi * width) ** 2

    def fun(t, y, yp):
        out = np.empty_like(y)
        out[0], out[-1] = y[0], y[-1]
        out[1:-1] = yp[1:-1] - (y[2:] - 2.0 * y[1:-1] + y[:-2]) / width**2
        return out

    def jac(t, y, yp):
        inner = np.ones(n)
        inner[[0, -1]] = 0.0
        below, above = -inner[1:] / width**2, -inner[:-1] / width**2
        main = np.where(inner == 1.0, 2.0 / width**2, 1.0)
        dy = sparse.diags_array([below, main, above], offsets=[-1, 0, 1], format="csc")
        return dy, sparse.diags_array([inner], offsets=[0], format="csc")

    return fun, jac, np.sin(np.pi * x), rate


@pytest.mark.parametrize("n", [200, 2000])
@pytest.mark.parametrize("way", ["banded", "sparse", "sparse jac", "banded jac"])
def test_heat_equation(n, way):
    fun, jac, start, rate = heat(n)
    pattern = sparse.diags_array([np.ones(n - 1), np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1])
    options = {
        "banded": {"bandwidth": (1, 1)},
        "sparse": {"jac_sparsity": pattern},
        "sparse jac": {"jac": jac},
        "banded jac": {"jac": jac, "bandwidth": (1, 1)},
    }[way]
    sol = solve_dae(fun, (0.0, 0.1), start, rtol=1e-6, atol=1e-9, **options)
    assert sol.success, sol.message
    np.testing.assert_allclose(sol.y[:, -1], np.exp(-0.1 * rate) * start, atol=2e-5)
    assert sol.nfev < 12 * sol.nsteps  # grouped differences: three columns at a time would be n/3 times more


def test_storages_agree():
    fun, jac, start, _ = heat(60)
    pattern = sparse.diags_array([np.ones(59), np.ones(60), np.ones(59)], offsets=[-1, 0, 1])

    def full(t, y, yp):
        return tuple(m.toarray() for m in jac(t, y, yp))

    ways = [
        {"jac": full},
        {"jac": jac},
        {"jac": jac, "bandwidth": (1, 1)},
        {"bandwidth": (1, 1)},
        {"jac_sparsity": pattern},
    ]
    runs = [solve_dae(fun, (0.0, 0.1), start, rtol=1e-6, atol=1e-9, **way) for way in ways]
    for run in runs[1:3]:
        assert run.nsteps == runs[0].nsteps
        np.testing.assert_allclose(run.y[:, -1], runs[0].y[:, -1], rtol=1e-9, atol=1e-13)
    for run in runs[3:]:
        np.testing.assert_allclose(run.y[:, -1], runs[0].y[:, -1], rtol=1e-5, atol=1e-9)


def test_entry_outside_the_band_is_an_error():
    with pytest.raises(ValueError, match=r"entry at \[0, 2\], outside"):
        solve_dae(
            lambda t, y, yp: yp + y,
            (0.0, 1.0),
            [1.0, 1.0, 1.0],
            jac=lambda t, y, yp: (sparse.csc_array(np.array([[1.0, 0, 1], [0, 1, 0], [0, 0, 1]])), sparse.eye_array(3)),
            bandwidth=(1, 1),
        )


@njit
def circuit(t, y, yp, r, count):
    out = np.empty(3)
    out[0] = yp[0] - (np.sin(t) - y[0]) / r
    out[1] = y[1] - y[0] ** count
    out[2] = yp[2] + 50.0 * (y[2] - y[1])
    return out


@njit
def circuit_in_place(t, y, yp, out, r, count):
    out[0] = yp[0] - (np.sin(t) - y[0]) / r
    out[1] = y[1] - y[0] ** count
    out[2] = yp[2] + 50.0 * (y[2] - y[1])


@njit
def circuit_jacobian(t, y, yp, r, count):
    dy = np.array([[1.0 / r, 0.0, 0.0], [-count * y[0] ** (count - 1), 1.0, 0.0], [0.0, -50.0, 50.0]])
    dyp = np.zeros((3, 3))
    dyp[0, 0] = 1.0
    dyp[2, 2] = 1.0
    return dy, dyp


def test_compiled_function_gives_the_result_of_the_python_one():
    options = {"rtol": 1e-7, "atol": 1e-10, "args": (0.3, 2)}
    span, start = (0.0, 20.0), [0.5, 0.0, 0.1]
    python = solve_dae(circuit.py_func, span, start, **options)
    for fun in (circuit, circuit_in_place, circuit_in_place.py_func):
        run = solve_dae(fun, span, start, **options)
        assert abs(run.nsteps - python.nsteps) < 0.2 * python.nsteps
        np.testing.assert_allclose(run.y[:, -1], python.y[:, -1], rtol=1e-6)
    span, steps = (0.0, 3.0), set()
    python = solve_dae(circuit.py_func, span, start, **options)
    for jac in (circuit_jacobian, circuit_jacobian.py_func):
        for fun in (circuit, circuit.py_func):
            for bandwidth in (None, (1, 1)):
                run = solve_dae(fun, span, start, jac=jac, bandwidth=bandwidth, **options)
                np.testing.assert_allclose(run.y[:, -1], python.y[:, -1], rtol=1e-6)
                steps.add(run.nsteps)
    assert len(steps) == 1  # the same Jacobian: the same steps, whoever evaluates
    assert python.success


def test_compiled_function_with_other_arguments():
    """The second run reads new numbers, no new code."""
    first = solve_dae(circuit, (0.0, 5.0), [0.5, 0.0, 0.1], args=(0.3, 2), rtol=1e-8, atol=1e-10)
    second = solve_dae(circuit, (0.0, 5.0), [0.5, 0.0, 0.1], args=(0.6, 3), rtol=1e-8, atol=1e-10)
    twin = solve_dae(circuit.py_func, (0.0, 5.0), [0.5, 0.0, 0.1], args=(0.6, 3), rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(second.y[:, -1], twin.y[:, -1], rtol=1e-6)
    assert abs(first.y[0, -1] - second.y[0, -1]) > 1e-3


@njit
def compiled_heat(t, y, yp, out, width):
    n = len(y)
    out[0] = y[0]
    out[n - 1] = y[n - 1]
    for i in range(1, n - 1):
        out[i] = yp[i] - (y[i + 1] - 2.0 * y[i] + y[i - 1]) / width**2


@pytest.mark.parametrize("way", ["banded", "sparse"])
def test_compiled_heat_equation(way):
    n = 400
    _, _, start, rate = heat(n)
    pattern = sparse.diags_array([np.ones(n - 1), np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1])
    options = {"bandwidth": (1, 1)} if way == "banded" else {"jac_sparsity": pattern}
    sol = solve_dae(compiled_heat, (0.0, 0.1), start, rtol=1e-6, atol=1e-9, args=(1.0 / (n - 1),), **options)
    assert sol.success, sol.message
    np.testing.assert_allclose(sol.y[:, -1], np.exp(-0.1 * rate) * start, atol=2e-5)


def test_compiled_function_with_array_argument_events_and_samples():
    @njit
    def fun(t, y, yp, weights):
        return np.array([yp[0] - weights[0] * y[1], yp[1] + weights[1] * y[0]])

    def crosses(t, y, weights):
        return y[0]

    crosses.terminal = 3
    times = np.linspace(0.0, 20.0, 200)
    sol = solve_dae(
        fun, (0.0, 20.0), [0.0, 1.0], args=(np.array([1.0, 1.0]),), rtol=1e-10, atol=1e-10, events=crosses, t_eval=times
    )
    assert sol.status == 1
    np.testing.assert_allclose(sol.t_events[0], [0.0, np.pi, 2.0 * np.pi], atol=1e-8)
    np.testing.assert_allclose(sol.y[0], np.sin(sol.t), atol=1e-7)
    assert sol.t[-1] <= 2.0 * np.pi
