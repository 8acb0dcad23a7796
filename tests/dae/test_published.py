"""Published end values: Test Set for IVP Solvers (F. Mazzia, C. Magherini, University of Bari)."""

from math import exp, nan, pi, sqrt

import numpy as np
import pytest

from fricmb.dae import solve_dae


def robertson(t, y, yp):
    slow, fast = -0.04 * y[0] + 1e4 * y[1] * y[2], 3e7 * y[1] ** 2
    return np.array([yp[0] - slow, yp[1] + slow + fast, y[0] + y[1] + y[2] - 1.0])


def robertson_jacobian(t, y, yp):
    dy = [[0.04, -1e4 * y[2], -1e4 * y[1]], [-0.04, 1e4 * y[2] + 6e7 * y[1], 1e4 * y[1]], [1.0, 1.0, 1.0]]
    return np.array(dy), np.diag([1.0, 1.0, 0.0])


ROBERTSON_END = np.array([0.2083340149701255e-7, 0.8333360770334713e-13, 0.9999999791665050])


@pytest.mark.parametrize("jac", [None, robertson_jacobian])
def test_robertson_far(jac):
    sol = solve_dae(robertson, (0.0, 1e11), [1.0, 0.0, 0.0], rtol=1e-6, atol=1e-14, jac=jac)
    assert sol.success, sol.message
    np.testing.assert_allclose(sol.y[:, -1], ROBERTSON_END, rtol=2e-5)
    assert sol.nsteps < 2500


def test_robertson_at_40():
    sol = solve_dae(robertson, (0.0, 40.0), [1.0, 0.0, 0.0], rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(sol.y[:, -1], [0.7158270688, 0.9185534765e-5, 0.2841637457], rtol=1e-6)


def akzo_nobel(t, y, yp):
    root = sqrt(y[1]) if y[1] >= 0.0 else nan
    r1, r2, r3 = 18.7 * y[0] ** 4 * root, 0.58 * y[2] * y[3], 0.58 / 34.4 * y[0] * y[4]
    r4, r5 = 0.09 * y[0] * y[3] ** 2, 0.42 * y[5] ** 2 * root
    inflow = 3.3 * (0.9 / 737.0 - y[1])
    return np.array(
        [
            yp[0] + 2.0 * r1 - r2 + r3 + r4,
            yp[1] + 0.5 * r1 + r4 + 0.5 * r5 - inflow,
            yp[2] - r1 + r2 - r3,
            yp[3] + r2 - r3 + 2.0 * r4,
            yp[4] - r2 + r3 - r5,
            115.83 * y[0] * y[3] - y[5],
        ]
    )


AKZO_END = [
    0.1150794920661702, 0.1203831471567715e-2, 0.1611562887407974,
    0.3656156421249283e-3, 0.1708010885264404e-1, 0.4873531310307455e-2,
]  # fmt: skip


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
def test_chemical_akzo_nobel(rtol):
    start = [0.444, 0.00123, 0.0, 0.007, 0.0, 0.0]  # the last is algebraic and a bad guess
    sol = solve_dae(akzo_nobel, (0.0, 180.0), start, rtol=rtol, atol=1e-3 * rtol)
    assert sol.success, sol.message
    np.testing.assert_allclose(sol.y[5, 0], 115.83 * 0.444 * 0.007, rtol=1e-12)
    np.testing.assert_allclose(sol.y[:, -1], AKZO_END, rtol=20.0 * rtol)


def transistor_amplifier(t, y, yp):
    if max(y[1] - y[2], y[4] - y[5]) > 10.0:
        return np.full(8, nan)
    i1, i2 = (1e-6 * (exp(u / 0.026) - 1.0) for u in (y[1] - y[2], y[4] - y[5]))
    r, ub, u_in = 9000.0, 6.0, 0.1 * np.sin(200.0 * pi * t)
    q1, q3, q5 = 1e-6 * (yp[1] - yp[0]), 3e-6 * (yp[4] - yp[3]), 5e-6 * (yp[7] - yp[6])
    return np.array(
        [
            q1 + (u_in - y[0]) / 1000.0,
            -q1 + (ub - 2.0 * y[1]) / r - 0.01 * i1,
            -2e-6 * yp[2] + i1 - y[2] / r,
            q3 + (ub - y[3]) / r - 0.99 * i1,
            -q3 + (ub - 2.0 * y[4]) / r - 0.01 * i2,
            -4e-6 * yp[5] + i2 - y[5] / r,
            q5 + (ub - y[6]) / r - 0.99 * i2,
            -q5 - y[7] / r,
        ]
    )


TRANSISTOR_END = [
    -0.5562145012262709e-2, 0.3006522471903042e1, 0.2849958788608128e1, 0.2926422536206241e1,
    0.2704617865010554e1, 0.2761837778393145e1, 0.4770927631616772e1, 0.1236995868091548e1,
]  # fmt: skip


def test_transistor_amplifier():
    """Charges of capacitors between nodes are differential: dF/dyp has rank 5, and no column of it is 0."""
    sol = solve_dae(transistor_amplifier, (0.0, 0.2), [0.0, 3.0, 3.0, 6.0, 3.0, 3.0, 6.0, 0.0], rtol=1e-5, atol=1e-8)
    assert sol.success, sol.message
    # derivatives at 0 by hand: the node equations without charges, differentiated (g: slope of the diodes at 0)
    g, r = 1e-6 / 0.026, 9000.0
    d3, d6 = -3.0 / r / 2e-6, -3.0 / r / 4e-6
    d1 = (0.1 * 200.0 * pi / 1000.0 + 0.01 * g * d3) / (1.0 / 1000.0 + 2.0 / r + 0.01 * g)
    d4 = (-0.99 * g * (d1 - d3) + 0.01 * g * d6) / (3.0 / r + 0.01 * g)
    d7 = -0.99 * g * (d4 - d6) / (2.0 / r)
    np.testing.assert_allclose(sol.yp[:, 0], [d1, d1, d3, d4, d4, d6, d7, d7], rtol=1e-6)
    np.testing.assert_allclose(sol.y[:, -1], TRANSISTOR_END, rtol=5e-4)


def ring_modulator(t, y, yp):
    c, cs, cp, lh, ls1, ls2 = 1.6e-8, 2e-12, 1e-8, 4.45, 0.002, 5e-4
    u1, u2 = 0.5 * np.sin(2e3 * pi * t), 2.0 * np.sin(2e4 * pi * t)
    over = (y[2] - y[4] - y[6] - u2, -y[3] + y[5] - y[6] - u2, y[3] + y[4] + y[6] + u2, -y[2] - y[5] + y[6] + u2)
    if max(over) > 15.0:
        return np.full(15, nan)
    q1, q2, q3, q4 = (40.67286402e-9 * (exp(17.7493332 * u) - 1.0) for u in over)
    return np.array(
        [
            c * yp[0] - (y[7] - 0.5 * y[9] + 0.5 * y[10] + y[13] - y[0] / 25e3),
            c * yp[1] - (y[8] - 0.5 * y[11] + 0.5 * y[12] + y[14] - y[1] / 25e3),
            cs * yp[2] - (y[9] - q1 + q4),
            cs * yp[3] - (-y[10] + q2 - q3),
            cs * yp[4] - (y[11] + q1 - q3),
            cs * yp[5] - (-y[12] - q2 + q4),
            cp * yp[6] - (-y[6] / 50.0 + q1 + q2 - q3 - q4),
            lh * yp[7] + y[0],
            lh * yp[8] + y[1],
            ls2 * yp[9] - (0.5 * y[0] - y[2] - 17.3 * y[9]),
            ls2 * yp[10] - (-0.5 * y[0] + y[3] - 17.3 * y[10]),
            ls2 * yp[11] - (0.5 * y[1] - y[4] - 17.3 * y[11]),
            ls2 * yp[12] - (-0.5 * y[1] + y[5] - 17.3 * y[12]),
            ls1 * yp[13] - (-y[0] + u1 - 86.3 * y[13]),
            ls1 * yp[14] - (-y[1] - 636.3 * y[14]),
        ]
    )


def test_ring_modulator_beginning_agrees_with_radau():
    """The oscillation at 1e-3 takes 1e5 steps; its beginning has the same difficulties."""
    from scipy.integrate import solve_ivp

    zero = np.zeros(15)
    mass = np.array([1.6e-8] * 2 + [2e-12] * 4 + [1e-8] + [4.45] * 2 + [5e-4] * 4 + [0.002] * 2)
    reference = solve_ivp(
        lambda t, y: -ring_modulator(t, y, zero) / mass, (0.0, 2e-5), zero, method="Radau", rtol=1e-9, atol=1e-12
    )
    sol = solve_dae(ring_modulator, (0.0, 2e-5), zero, rtol=1e-8, atol=1e-11)
    assert sol.success, sol.message
    error = np.abs(sol.y[:, -1] - reference.y[:, -1])
    assert np.all(error < 1e-5 * np.abs(reference.y).max(axis=1))


def test_van_der_pol():
    def fun(t, y, yp):
        return np.array([yp[0] - y[1], 1e-6 * yp[1] - ((1.0 - y[0] ** 2) * y[1] - y[0])])

    sol = solve_dae(fun, (0.0, 2.0), [2.0, 0.0], rtol=1e-7, atol=1e-10)
    np.testing.assert_allclose(sol.y[:, -1], [0.1706167732170469e1, -0.8928097010248125], rtol=1e-5)
