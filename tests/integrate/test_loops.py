"""Loops of contacts: blocks that rub on the ground and on one another, against an event loop that tries all modes."""

import itertools
import math

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import linprog

import fricmb as fm

METHODS = pytest.mark.parametrize("method", ["radau", "bdf", "auto"])


class Line:
    """Blocks (masses M) on springs K under loads a sin(w t + p), contacts W with normal forces N; all along one line.

    What rests goes on to rest while there are forces within mu_s N that hold it (a linear programme), and gives way as
    if slip changed nothing.
    """

    def __init__(self, M, K, loads, contacts, mu_s, mu, speed=0.0):
        self.M, self.K = np.array(M), np.array(K)
        self.loads = np.array(loads).T
        self.W = np.array([row for row, _ in contacts], float).T
        self.N = np.array([N for _, N in contacts])
        self.mu_s, self.mu = mu_s, mu
        # rows of one entry are contacts with a belt
        self.belt = speed * (np.abs(self.W).sum(axis=0) == 1)

    def accelerations(self, t, q, v, mode, mu=None):
        """Accelerations, and what those of mode 0 bear together."""
        a, w, p = self.loads
        slip = np.abs(self.W.T @ v - self.belt)
        f = a * np.sin(w * t + p) - self.K * q - self.W @ (mode * (mu or self.mu)(slip) * self.N)
        held = self.W[:, mode == 0]
        A = np.block([[np.diag(self.M), -held], [held.T, np.zeros((held.shape[1],) * 2)]])
        x = np.linalg.lstsq(A, np.append(f, np.zeros(held.shape[1])), rcond=None)[0]
        return x[: len(self.M)], held @ x[len(self.M) :]

    def load(self, together, mode):
        """The least part of mu_s N with which those of mode 0 can bear it."""
        held, limit = self.W[:, mode == 0], self.mu_s * self.N[mode == 0]
        k = len(limit)
        if not k:
            return 0.0
        U, s, _ = np.linalg.svd(held)
        U = U[:, : int((s > 1e-10).sum())]
        if U.shape[1] == k:
            return np.abs(np.linalg.lstsq(held, together, rcond=None)[0] / limit).max()
        one, I = -np.ones((k, 1)), np.diag(1 / limit)
        found = linprog(
            np.append(np.zeros(k), 1.0), A_ub=np.block([[I, one], [-I, one]]), b_ub=np.zeros(2 * k),
            A_eq=np.hstack([U.T @ held, 0 * U.T @ held[:, :1]]), b_eq=U.T @ together, bounds=[(None, None)] * (k + 1),
        )  # fmt: skip
        return found.x[-1]

    def decide(self, t, q, v, mode, rest, part, mu=None, first=None):
        at = np.flatnonzero(rest)
        if part < 1.0 and mu is None:
            alike = lambda slip: np.where(rest, self.mu_s, self.mu(slip))  # noqa: E731
            first = tuple(self.decide(t, q, v, mode, rest, part, alike)[at])
        small = 1e-12 if part == 1.0 else 1e-5
        for pattern in sorted(
            itertools.product((0, 1, -1), repeat=len(at)), key=lambda p: (p != first, np.abs(p).sum())
        ):
            new = mode.copy()
            new[at] = pattern
            a, together = self.accelerations(t, q, v, new, mu)
            starts = (new * (self.W.T @ a))[at][new[at] != 0]
            if (starts > (small if part == 1.0 else -small)).all() and self.load(together, new) <= part:
                return new
        raise RuntimeError("no modes")

    def run(self, until):
        n = len(self.M)
        t, q, v, times = 0.0, np.zeros(n), np.zeros(n), []
        mode = np.sign(-self.belt).astype(int)
        mode = self.decide(t, q, v, mode, mode == 0, 1.0)
        while True:
            sol = solve_ivp(
                lambda t, y, mode=mode: np.append(y[n:], self.accelerations(t, y[:n], y[n:], mode)[0]), (t, until),
                np.append(q, v), method="DOP853", rtol=1e-11, atol=1e-13, events=self.ends(mode), max_step=0.05,
            )  # fmt: skip
            t, q, v = sol.t[-1], sol.y[:n, -1], sol.y[n:, -1]
            which = [i for i, found in enumerate(sol.t_events) if len(found)]
            if not which:
                return q, times
            landed = which[0] < len(self.N)
            g = self.W.T @ v - self.belt
            rest = (mode == 0) | (np.abs(g) < 1e-9)
            if landed:
                rest[which[0]] = True
            D = self.W[:, rest] / self.M[:, None]
            v = v - D @ np.linalg.pinv(self.W[:, rest].T @ D) @ g[rest]
            rest |= np.abs(self.W.T @ v - self.belt) < 1e-12
            mode = self.decide(t, q, v, np.where(rest, 0, mode), rest, 1.0 if landed else 1.0 - 1e-9)
            times.append(t)

    def ends(self, mode):
        """For every contact the slip speed (1 while it sticks); behind them what those at rest could still bear."""
        n = len(self.M)

        def stops(t, y, k):
            return mode[k] * (self.W[:, k] @ y[n:] - self.belt[k]) if mode[k] else 1.0

        def bears(t, y):
            return 1.0 - self.load(self.accelerations(t, y[:n], y[n:], mode)[1], mode)

        functions = [lambda t, y, k=k: stops(t, y, k) for k in range(len(self.N))] + [bears]
        for function in functions:
            function.terminal, function.direction = True, -1
        return functions

    def scene(self, law, angle=None):
        """The same with fricmb; with an angle along that direction of the plane."""
        axes = {"x": 1.0} if angle is None else {"x": math.cos(angle), "y": math.sin(angle)}
        belt = fm.Driven("belt", velocity={axis: self.belt.max() * part for axis, part in axes.items()})
        blocks = [fm.Body(f"b{i}", mass=M, axes="".join(axes)) for i, M in enumerate(self.M)]
        parts = [belt, *blocks]
        for i, block in enumerate(blocks):
            a, w, p = self.loads[:, i]
            for axis, part in axes.items():
                load = part * a * sympy.sin(w * fm.t + p)
                parts += [fm.Spring(f"k{i}{axis}", block, axis=axis, stiffness=self.K[i])]
                parts += [fm.Force(f"f{i}{axis}", block, axis=axis, value=load)]
        for k, row in enumerate(self.W.T):
            i, *others = np.flatnonzero(row)[::-1]
            parts.append(fm.Contact(f"c{k}", blocks[i], blocks[others[0]] if others else belt, law=law,
                                    normal_force=self.N[k]))  # fmt: skip
        return fm.Scene("loops", parts)


def two_blocks(mu_s, mu):
    """On the ground, rubbing on each other."""
    contacts = [((1, 0), 1.0), ((0, 1), 1.0), ((-1, 1), 0.7)]
    return Line([1.0, 2.0], [3.0, 5.0], [(1.2, 1.3, 0.0), (1.2, 0.9, 0.4)], contacts, mu_s, mu)


def bricks(mu_s, mu):
    """Two between two belts of one speed, each rubbing on both belts and on the other."""
    contacts = [((1, 0), 0.6), ((1, 0), 0.4), ((0, 1), 0.6), ((0, 1), 0.4), ((-1, 1), 0.5)]
    return Line([1.0, 1.3], [4.0, 5.5], [(0.0, 1.0, 0.0)] * 2, contacts, mu_s, mu, speed=0.05)


def plates(mu_s, mu):
    """Pressed together: each rubs on the ground and on all the others."""
    one = np.eye(3)
    contacts = [(one[i], 0.5 + 0.1 * i) for i in range(3)]
    contacts += [(one[i] - one[j], 0.4 + 0.1 * j) for i in range(3) for j in range(i)]
    loads = [(1.6, 0.7 + 0.2 * i, 0.3 * i) for i in range(3)]
    return Line([1.0, 1.2, 1.4], [3.0, 4.0, 5.0], loads, contacts, mu_s, mu)


LAWS = {
    "coulomb": (0.5, lambda r: 0.5 + 0 * r, fm.laws.Coulomb(mu_s=0.5)),
    "static": (0.8, lambda r: 0.5 + 0 * r, fm.laws.Coulomb(mu_s=0.8, mu_k=0.5)),
    "stribeck": (0.8, lambda r: 0.5 + 0.3 * np.exp(-((r / 0.5) ** 2)), fm.laws.Stribeck(mu_s=0.8, mu_k=0.5, v_s=0.5)),
}
#: Ends of runs and a least number of transitions in them.
SCENES = {two_blocks: (10.0, 10), bricks: (8.0, 2), plates: (4.0, 5)}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("build", SCENES)
def test_loops_of_contacts_against_all_modes(build, law):
    mu_s, mu, own = LAWS[law]
    line = build(mu_s, mu)
    until, least = SCENES[build]
    exact, times = line.run(until)
    assert len(times) >= least
    for method, rtol in itertools.product(("radau", "bdf", "auto"), (1e-4, 1e-6, 1e-9)):
        sol = fm.simulate(line.scene(own), t_end=until, rtol=rtol, method=method)
        np.testing.assert_allclose(sol.q[:, -1], exact, rtol=0, atol=max(30 * rtol, 1e-8), err_msg=f"{method} {rtol}")
        assert any("redundant" in note for note in sol.stats.notes)
        # shares of redundant contacts are not determined: steps must not wait for them
        assert sol.stats.n_steps + sol.stats.n_rejected < 2000
        for k, N in enumerate(line.N):
            assert (np.abs(sol.force(f"c{k}")) <= mu_s * N * (1 + 1e-9)).all()
        for t in times:
            assert np.abs(np.array(sol.events.t) - t).min() < max(100 * rtol, 1e-7)


@METHODS
@pytest.mark.parametrize("law", ["coulomb", "static"])
def test_loops_in_the_plane(method, law):
    mu_s, mu, own = LAWS[law]
    line = two_blocks(mu_s, mu)
    exact, _ = line.run(8.0)
    sol = fm.simulate(line.scene(own, angle=0.7), t_end=8.0, rtol=1e-7, method=method)
    expected = np.outer(exact, [math.cos(0.7), math.sin(0.7)]).ravel()
    np.testing.assert_allclose(sol.q[:, -1], expected, rtol=0, atol=1e-6)


@METHODS
def test_rest_lasts_while_some_shares_of_the_load_hold_it(method):
    # pinched by two unlike pads: equal shares would pass the weaker one's limit at 2, both together bear up to 3.2
    body = fm.Body("held", mass=1.0)
    law = fm.laws.Coulomb(mu_s=0.8, mu_k=0.5)
    pads = [fm.Contact(f"pad{i}", body, law=law, normal_force=N) for i, N in enumerate((1.0, 3.0))]
    scene = fm.Scene("pinched", [body, *pads, fm.Force("pull", body, axis="x", value=fm.t)])
    sol = fm.simulate(scene, t_end=4.0, rtol=1e-8, method=method)
    assert sorted((e.contact, e.kind) for e in sol.events) == [("pad0", "slip"), ("pad1", "slip")]
    assert sol.events.t == pytest.approx([3.2, 3.2], abs=1e-9)
    at = sol.at([1.0, 3.0])
    assert at.force("pad0")[0] == pytest.approx([-0.5, -0.75], abs=1e-9)
    assert at.force("pad1")[0] == pytest.approx([-0.5, -2.25], abs=1e-9)
    # v' = t - 2 from 3.2 on
    assert sol.v[0, -1] == pytest.approx((4.0**2 - 3.2**2) / 2 - 2.0 * 0.8, abs=1e-7)
