"""Contacts beside joints whose load passes through 0: when, to the last digits, and what they do in the meantime."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

import fricmb as fm

METHODS = pytest.mark.parametrize("method", ["radau", "bdf"])


def slide(**options):
    body = fm.RigidBody("block", mass=1.0, inertia=1.0, **options)
    return body, fm.Prismatic("guide", body, fm.ground_point(0.0, 0.0))


@METHODS
@pytest.mark.parametrize("law", [fm.laws.Coulomb(mu_s=0.5), fm.laws.TanhRegularised(mu=0.5, v_reg=1e-3)])
def test_a_load_that_is_given_opens_and_closes(law, method):
    """N = max(0, cos t): the speed falls by half of its integral, which is 2 for every half period closed."""
    body, guide = slide(velocity=(10.0, 0.0))
    sole = fm.Contact("sole", body, law=law, normal_force=sympy.cos(fm.t), axes="x")
    sol = fm.simulate(fm.Scene("lifted", [body, guide, sole]), t_end=18.0, rtol=1e-8, method=method)
    expected = np.pi * (np.arange(6) + 0.5)
    assert [e.kind for e in sol.events] == ["open", "close"] * 3
    assert [e.t for e in sol.events] == pytest.approx(expected, abs=1e-11)
    cycle, phase = np.divmod(sol.t + np.pi / 2, 2.0 * np.pi)
    impulse = 2.0 * cycle + np.where(phase < np.pi, 1.0 - np.cos(phase), 2.0) - 1.0
    np.testing.assert_allclose(sol.velocity("block.x"), 10.0 - 0.5 * impulse, rtol=0, atol=1e-9)


@METHODS
def test_a_load_by_hertz_sets_in_where_bodies_touch(method):
    """Its force is next to nothing as long as they are near: v t and the height say when."""
    body, guide = slide(position=(1.0, 0.0), velocity=(-1.0, 0.0))
    press = fm.normal.Hertz(axis="x", stiffness=500.0, damping=0.0)
    stop = fm.Contact("stop", body, law=fm.laws.Coulomb(mu_s=0.3), normal_force=press, axes="y")
    sol = fm.simulate(fm.Scene("bounce", [body, guide, stop]), t_end=2.5, rtol=1e-8, method=method)
    closes, opens = (e.t for e in sol.events)
    assert closes == pytest.approx(1.0, abs=1e-13)
    # back with the speed that it came with
    assert sol.velocity("block.x")[-1] == pytest.approx(1.0, abs=1e-7)
    assert opens == pytest.approx(2.5 - sol.q[sol.dof_names.index("block.x"), -1], abs=1e-7)
