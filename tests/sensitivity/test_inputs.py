"""Derivatives by parameters inside inputs: frequency and size of a load, a normal force, a moved surface."""

import pytest
import sympy

import fricmb as fm

W, A = fm.parameter("w", 1.3), fm.parameter("A", 2.0)
WAVE = A * sympy.sin(W * fm.t)
LAW = fm.laws.Coulomb(mu_s=0.6, mu_k=0.5)


def load(body):
    return [fm.Contact("c", body, law=LAW, normal_force=1.0), fm.Force("f", body, axis="x", value=WAVE)]


def normal_force(body):
    pull = fm.Force("f", body, axis="x", value=A * sympy.cos(fm.t))
    return [fm.Contact("c", body, law=LAW, normal_force=1 + 0.3 * sympy.sin(W * fm.t)), pull]


def driven_velocity(body):
    belt = fm.Driven("belt", velocity={"x": WAVE})
    return [belt, fm.Contact("c", body, belt, law=LAW, normal_force=1.0)]


def driven_position(body):
    hand = fm.Driven("hand", position={"x": WAVE})
    return [hand, fm.Contact("c", body, law=LAW, normal_force=1.0), fm.Spring("h", body, hand, axis="x", stiffness=2.0)]


def slide(body):
    return [fm.Contact("c", body, law=LAW, normal_force=1.0, slide=WAVE)]


@pytest.mark.parametrize("make", [load, normal_force, driven_velocity, driven_position, slide])
def test_derivatives_by_what_is_inside_an_input(make):
    """Against differences of runs at 1e-12, through stick and slip."""
    body = fm.Body("b", mass=1.0)
    scene = fm.Scene("input", [body, fm.Spring("k", body, axis="x", stiffness=2.0), *make(body)])
    sol = fm.simulate(scene, t_end=10.0, rtol=1e-10, method="radau", sensitivities=("w", "A"))
    assert len(sol.events) > 3
    for name, value in (("w", 1.3), ("A", 2.0)):
        high, low = (
            fm.simulate(scene.with_parameters({name: value + d}), t_end=10.0, rtol=1e-12, method="radau")["b.x"][-1]
            for d in (1e-5, -1e-5)
        )
        assert sol.sensitivity("b.x", name)[-1] == pytest.approx((high - low) / 2e-5, rel=1e-6, abs=1e-7)
