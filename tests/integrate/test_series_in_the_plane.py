"""Few contacts in the plane on modes: steps by series, against exact structure; what is drawn where slip ends."""

from __future__ import annotations

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate.constrained.dense_rows import dense_rows
from fricmb.integrate.constrained.structure import mechanism_of
from fricmb.system import build


def pad(contacts, modes, velocity, load):
    """A body by its modes on a disc that moves, pressed at points."""
    rng, law = np.random.default_rng(1), fm.laws.Coulomb(mu_s=0.6, mu_k=0.4)
    shapes = {f"p{i}": rng.normal(size=(2, modes)) for i in range(contacts)}
    omega = 2.0 * np.pi * np.linspace(300.0, 6000.0, modes)
    body = fm.ModalBody("pad", frequencies=omega, damping_ratios=0.005, shapes=shapes, axes="xy")
    disc = fm.Driven("disc", velocity=dict(zip("xy", velocity, strict=True)))
    rubs = {"law": law, "normal_force": load, "axes": "xy"}
    points = [fm.Contact(f"c{i}", body.point(f"p{i}"), disc, **rubs) for i in range(contacts)]
    return fm.Scene("pad", [body, disc, *points])


SCENES = {
    "slides": (2, 10, (0.02, 0.003), 20.0, 0),
    "lands": (3, 30, (0.02, 0.003), 20.0, 2),
    "two stick and slip": (2, 12, (0.004, 0.0), 30.0, 6),
    "four stick and slip": (4, 24, (0.001, 0.002), 15.0, 47),
}


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("name", SCENES)
def test_series_against_exact_structure(name, method):
    """Collocation of the port forces knows the structure between its nodes in closed form and shares no step."""
    *given, count = SCENES[name]
    scene, t = pad(*given), np.linspace(0.0, 0.02, 41)
    problem = build(scene).problem
    assert dense_rows(problem, mechanism_of(problem)).inverse.size
    true = fm.simulate(scene, t_end=0.02, rtol=1e-11, method="collocation", t_eval=t)
    assert len(true.events) == count
    for rtol in (1e-4, 1e-8):
        sol = fm.simulate(scene, t_end=0.02, rtol=rtol, method=method, t_eval=t)
        assert [(e.kind, e.contact) for e in sol.events] == [(e.kind, e.contact) for e in true.events]
        assert sol.events.t == pytest.approx(true.events.t, abs=1e-3 * rtol)
        for found, exact in ((sol.q, true.q), (sol.v, true.v)):
            size = np.abs(exact).max(axis=1)
            assert (np.abs(found - exact).max(axis=1) < rtol * size).all()


def test_forces_of_what_sticks_beside_a_contact_that_lands_are_in_their_cones():
    """The friction of the one that lands had the direction of round-off in the row of its end: 700 rtol."""
    scene = pad(*SCENES["four stick and slip"][:-1])
    sol = fm.simulate(scene, t_end=0.02, rtol=1e-4, method="radau")
    for contact in scene.contacts:
        size, mode = np.hypot(*sol.force(contact.name)), sol.mode(contact.name)
        assert size[mode == 0].max() < 0.6 * 15.0 * (1.0 + 1e-9)
        np.testing.assert_allclose(size[mode == 1], 0.4 * 15.0, rtol=1e-9)
    assert sol.audit().ok, sol.audit()


def test_points_of_a_pad_that_land_together():
    """Some are nearly redundant in stick, and one was left slipping at 1e-10: no step got any further."""
    scene = fm.models.pad_rotor(n_contacts=2, speed=0.01)
    for rtol in (1e-3, 1e-6, 1e-8):
        sol = fm.simulate(scene, t_end=0.02, rtol=rtol, method="radau")
        assert [e.kind for e in sol.events] == ["stick", "stick"]
        assert not sol.stats.notes
        assert sol.events[1].t == pytest.approx(sol.events[0].t, rel=1e-8)
