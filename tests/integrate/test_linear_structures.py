"""The general method on scenes with a linear structure: certified references, closed forms, stiff modes."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest
import sympy
from scipy.linalg import expm
from scipy.optimize import brentq

import fricmb as fm
from tests.integrate.test_many_rows import Another

_spec = importlib.util.spec_from_file_location("reference", Path(__file__).parents[1] / "reference.py")
reference = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(reference)

GENERAL = "radau"


def belt(*, stribeck, damping):
    law = fm.laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=0.05, exponent=1.0) if stribeck else None
    return fm.models.belt_oscillator(damping=damping, law=law)


def two_blocks():
    laws = [fm.laws.HyperbolicStribeck(mu_s=mu_s, delta=3.0) for mu_s in (1.0, 1.3)]
    return fm.models.stick_slip_chain(2, coupling=1.2, laws=laws)


def planar(friction, position, velocity):
    return lambda: fm.models.planar_oscillator(friction=friction, position=position, velocity=velocity)


def forced(frequency):
    return lambda: fm.models.friction_oscillator(friction=0.2, amplitude=0.5, frequency=frequency)


SCENES = {
    "p1_1": lambda: fm.models.brake4dof("1"),
    "p1_2": lambda: fm.models.brake4dof("2"),
    "p1_5": lambda: fm.models.brake4dof("5"),
    "p2_a": lambda: belt(stribeck=False, damping=0.0),
    "p2_b": lambda: belt(stribeck=False, damping=0.05),
    "p2_s": lambda: belt(stribeck=True, damping=0.0),
    "p2_sb": lambda: belt(stribeck=True, damping=0.05),
    "p3_forced_w0.5_f0.2": forced(0.5),
    "p3_forced_w0.8_f0.2": forced(0.8),
    "p3_forced_w1.5_f0.2": forced(1.5),
    "p4_vdr0.1": two_blocks,
    "p5_a": planar(0.3, (2.0, 0.0), (0.0, 1.7)),
    "p5_b": planar(0.1, (2.0, 0.0), (0.0, 1e-2)),
    "p5_d": planar(0.05, (2.0, 0.3), (0.0, 1e-4)),
    "p5_e": planar(0.1, (2.0, 1.0), (0.0, 0.0)),
}


def compare(ref, sol):
    """Largest error over the problem's own growth, and of transitions (inf where their number is wrong)."""
    growth = np.maximum.accumulate(ref["growth"])[:, None] if "growth" in ref else 1.0
    worst = 0.0
    for got, true in ((sol.q, ref["q"]), (sol.v, ref["v"])):
        size = np.abs(true).max(axis=0)
        worst = max(worst, float((np.abs(got.T - true) / np.where(size > 0, size, 1.0) / growth).max()))
    times = reference.event_times(sol.events)
    if len(times) != len(ref["t_event"]):
        return worst, np.inf
    return worst, float(np.abs(times - ref["t_event"]).max())


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("name", SCENES)
def test_tolerance_means_error(name, rtol):
    ref = reference.load(name)
    sol = fm.simulate(SCENES[name](), t_end=float(ref["t"][-1]), rtol=rtol, t_eval=ref["t"], method=GENERAL)
    error, late = compare(ref, sol)
    assert error <= 100.0 * rtol
    assert late <= 1000.0 * rtol


@pytest.mark.parametrize("rtol", [1e-9, 3e-11, 5e-12])
def test_slip_that_ends_before_the_first_node_of_a_step(rtol):
    # all nodes lie behind the end, where laws are constant: their polynomial knows nothing of the slip before it
    ref = reference.load("p4_vdr0.1")
    sol = fm.simulate(two_blocks(), t_end=float(ref["t"][-1]), rtol=rtol, method=GENERAL)
    times = reference.event_times(sol.events)
    assert times == pytest.approx(ref["t_event"], abs=10.0 * rtol + 1e-10)


@pytest.mark.slow
def test_twenty_blocks_within_the_growth_of_errors():
    ref = reference.load("p6")
    scene = fm.models.stick_slip_chain(20, mu_s=[1.2 + 0.02 * i for i in range(20)])
    sol = fm.simulate(scene, t_end=float(ref["t"][-1]), rtol=1e-9, t_eval=ref["t"], method=GENERAL)
    error, late = compare(ref, sol)
    assert error <= 1e-7
    assert late <= 1e-6 * ref["growth"].max()


# stiff modes ----------------------------------------------------------------------------------------------------------


def pair(ratio, damping=0.0, **law):
    """Two unit masses, one on a spring to the ground, one on a belt, ``ratio``^2 times as stiff between."""
    a, b, drive = fm.Body("a", mass=1.0), fm.Body("b", mass=1.0), fm.Driven("belt", velocity={"x": 0.1})
    springs = [
        fm.Spring("k", a, axis="x", stiffness=1.0),
        fm.Spring("K", a, b, axis="x", stiffness=0.5 * ratio**2),
        fm.Damper("D", a, b, axis="x", damping=damping * ratio),
    ]
    contact = fm.Contact("c", b, drive, law=fm.laws.Coulomb(**law), normal_force=1.0)
    return fm.Scene("pair", [a, b, drive, *springs, contact])


def event_loop(K, C, mu_s, mu_k, t_end):
    """Transitions of the pair that starts from rest on its belt, and its end, by exponentials and brentq."""

    def flow(K, C, load):
        A = np.zeros((5, 5))
        A[:4, :4] = np.block([[np.zeros((2, 2)), np.eye(2)], [-K, -C]])
        A[2:4, 4] = load
        return A

    def force(y):
        return (K @ y[:2] + C @ y[2:4])[1]

    P = np.diag([1.0, 0.0])
    y, t, side, times = np.array([0.0, 0.0, 0.0, 0.0, 1.0]), 0.0, -1.0, []
    while True:
        A = flow(P @ K, P @ C, np.zeros(2)) if side == 0 else flow(K, C, np.array([0.0, -side * mu_k]))

        def margin(x, side=side):
            return mu_s - abs(force(x)) if side == 0 else side * (x[3] - 0.1)

        step, x, i = expm(A * 2e-4), y, 0
        while t + i * 2e-4 < t_end and not (i > 1 and margin(step @ x) < 0):
            x, i = step @ x, i + 1
        if t + i * 2e-4 >= t_end:
            return np.array(times), expm(A * (t_end - t)) @ y
        rest = brentq(lambda tau, A=A, x=x: margin(expm(A * tau) @ x), 0, 2e-4, xtol=1e-15)
        y, t = expm(A * rest) @ x, t + i * 2e-4 + rest
        times.append(t)
        if side == 0:
            side = np.sign(-force(y))
        else:
            y[3] = 0.1
            side = 0.0 if abs(force(y)) <= mu_s else np.sign(-force(y))


@pytest.mark.parametrize(("ratio", "damping"), [(30.0, 0.02), (300.0, 0.02), (30.0, 0.0)])
def test_a_fast_mode_against_matrix_exponentials(ratio, damping):
    k = 0.5 * ratio**2
    K = np.array([[1.0 + k, -k], [-k, k]])
    C = damping * ratio * np.array([[1.0, -1.0], [-1.0, 1.0]])
    sol = fm.simulate(pair(ratio, damping, mu_s=1.5, mu_k=1.0), t_end=25.0, rtol=1e-9, method=GENERAL)
    times, end = event_loop(K, C, 1.5, 1.0, 25.0)
    assert len(times) > 1
    assert reference.event_times(sol.events) == pytest.approx(times, abs=1e-8)
    assert [*sol.q[:, -1], *sol.v[:, -1]] == pytest.approx(end[:4], abs=1e-7)


@pytest.mark.parametrize("ratio", [1e2, 1e4])
def test_steps_do_not_follow_a_fast_mode_that_is_damped_out(ratio):
    sol = fm.simulate(pair(ratio, 0.05, mu_s=1.5, mu_k=1.0), t_end=60.0, rtol=1e-5, method=GENERAL)
    # to follow it would take more than 60 ratio / 8 steps
    assert sol.stats.n_steps < 400
    # both masses move as one of mass 2: x = mu (1 - cos) from the belt's start, released at x = 1.5
    assert [event.kind for event in sol.events][:2] == ["stick", "slip"]
    slips = sol.events.of(kind="slip").t
    w, drop = 1 / math.sqrt(2.0), 0.5
    period = 2 * (math.pi - math.atan(drop * w / 0.1)) / w + 2 * drop / 0.1
    assert np.diff(slips) == pytest.approx(period, rel=2.0 / ratio)


# ports of every kind --------------------------------------------------------------------------------------------------


def two_in_the_plane():
    """Two contacts in the plane, one between the bodies; damping that is not proportional; mu_s > mu_k."""
    a = fm.Body("a", mass=1.0, axes="xy", position={"x": 0.3}, velocity={"y": 1.0})
    b = fm.Body("b", mass=2.0, axes="xy", position={"y": -0.5}, velocity={"x": -0.7})
    stiff = {("a", "x"): 1.0, ("a", "y"): 1.7, ("b", "x"): 2.0, ("b", "y"): 0.8}
    parts = [
        fm.Spring(f"{name}{axis}", {"a": a, "b": b}[name], axis=axis, stiffness=k) for (name, axis), k in stiff.items()
    ]
    parts += [fm.Spring("ab", a, b, axis="x", stiffness=1.0), fm.Damper("d", a, b, axis="y", damping=0.05)]
    ground = fm.Contact("ca", a, law=fm.laws.Coulomb(mu_s=0.15, mu_k=0.1), normal_force=1.0)
    between = fm.Contact("cab", a, b, law=fm.laws.Coulomb(mu_s=0.12), normal_force=1.0)
    return fm.Scene("two", [a, b, *parts, ground, between])


def cubic():
    mass = fm.Body("m", mass=1.0, position={"x": 1.5})
    law = fm.laws.Coulomb(mu_s=0.1, mu_k=0.07)
    spring = fm.Spring("k", mass, axis="x", stiffness=1.0, cubic=2.0)
    return fm.Scene("cubic", [mass, spring, fm.Contact("c", mass, law=law, normal_force=1.0)])


def loaded_in_the_plane():
    body = fm.Body("m", mass=1.0, axes="xy")
    force = {"x": 0.9 * sympy.cos(0.7 * fm.t), "y": 0.6 * sympy.sin(1.1 * fm.t)}
    parts = [fm.Force(f"f{axis}", body, axis=axis, value=value) for axis, value in force.items()]
    parts += [fm.Spring(f"k{axis}", body, axis=axis, stiffness=k) for axis, k in (("x", 1.0), ("y", 2.0))]
    law = fm.laws.Stribeck(mu_s=0.3, mu_k=0.25, v_s=0.1)
    return fm.Scene("loaded", [body, *parts, fm.Contact("c", body, law=law, normal_force=1.0 + 0.3 * sympy.sin(fm.t))])


def bristles():
    law = fm.laws.LuGre(sigma0=1e3, sigma1=10.0, sigma2=0.1, mu_s=0.3, mu_k=0.2, v_s=0.1)
    body = fm.Body("m", mass=1.0, axes="xy", position={"x": 1.0}, velocity={"y": 0.5})
    springs = [fm.Spring(f"k{axis}", body, axis=axis, stiffness=k) for axis, k in (("x", 1.0), ("y", 1.5))]
    return fm.Scene("bristles", [body, *springs, fm.Contact("c", body, law=law, normal_force=1.0)])


@pytest.mark.parametrize("make", [two_in_the_plane, cubic, loaded_in_the_plane, bristles])
def test_agrees_with_another_formula_and_keeps_energy(make):
    t = np.linspace(0.0, 20.0, 101)
    scene = make()
    true = fm.simulate(scene, t_end=20.0, rtol=1e-11, t_eval=t, method=Another())
    for rtol in (1e-4, 1e-7, 1e-9):
        sol = fm.simulate(scene, t_end=20.0, rtol=rtol, t_eval=t, method=GENERAL)
        size = np.abs(true.q).max(axis=1)[:, None], np.abs(true.v).max(axis=1)[:, None]
        error = max((np.abs(sol.q - true.q) / size[0]).max(), (np.abs(sol.v - true.v) / size[1]).max())
        assert error < 100.0 * rtol
        assert np.abs(sol.energy.residual).max() < 100.0 * rtol
    assert [(e.contact, e.kind) for e in sol.events] == [(e.contact, e.kind) for e in true.events]
    assert sol.events.t == pytest.approx(true.events.t, abs=1e-6)


def test_one_contact_has_the_same_run_both_ways():
    t = np.linspace(0.0, 100.0, 201)
    scene = fm.models.brake4dof("2")
    one, any_number = (
        fm.simulate(scene, t_end=100.0, rtol=1e-9, t_eval=t, method=method) for method in ("collocation", GENERAL)
    )
    assert any_number.events.t == pytest.approx(one.events.t, abs=1e-9)
    np.testing.assert_allclose(any_number.q, one.q, atol=1e-7)


def test_what_it_refuses_it_says():
    held = fm.Body("held", mass=1.0, axes="xy")
    law = fm.laws.Coulomb(mu_s=0.5)
    two = fm.Scene("two", [held, *(fm.Contact(f"pad{i}", held, law=law, normal_force=1.0) for i in range(2))])
    with pytest.raises(fm.SceneError, match="takes one contact"):
        fm.simulate(two, t_end=0.1, method="collocation")
