"""A contact in the plane whose body moves along one axis alone: how the other axis slips turns its friction."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm

MASS, BELT, MU, LOAD, PUSH, BEGINS = 0.747, 0.8227, 0.6511, 2.774, 1.1, 4.061


def across(t, sin=np.sin):
    """Velocity of the belt along the axis that the block lacks."""
    return 0.2086 * sin(1.311 * t) + 0.3607


def scene():
    block = fm.Body("block", mass=MASS, axes="x", velocity={"x": BELT})
    belt = fm.Driven("belt", velocity={"x": BELT, "y": across(fm.t, sympy.sin)})
    push = fm.Force("push", block, axis="x", value=sympy.Piecewise((0, fm.t < BEGINS), (PUSH, True)))
    law = fm.laws.Coulomb(mu_s=1.0388, mu_k=MU)
    contact = fm.Contact("c", block, belt, axes=("x", "y"), law=law, normal_force=LOAD)
    return fm.Scene("pulled", [block, belt, push, contact])


def truth(t):
    def rate(t, v):
        slip = v[0] - BELT
        return [(PUSH - MU * LOAD * slip / np.hypot(slip, across(t))) / MASS]

    return solve_ivp(rate, (BEGINS, t[-1]), [BELT], t_eval=t, method="DOP853", rtol=1e-11, atol=1e-13).y[0]


@pytest.mark.parametrize("method", ["radau", "bdf", "auto"])
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("t_end", [5.0, 9.8888, 14.0])
def test_a_load_jumps_where_slip_is_along_the_missing_axis(t_end, rtol, method):
    """Slip sets out along x from 0.  How long the run is lets the first step behind the jump be 0.05 or 0.14 long."""
    t = np.linspace(BEGINS + 1e-3, BEGINS + 0.8, 60)
    sol = fm.simulate(scene(), t_end=t_end, rtol=rtol, method=method, t_eval=t)
    assert sol.velocity("block.x") == pytest.approx(truth(t), abs=2.0 * rtol)
