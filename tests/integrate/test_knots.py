"""Laws with bends: points of a table, corners of a formula, a peak that the law states; steps end there."""

from dataclasses import dataclass

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

import fricmb as fm
from fricmb.system import build

RTOL = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)
SPEED, MU = (0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.8, 1.2), (1.2, 1.05, 0.95, 0.9, 0.85, 0.83, 0.86, 0.9)


@dataclass(frozen=True, kw_only=True)
class Corner(fm.FrictionLaw):
    """A straight fall to a constant coefficient."""

    mu_s: float
    mu_k: float
    v_0: float

    def define_coefficient(self, r):
        falling = self.mu_s - (self.mu_s - self.mu_k) * r / self.v_0
        return sympy.Piecewise((falling, r < self.v_0), (self.mu_k, True))


@dataclass(frozen=True, kw_only=True)
class Peak(fm.FrictionLaw):
    """A narrow peak away from rest, which the law states."""

    mu: float
    height: float
    place: float
    width: float

    def define_coefficient(self, r):
        return self.mu * (1 - r / 5) + self.height * sympy.exp(-(((r - self.place) / self.width) ** 2))

    def knots(self):
        return (self.place,)


def by_pieces(coefficient, knots, mu_s, belt, grid, fine=()):
    """Block (m = k = N = 1) on a belt that starts with it: each smooth piece by itself, from knot to knot.

    ``coefficient(r, piece)``; ``fine``: pieces with something narrow in them.
    """
    t, y, piece, slips, edges = 0.0, np.array([0.0, belt]), 0, False, [0.0, *knots, np.inf]
    found, events = np.zeros((2, grid.size)), []
    while t < grid[-1]:
        if not slips:
            end = t + (mu_s - y[0]) / belt
            inside = (grid >= t) & (grid <= end)
            found[:, inside] = y[0] + belt * (grid[inside] - t), np.full(inside.sum(), belt)
            t, y, slips, piece = end, np.array([mu_s, belt]), True, 0
            events.append((end, "slip"))
            continue

        def rate(t, y, piece=piece):
            return [y[1], -y[0] + coefficient(belt - y[1], piece)]

        def above(t, y, edge=edges[piece + 1]):
            return belt - y[1] - min(edge, 1e9)

        def below(t, y, edge=edges[piece]):
            return belt - y[1] - edge

        above.terminal = below.terminal = True
        above.direction, below.direction = 1, -1
        run = solve_ivp(
            rate, (t, grid[-1] + 1e-9), y, method="DOP853", rtol=1e-13, atol=1e-15, events=[above, below],
            dense_output=True, max_step=0.002 if piece in fine else np.inf,
        )  # fmt: skip
        inside = (grid >= t) & (grid <= run.t[-1])
        if inside.any():
            found[:, inside] = run.sol(grid[inside])
        t, y = run.t[-1], run.y[:, -1].copy()
        if run.status != 1:
            break
        up = bool(run.t_events[0].size)
        y[1] = belt - edges[piece + 1 if up else piece]
        if not up and piece == 0:
            assert abs(y[0]) <= mu_s
            slips = False
            events.append((t, "stick"))
        piece += 1 if up else -1
    return found, [event for event in events if event[0] < grid[-1]]


def block_on_belt(law, belt):
    block, moving = fm.Body("block", mass=1.0, velocity={"x": belt}), fm.Driven("belt", velocity={"x": belt})
    spring = fm.Spring("spring", block, axis="x", stiffness=1.0)
    return fm.Scene("bends", [block, moving, spring, fm.Contact("sole", block, moving, law=law, normal_force=1.0)])


GRID, BELT = np.linspace(0.0, 20.0, 201), 0.3


def table():
    curve = PchipInterpolator(SPEED, MU)
    pieces = [np.poly1d(curve.c[:, i]) for i in range(len(SPEED) - 1)]
    found = by_pieces(lambda r, i: pieces[i](r - SPEED[i]), SPEED[1:], 1.4, BELT, GRID)
    return fm.laws.Tabulated(speed=SPEED, mu=MU, mu_s=1.4), BELT, found, RTOL


def corner():
    found = by_pieces(lambda r, i: 1.4 - 0.4 * r / 0.15 if i == 0 else 1.0, (0.15,), 1.4, BELT, GRID)
    return Corner(mu_s=1.4, mu_k=1.0, v_0=0.15), BELT, found, RTOL


def peak():
    law, belt = Peak(mu=1.0, height=0.5, place=0.3, width=2e-4), 0.5

    def coefficient(r, _):
        return 1.0 - r / 5 + 0.5 * np.exp(-(((r - 0.3) / 2e-4) ** 2))

    # what it brings is less than a looser tolerance, and grows by 50
    return law, belt, by_pieces(coefficient, (0.299, 0.3, 0.301), 1.0, belt, GRID, fine=(1, 2)), RTOL[2:]


@pytest.mark.parametrize("make", [table, corner, peak])
def test_laws_with_bends_are_as_exact_as_is_asked_for(make):
    law, belt, ((q, v), events), tolerances = make()
    scene, worst = block_on_belt(law, belt), {}
    for method in ("auto", "radau", "bdf"):
        for rtol in tolerances:
            sol = fm.simulate(scene, t_end=GRID[-1], rtol=rtol, method=method, t_eval=GRID)
            assert [e.kind for e in sol.events] == [kind for _, kind in events]
            error = max(np.abs(sol.q[0] - q).max() / np.abs(q).max(), np.abs(sol.v[0] - v).max() / np.abs(v).max())
            worst[method, rtol] = error / rtol
    assert max(worst.values()) < 10.0, worst


def test_steps_end_where_slip_in_two_directions_passes_a_point_of_a_table():
    """Mass on springs above a fast belt: it always slips; from knot to knot by another program."""
    law = fm.laws.Tabulated(speed=SPEED, mu=MU)
    body, belt = fm.Body("m", mass=1.0, axes="xy"), fm.Driven("belt", velocity={"x": 0.6})
    springs = [fm.Spring(f"k{c}", body, axis=c, stiffness=k) for c, k in (("x", 1.0), ("y", 2.3))]
    start = {"position": {"m.x": 0.5, "m.y": 0.4}, "velocity": {"m.x": 0.1}}
    scene = fm.Scene("plane", [body, belt, *springs, fm.Contact("c", body, belt, law=law, normal_force=0.2)])
    grid, curve = np.linspace(0.0, 12.0, 121), PchipInterpolator(SPEED, MU)
    edges = [*SPEED, np.inf]
    t, y, found = 0.0, np.array([0.5, 0.4, 0.1, 0.0]), np.zeros((4, grid.size))
    piece = int(np.searchsorted(SPEED, 0.5, side="left")) - 1
    while t < grid[-1]:
        part = np.poly1d(curve.c[:, piece]) if piece < len(SPEED) - 1 else np.poly1d([MU[-1]])

        def rate(t, y, part=part, foot=SPEED[piece]):
            g = np.array([y[2] - 0.6, y[3]])
            push = -0.2 * part(np.hypot(*g) - foot) * g / np.hypot(*g)
            return [y[2], y[3], -y[0] + push[0], -2.3 * y[1] + push[1]]

        def leaves(t, y, low=edges[piece], high=edges[piece + 1]):
            r = np.hypot(y[2] - 0.6, y[3])
            return min(r - low, high - r)

        leaves.terminal, leaves.direction = True, -1
        run = solve_ivp(
            rate, (t, grid[-1] + 1e-9), y, method="DOP853", rtol=1e-13, atol=1e-15, events=leaves, dense_output=True
        )
        inside = (grid >= t) & (grid <= run.t[-1])
        if inside.any():
            found[:, inside] = run.sol(grid[inside])
        t, y = run.t[-1], run.y[:, -1]
        if run.status != 1:
            break
        piece += 1 if np.hypot(y[2] - 0.6, y[3]) > 0.5 * (edges[piece] + min(edges[piece + 1], 1e9)) else -1
    worst = {}
    for method in ("radau", "bdf"):
        for rtol in RTOL:
            sol = fm.simulate(scene, t_end=12.0, rtol=rtol, method=method, t_eval=grid, initial=start)
            error = np.abs(np.vstack([sol.q, sol.v]) - found).max(axis=1) / np.abs(found).max(axis=1)
            worst[method, rtol] = error.max() / rtol
    assert max(worst.values()) < 10.0, worst


def knots_of(law):
    return build(block_on_belt(law, 0.3)).problem.contacts.knots


def test_formulas_tell_their_own_bends():
    assert knots_of(Corner(mu_s=1.4, mu_k=1.0, v_0=0.15)) == pytest.approx([0.15], abs=1e-15)
    assert knots_of(fm.laws.Tabulated(speed=SPEED, mu=MU)).tolist() == list(SPEED[1:])
    assert knots_of(Peak(mu=1.0, height=0.5, place=0.3, width=2e-4)).tolist() == [0.3]
    assert knots_of(fm.laws.Stribeck(mu_s=1.4, mu_k=1.0, v_s=0.1)).size == 0

    @dataclass(frozen=True, kw_only=True)
    class Several(fm.FrictionLaw):
        """Bends at v_0, where a square passes another one, and where a logarithm passes a number."""

        mu_s: float
        v_0: float

        def define_coefficient(self, r):
            steep = sympy.Max(0, 1 - r**2 / (4 * self.v_0**2)) + sympy.Abs(r - self.v_0) / 100
            return self.mu_s / 2 + steep / 10 + sympy.Min(sympy.log(1 + r), 1) / 1000

    assert knots_of(Several(mu_s=1.4, v_0=0.25)) == pytest.approx([0.25, 0.5, np.e - 1], rel=1e-12)


@dataclass(frozen=True, kw_only=True)
class LoadedCorner(fm.FrictionLaw):
    """Constant up to a slip speed that is in proportion to the load, and rising from there."""

    mu: float
    per_load: float
    rise: float

    def define_coefficient(self, r, N):
        corner = self.per_load * N
        return sympy.Piecewise((self.mu, r < corner), (self.mu + self.rise * (r - corner), True))


def thrown(normal_force, axes="x"):
    """A block on a spring, thrown over the ground."""
    block = fm.Body("block", mass=1.0, axes=axes, velocity={"x": 3.0})
    law = LoadedCorner(mu=0.1, per_load=0.5, rise=0.3)
    spring = fm.Spring("spring", block, axis="x", stiffness=4.0)
    return fm.Scene("thrown", [block, spring, fm.Contact("sole", block, axes="x", law=law, normal_force=normal_force)])


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
def test_a_bend_whose_place_depends_on_a_constant_load(method, rtol):
    """m = 1, k = 4, N = 2: above v = 1 friction is 2 (0.1 + 0.3 (v - 1)), below 0.2; each piece by itself."""

    def fast(t, y):
        return [y[1], -4.0 * y[0] - 0.2 - 0.6 * (y[1] - 1.0)]

    def slow(t, y):
        return [y[1], -4.0 * y[0] - 0.2]

    def corner(t, y):
        return y[1] - 1.0

    corner.terminal = True
    exact = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14, "dense_output": True}
    first = solve_ivp(fast, (0.0, 1.0), [0.0, 3.0], events=corner, **exact)
    second = solve_ivp(slow, (first.t[-1], 0.65), first.y[:, -1], **exact)
    grid = np.linspace(0.0, 0.65, 131)
    found = np.where(grid < first.t[-1], first.sol(grid), second.sol(grid))
    sol = fm.simulate(thrown(2.0), t_end=0.65, t_eval=grid, rtol=rtol, method=method)
    assert second.y[1, -1] > 0.0
    assert np.abs(np.vstack([sol.q, sol.v]) - found).max() < 3.0 * rtol


def test_bends_that_depend_on_the_load_are_known_where_it_is_constant():
    assert build(thrown(2.0)).problem.contacts.knots == pytest.approx([1.0], abs=1e-15)
    pressed = thrown(fm.normal.Spring(axis="y", stiffness=1.0, preload=2.0), axes="xy")
    assert build(pressed).problem.contacts.knots.size == 0
