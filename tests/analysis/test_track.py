"""Modes followed from value to value: which goes on which, and with how many threads."""

from itertools import permutations

import numpy as np
import pytest

import fricmb as fm
from fricmb.analysis import _track


def cheapest(known, new):
    """The least sum over all orders, tried one by one."""
    similar = np.abs(known[1].conj() @ new[1].T) ** 2
    scale = np.abs(known[0]).max()
    cost = 1.0 - similar + 4.0 * np.abs(known[0][:, None] - new[0]) / scale
    n = len(cost)
    return min(permutations(range(n)), key=lambda order: sum(cost[i, order[i]] for i in range(n)))


def pairs_of(rng, n, spread):
    values = spread * (rng.normal(size=n) + 1j * rng.normal(size=n)) + 1.0
    vectors = rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n))
    return values, vectors / np.linalg.norm(vectors, axis=1)[:, None]


@pytest.mark.parametrize("spread", [1e-3, 0.3, 3.0])
def test_all_orders_together_are_the_cheapest(spread):
    rng = np.random.default_rng(5)
    contested = 0
    for _ in range(40):
        known, new = pairs_of(rng, 6, spread), pairs_of(rng, 6, spread)
        order, _ = _track.match(known, new)
        np.testing.assert_array_equal(order, cheapest(known, new))
        near = np.abs(known[1].conj() @ new[1].T) ** 2
        contested += np.unique(near.argmax(axis=1)).size < 6
    assert contested > 10  # two that want the same one happen, too


def test_a_change_of_places_is_followed():
    known = pairs_of(np.random.default_rng(1), 6, 0.1)
    order = np.array([3, 0, 5, 1, 4, 2])
    found, least = _track.match(known, (known[0][order] * 1.001, known[1][order]))
    np.testing.assert_array_equal(order[found], np.arange(6))
    assert least == pytest.approx(1.0)


def chain(n):
    """Blocks on springs, rubbed by a belt."""
    mu = fm.parameter("mu", 0.3)
    belt = fm.Driven("belt", velocity={"x": 1.0})
    blocks = [fm.Body(f"b{i}", mass=1.0 + 0.1 * i) for i in range(n)]
    parts = [belt, *blocks]
    for i, block in enumerate(blocks):
        parts.append(fm.Spring(f"s{i}", block, blocks[i - 1] if i else fm.GROUND, axis="x", stiffness=100.0 + i))
        law = fm.laws.Stribeck(mu_s=2.0 * mu, mu_k=mu, v_s=0.5)
        parts.append(fm.Contact(f"c{i}", block, belt, law=law, normal_force=1.0))
    return fm.Scene("chain", parts, units=fm.Units("s", "m", "N"))


def threads():
    from threadpoolctl import threadpool_info

    return [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]


@pytest.mark.parametrize("what", ["eigenvalues", "map"])
def test_a_study_keeps_to_one_thread_of_blas(what, monkeypatch):
    """Two threads that spin beside other processes took eight times as long on an industrial brake."""
    from fricmb.analysis import _steady

    before, seen = threads(), []
    solve = _steady._solve

    def watched(*given):
        seen.append(threads())
        return solve(*given)

    monkeypatch.setattr(_steady, "_solve", watched)
    scene = chain(2)
    if what == "map":
        fm.analysis.stability_map(scene, over=("mu", "mu"), values=[[0.2], [0.3]])
    else:
        fm.analysis.complex_eigenvalues(scene, over="mu", values=[0.2, 0.3])
    assert seen
    assert all(set(counts) == {1} for counts in seen)
    assert threads() == before
