"""A dry pin that holds lets go where its load passes near 0, however soon the load is back."""

import numpy as np
import pytest
import sympy
from scipy.optimize import brentq

import fricmb as fm

RADIUS, BESIDE = 0.1, 1e-4


def scene(ahead, torque):
    """A disc on a pin under a torque; the load is ``(cos(t + ahead), BESIDE)``."""
    disc = fm.RigidBody("disc", mass=1.0, inertia=0.5, points={"hub": (0.0, 0.0)})
    law = fm.laws.Coulomb(mu_s=1.0, mu_k=0.8)
    return fm.Scene("held", [
        disc, fm.Revolute("pin", disc, radius=RADIUS, friction=law), fm.Torque("motor", disc, value=torque),
        fm.Force("fx", disc, axis="x", value=sympy.cos(fm.t + ahead)), fm.Force("fy", disc, axis="y", value=BESIDE),
    ])  # fmt: skip


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("rtol", [1e-4, 1e-6])
@pytest.mark.parametrize("torque", [0.0005, 0.002, 0.02])
@pytest.mark.parametrize("ahead", np.linspace(0.0, 0.2, 9))
def test_a_dry_pin_lets_go_where_its_load_dips(ahead, torque, rtol, method):
    """The load is below what holds for a hundredth of a period: steps at rest are ten times as long."""
    lets_go = brentq(lambda t: RADIUS * np.hypot(np.cos(t + ahead), BESIDE) - torque, 0.0, 0.5 * np.pi - ahead)
    sol = fm.simulate(scene(ahead, torque), t_end=10.0, method=method, rtol=rtol)
    assert sol.events[0].kind == "slip"
    assert sol.events[0].t == pytest.approx(lets_go, abs=1e-6)
