"""Impacts without collision: rods that slide on their tip where friction has no solution."""

import math

import numpy as np
import pytest

import fricmb as fm

HALF, G = 0.5, 9.81


def rod(*, mu, angle, speed, law="newton", painleve="impact", e=0.4, friction=None, spin=0.0, mu_impact=None):
    body = fm.RigidBody(
        "rod", mass=1.0, inertia=HALF**2 / 3, position=(HALF * math.cos(angle), HALF * math.sin(angle)), angle=angle,
        velocity=(speed - spin * HALF * math.sin(angle), spin * HALF * math.cos(angle)), angular_velocity=spin,
        points={"tip": (-HALF, 0.0)},
    )  # fmt: skip
    tip = fm.RollerOnLine(
        "tip", body.point("tip"), push_only=True, restitution=e, friction=friction or fm.laws.Coulomb(mu_s=mu),
        mu_impact=mu_impact,
    )  # fmt: skip
    return fm.Scene("rod", [body, tip, fm.Gravity("g"), fm.ImpactLaw("impacts", law=law, painleve=painleve)])


def mobility(angle):
    """Of the tip, across and along the floor: M^-1 seen there, J = m h^2/3."""
    s, c = math.sin(angle), math.cos(angle)
    return 1 + 3 * c * c, 1 + 3 * s * s, 3 * s * c


@pytest.mark.parametrize(("mu", "angle"), [(3.0, 0.9), (1.6, 1.1), (2.0, 1.0)])
def test_a_rod_without_forces_that_fit_sticks_by_its_own_friction(mu, angle):
    """Stick: D (N, T) = (0, -slip), with T within mu N where 1 + 3 cos^2 < 3 mu sin cos."""
    n, t, across = mobility(angle)
    assert n < mu * across
    sol = fm.simulate(rod(mu=mu, angle=angle, speed=-3.0), t_end=0.05, rtol=1e-9)
    first = next(iter(sol.events.of(kind="impact")))
    det = n * t - across**2
    assert first.t == 0.0
    assert first.approach == 0.0
    assert first.impulse == pytest.approx(3.0 * across / det, rel=1e-12)
    assert first.tangential_impulse == pytest.approx(3.0 * n / det, rel=1e-12)
    assert first.loss == pytest.approx(0.5 * 3.0 * first.tangential_impulse, rel=1e-12)
    s, c = math.sin(angle), math.cos(angle)
    q, v = sol.q[:, 0], sol.v[:, 0]
    assert abs(v[0] + HALF * s * v[2]) < 1e-12
    assert abs(v[1] - HALF * c * v[2]) < 1e-12
    assert abs(q[2] - angle) < 1e-12


@pytest.mark.parametrize("e", [0.0, 0.4])
def test_by_poissons_law_the_tip_is_thrown_up(e):
    """Compression ends with the tip at rest; then e N more, along the floor what keeps it there or the cone allows."""
    mu, angle = 3.0, 0.9
    n, t, across = mobility(angle)
    sol = fm.simulate(rod(mu=mu, angle=angle, speed=-3.0, law="poisson", e=e), t_end=0.02, rtol=1e-9)
    first = next(iter(sol.events.of(kind="impact")))
    press = 3.0 * across / (n * t - across**2)
    assert first.impulse == pytest.approx((1 + e) * press, rel=1e-12)
    assert across / t < mu  # the tip does not slip in the second phase: T = N across/t
    speed = e * press * (n - across**2 / t)
    s, c = math.sin(angle), math.cos(angle)
    v = sol.v[:, 0]
    assert v[1] - HALF * c * v[2] == pytest.approx(speed, abs=1e-12)
    assert abs(v[0] + HALF * s * v[2]) < 1e-12
    assert sol.audit().ok


def test_a_run_that_slides_to_the_edge_goes_on_behind_an_impact():
    law = fm.laws.Stribeck(mu_s=2.5, mu_k=1.0, v_s=3.0)
    how = {"mu": 2.5, "angle": 1.0, "speed": -3.6, "friction": law, "mu_impact": 2.5}
    with pytest.raises(fm.IntegrationError, match="no single solution") as ended:
        fm.simulate(rod(**how, painleve="end"), t_end=0.01, rtol=1e-8)
    sol = fm.simulate(rod(**how), t_end=0.01, rtol=1e-8)
    jump = next(iter(sol.events.of(kind="impact")))
    assert jump.t == pytest.approx(ended.value.t, abs=1e-6)
    assert jump.approach == 0.0
    assert jump.loss > 0.0
    assert np.abs(sol.energy.residual).max() < 1e-6


def test_the_choice_is_one_of_two():
    with pytest.raises(fm.SceneError, match="painleve must be 'end' or 'impact', got 'jump'"):
        fm.ImpactLaw("impacts", painleve="jump")
