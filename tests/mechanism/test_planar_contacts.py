"""Contacts in two directions on bodies that turn: against the reduced equations, and where they come to rest."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

M, J, N, MU, ARM = 1.0, 0.1, 10.0, 0.2, 0.2
START = [0.0, 0.0, 0.0, 1.0, 0.5, 3.0]


def disc(**kinds):
    return fm.RigidBody("disc", mass=M, inertia=J, points={"foot": (ARM, 0.0)}, **kinds)


def slip(y):
    return y[3] - y[5] * ARM * np.sin(y[2]), y[4] + y[5] * ARM * np.cos(y[2])


def sliding(until):
    """The equations of a disc on one foot that slides, until the foot is as slow as ``until``."""

    def rates(_, y):
        g = slip(y)
        fx, fy = (-MU * N * x / np.hypot(*g) for x in g)
        return [*y[3:], fx / M, fy / M, ARM * (np.cos(y[2]) * fy - np.sin(y[2]) * fx) / J]

    def slow(_, y):
        return np.hypot(*slip(y)) - until

    slow.terminal = True
    return solve_ivp(rates, (0, 1), START, method="DOP853", rtol=3e-14, atol=1e-15, dense_output=True, events=slow)


@pytest.mark.parametrize(("method", "rtol", "accuracy"), [("radau", 1e-6, 1e-7), ("radau", 1e-10, 1e-11),
                                                          ("bdf", 1e-8, 1e-9)])  # fmt: skip
def test_a_turning_disc_slides_to_rest_on_one_foot(method, rtol, accuracy):
    body = disc(velocity=(1.0, 0.5), angular_velocity=3.0)
    foot = fm.Contact("foot", body.point("foot"), law=fm.laws.Coulomb(mu_s=0.3, mu_k=MU), normal_force=N)
    sol = fm.simulate(fm.Scene("s", [body, foot]), t_end=0.8, rtol=rtol, method=method)
    exact = sliding(1e-7)
    # what is left of the slip goes in the time that it takes a velocity of 1e-7 to fall by some 10 m/s^2
    assert [event.kind for event in sol.events] == ["stick"]
    np.testing.assert_allclose(sol.events.t[0], exact.t[-1], atol=1e-7)
    times = exact.t[-1] * np.array([0.3, 0.7, 0.95])
    at = sol.at(times)
    for i, name in enumerate(("disc.x", "disc.y", "disc.angle")):
        np.testing.assert_allclose(at[name], exact.sol(times)[i], rtol=0, atol=accuracy)
    # against the slip, with the size that the law says
    g = np.array([slip(y) for y in exact.sol(times).T]).T
    np.testing.assert_allclose(at.force("foot"), -MU * N * g / np.hypot(*g), atol=1e4 * accuracy)
    assert np.abs(sol.energy.residual).max() < 1e2 * accuracy
    # then it turns about the foot, which bears the centrifugal force
    rate = sol.velocity("disc.angle")[-1]
    np.testing.assert_allclose(np.hypot(*sol.force("foot")[:, -1]), M * ARM * rate**2, rtol=1e-6)


def pulled(mu_s, mu_k, force):
    body = fm.RigidBody("b", mass=M, inertia=J, points={"foot": (0.2, 0.1), "hook": (-0.3, 0.2)})
    return fm.Scene("s", [
        body,
        fm.Contact("foot", body.point("foot"), law=fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k), normal_force=N),
        fm.Force("pull", body.point("hook"), axis="y", value=force * fm.t),
    ])  # fmt: skip


@pytest.mark.parametrize("mu_s", [0.2, 0.6])
def test_it_breaks_away_against_what_it_was_held_by(mu_s):
    """The direction of slip is that of an acceleration which depends on it; with mu_s = mu_k it starts from none."""
    sol = fm.simulate(pulled(mu_s, 0.2, 80.0), t_end=1.0, rtol=1e-8)
    assert [event.kind for event in sol.events] == ["slip"]
    t = sol.events.t[0]
    before, after = sol.at([t * (1 - 1e-9)]), sol.at([t * (1 + 1e-6)])
    np.testing.assert_allclose(np.hypot(*before.force("foot")), mu_s * N, rtol=1e-6)
    np.testing.assert_allclose(np.hypot(*after.force("foot")), 0.2 * N, rtol=1e-6)
    after = sol.at([t * 1.01])
    g = after.relative_velocity("foot")
    np.testing.assert_allclose(after.force("foot") / (0.2 * N), -g / np.hypot(*g), atol=1e-6)
    assert np.abs(sol.energy.residual).max() < 1e-6


def test_three_feet_come_to_rest_together():
    """Six rows of rest on three degrees of freedom: forces are not determined, the motion is."""
    body = fm.RigidBody(
        "b", mass=M, inertia=J, velocity=(1.0, 0.3), angular_velocity=4.0,
        points={"p": (0.2, 0.1), "q": (-0.2, 0.1), "e": (0.0, -0.3)},
    )  # fmt: skip
    law = fm.laws.Coulomb(mu_s=0.3, mu_k=0.2)
    feet = [fm.Contact(name, body.point(name), law=law, normal_force=4.0) for name in "pqe"]
    sol = fm.simulate(fm.Scene("s", [body, *feet]), t_end=2.0, rtol=1e-8)
    assert {event.kind for event in sol.events} == {"stick"}
    assert np.abs(sol.v[:, -1]).max() < 1e-12
    np.testing.assert_allclose(sol.energy.friction_loss[-1], 0.5 * (1.0 + 0.09) * M + 0.5 * J * 16.0, rtol=1e-8)


@pytest.mark.parametrize("law", [
    fm.laws.Elliptic(law=fm.laws.Coulomb(mu_s=0.3, mu_k=0.2), ratio=0.5), fm.laws.Stribeck(mu_s=0.4, mu_k=0.2, v_s=0.1),
    fm.laws.LuGre(sigma0=1e3, sigma1=10.0, sigma2=0.0, mu_s=0.3, mu_k=0.2, v_s=0.1),
], ids=lambda law: type(law).__name__)  # fmt: skip
def test_laws_of_two_directions_keep_the_ledger(law):
    belt = fm.Driven("belt", axes="xy", velocity={"x": 1.0})
    body = fm.RigidBody("b", mass=M, inertia=J, points={"p": (0.2, 0.1), "q": (-0.2, 0.1), "e": (-0.3, 0.2)})
    feet = [fm.Contact(name, body.point(name), belt, law=law, normal_force=6.0) for name in "pq"]
    spring = fm.PointSpring("spring", body.point("e"), fm.ground_point(-1.0, 0.0), stiffness=20.0)
    sol = fm.simulate(fm.Scene("s", [body, belt, *feet, spring]), t_end=3.0, rtol=1e-8)
    fine = fm.simulate(fm.Scene("s", [body, belt, *feet, spring]), t_end=3.0, rtol=1e-10)
    assert np.abs(sol.energy.residual).max() < 1e-6
    np.testing.assert_allclose(sol.q[:, -1], fine.q[:, -1], atol=1e-6)


def disc_on_feet(name, feet, x, **motion):
    angles = np.linspace(0.0, 2 * np.pi, feet, endpoint=False) + 0.1
    points = {f"f{i}": (0.2 * np.cos(a), 0.15 * np.sin(a)) for i, a in enumerate(angles)}
    body = fm.RigidBody(name, mass=1.0, inertia=0.02, position=(x, 0.0), points=points, **motion)
    law = fm.laws.Coulomb(mu_s=0.3)
    return body, *(
        fm.Contact(f"{name}_{p}", body.point(p), law=law, normal_force=1.0 + 0.1 * i) for i, p in enumerate(points)
    )


@pytest.mark.parametrize("rtol", [1e-6, 1e-8])
def test_many_feet_come_to_rest_beside_others_that_do_not(rtol):
    """Six feet near rest have a larger system of turns than is solved without LAPACK; four more are not near."""
    slow = disc_on_feet("a", 6, 0.0, velocity=(0.5, 0.2), angular_velocity=1.0)
    fast = disc_on_feet("b", 4, 5.0, velocity=(60.0, 10.0))
    alone, beside = (fm.simulate(fm.Scene("s", parts), t_end=0.8, rtol=rtol) for parts in (slow, slow + fast))
    np.testing.assert_allclose(beside.events.t, alone.events.t, atol=10 * rtol)
    for name in ("a.x", "a.y", "a.angle"):
        assert beside[name][-1] == pytest.approx(alone[name][-1], abs=10 * rtol)
    assert beside.stats.n_rejected < 2 * alone.stats.n_rejected


@pytest.mark.parametrize("along", ["x", "y"])
def test_a_direction_that_a_guide_blocks(along):
    """A body on a guide slips along it alone, though its contact has two directions.

    Closed form: it breaks away at t = 15 from x = 1.5, x = 1 + 0.5 cos(s) + 0.1 sin(s) for s = t - 15, and sticks again
    where its velocity is the belt's, tan(s/2) = -5.
    """
    belt = fm.Driven("belt", velocity={along: 0.1})
    angle = 0.0 if along == "x" else np.pi / 2.0
    body = fm.RigidBody("body", mass=1.0, inertia=1.0, angle=angle, velocity=(0.1, 0.0) if along == "x" else (0.0, 0.1))
    rub = fm.Contact("rub", body, belt, law=fm.laws.Coulomb(mu_s=1.5, mu_k=1.0), normal_force=1.0)
    guide = fm.Prismatic("guide", body, angle=angle)
    parts = [belt, body, guide, fm.Spring("k", body, axis=along, stiffness=1.0), rub]
    for method in ("radau", "bdf"):
        sol = fm.simulate(fm.Scene("guided", parts), t_end=20.0, rtol=1e-8, method=method)
        assert [event.kind for event in sol.events] == ["slip", "stick"]
        assert sol.events.t == pytest.approx([15.0, 15.0 + 2.0 * (np.pi - np.arctan(5.0))], abs=1e-8)
