"""A force at rest that passes the cone by little, as the tolerance has it, is a transition."""

import numpy as np
import pytest
import sympy
from scipy.optimize import brentq

import fricmb as fm

HOLD, DIP, RATE, STIFF, PLACE = 0.7, 0.45, 3.7, 2.0, 0.013


def held_block(depth):
    """A block on a spring that its ground holds, but for where the normal force dips."""
    block = fm.Body("b", mass=1.0, position={"x": PLACE})
    law = fm.laws.Tabulated(speed=(0.0, 0.05, 0.2, 1.0), mu=(0.6, 0.5, 0.45, 0.5), mu_s=HOLD)
    return fm.Scene("dip", [
        block, fm.Spring("k", block, axis="x", stiffness=STIFF),
        fm.Force("f", block, axis="x", value=HOLD * (1 - DIP) * (1 + depth) + STIFF * PLACE),
        fm.Contact("c", block, law=law, normal_force=1 - DIP * sympy.sin(RATE * fm.t)),
    ])  # fmt: skip


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize(("rtol", "depth"), [(1e-6, 4e-7), (1e-6, 1e-7), (1e-8, 2e-8), (1e-8, 1e-9), (1e-10, 1e-9)])
def test_it_lets_go_where_the_closed_form_does(method, rtol, depth):
    """Of a part of 5e-7 of the force none was seen, however tight the tolerance."""
    sol = fm.simulate(held_block(depth), t_end=1.5, rtol=rtol, method=method)
    beyond = brentq(lambda t: 1 - DIP * np.sin(RATE * t) - (1 - DIP) * (1 + depth), 0.3, np.pi / 2 / RATE, xtol=1e-15)
    assert [event.kind for event in sol.events] == ["slip", "stick"]
    assert sol.events[0].t == pytest.approx(beyond, abs=1e-7)


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_just_below_it_holds(method):
    """And what stays below by as much is no transition."""
    assert not fm.simulate(held_block(-1e-9), t_end=1.5, rtol=1e-8, method=method).events
