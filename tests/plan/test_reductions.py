"""What a plan leaves out, orders and stores in another way changes no result.

Islands, inert parts and observed names: tests/simulate/test_islands.py; bands: tests/integrate/test_band.py; truncated
modes: test_truncate.py.
"""

import numpy as np
import pytest

import fricmb as fm
from fricmb.system import _structure

END = 13.5
GRID = np.linspace(0.0, END, 28)


def run(scene, method):
    return fm.simulate(scene, t_end=END, rtol=1e-9, t_eval=GRID, method=method)


@pytest.mark.parametrize("method", ["taylor", "bdf"])
def test_terms_that_vanish(method):
    """Dampers of 0, and springs whose cubic term is 0, are as if they were not there."""
    whole = fm.models.stick_slip_chain(12)
    bare = fm.Scene("bare", [part for part in whole.parts if not isinstance(part, fm.Damper)])
    assert len(whole.plan().left_out[0].names) == 12
    found, expected = run(whole, method), run(bare, method)
    np.testing.assert_array_equal(found.q, expected.q)
    assert len(found.events) == len(expected.events) > 10


@pytest.mark.parametrize("method", ["taylor", "bdf"])
def test_order_of_declaration(method):
    """A chain declared in a wild order is found to be one, and moves as one."""
    chain = fm.models.stick_slip_chain(20)
    order = np.random.default_rng(3).permutation(len(chain.parts))
    wild = fm.Scene("wild", [chain.parts[i] for i in order])
    assert wild.plan().bandwidth == chain.plan().bandwidth == 1
    found, expected = (fm.simulate(scene, t_end=END, rtol=1e-9, t_eval=GRID, method=method) for scene in (wild, chain))
    scale = np.abs(expected.q).max()
    for name in chain.dof_names:
        np.testing.assert_allclose(found[name], expected[name], rtol=0, atol=1e-8 * scale)
    assert len(found.events) == len(expected.events) > 10


@pytest.mark.parametrize("method", ["taylor", "radau"])
def test_sparse_and_dense_matrices(method, monkeypatch):
    sparse = run_short(method)
    monkeypatch.setattr(_structure, "DENSE", 10**9)
    dense = run_short(method)
    np.testing.assert_allclose(sparse.q, dense.q, rtol=0, atol=1e-12 * np.abs(dense.q).max())
    assert len(sparse.events) == len(dense.events) >= 300


def run_short(method):
    scene = fm.models.stick_slip_chain(300)
    return fm.simulate(scene, t_end=END, rtol=1e-4, t_eval=GRID, method=method)
