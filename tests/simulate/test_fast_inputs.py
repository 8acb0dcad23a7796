"""Functions of time that move faster than the motion are seen: at rest, in slip, under any law, by every method."""

import itertools
from functools import cache

import numpy as np
import pytest
import sympy
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import fricmb as fm

T = fm.t


def line(load=0.0, *, law=None, normal_force=1.0, velocity=0.0, belt=None):
    """A block of mass 1 under a load, on the ground or on a belt."""
    body = fm.Body("b", mass=1.0, velocity={"x": velocity})
    ends = [body] if belt is None else [body, fm.Driven("belt", velocity={"x": belt})]
    law = law or fm.laws.Coulomb(mu_s=1.0, mu_k=0.8)
    sole = fm.Contact("sole", *ends, law=law, normal_force=normal_force)
    return fm.Scene("line", [*ends, fm.Force("load", body, axis="x", value=load), sole])


def roller(load):
    """The same, with a joint."""
    body = fm.RigidBody("b", mass=1.0, inertia=0.1)
    return fm.Scene("roller", [
        body, fm.Gravity("g", acceleration={"y": -1.0}), fm.Force("load", body, axis="x", value=load),
        fm.RollerOnLine("sole", body, friction=fm.laws.Coulomb(mu_s=1.0, mu_k=0.8)),
    ])  # fmt: skip


def slides(load, t_end, mu_s=1.0, mu_k=0.8, samples=400_000):
    """Transitions and way of a block at rest: it lets go where the load passes mu_s, and stops in time."""
    t, events, x = 0.0, [], 0.0
    grid = np.linspace(0.0, t_end, samples)
    value = load(grid)
    while True:
        over = np.flatnonzero((grid > t) & (np.abs(value) > mu_s))
        if not over.size:
            return events, x
        i = over[0]
        t = brentq(lambda s: abs(load(s)) - mu_s, grid[i - 1], grid[i], xtol=1e-14) if abs(load(t)) < mu_s else t
        side = np.sign(load(grid[i]))
        run = solve_ivp(
            lambda s, y, side=side: [y[1], load(s) - side * mu_k], (t, t_end), [0.0, 0.0], method="DOP853", rtol=1e-11,
            atol=1e-15, max_step=0.01, events=stops(t),
        )  # fmt: skip
        events.append(("slip", t))
        x += run.y[0, -1]
        if not run.t_events[0].size:
            return events, x
        t = float(run.t_events[0][0])
        events.append(("stick", t))


def stops(begin):
    def event(s, y):
        return y[1] if s > begin + 1e-6 else 1.0

    event.terminal = True
    return event


@pytest.fixture(scope="module")
def excursions():
    """Loads that pass the limit at the crests of a fast sine, the first of them by a thousandth."""
    return slides(lambda t: 0.6 + 0.3 * np.sin(20 * t) + 0.002 * t, 60.0)


@pytest.mark.parametrize("make", [line, roller])
@pytest.mark.parametrize(("method", "rtol"), [
    ("auto", 1e-4), ("auto", 1e-6), ("auto", 1e-10), ("radau", 1e-6), ("bdf", 1e-6), ("bdf", 1e-9), ("taylor", 1e-6),
])  # fmt: skip
def test_every_crest_over_the_limit_is_an_excursion(make, method, rtol, excursions):
    if make is roller and method == "taylor":
        pytest.skip("takes no joints")
    sol = fm.simulate(make(0.6 + 0.3 * sympy.sin(20 * T) + 0.002 * T), t_end=60.0, rtol=rtol, method=method)
    events, x = excursions
    assert [e.kind for e in sol.events] == [kind for kind, _ in events]
    assert len(events) > 50
    assert sol.events[0].t == pytest.approx(events[0][1], abs=1e-8)
    assert sol["b.x"][-1] == pytest.approx(x, rel=100 * rtol)


@pytest.mark.parametrize("law", [
    fm.laws.Stribeck(mu_s=1.0, mu_k=0.8, v_s=0.1),
    fm.laws.Tabulated(speed=[0.0, 0.05, 0.1, 1.0], mu=[1.0, 0.9, 0.85, 0.8]),
])  # fmt: skip
def test_crests_under_laws_of_slip_speed(law):
    """Loose and tight tolerances agree, with every transition; the first is where the load passes the limit."""
    scene = line(0.6 + 0.3 * sympy.sin(20 * T) + 0.002 * T, law=law)
    runs = {rtol: fm.simulate(scene, t_end=54.0, rtol=rtol) for rtol in (1e-4, 1e-7, 1e-10)}
    first = brentq(lambda t: 0.6 + 0.3 * np.sin(20 * t) + 0.002 * t - 1.0, 50.02, 50.03)
    for rtol, sol in runs.items():
        assert sol.events[0].t == pytest.approx(first, abs=1e-6)
        assert len(sol.events) == len(runs[1e-10].events) > 10
        assert sol["b.x"][-1] == pytest.approx(runs[1e-10]["b.x"][-1], rel=100 * rtol)


@pytest.mark.parametrize("width", [1e-1, 1e-3, 1e-5])
@pytest.mark.parametrize("method", ["auto", "radau", "bdf", "taylor"])
def test_a_pulse_while_sliding_brings_its_impulse(width, method):
    """A bell of area 1: v is 1 more behind it, whatever part of the run it takes."""
    at, sigma = 3.71234567, 10.0 * width / 5.0
    bell = sympy.exp(-(((T - at) / sigma) ** 2)) / (sympy.sqrt(sympy.pi) * sigma)
    sol = fm.simulate(line(bell, velocity=9.0), t_end=10.0, rtol=1e-8, method=method)
    assert sol.velocity("b.x")[-1] == pytest.approx(9.0 + 1.0 - 8.0, abs=1e-6)
    assert sol["b.x"][-1] == pytest.approx(90.0 - 40.0 + (10.0 - at), abs=1e-5)


@pytest.mark.parametrize("width", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
def test_a_pulse_at_rest_pushes(width, method):
    at, sigma = 3.71234567, 10.0 * width / 5.0
    bell = sympy.exp(-(((T - at) / sigma) ** 2)) / (sympy.sqrt(sympy.pi) * sigma)
    sol = fm.simulate(line(bell), t_end=10.0, rtol=1e-8, method=method)
    assert [e.kind for e in sol.events] == ["slip", "stick"]
    reach = sigma * np.sqrt(np.log(1.0 / (np.sqrt(np.pi) * sigma)))
    assert sol.events[0].t == pytest.approx(at - reach, abs=1e-6 * width)
    load = lambda t: np.exp(-(((t - at) / sigma) ** 2)) / (np.sqrt(np.pi) * sigma)  # noqa: E731
    speed = quad(lambda t: load(t) - 0.8, at - reach, at + 8.0 * sigma, epsabs=1e-13, points=[at])[0]
    assert sol.events[1].t == pytest.approx(at + 8.0 * sigma + speed / 0.8, rel=1e-6)


@cache
def shaken(law):
    """Place after 1 s of a block that is pulled on a shaken belt, by an own program."""
    states = len(law.states)

    def rates(t, y):
        slip = np.array([y[1] - 0.2 * np.sin(100 * np.pi * t)])
        z = y[2:] if states else None
        force = float(np.ravel(law.force(slip, 1.0, z))[0])
        rate = [] if not states else [float(rate_of(slip[0], z[0]))]
        return [y[1], 1.0 + force, *rate]

    def rate_of(v, z):
        g = law.mu_k + (law.mu_s - law.mu_k) * np.exp(-((v / law.v_s) ** 2))
        return v - law.sigma0 * abs(v) * z / g

    true = solve_ivp(rates, (0, 1), [0.0] * (2 + states), method="LSODA", rtol=1e-9, atol=1e-11, max_step=2e-4)
    return true.y[0, -1]


@pytest.mark.parametrize("law", [
    fm.laws.LuGre(sigma0=1e3, sigma1=10.0, sigma2=0.0, mu_s=1.0, mu_k=0.8, v_s=0.1),
    fm.laws.TanhRegularised(mu=0.8, v_reg=0.05),
], ids=["LuGre", "tanh"])  # fmt: skip
@pytest.mark.parametrize("rtol", [1e-5, 1e-8])
def test_a_shaken_belt_under_laws_that_never_stick(law, rtol):
    belt = sympy.sin(2 * sympy.pi * 50 * T) / 5
    found = fm.simulate(line(1.0, law=law, belt=belt), t_end=1.0, rtol=rtol)
    assert found["b.x"][-1] == pytest.approx(shaken(law), rel=100 * rtol + 1e-6)


def test_a_belt_that_shakes_under_a_sliding_block_is_met_at_each_turn():
    """Slip passes 0 twice a period as long as the block is slower than the belt's crest: counted by an own program."""
    belt = sympy.sin(2 * sympy.pi * 50 * T)
    scene = line(0.0, belt=belt, velocity=0.5)
    counts = [len(fm.simulate(scene, t_end=0.5, rtol=rtol).events) for rtol in (1e-4, 1e-8)]
    t, v, reversals, sign = 0.0, 0.5, 0, 1.0
    dt = 1e-6
    while t < 0.5:
        v -= 0.8 * sign * dt
        t += dt
        new = np.sign(v - np.sin(100 * np.pi * t))
        reversals += new != sign
        sign = new
    assert counts[0] == counts[1] == reversals > 40


def test_no_step_is_longer_than_asked_for():
    scenes = {
        "radau": line(0.5 + T / 100), "bdf": line(0.5 + T / 100), "taylor": fm.models.stick_slip_chain(3),
        "collocation": fm.models.brake4dof("2"),
    }  # fmt: skip
    for method, scene in scenes.items():
        free = fm.simulate(scene, t_end=10.0, method=method)
        held = fm.simulate(scene, t_end=10.0, method=method, max_step=0.05)
        assert np.diff(held.t).max() <= 0.05 * (1 + 1e-12), method
        assert np.diff(free.t).max() > 0.05
    crank = fm.simulate(fm.models.slider_crank(), t_end=0.1, max_step=1e-3)
    assert np.diff(crank.t).max() <= 1e-3 * (1 + 1e-12)
    for wrong in (0.0, -1.0, np.nan, "short"):
        with pytest.raises(fm.SceneError, match="max_step"):
            fm.simulate(scenes["radau"], t_end=1.0, max_step=wrong)


@pytest.mark.parametrize("method", ["auto", "radau"])
def test_ground_that_sets_in_at_once_has_a_place_before(method):
    """Its place is an integral that SymPy gives by log(1 + tanh): -oo in doubles, long before, where it is 0."""
    at, width, speed = 20.0, 1e-6, 0.3
    belt = fm.Driven("belt", velocity={"x": speed * (1 + sympy.tanh((fm.t - at) / width)) / 2})
    block = fm.Body("block", mass=1.0)
    rubs = fm.Contact("sole", block, belt, law=fm.laws.Coulomb(mu_s=0.5), normal_force=1.0)
    sol = fm.simulate(fm.Scene("engaged", [belt, block, rubs]), t_end=22.0, rtol=1e-6, method=method)
    # 0.5 m/s^2 from the jump on, until it goes with the belt
    assert sol["block.x"][-1] == pytest.approx(speed * (2.0 - 0.5 * speed / 0.5), abs=1e-5)
    assert sol.events[-1].kind == "stick"


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("rtol", [1e-6, 1e-8])
def test_ground_that_sets_in_under_a_body_at_rest(rtol, method):
    """Nothing has moved and has a size when a triangular pulse begins; beside modes that hang on a smooth law."""
    at, width, size = 13.519, 9.4e-4, 0.06
    ground = fm.Driven("ground", velocity={"x": size * sympy.Max(0, 1 - sympy.Abs(fm.t - at) / width)})
    block = fm.Body("block", mass=1.0, axes="x")
    spring = fm.Spring("spring", block, axis="x", stiffness=1.5)
    rub = fm.Contact("rub", block, ground, law=fm.laws.TanhRegularised(mu=0.4, v_reg=1e-2), normal_force=1.0, axes="x")
    sol = fm.simulate(fm.Scene("s", [ground, block, spring, rub]), t_end=16.0, rtol=rtol, method=method)

    def rate(t, y):
        return [y[1], 0.4 * np.tanh((size * max(0.0, 1 - abs(t - at) / width) - y[1]) / 1e-2) - 1.5 * y[0]]

    y = [0.0, 0.0]
    for a, b in itertools.pairwise([at - width, at, at + width, 16.0]):
        y = solve_ivp(rate, (a, b), y, "DOP853", rtol=1e-12, atol=1e-18).y[:, -1]
    np.testing.assert_allclose([sol.q[0, -1], sol.v[0, -1]], y, rtol=100 * rtol)
