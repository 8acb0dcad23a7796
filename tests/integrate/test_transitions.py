"""Transitions of one contact, point by point, against closed forms and certified references.

The workhorse is a puck of unit mass under a constant force a and friction c = mu_k N.  With v its speed, theta its
direction from the force, u = tan(theta/2), p = c/a:  v sin(theta) = C u^p,  t = (C/2a) [U(u0) - U(u)],
U(u) = u^(p-1)/(p-1) + u^(p+1)/(p+1).
"""

import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

_spec = importlib.util.spec_from_file_location("reference", Path(__file__).parents[1] / "reference.py")
reference = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(reference)

METHODS = pytest.mark.parametrize("method", ["bdf", "radau", "collocation"])
TURN = 0.7  # no direction below lies along an axis


def turned(along, across, angle=TURN):
    """Components in x and y of a vector given along and across a direction."""
    c, s = math.cos(angle), math.sin(angle)
    return (c * along - s * across, s * along + c * across)


def puck(force, velocity, *, mu_s=1.0, mu_k=None, normal_force=1.0, masses=None, stiffness=(0.0, 0.0), position=(0, 0)):
    """A puck on a rough plane: unit mass, or other masses along x and y."""
    body = fm.Body(
        "puck", mass=1.0, axes="xy", position=dict(zip("xy", position, strict=True)),
        velocity=dict(zip("xy", velocity, strict=True)),
    )  # fmt: skip
    parts = [fm.Force(f"f{axis}", body, axis=axis, value=value) for axis, value in zip("xy", force, strict=True)]
    parts += [fm.Spring(f"k{axis}", body, axis=axis, stiffness=k) for axis, k in zip("xy", stiffness, strict=True)]
    if masses is not None:
        parts.append(fm.MatrixElement("more", ["puck.x", "puck.y"], M=np.diag(np.subtract(masses, 1.0))))
    law = fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)
    return fm.Scene("puck", [body, *parts, fm.Contact("sole", body, law=law, normal_force=normal_force)])


def kinds(sol):
    return [event.kind for event in sol.events]


def slope_state(a, c, along, across, t):
    """Velocity along and across the force at t, by the formulas above."""
    p = c / a
    speed = math.hypot(along, across)
    # tan(theta/2) without cancellation where the start is nearly against the force
    u0 = (speed - along) / across
    C = across / u0**p

    def U(u):
        return u ** (p - 1) / (p - 1) + u ** (p + 1) / (p + 1)

    log_u = brentq(lambda x: C / (2 * a) * (U(u0) - U(math.exp(x))) - t, -200.0, math.log(u0), xtol=1e-15)
    u = math.exp(log_u)
    return C * u**p * (1 - u * u) / (2 * u), C * u**p


def in_arc_time(masses, stiffness, c, q, v, force=(0.0, 0.0)):
    """Time and place of rest of a slipping puck, in arc time dt = r ds with r and the angle of v as unknowns."""
    masses, stiffness, force = np.asarray(masses), np.asarray(stiffness), np.asarray(force)

    def rate(_, y):
        r = math.exp(y[4])
        n = np.array([math.cos(y[3]), math.sin(y[3])])
        a = (force - stiffness * y[1:3] - c * n) / masses
        return [r, *(r * r * n), a[1] * n[0] - a[0] * n[1], a @ n]

    def slow(_, y):
        return y[4] - math.log(1e-12)

    slow.terminal = True
    start = [0.0, *q, math.atan2(v[1], v[0]), math.log(math.hypot(*v))]
    y = solve_ivp(rate, (0, 1e5), start, method="DOP853", rtol=1e-12, atol=1e-13, events=slow).y[:, -1]
    return y[0], y[1:3]


# 1 slip -> stick ------------------------------------------------------------------------------------------------------


@METHODS
@pytest.mark.parametrize("ratio", [1e-3, 0.05, 0.25, 0.5, 0.8])
@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
def test_1_landing_with_a_singular_direction(method, ratio, rtol):
    # thrown across the force the direction turns like (t* - t)^p up to the very end
    sol = fm.simulate(puck(turned(ratio, 0), turned(0, 1)), t_end=3.0, rtol=rtol, method=method)
    assert kinds(sol) == ["stick"]
    assert sol.events[0].t == pytest.approx(1 / (1 - ratio**2), abs=100 * rtol)
    p = 1 / ratio
    rest = turned(1 / (4 * ratio * (p * p - 1)), 2 * p / (ratio * (4 * p * p - 1)))
    assert sol.q[:, -1] == pytest.approx(rest, abs=100 * rtol)
    assert not sol.v[:, -1].any()


@METHODS
@pytest.mark.parametrize("case", ["1", "2", "5"])
def test_1_landing_in_the_brake(method, case):
    ref = reference.load(f"p1_{case}")
    sol = fm.simulate(fm.models.brake4dof(case), t_end=700.0, rtol=1e-8, t_eval=ref["t"], method=method)
    assert kinds(sol) == [("stick", "slip")[code] for code in ref["type_event"]]
    assert np.abs(sol.events.t - ref["t_event"]).max() < 1e-5


@METHODS
@pytest.mark.parametrize("masses", [(1.0, 1.0), (1.0, 3.0), (5.0, 0.7)])
def test_1_landing_where_the_compliance_is_no_multiple_of_one(method, masses):
    stiffness, q, v = (1.0, 2.3), (0.3, -0.1), (0.2, 0.9)
    scene = puck((0, 0), v, masses=masses, stiffness=stiffness, position=q)
    sol = fm.simulate(scene, t_end=12.0, rtol=1e-9, method=method)
    t, place = in_arc_time(masses, stiffness, 1.0, q, v)
    assert np.hypot(*(np.array(stiffness) * place)) < 1.0  # it stays where it lands
    assert kinds(sol) == ["stick"]
    assert sol.events[0].t == pytest.approx(t, abs=1e-7)
    assert sol.q[:, -1] == pytest.approx(place, abs=1e-7)


# 2 the direction need not settle --------------------------------------------------------------------------------------


@METHODS
@pytest.mark.parametrize("ratio", [0.91, 0.95, 0.995, 0.9999])
def test_2_marginal_stick(method, ratio):
    stop = 1 / (1 - ratio**2)
    sol = fm.simulate(puck(turned(ratio, 0), turned(0, 1)), t_end=1.5 * stop, rtol=1e-8, method=method)
    assert kinds(sol) == ["stick"]
    # time and way grow without bound as the ratio goes to 1, and errors with them
    assert sol.events[0].t == pytest.approx(stop, rel=1e-6 * stop)
    assert np.hypot(*sol.force("sole")[:, -1]) == pytest.approx(ratio, rel=1e-9)


@METHODS
@pytest.mark.parametrize("masses", [None, (1.0, 3.0)])
def test_2_a_path_that_hits_rest_exactly_sticks(method, masses):
    # between the cones: mu_k N < |a| < mu_s N; straight against the force along x
    scene = puck((0.8, 0), (-1, 0), mu_s=1.0, mu_k=0.6, masses=masses)
    sol = fm.simulate(scene, t_end=3.0, rtol=1e-8, method=method)
    assert kinds(sol) == ["stick"]
    assert sol.events[0].t == pytest.approx(1 / 1.4, abs=1e-9)
    assert sol.force("sole")[:, -1] == pytest.approx([-0.8, 0.0], abs=1e-12)


@METHODS
@pytest.mark.parametrize("miss", [1e-1, 1e-2, 1e-3])
def test_2_a_path_that_misses_rest_turns_and_slips_on(method, miss):
    scene = puck(turned(0.8, 0), turned(-1, miss), mu_s=1.0, mu_k=0.6)
    sol = fm.simulate(scene, t_end=3.0, rtol=1e-8, method=method)
    assert kinds(sol) == []
    assert sol.v[:, -1] == pytest.approx(turned(*slope_state(0.8, 0.6, -1, miss, 3.0)), abs=1e-6)


# 3 a turn at small r is not a stick -----------------------------------------------------------------------------------


@METHODS
@pytest.mark.parametrize("miss", [1e-1, 1e-3, 1e-5, 1e-7, 1e-9])
def test_3_a_turn_at_tiny_speed_is_no_stick(method, miss):
    # |a| = 2 c: the speed falls to some miss^1.5, down to 1e-14 of the start
    scene = puck(turned(1.0, 0), turned(-1, miss), mu_s=0.5)
    sol = fm.simulate(scene, t_end=2.0, rtol=1e-8, method=method)
    assert "stick" not in kinds(sol)
    assert sol.v[:, -1] == pytest.approx(turned(*slope_state(1.0, 0.5, -1, miss, 2.0)), abs=1e-6)


@METHODS
@pytest.mark.parametrize(
    ("name", "friction", "position", "velocity"),
    [
        ("a", 0.3, (2.0, 0.0), (0.0, 1.7)),
        ("b", 0.1, (2.0, 0.0), (0.0, 1e-2)),
        ("d", 0.05, (2.0, 0.3), (0.0, 1e-4)),
    ],
)
def test_3_passes_close_to_rest_against_a_reference(method, name, friction, position, velocity):
    ref = reference.load(f"p5_{name}")
    scene = fm.models.planar_oscillator(friction=friction, position=position, velocity=velocity)
    sol = fm.simulate(scene, t_end=float(ref["t"][-1]), rtol=1e-8, t_eval=ref["t"], method=method)
    assert kinds(sol) == ["stick"]
    assert sol.events[0].t == pytest.approx(float(ref["info"]["rest_time"]), abs=1e-5)
    q, v = reference.errors(ref, sol.q, sol.v)
    assert max(*q, *v) < 1e-6


# 4 the last snap ------------------------------------------------------------------------------------------------------


@METHODS
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9])
def test_4_event_times_carry_no_snap_size(method, rtol):
    # a straight line is exact to both methods but for round-off (which bdf's growing steps magnify): all that is left
    # is how the landing is finished
    sol = fm.simulate(puck(turned(0.3, 0), turned(1, 0)), t_end=2.0, rtol=rtol, method=method)
    exact = {"bdf": 1e-10, "radau": 1e-13, "collocation": 1e-13}[method]
    assert kinds(sol) == ["stick"]
    assert sol.events[0].t == pytest.approx(1 / 0.7, abs=exact)
    assert sol.q[:, -1] == pytest.approx(turned(0.5 / 0.7, 0), abs=exact)


@METHODS
@pytest.mark.parametrize("ratio", [0.25, 0.8])
def test_4_event_times_follow_the_tolerance(method, ratio):
    scene = puck(turned(ratio, 0), turned(0, 1))
    errors = [
        abs(fm.simulate(scene, t_end=5.0, rtol=rtol, method=method).events[0].t - 1 / (1 - ratio**2))
        for rtol in (1e-5, 1e-8, 1e-11)
    ]
    assert errors[1] < 1e-6
    assert errors[2] < 1e-10
    assert errors[2] < max(errors[0], 1e-9) * 1e-2


@pytest.mark.parametrize("phase", [0.55, 0.75, 0.8])
@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_a_short_excess_of_the_load_between_two_steps_is_seen(method, phase):
    """Some 5 ms above mu_s N of a load that was just below it at the peaks before; mu_s is 20 mu_k."""

    def load(t):
        return 2.0 * (1.0 + 2e-5) * np.sin(1.7 * t - 2.0 - phase) * (1.0 - 0.5 * np.exp(-t))

    body = fm.Body("m", mass=1.0)
    pull = 2.0 * (1.0 + 2e-5) * sympy.sin(1.7 * fm.t - 2.0 - phase) * (1 - sympy.exp(-fm.t) / 2)
    law = fm.laws.Coulomb(mu_s=2.0, mu_k=0.1)
    scene = fm.Scene(
        "load", [body, fm.Force("pull", body, axis="x", value=pull), fm.Contact("c", body, law=law, normal_force=1.0)]
    )
    t = np.linspace(0.0, 12.0, 240001)
    above = int(np.argmax(np.abs(load(t)) > 2.0))
    first = brentq(lambda at: abs(load(at)) - 2.0, t[above - 1], t[above], xtol=1e-14)
    sol = fm.simulate(scene, t_end=12.0, rtol=1e-6, method=method)
    assert sol.events[0].kind == "slip"
    assert sol.events[0].t == pytest.approx(first, abs=1e-5)
