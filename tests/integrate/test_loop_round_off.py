"""Loops of contacts at rest in steps that Newton's method solves: shares of a load move on by their round-off."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm

MASS, K, MU_S, MU, END = 1.8, 3.5, 0.9, 0.6, 7.0
#: What makes a step one of several iterations: cubic stiffness and swing of a normal force, stiffness of a tie at rest.
ITERATES = {"cubic": (0.05, 0.0, 0.0), "load": (0.0, 0.3, 0.0), "tie": (0.0, 0.0, 1e8), "all": (0.05, 0.3, 1e8)}


def pull(t, sin=np.sin):
    return -0.25 + 1.3 * sin(3.0 * t + 1.0)


def load(t, swing, sin=np.sin):
    return 2.3 * (1.0 + swing * sin(t))


def three_blocks(cubic, swing, tie):
    """Two blocks that never move, tied and rubbing on one another, one leaning on a spring; a third comes to rest."""
    a, b = fm.Body("a", mass=1.5), fm.Body("b", mass=0.5, position={"x": 0.4})
    c = fm.Body("c", mass=MASS, position={"x": 0.9}, velocity={"x": -0.1})
    law = fm.laws.Coulomb(mu_s=MU_S, mu_k=MU)
    sole = load(fm.t, swing, sympy.sin) if swing else load(0.0, 0.0)
    return fm.Scene("three", [
        a, b, c, fm.Spring("tie", a, b, axis="x", stiffness=tie, length=-0.4),
        fm.Spring("lean", a, axis="x", stiffness=0.5, length=-0.7),
        fm.Spring("spring", c, axis="x", stiffness=K, cubic=cubic),
        fm.Force("pull", c, axis="x", value=pull(fm.t, sympy.sin)),
        fm.Contact("sole a", a, law=law, normal_force=1.4), fm.Contact("sole b", b, law=law, normal_force=0.8),
        fm.Contact("a on b", b, a, law=law, normal_force=1.2),
        fm.Contact("sole c", c, law=law, normal_force=sole), fm.Contact("c on b", c, b, law=law, normal_force=1.0),
    ])  # fmt: skip


def slide(cubic, swing):
    """The third block alone, which slides back until it rests: when, and where."""

    def rates(t, y):
        return [y[1], (pull(t) - K * y[0] - cubic * y[0] ** 3 + MU * (load(t, swing) + 1.0)) / MASS]

    def rests(t, y):
        return y[1]

    rests.terminal, rests.direction = True, 1.0
    found = solve_ivp(rates, (0.0, END), [0.9, -0.1], method="DOP853", rtol=1e-13, atol=1e-14, events=rests)
    return found.t[-1], found.y[0, -1]


@pytest.mark.parametrize("rtol", [1e-8, 1e-10, 1e-12])
@pytest.mark.parametrize("iterates", ITERATES)
@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_steps_do_not_wait_for_the_last_digit_of_a_share(method, iterates, rtol):
    """Blocks that never move have no speed of their own: they were to rest to less than forces can be added to."""
    cubic, swing, tie = ITERATES[iterates]
    sol = fm.simulate(three_blocks(cubic, swing, tie), t_end=END, rtol=rtol, method=method, time_limit=20.0)
    at, place = slide(cubic, swing)
    assert sorted((e.contact, e.kind) for e in sol.events) == [("c on b", "stick"), ("sole c", "stick")]
    np.testing.assert_allclose(sol.events.t, at, atol=10 * rtol + 1e-12)
    np.testing.assert_allclose(sol["c.x"][-1], place, atol=10 * rtol + 1e-12)
    np.testing.assert_allclose(sol["a.x"], 0.0, atol=1e-15)
    np.testing.assert_allclose(sol["b.x"], 0.4, atol=1e-15)
    held = sol.force("sole c")[0, -1] + sol.force("c on b")[0, -1]
    np.testing.assert_allclose(held, K * place + cubic * place**3 - pull(END), atol=10 * rtol + 1e-12)
    # several hundred rejected steps, or no end, before
    assert sol.stats.n_rejected < 60
    assert sol.stats.n_steps < 600
