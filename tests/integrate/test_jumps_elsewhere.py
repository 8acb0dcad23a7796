"""Forces and loads that jump with the motion, felt by bodies that rest: closed forms."""

import numpy as np
import pytest
import sympy

import fricmb as fm

METHODS = pytest.mark.parametrize("method", ["radau", "bdf"])


def pushed(mu_s, method, before=0.0):
    """A body that moves evenly switches on a force on another at 0.05."""
    m, rests = fm.Body("m", mass=1.0, velocity={"x": 1.0}), fm.Body("l", mass=1.0)
    force = before + sympy.Piecewise((0.5, fm.coordinate("m.x") > 0.05), (0, True))
    contact = fm.Contact("dry", rests, law=fm.laws.Coulomb(mu_s=mu_s), normal_force=1.0)
    scene = fm.Scene("jump", [m, rests, fm.Force("F", rests, axis="x", value=force), contact])
    return fm.simulate(scene, t_end=0.2, method=method)


@METHODS
@pytest.mark.parametrize("before", [0.0, 0.1])
def test_a_body_that_has_never_moved_is_held(method, before):
    sol = pushed(2.0, method, before)
    assert np.abs(sol["l.x"]).max() < 1e-15
    assert not len(sol.events)
    assert sol.at([0.1]).force("dry")[0, 0] == pytest.approx(-0.5 - before)


@METHODS
def test_a_jump_that_friction_does_not_hold_sets_in_motion_at_once(method):
    sol = pushed(0.3, method)
    (event,) = sol.events
    assert (event.kind, event.t) == ("slip", pytest.approx(0.05, abs=1e-10))
    assert sol["l.x"][-1] == pytest.approx(0.5 * (0.5 - 0.3) * 0.15**2, rel=1e-6)


@METHODS
@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
def test_a_load_that_jumps_does_not_open_the_contact(method, rtol):
    """N is 0.1 or 0.5 by the sign of x; half periods about -N and N, the last of which ends within the cone."""
    b = fm.Body("b", mass=1.0, position={"x": 3.0})
    N = sympy.Piecewise((0.1, fm.coordinate("b.x") < 0), (0.5, True))
    contact = fm.Contact("c", b, law=fm.laws.Coulomb(mu_s=1.0), normal_force=N, axes="x")
    scene = fm.Scene("two loads", [b, fm.Spring("k", b, axis="x", stiffness=1.0), contact])
    sol = fm.simulate(scene, t_end=40.0, rtol=rtol, method=method)
    assert not {"open", "close"} & {event.kind for event in sol.events}
    assert sol.normal_force("c").min() == pytest.approx(0.1)
    # energy from one turn to the next: x^2/2 falls by N times the way on either side of 0
    x = 3.0
    while abs(x) > (0.5 if x > 0.0 else 0.1):
        first, last = (0.5, 0.1) if x > 0.0 else (0.1, 0.5)
        left = x * x / 2.0 - first * abs(x)
        # beyond 0, or on this side of it
        other = last - np.sqrt(last * last + 2.0 * left) if left > 0.0 else 2.0 * first - abs(x)
        x = np.sign(x) * other
    assert sol["b.x"][-1] == pytest.approx(x, abs=100.0 * rtol)
