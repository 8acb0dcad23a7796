"""A law of a user's is run as a built-in one is."""

import numpy as np
import pytest

import fricmb as fm
from fricmb.bench._own_laws import FAMILIES, law_costs
from fricmb.testing import check_law


@pytest.mark.parametrize("family", FAMILIES)
def test_three_ways_to_state_a_law_take_the_same_steps(family):
    runs = [
        fm.simulate(fm.models.belt_oscillator(law=law), t_end=20.0, rtol=1e-6, method="bdf") for law in FAMILIES[family]
    ]
    for sol in runs[1:]:
        assert sol.stats.n_steps == runs[0].stats.n_steps
        np.testing.assert_allclose(sol.q[:, -1], runs[0].q[:, -1], rtol=1e-9)


@pytest.mark.parametrize("family", FAMILIES)
def test_own_laws_keep_the_rules(family):
    for law in FAMILIES[family]:
        check_law(law)


def test_costs_are_ratios():
    costs = law_costs(rounds=1)
    assert set(costs) == set(FAMILIES)
    assert all(value > 0.0 for row in costs.values() for value in row.values())
