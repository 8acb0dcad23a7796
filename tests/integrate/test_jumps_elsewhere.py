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


def switched(block, dry, switches, t_end):
    """A block on a spring under a force that is switched, in closed form: where it ends, and its changes.

    ``block``: m, k and the velocity at 0; ``dry``: mu_s N, mu_k N; ``switches``: until when, and the force till then.
    """
    (m, k, v), (hold, rub) = block, dry
    w, t, x, n, told = np.sqrt(k / m), 0.0, 0.0, np.sign(v), []
    for switch, force in switches:
        until = min(switch, t_end)
        while t < until:
            if n == 0.0:
                push = force - k * x
                if abs(push) <= hold:
                    break
                n = np.sign(push)
                told.append(("slip", t))
            # x = middle + A cos(w s) + B sin(w s), until x' is 0
            middle = (force - n * rub) / k
            A, B = x - middle, v / w
            ends = (np.arctan2(B, A) % np.pi or np.pi) / w
            s = min(ends, until - t)
            t, x, v = t + s, middle + A * np.cos(w * s) + B * np.sin(w * s), w * (B * np.cos(w * s) - A * np.sin(w * s))
            if s == ends:
                v, n = 0.0, 0.0
                told.append(("stick", t))
        t = until
    return x, told


@METHODS
@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-6, 1e-8])
def test_slip_that_begins_at_jumps_of_something_fast(method, rtol):
    """Once steps ended roundings before a jump, modes were decided there again and again, and runs crept."""
    m, k, v, mu_s, mu_k, N, push = 0.5821, 8.707, -0.0479, 0.7199, 0.6097, 1.523, 1.6707
    omega, phase, reach, place, t_end = 17.98, 4.5969, 2.307, 0.5649, 8.7894
    far = fm.Body(
        "far", mass=0.4782, position={"x": reach * np.cos(phase)}, velocity={"x": -reach * omega * np.sin(phase)}
    )
    b = fm.Body("b", mass=m, velocity={"x": v})
    scene = fm.Scene("s", [
        far, fm.Spring("swing", far, axis="x", stiffness=0.4782 * omega**2),
        b, fm.Spring("k", b, axis="x", stiffness=k),
        fm.Contact("dry", b, law=fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k), normal_force=N),
        fm.Force("jump", b, axis="x", value=push * sympy.Heaviside(fm.coordinate("far.x") - place * reach)),
    ])  # fmt: skip
    half = np.arccos(place)
    turns = [(2.0 * np.pi * i + side * half - phase, push * (side > 0)) for i in range(1, 27) for side in (-1, 1)]
    x, told = switched((m, k, v), (mu_s * N, mu_k * N), [(s / omega, force) for s, force in turns], t_end)
    sol = fm.simulate(scene, t_end=t_end, rtol=rtol, method=method, time_limit=60)
    assert not sol.stats.notes
    assert [e.kind for e in sol.events] == [kind for kind, _ in told]
    assert sol.events.t == pytest.approx([t for _, t in told], abs=rtol)
    assert sol["b.x"][-1] == pytest.approx(x, abs=rtol)
