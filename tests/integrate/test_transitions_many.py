"""Several contacts at one instant (point 8), restarts (9), limits of order (10), round-off of positions (11)."""

import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate.implicit.bdf.bdf_stability import COLUMNS, MAX_ORDER, SPACING, backward_polynomial, growth_table

_spec = importlib.util.spec_from_file_location("reference", Path(__file__).parents[1] / "reference.py")
reference = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(reference)

METHODS = pytest.mark.parametrize("method", ["bdf", "radau"])
PLANAR = pytest.mark.parametrize("angle", [None, 0.7], ids=["line", "plane"])


def story(sol):
    return [(event.contact, event.kind) for event in sol.events]


def components(angle, value):
    """A vector along x, or along a direction in the plane: {axis: component}."""
    if angle is None:
        return {"x": value}
    return {"x": value * math.cos(angle), "y": value * math.sin(angle)}


def along(angle, sol, name):
    """The motion of a body along that direction."""
    return sum(sol[f"{name}.{axis}"] * c for axis, c in components(angle, 1.0).items())


def body(name, mass, angle, speed=0.0):
    return fm.Body(name, mass=mass, axes="x" if angle is None else "xy", velocity=components(angle, speed))


# 8 several at once ----------------------------------------------------------------------------------------------------


@METHODS
@PLANAR
def test_8_one_release_takes_another_with_it(method, angle):
    # a cart dragged from the floor, a load on it: when the cart breaks away (mu_s 0.6, mu_k 0.2) its acceleration
    # (0.6 - 0.2) g is more than the load's friction gives (0.25 g): both slip at once, though the load's joint
    # carried nothing before
    g, V, k = 1.0, 0.1, 1.0
    cart, load = body("cart", 1.0, angle), body("load", 1.0, angle)
    puller = fm.Driven("puller", velocity=components(angle, V))
    parts = [cart, load, puller]
    parts += [fm.Spring(f"k{axis}", cart, puller, axis=axis, stiffness=k) for axis in cart.axes]
    parts.append(fm.Contact("floor", cart, law=fm.laws.Coulomb(mu_s=0.6, mu_k=0.2), normal_force=2 * g))
    parts.append(fm.Contact("joint", load, cart, law=fm.laws.Coulomb(mu_s=0.25, mu_k=0.15), normal_force=g))
    start = 1.2 / (k * V)
    t = start + np.array([0.0, 0.2, 0.5, 1.0])
    sol = fm.simulate(fm.Scene("cart", parts), t_end=t[-1], rtol=1e-9, t_eval=t, method=method)
    assert sorted(story(sol)) == [("floor", "slip"), ("joint", "slip")]
    assert sol.events.t == pytest.approx([start, start], abs=1e-10)
    tau = t - start
    # elongation e = V t - x:  e'' = -(k e - 0.4 - 0.15), e = 1.2, e' = V at release
    e = 0.55 + 0.65 * np.cos(tau) + V * np.sin(tau)
    assert along(angle, sol, "cart") == pytest.approx(V * t - e, abs=1e-7)
    assert along(angle, sol, "load") == pytest.approx(0.15 * tau**2 / 2, abs=1e-7)


@METHODS
@PLANAR
def test_8_one_release_leaves_the_other_stuck(method, angle):
    # the same, but the load's friction suffices for the jump of acceleration: one body of mass 2
    g, V = 1.0, 0.1
    cart, load = body("cart", 1.0, angle), body("load", 1.0, angle)
    puller = fm.Driven("puller", velocity=components(angle, V))
    parts = [cart, load, puller]
    parts += [fm.Spring(f"k{axis}", cart, puller, axis=axis, stiffness=1.0) for axis in cart.axes]
    parts.append(fm.Contact("floor", cart, law=fm.laws.Coulomb(mu_s=0.6, mu_k=0.2), normal_force=2 * g))
    parts.append(fm.Contact("joint", load, cart, law=fm.laws.Coulomb(mu_s=0.5), normal_force=g))
    t = np.array([12.0, 12.5, 13.0, 14.0])
    sol = fm.simulate(fm.Scene("cart", parts), t_end=14.0, rtol=1e-9, t_eval=t, method=method)
    assert story(sol) == [("floor", "slip")]
    tau, w = t - 12.0, math.sqrt(0.5)
    e = 0.4 + 0.8 * np.cos(w * tau) + V / w * np.sin(w * tau)
    assert along(angle, sol, "cart") == pytest.approx(V * t - e, abs=1e-7)
    assert along(angle, sol, "load") == pytest.approx(along(angle, sol, "cart"), abs=1e-12)


@METHODS
@PLANAR
def test_8_two_are_caught_at_the_same_instant(method, angle):
    # lower block on the floor (mu 0.3, N = 2 g), upper on it (mu 0.4): retardations 0.2 g and 0.4 g
    lower, upper = body("lower", 1.0, angle, 1.0), body("upper", 1.0, angle, 2.0)
    contacts = [
        fm.Contact("floor", lower, law=fm.laws.Coulomb(mu_s=0.3), normal_force=2.0),
        fm.Contact("joint", upper, lower, law=fm.laws.Coulomb(mu_s=0.4), normal_force=1.0),
    ]
    sol = fm.simulate(fm.Scene("stack", [lower, upper, *contacts]), t_end=7.0, rtol=1e-9, method=method)
    assert sorted(story(sol)) == [("floor", "stick"), ("joint", "stick")]
    assert sol.events.t == pytest.approx([5.0, 5.0], abs=1e-7)
    assert along(angle, sol, "lower")[-1] == pytest.approx(2.5, abs=1e-7)
    assert along(angle, sol, "upper")[-1] == pytest.approx(5.0, abs=1e-7)
    # what a projection leaves of round-off: whether that is nothing at all depends on how sums are rounded
    assert np.abs(sol.v[:, -1]).max() < 1e-30


@METHODS
@PLANAR
def test_8_what_turns_round_leaves_what_has_rested(method, angle):
    # both plates could also go on together (static friction of the joint 0.9, of the floor 1.4, under 1 and 1.6); but
    # nothing makes the lower one let go: under the upper one's 0.3 it is held before and after the turn
    lower, upper = body("lower", 1.0, angle), body("upper", 1.0, angle, -0.5)
    parts = [lower, upper]
    for name, plate, force in (("push", lower, 0.6), ("pull", upper, 1.0)):
        parts += [fm.Force(f"{name}{a}", plate, axis=a, value=f) for a, f in components(angle, force).items()]
    parts.append(fm.Contact("floor", lower, law=fm.laws.Coulomb(mu_s=1.4, mu_k=0.5), normal_force=1.0))
    parts.append(fm.Contact("joint", upper, lower, law=fm.laws.Coulomb(mu_s=0.9, mu_k=0.3), normal_force=1.0))
    turn = 0.5 / 1.3
    t = np.array([0.2, turn, 0.7, 1.0])
    sol = fm.simulate(fm.Scene("plates", parts), t_end=1.0, rtol=1e-9, t_eval=t, method=method)
    assert "floor" not in dict(story(sol))
    before, after = np.minimum(t, turn), np.maximum(t - turn, 0.0)
    assert along(angle, sol, "upper") == pytest.approx(-0.5 * before + 0.65 * before**2 + 0.35 * after**2, abs=1e-8)
    assert np.abs(sol.q[: len(lower.axes)]).max() < 1e-15


@METHODS
def test_8_like_blocks_do_alike(method):
    # three blocks side by side on a belt and two springs to one driver: the same instant for all of them
    V, D = 0.1, 0.3
    puller = fm.Driven("puller", velocity={"x": V})
    blocks = [fm.Body(f"b{i}", mass=1.0) for i in range(3)]
    parts = [fm.Spring(f"k{i}", block, puller, axis="x", stiffness=1.0) for i, block in enumerate(blocks)]
    law = fm.laws.Coulomb(mu_s=0.8, mu_k=0.5)
    parts += [fm.Contact(f"c{i}", block, law=law, normal_force=1.0) for i, block in enumerate(blocks)]
    slip = 2 * (math.pi - math.atan(D / V))
    sol = fm.simulate(fm.Scene("row", [puller, *blocks, *parts]), t_end=13.0, rtol=1e-9, method=method)
    assert sol.events.t == pytest.approx([8.0] * 3 + [8.0 + slip] * 3, abs=1e-8)
    assert [event.kind for event in sol.events] == ["slip"] * 3 + ["stick"] * 3


@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_8_two_contacts_share_a_held_body(method):
    # pinched between two pads: which of them holds how much is not determined, that it stays is
    held = fm.Body("held", mass=1.0, axes="xy")
    force = [fm.Force("fx", held, axis="x", value=0.15 * fm.t), fm.Force("fy", held, axis="y", value=0.2 * fm.t)]
    pads = [fm.Contact(f"pad{i}", held, law=fm.laws.Coulomb(mu_s=0.5), normal_force=1.0) for i in range(2)]
    sol = fm.simulate(fm.Scene("pinched", [held, *force, *pads]), t_end=5.0, rtol=1e-9, method=method)
    assert sorted(story(sol)) == [("pad0", "slip"), ("pad1", "slip")]
    assert sol.events.t == pytest.approx([4.0, 4.0], abs=1e-7)
    # v' = t/4 - 1 from 4 on: v = tau^2/8
    assert np.hypot(*sol.v[:, -1]) == pytest.approx(1 / 8, abs=1e-7)


@METHODS
def test_8_two_blocks_of_a_chain(method):
    ref = reference.load("p4_vdr0.1")
    laws = [fm.laws.HyperbolicStribeck(mu_s=mu_s, delta=3.0) for mu_s in (1.0, 1.3)]
    scene = fm.models.stick_slip_chain(2, coupling=1.2, laws=laws)
    sol = fm.simulate(scene, t_end=float(ref["t"][-1]), rtol=1e-9, t_eval=ref["t"], method=method)
    assert [event.contact for event in sol.events] == [f"sole{k + 1}" for k in ref["contact_event"].tolist()]
    assert sol.events.t == pytest.approx(ref["t_event"], abs=1e-6 * ref["growth"].max())


@pytest.mark.slow
@METHODS
def test_8_twenty_blocks_of_a_chain(method):
    ref = reference.load("p6")
    scene = fm.models.stick_slip_chain(20, mu_s=[1.2 + 0.02 * i for i in range(20)])
    sol = fm.simulate(scene, t_end=float(ref["t"][-1]), rtol=1e-10, t_eval=ref["t"], method=method)
    error = np.abs(sol.q.T - ref["q"]).max(axis=1) / np.abs(ref["q"]).max()
    assert (error < 1e-8 * np.maximum(np.maximum.accumulate(ref["growth"]), 1.0)).all()


# 9 restarts -----------------------------------------------------------------------------------------------------------


@METHODS
def test_9_a_transition_costs_few_steps_and_no_accuracy(method):
    ref = reference.load("p2_a")
    sol = fm.simulate(fm.models.belt_oscillator(), t_end=float(ref["t"][-1]), rtol=1e-10, method=method)
    assert sol.events.t == pytest.approx(ref["t_event"], abs=1e-8)
    steps = np.diff(sol.t)
    for event in sol.events.of(kind="slip"):
        first = steps[np.searchsorted(sol.t, event.t, side="right") - 1]
        # a method of order 1 would have to start with the square root of the tolerance
        assert first > 1e-3


# 10 limits of order ---------------------------------------------------------------------------------------------------


def test_10_growth_of_oscillations_by_order():
    table = growth_table()
    z = SPACING * np.arange(COLUMNS)
    assert not table[:3].any()
    # order 3 grows where z is small, like z^4/4, order 4 less there but up to larger z; order 5 from about 0.7 on
    assert (table[4, (z > 0.1) & (z < 0.4)] < table[3, (z > 0.1) & (z < 0.4)]).all()
    small = (z > 0.1) & (z < 0.3)
    assert table[3, small] == pytest.approx(z[small] ** 4 / 4, rel=0.15)
    assert not table[3, z > 2.0].any()
    assert (table[4, (z > 0.1) & (z < 4.6)] > 0).all()
    assert not table[4, z > 4.8].any()
    assert not table[5, z < 0.5].any()
    assert table[5].max() > table[4].max() > table[3].max() > 0.0
    for k in range(1, MAX_ORDER + 1):
        # exact for polynomials of degree k: the coefficients differentiate x^d at 0 from the values at 0, -1, ...
        c = backward_polynomial(k)
        for d in range(k + 1):
            assert np.sum(c * (-np.arange(k + 1.0)) ** d) == pytest.approx(1.0 if d == 1 else 0.0, abs=1e-10)


@METHODS
@pytest.mark.parametrize("rtol", [1e-3, 1e-5])
def test_10_an_undamped_oscillation_never_grows(method, rtol):
    # a stiff mode that nothing excites beside a slow one that sets the step: neither may gain energy in 1e4 radians
    slow, fast = fm.Body("slow", mass=1.0, position={"x": 1.0}), fm.Body("fast", mass=1.0, position={"x": 1e-6})
    springs = [fm.Spring("a", slow, axis="x", stiffness=1.0), fm.Spring("b", fast, axis="x", stiffness=900.0)]
    sol = fm.simulate(fm.Scene("two", [slow, fast, *springs]), t_end=1e4, rtol=rtol, method=method)
    assert np.abs(sol["slow.x"]).max() < 1.0 + 20 * rtol
    assert np.abs(sol["fast.x"]).max() < 1e-6 + rtol


# 11 round-off of positions --------------------------------------------------------------------------------------------


@METHODS
def test_11_positions_after_many_steps(method):
    ref = reference.load("p1_2")
    sol = fm.simulate(fm.models.brake4dof("2"), t_end=700.0, rtol=1e-12, t_eval=ref["t"], method=method)
    assert np.abs(sol["rotor.x"] - ref["q"][:, 2]).max() < 1e-8
    assert ref["q"][-1, 2] > 1000.0


@METHODS
def test_11_a_long_uniform_slide(method):
    # friction and drive in balance; a fast oscillator beside it keeps the steps short
    slide = fm.Body("slide", mass=1.0, axes="xy", velocity={"x": 0.6, "y": 0.8})
    ring = fm.Body("ring", mass=1.0, position={"x": 1.0})
    parts = [
        fm.Force("fx", slide, axis="x", value=0.3), fm.Force("fy", slide, axis="y", value=0.4),
        fm.Contact("sole", slide, law=fm.laws.Coulomb(mu_s=0.5), normal_force=1.0),
        fm.Spring("k", ring, axis="x", stiffness=100.0),
    ]  # fmt: skip
    sol = fm.simulate(fm.Scene("slide", [slide, ring, *parts]), t_end=2000.0, rtol=1e-8, method=method)
    assert sol["slide.x"][-1] == pytest.approx(1200.0, abs=1e-8)
    assert sol["slide.y"][-1] == pytest.approx(1600.0, abs=1e-8)
    assert story(sol) == []
