"""Ropes over drums: Euler's ratio, slip, band brakes, slack."""

import math
import pickle

import numpy as np
import pytest

import fricmb as fm

G = 9.81


def tensions(sol):
    mean, difference = sol.reaction("rope")[0], sol.force("rope")[0]
    return mean + difference / 2, mean - difference / 2


def capstan(friction, angle, pull, **more):
    """A rope on a fixed drum: 10 at the first end, ``pull`` at the second."""
    bodies = [fm.Body(name, mass=1.0) for name in ("a", "b")]
    rope = fm.Rope("rope", bodies, axes=("x", "x"), angle=angle, friction=friction, **more)
    forces = [fm.Force(f"f{c.name}", c, axis="x", value=v) for c, v in zip(bodies, (10.0, pull), strict=True)]
    return fm.Scene("capstan", [*bodies, rope, *forces])


@pytest.mark.parametrize(("mu", "angle"), [(0.1, 0.5), (0.5, math.pi), (0.3, 6 * math.pi)])
@pytest.mark.parametrize("up", [True, False])
def test_breaks_away_at_eulers_ratio(mu, angle, up):
    ratio = math.exp(mu * angle if up else -mu * angle)
    pull = 10.0 + 10.0 * (ratio - 1.0) * fm.t  # reaches the limit at t = 1
    sol = fm.simulate(capstan(mu, angle, pull), t_end=1.1, rtol=1e-10)
    assert [(e.kind, e.t) for e in sol.events] == [("slip", pytest.approx(1.0, rel=1e-12))]
    first, second = tensions(sol)
    assert second[-1] / first[-1] == pytest.approx(ratio, rel=1e-12)
    np.testing.assert_allclose(first[sol.t < 1.0], 10.0, rtol=1e-12)
    assert sol.audit().ok


def test_more_at_break_away():
    law = fm.laws.Coulomb(mu_s=0.5, mu_k=0.3)
    sol = fm.simulate(capstan(law, 2.0, 10.0 + 10.0 * fm.t), t_end=2.0, rtol=1e-9)
    assert sol.events[0].t == pytest.approx(math.exp(1.0) - 1.0, rel=1e-10)
    first, second = tensions(sol)
    assert second[-1] / first[-1] == pytest.approx(math.exp(0.6), rel=1e-10)


def test_two_masses_over_a_dry_drum():
    """m1 g - T1 = m1 a, T2 - m2 g = m2 a, T1 = T2 e^(mu phi)."""
    m1, m2, mu = 5.0, 1.0, 0.3
    one = fm.RigidBody("one", mass=m1, inertia=1.0, position=(-0.5, -2.0))
    two = fm.RigidBody("two", mass=m2, inertia=1.0, position=(0.5, -3.0))
    down = (0.0, -1.0)
    rope = fm.Rope("rope", (one, two), axes=(down, down), angle=math.pi, friction=mu)
    sol = fm.simulate(fm.Scene("s", [one, two, rope, fm.Gravity("g")]), t_end=0.7, rtol=1e-9)
    e = math.exp(mu * math.pi)
    a = G * (m1 - m2 * e) / (m1 + m2 * e)
    assert sol["one.y"][-1] == pytest.approx(-2.0 - a * 0.7**2 / 2, rel=1e-10)
    assert sol["two.y"][-1] == pytest.approx(-3.0 + a * 0.7**2 / 2, rel=1e-10)
    first, second = tensions(sol)
    np.testing.assert_allclose(first, m1 * (G - a), rtol=1e-10)
    np.testing.assert_allclose(second, m2 * (G + a), rtol=1e-10)
    assert np.abs(sol.energy.residual).max() < 1e-10
    assert sol.audit().ok


@pytest.mark.parametrize("spin", [8.0, -8.0])
def test_moment_of_a_band_brake(spin):
    """The band is held at one end, pulled with P at the other: R P (e^(mu phi) - 1) or R P (1 - e^(-mu phi))."""
    R, P, mu, phi, J = 0.2, 30.0, 0.25, 4.0, 0.9
    drum = fm.RigidBody("drum", mass=5.0, inertia=J, angular_velocity=spin)
    lever = fm.Body("lever", mass=0.1)
    band = fm.Rope("rope", (fm.GROUND, lever), axes=("x", "x"), drum=drum, radius=R, angle=phi, friction=mu)
    parts = [drum, lever, band, fm.Revolute("hub", drum), fm.Force("pull", lever, axis="x", value=P)]
    moment = R * P * (math.exp(mu * phi) - 1.0 if spin > 0 else 1.0 - math.exp(-mu * phi))
    stops = J * abs(spin) / moment
    sol = fm.simulate(fm.Scene("brake", parts), t_end=stops + 1.0, rtol=1e-9)
    assert [(e.kind, e.t) for e in sol.events] == [("stick", pytest.approx(stops, rel=1e-9))]
    first, second = (t[0] for t in tensions(sol))
    assert second == pytest.approx(P, rel=1e-10)
    assert first / second == pytest.approx(math.exp(math.copysign(mu * phi, spin)), rel=1e-10)
    assert sol.energy.friction_loss[-1] == pytest.approx(J * spin**2 / 2, rel=1e-8)
    assert sol.audit().ok


def test_a_winch_pulls_until_its_rope_slips():
    """A driven drum takes the rope along: what the load may be is e^(mu phi) times the pull at the free end."""
    drum = fm.RigidBody("drum", mass=5.0, inertia=0.5, angular_velocity=2.0)
    load, hand = fm.Body("load", mass=2.0, velocity={"x": -0.4}), fm.Body("hand", mass=0.5, velocity={"x": 0.4})
    rope = fm.Rope("rope", (load, hand), axes=("x", "x"), drum=drum, radius=0.2, angle=3.0, friction=0.4)
    parts = [
        drum, load, hand, rope, fm.Revolute("hub", drum), fm.DrivenAngle("motor", drum, speed=2.0),
        fm.Force("weight", load, axis="x", value=5.0 + 2.0 * fm.t), fm.Force("pull", hand, axis="x", value=4.0),
    ]  # fmt: skip
    sol = fm.simulate(fm.Scene("winch", parts), t_end=6.5, rtol=1e-9)
    limit = (4.0 * math.exp(1.2) - 5.0) / 2.0
    assert [(e.kind, e.t) for e in sol.events] == [("slip", pytest.approx(limit, rel=1e-9))]
    assert sol.at([limit / 2]).velocity("load.x")[0] == pytest.approx(-0.4, rel=1e-9)


def test_slack_ends_a_run_or_lets_the_rope_go():
    scene = capstan(0.2, 1.0, 8.0 - 20.0 * fm.t)
    with pytest.raises(fm.IntegrationError, match=r"'rope' is lost: its reaction .* ropes pull"):
        fm.simulate(scene, t_end=2.0)
    sol = fm.simulate(capstan(0.2, 1.0, 8.0 - 20.0 * fm.t, when_slack="open"), t_end=1.0)
    assert sol.events[-1].kind == "open"


def test_sensitivity_to_friction_and_angle():
    mu, angle = 0.4, 2.0
    sol = fm.simulate(
        capstan(mu, angle, 10.0 + 10.0 * fm.t), t_end=2.0, rtol=1e-9, sensitivities=("rope.mu", "rope.angle")
    )
    ratio = math.exp(mu * angle)
    assert sol.events[0].sensitivity("rope.mu") == pytest.approx(angle * ratio, rel=1e-8)
    assert sol.events[0].sensitivity("rope.angle") == pytest.approx(mu * ratio, rel=1e-8)


def test_copies_and_files(tmp_path):
    scene = capstan(fm.laws.Coulomb(mu_s=0.5, mu_k=0.3), 2.0, 20.0)
    rope = scene["rope"]
    assert pickle.loads(pickle.dumps(rope)) == rope
    assert (rope.mu, rope.friction.mu_s) == (0.3, pytest.approx(math.tanh(0.5) / math.tanh(0.3)))
    assert scene.with_parameters({"rope.mu": 0.2})["rope"].mu == 0.2
    sol = fm.simulate(scene, t_end=0.5)
    sol.save(tmp_path / "rope.npz")
    assert fm.Solution.load(tmp_path / "rope.npz").scene["rope"] == rope
    assert "tanh" in str(scene.equations())
    assert "joints              1" in str(scene.plan())


def test_what_cannot_be_is_refused_by_name():
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=1.0)
    drum = fm.RigidBody("drum", mass=1.0, inertia=1.0)
    given = {"axes": ("x", "x"), "angle": 1.0, "friction": 0.3}
    for match, ends, more in [
        ("ends must be two ends", (a,), {}),
        ("ends must be of different parts, got 'a'", (a, a), {}),
        ("one end must have degrees of freedom", (fm.GROUND, fm.ground_point(1.0, 0.0)), {}),
        ("axes must be two directions", (a, b), {"axes": "x"}),
        ("axes must be two directions", (a, b), {"axes": (1.0, 0.0)}),
        ("'y', which 'a' does not have", (a, b), {"axes": "yx"}),
        ("angle must be a finite number > 0", (a, b), {"angle": 0.0}),
        ("friction must be given", (a, b), {"friction": None}),
        ("friction must be a finite number >= 0", (a, b), {"friction": -0.1}),
        ("friction must be a coefficient or fm.laws.Coulomb", (a, b), {"friction": fm.laws.Stribeck.example()}),
        ("friction must be a law with mu_k > 0", (a, b), {"friction": fm.laws.Coulomb(mu_s=0.3, mu_k=0.0)}),
        ("radius must be given for a drum that turns", (a, b), {"drum": drum}),
        ("drum must turn", (a, b), {"drum": fm.Body("c", mass=1.0), "radius": 1.0}),
        ("when_slack must be 'end' or 'open'", (a, b), {"when_slack": "stop"}),
    ]:
        with pytest.raises(fm.SceneError, match=match):
            fm.Rope("rope", ends, **{**given, **more})
