"""Wheels on rails: creep laws, an axle's critical speed in closed form, hunting, and a program of large angles."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb.scene import LinearForm

sys.path.insert(0, str(Path(__file__).parent))
from cases import DOWN, case

SPACE = fm.space
P, FOUND = case("wheelset")
A0, R0, M, IZ, CREEP = P["half_gauge_a"], P["r0"], P["m"], P["Iz"], {"f11": P["f11"], "f22": P["f22"]}
ARM = 1.0


def axle_scene(speed, law=SPACE.LinearCreep, *, y0=0.0, yaw=0.0, conicity=P["conicity"], backwards=False, **options):
    """An axle on its suspension; ``backwards``: its axis points to the right."""
    V = fm.parameter("V", speed)
    n = np.array([-np.sin(yaw), np.cos(yaw), 0.0]) * (-1.0 if backwards else 1.0)
    end = -1.0 if backwards else 1.0
    axle = SPACE.Rotor(
        "axle", mass=M, inertia_across=IZ, inertia_axial=110.0, position=(0, y0, R0), axis=n, spin=end * speed / R0,
        stations={"left": end * A0, "right": -end * A0, "front": end * ARM, "back": -end * ARM},
    )  # fmt: skip
    creep = law(**CREEP | options, speed=V)
    wheels = [
        SPACE.WheelRail(
            side, axle.station(side), through=(0, y, 0), rolling_radius=R0, conicity=fm.parameter("conicity", conicity),
            speed=V, friction=creep,
        )
        for side, y in (("left", A0), ("right", -A0))
    ]  # fmt: skip
    springs = [
        fm.Spring(name, axle.station(name), axis="x", stiffness=P["kpsi"] / (2 * ARM**2)) for name in ("front", "back")
    ]
    return fm.Scene("axle", [axle, *wheels, *springs, fm.Spring("ky", axle, axis="y", stiffness=P["ky"]), DOWN])


def linear_matrix(V, conicity, creep=CREEP):
    """Of y and yaw, their rates: the textbook's equations (Knothe and Stichel, chapter 9)."""
    f1, f2 = 2 * creep["f11"], 2 * creep["f22"]
    return np.array([
        [0, 0, 1, 0],
        [0, 0, 0, 1],
        [-P["ky"] / M, f2 / M, -f2 / V / M, 0],
        [-f1 * A0 * conicity / R0 / IZ, -P["kpsi"] / IZ, 0, -f1 * A0**2 / V / IZ],
    ])  # fmt: skip


@pytest.mark.parametrize(
    ("law", "backwards", "options"),
    [
        (SPACE.LinearCreep, True, {}),
        (SPACE.ShenHedrickElkins, False, {"mu": 0.3}),
    ],
)
def test_critical_speed_is_that_of_the_closed_form(law, backwards, options):
    scene = axle_scene(60.0, law, backwards=backwards, **options)
    found = fm.analysis.complex_eigenvalues(scene, over="V", values=[70.0, 110.0])
    (critical,) = found.critical
    assert critical.value == pytest.approx(float(FOUND["critical_speed"]), rel=1e-9)
    assert critical.frequency == pytest.approx(float(FOUND["omega_critical"]), rel=1e-9)
    assert (critical.kind, critical.unstable_above) == ("flutter", True)
    # the modes of y and yaw are the textbook's, beside those of running along and spinning
    for value in np.linalg.eigvals(linear_matrix(110.0, P["conicity"])):
        assert np.abs(found.eigenvalues[-1] - complex(value.real, abs(value.imag))).min() < 1e-8 * abs(value)


def test_polach_is_linear_at_rest_of_slip_for_one_coefficient_alone():
    """His force is against slip, that of the linear theory is not: with two coefficients it has no derivative."""
    options = {"mu": 0.3, "A": 0.5, "B": 0.6}
    with pytest.raises(fm.FricmbError, match="'left' has no derivative where it does not slip"):
        fm.analysis.complex_eigenvalues(axle_scene(60.0, SPACE.Polach, **options), over="V", values=[70.0, 110.0])
    one = dict.fromkeys(("f11", "f22"), 8e6)
    scene = axle_scene(60.0, SPACE.Polach, **options, **one)
    (critical,) = fm.analysis.complex_eigenvalues(scene, over="V", values=[70.0, 110.0]).critical
    values = np.linalg.eigvals(linear_matrix(critical.value, P["conicity"], one))
    assert abs(values.real.max()) < 1e-9 * abs(values).max()


def test_stability_over_speed_and_conicity():
    speeds, conicities = np.linspace(40, 160, 4), np.linspace(0.02, 0.2, 3)
    found = fm.analysis.stability_map(axle_scene(60.0), over=("V", "conicity"), values=[speeds, conicities])
    growth = np.array([
        [np.linalg.eigvals(linear_matrix(V, c)).real.max() for c in conicities] for V in speeds
    ])  # fmt: skip
    unstable = growth > 0.0
    assert unstable.any()
    assert not unstable.all()
    np.testing.assert_array_equal(found.unstable, unstable)
    np.testing.assert_allclose(found.growth[unstable], growth[unstable], rtol=1e-8)


@dataclass(frozen=True, eq=False)
class LinearWheel(fm.Joint):
    """A wheel in the linear kinematics of the reference: y and yaw small, the load constant."""

    slip_rows: ClassVar[int] = 2
    takes_friction: ClassVar[bool] = True
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "holds")
    side: Any = 1.0
    V: Any = 1.0
    holds: Any = "z"

    def local_coordinates(self):
        """Displacement, yaw and what the wheel holds."""
        return tuple(LinearForm.of({f"axle.{name}": 1.0}) for name in ("y", "turn_z", self.holds))

    def drives(self):
        """The way along the rail."""
        return (("rate", self.V, 0.0),)

    def define_constraint(self, x):
        """One wheel the height, the other the roll."""
        return (x[2],)

    def define_slip(self, x):
        """Creepage times speed."""
        return (0, -self.side * A0, 0, -self.side * P["conicity"] * x[0] / R0), (1, 0, 0, -x[1])

    def define_load(self, x, lam):
        """Constant."""
        return P["normal_force_per_wheel"] + 0 * lam[0]


@pytest.mark.parametrize(("rtol", "error"), [(1e-8, 1e-8), (1e-10, 1e-9)])
def test_shen_hedrick_elkins_gives_the_certified_run(rtol, error):
    V = P["V_transient"]
    body = SPACE.Ball("axle", mass=M, radius=0.1, inertia=IZ, position=(0, P["y0"], 0))
    law = SPACE.ShenHedrickElkins(mu=P["mu"], **CREEP, speed=V)
    both = [
        LinearWheel(name, body, side=side, V=V, holds=holds, friction=law)
        for name, side, holds in (("left", 1.0, "z"), ("right", -1.0, "turn_x"))
    ]
    springs = [
        fm.Spring("ky", body, axis="y", stiffness=P["ky"]),
        Turned("kpsi", body, stiffness=P["kpsi"]),
    ]
    sol = fm.simulate(fm.Scene("reference", [body, *both, *springs]), t_end=1.0, rtol=rtol)
    for t in (0.5, 1.0):
        seen = sol.at([t])
        motion = [seen["axle.y"], seen["axle.turn_z"], seen.velocity("axle.y"), seen.velocity("axle.turn_z")]
        np.testing.assert_allclose(np.ravel(motion), FOUND[f"y_psi_yd_psid_at_{t:g}"], rtol=error)
    assert np.abs(sol.energy.residual).max() < 1e-7 * np.ptp(sol.energy.friction_loss)


@dataclass(frozen=True, eq=False)
class Turned(fm.Element):
    """A spring against yaw, which is an angle in linear kinematics alone."""

    body: Any
    stiffness: Any

    def local_coordinates(self):
        """Yaw."""
        return (LinearForm.of({"axle.turn_z": 1.0}),)

    def define_potential(self, x):
        """Quadratic."""
        return self.stiffness * x[0] ** 2 / 2


@pytest.mark.parametrize(("rtol", "error"), [(1e-6, 1e-6), (1e-9, 1e-9)])
def test_axle_at_large_angles_against_an_own_program(rtol, error):
    """Hunting beyond what is linear: every wheel slides at times, its load from roll balance and gyroscopic torque."""
    V, mu, C = 120.0, 0.3, 110.0
    scene = axle_scene(V, SPACE.ShenHedrickElkins, mu=mu, y0=0.02, yaw=0.05)
    weight = 2 * P["normal_force_per_wheel"]
    down = fm.Force("load", scene["axle"], axis="z", value=M * 9.81 - weight)
    scene = fm.Scene("axle", [*scene.parts, down])
    sol = fm.simulate(scene, t_end=0.4, rtol=rtol)

    def creep(u1, u2, N):
        a, b = P["f11"] * u1 / V, P["f22"] * u2 / V
        e = np.hypot(a, b) / (mu * N)
        part = 1 - e / 3 + e**2 / 27 if e < 3 else 1 / e
        return -part * a, -part * b

    def rates(t, state):
        x, y, yaw, _, vx, vy, w, s = state
        n, run = np.array([-np.sin(yaw), np.cos(yaw)]), np.array([np.cos(yaw), np.sin(yaw)])
        loads = np.full(2, weight / 2)
        for _ in range(30):
            force, moment, along, roll = np.array([0.0, -P["ky"] * y]), 0.0, 0.0, C * s * w
            for side, N in zip((1.0, -1.0), loads, strict=True):
                r = R0 + P["conicity"] * side * (y + side * A0 * n[1] - side * A0)
                slip = np.array([vx + V, vy]) - side * A0 * w * run - r * s * run
                f1, f2 = creep(slip @ run, slip @ n, N)
                force = force + f1 * run + f2 * n
                moment -= side * A0 * f1
                along -= r * f1
                roll += r * f2
            loads = weight / 2 - np.array([1.0, -1.0]) * roll / (2 * A0)
        for side in (1.0, -1.0):
            pull = -P["kpsi"] / (2 * ARM**2) * (x + side * ARM * n[0])
            force[0] += pull
            moment -= side * ARM * n[1] * pull
        return [vx, vy, w, s, *(force / M), moment / IZ, along / C]

    start = [0, 0.02, 0.05, 0, 0, 0, 0, V / R0]
    exact = solve_ivp(rates, (0, 0.4), start, method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
    seen = [sol["axle.x"][-1], sol["axle.y"][-1], -sol["axle.axis_x"][-1], sol.velocity("axle.y")[-1] / 100]
    np.testing.assert_allclose(seen, [exact[0], exact[1], np.sin(exact[2]), exact[5] / 100], atol=error)
    assert sol["axle.spin"][-1] == pytest.approx(exact[3], abs=100 * error)
    assert sol.audit().ok


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_steps_end_where_the_law_saturates(method):
    """A wheel in linear kinematics that is braked across saturation, by a force that rises: creepage is its answer."""
    law = SPACE.ShenHedrickElkins(mu=0.3, f11=8e6, f22=8e6, speed=50.0)
    block = SPACE.Ball("block", mass=10.0, radius=1.0, inertia=1e12, position=(0, 0, 1))
    rail = SPACE.OnPlane("rail", block, normal=(0, 0, 1), friction=law)
    push = fm.Force("push", block, axis="x", value=40.0 * fm.t)
    sol = fm.simulate(fm.Scene("pushed", [block, rail, push, DOWN]), t_end=1.0, rtol=1e-9, method=method)
    limit = 0.3 * 10.0 * 9.81
    slip = sol.relative_velocity("rail")[0]
    switch = 3 * limit - 8e6 * np.abs(slip) / 50.0
    (crossing,) = np.flatnonzero(np.diff(np.sign(switch)) != 0)
    near = np.abs(switch[crossing : crossing + 2]).min()
    assert near < 1e-6 * limit  # a step ends there
    assert not sol.events

    def rates(t, y):
        e = 8e6 * y[0] / 50.0 / limit
        return [(40.0 * t - limit * (e - e**2 / 3 + e**3 / 27 if e < 3 else 1.0)) / 10.0]

    own = solve_ivp(rates, (0, 1.0), [0.0], method="Radau", rtol=1e-11, atol=1e-16).y[0, -1]
    assert slip[-1] == pytest.approx(own, rel=1e-7)


def test_laws_are_what_their_papers_say():
    u = np.array([[0.02, -0.3, 1.5], [0.05, 0.4, -2.0]])
    N, V = 60e3, 40.0
    linear = -np.array([[CREEP["f11"]], [CREEP["f22"]]]) * u / V
    np.testing.assert_allclose(SPACE.LinearCreep(**CREEP, speed=V).force(u, N), linear)
    she = SPACE.ShenHedrickElkins(mu=0.3, **CREEP, speed=V).force(u, N)
    e = np.linalg.norm(linear, axis=0) / (0.3 * N)
    assert e[0] < 3 < e[2]
    size = np.where(e < 3, e - e**2 / 3 + e**3 / 27, 1.0) * 0.3 * N
    np.testing.assert_allclose(she, linear / np.linalg.norm(linear, axis=0) * size, rtol=1e-12)
    options = {"k_A": 0.8, "k_S": 0.4, "A": 0.4, "B": 0.6}
    polach = SPACE.Polach(mu=0.3, **CREEP, speed=V, **options).force(u, N)
    w = np.linalg.norm(u, axis=0)
    mu = 0.3 * (0.6 * np.exp(-0.6 * w) + 0.4)
    e = np.pi / 4 * np.linalg.norm(linear, axis=0) / (mu * N)
    size = 2 * mu * N / np.pi * (0.8 * e / (1 + (0.8 * e) ** 2) + np.arctan(0.4 * e))
    np.testing.assert_allclose(polach, -u / w * size, rtol=1e-12)
    # both begin as the linear theory, and give nothing without load
    small = 1e-7 * u
    for law in (SPACE.ShenHedrickElkins(mu=0.3, **CREEP, speed=V), SPACE.Polach(mu=0.3, **CREEP, speed=V)):
        along = np.diag(small[:, 2])  # Polach's direction is that of slip
        np.testing.assert_allclose(np.diag(law.force(along, N)), 1e-7 * linear[:, 2], rtol=1e-5)
        np.testing.assert_allclose(law.force(u, 0.0), 0.0, atol=1e-9)
        np.testing.assert_array_equal(law.force(np.zeros((2, 1)), N), 0.0)


def test_kalker_table_joins_his_asymptotes():
    """For thin ellipses across the rolling direction his table tends to closed forms; between entries it is smooth."""
    for poisson in (0.0, 0.25, 0.4):
        thin = SPACE.kalker(a=0.1, b=1.0, shear_modulus=1.0, poisson=poisson)
        assert thin.c11 == pytest.approx(np.pi**2 / (4 * (1 - poisson)), rel=0.03)
        assert thin.c22 == pytest.approx(np.pi**2 / 4, rel=0.03)
        assert thin.c33 == pytest.approx(np.pi**2 / (16 * 0.1 * (1 - poisson)), rel=0.05)
    # without Poisson's ratio both directions are alike in his theory
    for ratio in np.geomspace(0.1, 10.0, 40):
        found = SPACE.kalker(a=ratio, b=1.0, shear_modulus=2.0, poisson=0.0)
        assert found.c11 == pytest.approx(found.c22, rel=1e-12)
        assert found.f11 == pytest.approx(2.0 * ratio * found.c11)
        assert found.f23 == pytest.approx(2.0 * ratio**1.5 * found.c23)
    for poisson in (0.0, 0.25, 0.5):
        all_of = [SPACE.kalker(a=r, b=1.0, shear_modulus=1.0, poisson=poisson) for r in np.geomspace(0.1, 10.0, 200)]
        for name in ("c22", "c23"):
            assert (np.diff([getattr(one, name) for one in all_of]) > 0).all()
        assert (np.diff([one.c33 for one in all_of]) < 0).all()


def test_what_cannot_roll_is_refused():
    axle = SPACE.Rotor("axle", mass=1.0, inertia_across=1.0, inertia_axial=1.0, axis=(0, 1, 0), stations={"l": 1.0})
    body = SPACE.RigidBody("box", mass=1.0, inertia=(1, 1, 1))
    given = {"through": (0, 1, -1), "rolling_radius": 1.0}
    refused = [
        (lambda: SPACE.WheelRail("w", axle, **given), "beside its middle"),
        (lambda: SPACE.WheelRail("w", body, **given), "a station of a fm.space.Rotor"),
        (lambda: SPACE.WheelRail("w", axle.station("l"), body, **given), "the rail is fixed"),
        (lambda: SPACE.WheelRail("w", axle.station("l"), **given, along=(0, 1, 0)), "lies along the rail"),
        (lambda: SPACE.WheelRail("w", axle.station("l"), **given, along=(1, 0, 1)), "at right angles"),
        (lambda: SPACE.WheelRail("w", axle.station("l"), through=(0, 1, 0), rolling_radius=-1.0), "must be"),
        (lambda: SPACE.kalker(a=1.0, b=0.05, shear_modulus=1.0, poisson=0.3), "a/b must be from 0.1 to 10"),
        (lambda: SPACE.kalker(a=1.0, b=1.0, shear_modulus=1.0, poisson=0.6), "poisson must be from 0 to 0.5"),
        (lambda: SPACE.LinearCreep(f11=1.0, f22=1.0, speed=0.0), "speed"),
    ]
    for make, words in refused:
        with pytest.raises(fm.FricmbError, match=words):
            make()
