"""Energies where steps are chosen by a motion that hardly knows of the powers: against closed forms."""

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.integrate.implicit.output.step_energies import integrate_between, integrate_powers

RTOL = 1e-6
OMEGA, MU, T, SPEED = 3.0, 0.1, 30.0, 100.0


def work(f):
    """Its integral over the run, by Gauss."""
    x, weight = np.polynomial.legendre.leggauss(300)
    return float(0.5 * T * (f(0.5 * T * (x + 1.0)) @ weight))


@pytest.mark.parametrize("beside", [(), (fm.RigidBody("idle", mass=1.0, inertia=1.0),)], ids=["blocks", "mechanism"])
@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("mass", [1e3, 1e6])
def test_heavy_body_under_a_load_that_swings(method, mass, beside):
    """v = v0 - mu (t + 0.5 (1 - cos wt)/w)/m hardly feels the load, and steps are as long as its period."""
    body = fm.Body("b", mass=mass, velocity={"x": SPEED})
    N = 1.0 + 0.5 * sympy.sin(OMEGA * fm.t)
    rub = fm.Contact("rub", body, law=fm.laws.Coulomb(mu_s=MU), normal_force=N)
    sol = fm.simulate(fm.Scene("heavy", [body, rub, *beside]), t_end=T, rtol=RTOL, method=method)

    def lost(t):
        v = SPEED - MU * (t + 0.5 * (1.0 - np.cos(OMEGA * t)) / OMEGA) / mass
        return MU * (1.0 + 0.5 * np.sin(OMEGA * t)) * v

    assert sol.energy.friction_loss[-1] == pytest.approx(work(lost), rel=RTOL)
    assert sol.at([T]).energy.friction_loss[-1] == pytest.approx(work(lost), rel=RTOL)


@pytest.mark.parametrize("method", ["radau", "bdf", "taylor"])
def test_work_of_a_load_that_swings(method):
    body = fm.Body("b", mass=1e6, velocity={"x": SPEED})
    load = fm.Force("F", body, axis="x", value=sympy.sin(OMEGA * fm.t))
    rub = fm.Contact("rub", body, law=fm.laws.Coulomb(mu_s=MU), normal_force=1.0)
    sol = fm.simulate(fm.Scene("heavy", [body, load, rub]), t_end=T, rtol=RTOL, method=method)

    def given(t):
        v = SPEED + ((1.0 - np.cos(OMEGA * t)) / OMEGA - MU * t) / 1e6
        return np.sin(OMEGA * t) * v

    assert sol.energy.input[-1] == pytest.approx(work(given), rel=RTOL)


def test_mechanism_that_is_driven_throughout():
    """A crank whose angle is prescribed, a dry pin between it and a rod: N = m a, by hand, where the rod only turns.

    The rod is a body on the crank's end that keeps its angle by inertia alone but for its dry pin: slip velocity
    radius * (spin of the rod - speed of the crank), normal force m r sqrt(w'^2 + w^4).
    """
    r, m, radius, mu = 0.3, 2.0, 0.05, 0.2
    angle = 0.3 + 0.5 * sympy.cos(fm.t)
    first = float(angle.subs(fm.t, 0))
    arm = fm.RigidBody("arm", mass=1.0, inertia=0.1, angle=first, points={"end": (r, 0.0)})
    place = (r * np.cos(first), r * np.sin(first))
    wheel = fm.RigidBody("wheel", mass=m, inertia=1e9, position=place)  # it does not turn
    pin = fm.Revolute("pin", wheel, arm.point("end"), friction=fm.laws.Coulomb(mu_s=mu), radius=radius)
    parts = [arm, wheel, fm.Revolute("hub", arm), fm.DrivenAngle("drive", arm, angle=angle), pin]
    sol = fm.simulate(fm.Scene("crank", parts), t_end=100.0, rtol=RTOL)

    def lost(t):
        w, a = -0.5 * np.sin(t), -0.5 * np.cos(t)
        return mu * m * r * np.sqrt(a**2 + w**4) * radius * np.abs(w)

    edges = np.append(np.arange(0.0, 100.0, np.pi / 4.0), 100.0)
    x, weight = np.polynomial.legendre.leggauss(40)
    half = 0.5 * np.diff(edges)[:, None]
    expected = float((half * lost(edges[:-1, None] + half * (x + 1.0)) @ weight).sum())
    assert sol.energy.friction_loss[-1] == pytest.approx(expected, rel=RTOL)
    assert np.abs(sol.energy.residual).max() < 1e-7
    middle = sol.at(np.linspace(0.0, 100.0, 57)).energy.friction_loss
    assert np.all(np.diff(middle) >= 0.0)


def test_integrals_follow_powers_that_no_step_has_seen():
    """sin^2(7 t) over two long steps that say nothing of it."""
    whole = integrate_powers(
        lambda t, step: np.sin(7.0 * t)[:, None] ** 2, np.array([0.0, 5.0]), np.array([5.0, 9.0]), np.arange(2),
        np.zeros((2, 1)), 1e-9, np.ones(1),
    )  # fmt: skip

    def stated(t):
        return 0.5 * t - np.sin(14.0 * t) / 28.0

    assert whole[:, 0] == pytest.approx(np.diff(stated(np.array([0.0, 5.0, 9.0]))), abs=1e-9)
    t = np.array([8.0, 2.0, 5.5, 2.0])
    begin = np.array([5.0, 0.0, 5.0, 0.0])
    parts = integrate_between(
        lambda t, step: np.sin(7.0 * t)[:, None] ** 2, t, np.array([1, 0, 1, 0]), np.zeros((4, 1)), begin,
        np.zeros((4, 1)), 1e-9, np.ones(1),
    )  # fmt: skip
    assert parts[:, 0] == pytest.approx(stated(t) - stated(begin), abs=1e-9)
