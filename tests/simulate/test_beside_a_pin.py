"""A block that is let go by a smooth load, by itself and beside an idle rotor on a pin, which takes another driver."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

MASS, MU, NORMAL = 1.536, 0.7708, 0.3649
LIMIT = MU * NORMAL
LOADS = {
    "bell": (lambda t, f: 38.3 * f.exp(-(((t - 0.3) / 0.0008538) ** 2)), 0.3),
    "engaged": (lambda t, f: 2.0 * (1.0 + f.tanh((t - 0.3) / 0.02)) * f.exp(-3.0 * t), 0.4),
    "wave": (lambda t, f: 0.4 * f.sin(5.0 * t), 0.3),
}


def parts_of(load, mu_s):
    block = fm.Body("block", mass=MASS, axes="x", position={"x": 0.3})
    law = fm.laws.CoulombViscous(mu_s=mu_s, mu_k=MU, viscous=0.07)
    push = fm.Force("push", block, axis="x", value=load(fm.t, sympy))
    return [block, push, fm.Contact("rub", block, law=law, normal_force=NORMAL, axes="x")]


def rotor():
    body = fm.RigidBody("rotor", mass=0.01, inertia=1e-12, angular_velocity=0.36)
    return [body, fm.Revolute("pin", body, fm.GROUND)]


def by_hand(load, top, mu_s):
    """When it is let go, when it comes to rest, and where."""
    start = brentq(lambda t: load(t, np) - mu_s * NORMAL, 0.0, top, xtol=1e-15)
    stops = lambda t, y: y[1] if t > start + 1e-4 else 1.0  # noqa: E731
    stops.terminal, stops.direction = True, -1
    slip = lambda t, y: [y[1], (load(t, np) - LIMIT - 0.07 * NORMAL * y[1]) / MASS]  # noqa: E731
    found = solve_ivp(slip, (start, 20.0), [0.3, 0.0], "DOP853", rtol=1e-12, atol=1e-15, events=stops, max_step=1e-2)
    return start, found.t[-1], found.y[0, -1]


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize("beside", [list, rotor], ids=["alone", "beside"])
@pytest.mark.parametrize("mu_s", [MU, 1.1 * MU])
@pytest.mark.parametrize("name", LOADS)
def test_a_block_let_go_by_a_smooth_load(name, mu_s, beside, method):
    """With mu_s = mu_k its acceleration begins at 0: nothing but the step itself tells how far it gets."""
    load, top = LOADS[name]
    start, stop, place = by_hand(load, top, mu_s)
    sol = fm.simulate(fm.Scene("s", [*parts_of(load, mu_s), *beside()]), t_end=stop + 0.01, method=method)
    events = [e for e in sol.events if e.contact == "rub"]
    assert [e.kind for e in events] == ["slip", "stick"]
    np.testing.assert_allclose([e.t for e in events], [start, stop], rtol=1e-7)
    assert sol["block.x"][-1] - 0.3 == pytest.approx(place - 0.3, rel=1e-5)
