"""Derivatives of mechanisms and of bodies in space: an own program, closed forms, differences of runs."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb import models

from .differences import said, shares_off, worst

PENDULUM = {"mass": 1.3, "inertia": 0.2, "length": 0.7, "radius": 0.05, "mu": 0.6, "gravity": 9.81}


def swing(mass, inertia, length, radius, mu, gravity, swings):
    """Times at which a pendulum on a dry pin turns round; its pin's load found at every instant by iteration."""

    def rate(t, y, sign):
        angle, w = y
        a = 0.0
        for _ in range(60):
            load = mass * np.hypot(length * w**2 + gravity * np.cos(angle), length * a + gravity * np.sin(angle))
            torque = -mass * gravity * length * np.sin(angle) - mu * radius * load * sign
            a = torque / (inertia + mass * length**2)
        return [w, a]

    t, y, found = 0.0, [1.2, 0.0], []
    for k in range(swings):
        def turns(t, y, sign):
            return y[1]

        turns.terminal, turns.direction = True, 1.0 if k % 2 == 0 else -1.0
        run = solve_ivp(
            rate, (t, t + 3.0), y, method="DOP853", rtol=1e-12, atol=1e-13, args=(-1.0 if k % 2 == 0 else 1.0,),
            events=turns,
        )  # fmt: skip
        t, y = float(run.t_events[0][-1]), run.y_events[0][-1]
        found.append(t)
    return np.array(found)


@pytest.mark.parametrize(
    ("name", "own"), [("pin.friction.mu_s", "mu"), ("pin.radius", "radius"), ("arm.inertia", "inertia")]
)
def test_dry_pendulum(name, own):
    """Reactions jump where it turns round, and with them the friction."""
    step = 1e-4 * PENDULUM[own]
    times = [swing(**{**PENDULUM, own: PENDULUM[own] + k * step}, swings=2) for k in (-2, -1, 1, 2)]
    expected = (times[0] - 8.0 * times[1] + 8.0 * times[2] - times[3]) / (12.0 * step)
    sol = fm.simulate(models.dry_pendulum(**PENDULUM, angle=1.2), t_end=2.5, rtol=1e-9, sensitivities=(name,))
    assert [event.kind for event in sol.events] == ["reversal", "reversal"]
    found = np.array([event.sensitivity(name) for event in sol.events])
    assert found == pytest.approx(expected, rel=1e-6)
    assert sol.unsafe_events == ()


def large_top():
    """Moments of inertia that differences may change."""
    return models.heavy_top(mass=5.0, inertia_across=0.2, inertia_axial=0.25, reach=0.4, spin=12.0)


def skidding():
    """A ball on a turntable under regularised friction, which lets it creep."""
    return models.turntable(law=fm.laws.TanhRegularised(mu=0.3, v_reg=0.01), velocity=(1.3, 0.2))


@pytest.mark.parametrize(
    ("make", "names", "t_end"),
    [
        (models.four_bar, ("coupler.inertia", "motor.value"), 0.3),
        (models.slider_crank, ("slider.mass", "crank.angular_velocity"), 0.08),
        (models.painleve_rod, ("tip.friction.mu_s", "rod.angular_velocity"), 1.0),
        (models.heavy_top, ("top.mass", "gravity.acceleration.z"), 0.3),
        (large_top, ("top.inertia_axial", "top.inertia_across"), 0.3),
        (skidding, ("table.turning", "ball.velocity.x"), 1.0),
    ],
)
def test_against_differences(make, names, t_end):
    """Loops of links; a rod whose point slips, turns round, sticks and slips; a top in space."""
    found = worst(make(), names, rtol=1e-8, t_end=t_end)
    assert set(found) == set(names)
    assert max(found.values()) < 1e3


LAWS = {
    "Coulomb": fm.laws.Coulomb(mu_s=0.3, mu_k=0.2),
    "HyperbolicStribeck": fm.laws.HyperbolicStribeck.example(),
    "LuGre": fm.laws.LuGre(sigma0=200.0, sigma1=0.0, sigma2=0.1, mu_s=0.3, mu_k=0.2, v_s=0.1),
    "Stribeck": fm.laws.Stribeck(mu_s=0.3, mu_k=0.2, v_s=0.1),
}


@pytest.mark.parametrize(
    ("make", "law", "names", "t_end"),
    [
        (models.rolling_coin, "Coulomb", ("coin.mass", "floor.friction.mu_k"), 1.0),
        (models.rolling_coin, "LuGre", ("floor.friction.sigma2",), 0.5),
        (models.billiard, "Stribeck", ("gravity.acceleration.z", "cloth.friction.mu_s"), 1.0),
        (models.ball_in_cylinder, "HyperbolicStribeck", ("gravity.acceleration.z", "tube.friction.mu_k"), 0.8),
        (models.dry_ball_joint, "Stribeck", ("hook.radius", "bob.mass"), 1.0),
        (models.rising_top, "Coulomb", ("table.friction.mu_k", "gravity.acceleration.z"), 0.15),
    ],
)
def test_laws_of_bodies_in_space(make, law, names, t_end):
    """To a thousand tolerances, or to what a note says."""
    start = {
        models.rolling_coin: {"angle": 1.0, "rates": (9.0, 1.5, -2.5)},
        models.ball_in_cylinder: {"rise": 1.0},
        models.rising_top: {"spin": 150.0},
    }.get(make, {})
    sol = fm.simulate(make(law=LAWS[law], **start), t_end=t_end, rtol=1e-8, sensitivities=names)
    off = shares_off(sol, names, steps=(5e-4,), t_end=t_end)
    assert off
    assert max(off.values()) < max([1e3 * 1e-8, *said(sol)]), (off, sol.stats.notes)


def test_ball_that_slides_until_it_rolls():
    """What rolls keeps 5/7 of its speed; it slides for a time that goes like 1/mu."""
    names = ("cloth.friction.mu_s", "ball.velocity.x")
    sol = fm.simulate(models.billiard(), t_end=2.0, rtol=1e-9, sensitivities=names)
    (event,) = sol.events
    mu = sol.scene.parameters["cloth.friction.mu_s"]
    assert event.sensitivity("cloth.friction.mu_s") == pytest.approx(-event.t / mu, rel=1e-8)
    assert sol.sensitivity("ball.x.velocity", "ball.velocity.x")[-1] == pytest.approx(5.0 / 7.0, rel=1e-9)
    assert sol.sensitivity("ball.x.velocity", "cloth.friction.mu_s")[-1] == pytest.approx(0.0, abs=1e-8)


def test_block_that_slides_to_rest():
    """Without other forces slip ends in the direction that it has had: t = m |v|/(mu N)."""
    block = fm.Body("block", mass=1.3, axes="xy", velocity={"x": 0.4, "y": 0.3})
    rub = fm.Contact("rub", block, law=fm.laws.Coulomb(mu_s=0.5), normal_force=1.0, axes="xy")
    names = ("block.mass", "block.velocity.x", "rub.law.mu_s")
    sol = fm.simulate(fm.Scene("puck", [block, rub]), t_end=2.0, rtol=1e-9, sensitivities=names)
    assert [sol.events[0].sensitivity(name) for name in names] == pytest.approx([1.0, 2.08, -2.6], rel=1e-9)
    end = [sol.sensitivity("block.x", name)[-1] for name in names]
    assert end == pytest.approx([0.2, 1.066, -0.52], rel=1e-9)


def test_start_that_does_not_fit():
    """Joints move a start that does not fit; by what changes positions there, that is not differentiated."""
    scene = models.dry_pendulum().with_parameters({"arm.angle": -0.3})
    with pytest.raises(fm.SceneError, match="moved to satisfy the joints"):
        fm.simulate(scene, t_end=0.1, sensitivities=("arm.angle",))
    fm.simulate(scene, t_end=0.1, sensitivities=("arm.mass",))


def test_coordinates_that_hardly_move_do_not_set_the_steps():
    """A wheelset: a coordinate that stays at round-off beside one that turns five times."""
    scene = models.wheelset()
    found = worst(scene, ("conicity",), rtol=1e-8, step=5e-3, t_end=0.03)
    assert found["conicity"] < 1e3
    sol = fm.simulate(scene, t_end=0.1, rtol=1e-8, sensitivities=("conicity",))
    (tangent,) = sol.run.__dict__["_tangents"].values()
    assert tangent.mesh.t.size < 20 * sol.t.size


def test_states_that_hardly_move_do_not_set_the_steps():
    """A ball in a tube: its bristle bends along the tube's axis, across it by round-off alone."""
    sol = fm.simulate(models.ball_in_cylinder(law=LAWS["LuGre"], rise=1.0), t_end=0.6, sensitivities=("ball.mass",))
    (tangent,) = sol.run.__dict__["_tangents"].values()
    assert tangent.mesh.t.size < 50 * sol.t.size
