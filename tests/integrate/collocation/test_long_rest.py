"""Rest beside free vibration: it lasts for ever where the vibration never reaches the cone, and costs nothing."""

import time

import numpy as np
import pytest

import fricmb as fm


def held(swing, *, damping=0.0, load=0.0):
    """A block that rests under dry friction of 1, tied by a spring of 1 to a mass of 1 that swings by ``swing``."""
    block, mass = fm.Body("block", mass=1.0), fm.Body("mass", mass=1.0, velocity={"x": swing})
    parts = [block, mass, fm.Spring("k", block, mass, axis="x", stiffness=1.0)]
    parts += [fm.Damper("d", mass, axis="x", damping=damping)] if damping else []
    parts += [fm.Force("F", block, axis="x", value=load)] if load else []
    return fm.Scene("held", [*parts, fm.Contact("c", block, law=fm.laws.Coulomb(mu_s=1.0), normal_force=1.0)])


@pytest.mark.parametrize(("swing", "damping", "load"), [(0.999, 0.0, 0.0), (0.4, 0.0, 0.59), (0.999, 1e-9, 0.0)])
def test_what_cannot_let_go_is_seen_at_once(swing, damping, load):
    """1e9 s of free vibration, which was looked at period by period: 160 million of them."""
    fm.simulate(held(0.1), t_end=10.0, method="collocation")
    begin = time.process_time()
    sol = fm.simulate(held(swing, damping=damping, load=load), t_end=1e9, method="collocation", time_limit=60)
    assert time.process_time() - begin < 10.0
    assert len(sol.events) == 0
    np.testing.assert_allclose(sol.at(10.0)["mass.x"], swing * np.sin(10.0), atol=1e-7)


@pytest.mark.parametrize(("swing", "load"), [(1.001, 0.0), (0.42, 0.59), (0.4, 0.61)])
def test_what_does_let_go_is_found(swing, load):
    """Where swing sin t + load = 1."""
    sol = fm.simulate(held(swing, load=load), t_end=20.0, method="collocation")
    np.testing.assert_allclose(sol.events[0].t, np.arcsin((1.0 - load) / swing), rtol=1e-12)


def test_a_brake_at_rest_costs_nothing():
    short = fm.simulate(fm.models.brake4dof("2"), t_end=1e4)
    long = fm.simulate(fm.models.brake4dof("2"), t_end=1e9, time_limit=30)
    np.testing.assert_array_equal(long.events.t, short.events.t)
