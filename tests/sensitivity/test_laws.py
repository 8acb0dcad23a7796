"""Derivatives under every law of the catalogue, beside differences of runs."""

import numpy as np
import pytest
import sympy

import fricmb as fm
from tests.oracle.table import LAWS, SITUATIONS, case

from .differences import said, shares_off, worst

#: Brings compiled code, and is refused.
_LEFT_OUT = {"Contensou"}
#: Of many elements, whose kinks cost a step each.
_COSTLY = {"ElastoPlastic", "GeneralisedMaxwellSlip", "Iwan", "Leuven"}
_NOT_IN_JOINTS = {*_COSTLY, "Offset"}
_SITUATIONS = ("reversal", "stick-slip")
_RTOL = 1e-8


def _of(name: str, situation: str):
    """A scene, and names of numbers of the law and the load that it can be differentiated by."""
    scene = case(name, situation).scene
    own = [p for p in scene.parameters if p.startswith("sole.law") and np.ndim(scene.parameters[p]) == 0]
    return scene, ("sole.normal_force", *[p for p in own if scene.parameters[p] != 0.0][:1])


@pytest.mark.parametrize("situation", _SITUATIONS)
@pytest.mark.parametrize("name", sorted(LAWS.keys() - _LEFT_OUT))
def test_law(name, situation):
    """To a thousand tolerances of the largest derivative, or a note says to how much."""
    scene, names = _of(name, situation)
    given = {"t_end": SITUATIONS[situation].t_end, "method": "auto"}
    sol = fm.simulate(scene, rtol=_RTOL, sensitivities=names, **given)
    off = shares_off(sol, names, enough=1e3 * _RTOL, **given)
    assert off
    assert max(off.values()) < max(said(sol), default=1e3 * _RTOL), (off, sol.stats.notes)


@pytest.mark.parametrize("name", sorted(name for name in LAWS.keys() - _NOT_IN_JOINTS if 1 in LAWS[name].dimensions))
def test_law_in_a_joint(name):
    """Of a dry pin, whose load is its reaction, by a number of the law."""
    scene = fm.models.dry_pendulum(law=LAWS[name], radius=0.2)
    own = [p for p in scene.parameters if p.startswith("pin.friction") and np.ndim(scene.parameters[p]) == 0]
    names = own[:1] or ("arm.inertia",)
    sol = fm.simulate(scene, t_end=2.0, rtol=_RTOL, sensitivities=names)
    # a table has no numbers of its own, and where its knots are passed differences need two steps to tell
    off = shares_off(sol, names, t_end=2.0, steps=(5e-4,) if own else (2e-3, 2e-4))
    assert off
    assert max(off.values()) < max(said(sol), default=1e3 * _RTOL), (off, sol.stats.notes)


def test_offset_under_a_normal_force_that_varies():
    """Slip forward is slowed by ``(mu + offset) N(t)``; with reversals the derivative is that of differences."""
    body, N = fm.Body("b", mass=2.0, velocity={"x": 5.0}), 10.0 * (1 + 0.3 * fm.t)
    law = fm.laws.Offset(law=fm.laws.Coulomb(mu_s=0.4, mu_k=0.3), offset=0.2)
    contact = fm.Contact("c", body, law=law, normal_force=N, axes="x")
    sol = fm.simulate(fm.Scene("forward", [body, contact]), t_end=1.0, rtol=1e-9, sensitivities=("c.law.offset",))
    assert sol.sensitivity("b.x.velocity", "c.law.offset")[-1] == pytest.approx(-10.0 * 1.15 / 2.0, rel=1e-9)
    assert sol.sensitivity("b.x", "c.law.offset")[-1] == pytest.approx(-10.0 * (0.5 + 0.05) / 2.0, rel=1e-9)
    pull = fm.Force("f", body, axis="x", value=16.0 * sympy.sin(3.0 * fm.t))
    scene = fm.Scene("back", [body, contact, fm.Spring("k", body, axis="x", stiffness=20.0), pull])
    errors = worst(scene, ("c.law.offset",), rtol=1e-8, t_end=3.0)
    assert max(errors.values()) < 100.0, errors
    plane = fm.Body("b", mass=2.0, axes="xy", velocity={"x": 1.0, "y": 0.5})
    offset = fm.parameter("along", 0.1), fm.parameter("across", -0.05)
    both = fm.laws.Offset(law=fm.laws.Coulomb(mu_s=0.3), offset=offset)
    scene = fm.Scene("plane", [plane, fm.Contact("c", plane, law=both, normal_force=N, axes="xy")])
    errors = worst(scene, ("along", "across"), rtol=1e-8, t_end=0.2, events=False)
    assert len(errors) == 2
    assert max(errors.values()) < 100.0, errors
