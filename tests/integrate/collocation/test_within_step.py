"""Transitions located on the motion within a step, and contacts that stick eliminated once for a step of the ladder."""

import itertools

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate.collocation import Collocation

GENERAL = Collocation(general=True)


def row(n, *, coupling):
    """Blocks beside each other on a belt."""
    belt = fm.Driven("belt", velocity={"x": 0.1})
    blocks = [fm.Body(f"b{i}", mass=1.0) for i in range(n)]
    law = fm.laws.Coulomb(mu_s=1.3, mu_k=1.0)
    parts = [belt, *blocks]
    for i, block in enumerate(blocks):
        parts.append(fm.Spring(f"g{i}", block, axis="x", stiffness=1.0))
        parts.append(fm.Contact(f"c{i}", block, belt, law=law, normal_force=1.0 + 0.1 * i))
    for i, (one, next_one) in enumerate(itertools.pairwise(blocks)):
        parts.append(fm.Spring(f"k{i}", one, next_one, axis="x", stiffness=coupling))
    return fm.Scene("row", parts)


def pads(n):
    """Pads on springs that rub in the plane on one rotor, which slows down."""
    rotor = fm.Body("rotor", mass=100.0, axes="xy", velocity={"x": 3.0, "y": 0.01})
    parts = [rotor, fm.Spring("k", rotor, axis="y", stiffness=300.0)]
    law = fm.laws.Coulomb(mu_s=1.2, mu_k=1.0)
    for i in range(n):
        pad = fm.Body(f"pad{i}", mass=1.0, axes="xy")
        parts += [
            pad,
            fm.Spring(f"kx{i}", pad, axis="x", stiffness=1.0 + 0.1 * i),
            fm.Spring(f"ky{i}", pad, axis="y", stiffness=30.0 + i),
            fm.Contact(f"lining{i}", pad, rotor, law=law, normal_force=5.0),
        ]
    return fm.Scene("pads", parts)


@pytest.mark.parametrize("scene", [row(2, coupling=20.0), pads(2), pads(3)], ids=["row", "two pads", "three pads"])
def test_transitions_are_where_other_formulas_find_them(scene):
    found = fm.simulate(scene, t_end=60.0, rtol=1e-9, method=GENERAL)
    other = fm.simulate(scene, t_end=60.0, rtol=1e-11, method="radau")
    assert len(found.events) > 8
    assert [(e.contact, e.kind) for e in found.events] == [(e.contact, e.kind) for e in other.events]
    assert [e.t for e in found.events] == pytest.approx([e.t for e in other.events], abs=1e-7)


@pytest.mark.parametrize("scene", [row(2, coupling=20.0), pads(2), pads(3)], ids=["row", "two pads", "three pads"])
def test_few_systems_are_solved_for_a_transition(scene):
    """Located by steps of variable length alone it takes four to six."""
    sol = fm.simulate(scene, t_end=60.0, rtol=1e-6, method=GENERAL)
    assert sol.stats.n_rhs - sol.stats.n_steps - sol.stats.n_rejected <= 2.0 * len(sol.events)


def test_energy_is_kept_where_steps_end_within_what_was_solved():
    sol = fm.simulate(pads(2), t_end=60.0, rtol=1e-8, method=GENERAL)
    assert sol.energy.residual.max() == pytest.approx(0.0, abs=1e-7 * np.max(sol.energy.total))


def test_runs_do_not_depend_on_what_runs_before_them_left():
    scene = pads(3)
    first, second, anew = (
        fm.simulate(each, t_end=30.0, rtol=1e-6, method=GENERAL) for each in (scene, scene, pads(3))
    )
    np.testing.assert_array_equal(first.q, second.q)
    np.testing.assert_array_equal(first.q, anew.q)
