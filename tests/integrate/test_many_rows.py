"""Scenes without joints in the band, with many rows of contacts and few, against steps condensed to the contacts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb.integrate import OneStepMethod
from fricmb.integrate.constrained.problem_structs import mech_of
from fricmb.integrate.step.tableau import radau
from fricmb.system import build


@dataclass(frozen=True, kw_only=True)
class Condensed(OneStepMethod):
    """Radau IIA of seven stages, always condensed."""

    name = "condensed"
    order = "13"

    def nodes(self, problem, rtol):
        return tuple(radau(7).c.tolist())


def pad(contacts, modes, law=None, normal=20.0, axes="xy"):
    """A body by its modes, pressed on a disc at many points."""
    rng, law = np.random.default_rng(1), law or fm.laws.Coulomb(mu_s=0.6, mu_k=0.4)
    shapes = {f"p{i}": rng.normal(size=(2, modes)) for i in range(contacts)}
    omega = 2.0 * np.pi * np.linspace(300.0, 6000.0, modes)
    body = fm.ModalBody("pad", frequencies=omega, damping_ratios=0.005, shapes=shapes, axes="xy")
    disc = fm.Driven("disc", velocity={"x": 0.02, "y": 0.003})
    rubs = {"law": law, "normal_force": normal, "axes": axes}
    pads = [fm.Contact(f"c{i}", body.point(f"p{i}"), disc, **rubs) for i in range(contacts)]
    return fm.Scene("pad", [body, disc, *pads])


def bar(contacts, law, nodes=30):
    """Linear finite elements with a mass matrix that couples, some of whose nodes rub on a belt."""
    unit = np.array([[1.0, -1.0], [-1.0, 1.0]])
    M, K = np.zeros((2, nodes, nodes))
    for e in range(nodes - 1):
        M[e : e + 2, e : e + 2] += (np.abs(unit) + np.eye(2)) / (6.0 * nodes)
        K[e : e + 2, e : e + 2] += unit * nodes
    K[0, 0] += 5.0
    bodies, belt = [fm.Body(f"x{i}", mass=1e-3 / nodes) for i in range(nodes)], fm.Driven("belt", velocity={"x": 0.05})
    matrices = fm.MatrixElement("bar", [f"x{i}.x" for i in range(nodes)], M=M, C=1e-3 * K + 0.05 * M, K=K)
    places = np.linspace(nodes // 6, nodes - 1, contacts).round().astype(int)
    rubs = {"law": law, "normal_force": 1.0 / contacts}
    return fm.Scene("bar", [*bodies, belt, matrices, *(fm.Contact(f"c{i}", bodies[i], belt, **rubs) for i in places)])


STRIBECK = fm.laws.Stribeck(mu_s=1.2, mu_k=0.8, v_s=0.1)
LUGRE = fm.laws.LuGre(sigma0=1e3, sigma1=30.0, sigma2=0.1, mu_s=1.3, mu_k=1.0, v_s=0.1)
LIFTS = fm.normal.Spring(axis="y", stiffness=3e7, preload=5.0)


@pytest.mark.parametrize(
    ("scene", "t_end"),
    [
        pytest.param(bar(16, STRIBECK), 1.0, id="one direction"),
        pytest.param(bar(16, LUGRE), 0.5, id="states"),
        pytest.param(pad(18, 44), 3e-4, id="in the plane"),
        pytest.param(pad(12, 24, normal=LIFTS, axes="x"), 2e-3, id="normal forces"),
    ],
)
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
def test_errors_stay_below_the_tolerance(scene, t_end, rtol):
    t = np.linspace(0.0, t_end, 51)
    true = fm.simulate(scene, t_end=t_end, t_eval=t, rtol=1e-11, method=Condensed())
    found = fm.simulate(scene, t_end=t_end, t_eval=t, rtol=rtol, method="radau")
    assert [(e.contact, e.kind) for e in found.events] == [(e.contact, e.kind) for e in true.events]
    for a, b in ((found.q, true.q), (found.v, true.v)):
        assert (np.abs(a - b).max(axis=1) < rtol * np.abs(b).max(axis=1)).all()
    assert np.abs(found.energy.residual).max() < 10.0 * rtol


def test_jacobians_are_kept_while_nothing_changes():
    """Under constant friction one Jacobian serves until modes change."""
    sol = fm.simulate(bar(10, fm.laws.Coulomb(mu_s=1.2, mu_k=0.8)), t_end=1.0, rtol=1e-8, method="radau")
    assert sol.stats.n_steps > 100
    assert sol.stats.n_jac <= len(sol.events) + 1 + sol.stats.n_rejected


@pytest.mark.slow
def test_more_contacts_set_out_than_directions_are_found_for():
    """Left as if it had a direction of its own, one at rest kept the force it broke away with: 2e-2 at rtol 1e-6."""
    scene, t = pad(36, 80), np.linspace(0.0, 1e-3, 51)
    true = fm.simulate(scene, t_end=1e-3, t_eval=t, rtol=1e-9, method=Condensed())
    found = fm.simulate(scene, t_end=1e-3, t_eval=t, rtol=1e-6, method="radau")
    assert (np.abs(found.q - true.q).max(axis=1) < 1e-6 * np.abs(true.q).max(axis=1)).all()


def test_few_contacts_on_many_modes_are_a_border():
    """Without joints: a band of all unknowns would be as wide as there are modes."""
    sizes = mech_of(build(pad(4, 400)).problem).order.sizes
    assert sizes[:2].tolist() == [400, 0]
    assert sizes[7] == 8
    assert mech_of(build(bar(16, STRIBECK)).problem).order.sizes[7] == 0
    assert mech_of(build(fm.models.slider_crank()).problem).order.sizes[7] == 0


@pytest.mark.parametrize(
    ("law", "mass"),
    [
        pytest.param(STRIBECK, 1.0, id="a law that falls"),
        pytest.param(LUGRE, 1.0, id="a state"),
        pytest.param(STRIBECK, 1e-3, id="a stiff tip"),
    ],
)
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
def test_one_contact_against_condensed_steps(law, mass, rtol):
    """Where friction alone is not linear, iterations that leave the structure out find what all of it gives."""
    belt, block = fm.Driven("belt", velocity={"x": 0.1 + 0.05 * sympy.sin(2.0 * fm.t)}), fm.Body("m", mass=1.0)
    tip = fm.Body("tip", mass=mass)
    parts = [fm.Spring("k", block, axis="x", stiffness=1.0), fm.Spring("stiff", block, tip, axis="x", stiffness=100.0)]
    scene = fm.Scene("s", [belt, block, tip, *parts, fm.Contact("c", block, belt, law=law, normal_force=1.0)])
    t = np.linspace(0.0, 10.0, 101)
    true = fm.simulate(scene, t_end=10.0, t_eval=t, rtol=1e-11, method=Condensed())
    found = fm.simulate(scene, t_end=10.0, t_eval=t, rtol=rtol, method="radau")
    assert [e.kind for e in found.events] == [e.kind for e in true.events]
    for a, b in ((found.q[:1], true.q[:1]), (found.v[:1], true.v[:1])):
        assert (np.abs(a - b).max(axis=1) < rtol * np.abs(b).max(axis=1)).all()


def test_one_contact_whose_law_has_many_states():
    """A plate as good as fixed, whose joint of twenty sliders is shaken."""
    n = 20
    law = fm.laws.Iwan(stiffness=(1.0,) * n, limits=tuple((np.arange(n) + 0.5) / n), corner=1e-3)
    plate, shaker = fm.Body("plate", mass=1e9), fm.Driven("shaker", position={"x": 0.9 * sympy.sin(6.0 * fm.t)})
    scene = fm.Scene("joint", [plate, shaker, fm.Contact("bolt", plate, shaker, law=law, normal_force=1.0)])
    period = np.pi / 3.0
    sol = fm.simulate(scene, t_end=2.0 * period, rtol=1e-5, method="radau", t_eval=[period, 2.0 * period])
    limits = (np.arange(n) + 0.5) / n
    loss = np.sum(4.0 * limits * np.maximum(0.9 - limits, 0.0))
    assert np.diff(sol.energy.friction_loss)[0] == pytest.approx(loss, rel=1e-2)


def test_points_that_land_together_are_run_through():
    """Points of a pad, nearly redundant in stick."""
    scene = fm.models.pad_rotor(3, 4, 4, speed=0.2, mu_s=0.5, mu_k=0.4)
    sol = fm.simulate(scene, t_end=0.025, rtol=1e-5, method="radau")
    assert sol.t[-1] == 0.025
    assert np.abs(sol.energy.residual).max() < 1e-7


def ageing(n):
    """Blocks in a row on a belt, each held by a spring and the next one, whose friction ages; they start at rest."""
    belt, parts, bodies = fm.Driven("belt", velocity={"x": 0.3}), [], []
    for i in range(n):
        body = fm.Body(f"b{i}", mass=1.0, velocity={"x": 0.3})
        contact = fm.Contact(f"c{i}", body, belt, law=AGEING, normal_force=2.0)
        parts += [body, fm.Spring(f"k{i}", body, axis="x", stiffness=10.0 + i), contact]
        parts += [fm.Spring(f"t{i}", last, body, axis="x", stiffness=1.0) for last in bodies[-1:]]
        bodies.append(body)
    return [belt, *parts]


AGEING = fm.laws.RateAndState(mu_0=0.6, a=0.01, b=0.015, L=1e-3, v_0=1e-3)


def aged(n, t):
    """Their positions (n,) at t, by SciPy's BDF from the law's formula."""
    K = np.diag([10.0 + i + (i > 0) + (i < n - 1) for i in range(n)]) - np.eye(n, k=1) - np.eye(n, k=-1)

    def rates(t, y):
        x, v, psi = y.reshape(3, n)
        slow = np.hypot(v - 0.3, 1e-11)
        power = np.log(slow / 2e-3) + (0.6 + 0.015 * psi) / 0.01
        mu = 0.01 * np.where(power < 30.0, np.arcsinh(np.exp(np.minimum(power, 30.0))), power + np.log(2.0))
        rate = (1e-3 * np.exp(-psi) - abs(v - 0.3)) / 1e-3
        return np.concatenate([v, -K @ x - 2.0 * mu * (v - 0.3) / slow, rate])

    start = np.concatenate([np.zeros(n), np.full(n, 0.3), np.zeros(n)])
    return solve_ivp(rates, (0.0, t), start, method="BDF", rtol=1e-9, atol=1e-12).y[:n, -1]


@pytest.mark.parametrize("beside", [(), "pin"], ids=["alone", "beside a pin"])
def test_friction_that_is_a_logarithm_of_the_slip_speed_has_the_slopes_of_every_stage(beside):
    """Rate-and-state friction at rest goes with the logarithm of slip speeds of 1e-9: no one slope serves a step."""
    parts = ageing(3)
    if beside:
        arm = fm.RigidBody("arm", mass=1.0, inertia=1.0, position={"y": -1.0}, points={"top": (0.0, 1.0)})
        parts += [arm, fm.Revolute("pin", arm.point("top")), fm.Spring("w", arm, parts[1], axis="x", stiffness=1e-9)]
    want = aged(3, 1.5)
    for method in ("radau", "bdf"):
        sol = fm.simulate(fm.Scene("s", parts), t_end=1.5, rtol=1e-5, method=method)
        assert not sol.stats.notes
        assert sol.stats.n_steps < 150
        assert [sol[f"b{i}.x"][-1] for i in range(3)] == pytest.approx(want, abs=1e-6)


def shaken(apart):
    """A block on ground that beats, and a second one at a distance, on a spring between them, or None."""
    velocity = 0.06805 * (sympy.sin(35.93 * fm.t) + sympy.sin(38.4451 * fm.t))
    ground = fm.Driven("ground", velocity={"x": velocity})
    law = fm.laws.Tabulated(speed=(0.0, 0.05, 0.2, 1.0), mu=(0.6, 0.5, 0.45, 0.5), mu_s=0.7)
    first = fm.Body("a", mass=1.0)
    parts = [ground, first, fm.Contact("of a", first, ground, law=law, normal_force=1.0)]
    if apart is not None:
        other = fm.Body("b", mass=1.0, position={"x": apart})
        spring = fm.Spring("k", first, other, axis="x", stiffness=4.893)
        parts += [other, spring, fm.Contact("of b", other, ground, law=law, normal_force=1.0)]
    return fm.Scene("shaken", parts)


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("apart", [1e-6, 1e-8])
def test_two_that_slide_as_one_let_go_one_after_another(apart, method):
    """Each moves as one alone does, to within ``apart``: the second lets go within steps that are round-off."""
    alone = [(event.kind, event.t) for event in fm.simulate(shaken(None), t_end=5.0, rtol=1e-9, method="radau").events]
    sol = fm.simulate(shaken(apart), t_end=5.0, rtol=1e-6, method=method)
    assert not sol.stats.notes
    for name in ("of a", "of b"):
        events = sol.events.of(contact=name)
        assert [event.kind for event in events] == [kind for kind, _ in alone]
        assert [event.t for event in events] == pytest.approx([t for _, t in alone], abs=apart + 1e-7)
