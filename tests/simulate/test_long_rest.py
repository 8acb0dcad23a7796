"""Rest under a load that swings below the cone costs next to nothing, and the first excursion over it is located."""

import numpy as np
import pytest
import sympy
from scipy.optimize import brentq

import fricmb as fm

T = fm.t
LAWS = {
    "Coulomb": fm.laws.Coulomb(mu_s=1.0, mu_k=0.8), "Stribeck": fm.laws.Stribeck(mu_s=1.0, mu_k=0.8, v_s=0.1),
}  # fmt: skip
#: A million periods.
LONG = 1e6 * 2.0 * np.pi / 20.0


def block(load, law="Coulomb", normal_force=1.0, stiffness=0.0):
    body = fm.Body("b", mass=1.0, position={"x": 0.1})
    hold = [fm.Spring("k", body, axis="x", stiffness=stiffness)] if stiffness else []
    sole = fm.Contact("sole", body, law=LAWS[law], normal_force=normal_force)
    return fm.Scene("rest", [body, *hold, fm.Force("load", body, axis="x", value=load), sole])


@pytest.mark.parametrize("law", LAWS)
def test_a_million_periods_below_the_limit(law):
    sol = fm.simulate(block(0.6 + 0.3 * sympy.sin(20 * T), law), t_end=LONG, method="taylor")
    assert not list(sol.events)
    assert sol.stats.n_steps < 100
    t = np.sort(np.random.default_rng(0).uniform(0.0, LONG, 300))
    assert sol.at(t).force("sole")[0] == pytest.approx(-(0.6 + 0.3 * np.sin(20 * t)), abs=1e-8)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("stiffness", [0.0, 1.0])
def test_the_first_excursion_behind_them(law, stiffness):
    """The crests begin to grow after nearly a million periods."""
    own = 0.1 * stiffness
    load = lambda t: 0.6 + 0.3 * np.sin(20 * t) + 0.11 * np.exp(-(((t - LONG) / 100) ** 2))  # noqa: E731
    formula = 0.6 + own + 0.3 * sympy.sin(20 * T) + 0.11 * sympy.exp(-(((T - LONG) / 100) ** 2))
    sol = fm.simulate(block(formula, law, stiffness=stiffness), t_end=LONG, method="taylor")
    crest = (np.arange(999_000, 1_000_000) + 0.25) * 2.0 * np.pi / 20.0
    first = crest[np.argmax(load(crest) > 1.0)]
    exact = brentq(lambda t: load(t) - 1.0, first - 0.07, first, xtol=1e-9)
    assert sol.events[0].kind == "slip"
    assert sol.events[0].t == pytest.approx(exact, abs=1e-5)
    assert sol.stats.n_steps < 20_000


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("rtol", [1e-4, 1e-8])
def test_steps_over_rest_change_nothing(law, rtol):
    """The same by radau, which goes through every period."""
    scene = block(0.6 + 0.3 * sympy.sin(20 * T) + 0.002 * T, law)
    sol, ref = (fm.simulate(scene, t_end=60.0, rtol=rtol, method=method) for method in ("taylor", "radau"))
    assert [e.kind for e in sol.events] == [e.kind for e in ref.events]
    t = np.linspace(0.0, 60.0, 997)
    assert np.abs(sol(t) - ref(t)).max() < 100 * rtol
    still = t[t < 50.0]
    assert sol.at(still).force("sole") == pytest.approx(ref.at(still).force("sole"), abs=rtol)
    assert sol.stats.n_steps < ref.stats.n_steps / 4
    assert sol.audit().ok
    asked = fm.simulate(scene, t_end=60.0, rtol=rtol, method="taylor", t_eval=t)
    assert np.abs(asked.q - sol(t)[:1]).max() < 10 * rtol
    assert np.abs(asked.force("sole") - sol.at(t).force("sole")).max() < 1e-6


def test_two_blocks_and_a_pulse_in_the_rest():
    a, b = (fm.Body(name, mass=1.0) for name in "ab")
    pulse = 0.3 * sympy.sin(20 * T) + 5 * sympy.exp(-(((T - 70_000) / sympy.Rational(1, 100)) ** 2))
    scene = fm.Scene("two", [
        a, b, fm.Spring("k", a, b, axis="x", stiffness=1.0), fm.Force("f", a, axis="x", value=0.5 * sympy.sin(31 * T)),
        fm.Force("g", b, axis="x", value=pulse),
        *(fm.Contact(f"c{body.name}", body, law=LAWS["Coulomb"], normal_force=1.0) for body in (a, b)),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=100_000.0, rtol=1e-6, method="taylor")
    assert sol.stats.n_steps < 10_000  # 1.5e6 where every period is gone through
    assert sol.events[0].contact == "cb"
    load = lambda t: 0.3 * np.sin(20 * t) + 5 * np.exp(-(((t - 70_000) / 0.01) ** 2)) - 1.0  # noqa: E731
    assert sol.events[0].t == pytest.approx(brentq(load, 69_999.97, 70_000.0), abs=1e-7)
    assert sol.audit().ok
