"""Taylor steps where friction depends on slip speed or bodies touch each other: references, closed forms, radau."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import sympy

import fricmb as fm

_spec = importlib.util.spec_from_file_location("reference", Path(__file__).parents[2] / "reference.py")
reference = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(reference)


def on_belt(law, *, q, damping=0.0):
    """Mass on a belt, as p2 has it."""
    belt = fm.Driven("belt", velocity={"x": 0.1})
    mass = fm.Body("mass", mass=1.0, position={"x": q}, velocity={"x": 0.1})
    parts = [belt, mass, fm.Spring("spring", mass, axis="x", stiffness=1.0)]
    parts.append(fm.Damper("damper", mass, axis="x", damping=damping))
    return fm.Scene("p2", [*parts, fm.Contact("sole", mass, belt, law=law, normal_force=1.0)])


@pytest.mark.parametrize(("name", "damping"), [("p2_s", 0.0), ("p2_sb", 0.05)])
@pytest.mark.parametrize("rtol", [1e-6, 1e-10])
def test_stribeck_against_certified_motion(name, damping, rtol):
    ref = reference.load(name)
    law = fm.laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=0.05, exponent=1.0)
    scene = on_belt(law, q=ref["q"][0, 0], damping=damping)
    sol = fm.simulate(scene, t_end=ref["t"][-1], t_eval=ref["t"], rtol=rtol, method="taylor")
    assert len(sol.events) == len(ref["t_event"])
    assert sol.events.t == pytest.approx(ref["t_event"], abs=3 * rtol)
    assert max(error.max() for error in reference.errors(ref, sol.q, sol.v)) < 10 * rtol
    assert np.abs(sol.energy.residual).max() < 1e-10


def test_two_blocks_against_certified_motion():
    ref = reference.load("p4_vdr0.1")
    belt = fm.Driven("belt", velocity={"x": 0.1})
    blocks = [fm.Body(f"b{i}", mass=1.0, velocity={"x": 0.1}) for i in range(2)]
    parts = [fm.Spring(f"g{i}", block, axis="x", stiffness=1.0) for i, block in enumerate(blocks)]
    parts.append(fm.Spring("k", *blocks, axis="x", stiffness=1.2))
    for i, (block, mu) in enumerate(zip(blocks, (1.0, 1.3), strict=True)):
        law = fm.laws.HyperbolicStribeck(mu_s=mu, mu_k=0.0, delta=3.0)
        parts.append(fm.Contact(f"s{i}", block, belt, law=law, normal_force=1.0))
    scene = fm.Scene("p4", [belt, *blocks, *parts])
    sol = fm.simulate(scene, t_end=ref["t"][-1], t_eval=ref["t"], rtol=1e-9, method="taylor")
    growth = np.maximum.accumulate(np.maximum(ref["growth"], 1.0))
    assert len(sol.events) == 41
    assert sol.events.t == pytest.approx(ref["t_event"], abs=1e-9 * growth.max())
    assert (np.abs(sol.q.T - ref["q"]).max(axis=1) < 1e-9 * growth).all()
    assert sol.energy.friction_loss[-1] == pytest.approx(ref["Wd"][-1], abs=1e-7)


def test_stack_is_caught_block_by_block():
    sol = fm.simulate(fm.models.block_stack(), t_end=1.0, rtol=1e-6, method="taylor")
    assert [event.contact for event in sol.events] == ["joint1", "joint2", "joint3"]
    assert sol.events.t == pytest.approx([1 / (0.9 * 9.81), 1 / (0.4 * 9.81), 1 / (0.2 * 9.81)], rel=1e-13)
    assert sol.end.q[0] == pytest.approx(1.0 - 0.5 / (0.9 * 9.81), rel=1e-13)


def wall(columns, rows, law, *, belt=0.1, push=None, damping=0.0):
    """Stacks of blocks on a belt, neighbours of a row tied by springs."""
    ground = fm.Driven("belt", velocity={"x": belt})
    parts, block = [ground], {}
    for i in range(columns):
        for j in range(rows):
            b = block[i, j] = fm.Body(f"b{i}_{j}", mass=1 + 0.1 * ((3 * i + 2 * j) % 5), velocity={"x": 0.0})
            parts += [b, fm.Spring(f"g{i}_{j}", b, axis="x", stiffness=1.0 + 0.3 * j)]
            if i:
                parts.append(fm.Spring(f"k{i}_{j}", block[i - 1, j], b, axis="x", stiffness=3.0))
                parts.append(fm.Damper(f"c{i}_{j}", block[i - 1, j], b, axis="x", damping=damping))
            mu = 0.5 * (1.0 + 0.15 * np.sin(2.0 * i + 1.3 * j))
            below = block[i, j - 1] if j else ground
            parts.append(fm.Contact(f"s{i}_{j}", b, below, law=law(mu), normal_force=float(rows - j)))
    if push is not None:
        parts.append(fm.Force("push", block[0, rows - 1], axis="x", value=push))
    return fm.Scene("wall", parts)


def coulomb(mu):
    return fm.laws.Coulomb(mu_s=mu, mu_k=0.35)


def stribeck(mu):
    return fm.laws.Stribeck(mu_s=mu, mu_k=0.3, v_s=0.05)


def rising(mu):
    return fm.laws.CoulombViscous(mu_s=mu, mu_k=0.3, viscous=0.2)


SCENES = {
    "wall": lambda: wall(3, 3, coulomb),
    "wall, weakening": lambda: wall(3, 2, stribeck),
    "row, weakening, dampers": lambda: wall(6, 1, stribeck, damping=0.2),
    "row, strengthening": lambda: wall(5, 1, rising),
    "belt that swings": lambda: wall(2, 2, stribeck, belt=0.8 * sympy.sin(0.9 * fm.t)),
    "push that switches": lambda: wall(2, 2, coulomb, push=1.5 * sympy.sign(sympy.sin(0.5 * fm.t)), damping=0.1),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_against_radau(name):
    scene, grid = SCENES[name](), np.linspace(0.0, 14.0, 57)
    ours = fm.simulate(scene, t_end=14.0, t_eval=grid, rtol=1e-10, method="taylor")
    other = fm.simulate(scene, t_end=14.0, t_eval=grid, rtol=1e-11, method="radau")
    assert np.abs(ours.q - other.q).max() < 1e-8
    assert np.abs(ours.v - other.v).max() < 1e-7
    assert [(e.contact, e.kind) for e in ours.events] == [(e.contact, e.kind) for e in other.events]
    assert len(ours.events) > 5
    assert ours.events.t == pytest.approx(other.events.t, abs=1e-7)
    for part in ("friction_loss", "damping_loss", "input"):
        assert getattr(ours.energy, part) == pytest.approx(getattr(other.energy, part), abs=1e-6)
    # powers of s follow a belt that swings to 1e-11
    assert np.abs(ours.energy.residual).max() < (1e-9 if "swings" in name else 1e-10)


def test_dense_output_and_going_on():
    scene = wall(4, 2, stribeck)
    times = np.sort(np.random.default_rng(3).uniform(0.0, 12.0, 40))
    whole = fm.simulate(scene, t_end=12.0, rtol=1e-8)
    assert whole.stats.method == "taylor"
    asked = fm.simulate(scene, t_end=12.0, t_eval=times, rtol=1e-8)
    np.testing.assert_array_equal(whole(times), np.vstack([asked.q, asked.v]))
    first = fm.simulate(scene, t_end=7.0, rtol=1e-8)
    rest = fm.simulate(scene, t_end=12.0, rtol=1e-8, initial=first)
    assert rest.end.q == pytest.approx(whole.end.q, abs=1e-7)
    assert len(first.events) + len(rest.events) == len(whole.events)


def test_contacts_that_share_their_forces_are_refused():
    law = fm.laws.Coulomb(mu_s=0.5, mu_k=0.4)
    held = fm.Body("held", mass=1.0)
    pads = [fm.Contact(f"pad{i}", held, law=law, normal_force=1.0) for i in range(2)]
    with pytest.raises(fm.SceneError, match="in more than one way"):
        fm.simulate(fm.Scene("pinched", [held, *pads]), t_end=1.0, method="taylor")


def test_dense_output_before_a_switch_of_a_load_does_not_depend_on_what_was_asked_for_last():
    """The stretch of time in which loads are evaluated is that of the time asked for, not of the last one."""
    load = sympy.Piecewise((0.4, fm.t < 18.0), (-0.3, True))
    parts = list(fm.models.stick_slip_chain(4, laws=[fm.laws.Stribeck(mu_s=1.3, mu_k=1.0, v_s=0.1)] * 4).parts)
    body = next(part for part in parts if isinstance(part, fm.Body))
    scene = fm.Scene("pushed", [*parts, fm.Force("push", body, axis="x", value=load)])
    sol, other = (fm.simulate(scene, t_end=26.0, method=method, rtol=1e-9) for method in ("taylor", "radau"))
    early, late = np.linspace(12.0, 17.9, 30), np.linspace(22.0, 25.0, 7)
    for t in (late, early, late, early):
        np.testing.assert_allclose(sol.at(t).v, other.at(t).v, atol=1e-7)
