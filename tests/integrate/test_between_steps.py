"""Values between steps and at breakpoints, against closed forms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
import sympy
from scipy.linalg import expm

import fricmb as fm
from fricmb.integrate.problem import SLIP
from fricmb.laws import Coulomb, CoulombViscous

GENERAL = ("radau", "bdf")


@pytest.mark.parametrize("method", GENERAL)
def test_energies_between_steps_are_as_good_as_the_motion(method: str) -> None:
    """A block slides on a belt throughout: x rings about mu N/k, and losses and input follow from x and v alone."""
    k, c, mu, belt, x0 = 4.0, 0.3, 0.4, 3.0, 0.8
    block = fm.Body("m", mass=1.0, position={"x": x0})
    moving = fm.Driven("belt", velocity={"x": belt})
    scene = fm.Scene("belt", [
        block, moving, fm.Spring("k", block, axis="x", stiffness=k), fm.Damper("c", block, axis="x", damping=c),
        fm.Contact("sole", block, moving, law=Coulomb(mu_s=mu, mu_k=mu), normal_force=1.0),
    ])  # fmt: skip
    rtol = 1e-11
    t = np.linspace(0.0, 6.0, 301)
    sol = fm.simulate(scene, t_end=6.0, rtol=rtol, method=method, t_eval=t)

    d, rest = 0.5 * c, mu / k
    w = np.sqrt(k - d**2)
    x = rest + (x0 - rest) * np.exp(-d * t) * (np.cos(w * t) + d / w * np.sin(w * t))
    v = -(x0 - rest) * k / w * np.exp(-d * t) * np.sin(w * t)
    supply = mu * belt * t
    loss = supply - mu * (x - x0)
    damped = supply - loss + 0.5 * k * (x0**2 - x**2) - 0.5 * v**2
    assert len(sol.events) == 0
    known = sol.energy
    for found, true in ((known.friction_loss, loss), (known.input, supply), (known.damping_loss, damped)):
        assert np.abs(found - true).max() < 2.0 * rtol * np.abs(true).max()
    assert np.abs(known.residual).max() < 2.0 * rtol * supply[-1]


@dataclass(frozen=True, kw_only=True)
class Relaxing(fm.FrictionLaw):
    """A bristle that creeps back: linear, so that its motion has a closed form."""

    stiffness: float
    tau: float
    states = ("z",)

    def define_force(self, v, N, z):
        return tuple(-self.stiffness * N * bent for bent in z)

    def define_rate(self, v, N, z):
        return tuple(speed - bent / self.tau for speed, bent in zip(v, z, strict=True))


@pytest.mark.parametrize("rtol", [1e-6, 1e-9, 1e-11])
@pytest.mark.parametrize("method", GENERAL)
def test_states_between_steps_are_as_good_as_the_motion(method: str, rtol: float) -> None:
    """A block on a belt held by bristles that creep: (x, v, z, 1) follows a matrix exponential."""
    k, belt, load, tau = 2.0, 0.5, 10.0, 0.7
    block = fm.Body("m", mass=1.0, position={"x": 0.3})
    moving = fm.Driven("belt", velocity={"x": belt})
    scene = fm.Scene("belt", [
        block, moving, fm.Spring("k", block, axis="x", stiffness=k),
        fm.Contact("sole", block, moving, law=Relaxing(stiffness=1.0, tau=tau), normal_force=load),
    ])  # fmt: skip
    t = np.linspace(0.0, 12.0, 301)
    sol = fm.simulate(scene, t_end=12.0, rtol=rtol, method=method, t_eval=t)
    rates = np.array([[0, 1, 0, 0], [-k, 0, -load, 0], [0, 1, -1 / tau, -belt], [0, 0, 0, 0]])
    x, _, z, _ = np.array([expm(rates * time) @ (0.3, 0.0, 0.0, 1.0) for time in t]).T
    assert np.abs(sol["m.x"] - x).max() < 5.0 * rtol * np.abs(x).max()
    assert np.abs(sol.state("sole")[0] - z).max() < 5.0 * rtol * np.abs(z).max()
    assert np.abs(sol.force("sole")[0] + load * z).max() < 5.0 * rtol * load * np.abs(z).max()


@pytest.mark.parametrize("blocks", [1, 2])
@pytest.mark.parametrize("method", GENERAL)
def test_belt_that_jumps_past_the_block(method: str, blocks: int) -> None:
    """The force before the jump belongs to the slip before it: else friction under a law of speed seems to drive."""
    mu, c, v0 = 0.2, 0.5, 0.5
    moving = fm.Driven("belt", velocity={"x": sympy.Piecewise((0.9, fm.t < 1), (0.1, True))})
    law = CoulombViscous(mu_s=mu, mu_k=mu, viscous=c)
    bodies = [fm.Body(f"m{i}", mass=1.0, velocity={"x": v0}) for i in range(blocks)]
    rubs = [fm.Contact(f"c{i}", body, moving, law=law, normal_force=1.0) for i, body in enumerate(bodies)]
    sol = fm.simulate(fm.Scene("jump", [*bodies, moving, *rubs]), t_end=1.4, rtol=1e-9, method=method)
    # with r the slip speed: r' = -mu - c r on both sides, from 0.4 down, then from where the jump leaves it
    before = (0.9 - v0 + mu / c) * np.exp(-c) - mu / c
    after = (0.9 - before - 0.1 + mu / c) * np.exp(-0.4 * c) - mu / c
    assert before > 0.0
    assert after > 0.0
    assert sol.velocity("m0.x")[-1] == pytest.approx(0.1 + after, rel=1e-9)
    at = np.flatnonzero(sol.t == 1.0)
    assert at.size >= 2
    force, slip = sol.force("c0")[0], sol.relative_velocity("c0")[0]
    assert (force[at] * slip[at] < 0.0).all()
    assert slip[at[0]] == pytest.approx(-before, rel=1e-9)
    assert slip[at[-1]] == pytest.approx(0.8 - before, rel=1e-9)


@pytest.mark.parametrize("rtol", [1e-4, 1e-5])
@pytest.mark.parametrize("method", GENERAL)
def test_friction_of_a_contact_that_has_just_closed_opposes_slip(method: str, rtol: float) -> None:
    """Its load begins at 0, where no force tells a direction and polynomials through those of the step pass 0."""
    block = fm.Body("b", mass=0.4, axes="xy", position={"x": 0.3}, velocity={"x": 0.5})
    belt = fm.Driven("belt", velocity={"x": 0.6})
    load = fm.normal.Hertz(axis="y", stiffness=60.0, preload=0.1)
    scene = fm.Scene("hops", [
        block, belt, fm.Spring("k", block, axis="x", stiffness=2.0),
        fm.Force("f", block, axis="y", value=0.15 * sympy.sin(2.0 * fm.t)),
        fm.Contact("c", block, belt, law=fm.laws.Stribeck(mu_s=0.6, mu_k=0.3, v_s=0.1), normal_force=load),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=10.0, rtol=rtol, method=method, t_eval=np.linspace(0.0, 10.0, 401))
    closed = [event.t for event in sol.events if event.kind == "close"]
    assert closed
    for t in closed:
        after = sol.at(t + np.geomspace(1e-7, 1e-2, 60))
        slips = after.mode("c") == SLIP
        g, F, N = after.relative_velocity("c")[0][slips], after.force("c")[0][slips], after.normal_force("c")[slips]
        assert slips.sum() > 20
        assert (N > 0.0).all()
        assert (-F * np.sign(g) >= 0.3 * N * (1.0 - 1e-14)).all()
