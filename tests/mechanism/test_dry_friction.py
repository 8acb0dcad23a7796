"""Friction of constant size in joints: arms and guides against reduced equations of own programs."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

M, L, I, G = 2.0, 0.5, 0.1, 9.81
TIGHT = {"rtol": 1e-12, "atol": 1e-13, "method": "DOP853"}


def arm(angle, **more):
    at = (L * math.sin(angle), -L * math.cos(angle))
    return fm.RigidBody("arm", mass=M, inertia=I, position=at, angle=angle, points={"pin": (0.0, L)}, **more)


def swing(angle, torque):
    """Turns of an arm under the friction torque ``torque(angle, rate, direction)``, until it stays."""
    t, found = 0.0, []
    while True:
        s = -math.copysign(1.0, math.sin(angle))
        stops = lambda t, y: y[1]  # noqa: E731
        stops.terminal, stops.direction = True, -s
        run = solve_ivp(
            lambda t, y, s=s: [y[1], (-M * G * L * math.sin(y[0]) - s * torque(y[0], y[1], s)) / (I + M * L * L)],
            (t, t + 20.0), [angle, 0.0], events=stops, first_step=1e-3, **TIGHT,
        )  # fmt: skip
        t, angle = run.t[-1], run.y[0, -1]
        found.append((t, angle))
        if M * G * L * abs(math.sin(angle)) <= torque(angle, 0.0, 0.0):
            return np.array(found).T


def test_arm_with_a_constant_torque_in_its_joint():
    start = math.radians(80.0)
    body = arm(start)
    pin = fm.Revolute("pin", body.point("pin"))
    scene = fm.Scene("arm", [body, pin, fm.DryFriction("dry", body, axis=pin, static=3.0), fm.Gravity("g")])
    times, angles = swing(start, lambda angle, rate, s: 3.0)
    sol = fm.simulate(scene, t_end=times[-1] + 1.0, rtol=1e-9)
    assert [e.kind for e in sol.events] == ["reversal"] * (times.size - 1) + ["stick"]
    np.testing.assert_allclose(sol.events.t, times, rtol=0, atol=1e-10)
    np.testing.assert_allclose(sol.at(times)["arm.angle"], angles, rtol=0, atol=1e-10)
    # what it holds at rest is the weight's torque
    assert sol.force("dry")[0, -1] == pytest.approx(M * G * L * math.sin(angles[-1]), rel=1e-8)
    assert np.abs(sol.energy.residual).max() < 1e-9
    assert sol.audit().ok


def test_stribeck_and_viscous_torque_and_that_of_the_load_on_one_joint():
    """A robot's joint: Stribeck and viscous torque, and a loss by the load of the bearing."""
    start, mu, r = 1.2, 0.3, 0.05
    law = fm.laws.Stribeck(mu_s=0.8, mu_k=0.5, v_s=0.3, viscous=0.06)
    body = arm(start)
    pin = fm.Revolute("pin", body.point("pin"), radius=r, friction=fm.laws.Coulomb(mu_s=mu))
    scene = fm.Scene("arm", [body, pin, fm.DryFriction("dry", body, axis=pin, law=law), fm.Gravity("g")])

    def load(angle, rate, a):
        return M * math.hypot(L * a + G * math.sin(angle), L * rate**2 + G * math.cos(angle))

    def acceleration(angle, rate, s):
        own = s * float(law.coefficient(abs(rate)))
        defect = lambda a: (I + M * L * L) * a + M * G * L * math.sin(angle) + own + s * mu * r * load(angle, rate, a)  # noqa: E731
        return brentq(defect, -300.0, 300.0, xtol=1e-14, rtol=1e-15)

    t, angle, found = 0.0, start, []
    for _ in range(3):
        s = -math.copysign(1.0, math.sin(angle))
        stops = lambda t, y: y[1]  # noqa: E731
        stops.terminal, stops.direction = True, -s
        run = solve_ivp(
            lambda t, y, s=s: [y[1], acceleration(y[0], y[1], s)], (t, t + 9.0), [angle, 0.0], events=stops,
            first_step=1e-3, **{**TIGHT, "rtol": 1e-10, "atol": 1e-11},
        )  # fmt: skip
        t, angle = run.t[-1], run.y[0, -1]
        found.append((t, angle))
    times, angles = np.array(found).T
    sol = fm.simulate(scene, t_end=times[-1], rtol=1e-8)
    turned = [e.t for e in sol.events if e.contact == "dry"]
    np.testing.assert_allclose(turned[:2], times[:2], rtol=0, atol=1e-8)
    np.testing.assert_allclose(sol.at(times)["arm.angle"], angles, rtol=0, atol=1e-8)


def test_both_together_hold_up_to_their_sum():
    wheel = fm.RigidBody("wheel", mass=2.0, inertia=0.5)
    pin = fm.Revolute("pin", wheel, radius=0.2, friction=fm.laws.Coulomb(mu_s=0.5, mu_k=0.4))
    dry = fm.DryFriction("dry", wheel, axis=pin, static=0.3, kinetic=0.25)
    parts = [wheel, pin, dry, fm.Gravity("g", acceleration={"y": -1.5}), fm.Torque("drive", wheel, value=fm.t)]
    sol = fm.simulate(fm.Scene("wheel", parts), t_end=1.0)
    limit, slip = 0.2 * 0.5 * 3.0 + 0.3, 0.2 * 0.4 * 3.0 + 0.25
    assert [(e.kind, e.t) for e in sol.events] == [("slip", pytest.approx(limit, rel=1e-9))] * 2
    rate = ((1.0 - limit**2) / 2 - slip * (1.0 - limit)) / 0.5
    assert sol.velocity("wheel.angle")[-1] == pytest.approx(rate, rel=1e-9)


def two_links(limits, t_end):
    """Two links with constant torques in both joints, from level; tries which of the joints hold."""
    D, m, l = np.array([[1.0, 0.0], [-1.0, 1.0]]), M, L

    def accelerations(q, w, mode):
        c, s = math.cos(q[0] - q[1]), math.sin(q[0] - q[1])
        A = np.array([[I + 5 * m * l * l, 2 * m * l * l * c], [2 * m * l * l * c, I + m * l * l]])
        b = np.array([
            -2 * m * l * l * s * w[1] ** 2 - 3 * m * G * l * math.cos(q[0]),
            2 * m * l * l * s * w[0] ** 2 - m * G * l * math.cos(q[1]),
        ]) + D.T @ (-np.array(limits) * mode)  # fmt: skip
        W = D[[j for j in (0, 1) if mode[j] == 0]]
        z = np.linalg.solve(np.block([[A, -W.T], [W, np.zeros((len(W), len(W)))]]), np.append(b, np.zeros(len(W))))
        held = dict(zip([j for j in (0, 1) if mode[j] == 0], z[2:], strict=True))
        return z[:2], held

    def event(j, mode):
        def of(t, y):
            if mode[j]:
                return (D @ y[2:])[j] * mode[j]
            return limits[j] - abs(accelerations(y[:2], y[2:], mode)[1][j])

        of.terminal, of.direction = True, -1
        return of

    t, y, rest, events = 0.0, np.zeros(4), [True, True], []
    while True:
        speed = D @ y[2:]
        for mode in itertools.product(*[(0, 1, -1) if rest[j] else (int(np.sign(speed[j])),) for j in (0, 1)]):
            a, held = accelerations(y[:2], y[2:], mode)
            starts = D @ a
            if all(
                abs(held[j]) <= limits[j] * (1 - 1e-10) if mode[j] == 0 else mode[j] * starts[j] > 0
                for j in (0, 1) if rest[j]
            ):  # fmt: skip
                break
        run = solve_ivp(
            lambda t, y, mode=mode: np.concatenate([y[2:], accelerations(y[:2], y[2:], mode)[0]]), (t, t_end), y,
            events=[event(0, mode), event(1, mode)], **TIGHT,
        )  # fmt: skip
        t, y = run.t[-1], run.y[:, -1].copy()
        if run.status == 0:
            return y, events
        for j in (0, 1):
            if len(run.t_events[j]):
                rest[j] = True
                events.append((j, bool(mode[j]), t))
            elif mode[j]:
                rest[j] = False
        if rest[0] and len(run.t_events[0]) and mode[0]:
            y[2] = 0.0
        if rest[1] and len(run.t_events[1]) and mode[1]:
            y[3] = y[2]


def test_two_links_with_constant_torques():
    first = fm.RigidBody("a", mass=M, inertia=I, position=(L, 0.0), points={"p": (-L, 0.0), "q": (L, 0.0)})
    second = fm.RigidBody("b", mass=M, inertia=I, position=(3 * L, 0.0), points={"p": (-L, 0.0)})
    pins = [fm.Revolute("j1", first.point("p")), fm.Revolute("j2", second.point("p"), first.point("q"))]
    dry = [
        fm.DryFriction("d1", first, axis=pins[0], static=3.0), fm.DryFriction("d2", second, axis=pins[1], static=2.0),
    ]  # fmt: skip
    t_end = 2.0
    sol = fm.simulate(fm.Scene("2R", [first, second, *pins, *dry, fm.Gravity("g")]), t_end=t_end, rtol=1e-9)
    y, events = two_links((3.0, 2.0), t_end)
    np.testing.assert_allclose([sol["a.angle"][-1], sol["b.angle"][-1]], y[:2], rtol=0, atol=1e-7)
    stops = [(("d1", "d2")[j], t) for j, stop, t in events if stop]
    found = [(e.contact, e.t) for e in sol.events if e.kind in ("stick", "reversal")]
    assert [name for name, _ in found] == [name for name, _ in stops]
    np.testing.assert_allclose([t for _, t in found], [t for _, t in stops], rtol=0, atol=1e-7)


@pytest.mark.parametrize(("along", "right"), [("angle", (0.15 * 0.36 + 0.2 * 0.64) * 3.0 / 1.5), ("slide", 3.0)])
def test_in_space_along_and_about_a_tilted_axis(along, right):
    axis = (0.0, 0.6, 0.8)
    start = {"velocity" if along == "slide" else "angular_velocity": (0.0, 1.8, 2.4)}
    body = fm.space.RigidBody("b", mass=1.5, inertia=(0.1, 0.15, 0.2), **start)
    joint = (fm.space.Prismatic if along == "slide" else fm.space.Revolute)("j", body, axis=axis)
    dry = fm.space.DryFriction("dry", body, axis=joint, static=1.5)
    sol = fm.simulate(fm.Scene("s", [body, joint, dry]), t_end=right + 1.0, rtol=1e-8)
    assert [(e.kind, e.t) for e in sol.events] == [("stick", pytest.approx(right, rel=1e-9))]
    assert sol.audit().ok


def test_sensitivity_to_the_limit():
    """Of the angle at which the arm stays, and of when, against differences."""
    start = math.radians(80.0)
    body = arm(start)
    pin = fm.Revolute("pin", body.point("pin"))
    scene = fm.Scene("arm", [body, pin, fm.DryFriction("dry", body, axis=pin, static=3.0), fm.Gravity("g")])
    sol = fm.simulate(scene, t_end=2.0, rtol=1e-9, sensitivities=("dry.law.mu_s",))
    (t_up, up), (t_low, low) = (np.array(swing(start, lambda *_, c=c: c))[:, -1] for c in (3.001, 2.999))
    assert sol.sensitivity("arm.angle", "dry.law.mu_s")[-1] == pytest.approx((up - low) / 0.002, rel=1e-4)
    assert sol.events[-1].sensitivity("dry.law.mu_s") == pytest.approx((t_up - t_low) / 0.002, rel=1e-4)


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("size", [1.0, 1e9, 1e12])
def test_friction_without_a_load_turns_with_slip_in_any_unit_of_force(method, size):
    """A torque of twice the friction brakes at 3 until t = w/3, then turns back at 1."""
    w, t_end = 5.0, 6.0
    arm = fm.RigidBody("arm", mass=size, inertia=size, angular_velocity=w)
    dry = fm.DryFriction("dry", arm, axis="angle", static=size)
    drive = fm.Torque("drive", arm, value=-2.0 * size)
    sol = fm.simulate(fm.Scene("s", [arm, fm.Revolute("pin", arm), dry, drive]), t_end=t_end, rtol=1e-8, method=method)
    assert [e.kind for e in sol.events] == ["reversal"]
    assert sol.events[0].t == pytest.approx(w / 3, rel=1e-9)
    assert sol["arm.angle"][-1] == pytest.approx(w**2 / 6 - (t_end - w / 3) ** 2 / 2, rel=1e-9)
    assert sol.audit().ok
