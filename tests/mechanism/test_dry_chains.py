"""Chains of dry pins, which are trees: at rest against statics, swinging against equations in angles, long ones."""

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

G = 9.81


def chain(angles, rates=0.0, *, radius=0.01, mu=0.5):
    """Links of mass and length 1, hanging from the first pin; angles from the vertical."""
    n = len(angles)
    rates = np.broadcast_to(rates, n)
    law = fm.laws.Coulomb(mu_s=mu)
    at, speed, parts, above = np.zeros(2), np.zeros(2), [fm.Gravity("weight", acceleration={"y": -G})], None
    for i, (angle, rate) in enumerate(zip(angles, rates, strict=True)):
        along, across = np.array([np.sin(angle), -np.cos(angle)]), np.array([np.cos(angle), np.sin(angle)])
        link = fm.RigidBody(
            f"link{i}", mass=1.0, inertia=1 / 12, position=tuple(at + along / 2), angle=angle - np.pi / 2,
            velocity=tuple(speed + rate * across / 2), angular_velocity=float(rate),
            points={"top": (-0.5, 0.0), "end": (0.5, 0.0)},
        )  # fmt: skip
        held = {"radius": radius, "friction": law}
        ends = (link.point("top"),) if above is None else (link.point("top"), above.point("end"))
        parts += [link, fm.Revolute(f"pin{i}", *ends, **held)]
        at, speed, above = at + along, speed + rate * across, link
    return fm.Scene("chain", parts)


@pytest.mark.parametrize("n", [14, 20, 200])
@pytest.mark.parametrize("part", [0.05, 0.5, 0.97])
def test_hanging_links_rest_as_statics_says(n, part):
    tilt = 5e-4 * np.cos(np.arange(n) * 2.4)
    # moment and load of every pin from the weights below it
    x = np.concatenate([[0.0], np.cumsum(np.sin(tilt))])
    centre = (x[:-1] + x[1:]) / 2
    moment = np.array([G * (centre[i:] - x[i]).sum() for i in range(n)])
    load = G * np.arange(n, 0, -1.0)
    radius = np.abs(moment / (0.5 * load)).max() / part
    sol = fm.simulate(chain(tilt, radius=radius), t_end=1.0)
    assert len(sol.events) == 0
    for i in range(n):
        assert (sol.mode(f"pin{i}") == 0).all()
        assert sol.force(f"pin{i}")[0, -1] * radius == pytest.approx(moment[i], rel=1e-8, abs=1e-9 * load[0] * radius)
        assert sol.normal_force(f"pin{i}")[-1] == pytest.approx(load[i], rel=1e-9)
    assert np.abs(sol.v[:, -1]).max() < 1e-20


def test_a_start_at_rest_whose_velocities_are_round_off_stays():
    noise = 1e-17 * np.random.default_rng(5).standard_normal(100)
    sol = fm.simulate(chain(np.full(100, 5e-4), noise, radius=0.1), t_end=1.0)
    assert all((sol.mode(f"pin{i}") == 0).all() for i in range(100))
    assert np.abs(sol.v[:, -1]).max() < 1e-20


class Links:
    """The chain in its angles, its mass matrix written by hand; modes of the pins by trial of all combinations."""

    def __init__(self, n, radius, mu):
        self.n, self.R, self.mu = n, radius, mu
        below = n - np.maximum.outer(np.arange(n), np.arange(n))
        self.J = below - 0.5 + np.eye(n) * (1 / 12 - 0.25)  # sum of lever products, 1/4 + 1/12 for a link itself
        self.weight = G * (n - np.arange(n) - 0.5)
        # a moment at pin i acts on link i and back on the link above
        self.B = np.eye(n) - np.eye(n, k=1)

    def forces(self, angle, rate):
        apart = angle[:, None] - angle
        inertia = self.J * np.cos(apart)
        return inertia, -(self.J * np.sin(apart)) @ rate**2 - self.weight * np.sin(angle)

    def loads(self, angle, rate, acc):
        """Magnitude of what each pin bears: inertia and weight of all below it."""
        a = np.array([np.cos(angle), np.sin(angle)]) * acc + np.array([-np.sin(angle), np.cos(angle)]) * rate**2
        tip = np.cumsum(a, axis=1)
        centre = tip - a / 2 + np.array([[0.0], [G]])
        return np.hypot(*np.cumsum(centre[:, ::-1], axis=1)[:, ::-1])

    def solve(self, angle, rate, mode):
        """Accelerations, moments and loads; mode 0 sticks, +-1 slips that way."""
        inertia, f = self.forces(angle, rate)
        held = np.flatnonzero(mode == 0)
        k = len(held)
        A = np.block([[inertia, -self.B[:, held]], [self.B[:, held].T, np.zeros((k, k))]])
        load = np.zeros(self.n)
        for _ in range(200):
            moment = -mode * self.mu * self.R * load
            x = np.linalg.solve(A, np.concatenate([f + self.B @ moment, np.zeros(k)]))
            new = self.loads(angle, rate, x[: self.n])
            if np.abs(new - load).max() <= 1e-14 * new.max():
                break
            load = new
        moment[held] = x[self.n :]
        return x[: self.n], moment, load

    def decide(self, angle, rate, mode, rest, forced):
        found = []
        for pattern in itertools.product((0, 1, -1), repeat=int(rest.sum())):
            new = mode.copy()
            new[rest] = pattern
            if forced is not None and new[forced[0]] != forced[1]:
                continue
            acc, moment, load = self.solve(angle, rate, new)
            turn = self.B.T @ acc
            inside = np.abs(moment) <= self.mu * self.R * load * (1 + 1e-9)
            free = rest.copy()
            if forced is not None:
                free[forced[0]] = False
            if (inside | (new != 0)).all() and (new * turn >= 0)[free].all():
                found.append(new)
        assert len(found) == 1
        return found[0]

    def end_of(self, i, mode):
        """What falls through 0 where the mode of pin i ends."""

        def ends(t, y):
            if mode[i]:
                return mode[i] * (self.B[:, i] @ y[self.n :])
            _, moment, load = self.solve(y[: self.n], y[self.n :], mode)
            return self.mu * self.R * load[i] - abs(moment[i])

        ends.terminal, ends.direction = True, -1
        return ends

    def run(self, angle, rate, until):
        t, events = 0.0, []
        mode = np.sign(np.round(self.B.T @ rate, 12)).astype(int)
        mode = self.decide(angle, rate, mode, mode == 0, None)
        while True:
            run = solve_ivp(
                lambda t, y, mode=mode: np.concatenate([y[self.n :], self.solve(y[: self.n], y[self.n :], mode)[0]]),
                (t, until), np.concatenate([angle, rate]), method="DOP853", rtol=1e-11, atol=1e-12,
                events=[self.end_of(i, mode) for i in range(self.n)],
            )  # fmt: skip
            t, angle, rate = run.t[-1], run.y[: self.n, -1], run.y[self.n :, -1]
            which = [i for i, times in enumerate(run.t_events) if len(times)]
            if not which:
                return angle, events
            i = which[0]
            forced = None
            if mode[i] == 0:
                forced = (i, -np.sign(self.solve(angle, rate, mode)[1][i]))
            else:
                rate = rate - np.linalg.solve(self.B.T, np.eye(self.n)[i]) * (self.B[:, i] @ rate)
            rest = mode == 0
            rest[i] = True
            mode = self.decide(angle, rate, mode, rest, forced)
            events.append(t)


@pytest.mark.parametrize(("angles", "rates"), [
    ((0.6, 0.6, 0.6), (0.0, 0.0, 0.0)),
    ((0.3, -0.2, 0.5), (0.0, 2.0, -1.0)),
    ((0.5, 0.5, 0.5, 0.5), (0.4, 0.4, 0.4, 0.4)),
])  # fmt: skip
def test_swinging_links_against_equations_in_angles(angles, rates):
    reference, times = Links(len(angles), 0.08, 0.5).run(np.array(angles), np.array(rates), 1.5)
    assert len(times) >= 2
    for rtol in (1e-6, 1e-9):
        sol = fm.simulate(chain(angles, rates, radius=0.08), t_end=1.5, rtol=rtol)
        # one that sticks may set another free at the same instant
        found = np.array(sol.events.t)
        found = found[np.append(True, np.diff(found) > 1e-12)]
        np.testing.assert_allclose(found, times, rtol=0, atol=30 * rtol)
        last = [sol[f"link{i}.angle"][-1] + np.pi / 2 for i in range(len(angles))]
        np.testing.assert_allclose(last, reference, rtol=0, atol=30 * rtol)


@pytest.mark.parametrize("start", ["straight", "swinging", "crooked"])
def test_long_chains_swing(start):
    """Energy closes, pins stay within their limits, and the tolerance tells: 40 links from three starts."""
    n = 40
    angles = np.random.default_rng(7).uniform(-1, 1, n) if start == "crooked" else np.full(n, 0.4)
    scene = chain(angles, 0.5 if start == "swinging" else 0.0, radius=0.03)
    sol, finer = (fm.simulate(scene, t_end=0.3, rtol=rtol) for rtol in (1e-5, 1e-7))
    assert np.abs(sol.energy.residual).max() < 1e-6
    for i in range(n):
        assert (np.abs(sol.force(f"pin{i}")[0]) <= 0.5 * sol.normal_force(f"pin{i}") + 1e-6 * G).all()
    np.testing.assert_allclose(sol.q[:, -1], finer.q[:, -1], rtol=0, atol=1e-3)


@pytest.mark.parametrize("seed", [8, 29, 33, 44, 70, 75, 130])
def test_pins_that_bear_next_to_nothing_do_not_end_a_run(seed):
    """Far ends of crooked chains fall almost freely: their loads are a part in 1e10 of the first, and jump."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(10, 45))
    angles, rate, radius = rng.uniform(-1, 1, n), rng.choice([0.0, 0.5]), rng.choice([0.01, 0.03, 0.08])
    sol, finer = (fm.simulate(chain(angles, rate, radius=radius), t_end=0.3, rtol=rtol) for rtol in (1e-6, 1e-8))
    np.testing.assert_allclose(sol.q[:, -1], finer.q[:, -1], rtol=0, atol=1e-5)
    assert np.abs(finer.energy.residual).max() < 1e-7
