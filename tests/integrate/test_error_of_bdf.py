"""Errors of a run by BDF where nothing damps: those of its steps add up."""

from itertools import pairwise

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate.implicit.bdf import bdf_history
from fricmb.integrate.implicit.bdf.bdf_stability import guard_of


def arcs(grid, mu_s, mu_k, belt, x, v):
    """Unit mass on a unit spring and a belt, load 1, which slips at first: arcs of circles, and sticks between them."""
    t, side, found = 0.0, np.sign(v - belt), np.empty((2, grid.size))
    while t < grid[-1]:
        middle = -mu_k * side
        if side == 0:
            length = (mu_s - x) / belt
            motion = lambda s, x=x: np.array([x + belt * s, belt + 0.0 * s])  # noqa: E731
        else:
            radius, phase = np.hypot(x - middle, v), np.arctan2(v, x - middle)
            turns = np.arcsin(min(1.0, belt / radius))
            ahead = [np.mod(angle + phase, 2.0 * np.pi) for angle in (-turns, np.pi + turns)]
            length = min((s for s in ahead if s > 1e-9), default=np.inf) if radius > belt else np.inf
            motion = lambda s, m=middle, r=radius, p=phase: np.array([m + r * np.cos(s - p), -r * np.sin(s - p)])  # noqa: E731
        within = (grid >= t) & (grid <= t + length)
        found[:, within] = motion(grid[within] - t)
        if length == np.inf:
            break
        t, (x, _), v = t + length, motion(length), belt
        side = -1.0 if side == 0 else (0 if abs(x) <= mu_s else -np.sign(x))
    return found


@pytest.mark.parametrize("rtol", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10])
@pytest.mark.parametrize(
    ("mu_s", "mu_k", "belt", "x"), [(0.45, 0.35, 0.86, 2.62), (0.74, 0.74, 1.09, -1.78), (0.92, 0.92, 1.07, -0.33)]
)
def test_errors_of_steps_sum_to_a_few_tolerances(mu_s, mu_k, belt, x, rtol):
    """Each of thirty steps had been allowed the whole tolerance: 20 to 32 rtol."""
    grid = np.linspace(0.0, 10.0, 201)
    q, v = arcs(grid, mu_s, mu_k, belt, x, 0.0)
    block, drum = fm.Body("block", mass=1.0, position={"x": x}), fm.Driven("belt", velocity={"x": belt})
    law = fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)
    spring = fm.Spring("k", block, axis="x", stiffness=1.0)
    scene = fm.Scene("s", [block, drum, spring, fm.Contact("c", block, drum, law=law, normal_force=1.0)])
    sol = fm.simulate(scene, t_end=10.0, rtol=rtol, method="bdf", t_eval=grid)
    assert np.abs(sol.q[0] - q).max() < 3 * rtol * np.abs(q).max()
    assert np.abs(sol.v[0] - v).max() < 3 * rtol * np.abs(v).max()
    assert sol.stats.n_steps + sol.stats.n_rejected < 100


def test_of_many_bodies_no_matrix_is_made(monkeypatch):
    """Frequencies up to the bound of Gershgorin, sqrt(4 k/m) in a chain, stand for the spectrum; three full matrices of
    4000 bodies took half a gigabyte."""
    n, seen = 600, []
    bodies = [fm.Body(f"b{i}", mass=2.0) for i in range(n)]
    springs = [fm.Spring(f"k{i}", a, b, axis="x", stiffness=3.0) for i, (a, b) in enumerate(pairwise(bodies))]
    rub = fm.Contact("rub", bodies[0], law=fm.laws.Coulomb(mu_s=0.3), normal_force=1.0)
    monkeypatch.setattr(bdf_history, "guard_of", lambda found: seen.append(found) or guard_of(found))
    monkeypatch.setattr(bdf_history, "motion_layers", None)
    start = {"velocity": {"b7.x": 1.0}}
    fm.simulate(fm.Scene("chain", [*bodies, *springs, rub]), t_end=0.1, method="bdf", initial=start)
    ((omega, decay),) = seen
    assert omega.max() == pytest.approx(np.sqrt(4.0 * 3.0 / 2.0), rel=1e-14)
    assert not decay.any()
