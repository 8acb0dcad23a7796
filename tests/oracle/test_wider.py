"""Kinds of scenes that the oracle decides by itself: closed forms of each, and one scene of each by every method."""

import numpy as np
import pytest

from tests.oracle.campaign import make
from tests.oracle.judge import judge, truth
from tests.oracle.problem import Contact, Problem
from tests.oracle.random_scenes import generate
from tests.oracle.references import constant
from tests.oracle.run import solve
from tests.oracle.shrink import BAD

ONE = np.ones((1, 1))


def row(n, *contacts, load, v=None, K=0.0, t_end=4.0):
    """Unit masses under a load."""
    zero = np.zeros((n, n))
    return Problem(
        M=np.eye(n), K=zero + K, C=zero, q=np.zeros(n), v=np.zeros(n) if v is None else np.array(v), load=load,
        contacts=contacts, t_end=t_end,
    )  # fmt: skip


def touch(name, W, mu_s, mu_k):
    """Under a unit load."""
    return Contact(name=name, W=np.array(W, dtype=float), N=constant(1.0), mu=constant(mu_k), mu_s=constant(mu_s))


@pytest.mark.parametrize("mu_s", [0.5, 0.8])
def test_blocks_let_go_at_one_instant(mu_s):
    """Three alike under ``0.4 t``, tied by springs that do not stretch: each as if alone, all at t = mu_s/0.4."""
    K = 3.0 * np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    contacts = (touch(f"c{i}", np.eye(3)[:, [i]], mu_s, 0.5) for i in range(3))
    found = solve(row(3, *contacts, load=lambda t: np.full(3, 0.4 * t), K=K))
    start = mu_s / 0.4
    assert [(e.kind, e.contact) for e in found.events] == [("slip", f"c{i}") for i in range(3)]
    assert [e.t for e in found.events] == pytest.approx([start] * 3, abs=1e-10)
    expected = 0.2 * (16.0 - start**2) - 0.5 * (4.0 - start)
    np.testing.assert_allclose(found(np.array([4.0]))[3:, 0], expected, atol=1e-9)


def test_contact_without_friction_turns_round_and_never_sticks():
    """It goes as its load says from the first instant on: ``v = 1/2 - cos t`` from v = -1/2."""
    found = solve(row(1, touch("c", ONE, 0.0, 0.0), load=lambda t: np.array([np.sin(t)]), v=[-0.5]))
    assert [e.kind for e in found.events] == ["reversal"]
    assert found.events[0].t == pytest.approx(np.pi / 3, abs=1e-10)
    resting = solve(row(1, touch("c", ONE, 0.0, 0.0), load=lambda t: np.array([-np.sin(t)])))
    assert resting(np.array([2.0]))[1, 0] == pytest.approx(np.cos(2.0) - 1.0, abs=1e-10)


def test_several_contacts_of_one_body_hold_as_long_as_all_of_them_do():
    """``0.5 t`` against 0.6 and 0.9 at rest and 0.4 and 0.5 in slip: both go at t = 3."""
    contacts = touch("a", ONE, 0.6, 0.4), touch("b", ONE, 0.9, 0.5)
    found = solve(row(1, *contacts, load=lambda t: np.array([0.5 * t])))
    assert sorted(e.contact for e in found.events if e.kind == "slip") == ["a", "b"]
    assert [e.t for e in found.events] == pytest.approx([3.0, 3.0], abs=1e-9)
    assert found(np.array([4.0]))[1, 0] == pytest.approx(0.25 * (16.0 - 9.0) - 0.9, abs=1e-9)


def test_a_box_on_two_feet_holds_what_both_hold():
    """A pull of 0.1 t at the height of the centre of mass: 1.0 t of the weight 1 hold until t = 10, then 0.5 of it."""
    numbers = {
        "mass": 1.0, "g": 1.0, "a": [0.5, 0.5], "mu": [(1.0, 0.5), (1.0, 0.5)], "height": 0.2, "t_end": 12.0,
        "k": 0.0, "ramp": 0.1, "wave": [0.0, 0.0, 1.0, 0.0], "v": 0.0,
    }  # fmt: skip
    from tests.oracle.feet import box_case

    found = solve(box_case({**numbers, "k": 1e-12}).problem)
    assert [e.t for e in found.events] == pytest.approx([10.0, 10.0], abs=1e-8)
    assert found(np.array([12.0]))[0, 0] == pytest.approx(8.0 / 60.0 + 1.0, abs=1e-8)


#: Kinds with the seed of one scene for each way that they are made.
SEEDS = {
    "feet": (0, 1, 2), "driven": (0, 1, 2), "drives": (0, 1, 2, 720012, 720018), "together": (0, 3), "bare": (1, 2),
    "elsewhere": (0, 1), "units": (0, 1), "beside": (0, 1), "excursions": (700001,), "machines": (0, 3, 730001),
}  # fmt: skip


@pytest.mark.parametrize(("kind", "seed"), [(kind, seed) for kind, seeds in SEEDS.items() for seed in seeds])
def test_scene_moves_as_the_oracle_says(kind, seed):
    true = truth(make({}, generate(kind, seed)))
    assert not true.marginal
    verdicts = {method: judge(true, method) for method in ("auto", "bdf", "radau")}
    assert verdicts["auto"].kind == "right"
    assert {method: verdict for method, verdict in verdicts.items() if verdict.kind in BAD} == {}
