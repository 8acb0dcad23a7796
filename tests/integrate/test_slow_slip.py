"""What a law of slip speed does between the nodes of a step, where slip is slow or turns."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import fricmb as fm


def largest_error(solution, q, v):
    return max(np.abs(solution.q[0] - q).max() / np.abs(q).max(), np.abs(solution.v[0] - v).max() / np.abs(v).max())


def from_corner_to_corner(corner, stiffness, belt, force, grid):
    """Motion of a unit mass that starts with the belt: closed forms within and beyond the corners of its law."""

    def system(side):
        law = [-force / corner, force / corner * belt] if side == 0 else [0.0, -side * force]
        return np.array([[0.0, 1.0, 0.0], [-stiffness, *law], [0.0, 0.0, 0.0]])

    look, t, y, side, rows = 5e-4, 0.0, np.array([0.0, belt, 1.0]), 0, np.empty((2, grid.size))
    while t < grid[-1]:
        M, u, there = system(side), 0.0, y
        E = expm(M * look)

        def beyond(u, M=M, y=y, side=side):
            return (abs((expm(M * u) @ y)[1] - belt) - corner) * (1.0 if side == 0 else -1.0)

        for _ in range(int((grid[-1] - t) / look) + 1):
            there, u = E @ there, u + look
            if (abs(there[1] - belt) > corner) == (side == 0):
                break
        else:
            u = np.inf
        last = brentq(beyond, max(u - look, 1e-9), u, xtol=1e-16) if u < np.inf else np.inf
        for i in np.flatnonzero((grid >= t) & (grid <= t + last)):
            rows[:, i] = (expm(M * (grid[i] - t)) @ y)[:2]
        if last == np.inf:
            break
        t, y = t + last, expm(M * last) @ y
        side = int(np.sign(y[1] - belt)) if side == 0 else 0
    return rows


@pytest.fixture(scope="module")
def dips():
    """A block on a belt that comes near the belt's speed for 2 ms, below the corner of its law by 1e-3 and less."""
    grid = np.linspace(0.0, 6.0, 61)
    body, belt = fm.Body("b", mass=1.0, velocity={"x": 0.3}), fm.Driven("belt", velocity={"x": 0.3})
    law = fm.laws.LinearRegularised(mu=0.4, v_reg=0.001)
    parts = [fm.Spring("k", body, axis="x", stiffness=10.0), fm.Contact("c", body, belt, law=law, normal_force=2.0)]
    return fm.Scene("s", [body, belt, *parts]), grid, from_corner_to_corner(0.001, 10.0, 0.3, 0.8, grid)


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("rtol", [1e-7, 1e-9])
def test_a_short_dip_below_the_corner_of_a_law_is_seen(dips, method, rtol):
    scene, grid, (q, v) = dips
    solution = fm.simulate(scene, t_end=6.0, rtol=rtol, method=method, t_eval=grid)
    assert largest_error(solution, q, v) < 5 * rtol


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_the_peak_of_a_law_behind_a_reversal_is_seen(method):
    # slip passes v_s within 1e-4 of a period; a step over it loses the impulse of the peak at each of ten reversals
    grid = np.linspace(0.0, 4.0, 101)
    body = fm.Body("b", mass=1.0, position={"x": 3.63}, velocity={"x": -1e-9})
    law = fm.laws.Stribeck(mu_s=0.8, mu_k=0.66, v_s=0.0016)
    parts = [fm.Spring("k", body, axis="x", stiffness=4.3), fm.Contact("c", body, law=law, normal_force=1.0)]
    scene = fm.Scene("s", [body, *parts])
    series = fm.simulate(scene, t_end=4.0, rtol=1e-11, method="taylor", t_eval=grid)
    for rtol in (1e-6, 1e-7, 1e-8):
        solution = fm.simulate(scene, t_end=4.0, rtol=rtol, method=method, t_eval=grid)
        assert largest_error(solution, series.q[0], series.v[0]) < 3 * rtol


def test_a_law_much_steeper_than_the_tolerance_of_velocities_does_not_make_steps_creep():
    # aging at rest: slip of 1e-9 is where the force is, and 1e-5 is what velocities may be wrong by at rtol 1e-2
    body, belt = fm.Body("b", mass=1.0, velocity={"x": 0.3}), fm.Driven("belt", velocity={"x": 0.3})
    law, grid = fm.laws.RateAndState.example(), np.linspace(0.0, 6.0, 61)
    parts = [fm.Spring("k", body, axis="x", stiffness=10.0), fm.Contact("c", body, belt, law=law, normal_force=2.0)]
    scene = fm.Scene("s", [body, belt, *parts])
    tight = fm.simulate(scene, t_end=6.0, rtol=1e-10, method="radau", t_eval=grid)
    for rtol in (1e-2, 1e-3, 1e-4, 1e-5):
        solution = fm.simulate(scene, t_end=6.0, rtol=rtol, method="radau", t_eval=grid)
        assert solution.stats.n_steps + solution.stats.n_rejected < 300
        assert largest_error(solution, tight.q[0], tight.v[0]) < rtol
