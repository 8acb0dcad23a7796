"""Slip that begins where friction falls with speed from the first: an own program from the break-away on."""

import numpy as np
import pytest
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
