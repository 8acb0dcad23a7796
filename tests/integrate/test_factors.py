"""Factors serve steps almost as long without joints or a series, and no others: counted, and against finer runs."""

import numpy as np
import pytest

import fricmb as fm
from tests.integrate.test_many_rows import LIFTS, Condensed, bar, pad

COULOMB = fm.laws.Coulomb(mu_s=1.2, mu_k=0.8)


@pytest.mark.parametrize(
    ("scene", "t_end", "most"),
    [
        # without 2.1, with 1.7
        pytest.param(bar(10, COULOMB), 1.0, 1.9, id="bar"),
    ],
)
@pytest.mark.parametrize("rtol", [1e-4, 1e-6])
def test_factors_serve_while_a_transition_is_located(scene, t_end, most, rtol):
    stats = fm.simulate(scene, t_end=t_end, rtol=rtol, method="radau").stats
    assert 0 < stats.n_lu < most * (stats.n_steps + stats.n_rejected)


@pytest.mark.parametrize("rtol", [1e-4, 1e-5, 1e-6])
def test_what_they_leave_is_below_the_tolerance(rtol):
    scene, t = pad(11, 30, normal=LIFTS, axes="x"), np.linspace(0.0, 2e-3, 51)
    true = fm.simulate(scene, t_end=2e-3, t_eval=t, rtol=1e-11, method=Condensed())
    found = fm.simulate(scene, t_end=2e-3, t_eval=t, rtol=rtol, method="radau")
    assert len(true.events) > 3
    assert [(e.contact, e.kind) for e in found.events] == [(e.contact, e.kind) for e in true.events]
    for a, b in ((found.q, true.q), (found.v, true.v)):
        assert (np.abs(a - b).max(axis=1) < 0.2 * rtol * np.abs(b).max(axis=1)).all()
