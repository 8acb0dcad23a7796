"""Laws with internal states through reversals of the velocity, against scipy on the law's own stated equations."""

from functools import lru_cache

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb import laws

T_END = 6.0
GRID = np.linspace(0.0, T_END, 241)
LAWS = {
    "soft Dahl": laws.Dahl(sigma0=200.0, mu=0.5),
    "LuGre, its velocity not in its force": laws.LuGre(
        sigma0=200.0, sigma1=0.0, sigma2=0.1, mu_s=0.6, mu_k=0.4, v_s=0.1
    ),
} | {name: law for name in laws.names if (law := getattr(laws, name).example()).states and 1 in law.dimensions}


def oscillator(law):
    """Swings to and fro by some 0.4: three reversals in the run."""
    body = fm.Body("m", mass=1.0)
    return fm.Scene(
        "oscillator",
        [body, fm.Spring("k", body, axis="x", stiffness=4.0),
         fm.Force("f", body, axis="x", value=1.5 * sympy.sin(1.3 * fm.t)),
         fm.Contact("c", body, law=law, normal_force=1.0)],
    )  # fmt: skip


@lru_cache
def by_scipy(name):
    """Positions from the law's define_force and define_rate alone."""
    law = LAWS[name]
    v, N = sympy.symbols("v N", real=True)
    z = sympy.symbols(f"z:{law.n_states(1)}", real=True)
    sums = (law.define_force((v,), N, z)[0], *law.define_rate((v,), N, z))
    numeric = sympy.lambdify((v, N, z), sums, modules=["numpy", "scipy"])
    begin = fm.simulate(oscillator(law), t_end=1e-9).state("c")[:, 0]

    def rates(t, y):
        force, *others = numeric(y[1], 1.0, y[2:])
        return [y[1], 1.5 * np.sin(1.3 * t) - 4.0 * y[0] + force, *others]

    found = solve_ivp(
        rates, (0.0, T_END), [0.0, 0.0, *begin], method="LSODA", rtol=1e-11, atol=1e-13, t_eval=GRID, max_step=0.02
    )
    assert found.success
    return found.y[0]


@pytest.mark.parametrize("method", ["radau"])
@pytest.mark.parametrize("name", LAWS)
def test_law_with_states_follows_a_reversal(name, method):
    """A state at its limit does not follow the first Newton correction: forces that stand still prove nothing."""
    expected = by_scipy(name)
    sol = fm.simulate(oscillator(LAWS[name]), t_end=T_END, rtol=1e-6, t_eval=GRID, method=method)
    assert np.abs(sol.q[0] - expected).max() < 2e-5 * np.abs(expected).max()


@pytest.mark.parametrize("name", ["Karnopp", "Gonthier"])
@pytest.mark.parametrize("rtol", [1e-9, 1e-10])
def test_a_state_that_makes_no_force_for_a_while_is_known_when_it_does_again(name, rtol):
    """Outside its band Karnopp's hold is not felt, nor is Gonthier's bristle in fast slip: what is left of it is."""
    expected = by_scipy(name)
    sol = fm.simulate(oscillator(LAWS[name]), t_end=T_END, rtol=rtol, t_eval=GRID, method="radau")
    assert np.abs(sol.q[0] - expected).max() < 2e-9 * np.abs(expected).max()
    assert sol.stats.n_steps + sol.stats.n_rejected < 800
