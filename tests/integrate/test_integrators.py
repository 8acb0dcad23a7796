"""Every integrator: its contract, failures, order, energy, dense output, nonlinear scenes."""

import importlib.util
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb.integrate import Integrator, integrators

_spec = importlib.util.spec_from_file_location("reference", Path(__file__).parents[1] / "reference.py")
reference = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(reference)

METHODS = pytest.mark.parametrize("method", ["bdf", "radau"])
#: Those that take two-dimensional contacts (the others have tests of their own).
EVERY = pytest.mark.parametrize("name", [name for name in integrators if name != "taylor"])


def options(name):
    return {"method": name} if integrators[name].adaptive else {"method": name, "step": 1e-3}


@EVERY
def test_every_integrator_keeps_the_contract(name):
    kind = integrators[name]
    assert issubclass(kind, Integrator)
    assert kind.name == name
    assert kind.order
    assert kind.takes <= {"linear", "ports", "nonlinear", "constraints"}
    assert kind() == kind()
    assert name in fm.integrators
    sol = fm.simulate(fm.models.puck_on_belt(), t_end=1.0, rtol=1e-6, **options(name))
    assert (sol.stats.method, sol.t[0], sol.t[-1]) == (name, 0.0, 1.0)
    assert (np.diff(sol.t) >= 0).all()
    assert sol.stats.n_steps > 0
    assert [event.kind for event in sol.events] == ["stick"]
    # a fixed step finds the instant of rest to within one of its steps
    assert sol.events[0].t == pytest.approx(math.hypot(1.0, 1.5) / (0.25 * 9.81), abs=2e-3)


@dataclass(frozen=True, kw_only=True)
class Falling(fm.FrictionLaw):
    """Friction that falls without end: it would drive where it has become negative."""

    mu_s: float
    slope: float

    def define_coefficient(self, r):
        return self.mu_s - self.slope * r


@pytest.mark.parametrize("name", [name for name in integrators if name not in ("taylor", "collocation")])
def test_a_negative_coefficient_is_a_failure_with_its_part(name):
    # mu(r) = 0.5 - 0.1 r is 0 at r = 5; a force drives the mass there
    law = Falling(mu_s=0.5, slope=0.1)
    body = fm.Body("m", mass=1.0, velocity={"x": 1.0})
    push = fm.Force("f", body, axis="x", value=2.0)
    scene = fm.Scene("driven", [body, push, fm.Contact("c", body, law=law, normal_force=1.0)])
    with pytest.raises(fm.IntegrationError, match="negative") as caught:
        fm.simulate(scene, t_end=20.0, rtol=1e-6, **options(name))
    partial = caught.value.partial
    assert np.isfinite(partial.q).all()
    assert 4.0 < partial.v[0, -1] < 5.01
    assert partial.t_end == pytest.approx(caught.value.t, rel=0.5)


@EVERY
def test_output_at_given_times_is_the_dense_output(name):
    scene = fm.models.planar_oscillator(friction=0.3, velocity=(0.0, 1.7))
    times = np.linspace(0.0, 10.0, 77)
    free = fm.simulate(scene, t_end=10.0, rtol=1e-7, **options(name))
    asked = fm.simulate(scene, t_end=10.0, rtol=1e-7, t_eval=times, **options(name))
    np.testing.assert_allclose(free(times), np.vstack([asked.q, asked.v]), rtol=0, atol=1e-12)
    np.testing.assert_allclose(free(free.t[::7])[:2], free.q[:, ::7], rtol=0, atol=1e-12)


def test_the_published_scheme_has_order_two():
    ref = reference.load("p1_2")
    # before the first transition, where nothing but the formula makes the error
    inside = ref["t"] < 0.9 * ref["t_event"][0]
    grid = ref["t"][inside]
    errors = []
    for step in (2e-3, 1e-3):
        sol = fm.simulate(
            fm.models.brake4dof("2"), t_end=float(grid[-1]), method="bdf2-paper", step=step, t_eval=grid
        )  # fmt: skip
        errors.append(np.abs(sol["pad.x"] - ref["q"][inside, 0]).max())
    assert 3.4 < errors[0] / errors[1] < 4.6


def test_the_published_scheme_agrees_with_the_reference():
    ref = reference.load("p1_2")
    sol = fm.simulate(fm.models.brake4dof("2"), t_end=700.0, method="bdf2-paper", step=1e-2, t_eval=ref["t"])
    q, _ = reference.errors(ref, sol.q, sol.v)
    assert q[1] < 1e-2


SCENES = {
    "brake 1": (lambda: fm.models.brake4dof("1"), 100.0),
    "brake 2": (lambda: fm.models.brake4dof("2"), 100.0),
    "brake 5": (lambda: fm.models.brake4dof("5"), 100.0),
    "belt": (lambda: fm.models.belt_oscillator(damping=0.05), 60.0),
    "free": (lambda: fm.models.friction_oscillator(x0=2.7), 40.0),
    "planar": (lambda: fm.models.planar_oscillator(), 40.0),
    "puck": (lambda: fm.models.puck_on_belt(), 1.0),
    "stack": (lambda: fm.models.block_stack(), 0.7),
    "chain": (lambda: fm.models.stick_slip_chain(5), 20.0),
}


@METHODS
@pytest.mark.parametrize("name", SCENES)
def test_the_energy_ledger_closes(name, method):
    make, t_end = SCENES[name]
    sol = fm.simulate(make(), t_end=t_end, rtol=1e-8, method=method)
    assert np.abs(sol.energy.residual).max() < 1e-6
    loss = sol.energy.friction_loss
    assert np.diff(loss).min() > -1e-12 * loss.max()  # to the round-off of sums


# nonlinear scenes -----------------------------------------------------------------------------------------------------


def nonlinear(kind):
    """A scene that does not stick, its right-hand side v' written by hand, and the span."""
    mass = fm.Body("m", mass=1.0, axes="xy", position={"x": 1.0, "y": 0.4}, velocity={"x": 0.0, "y": 1.0})
    start = [1.0, 0.4, 0.0, 1.0]
    if kind == "point spring":
        parts = [fm.PointSpring("s", mass, stiffness=20.0, length=1.0), fm.PointDamper("d", mass, damping=0.3)]

        def f(t, q, v):
            r = np.hypot(*q)
            return -(20.0 * (r - 1.0) + 0.3 * (q @ v) / r) * q / r

    elif kind == "cubic":
        parts = [
            fm.Spring("x", mass, axis="x", stiffness=1.0, cubic=3.0), fm.Spring("y", mass, axis="y", stiffness=2.0),
        ]  # fmt: skip

        def f(t, q, v):
            return np.array([-q[0] - 3 * q[0] ** 3, -2 * q[1]])

    elif kind == "force":
        x, vy = fm.coordinate("m.x"), fm.speed("m.y")
        parts = [fm.Force("fx", mass, axis="x", value=-sympy.sin(3 * x) + sympy.cos(fm.t)),
                 fm.Force("fy", mass, axis="y", value=-0.2 * vy**3 - x * fm.coordinate("m.y"))]  # fmt: skip

        def f(t, q, v):
            return np.array([-np.sin(3 * q[0]) + np.cos(t), -0.2 * v[1] ** 3 - q[0] * q[1]])

    else:
        normal = 1.0 + 0.5 * sympy.sin(2 * fm.t)
        parts = [fm.Spring("x", mass, axis="x", stiffness=4.0), fm.Spring("y", mass, axis="y", stiffness=9.0)]
        parts.append(fm.Contact("c", mass, law=fm.laws.Coulomb(mu_s=0.1), normal_force=normal, axes="xy"))

        def f(t, q, v):
            return -np.array([4.0, 9.0]) * q - 0.1 * (1 + 0.5 * np.sin(2 * t)) * v / np.hypot(*v)

    return fm.Scene(kind, [mass, *parts]), lambda t, y: [*y[2:], *f(t, y[:2], y[2:])], start


@METHODS
@pytest.mark.parametrize("kind", ["point spring", "cubic", "force", "varying normal force"])
def test_a_nonlinear_scene(kind, method):
    scene, rate, start = nonlinear(kind)
    true = solve_ivp(rate, (0, 3.0), start, method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    errors = [
        np.abs(fm.simulate(scene, t_end=3.0, rtol=rtol, method=method)(3.0) - true).max()
        for rtol in (1e-4, 1e-7, 1e-10)
    ]
    assert errors[0] < 1e-1
    assert errors[1] < 1e-4
    assert errors[2] < 1e-7
    # linear between ports, or as good as exact at any tolerance
    assert errors[2] < max(errors[0], 1e-11)


@METHODS
def test_a_normal_spring_opens_and_closes(method):
    # a mass thrown up from a compliant floor: free flight under the preload, then the floor again
    k, preload, v0 = 100.0, 1.0, 0.5
    mass = fm.Body("m", mass=1.0, axes="xy", velocity={"x": 1.0, "y": v0})
    law = fm.laws.Coulomb(mu_s=0.3)
    contact = fm.Contact("c", mass, law=law, normal_force=fm.normal.Spring(axis="y", stiffness=k, preload=preload))
    sol = fm.simulate(fm.Scene("hop", [mass, contact]), t_end=1.03, rtol=1e-9, method=method)
    w, gap = 10.0, preload / k
    up = math.asin(gap * w / v0) / w
    speed = v0 * math.cos(w * up)
    assert [event.kind for event in sol.events] == ["open", "close"]
    assert sol.events.t == pytest.approx([up, up + 2 * speed / preload], abs=1e-8)
    assert not sol.force("c")[0, (sol.t > up + 1e-6) & (sol.t < up + 2 * speed / preload - 1e-6)].any()
    # the impulse of N, from what it did across, is what friction took 0.3 of
    impulse = speed - v0 + preload * up
    assert sol(up + 0.1)[2] == pytest.approx(1.0 - 0.3 * impulse, abs=1e-8)


@METHODS
def test_lugre_creeps_and_breaks_away(method):
    # after Rabinowicz: a mass pulled through a spring at a steady speed
    law = fm.laws.LuGre(sigma0=1e5, sigma1=math.sqrt(1e5), sigma2=0.4, mu_s=1.5, mu_k=1.0, v_s=1e-3)
    mass, hand = fm.Body("m", mass=1.0), fm.Driven("hand", velocity={"x": 0.1})
    spring = fm.Spring("k", mass, hand, axis="x", stiffness=2.0)
    scene = fm.Scene("pulled", [mass, hand, spring, fm.Contact("c", mass, law=law, normal_force=1.0)])
    sol = fm.simulate(scene, t_end=25.0, rtol=1e-9, method=method)
    assert sol["m.x"][-1] == pytest.approx(1.9088391992256, abs=1e-6)
    assert sol.state("c")[0, -1] == pytest.approx(1.18167954559e-5, rel=1e-5)
    assert not len(sol.events)
