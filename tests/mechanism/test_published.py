"""Mechanisms against digits that others have published."""

import numpy as np
import pytest

import fricmb as fm

# Test Set for IVP Solvers (Mazzia, Magherini 2008), problem andrews, t = 0.03, computed with PSIDE at 1e-14
ANDREWS = {
    "angle": [
        0.1581077119629904e2, -0.1575637105984298e2, 0.4082224013073101e-1, -0.5347301163226948, 0.5244099658805304,
        0.5347301163226948, 0.1048080741042263e1,
    ],
    "rate": [
        0.1139920302151208e4, -0.1424379294994111e4, 0.1103291221937134e2, 0.1929337464421385e2, 0.5735699284790808,
        -0.1929337464421385e2, 0.3231791658026955,
    ],
}  # fmt: skip
# the same, problem caraxis, t = 3
CAR_AXIS = [
    0.4934557842755629e-1, 0.4969894602303324, 0.1041742524885400e1, 0.3739110272652214, -0.7705836840321485e-1,
    0.7446866596327776e-2, 0.1755681574942899e-1, 0.7703410437794031,
]  # fmt: skip


def published_angles(of):
    """beta, Theta, gamma, Phi, delta, Omega, epsilon from the angles of the bodies."""
    k = [None, *(of(f"K{i}.angle")[-1] for i in range(1, 8))]
    return [k[1], k[2] - k[1], k[3], k[4] - k[5], k[5], k[6] - k[7], k[7]]


@pytest.mark.parametrize(("rtol", "tolerance"), [(1e-6, 5e-6), (1e-8, 1e-7)])
def test_andrews(rtol, tolerance):
    sol = fm.simulate(fm.models.andrews(), t_end=0.03, rtol=rtol)
    np.testing.assert_allclose(published_angles(sol.__getitem__), ANDREWS["angle"], rtol=tolerance)
    np.testing.assert_allclose(published_angles(sol.velocity), ANDREWS["rate"], rtol=tolerance)
    assert np.abs(sol.energy.residual).max() < 1e-8


@pytest.mark.parametrize(("rtol", "tolerance"), [(1e-6, 1e-7), (1e-8, 2e-9)])
def test_car_axis(rtol, tolerance):
    sol = fm.simulate(fm.models.car_axis(), t_end=3.0, rtol=rtol)
    np.testing.assert_allclose(np.concatenate([sol.q[:, -1], sol.v[:, -1]]), CAR_AXIS, atol=tolerance)
    # the first multiplier of the problem, in this scene that of "guide"
    assert sol.reaction("guide")[0, -1] == pytest.approx(-0.4736886750784630e-2, rel=1e-4)
