"""Taylor steps of contacts in two directions: closed forms, the oracle, other methods, scenes with both kinds."""

import math

import numpy as np
import pytest
import sympy

import fricmb as fm
from tests.oracle.judge import judge, truth
from tests.oracle.random_scenes import generate
from tests.oracle.spec import case_of

PULL, RUB = 0.2, 0.5


def sliding(turn, law, speed=1.0, pull=PULL):
    """A unit mass on the ground, sliding across a constant force, all turned by an angle."""
    along, across = np.array([math.cos(turn), math.sin(turn)]), np.array([-math.sin(turn), math.cos(turn)])
    block = fm.Body("block", mass=1.0, axes="xy", velocity=dict(zip("xy", speed * across, strict=True)))
    parts = [fm.Force(f"pull {axis}", block, axis=axis, value=f) for axis, f in zip("xy", pull * along, strict=True)]
    sole = fm.Contact("sole", block, law=law, normal_force=1.0)
    return fm.Scene("slide", [block, *parts, sole]), along, across


@pytest.mark.parametrize("turn", [0.0, 0.7, 4.0])
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-9])
def test_a_block_comes_to_rest_under_a_force_across(turn, rtol):
    """T = b v/(b^2 - a^2) and the way to rest from the rates of r^2 and r u (see ``taylor/landing``); F = -a then."""
    scene, along, across = sliding(turn, fm.laws.Coulomb(mu_s=RUB))
    sol = fm.simulate(scene, t_end=4.0, rtol=rtol, method="taylor")
    (stick,) = sol.events
    left = RUB**2 - PULL**2
    assert stick.kind == "stick"
    assert stick.t == pytest.approx(RUB / left, rel=rtol)
    way = PULL / (4.0 * left) * along + 2.0 * RUB / (4.0 * RUB**2 - PULL**2) * across
    np.testing.assert_allclose(sol.q[:, -1], way, atol=rtol)
    np.testing.assert_allclose(sol.force("sole")[:, -1], -PULL * along, atol=1e-12)
    # all the block had, and what the force has brought, is gone
    assert sol.energy.friction_loss[-1] == pytest.approx(0.5 + PULL * way @ along, rel=rtol)
    assert np.abs(sol.energy.residual).max() < 10.0 * rtol


def test_a_force_that_is_more_than_friction_turns_slip_round():
    """u . a and r obey u_a' = a - b c, r' = a c - b: b r + a u_a falls at the rate b^2 - a^2, here it grows."""
    scene, along, _ = sliding(1.1, fm.laws.Coulomb(mu_s=RUB), pull=0.6)
    sol = fm.simulate(scene, t_end=20.0, rtol=1e-8, method="taylor")
    assert not sol.events
    u = np.stack([sol.velocity("block.x"), sol.velocity("block.y")])
    sizes = RUB * np.linalg.norm(u, axis=0) + 0.6 * along @ u
    np.testing.assert_allclose(sizes, RUB + (0.36 - RUB**2) * sol.t, atol=1e-7)


def test_a_straight_way_through_rest_is_no_stick():
    """Against a force beyond its cone a contact comes to rest for an instant, and slides back."""
    block = fm.Body("block", mass=1.0, axes="xy", velocity={"x": -0.6, "y": -0.8})
    parts = [fm.Force(a, block, axis=a, value=f) for a, f in (("x", 0.33), ("y", 0.44))]
    sole = fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=0.5, mu_k=0.4), normal_force=1.0)
    sol = fm.simulate(fm.Scene("back", [block, *parts, sole]), t_end=10.0, rtol=1e-8, method="taylor")
    turned = 1.0 / 0.95
    back = 0.5 * 0.15 * (10.0 - turned) ** 2 - 0.5 * turned
    assert not sol.events
    np.testing.assert_allclose(sol.q[:, -1], [0.6 * back, 0.8 * back], atol=1e-7)


@pytest.mark.parametrize("seed", [0, 130001, 130004, 130007])
def test_as_the_oracle_says(seed):
    true = truth(case_of(generate("plane", seed)))
    assert not true.marginal
    assert judge(true, "taylor").kind == "right"


LAWS = {
    "equal": fm.laws.Coulomb(mu_s=0.5),
    "Coulomb": fm.laws.Coulomb(mu_s=0.6, mu_k=0.4),
    "Stribeck": fm.laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.05, exponent=1.0),
    "flat": fm.laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.02, exponent=2.0),
}


def masses(laws, *, axes=(None, None, None), swing=False):
    """Three masses in the plane on a belt, coupled; one contact of them may be along x alone."""
    speed = {"x": 0.1 + 0.05 * sympy.sin(1.3 * fm.t) if swing else 0.1, "y": 0.03}
    belt = fm.Driven("belt", velocity=speed)
    at = [{"x": 0.1 * i, "y": 0.4 - 0.3 * i} for i in range(3)]
    bodies = [fm.Body(f"m{i}", mass=1.0 + 0.3 * i, axes="xy", position=at[i]) for i in range(3)]
    held = [(i, a, k) for i in range(3) for a, k in (("x", 1.0), ("y", 1.7))]
    parts = [fm.Spring(f"g{i}{a}", bodies[i], axis=a, stiffness=k) for i, a, k in held]
    parts += [fm.Spring(f"c{i}{a}", bodies[i], bodies[i + 1], axis=a, stiffness=4.0) for i in range(2) for a in "xy"]
    parts.append(fm.Damper("d", bodies[0], bodies[1], axis="x", damping=0.1))
    for i, (body, law) in enumerate(zip(bodies, laws, strict=True)):
        only = {} if axes[i] is None else {"axes": axes[i]}
        parts.append(fm.Contact(f"k{i}", body, belt, law=law, normal_force=1.0 - 0.2 * i, **only))
    return fm.Scene("masses", [belt, *bodies, *parts])


SCENES = {
    **{name: masses([law] * 3) for name, law in LAWS.items()},
    "all laws": masses([LAWS["Coulomb"], LAWS["Stribeck"], LAWS["equal"]]),
    "one along x": masses([LAWS["Coulomb"], LAWS["Stribeck"], LAWS["Coulomb"]], axes=(None, None, "x")),
    "two along x": masses([LAWS["Coulomb"], LAWS["Stribeck"], LAWS["flat"]], axes=("x", "x", None)),
    "a belt that swings": masses([LAWS["Coulomb"], LAWS["flat"], LAWS["Coulomb"]], swing=True),
}


@pytest.mark.parametrize("name", SCENES)
def test_as_steps_of_another_kind(name):
    """Transitions one by one, and the motion to the tolerance, of Radau steps at a thousandth of it."""
    scene, t = SCENES[name], np.linspace(0.0, 15.0, 76)
    true = fm.simulate(scene, t_end=15.0, rtol=1e-10, t_eval=t, method="radau")
    sol = fm.simulate(scene, t_end=15.0, rtol=1e-7, t_eval=t, method="taylor")
    order = [sorted((e.contact, e.t, e.kind) for e in run.events) for run in (sol, true)]
    assert len(true.events) > 3
    assert [(c, kind) for c, _, kind in order[0]] == [(c, kind) for c, _, kind in order[1]]
    np.testing.assert_allclose([at for _, at, _ in order[0]], [at for _, at, _ in order[1]], atol=3e-6)
    np.testing.assert_allclose(sol.q, true.q, atol=3e-7)
    np.testing.assert_allclose(sol.v, true.v, atol=1e-6)
    for k in range(3):
        np.testing.assert_array_equal(sol.mode(f"k{k}"), true.mode(f"k{k}"))
    np.testing.assert_allclose(sol.energy.friction_loss, true.energy.friction_loss, atol=1e-6)
    assert sol.audit().ok, sol.audit().table()


def test_any_time_is_run_again_to_the_last_digit():
    """Rows, values between them and values asked for in advance come from runs that begin at other checkpoints."""
    scene, t = SCENES["all laws"], np.linspace(0.0, 15.0, 301)
    ahead = fm.simulate(scene, t_end=15.0, rtol=1e-6, t_eval=t, method="taylor")
    rows = fm.simulate(scene, t_end=15.0, rtol=1e-6, method="taylor")
    np.testing.assert_array_equal(rows(t[200:]), ahead(t[200:]))
    np.testing.assert_array_equal(rows.at(t).force("k1"), ahead.force("k1"))


def test_islands_in_the_plane_are_joined():
    """Masses that nothing ties, each with its own steps, have rows in common."""
    belt = fm.Driven("belt", velocity={"x": 0.1})
    parts = []
    for i in range(2):
        body = fm.Body(f"m{i}", mass=1.0 + i, axes="xy", position={"y": 0.5})
        parts += [body, fm.Contact(f"k{i}", body, belt, law=LAWS["Coulomb"], normal_force=1.0)]
        parts += [fm.Spring(f"g{i}{a}", body, axis=a, stiffness=2.0) for a in "xy"]
    scene = fm.Scene("two", [belt, *parts])
    sol, other = (fm.simulate(scene, t_end=10.0, rtol=1e-8, method=m) for m in ("taylor", "radau"))
    assert [(e.contact, e.kind) for e in sol.events] == [(e.contact, e.kind) for e in other.events]
    np.testing.assert_allclose(sol(other.t), other(other.t), atol=1e-6)
    np.testing.assert_allclose(sol.normal_force("k1"), 1.0)


def test_auto_takes_them_for_several_contacts():
    sol = fm.simulate(SCENES["all laws"], t_end=1.0, rtol=1e-6)
    assert sol.stats.method == "taylor"


def stacked(law, **contact):
    """A block on a block, both in the plane."""
    low, top = (fm.Body(name, mass=1.0, axes="xy", velocity={"x": 1.0}) for name in ("low", "top"))
    return fm.Scene("stack", [
        low, top, fm.Contact("ground", low, law=law, normal_force=2.0),
        fm.Contact("between", top, low, law=law, normal_force=1.0, **contact),
    ])  # fmt: skip


def test_what_is_left_to_others():
    with pytest.raises(fm.SceneError, match="contact 'ground', which slides in two directions, shares a body"):
        fm.simulate(stacked(LAWS["Coulomb"]), t_end=1.0, method="taylor")
    block = fm.Body("block", mass=1.0, axes="xy", velocity={"x": 1.0})
    law = fm.laws.Elliptic(law=LAWS["Coulomb"], ratio=0.5)
    scene = fm.Scene("s", [block, fm.Contact("sole", block, law=law, normal_force=1.0)])
    with pytest.raises(fm.SceneError, match="'sole' does not answer to a force alike in all directions"):
        fm.simulate(scene, t_end=1.0, method="taylor")
    assert fm.simulate(stacked(LAWS["Coulomb"]), t_end=1.0).stats.method != "taylor"


def test_slip_that_sets_out_from_rest_takes_few_steps():
    """Nothing moves yet: what counts as little is what the force that grows brings in the step."""
    pulls = [("x", 0.7 * fm.t), ("y", 0.3 * fm.t + 0.1 * fm.t**2)]
    block = fm.Body("block", mass=1.0, axes="xy")
    parts = [fm.Force(f"f{axis}", block, axis=axis, value=F) for axis, F in pulls]
    law = fm.laws.Lorentzian(mu_s=0.2, mu_k=0.08, v_s=0.05, viscous=0.02)
    scene = fm.Scene("out", [block, *parts, fm.Contact("sole", block, law=law, normal_force=11.0)])
    true = fm.simulate(scene, t_end=5.0, rtol=1e-10, method="radau")
    for rtol in (1e-4, 1e-8):
        sol = fm.simulate(scene, t_end=5.0, rtol=rtol)
        assert sol.stats.method == "taylor"
        assert sol.stats.n_steps < 250
        assert [e.kind for e in sol.events] == ["slip"]
        np.testing.assert_allclose(sol.q[:, -1], true.q[:, -1], atol=rtol)


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-9])
@pytest.mark.parametrize("N", [1e-10, 1e-6, 1e-2])
def test_weak_friction_is_told_as_it_is(N, rtol):
    """Steps are as long as motion bears, and the direction of friction that hardly matters turns much faster."""
    block = fm.Body("block", mass=1.0, axes="xy", velocity={"x": 0.3, "y": -0.7})
    belt = fm.Driven("belt", velocity={"x": 0.1})
    parts = [fm.Spring(f"s{axis}", block, axis=axis, stiffness=1.0) for axis in "xy"]
    parts += [fm.Force("f", block, axis="x", value=0.3 * sympy.sin(0.7 * fm.t))]
    sole = fm.Contact("sole", block, belt, law=fm.laws.Coulomb(mu_s=0.5), normal_force=N)
    scene, t = fm.Scene("weak", [block, belt, *parts, sole]), np.linspace(0.0, 20.0, 401)
    true = fm.simulate(scene, t_end=20.0, rtol=1e-10, t_eval=t, method="radau")
    sol = fm.simulate(scene, t_end=20.0, rtol=rtol, t_eval=t, method="taylor")
    np.testing.assert_allclose(sol.force("sole") / (0.5 * N), true.force("sole") / (0.5 * N), atol=max(rtol, 1e-8))
    np.testing.assert_allclose(sol.energy.friction_loss, true.energy.friction_loss, rtol=1e-5, atol=1e-6 * N)
    assert sol.audit().ok, sol.audit().table()


@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
def test_a_run_goes_on_from_a_transition(rtol):
    """What lets go or comes to rest where a run ends is told once, by that run or by the next."""
    scene = SCENES["Stribeck"]
    whole = fm.simulate(scene, t_end=15.0, rtol=rtol, method="taylor")
    for event in list(whole.events)[:10]:
        first = fm.simulate(scene, t_end=event.t, rtol=rtol, method="taylor")
        then = fm.simulate(scene, t_end=15.0, rtol=rtol, method="taylor", initial=first)
        told = [(e.contact, e.kind) for e in (*first.events, *then.events)]
        assert told == [(e.contact, e.kind) for e in whole.events]
        np.testing.assert_allclose(then.q[:, -1], whole.q[:, -1], atol=rtol)


def test_a_run_leaves_nothing_to_the_next():
    """One that ends where a contact breaks away; the next starts with a speed."""
    scene, _, _ = sliding(0.3, fm.laws.Coulomb(mu_s=RUB), speed=0.0, pull=0.4 * fm.t)
    start = {"velocity": {"block.x": 0.7}}
    alone = fm.simulate(scene, t_end=1.0, rtol=1e-8, method="taylor", initial=start)
    (slip,) = fm.simulate(scene, t_end=3.0, rtol=1e-8, method="taylor").events
    assert fm.simulate(scene, t_end=float(np.nextafter(slip.t, 9.0)), rtol=1e-8, method="taylor").events
    after = fm.simulate(scene, t_end=1.0, rtol=1e-8, method="taylor", initial=start)
    np.testing.assert_array_equal(after.q, alone.q)


@pytest.mark.parametrize("axes", ["x", "xy"])
def test_rows_stand_on_both_sides_of_a_belt_that_jumps_under_slip(axes):
    """No contact changes its mode there, but slip velocities and friction do; audits look at what is between rows."""
    later = {"y": 0.05} if axes == "xy" else {}
    speed = sympy.Piecewise((0.1, fm.t < 5.0), (0.5, True))
    belt = fm.Driven("belt", velocity={"x": speed, **later})
    parts = [belt]
    for i in range(2):
        body = fm.Body(f"b{i}", mass=1.0, axes=axes, velocity=dict.fromkeys(axes, 1.0))
        springs = [fm.Spring(f"k{i}{a}", body, axis=a, stiffness=0.2 + 0.1 * i) for a in axes]
        law = fm.laws.Coulomb(mu_s=0.06, mu_k=0.04)
        parts += [body, *springs, fm.Contact(f"c{i}", body, belt, axes=tuple(axes), law=law, normal_force=1.0)]
    sol = fm.simulate(fm.Scene("jump", parts), t_end=6.0, rtol=1e-8, method="taylor")
    before, behind = np.flatnonzero(np.abs(sol.t - 5.0) < 1e-12)
    slip = [sol.relative_velocity(f"c{i}") for i in range(2)]
    for g in slip:
        x = np.atleast_2d(g)[0]
        assert x[behind] - x[before] == pytest.approx(-0.4, abs=1e-9)
    assert sol.audit().ok, sol.audit().table()
