"""Models in space against certified digits, constants of motion and closed forms."""

import json
from pathlib import Path

import numpy as np
import pytest

import fricmb as fm
from fricmb.models import catalogue

CASES = json.loads((Path(__file__).parents[1] / "data" / "space.json").read_text())


def certified(name):
    return {key: np.array(value, dtype=float) for key, value in CASES[name]["values"].items()}


def standard_run(name, rtol=1e-9):
    return fm.simulate(catalogue[name].build(), t_end=catalogue[name].t_end, rtol=rtol)


def centre(sol, name):
    return np.array([sol[f"{name}.{c}"][-1] for c in "xyz"])


def test_heavy_top():
    sol = standard_run("heavy_top")
    np.testing.assert_allclose(sol["top.axis"][:, -1], certified("heavy_top_cusps")["axis_n"], atol=1e-9)


def test_billiard():
    sol, found = standard_run("billiard"), certified("billiard_ball")
    assert [event.kind for event in sol.events] == ["stick"]
    assert sol.events[0].t == pytest.approx(float(found["onset_of_rolling"]), abs=1e-12)
    np.testing.assert_allclose(centre(sol, "ball")[:2], found["centre_at_1"], atol=1e-12)


def test_rolling_coin():
    sol, found = standard_run("rolling_coin"), certified("rolling_coin")
    np.testing.assert_allclose(centre(sol, "coin"), found["centre"], atol=1e-9)
    np.testing.assert_allclose(sol["coin.axis"][:, -1], found["axis"], atol=1e-9)
    slipping = fm.simulate(fm.models.rolling_coin(mu=0.35), t_end=0.2, rtol=1e-9)
    assert slipping.events[0].t == pytest.approx(float(found["slips_first_if_mu_is_0.35_at"]), abs=1e-9)


def test_turntable():
    np.testing.assert_allclose(
        centre(standard_run("turntable"), "ball")[:2], certified("ball_on_turntable")["centre"], atol=1e-9
    )


def test_rising_top():
    """It rises; Jellett's constant is one, and friction takes what the energy loses."""
    scene = catalogue["rising_top"].build()
    p, sol = scene.parameters, standard_run("rising_top")
    n, omega = sol["top.axis"], sol["top.omega"]
    across, axial = p["top.inertia_across"], p["top.inertia_axial"]
    along = np.sum(omega * n, axis=0)
    L = across * (omega - along * n) + axial * along * n
    reach, rho = 0.02, p["table.radius"]
    jellett = np.sum(L * np.array([[0.0], [0.0], [rho]]), axis=0) + reach * np.sum(L * n, axis=0)
    assert np.abs(jellett / jellett[0] - 1.0).max() < 1e-8
    assert sol["top.axis_z"][0] == pytest.approx(np.cos(0.3))
    assert [event.kind for event in sol.events] == ["stick"]
    rolls = sol.events[0].t
    assert np.arccos(sol.at([rolls])["top.axis_z"][0]) < 0.1  # it has risen, and rises no more
    later = sol.at(np.linspace(rolls, sol.t_end, 500))
    assert np.ptp(np.arccos(later["top.axis_z"])) < 0.02
    assert np.ptp(later.energy.total) < 1e-7 * sol.energy.kinetic[0]
    assert np.abs(sol.energy.residual).max() < 1e-7 * sol.energy.kinetic[0]
    assert sol.audit().ok


def test_ball_in_cylinder():
    found, sol = certified("ball_in_cylinder"), standard_run("ball_in_cylinder")
    assert sol["ball.z"][-1] == pytest.approx(float(found["z"]), abs=1e-9)


def test_dry_ball_joint():
    """It comes to rest out of plumb, where the ball bears what gravity turns, and friction takes all energy."""
    sol = standard_run("dry_ball_joint", rtol=1e-8)
    assert sol.events[-1].kind == "stick"
    arm = sol["bob.rotation"][:, :, -1] @ (0.1, 0.05, -0.3)
    held = np.cross(arm, (0.0, 0.0, -2.0 * 9.81))
    np.testing.assert_allclose(0.02 * sol.force("hook")[:, -1], -held, atol=1e-8)
    assert 1e-4 < np.linalg.norm(held) < 0.6 * 0.02 * 2.0 * 9.81
    assert sol.energy.kinetic[-1] < 1e-20
    assert np.abs(sol.energy.residual).max() < 1e-8 * sol.energy.kinetic[0]
    assert sol.audit().ok


def test_wobbling_disc_brake():
    """At the critical coefficient, and at no other, one pair of modes neither grows nor decays."""
    growth = {}
    for mu in (0.40, 0.413829737886213898, 0.42):
        steady = fm.analysis.steady_sliding(fm.models.wobbling_disc_brake(mu=mu, kick=0.0))
        growth[mu] = np.linalg.eigvals(steady.matrix()).real.max()
    below, at, above = growth.values()
    assert below < -0.01
    assert abs(at) < 1e-9
    assert above > 0.005
    sol = standard_run("wobbling_disc_brake", 1e-8)
    assert not sol.events
    assert np.abs(sol.energy.residual).max() < 1e-10 * np.ptp(sol.energy.friction_loss)


def test_wheelset():
    """At the critical speed one pair neither grows nor decays; well above it the oscillation settles to one size."""
    found = certified("wheelset")
    edge = fm.models.wheelset(speed=float(found["critical_speed"]), kick=0.0)
    values = np.linalg.eigvals(fm.analysis.steady_sliding(edge).matrix())
    hunting = values[np.argmin(np.abs(values - 1j * float(found["omega_critical"])))]
    assert abs(hunting.real) < 1e-9
    assert hunting.imag == pytest.approx(float(found["omega_critical"]), rel=1e-9)
    tops = []
    for kick in (0.002, 0.02):
        sol = fm.simulate(fm.models.wheelset(kick=kick), t_end=3.0, rtol=1e-7)
        tops.append(sol.at(np.linspace(2.5, 3.0, 2000))["axle.y"].max())
    assert tops[0] == pytest.approx(tops[1], rel=1e-3)
    assert tops[0] > 0.02
