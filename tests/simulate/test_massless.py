"""Bodies without mass: sliders, and quasi-dynamic blocks, against programs of their own."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

M, K, C, LIMIT, PUSH, W = 1.0, 4.0, 10.0, 0.5, 2.0, 1.3


def jenkins(mass=0.0, turned=False, **more):
    """A mass on a spring, with a spring and a slider in series beside it."""
    body, slider = fm.Body("b", mass=M), fm.Body("slider", mass=mass)
    law = fm.laws.Coulomb(mu_s=0.25)
    spring = fm.Spring("k", slider, body, axis="x", stiffness=C) if turned else fm.Spring(
        "k", body, slider, axis="x", stiffness=C
    )
    return fm.Scene("jenkins", [
        body, slider, spring, fm.Contact("rub", slider, law=law, normal_force=LIMIT / 0.25),
        fm.Spring("K", body, axis="x", stiffness=K), fm.Force("f", body, axis="x", value=PUSH * sympy.sin(W * fm.t)),
        *more.values(),
    ])  # fmt: skip


def own_jenkins(t_end):
    """Position and speed at the end, elongation, and the times at which the slider sets out and stops."""
    t, y, e, sense, changes = 0.0, [0.0, 0.0], 0.0, 0.0, []
    while True:
        if sense == 0.0:
            rates = lambda t, y: [y[1], (PUSH * np.sin(W * t) - K * y[0] - C * y[2]) / M, y[1]]  # noqa: E731
            ends = [lambda t, y: y[2] - LIMIT / C, lambda t, y: y[2] + LIMIT / C]
            ends[0].direction, ends[1].direction = 1, -1
            start = [*y, e]
        else:
            rates = lambda t, y: [y[1], (PUSH * np.sin(W * t) - K * y[0] - sense * LIMIT) / M]  # noqa: E731, B023
            ends = [lambda t, y: y[1] * sense]  # noqa: B023
            ends[0].direction = -1
            start = y
        for end in ends:
            end.terminal = True
        found = solve_ivp(rates, (t, t_end), start, rtol=1e-12, atol=1e-13, events=ends, method="DOP853")
        t, y = float(found.t[-1]), list(found.y[:2, -1])
        e = float(found.y[2, -1]) if sense == 0.0 else sense * LIMIT / C
        if found.status == 0:
            return y, e, changes
        changes.append(t)
        sense = float(np.sign(e)) if sense == 0.0 else 0.0


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize("turned", [False, True])
def test_a_slider_without_mass_is_a_jenkins_element(method, turned):
    sol = fm.simulate(jenkins(turned=turned), t_end=20.0, rtol=1e-9, method=method)
    y, e, changes = own_jenkins(20.0)
    assert len(changes) > 10
    assert sol["b.x"][-1] == pytest.approx(y[0], abs=1e-8)
    assert sol.velocity("b.x")[-1] == pytest.approx(y[1], abs=1e-8)
    assert sol.state("rub")[0, -1] == pytest.approx(e, abs=1e-8)
    assert np.abs(sol.force("rub")).max() == pytest.approx(LIMIT, rel=1e-8)
    assert any("without mass is a slider" in note for note in sol.stats.notes)
    assert sol.audit().ok


def test_work_over_a_cycle_is_that_of_the_closed_form():
    """Driven to and fro by A the element takes 4 F (A - F/k) in each cycle, from the second on."""
    A = 0.3
    hand = fm.Driven("hand", position={"x": A * sympy.sin(fm.t)})
    slider = fm.Body("slider", mass=0.0)
    scene = fm.Scene("loop", [
        hand, slider, fm.Spring("k", slider, hand, axis="x", stiffness=C), fm.Body("idle", mass=1.0),
        fm.Contact("rub", slider, law=fm.laws.Coulomb(mu_s=1.0), normal_force=LIMIT),
    ])  # fmt: skip
    with pytest.raises(fm.SceneError, match="mass is 0"):
        fm.simulate(scene, t_end=1.0)  # the hand alone moves: there is nothing to solve
    body = fm.Body("b", mass=1e-3)
    parts = [part for part in scene.parts if part.name not in ("idle", "k")]
    scene = fm.Scene("loop", [
        *parts, body, fm.Spring("k", slider, body, axis="x", stiffness=C),
        fm.Spring("grip", body, hand, axis="x", stiffness=1e4),
    ])  # fmt: skip
    times = np.array([1, 2]) * 2 * np.pi
    sol = fm.simulate(scene, t_end=4 * np.pi, rtol=1e-9, t_eval=times)
    lost = sol.energy.friction_loss + sol.energy.potential
    # the grip gives way by F/1e4
    assert np.diff(lost)[0] == pytest.approx(4 * LIMIT * (A - LIMIT / C - LIMIT / 1e4), rel=2e-3)


N, MU, DIRECT, EVOLVES, L, V0, VISCOUS, PLATE = 1.0, 0.6, 0.01, 0.015, 1e-5, 1e-6, 0.5, 1.3e-6
STIFF = 0.7 * N * (EVOLVES - DIRECT) / L


def own_fault(t_end):
    """Stretch of the spring and state of a block without inertia: its speed balances the spring at every instant."""
    def speed(pull, psi):
        high = N * DIRECT, np.exp((MU + EVOLVES * psi) / DIRECT) / (2 * V0)
        f = lambda w: high[0] * np.arcsinh(np.exp(w) * high[1]) + VISCOUS * np.exp(w) - pull  # noqa: E731
        return np.exp(brentq(f, -80.0, 10.0, xtol=1e-14))

    def rates(t, y):
        v = speed(STIFF * y[0], y[1])
        return [PLATE - v, (V0 * np.exp(-y[1]) - v) / L]

    start = (MU * N + VISCOUS * V0) / STIFF
    found = solve_ivp(rates, (0.0, t_end), [start, 0.0], method="LSODA", rtol=1e-11, atol=[1e-16, 1e-12])
    return start, found.y[:, -1]


@pytest.mark.parametrize("method", ["auto", "bdf"])
def test_a_quasi_dynamic_block_with_radiation_damping(method):
    start, (stretch, psi) = own_fault(200.0)
    block = fm.Body("b", mass=0.0, velocity={"x": V0})
    plate = fm.Driven("plate", position={"x": start + PLATE * fm.t})
    law = fm.laws.RateAndState(mu_0=MU, a=DIRECT, b=EVOLVES, L=L, v_0=V0, v_rest=1e-16, viscous=VISCOUS / N)
    scene = fm.Scene("fault", [
        block, plate, fm.Spring("k", block, plate, axis="x", stiffness=STIFF),
        fm.Contact("fault", block, law=law, normal_force=N),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=200.0, rtol=1e-9, method=method)
    assert start + PLATE * 200 - sol["b.x"][-1] == pytest.approx(stretch, rel=1e-8)
    assert sol.state("fault")[0, -1] == pytest.approx(psi, abs=1e-6)
    assert any("without mass is solved with" in note for note in sol.stats.notes)


def test_a_damped_body_without_mass_sticks_and_creeps():
    """c x' = k (ramp - x) - F: it sets out at F/k, and lags by (F + c v)/k."""
    k, c, F, v = 2.0, 0.5, 0.3, 0.1
    body, hand = fm.Body("b", mass=0.0), fm.Driven("hand", velocity={"x": v})
    scene = fm.Scene("creep", [
        body, hand, fm.Spring("k", body, hand, axis="x", stiffness=k), fm.Damper("c", body, axis="x", damping=c),
        fm.Contact("rub", body, law=fm.laws.Coulomb(mu_s=F), normal_force=1.0),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=6.0, rtol=1e-8)
    begin = F / k / v
    assert [event.kind for event in sol.events] == ["slip"]
    assert float(sol.events[0].t) == pytest.approx(begin, rel=1e-9)
    lag = (F + c * v * (1 - np.exp(-(6.0 - begin) * k / c))) / k
    assert 6 * v - sol["b.x"][-1] == pytest.approx(lag, rel=1e-7)


def test_what_determines_no_velocity_is_refused_by_name():
    spring = fm.Spring("more", fm.Body("slider", mass=0.0), axis="x", stiffness=1.0)
    for scene in (jenkins(more=spring), jenkins().replace("rub", law=fm.laws.Coulomb(mu_s=0.3, mu_k=0.2))):
        with pytest.raises(fm.SceneError, match="Body 'slider': mass is 0; a body without mass needs"):
            fm.simulate(scene, t_end=1.0)
    with pytest.raises(fm.SceneError, match="not relaxed at the start"):
        fm.simulate(jenkins().with_parameters({"slider.position.x": 0.1}), t_end=1.0)
    with pytest.raises(fm.SceneError, match="mass must be > 0"):
        jenkins().modes()
