"""Slip that begins where friction falls with speed from the first: an own program from the break-away on."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm

LAWS = {
    "hyperbolic": (fm.laws.HyperbolicStribeck(mu_s=1.0, mu_k=0.2, delta=3.0), lambda r: 0.2 + 0.8 / (1 + 3 * r)),
    "stribeck": (fm.laws.Stribeck(mu_s=1.0, mu_k=0.2, v_s=0.3, exponent=1.0), lambda r: 0.2 + 0.8 * np.exp(-r / 0.3)),
    "steep": (fm.laws.Stribeck(mu_s=1.0, mu_k=0.2, v_s=0.02, exponent=1.0), lambda r: 0.2 + 0.8 * np.exp(-r / 0.02)),
}


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-9])
@pytest.mark.parametrize("name", LAWS)
def test_slip_from_rest_grows_as_the_law_says(name, rtol):
    """The load rises slowly: speed, acceleration and the scale of all speeds are 0 where slip begins."""
    law, mu = LAWS[name]
    N, t_end = 1.6, 5.0
    block = fm.Body("block", mass=1.0)
    scene = fm.Scene("pulled", [
        block,
        fm.Spring("spring", block, axis="x", stiffness=1.0),
        fm.Damper("damper", block, axis="x", damping=0.5),
        fm.Force("pull", block, axis="x", value=0.7 * fm.t),
        fm.Contact("sole", block, law=law, normal_force=N),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=t_end, rtol=rtol, method="taylor")
    release = N / 0.7
    assert sol.events[0].kind == "slip"
    assert sol.events[0].t == pytest.approx(release, rel=1e-12)

    def rate(t, y):
        return [y[1], 0.7 * t - y[0] - 0.5 * y[1] - N * mu(abs(y[1]))]

    true = solve_ivp(rate, (release, t_end), [0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-16, dense_output=True)
    end = sol.events[1].t if len(sol.events) > 1 else t_end
    t = np.linspace(release, end, 60)
    # a part of the steep law's growth is that of the release's round-off: from there on it is 40 times rtol
    np.testing.assert_allclose(sol(t), true.sol(t), rtol=0.0, atol=40.0 * max(rtol, 1e-10))
    assert np.abs(true.sol(t)[1]).max() > 0.1


ONSETS = {
    "equal": fm.laws.Coulomb(mu_s=0.5),
    "jump": fm.laws.Coulomb(mu_s=0.6, mu_k=0.4),
    "steep": fm.laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.05, exponent=1.0),
}


@pytest.mark.parametrize("after", [1e-7, 1e-5, 1e-3, 1e-2])
@pytest.mark.parametrize("name", ONSETS)
def test_blocks_that_break_away_one_shortly_after_another(name, after):
    """A step that ends at the next one's break-away leaves a slip speed in which the direction could turn at once."""
    parts, blocks = [], [fm.Body(f"b{i}", mass=1.0, axes="xy") for i in range(3)]
    for i, block in enumerate(blocks):
        t = fm.t - after * i
        loads = [0.3 * t * way(0.8 * t) for way in (sympy.cos, sympy.sin)]
        parts += [fm.Force(f"f{i}{a}", block, axis=a, value=F) for a, F in zip("xy", loads, strict=True)]
        parts += [fm.Spring(f"k{i}{a}", block, axis=a, stiffness=1.0) for a in "xy"]
        parts.append(fm.Contact(f"c{i}", block, law=ONSETS[name], normal_force=1.0))
    parts += [fm.Spring(f"t{i}{a}", blocks[i], blocks[i + 1], axis=a, stiffness=0.01) for i in range(2) for a in "xy"]
    scene, t = fm.Scene("onset", [*blocks, *parts]), np.linspace(0.0, 4.0, 101)
    true = fm.simulate(scene, t_end=4.0, rtol=1e-11, t_eval=t, method="radau")
    for rtol in (1e-4, 1e-6, 1e-9):
        sol = fm.simulate(scene, t_end=4.0, rtol=rtol, t_eval=t, method="taylor")
        assert [(event.contact, event.kind) for event in sol.events] == [(f"c{i}", "slip") for i in range(3)]
        np.testing.assert_allclose(np.diff(sol.events.t), after, rtol=1e-4, atol=0.01 * rtol)  # but for the ties
        assert sol.stats.n_steps < 100
        np.testing.assert_allclose(sol.v, true.v, atol=0.1 * rtol)
        np.testing.assert_allclose(sol.q, true.q, atol=0.1 * rtol)
        assert sol.audit().ok, sol.audit().table()
