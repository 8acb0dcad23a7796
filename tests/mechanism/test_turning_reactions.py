"""Pins whose reaction passes by near 0: the load, its length, has all but a kink there."""

from itertools import pairwise

import numpy as np
import pytest
import sympy as sp
from numpy.polynomial.legendre import leggauss

import fricmb as fm

PUSH, OMEGA, PHASE, MU, RADIUS, INERTIA, START, T_END = 10.0, 7.0, 0.1, 0.3, 0.05, 0.1, 50.0, 6.0


def rotor(aside):
    """A rotor on a dry pin that bears a force to and fro, and one ``aside``."""
    body = fm.RigidBody("rotor", mass=1.0, inertia=INERTIA, angular_velocity=START)
    return fm.Scene("rotor", [
        body, fm.Revolute("pin", body, radius=RADIUS, friction=fm.laws.Coulomb(mu_s=MU)),
        fm.Force("push", body, axis="x", value=PUSH * sp.sin(OMEGA * fm.t + PHASE)),
        fm.Force("aside", body, axis="y", value=aside),
    ])  # fmt: skip


def impulse(aside):
    """Integral of the load, by Gauss's rule on pieces that halve towards where the push passes through 0."""
    zeros = [z for z in (np.arange(1, 30) * np.pi - PHASE) / OMEGA if z < T_END]
    ends = [0.0, *zeros, T_END]
    node, weight = leggauss(20)
    total = 0.0
    for a, b in pairwise(ends):
        part = 0.5 ** np.arange(50, 0, -1)
        cuts = np.concatenate([[a], a + (b - a) * part, b - (b - a) * part[-2::-1], [b]])
        for low, high in pairwise(cuts):
            t = 0.5 * (high - low) * node + 0.5 * (high + low)
            total += 0.5 * (high - low) * float(weight @ np.hypot(PUSH * np.sin(OMEGA * t + PHASE), aside))
    return total


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("aside", [0.0, 1e-6, 1e-3, 1e-2, 0.1])
def test_a_rotor_loses_what_its_load_takes_however_the_reaction_turns(method, aside):
    """Errors were up to 1e5 times the tolerance: no stage lay where the reaction turns."""
    speed = START - MU * RADIUS * impulse(aside) / INERTIA
    for rtol in (1e-4, 1e-6, 1e-8, 1e-10, 1e-11):
        sol = fm.simulate(rotor(aside), t_end=T_END, rtol=rtol, method=method, time_limit=60.0)
        assert sol.velocity("rotor.angle")[-1] == pytest.approx(speed, abs=10.0 * rtol * START)
        assert sol.stats.n_steps < 600


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_reactions_of_a_slider_crank_that_pass_by_near_0(method):
    """Errors were hundreds of times the tolerance."""
    scene = fm.models.slider_crank(friction=fm.laws.Coulomb(mu_s=0.1), gravity=9.81)
    grid = np.linspace(0.0, 1.5, 101)
    witnesses = (("radau", 1e-13), ("bdf", 1e-12))
    exact, other = (fm.simulate(scene, t_end=1.5, rtol=rtol, method=m, t_eval=grid).v for m, rtol in witnesses)
    moves = np.abs(exact).max(axis=1) > 1e-6 * np.abs(exact).max()
    scale = np.abs(exact).max(axis=1, keepdims=True)[moves]
    assert (np.abs(other - exact)[moves] / scale).max() < 3e-11
    for rtol in (1e-7, 1e-8, 1e-9, 1e-10):
        sol = fm.simulate(scene, t_end=1.5, rtol=rtol, method=method, t_eval=grid)
        assert (np.abs(sol.v - exact)[moves] / scale).max() < 15.0 * rtol
