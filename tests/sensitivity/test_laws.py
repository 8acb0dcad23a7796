"""Derivatives under every law of the catalogue, beside differences of runs."""

import numpy as np
import pytest

import fricmb as fm
from tests.oracle.table import LAWS, SITUATIONS, case

from .differences import derived, said, shares_off, surest

#: Brings compiled code, and is refused.
_LEFT_OUT = {"Contensou"}
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
    t_end = SITUATIONS[situation].t_end
    sol = fm.simulate(scene, t_end=t_end, rtol=_RTOL, sensitivities=names)
    off = shares_off(sol, names, t_end=t_end)
    assert off
    assert max(off.values()) < max(said(sol), default=1e3 * _RTOL), (off, sol.stats.notes)


@pytest.mark.parametrize("name", ["Ambrosio", "Dahl", "LinearRegularised", "RateAndState", "Tabulated", "Threlfall"])
def test_law_in_a_joint(name):
    """Of a dry pin, whose load is its reaction."""
    scene = fm.models.dry_pendulum(law=LAWS[name], radius=0.2)
    own = [p for p in scene.parameters if p.startswith("pin.friction") and np.ndim(scene.parameters[p]) == 0]
    names = ("arm.inertia", *own[:1])
    sol = fm.simulate(scene, t_end=3.0, rtol=_RTOL, sensitivities=names)
    for parameter in names:
        value, unsure = surest(scene, parameter, t_end=3.0)
        error = np.maximum(np.abs(derived(sol, parameter) - value) - 3.0 * unsure, 0.0).max()
        assert error < 1e3 * _RTOL * np.abs(value).max()
        assert unsure.max() < 1e-3 * np.abs(value).max()
