"""Impacts of one contact in compiled code against the law for any number of them, in NumPy."""

import math

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate.implicit.impacts import impact


def disc(law):
    body = fm.RigidBody("disc", mass=1.3, inertia=0.02, position=(0.0, 0.8), velocity=(1.0, 0.0), angular_velocity=9.0)
    rub = {"friction": fm.laws.Coulomb(mu_s=0.4, mu_k=0.3)}
    floor = fm.Wheel("floor", body, radius=0.2, push_only=True, restitution=0.7, **rub)
    return fm.Scene("disc", [body, floor, fm.Gravity("g"), fm.ImpactLaw("impacts", law=law)])


def pendulum():
    at = 1.4
    bob = fm.RigidBody(
        "bob", mass=1.0, inertia=0.5, position=(math.sin(at), -math.cos(at)), angle=at, points={"pin": (0.0, 1.0)}
    )
    pin = fm.Revolute("pin", bob.point("pin"), fm.GROUND, friction=fm.laws.Coulomb(mu_s=0.2), radius=0.1)
    stop = fm.Stop("stop", bob, axis="angle", lower=0.3, upper=2.0, restitution=0.7)
    return fm.Scene("pendulum", [bob, pin, stop, fm.Gravity("g")])


def tip():
    """A rod that slips or sticks in its impacts, and turns."""
    c, s = math.cos(0.7), math.sin(0.7)
    rod = fm.RigidBody(
        "rod", mass=1.0, inertia=1 / 12, position=(0.0, 0.5 * s + 0.3), angle=0.7, velocity=(0.3 * c, 0.0),
        points={"tip": (-0.5, 0.0), "end": (0.5, 0.0)},
    )  # fmt: skip
    law = {"friction": fm.laws.Coulomb(mu_s=0.5), "tangential_restitution": 0.2}
    feet = [
        fm.RollerOnLine(name, rod.point(name), push_only=True, restitution=0.6, **law) for name in ("tip", "end")
    ]
    return fm.Scene("rod", [rod, *feet, fm.Gravity("g")])


SCENES = {"newton": lambda: disc("newton"), "poisson": lambda: disc("poisson"), "pendulum": pendulum, "rod": tip}


@pytest.mark.parametrize("name", SCENES)
def test_one_contact_does_what_the_law_for_several_says(name, monkeypatch):
    quick = fm.simulate(SCENES[name](), t_end=2.0, rtol=1e-9)
    calls = []
    monkeypatch.setattr(impact, "_hit_alone", lambda *arguments: calls.append(0))
    whole = fm.simulate(SCENES[name](), t_end=2.0, rtol=1e-9)
    assert len(calls) > 1
    assert [(event.kind, event.contact) for event in quick.events] == [(e.kind, e.contact) for e in whole.events]
    assert np.allclose([event.t for event in quick.events], [e.t for e in whole.events], rtol=0, atol=1e-11)
    hits = zip(quick.events.of(kind="impact"), whole.events.of(kind="impact"), strict=True)
    for a, b in hits:
        one = [a.impulse, a.tangential_impulse, a.approach, a.loss, a.others]
        assert np.allclose(one, [b.impulse, b.tangential_impulse, b.approach, b.loss, b.others], rtol=0, atol=1e-9)
    assert np.allclose(quick.q[:, -1], whole.q[:, -1], rtol=0, atol=1e-10)
    assert np.allclose(quick.energy.residual[-1], whole.energy.residual[-1], rtol=0, atol=1e-11)
    assert quick.stats.notes == whole.stats.notes
    assert quick.audit().ok
