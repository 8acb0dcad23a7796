"""Every law of the catalogue in one common set of scenes."""

import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb import laws

CASES = [(name, d) for name in laws.names for d in getattr(laws, name).example().dimensions]


def scene_of(law, d, speed=1.0):
    """1: a block on a belt; 2: a swinging puck; 3: a disc that slides and spins; ``speed``: part of their speeds."""
    if d == 3:
        body = fm.ModalBody(
            "m", frequencies=(0.0, 0.0, 0.0), damping_ratios=0.0, masses=(1.0, 1.0, 0.5), axes="xyz",
            shapes={"sole": np.eye(3)},
            velocity={"mode1": 0.3 * speed, "mode2": 0.1 * speed, "mode3": 0.2 * speed},
        )  # fmt: skip
        contact = fm.Contact("sole", body.point("sole"), law=law, normal_force=1.0, axes="xyz")
        return fm.Scene("disc", [body, contact])
    if d == 2:
        puck = fm.Body("m", mass=1.0, axes="xy", velocity={"x": 0.3 * speed, "y": 0.4 * speed})
        springs = [fm.Spring(f"k{c}", puck, axis=c, stiffness=k) for c, k in (("x", 50.0), ("y", 80.0))]
        return fm.Scene("puck", [puck, *springs, fm.Contact("sole", puck, law=law, normal_force=1.0)])
    block, belt = fm.Body("m", mass=1.0), fm.Driven("belt", velocity={"x": 0.1 * speed})
    spring = fm.Spring("k", block, axis="x", stiffness=100.0)
    return fm.Scene("belt", [block, belt, spring, fm.Contact("sole", block, belt, law=law, normal_force=10.0)])


@pytest.mark.parametrize(("name", "d"), CASES)
def test_law_runs_and_its_energy_balances(name, d):
    sol = fm.simulate(scene_of(getattr(laws, name).example(), d), t_end=0.5, rtol=1e-6, method="bdf")
    assert np.abs(sol.energy.residual).max() < 1e-4
    assert np.isfinite(sol.force("sole")).all()
    if not sol.state("sole").size:
        assert (np.diff(sol.energy.friction_loss) >= -1e-9).all()


@functools.cache
def own_hold():
    """A block on a belt whose hold sets in within its band, by a program of its own: times, and x, v, z there."""
    mu_s, mu_k, v_band, stiffness, damping = 0.6, 0.4, 1.5e-3, 1e4, 30.0

    def rate(t, y):
        slip, z = y[1] - 0.1, y[2]
        x = min(1.0, max(0.0, abs(slip) / v_band - 1.0))
        inside, hold = 1.0 - x * x * (3.0 - 2.0 * x), stiffness * z + damping * slip
        held = inside * min(1.0, mu_s / abs(hold)) * hold
        force = -10.0 * (held + (1.0 - inside) * mu_k * np.sign(slip))
        return [y[1], force - 100.0 * y[0], inside * slip - (1.0 - inside) * abs(slip) * stiffness / mu_s * z]

    t = np.linspace(0.0, 0.5, 101)
    own = solve_ivp(rate, (0.0, 0.5), [0.0, 0.0, 0.0], method="DOP853", rtol=1e-13, atol=1e-17, t_eval=t, max_step=1e-4)
    return t, own


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
def test_a_hold_that_sets_in_within_its_band(method, rtol):
    """Against a program of its own: the state is 0 until slip comes into the band, and has no size there."""
    t, own = own_hold()
    sol = fm.simulate(scene_of(laws.Karnopp.example(), 1), t_end=0.5, rtol=rtol, method=method, t_eval=t)
    for found, true in ((sol.q[0], own.y[0]), (sol.v[0], own.y[1]), (sol.state("sole")[0], own.y[2])):
        np.testing.assert_allclose(found, true, atol=rtol * np.abs(true).max())


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize(("name", "d"), CASES)
def test_nothing_moves_where_nothing_acts(name, d, method):
    """Nothing has a size here: whatever is measured by the largest so far is measured by 0."""
    sol = fm.simulate(scene_of(getattr(laws, name).example(), d, speed=0.0), t_end=3.0, method=method)
    least = 1e-20 if name == "Offset" else 0.0  # one that pushes on is held by round-off
    assert np.abs(sol.q).max() <= least
    assert np.abs(sol.v).max() <= least
    assert not sol.events
    assert sol.stats.n_steps < 60
