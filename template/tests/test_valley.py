"""The law against its own formula, the conformance kit, and in a run."""

import fricmb as fm
import numpy as np
import pytest
from fricmb.testing import check_law
from fricmb_law_template import Valley

LAW = Valley(mu_s=0.6, mu_min=0.4, v_min=0.1)


def test_numbers_of_the_formula():
    assert LAW.break_away() == 0.6
    np.testing.assert_allclose(LAW.coefficient([0.0, 0.1, 0.2]), [0.6, 0.4, 0.6 - 0.4 * np.exp(-1)], rtol=1e-14)
    assert LAW.derivative(0.1) == pytest.approx(0.0, abs=1e-14)  # the bottom of the valley


def test_keeps_the_rules_of_a_run():
    check_law(LAW)


def test_is_found_by_name():
    found, broken = fm.laws.published("fricmb.friction_laws")
    assert found["Valley"] is Valley
    assert "Valley" not in broken


def test_bad_values_are_refused_by_name():
    with pytest.raises(fm.LawError, match="mu_min"):
        Valley(mu_s=0.4, mu_min=0.6, v_min=0.1)


def test_sliding_is_steady_beyond_the_valley_alone():
    """On its rising branch friction damps: a block on a fast belt comes to rest, on a slow one it sticks and slips."""
    ends = {}
    for belt in (0.05, 0.3):
        scene = fm.models.belt_oscillator(law=LAW, belt=belt)
        ends[belt] = fm.simulate(scene, t_end=200.0, rtol=1e-6, t_eval=np.linspace(150.0, 200.0, 501))
    assert ends[0.05].time_share("sole", 0) > 0.1
    assert abs(ends[0.3].velocity("mass.x")).max() < 1e-3
