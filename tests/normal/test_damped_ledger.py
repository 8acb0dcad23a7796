"""What a damped contact that opens and closes loses, beside a program of its own."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

MASS, WEIGHT, PRELOAD, T_END = 1.0, 5.0, 1.0, 6.0


def _lost(k, c, times):
    """Kinetic energy, that of the spring and of the weight at the start, less what is left of them at the times."""

    def pressing(y, v):
        return max(0.0, PRELOAD - k * y - c * v)

    def rate(_, s):
        return [s[1], (pressing(*s) - PRELOAD - WEIGHT) / MASS]

    run = solve_ivp(rate, (0.0, T_END), [0.0, 2.0], "DOP853", rtol=1e-12, atol=1e-14, t_eval=times)
    y, v = run.y
    slack = PRELOAD / k
    stored = np.where(y < slack, 0.5 * k * y**2, 0.5 * k * slack**2 + PRELOAD * (y - slack))
    energy = 0.5 * MASS * v**2 + stored + WEIGHT * y
    return energy[0] - energy


def _parts(k, c, mechanism):
    block = fm.Body("b", mass=MASS, axes="xy", velocity={"y": 2.0})
    pressing = fm.normal.Spring(axis="y", stiffness=k, damping=c, preload=PRELOAD)
    contact = fm.Contact("c", block, law=fm.laws.Coulomb(mu_s=0.3), normal_force=pressing)
    parts = [block, fm.Force("weight", block, axis="y", value=-WEIGHT), contact]
    if mechanism:  # turns about a pin beside it, so that the scene is run as one with joints
        arm = fm.RigidBody("arm", mass=1.0, inertia=0.1, position=(0.0, 0.0), points={"top": (0.0, 0.0)},
                           angular_velocity=1.0)
        hold = fm.Spring("hold", arm.point("top"), block, axis="x", stiffness=1.0)
        parts += [arm, fm.Revolute("pin", arm.point("top")), hold]
    return parts


@pytest.mark.parametrize(("k", "c"), [(200.0, 0.5), (200.0, 5.0), (2e4, 5.0)])
@pytest.mark.parametrize(("method", "mechanism"), [("radau", False), ("bdf", False), ("bdf", True)])
def test_a_damped_contact_that_opens_loses_what_the_motion_has_lost(k, c, method, mechanism):
    times = np.linspace(0.0, T_END, 601)
    scene = fm.Scene("bouncing block", _parts(k, c, mechanism))
    sol = fm.simulate(scene, t_end=T_END, t_eval=times, rtol=1e-9, method=method)
    lost = _lost(k, c, times)
    assert lost[-1] > 0.5
    assert sum(event.kind == "open" for event in sol.events) >= 1
    np.testing.assert_allclose(sol.energy.damping_loss, lost, rtol=0.0, atol=3e-7 * lost[-1])
    assert np.abs(sol.energy.residual).max() < 1e-7
    assert not any("ledger" in note for note in sol.stats.notes)


def test_a_contact_without_damping_loses_nothing():
    scene = fm.Scene("bouncing block", _parts(200.0, 0.0, False))
    for method in ("radau", "bdf"):
        sol = fm.simulate(scene, t_end=T_END, rtol=1e-6, method=method)
        assert np.abs(sol.energy.damping_loss).max() < 1e-10
