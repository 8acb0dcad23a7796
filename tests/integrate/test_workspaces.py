"""Runs borrow workspaces: what is left in those of one run never reach another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb._simulate._mechanics import prepare
from fricmb.integrate import Tolerance
from fricmb.integrate.implicit import run
from fricmb.integrate.implicit.scene.problem_structs import mech_of
from fricmb.integrate.named import integrators
from fricmb.integrate.run import workspace
from tests.ticking import ticking

SCENES = {
    "lugre": lambda: fm.models.belt_oscillator(
        law=fm.laws.LuGre(sigma0=1e3, sigma1=10.0, sigma2=0.1, mu_s=1.2, mu_k=1.0, v_s=0.1)
    ),
    "planar": fm.models.planar_oscillator,
    "row": lambda: fm.models.stick_slip_chain(3, laws=[fm.laws.Stribeck(mu_s=1.3, mu_k=1.0, v_s=0.1)] * 3),
}


def motion(sol):
    return np.concatenate([np.asarray(x, float).ravel() for x in (sol.t, sol.q, sol.v, [e.t for e in sol.events])])


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("name", SCENES)
def test_a_run_inside_another_changes_nothing(name, method):
    """From a callback in the middle of a run the same scene is run, with other values and with the same."""
    scene, how = SCENES[name](), {"t_end": 6.0, "rtol": 1e-6, "method": method}
    alone = motion(fm.simulate(scene, **how))
    mass = next(p for p in scene.parameters if p.endswith(".mass"))
    other = {mass: 1.5 * scene.parameters[mass]}
    inner, parts = [], []

    def look(part):
        parts.append(part.t_end)
        inner.append(motion(fm.simulate(scene, **how)))
        fm.simulate(scene, parameters=other, **how)

    chunks = fm.simulate(scene, on_chunk=look, chunk=2.0, **how)
    assert len(parts) > 1
    assert all(np.array_equal(one, alone) for one in inner)
    np.testing.assert_allclose(chunks.q[:, -1], fm.simulate(scene, **how).q[:, -1], rtol=1e-4, atol=1e-6)
    assert np.array_equal(motion(fm.simulate(scene, **how)), alone)


def arrays(held):
    """All numbers of nested rooms and tuples, one after another."""
    if isinstance(held, int | float | np.ndarray):
        return np.asarray(held).tobytes()
    parts = held if isinstance(held, tuple) else [getattr(held, name) for name in held.room_type.of]
    return b"".join(arrays(part) for part in parts)


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("name", SCENES)
def test_a_run_that_another_comes_between_is_the_same(name, method, monkeypatch):
    """Between two calls of its kernels, as of another thread, the same problem is run from afar and looked at."""
    monkeypatch.setattr(run, "CHUNK", 64)
    scene, tolerance = SCENES[name](), Tolerance(rtol=1e-6)
    mechanics = prepare(scene, None, None)
    start, problem = mechanics.start, mechanics.members[0].system.problem
    shared = arrays(mech_of(problem))
    integrator, other = integrators[method](), integrators[method]()
    earlier = integrator.integrate(problem, start, 2.0, tolerance=tolerance)
    called = []

    def between(t):
        called.append(t)
        earlier.motion(np.linspace(0.0, 2.0, 9))
        far = replace(start, q=start.q + 1e14, v=start.v + 1.0)
        other.integrate(problem, far, 0.5, tolerance=Tolerance(rtol=1e-3))

    def bits(progress):
        with ticking():
            found = integrator.integrate(problem, start, 20.0, tolerance=tolerance, progress=progress)
        motion = found.motion(np.linspace(0.0, 20.0, 40))
        return [np.asarray(x).tobytes() for x in (found.t, motion.q, motion.v, motion.F, found.transitions.t)]

    assert bits(between) == bits(lambda t: None)
    assert len(called) > 1
    assert arrays(mech_of(problem)) == shared


def test_without_prescribed_loads_a_run_takes_few_steps():
    """A puck that comes to rest: as many steps as its motion needs, not a hundred; with a load in time a hundred."""
    puck = fm.models.puck_on_belt()
    assert fm.simulate(puck, t_end=1.0, rtol=1e-4, method="radau").stats.n_steps < 40
    body = next(p for p in puck.parts if isinstance(p, fm.Body))
    pulse = fm.Force("pulse", body, axis=next(iter(body.axes)), value=1e-3 * fm.t**2)
    assert fm.simulate(fm.Scene("pulse", [*puck.parts, pulse]), t_end=1.0, rtol=1e-4, method="radau").stats.n_steps > 90


def held():
    """A block on dry ground under a force that jumps forty times and swings between."""
    t = np.linspace(0.0, 8.0, 41)
    block, force = fm.Body("b", mass=1.0), fm.Signal(t, np.sin(3.0 * np.arange(41.0)), kind="hold")
    return fm.Scene("held", [
        block, fm.Spring("k", block, axis="x", stiffness=4.0), fm.Force("f", block, axis="x", value=force),
        fm.Force("g", block, axis="x", value=0.2 * sympy.sin(50 * fm.t)),
        fm.Contact("c", block, law=fm.laws.Coulomb(mu_s=0.9, mu_k=0.7), normal_force=1.0),
    ])  # fmt: skip


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_space_for_rows_may_end_where_forces_jump(method, monkeypatch):
    """Where a step to a jump filled it the jump was not gone through: what rested stopped, and rows were missing."""
    scene, how = held(), {"t_end": 8.0, "rtol": 1e-6, "method": method}
    alone = motion(fm.simulate(scene, **how))
    for size in range(64, 84):
        monkeypatch.setattr(run, "CHUNK", size)
        assert np.array_equal(motion(fm.simulate(scene, **how)), alone), size


def on_a_spring(cubic):
    """A body on a spring, whose equations are linear or are not."""
    body, law = fm.Body("m", mass=1.0, position={"x": 1.5}), fm.laws.Coulomb(mu_s=0.1, mu_k=0.07)
    spring = fm.Spring("k", body, axis="x", stiffness=1.0, cubic=cubic)
    return fm.Scene("spring", [body, spring, fm.Contact("c", body, law=law, normal_force=1.0)])


def ageing_one(first):
    """Two blocks on a belt, of which the first or the second has friction that ages."""
    ages = fm.laws.RateAndState(mu_0=0.6, a=0.01, b=0.015, L=1e-3, v_0=1e-3)
    laws = [ages, fm.laws.Coulomb(mu_s=0.4)]
    belt, parts = fm.Driven("belt", velocity={"x": 0.3}), []
    for i, law in enumerate(laws if first else laws[::-1]):
        body = fm.Body(f"b{i}", mass=1.0, velocity={"x": 0.3})
        parts += [body, fm.Spring(f"k{i}", body, axis="x", stiffness=10.0)]
        parts.append(fm.Contact(f"c{i}", body, belt, law=law, normal_force=2.0))
    parts.append(fm.Spring("tie", parts[0], parts[3], axis="x", stiffness=1.0))
    return fm.Scene("two", [belt, *parts])


@pytest.mark.parametrize(
    ("make", "one", "other", "t_end", "rtol"),
    [(on_a_spring, 2.0, 0.0, 20.0, 1e-11), (ageing_one, True, False, 1.5, 1e-5)],
)
def test_a_run_behind_one_of_another_scene_of_the_same_sizes(make, one, other, t_end, rtol, monkeypatch):
    """What is linear, and which law is steep, was taken from the scene that had been run before."""
    how = {"t_end": t_end, "rtol": rtol, "method": "radau"}
    monkeypatch.setattr(workspace, "_store", {})
    alone = motion(fm.simulate(make(one), **how))
    monkeypatch.setattr(workspace, "_store", {})
    fm.simulate(make(other), **how)
    np.testing.assert_array_equal(motion(fm.simulate(make(one), **how)), alone)
