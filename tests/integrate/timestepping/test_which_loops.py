"""Which contacts are in loops: rows of W that depend on one another, and how many of each loop do not."""

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate.timestepping.loops import _left, loops_of
from fricmb.system import build

LAW = fm.laws.Coulomb(mu_s=0.4, mu_k=0.3)


def rubs(name, a, b=None):
    ends = (a,) if b is None else (a, b)
    return fm.Contact(name, *ends, law=LAW, normal_force=1.0)


def test_blocks_on_the_ground_and_on_one_another():
    """Three contacts of two blocks are a loop of rank 2; a third block rubs apart from them, a fourth twice."""
    one, two, three, four = (fm.Body(name, mass=1.0) for name in ("one", "two", "three", "four"))
    scene = fm.Scene("loops", [
        one, two, three, four, rubs("a", one), rubs("b", two), rubs("between", one, two), rubs("alone", three),
        rubs("left", four), rubs("right", four),
    ])  # fmt: skip
    loop, rank = loops_of(build(scene).problem)
    assert loop[[0, 1, 2]].tolist() == [loop[0]] * 3
    assert loop[3] == -1
    assert loop[4] == loop[5] != loop[0]
    assert rank[[loop[0], loop[4]]].tolist() == [2, 1]


def test_a_chain_has_none():
    loop, rank = loops_of(build(fm.models.stick_slip_chain(20)).problem)
    assert (loop == -1).all()
    assert rank.size == 0


@pytest.mark.parametrize(("m", "n", "r"), [(3, 5, 2), (6, 3, 3), (12, 5000, 9), (1, 7, 1)])
def test_vectors_behind_the_rank_are_all_dependences(m, n, r):
    rng = np.random.default_rng(m)
    W = rng.normal(size=(m, r)) @ rng.normal(size=(r, n))
    U, rank = _left(W)
    assert rank == min(m, n, r)
    np.testing.assert_allclose(U.T @ U, np.eye(m), atol=1e-12)
    np.testing.assert_allclose(U[:, rank:].T @ (W / np.linalg.norm(W, axis=1, keepdims=True)), 0.0, atol=1e-10)
