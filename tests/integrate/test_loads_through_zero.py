"""Loads that pass 0: between steps friction opposes slip, also in the step that the opening has cut short."""

import numpy as np
import pytest
import sympy

import fricmb as fm


def two_blocks(law):
    """Two blocks whose loads come and go."""
    one, other = fm.Body("one", mass=2.0), fm.Body("other", mass=1.0, position={"x": 0.3})
    parts = [
        fm.Spring("k", one, axis="x", stiffness=40.0),
        fm.Spring("between", one, other, axis="x", stiffness=30.0),
        fm.Force("f", one, axis="x", value=5 * sympy.sin(2 * fm.t)),
        fm.Contact("first", one, law=law, normal_force=10 * sympy.sin(3 * fm.t), axes="x"),
        fm.Contact("second", other, law=law, normal_force=4 * sympy.cos(2 * fm.t), axes="x"),
    ]
    return fm.Scene("two", [one, other, *parts])


@pytest.mark.parametrize("law", [fm.laws.Coulomb(mu_s=0.5, mu_k=0.3), fm.laws.Stribeck(mu_s=0.5, mu_k=0.3, v_s=0.05)])
@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize("rtol", [1e-2, 1e-5, 1e-8])
def test_friction_never_drives_between_steps(law, method, rtol):
    sol = fm.simulate(two_blocks(law), t_end=8.0, rtol=rtol, method=method).at(np.linspace(0.0, 8.0, 4001))
    for name in ("first", "second"):
        power = sol.force(name) * sol.relative_velocity(name)
        assert power.max() < 0.01 * rtol * -power.min()


@pytest.mark.parametrize("rtol", [1e-2, 1e-3, 1e-4, 1e-5])
def test_a_load_that_passes_zero_is_no_negative_coefficient(rtol):
    """The run ended with that error where ``t_eval`` fell into the last step before an opening."""
    block = fm.Body("m", mass=2.0)
    parts = [
        fm.Spring("k", block, axis="x", stiffness=40.0),
        fm.Damper("c", block, axis="x", damping=0.1),
        fm.Force("f", block, axis="x", value=5 * sympy.sin(2 * fm.t)),
        fm.Contact(
            "pad", block, law=fm.laws.Stribeck(mu_s=0.5, mu_k=0.3, v_s=0.05, viscous=0.01),
            normal_force=10 * sympy.sin(3 * fm.t), axes="x",
        ),
    ]  # fmt: skip
    grid = np.linspace(0.0, 8.0, 161)
    sol = fm.simulate(fm.Scene("one", [block, *parts]), t_end=8.0, rtol=rtol, method="radau", t_eval=grid)
    assert [e.kind for e in sol.events].count("open") == 4
