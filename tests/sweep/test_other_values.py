"""Runs with other values take over what scenes of one family share, and equal runs of scenes made anew bit for bit."""

import pickle

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate.array_cache import forget_results
from fricmb.integrate.collocation.one_contact import workspace as one_contact
from fricmb.integrate.implicit.scene import pattern
from fricmb.integrate.run import workspace
from fricmb.plan import _same, make_plan
from fricmb.plan._make import _make
from fricmb.scene._family_of import forget_families

M = fm.models


def several():
    """Springs along and across, a load, a law of slip speed, a body that nothing moves."""
    belt = fm.Driven("belt", velocity={"x": 0.4})
    a, b = fm.Body("a", mass=1.0, axes="xy", velocity={"x": 0.1}), fm.Body("b", mass=0.7, axes="xy")
    still = fm.Body("still", mass=2.0)
    law = fm.laws.Stribeck(mu_s=0.5, mu_k=0.3, v_s=0.2)
    return fm.Scene("several", [
        belt, a, b, still, fm.Spring("ka", a, axis="x", stiffness=3.0, cubic=0.5), fm.Spring("kb", a, b, axis=(1, 1),
        stiffness=2.0), fm.Spring("tie", b, belt, axis="x", stiffness=1.0), fm.Damper("ca", b, axis="y", damping=0.2),
        fm.Spring("ky", b, axis="y", stiffness=4.0), fm.Force("load", a, axis="y", value=0.1),
        fm.Spring("hold", still, axis="x", stiffness=1.0),
        fm.Contact("ca_belt", a, belt, law=law, normal_force=1.0), fm.Contact("free", b, belt,
        law=fm.laws.Coulomb(mu_s=0.4), normal_force=0.0),
    ])  # fmt: skip


SCENES = {
    "brake": (M.brake4dof, 2.0), "belt": (M.belt_oscillator, 20.0), "several": (several, 4.0),
    "stack": (M.block_stack, 0.5), "planar": (M.planar_oscillator, 4.0), "chain": (lambda: M.stick_slip_chain(5), 3.0),
    "slider crank": (M.slider_crank, 0.05), "dry pendulum": (M.dry_pendulum, 0.3), "heavy top": (M.heavy_top, 0.02),
    "rising top": (M.rising_top, 0.01), "ball": (M.ball_in_cylinder, 0.05), "rod": (M.painleve_rod, 0.02),
}  # fmt: skip


def changes(scene, seed, count):
    """Sets of values: one to three parameters a few per cent away, at 0, or of the other sign."""
    rng = np.random.default_rng(seed)
    names = [name for name, value in scene.parameters.items() if isinstance(value, float)]
    for _ in range(count):
        chosen = rng.choice(names, size=rng.integers(1, 4), replace=False)
        factor = rng.choice([0.0, -1.0, 0.97, 1.02, 1.05], p=[0.15, 0.05, 0.3, 0.3, 0.2], size=3)
        held = {str(name): scene.parameters[str(name)] for name in chosen}
        values = {name: (v or 0.01) * float(f) for (name, v), f in zip(held.items(), factor, strict=False)}
        try:
            yield values, scene.with_parameters(values)
        except fm.FricmbError:
            continue


def forget():
    """Nothing is left of runs before."""
    forget_families()
    for store in (one_contact._store, workspace._store, pattern._store, _same._common, _same._known):
        store.clear()
    forget_results()


def outcome(run):
    """All that a run gave, or why it gave nothing."""
    try:
        sol = run()
    except fm.FricmbError as error:
        return str(error)
    arrays = (sol.t, sol.q, sol.v, sol.energy.residual, sol.energy.friction_loss_by_contact)
    events = [(event.t, event.kind, event.contact) for event in sol.events]
    return [array.tobytes() for array in arrays], events, sol.stats.method, sol.stats.why, sol.stats.notes


@pytest.mark.parametrize("name", SCENES)
def test_other_values_give_what_a_scene_made_anew_gives(name):
    make, t_end = SCENES[name]
    scene = make()
    told = 0
    for values, changed in changes(scene, 1, 14):
        found = outcome(lambda v=values: fm.simulate(scene, t_end=t_end, parameters=v))
        beside = pickle.loads(pickle.dumps(changed))  # of the same family as that of the values before
        assert found == outcome(lambda s=beside: fm.simulate(s, t_end=t_end)), values
        forget()
        anew = pickle.loads(pickle.dumps(changed))
        assert found == outcome(lambda s=anew: fm.simulate(s, t_end=t_end)), values
        told += not isinstance(found, str)
    assert told > 4


@pytest.mark.parametrize("name", [*SCENES, "pad_rotor", "four_bar", "andrews"])
def test_plans_of_a_family_are_those_of_each_scene(name):
    scene = SCENES[name][0]() if name in SCENES else getattr(M, name)()
    make_plan(scene)
    for values, changed in changes(scene, 2, 150):
        plan, own = make_plan(changed), _make(changed, None)
        assert (plan.dofs, plan.parts, plan.islands, plan.idle, plan.counts, plan.left_out, plan.resting) == (
            own.dofs, own.parts, own.islands, own.idle, own.counts, own.left_out, own.resting), values  # fmt: skip
        assert (plan.order, plan.storage, plan.tree, plan.loops) == (own.order, own.storage, own.tree, own.loops)
        assert set(own.notes) <= set(plan.notes), values


def test_a_family_shares_a_plan_where_numbers_alone_differ_and_not_where_a_term_vanishes():
    scene = several()
    plan = make_plan(scene)
    assert make_plan(scene.with_parameters({"ka.stiffness": 5.0})).islands is plan.islands
    other = make_plan(scene.with_parameters({"ka.cubic": 0.0}))
    assert other.counts != plan.counts
    assert make_plan(scene.with_parameters({"still.velocity.x": 1.0})).resting == ()
    moved = scene.replace("kb", axis="x")
    assert make_plan(moved).order == _make(moved, None).order
