"""Laws with kinks in a joint: beside an own program, as exact as was asked for."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb import models

M, INERTIA, LENGTH, RADIUS, GRAVITY, T = 1.3, 0.2, 0.7, 0.2, 9.81, 2.0


def dahl(v, z):
    """Force over the load, and the rate of the state."""
    return -200.0 * z[0], [v - 400.0 * abs(v) * z[0]]


def linear(v, z):
    """The same of a straight line to a limit."""
    return -0.4 * min(1.0, max(-1.0, v / 1e-2)), []


CASES = {
    "Dahl": (dahl, 1, fm.laws.Dahl(sigma0=200.0, mu=0.5)),
    "LinearRegularised": (linear, 0, fm.laws.LinearRegularised(mu=0.4, v_reg=1e-2)),
}


def swing(law, n_z):
    """Angle and rate of a pendulum on a pin under a law, whose load is found at every instant by iteration."""

    def rate(t, y):
        angle, w = y[:2]
        per_load, z_rate = law(RADIUS * w, y[2:])
        a, last = 0.0, np.inf
        while abs(a - last) > 1e-15 * (1.0 + abs(a)):
            last = a
            load = M * np.hypot(LENGTH * w**2 + GRAVITY * np.cos(angle), LENGTH * a + GRAVITY * np.sin(angle))
            torque = RADIUS * per_load * load - M * GRAVITY * LENGTH * np.sin(angle)
            a = torque / (INERTIA + M * LENGTH**2)
        return [w, a, *z_rate]

    run = solve_ivp(rate, (0.0, T), [1.2, 0.0] + [0.0] * n_z, method="DOP853", rtol=1e-12, atol=1e-14, max_step=1e-3)
    return run.y[0, -1], run.y[1, -1]


@pytest.mark.parametrize("name", CASES)
def test_as_exact_as_asked_for(name):
    law, n_z, declared = CASES[name]
    angle, w = swing(law, n_z)
    scene = models.dry_pendulum(
        mass=M, inertia=INERTIA, length=LENGTH, radius=RADIUS, angle=1.2, gravity=GRAVITY, law=declared
    )
    for method in ("radau", "bdf"):
        for rtol in (1e-6, 1e-8, 1e-10):
            sol = fm.simulate(scene, t_end=T, rtol=rtol, method=method)
            assert sol.q[-1, -1] + np.pi / 2 == pytest.approx(angle, abs=10.0 * rtol)
            assert sol.v[-1, -1] == pytest.approx(w, abs=10.0 * rtol)


def threlfall(r):
    return 0.4 * (1.0 - np.exp(-3.0 * min(1.0, r / 1e-3)))


def ambrosio(r):
    return 0.4 * min(1.0, max(0.0, (r - 1e-4) / (1e-3 - 1e-4)))


CORNERS = {
    "Threlfall": (threlfall, fm.laws.Threlfall(mu=0.4, v_reg=1e-3)),
    "LinearRegularised": (lambda r: 0.4 * min(1.0, r / 1e-3), fm.laws.LinearRegularised(mu=0.4, v_reg=1e-3)),
    "Ambrosio": (ambrosio, fm.laws.Ambrosio(mu=0.4, v_0=1e-4, v_1=1e-3)),
}


def drag(mu, belt, times):
    """Positions of a unit mass on a unit spring and a belt that it starts with, under a unit load."""

    def rate(t, y):
        slip = y[1] - belt
        return [y[1], -y[0] - np.sign(slip) * mu(abs(slip))]

    options = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15, "max_step": 2e-3}
    return solve_ivp(rate, (0.0, times[-1]), [0.0, belt], t_eval=times, **options).y[0]


@pytest.mark.parametrize("name", CORNERS)
def test_a_law_that_turns_between_two_stages_beside_an_idle_body(name):
    mu, law = CORNERS[name]
    times = np.linspace(0.1, 12.0, 60)
    want = drag(mu, 0.1, times)
    parts = models.belt_oscillator(law=law).parts
    beside = fm.Scene("beside", [*parts, fm.RigidBody("idle", mass=1.0, inertia=1.0)])
    for scene in (fm.Scene("alone", parts), beside):
        for rtol in (1e-4, 1e-6, 1e-8):
            sol = fm.simulate(scene, t_end=12.0, rtol=rtol, method="radau")
            assert np.abs(sol.at(times)["mass.x"] - want).max() < 5.0 * rtol * np.abs(want).max()


@pytest.mark.parametrize("name", ["Karnopp", "Iwan", "Gonthier", "Dahl"])
def test_states_that_move_nothing_cost_no_steps_beside_an_idle_body(name):
    """Newton's method solves for states, too: what it left of one that fades kept steps at the rate of its fading."""
    parts = models.belt_oscillator(law=getattr(fm.laws, name).example()).parts
    beside = fm.Scene("beside", [*parts, fm.RigidBody("idle", mass=1.0, inertia=1.0)])
    alone, other = (
        fm.simulate(scene, t_end=12.0, rtol=1e-6, method="radau") for scene in (fm.Scene("alone", parts), beside)
    )
    assert other.stats.n_steps < 2 * alone.stats.n_steps
    times = np.linspace(0.1, 12.0, 60)
    apart = np.abs(alone.at(times)["mass.x"] - other.at(times)["mass.x"]).max()
    assert apart < 2e-6 * np.abs(alone.at(times)["mass.x"]).max()


def test_speed_of_a_plate_is_no_round_off_of_rest():
    """A fault creeps at 1.2 nm/s under stresses of MPa; v' = 0 where load and friction balance, for 10^6 s almost."""
    a, b, L, f_0, sigma, start = 0.01, 0.015, 8e-3, 0.6, 5e7, 1.2e-9
    psi = np.log(1e-6 / start)
    law = fm.laws.RateAndState(mu_0=f_0, a=a, b=b, L=L, v_0=1e-6, v_rest=1e-14)
    k = 0.3 * sigma * (b - a) / L
    held = sigma * (f_0 + a * np.log(start / 1e-6) + b * psi)
    fault = fm.Body("fault", mass=1e4, velocity={"x": start})
    plate = fm.Driven("plate", velocity={"x": 1e-9}, position={"x": held / k})
    still = fm.RigidBody("still", mass=1.0, inertia=1.0)
    spring = fm.Spring("k", fault, plate, axis="x", stiffness=k)
    rubs = fm.Contact("c", fault, law=law, normal_force=sigma)
    scene = fm.Scene("fault", [fault, plate, still, fm.Fixed("fixed", still), spring, rubs])
    sol = fm.simulate(scene, t_end=1e6, rtol=1e-6, method="radau", initial={"state": {"c": [psi]}})
    # quasi-static: a v'/v + b psi' = -k (v - V)/sigma, with psi' of the aging law
    rates = lambda t, y: [  # noqa: E731
        y[0] / a * (-k * (y[0] - 1e-9) / sigma - b * (1e-6 * np.exp(-y[1]) - y[0]) / L),
        (1e-6 * np.exp(-y[1]) - y[0]) / L,
    ]
    want = solve_ivp(rates, (0.0, 1e6), [start, psi], method="LSODA", rtol=1e-10, atol=[1e-20, 1e-12]).y[0, -1]
    assert sol.velocity("fault.x")[-1] == pytest.approx(want, rel=1e-5)
