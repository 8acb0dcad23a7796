"""Scenes with joints that the oracle found wrong, or that stopped."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm
from tests.oracle.campaign import make
from tests.oracle.judge import judge, truth
from tests.oracle.random_scenes import generate


def test_shoes_of_a_guide_stand_where_the_axis_says_not_its_round_off():
    """A guide along z but for 1e-17, its shoes side by side along x; also by an own program in one coordinate."""
    spec = generate("tree", 150003)
    case = make({}, spec)
    true = truth(case)
    assert {m: judge(true, m).kind for m in ("bdf", "radau")} == {"bdf": "right", "radau": "right"}
    (link,), (push,), ((_, _, k_z, c_z), (_, _, k_y, _)) = spec.links, spec.pushes, spec.springs
    law = link.fields
    sol = fm.simulate(case.scene, t_end=spec.t_end, rtol=1e-9)
    start, across = sol["b0.z"][0], sol["b0.y"][0]
    arm = sol["b0.x"][0]  # of the force along y about the guide, which goes through the origin
    load = 2.0 * sum(abs(k_y * across / 4 + sign * k_y * across * arm / link.width / 2) for sign in (1, -1))

    def rates(t, y):
        force = push.constant + push.amplitude * np.sin(push.omega * t + push.phase) - link.mass * 9.81
        mu = law["mu_k"] + (law["mu_s"] - law["mu_k"]) * np.exp(-((y[1] / law["v_s"]) ** 2))
        return y[1], (force - k_z * y[0] - c_z * y[1] + mu * load) / link.mass  # it falls from the start on

    y = solve_ivp(rates, (0, spec.t_end), [start, 0.0], rtol=1e-11, atol=1e-12).y
    assert (y[1, 1:] < 0.0).all()
    assert sol["b0.z"][-1] == pytest.approx(y[0, -1], abs=1e-8)


def test_stages_near_rest_start_from_the_step_before_only_where_that_was_one():
    """Slip passes rest by 4e-8: what steps as short say of forces is round-off, and no solution was found from it."""
    true = truth(make({}, generate("tree", 150009)))
    kinds = {rtol: judge(true, "radau", rtol).kind for rtol in (3.16e-6, 1e-6, 4.6e-7, 2.15e-7)}
    assert set(kinds.values()) == {"right"}, kinds
