"""Pads on a face: a wobbling disc by its linear theory in closed form and by an own program of Euler's equations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import fricmb as fm

SPACE = fm.space
#: The wobbling disc: inertia across and axial, thickness, radius of the pads, their spring, the bearing, the speed.
A, C, H, R = 0.16, 0.32, 0.02, 0.13
N0, K, D, KT, DT, SPEED = 3e3, 6e6, 5.0, 1.88e7, 0.1, 50.0


def linear(mu, speed=SPEED, preload=N0):
    """Matrix of the tilts a, b and their rates, from the sum of torques to first order (derived with SymPy)."""
    moment = mu * preload * H**2 / (2 * R)
    damping = [[DT + 2 * D * R**2 + moment / speed, C * speed], [-C * speed - mu * D * H * R, DT]]
    stiffness = [[KT + 2 * K * R**2 + preload * H, moment], [-mu * K * H * R, KT + preload * H]]
    return np.block([
        [np.zeros((2, 2)), np.eye(2)],
        [-np.array(stiffness) / A, -np.array(damping) / A],
    ])  # fmt: skip


def test_critical_friction_is_that_of_hurwitz():
    """The coefficient from Hurwitz's polynomial of fourth degree in mu, with 30 digits."""
    scene = fm.models.wobbling_disc_brake(kick=0.0)
    found = fm.analysis.complex_eigenvalues(scene, over="mu", values=[0.2, 0.6])
    (critical,) = found.critical
    assert critical.value == pytest.approx(0.413829737886213898, rel=1e-10)
    assert critical.frequency == pytest.approx(10926.917070171333497, rel=1e-12)
    assert (critical.kind, critical.unstable_above) == ("flutter", True)
    for value in np.linalg.eigvals(linear(0.6)):
        assert np.abs(found.eigenvalues[-1] - complex(value.real, abs(value.imag))).min() < 1e-11 * abs(value)


def test_critical_speed_is_that_of_the_same_matrices():
    """Over the speed, which is in the drive alone: gyroscopic forces and the slip that friction is divided by."""
    scene = fm.models.wobbling_disc_brake(kick=0.0, mu=0.3)
    (critical,) = fm.analysis.complex_eigenvalues(scene, over="speed", values=[30.0, 200.0]).critical
    values = np.linalg.eigvals(linear(0.3, critical.value))
    assert abs(values.real.max()) < 1e-12 * abs(values).max()


def test_run_grows_as_the_eigenvalue_says():
    """From a kick so small that nothing is left but the linear theory; the growth of a long run beside Re(lambda)."""
    scene = fm.models.wobbling_disc_brake(kick=1e-3, mu=3.0, speed=200.0, preload=300.0)
    sol = fm.simulate(scene, t_end=0.05, rtol=1e-9)
    matrix = linear(3.0, 200.0, preload=300.0)
    t = np.linspace(0.0, 0.05, 11)
    seen = sol.at(t)
    exact = np.array([expm(matrix * s) @ [0.0, 0.0, 1e-3, 0.0] for s in t])
    np.testing.assert_allclose(seen["disc.axis_x"], exact[:, 0], atol=1e-8 * np.abs(exact[:, 1]).max())
    np.testing.assert_allclose(seen["disc.axis_y"], exact[:, 1], atol=1e-7 * np.abs(exact[:, 1]).max())
    values, vectors = np.linalg.eig(matrix)
    grows = int(np.argmax(values.real))
    assert values[grows].real > 5.0
    left = np.linalg.inv(vectors)[grows]
    rates = np.array([seen.velocity("disc.axis_x"), seen.velocity("disc.axis_y")])
    part = np.abs(left @ np.vstack([seen["disc.axis_x"], seen["disc.axis_y"], rates]))
    growth = np.log(part[-1] / part[0]) / t[-1]
    assert growth == pytest.approx(values[grows].real, rel=1e-6)
    assert not sol.events
    assert sol.audit().ok


def pressed(n, n_dot, spin, mu, damping):
    """Normal forces of pads, and the sum of forces and torques on a disc whose centre rests."""
    omega = np.cross(n, n_dot) + spin * n
    loads, force, torque = [], np.zeros(3), np.zeros(3)
    for side in (1.0, -1.0):
        p, m = np.array([R, 0.0, side * H / 2]), side * n
        depth, rate = (H / 2 * m - p) @ m, -p @ (side * n_dot)
        spring = N0 + K * depth
        load = spring * (1 + damping / N0 * rate) if spring > 0.0 else spring
        loads.append(load)
        touch = p + depth * m
        slip = np.cross(omega, touch)
        slip -= (slip @ m) * m
        push = -max(load, 0.0) * (m + mu * slip / np.linalg.norm(slip))
        force, torque = force + push, torque + np.cross(touch, push)
    return np.array(loads), force, torque


@pytest.mark.parametrize(("method", "damping"), [("radau", D), ("radau", 5e2), ("bdf", D)])
def test_pads_lift_off_as_in_a_program_of_eulers_equations(method, damping):
    """A kick that lets the pads lift off and touch again: times, tilts, normal forces, reaction, drive and ledger."""
    mu, kick, end = 0.5, 60.0, 2e-3
    scene = fm.models.wobbling_disc_brake(mu=mu, kick=kick, damping=damping)
    sol = fm.simulate(scene, t_end=end, rtol=1e-9, method=method)

    def rates(t, state):
        n, n_dot = state[:3], state[3:]
        _, _, torque = pressed(n, n_dot, SPEED, mu, damping)
        push = C * SPEED * np.cross(n, n_dot) + np.cross(torque, n)
        push[:2] -= KT * n[:2] + DT * n_dot[:2]
        push /= A
        return [*n_dot, *(push - (push @ n + n_dot @ n_dot) * n)]

    def off(i, t, state):
        return pressed(state[:3], state[3:], SPEED, mu, damping)[0][i]

    watch = [lambda t, y, i=i: off(i, t, y) for i in (0, 1)]
    for w in watch:
        w.terminal = True
    times, t, state = [], 0.0, np.array([0, 0, 1.0, kick, 0, 0])
    while t < end:
        own = solve_ivp(rates, (t, end), state, method="DOP853", rtol=1e-13, atol=1e-15, events=watch)
        both = zip(own.t_events, ("upper", "lower"), strict=True)
        times += [(float(found[0]), name) for found, name in both if found.size]
        t, state = own.t[-1], own.y[:, -1]
        if t < end:  # over the kink
            step = solve_ivp(rates, (t, min(t + 1e-9, end)), state, method="DOP853", rtol=1e-13, atol=1e-15)
            t, state = step.t[-1], step.y[:, -1]
    assert len(times) > 6
    error = 1e-8 if method == "radau" else 3e-6
    assert [event.contact for event in sol.events] == [name for _, name in times]
    assert {event.kind for event in sol.events} == {"open", "close"}
    np.testing.assert_allclose([event.t for event in sol.events], [t for t, _ in times], atol=error * end)
    last = sol.at([end])
    n = np.array([last[f"disc.axis_{c}"][0] for c in "xyz"])
    np.testing.assert_allclose(n, state[:3], atol=10 * error * np.abs(state[:2]).max())
    loads, force, torque = pressed(state[:3], state[3:], SPEED, mu, damping)
    np.testing.assert_allclose(
        [last.normal_force(name)[0] for name in ("upper", "lower")], np.maximum(loads, 0.0), atol=100 * error * N0
    )
    np.testing.assert_allclose(last.reaction("centre")[:, 0], -force, atol=1e3 * error * np.linalg.norm(force))
    np.testing.assert_allclose(last.reaction("drive")[0, 0], -torque @ state[:3], rtol=1e3 * error)
    assert np.abs(sol.energy.residual).max() < 1e-9 * np.ptp(sol.energy.friction_loss)
    assert sol.audit().ok


def plate(kind, mu, law=None):
    """A disc on a ball joint as a rotor and as a rigid body, with one pad beside the axis."""
    if kind == "rotor":
        disc = SPACE.Rotor(
            "disc", mass=2.0, inertia_across=0.05, inertia_axial=0.08, axis=(0, 0, 1), angular_velocity=(0.3, 0.1, 20.0)
        )
    else:
        disc = SPACE.RigidBody("disc", mass=2.0, inertia=(0.05, 0.05, 0.08), angular_velocity=(0.3, 0.1, 20.0))
    centre = SPACE.Spherical("centre", disc)
    pads = [
        SPACE.Pad(name, disc, at=at, normal=(0, 0, side), preload=20.0, stiffness=4e3, damping=2.0,
                  friction=law or fm.laws.Coulomb(mu_s=mu))
        for name, at, side in (
            ("a", (0.2, 0.05, 0.03), 1), ("b", (-0.1, 0.15, -0.01), -1), ("c", (-0.1, -0.2, 0.03), 1)
        )
    ]  # fmt: skip
    return fm.Scene("plate", [disc, centre, *pads])


def test_rotor_and_rigid_body_rub_alike():
    """Two types of bodies with coordinates of their own, down to the stop under three pads."""
    one, other = (fm.simulate(plate(kind, 0.3), t_end=0.3, rtol=1e-9) for kind in ("rotor", "body"))
    axis = other.at(other.t).rotation("disc")[:, 2] if hasattr(other, "rotation") else other["disc.rotation"][:, 2]
    np.testing.assert_allclose(one.at(other.t)["disc.axis"], axis, atol=1e-8)
    np.testing.assert_allclose(one.at(other.t)["disc.omega"], other["disc.omega"], atol=1e-6)
    for name in "abc":
        np.testing.assert_allclose(one.at(other.t).normal_force(name), other.normal_force(name), atol=1e-6)
        np.testing.assert_allclose(one.at(other.t).force(name), other.force(name), atol=2e-6)


def test_block_under_a_pad_sticks_slides_and_breaks_away():
    """A block in a guide pulled by a rising force: it breaks away at mu_s N, and slides with mu_k N."""
    block = SPACE.RigidBody("block", mass=2.0, inertia=(0.1, 0.1, 0.1))
    guide = SPACE.Prismatic("guide", block, axis=(1, 0, 0))
    law = fm.laws.Coulomb(mu_s=0.5, mu_k=0.3)
    pad = SPACE.Pad("pad", block, at=(0, 0, 0.1), normal=(0, 0, 1), preload=8.0, stiffness=1e3, friction=law)
    pull = fm.Force("pull", block, axis="x", value=2.0 * fm.t)
    sol = fm.simulate(fm.Scene("block", [block, guide, pad, pull]), t_end=3.0, rtol=1e-9)
    (event,) = sol.events
    assert event.kind == "slip"
    assert event.t == pytest.approx(2.0, abs=1e-10)
    # m v' = 2 t - mu_k N from t = 2 on
    assert sol.velocity("block.x")[-1] == pytest.approx((3.0**2 - 2.0**2 - 0.3 * 8.0) / 2.0, rel=1e-9)
    np.testing.assert_allclose(sol.normal_force("pad"), 8.0, rtol=1e-12)


def test_smooth_law_lifts_off_with_its_pad():
    """A law without stick has no force either where the pad is off."""
    law = fm.laws.TanhRegularised(mu=0.4, v_reg=1e-2)
    sol = fm.simulate(fm.models.wobbling_disc_brake(kick=60.0, law=law), t_end=1e-3, rtol=1e-8)
    assert any(event.kind == "open" for event in sol.events)
    off = sol.normal_force("upper") == 0.0
    assert off.any()
    np.testing.assert_allclose(sol.force("upper")[:, off], 0.0, atol=1e-13 * N0)
    assert np.abs(sol.energy.residual).max() < 1e-8 * np.ptp(sol.energy.friction_loss)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_pad_beside_a_contact_that_opens(order):
    """A pad has no row among the constraints, a lifted ball loses its own: neither takes the other for itself."""
    disc = SPACE.Rotor("disc", mass=2.0, inertia_across=0.05, inertia_axial=0.08, spin=20.0)
    ball = SPACE.Ball("ball", mass=1.0, radius=0.1, position=(3.0, 0, 0.1), velocity=(1, 0, 0))
    law = fm.laws.Coulomb(mu_s=0.1)
    pair = [
        SPACE.Pad("pad", disc, at=(0.2, 0, 0.01), normal=(0, 0, 1), preload=5.0, stiffness=1e4, friction=law),
        SPACE.OnPlane("floor", ball, normal=(0, 0, 1), push_only=True, when_lost="open", friction=law),
    ]
    parts = [
        disc, ball, SPACE.Revolute("hub", disc, axis=(0, 0, 1)), *(pair[i] for i in order),
        fm.Force("weight", ball, axis="z", value=-9.81 + 20.0 * fm.t),
        fm.Spring("thread", ball, disc, axis="y", stiffness=1e-3),  # one island, nothing moves along y
    ]  # fmt: skip
    sol = fm.simulate(fm.Scene("both", parts), t_end=1.0, rtol=1e-8)
    assert [(event.contact, event.kind) for event in sol.events] == [("floor", "open")]
    lost = 9.81 / 20.0
    assert sol.events[0].t == pytest.approx(lost, abs=1e-10)
    assert sol["ball.z"][-1] == pytest.approx(0.1 + 20.0 * (1.0 - lost) ** 3 / 6, rel=1e-9)
    assert sol.velocity("disc.spin")[-1] == pytest.approx(20.0 - 0.1 * 5.0 * 0.2 / 0.08, rel=1e-9)
    np.testing.assert_allclose(sol.normal_force("pad"), 5.0, rtol=1e-12)


@pytest.mark.parametrize(("kick", "end"), [(1.0, 5e-4), (60.0, 3e-4)])
def test_derivatives_by_numbers_of_the_pads(kick, end):
    """Beside differences of runs, without and with lifting off and touching again."""
    names = {"preload": N0, "stiffness": K, "mu": 0.3}

    def run(rtol, **changed):
        given = {name: fm.parameter(name, changed.get(name, value)) for name, value in names.items() if name != "mu"}
        scene = fm.models.wobbling_disc_brake(kick=kick, mu=changed.get("mu", 0.3), **given)
        return fm.simulate(scene, t_end=end, rtol=rtol, sensitivities=tuple(names) if not changed else ())

    sol = run(1e-10)
    assert len(sol.events) == (0 if kick == 1.0 else 2)
    for name, value in names.items():
        h = 1e-4 * value
        above, below = (run(1e-12, **{name: value + side * h}) for side in (1, -1))
        for motion in ("disc.axis_x", "disc.axis_y"):
            difference = (above[motion][-1] - below[motion][-1]) / (2 * h)
            assert sol.sensitivity(motion, name)[-1] == pytest.approx(difference, rel=2e-5)


def test_what_no_pad_can_press_on_is_refused():
    ball = SPACE.Ball("ball", mass=1.0, radius=0.1)
    disc = SPACE.Rotor("disc", mass=1.0, inertia_across=1.0, inertia_axial=1.0)
    body = SPACE.RigidBody("body", mass=1.0, inertia=(1, 1, 1))
    law = fm.laws.Coulomb(mu_s=0.3)
    given = {"at": (0.1, 0, 0), "preload": 1.0, "stiffness": 1.0, "friction": law}
    refused = [
        (lambda: SPACE.Pad("p", ball, normal=(0, 0, 1), **given), "a body that has directions"),
        (lambda: SPACE.Pad("p", disc, normal=(1, 0, 0), **given), "normal must be along the axis"),
        (lambda: SPACE.Pad("p", disc, body, normal=(0, 0, 1), **given), "a holder that does not turn"),
        (lambda: SPACE.Pad("p", disc, normal=(0, 0, 0), **given), "normal must be"),
        (lambda: SPACE.Pad("p", disc, normal=(0, 0, 1), **given | {"friction": None}), "friction must be"),
        (lambda: SPACE.Pad("p", disc, normal=(0, 0, 1), **given | {"preload": -1.0}), "preload must be"),
        (lambda: SPACE.Pad("p", disc, normal=(0, 0, 1), **given | {"stiffness": 0.0}), "stiffness must be"),
        (lambda: SPACE.DrivenSpin("d", body, speed=1.0), "a must be a Rotor"),
        (lambda: SPACE.DrivenSpin("d", disc, body, speed=1.0), "b must be left out"),
        (lambda: SPACE.DrivenSpin("d", disc, speed=fm.coordinate("disc.x")), "speed"),
    ]
    for make, words in refused:
        with pytest.raises(fm.FricmbError, match=words):
            make()
