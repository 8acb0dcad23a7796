"""Derivatives against closed forms: periods of stick-slip, a multiplier, jumps at transitions."""

import numpy as np
import pytest
import sympy

import fricmb as fm

#: Period of a block on a belt (m = k = N = 1, c = 0, V = 0.1, mu_s = 1.5, mu_k = 1): closed form in 30 digits.
BELT = {
    "belt.velocity.x": -96.15384615384615384615,
    "rub.law.mu_s": 19.230769230769230769,
    "rub.law.mu_k": -19.230769230769230769,
    "mass.mass": 1.96049957895246969,
    "spring.stiffness": -11.5758841943370851,
    "rub.normal_force": 9.61538461538461538,
    "damper.damping": -9.8024978947626,
}
#: Leine's oscillator (F_s = 1, delta = 3, V = 0.2).
LEINE = {
    "belt.velocity.x": -30.300423494504402117,
    "spring.stiffness": -9.9589921160152764256,
    "damper.damping": -10.169833981690928169,
    "rub.law.mu_s": 7.9169529371999742043,
    "rub.law.delta": 0.6189560794330312603,
}
#: Den Hartog's oscillator with mu_s > mu_k: displacement in stick, multiplier, and derivatives of the former.
STUCK, MULTIPLIER = 1.059269513157373852607, 0.21431492140652878768
DEN_HARTOG = {
    "A": 1.1911976191746360413,
    "omega": 2.2221116384609168994,
    "rub.law.mu_k": -0.51626181222062918059,
    "rub.law.mu_s": 0.14915323774197896702,
}


def oscillator(law, V):
    belt, mass = fm.Driven("belt", velocity={"x": V}), fm.Body("mass", mass=1.0, velocity={"x": V})
    springs = [fm.Spring("spring", mass, axis="x", stiffness=1.0), fm.Damper("damper", mass, axis="x", damping=0.0)]
    return fm.Scene("oscillator", [mass, belt, *springs, fm.Contact("rub", mass, belt, law=law, normal_force=1.0)])


def period(scene, names, **options):
    sol = fm.simulate(scene, t_end=60.0, sensitivities=names, **options)
    second, third = [event for event in sol.events if event.kind == "slip"][1:3]
    return {name: third.sensitivity(name) - second.sensitivity(name) for name in names}


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
def test_period_of_a_block_on_a_belt(method):
    scene = oscillator(fm.laws.Coulomb(mu_s=1.5, mu_k=1.0), 0.1)
    found = period(scene, tuple(BELT), rtol=1e-10, method=method)
    assert found == pytest.approx(BELT, abs=1e-9)


@pytest.mark.parametrize(
    ("method", "rtol", "limit"), [("auto", 1e-10, 1e-9), ("radau", 1e-10, 1e-10), ("bdf", 1e-8, 1e-8)]
)
def test_period_of_leines_oscillator(method, rtol, limit):
    scene = oscillator(fm.laws.HyperbolicStribeck(mu_s=1.0, delta=3.0), 0.2)
    found = period(scene, tuple(LEINE), rtol=rtol, method=method)
    assert found == pytest.approx(LEINE, rel=limit, abs=1e-9 if rtol < 1e-9 else 0.0)


def den_hartog(start):
    A, omega = fm.parameter("A", 1.0), fm.parameter("omega", 0.4)
    mass = fm.Body("mass", mass=1.0, position={"x": start})
    return fm.Scene("den Hartog", [
        mass, fm.Spring("spring", mass, axis="x", stiffness=1.0), fm.Damper("damper", mass, axis="x", damping=0.1),
        fm.Force("push", mass, axis="x", value=A * sympy.cos(omega * fm.t)),
        fm.Contact("rub", mass, law=fm.laws.Coulomb(mu_s=0.5, mu_k=0.4), normal_force=1.0),
    ])  # fmt: skip


def test_multiplier_of_den_hartogs_oscillator():
    period = 2.0 * np.pi / 0.4
    begin = fm.simulate(den_hartog(STUCK), t_end=1.0, rtol=1e-12)
    sol = fm.simulate(den_hartog(STUCK), initial=begin, t_end=1.0 + period, rtol=1e-12, sensitivities="state")
    values = np.sort(np.abs(np.linalg.eigvals(sol.monodromy)))
    assert values == pytest.approx([0.0, MULTIPLIER], abs=1e-9)
