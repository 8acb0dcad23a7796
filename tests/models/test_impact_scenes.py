"""Models of impacts against closed forms, certified values and event loops that share no code with the project."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

import fricmb as fm


# -- ball on an oscillating table ------------------------------------------------------------------------------------
def test_a_ball_on_a_table_is_hit_where_its_parabolas_meet_the_table_and_falls_into_step():
    A, w, e, g = 1e-3, 100.0, 0.8, 9.81
    sol = fm.simulate(fm.models.oscillating_table(), t_end=4.0, rtol=1e-9)
    t, y, v, hits = 0.0, 4e-3, -0.18, []
    while True:
        apart = lambda s: y + v * s - g * s * s / 2 - A * math.sin(w * (t + s))  # noqa: B023, E731
        # it is above the table's highest place for most of its flight: the first root lies behind that
        fall = (v + math.sqrt(max(v * v + 2 * g * (y - A), 0.0))) / g
        s = brentq(apart, fall, (v + math.sqrt(v * v + 2 * g * (y + A))) / g, xtol=1e-16)
        if t + s > 4.0:
            break
        t, y = t + s, A * math.sin(w * (t + s))
        table = A * w * math.cos(w * t)
        v = table + e * (table - (v - g * s))
        hits.append(t)
    impulse = sol.impulse("surface")
    assert len(hits) == len(impulse.t) > 60
    assert np.allclose(impulse.t, hits, rtol=0, atol=1e-9)
    # certified: phase and impulse of the orbit of one period
    assert abs(impulse.t[-1] * w % (2 * math.pi) - 1.221290450550073) < 1e-5
    assert abs(impulse.normal[-1] / 0.1 - 0.6163804786343174) < 1e-5
    assert sol.audit().ok


# -- impact damper ---------------------------------------------------------------------------------------------------
def steady_damper(*, M=1.0, k=100.0, c=0.2, F=1.0, w=10.0, m=0.1, gap=0.2, e=0.6):
    """(place of the box, speed of the loose mass) of motions with impacts half a period apart, by symmetry."""
    half, d = math.pi / w, c / (2 * M)
    own = math.sqrt(k / M - d * d)
    answer = F / complex(k - M * w * w, c * w)

    def steady(t):
        z = answer * np.exp(1j * w * t)
        return np.array([z.imag, (1j * w * z).imag])

    damped, cos, sin = math.exp(-d * half), math.cos(own * half), math.sin(own * half)
    flow = damped * np.array([[cos + d / own * sin, sin / own], [-k / M / own * sin, cos - d / own * sin]])

    def speeds(x):
        u = -(2 * x + gap) / half  # from one wall to the other in half a period
        before = (1 - e + 2 * m / M) / (1 + e) * u  # momentum and restitution
        return before, u - e * (u + before), u

    def defect(unknown):
        t, x = unknown
        before, behind, _ = speeds(x)
        after = flow @ (np.array([x, behind]) - steady(t)) - steady(t)
        return after + np.array([x, before])

    found = []
    for guess in ((t, x) for t in np.linspace(0, 2 * half, 9) for x in (-0.05, 0.05)):
        (_, x), _, fits, _ = fsolve(defect, guess, xtol=1e-13, full_output=True)
        if fits == 1 and 2 * x + gap > 0:
            found.append((abs(x), abs(speeds(x)[2])))
    return found


@pytest.mark.parametrize("given", [{}, {"gap": 0.25, "e": 0.3}])
def test_an_impact_damper_ends_in_two_impacts_a_period(given):
    names = {"gap": "gap", "e": "restitution"}
    scene = fm.models.impact_damper(**{names[name]: value for name, value in given.items()})
    sol = fm.simulate(scene, t_end=60.0, rtol=1e-9)
    impulse = sol.impulse("walls")
    late = impulse.t > 50.0
    assert np.allclose(np.diff(impulse.t[late]), math.pi / 10.0, rtol=0, atol=1e-6)
    places = np.abs(sol.at(impulse.t[late])["box.x"])
    place, u = min(steady_damper(**given), key=lambda motion: abs(motion[0] - places[0]))
    assert np.allclose(places, place, rtol=0, atol=1e-6)
    assert np.allclose(impulse.normal[late], 2 * 0.1 * u, rtol=1e-5)
    # without the loose mass resonance has force/(damping frequency)
    assert np.abs(sol["box.x"][sol.t > 50.0]).max() < 0.5 * 1.0 / (0.2 * 10.0)
    assert sol.audit().ok


# -- Newton's cradle -------------------------------------------------------------------------------------------------
def cradle(n, lifted, t_end, e, *, R=0.01, L=0.15, gap=1e-5, angle=0.5, g=9.81):
    """Times, numbers and impulses (mass 0.05) of pendulums that strike along the line of their centres."""
    pitch, t = 2 * R + gap, 0.0
    y = np.concatenate([np.where(np.arange(n) < lifted, -angle, 0.0), np.zeros(n)])

    def between(i):
        def apart(_, y):
            x = pitch + L * (math.sin(y[i + 1]) - math.sin(y[i]))
            h = L * (math.cos(y[i]) - math.cos(y[i + 1]))
            return math.hypot(x, h) - 2 * R

        apart.terminal, apart.direction = True, -1
        return apart

    events, found = [between(i) for i in range(n - 1)], []
    while t < t_end:
        run = solve_ivp(
            lambda _, y: np.concatenate([y[n:], -g / L * np.sin(y[:n])]), (t, t_end), y, "DOP853", rtol=1e-12,
            atol=1e-14, events=events, max_step=0.02,
        )  # fmt: skip
        t, y = float(run.t[-1]), run.y[:, -1].copy()
        for i in (i for i in range(n - 1) if run.t_events[i].size):
            x, h = (L * (f(y[i + 1]) - f(y[i])) for f in (math.sin, lambda a: -math.cos(a)))
            line = np.array([pitch + x, h])
            line /= np.linalg.norm(line)
            along = [L * (line @ (math.cos(y[j]), math.sin(y[j]))) for j in (i, i + 1)]
            rate = along[1] * y[n + i + 1] - along[0] * y[n + i]
            impulse = -(1 + e) * rate * 0.05 / ((along[0] ** 2 + along[1] ** 2) / L**2)
            y[n + i] -= impulse * along[0] / (0.05 * L**2)
            y[n + i + 1] += impulse * along[1] / (0.05 * L**2)
            found.append((t, i, impulse))
    return found, y


@pytest.mark.parametrize(("lifted", "e", "t_end"), [(1, 1.0, 1.0), (2, 1.0, 0.4), (1, 0.9, 0.2)])
def test_a_cradle_passes_speeds_on_as_pendulums_do_that_strike(lifted, e, t_end):
    sol = fm.simulate(fm.models.newtons_cradle(lifted=lifted, restitution=e), t_end=t_end, rtol=1e-10)
    wanted, end = cradle(5, lifted, t_end, e)
    hits = sol.events.of(kind="impact")
    assert [hit.contact for hit in hits] == [f"touch{i + 1}" for _, i, _ in wanted]
    assert np.allclose([hit.t for hit in hits], [t for t, _, _ in wanted], rtol=0, atol=1e-8)
    assert np.allclose([hit.impulse for hit in hits], [p for _, _, p in wanted], rtol=0, atol=1e-8 * 0.05)
    angle = [math.asin((sol[f"ball{i + 1}.x"][-1] - 0.02001 * i) / 0.15) for i in range(5)]
    assert np.allclose(angle, end[:5], rtol=0, atol=1e-7)
    assert sol.audit().ok


# -- woodpecker ------------------------------------------------------------------------------------------------------
PERIOD = 0.1459760651437518
CYCLE = {"angle": -0.2051353492435258, "rate": 17.57466620557608}


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
def test_a_woodpecker_pecks_in_its_certified_cycle(rtol):
    """By matrix exponentials in 34 digits along the sequence of the cycle, and by a program of another kind."""
    sol = fm.simulate(fm.models.woodpecker(**CYCLE), t_end=0.99 * PERIOD, rtol=rtol)
    kinds = [(event.kind, event.contact) for event in sol.events if event.t > 1e-9]
    wanted = [
        ("open", "low", 0.005820757234809802, None),
        ("impact", "high", 0.0167098252806435, 4.79075800387315e-5),
        ("impact", "beak", 0.01981117893963643, 0.001284502929813755),
        ("impact", "high", 0.02039070047798867, 0.0001872339447528719),
        ("rest", "high", 0.02039070047798867, None),
        ("open", "high", 0.02224539127203278, None),
        ("impact", "low", 0.05753380196015821, 8.03239668027116e-5),
        ("impact", "low", 0.06026253599142089, 1.137924739387418e-5),
        ("rest", "low", 0.06026253599142089, None),
        ("stick", "low", 0.1063826581442899, None),
    ]
    assert kinds == [(kind, contact) for kind, contact, _, _ in wanted]
    late = [event for event in sol.events if event.t > 1e-9]
    for event, (_, _, t, impulse) in zip(late, wanted, strict=True):
        assert abs(event.t - t) < 10 * rtol * PERIOD
        if impulse is not None:
            assert abs(event.impulse - impulse) < 10 * rtol * 1.3e-3
    assert sol.audit().ok


def test_what_is_left_of_a_deviation_is_the_certified_multiplier():
    sol = fm.simulate(
        fm.models.woodpecker(angle=CYCLE["angle"], rate=CYCLE["rate"] + 1e-3), t_end=6 * PERIOD, rtol=1e-11
    )
    slips = [event.t for event in sol.events.of(kind="slip") if event.t > 1e-3]
    off = sol.at(np.array(slips)).velocity("bird.beak.x") / 0.02 - CYCLE["rate"]
    assert np.allclose(off[2:5] / off[1:4], -0.8391556530475859, rtol=0, atol=2e-4)
    drop = np.diff(sol.at(np.array(slips))["bird.sleeve.y"])
    assert np.allclose(drop, -0.01944537928471653, rtol=0, atol=1e-5)


# -- vibrating incline -----------------------------------------------------------------------------------------------
@dataclass
class Conveyor:
    """A block seen from the incline: along s and normal n, pushed by ``a sin(w t)`` and gravity; mass 1."""

    slope: float = 0.1
    A: float = 2e-3
    w: float = 100.0
    direction: float = 0.8
    mu: float = 0.6
    g: float = 9.81

    def push(self, t):
        a, b = self.A * self.w**2 * math.sin(self.w * t), self.direction - self.slope
        return a * math.cos(b) - self.g * math.sin(self.slope), self.g * math.cos(self.slope) - a * math.sin(b)

    def slopes(self, mode):
        def rate(t, y):
            along, load = self.push(t)
            if mode == "open":
                return [y[2], y[3], along, -load]
            return [y[2], 0.0, 0.0 if mode == "stick" else along - mode * self.mu * load, 0.0]

        return rate

    def events(self, mode):
        if mode == "open":
            lands = lambda t, y: y[1]  # noqa: E731
            lands.direction = -1
            found = [lands]
        elif mode == "stick":
            slips = lambda t, y: self.mu * self.push(t)[1] - abs(self.push(t)[0])  # noqa: E731
            slips.direction = -1
            found = [slips]
        else:
            stops, lifts = (lambda t, y: mode * y[2]), (lambda t, y: self.push(t)[1])
            stops.direction = lifts.direction = -1
            found = [stops, lifts]
        for event in found:
            event.terminal = True
        return found

    def next_mode(self, t, v):
        along, load = self.push(t)
        if load <= 0.0:
            return "open"
        if abs(v) > 1e-12:
            return int(np.sign(v))
        return "stick" if abs(along) < self.mu * load else int(np.sign(along))

    def run(self, t_end):
        """Events without restitution, and the state at the end."""
        t, y, mode, found = 0.0, np.zeros(4), "stick", []
        while t < t_end:
            run = solve_ivp(
                self.slopes(mode), (t, t_end), y, "DOP853", rtol=1e-12, atol=1e-15, events=self.events(mode),
                max_step=2e-4,
            )  # fmt: skip
            t, y = float(run.t[-1]), run.y[:, -1].copy()
            if t >= t_end:
                break
            before = mode
            if mode == "open":
                y[2] -= math.copysign(min(abs(y[2]), self.mu * -y[3]), y[2])
                y[1] = y[3] = 0.0
                found.append(("impact", t))
            mode = self.next_mode(t + 1e-9, 0.0 if before in (1, -1) and run.t_events[0].size else y[2])
            y[2] = 0.0 if mode == "stick" else y[2]
            if mode == "open":
                found.append(("open", t))
        return found, y


def test_an_incline_throws_a_block_as_an_event_loop_in_its_axes_has_it():
    sol = fm.simulate(fm.models.vibrating_incline(restitution=0.0), t_end=0.3, rtol=1e-9)
    wanted, end = Conveyor().run(0.3)
    found = [(event.kind, event.t) for event in sol.events if event.kind in ("impact", "open")]
    assert [kind for kind, _ in found] == [kind for kind, _ in wanted]
    assert sum(kind == "impact" for kind, _ in wanted) >= 4
    assert np.allclose([t for _, t in found], [t for _, t in wanted], rtol=0, atol=1e-7)
    way = [sol[f"block.{c}"][-1] - sol[f"incline.{c}"][-1] for c in "xy"]
    assert abs(way[0] * math.cos(0.1) + way[1] * math.sin(0.1) - end[0]) < 1e-9
    assert end[0] > 1e-2  # uphill
    assert sol.audit().ok


# -- dropped disc ----------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("spin", "e"), [(0.0, 0.6), (-60.0, 0.4)])
def test_a_dropped_disc_is_a_bouncing_ball_across_the_slope_and_rubs_along_it(spin, e):
    g, a, mu, R, height = 9.81, math.atan(0.3), 0.25, 0.1, 0.5
    down, push = g * math.cos(a), g * math.sin(a)
    sol = fm.simulate(fm.models.dropped_disc(spin=spin, restitution=e), t_end=4.0, rtol=1e-8)
    impulse, (rest,) = sol.impulse("slope"), sol.events.of(kind="rest")
    V = math.sqrt(2 * down * height)
    t, v, rate, came = V / down, push * V / down, spin, V
    for k in range(8):
        rub = np.clip(-(v + R * rate) / 3, -mu * (1 + e) * came, mu * (1 + e) * came)
        v, rate = v + rub, rate + 2 * rub / R
        assert abs(impulse.t[k] - t) < 1e-12
        assert abs(impulse.normal[k] - 0.5 * (1 + e) * came) < 1e-11
        assert abs(impulse.tangential[k] - 0.5 * rub) < 1e-11
        came *= e
        t += 2 * came / down
        v += push * 2 * came / down
    assert abs(rest.t - V / down * (1 + e) / (1 - e)) < min(rest.bound, 1e-10)
    late = sol.t > rest.t + 0.1
    speed = np.hypot(sol.velocity("disc.x"), sol.velocity("disc.y"))[late]
    assert np.allclose(np.diff(speed), 2 / 3 * push * np.diff(sol.t[late]), rtol=0, atol=1e-9)
    assert sol.audit().ok


# -- pad that lifts off ----------------------------------------------------------------------------------------------
def pad(t_end, e):
    """Events and the end of a pad that slips all the time, by an event loop."""
    m, k, c, K, C, P, A, w, mu = 0.5, 2e4, 10.0, 2e5, 50.0, 30.0, 2e-4, 600.0, 0.4

    def load(t):
        return P + (k - m * w * w) * A * math.sin(w * t) + c * A * w * math.cos(w * t)

    def rate(held):
        def slopes(t, y):
            if held:
                N, across = load(t), -A * w * w * math.sin(w * t)
            else:
                N, across = 0.0, -(P + k * y[1] + c * y[3]) / m
            return [y[2], y[3], (mu * N - K * y[0] - C * y[2]) / m, across]

        return slopes

    lifts, lands = (lambda t, y: load(t)), (lambda t, y: y[1] - A * math.sin(w * t))
    for event in (lifts, lands):
        event.terminal, event.direction = True, -1
    t, y, held, found = 0.0, np.array([0.0, 0.0, 0.0, A * w]), True, []
    while t < t_end:
        run = solve_ivp(
            rate(held), (t, t_end), y, "DOP853", rtol=1e-12, atol=1e-15, events=[lifts if held else lands],
            max_step=1e-4,
        )  # fmt: skip
        t, y = float(run.t[-1]), run.y[:, -1].copy()
        if t >= t_end:
            break
        if held:
            held = False
            found.append(("open", t))
            continue
        hit = (1 + e) * (A * w * math.cos(w * t) - y[3])
        y[1], y[2], y[3] = A * math.sin(w * t), y[2] + mu * hit, y[3] + hit
        held = e == 0.0
        found.append(("impact", t))
    return found, y


@pytest.mark.parametrize(("e", "t_end"), [(0.0, 0.1), (0.3, 0.0047)])
def test_a_pad_lifts_off_and_returns_as_an_event_loop_has_it(e, t_end):
    wanted, end = pad(t_end, e)
    sol = fm.simulate(fm.models.pad_lift_off(restitution=e), t_end=t_end, rtol=1e-9)
    found = [(event.kind, event.t) for event in sol.events if event.kind in ("impact", "open")]
    assert [kind for kind, _ in found] == [kind for kind, _ in wanted]
    assert len(found) >= 3
    assert np.allclose([t for _, t in found], [t for _, t in wanted], rtol=0, atol=1e-8)
    assert np.allclose([*sol.q[:, -1], *sol.v[:, -1] * 1e-3], [*end[:2], *end[2:] * 1e-3], rtol=0, atol=1e-9)
    assert sol.audit().ok
