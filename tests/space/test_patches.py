"""Patches on a plane that slide and spin at once, against certified digits and an integral over the patch."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

sys.path.insert(0, str(Path(__file__).parent))
from cases import DOWN, case

SPACE, UP, G = fm.space, (0.0, 0.0, 1.0), 9.81


def disc(kind, law, **options):
    """A puck that touches in the plane of its centre, so that friction does not tip it."""
    p, _ = case("contensou_disc")
    R, m = p["R"], 0.3
    across, axial = m * R**2 / 4, m * R**2 / 2
    start = {"mass": m, "velocity": (p["v0"], 0, 0), "angular_velocity": (0, 0, p["omega0"])}
    if kind == "rotor":
        puck = SPACE.Rotor("puck", inertia_across=across, inertia_axial=axial, **start)
        foot = puck.station("foot", 0.0)
    else:
        puck = SPACE.RigidBody("puck", inertia=(across, across, axial), **start)
        foot = puck.point("foot", (0, 0, 0))
    ice = SPACE.OnPlane("ice", foot, normal=UP, patch=R, friction=law(mu=p["mu"], v_reg=1e-9), **options)
    return fm.Scene("puck", [puck, ice, DOWN])


@pytest.mark.parametrize("kind", ["rotor", "body"])
def test_disc_slides_and_spins_to_its_stop(kind):
    p, found = case("contensou_disc")
    found = {key: float(value) for key, value in found.items()}
    stop = found["stop_time"]
    sol = fm.simulate(disc(kind, fm.laws.Contensou), t_end=1.2 * stop, rtol=1e-9)
    there = sol.at([0.05, stop * (1 - 1e-3), stop * (1 - 1e-6)])
    omega = there["puck.omega"][2]
    assert there.velocity("puck.x")[0] == pytest.approx(found["v_at_0p05"], rel=1e-8)
    assert omega[0] == pytest.approx(found["omega_at_0p05"], rel=1e-8)
    # both go to 0 at once, in a ratio of their own
    off = np.abs(there.velocity("puck.x")[1:] / (p["R"] * omega[1:]) - found["final_ratio_v_over_Romega"])
    assert off[1] < 0.1 * off[0]
    assert off[1] < 2e-4
    assert sol["puck.x"][-1] == pytest.approx(found["distance"], rel=1e-7)
    np.testing.assert_allclose(sol["puck.y"], 0.0, atol=1e-12)
    if kind == "rotor":
        assert sol["puck.spin"][-1] == pytest.approx(found["angle"], rel=1e-7)
    assert abs(sol.velocity("puck.x")[-1]) < 1e-9
    assert np.abs(sol.energy.residual).max() < 1e-8 * np.ptp(sol.energy.friction_loss)
    assert sol.audit().ok


def over_the_patch(slip, spin, R, order=120):
    """Force (2,) and moment of unit pressure by Gauss's formula along rays from where the patch does not move.

    From there, d away from the middle at angle phi, slip has the direction across the ray on all of it: chords remain.
    """
    pole = np.array([-slip[1], slip[0]]) / spin
    d = float(np.hypot(*pole))
    x, w = np.polynomial.legendre.leggauss(order)
    base = np.arctan2(-pole[1], -pole[0])
    if d < R:
        ranges = [(-np.pi, np.pi)]
    else:
        ranges = [(-np.arcsin(R / d), np.arcsin(R / d))]
    force, moment = np.zeros(2), 0.0
    for low, high in ranges:
        u = 0.5 * (high - low) * (1 + x) + low
        weights = 0.5 * (high - low) * w
        if d >= R:  # the root at the ends of the range is taken away by a sine
            s = 0.5 * np.pi * x
            u, weights = high * np.sin(s), high * np.cos(s) * 0.5 * np.pi * w
        for angle, weight in zip(u, weights, strict=True):
            root = np.sqrt(max(R**2 - (d * np.sin(angle)) ** 2, 0.0))
            far, near = d * np.cos(angle) + root, max(d * np.cos(angle) - root, 0.0) if d >= R else 0.0
            ray = np.array([np.cos(base + angle), np.sin(base + angle)])
            across = np.array([-ray[1], ray[0]]) * np.sign(spin)
            area, first = (far**2 - near**2) / 2, (far**3 - near**3) / 3
            force -= weight * area * across
            moment -= weight * (area * (pole[0] * across[1] - pole[1] * across[0]) + first * np.sign(spin))
    size = np.pi * R**2
    return force / size, moment / size


def test_ball_with_a_patch_against_an_integral_over_it():
    """A ball that slides, rolls on and pivots on a turntable, its patch integrated anew in an own program."""
    m, R, patch, mu, Omega = 0.17, 0.03, 0.004, 0.2, 3.0
    v0, w0 = (0.4, 0.1), (3.0, 9.0, 60.0)
    ball = SPACE.Ball("ball", mass=m, radius=R, position=(0.1, 0, R), velocity=(*v0, 0), angular_velocity=w0)
    law = fm.laws.Contensou(mu=mu, v_reg=1e-9)
    table = SPACE.OnPlane("table", ball, normal=UP, patch=patch, turning=Omega, push_only=True, friction=law)
    end = 0.04
    sol = fm.simulate(fm.Scene("ball", [ball, table, DOWN]), t_end=end, rtol=1e-9)
    inertia = 0.4 * m * R**2

    def rates(t, y):
        (px, py), v, w = y[:2], y[2:4], y[4:]
        slip = np.array([v[0] - R * w[1] + Omega * py, v[1] + R * w[0] - Omega * px])
        force, moment = over_the_patch(slip, w[2] - Omega, patch)
        force, moment = mu * m * G * force, mu * m * G * moment
        return [*v, *(force / m), R * force[1] / inertia, -R * force[0] / inertia, moment / inertia]

    own = solve_ivp(rates, (0, end), [0.1, 0, *v0, *w0], method="DOP853", rtol=1e-10, atol=1e-12)
    seen = [*(sol[f"ball.{c}"][-1] for c in "xy"), *(sol.velocity(f"ball.{c}")[-1] for c in "xy")]
    np.testing.assert_allclose([*seen, *sol["ball.omega"][:, -1]], own.y[:, -1], rtol=1e-7)
    assert abs(sol.relative_velocity("table")[2]).max() == pytest.approx(patch * (w0[2] - Omega), rel=1e-9)
    assert sol.audit().ok


def test_patches_and_laws_have_to_fit():
    ball = SPACE.Ball("ball", mass=1.0, radius=0.1, position=(0, 0, 0.1))
    both, one = fm.laws.Contensou(mu=0.2, v_reg=1e-6), fm.laws.Coulomb(mu_s=0.2)
    refused = [
        (lambda: SPACE.OnPlane("p", ball, normal=UP, friction=both), "patch must be given"),
        (lambda: SPACE.OnPlane("p", ball, normal=UP, patch=0.01, friction=one), "a law of sliding and spinning"),
        (lambda: SPACE.OnPlane("p", ball, normal=UP, patch=0.0, friction=both), "patch must be"),
        (lambda: SPACE.OnPlane("p", ball, normal=UP, patch=0.01), "left out where there is no friction"),
    ]
    for make, words in refused:
        with pytest.raises(fm.FricmbError, match=words):
            make()


def test_equations_name_the_force_of_the_compiled_law():
    equations = disc("rotor", fm.laws.Contensou).equations()
    x, y, spin = equations.contacts[0].slip
    assert [str(force.func) for force in (x, y, spin)] == ["F_ice_x", "F_ice_y", "F_ice_spin"]
    names = {str(symbol) for symbol in spin.free_symbols}
    assert {"xdot_puck", "spindot_puck", "patch_ice", "lambda_ice"} <= names


def test_pade_form_follows_the_exact_law_from_afar():
    """The fractions share their ends with the exact law: a puck that mostly slides moves nearly as it."""
    laws = (fm.laws.Contensou, fm.laws.ContensouPade)
    exact, near = (fm.simulate(disc("rotor", law), t_end=0.1, rtol=1e-7) for law in laws)
    assert near["puck.x"][-1] == pytest.approx(exact["puck.x"][-1], rel=0.15)
    assert near["puck.x"][-1] != exact["puck.x"][-1]
