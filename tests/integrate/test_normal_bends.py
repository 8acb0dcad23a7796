"""Normal-force laws of one's own that bend with the approach: progressive pads, clearance, forces cut at 0."""

from dataclasses import dataclass

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm

RTOL = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)


@dataclass(frozen=True, kw_only=True)
class Bilinear(fm.normal.NormalLaw):
    """A pad that is stiffer beyond a gap; N goes on below 0 where it opens."""

    soft: float
    stiff: float
    gap: float

    def define_normal(self, e, e_dot):
        return self.preload - self.soft * e + self.stiff * sympy.Max(0, -e - self.gap)


@dataclass(frozen=True, kw_only=True)
class Cut(fm.normal.NormalLaw):
    """Hertz's law with damping as most would write it: 0 where the bodies are apart, by a power or by pieces."""

    stiffness: float
    damping: float
    pieces: bool = False

    def define_normal(self, e, e_dot):
        if self.pieces:
            return sympy.Piecewise((self.stiffness * (-e) ** 1.5 * (1 - self.damping * e_dot), e < 0), (0, True))
        return self.stiffness * sympy.Max(0, -e) ** sympy.Rational(3, 2) * (1 - self.damping * e_dot)


@dataclass(frozen=True, kw_only=True)
class CutKelvin(fm.normal.NormalLaw):
    """Spring and damper, cut at 0 by hand."""

    stiffness: float
    damping: float

    def define_normal(self, e, e_dot):
        return sympy.Max(0, -self.stiffness * e - self.damping * e_dot)


def by_pieces(rate, sides, start, grid):
    """Motion under ``rate(t, y, beyond)``, each smooth piece by itself; ``sides`` are above 0 beyond their bends."""
    t, y, found = 0.0, np.array(start), np.zeros((len(start), grid.size))
    beyond = [side(y) > 0.0 for side in sides]
    while t < grid[-1]:
        events = []
        for side, is_beyond in zip(sides, beyond, strict=True):

            def passes(_, y, side=side):
                return side(y)

            passes.terminal, passes.direction = True, -1 if is_beyond else 1
            events.append(passes)
        run = solve_ivp(
            lambda t, y, at=tuple(beyond): rate(t, y, at), (t, grid[-1]), y, method="DOP853", rtol=1e-13, atol=1e-15,
            dense_output=True, events=events, max_step=0.05,
        )  # fmt: skip
        inside = (grid >= t) & (grid <= run.t[-1])
        if inside.any():
            found[:, inside] = run.sol(grid[inside])
        t, y = run.t[-1], run.y[:, -1]
        beyond = [b != bool(at.size) for b, at in zip(beyond, run.t_events, strict=True)]
        if run.status != 1:
            break
    return found


def pressed(law, load, start):
    """A block on a fast belt, which only slips, shaken against its normal-force law."""
    block, belt = fm.Body("m", mass=1.0, axes="xy", position={"y": start}), fm.Driven("belt", velocity={"x": 9.0})
    parts = [
        fm.Spring("k", block, axis="x", stiffness=20.0),
        fm.Damper("c", block, axis="y", damping=0.3),
        fm.Force("f", block, axis="y", value=load * sympy.sin(3 * fm.t)),
        fm.Contact("pad", block, belt, law=fm.laws.Coulomb(mu_s=0.4), normal_force=law),
    ]
    return fm.Scene("pressed", [block, belt, *parts])


def motion_of_pressed(law, load, start, grid):
    """The same by its own equations."""

    def rate(t, s, beyond):
        apart, further = beyond
        N = 0.0 if apart else law.preload - law.soft * s[1] + (law.stiff * (-s[1] - law.gap) if further else 0.0)
        push = load * np.sin(3 * t) - 0.3 * s[3] + N - law.preload
        return [s[2], s[3], -20 * s[0] + 0.4 * N, push]

    sides = (lambda s: s[1] - law.preload / law.soft, lambda s: -s[1] - law.gap)
    return by_pieces(rate, sides, [0.0, start, 0.0, 0.0], grid)


@pytest.mark.parametrize(("gap", "load"), [(0.1, 6.0), (0.0, 2.0)])
def test_a_pad_that_grows_stiffer_is_as_exact_as_is_asked_for(gap, load):
    law = Bilinear(axis="y", soft=50.0, stiff=400.0, gap=gap, preload=4.0)
    grid, worst = np.linspace(0.0, 10.0, 201), {}
    found = motion_of_pressed(law, load, 0.01, grid)
    scene = pressed(law, load, 0.01)
    for method in ("auto", "radau", "bdf"):
        for rtol in RTOL:
            sol = fm.simulate(scene, t_end=10.0, rtol=rtol, method=method, t_eval=grid)
            gaps = np.abs(np.vstack([sol.q, sol.v]) - found).max(axis=1) / np.abs(found).max(axis=1)
            worst[method, rtol] = gaps.max() / rtol
    assert max(worst.values()) < 20.0, worst
    with pytest.raises(fm.SceneError, match="collocation takes"):
        fm.simulate(scene, t_end=1.0, method="collocation")


@pytest.mark.parametrize("pieces", [False, True])
@pytest.mark.parametrize("rtol", RTOL)
def test_a_force_that_is_cut_at_zero_opens_and_closes(rtol, pieces):
    """Own Hertz laws that are 0 beyond their opening have the transitions and the motion of the built-in one."""
    grid = np.linspace(0.0, 3.0, 61)
    same = fm.normal.Hertz(axis="y", stiffness=2e3, damping=0.3)
    own = Cut(axis="y", stiffness=2e3, damping=0.3, pieces=pieces)
    known = fm.simulate(dropped(same), t_end=3.0, rtol=1e-12, method="radau", t_eval=grid)
    assert {e.kind for e in known.events} == {"open", "close"}
    sol = fm.simulate(dropped(own), t_end=3.0, rtol=rtol, t_eval=grid)
    assert [e.kind for e in sol.events] == [e.kind for e in known.events]
    assert np.abs(sol["m.y"] - known["m.y"]).max() < 20.0 * rtol * np.abs(known["m.y"]).max()
    np.testing.assert_array_equal(sol.mode("pad")[1:-1], known.mode("pad")[1:-1])
    assert np.abs(sol.energy.residual).max() < 1e-4


def dropped(law):
    """A block that falls on a belt and bounces."""
    block, belt = fm.Body("m", mass=1.0, axes="xy", position={"y": 0.1}), fm.Driven("belt", velocity={"x": 60.0})
    parts = [
        fm.Spring("k", block, axis="x", stiffness=20.0),
        fm.Force("weight", block, axis="y", value=-10.0),
        fm.Contact("pad", block, belt, law=fm.laws.Coulomb(mu_s=0.3), normal_force=law),
    ]
    return fm.Scene("dropped", [block, belt, *parts])


def test_spring_and_damper_cut_by_hand():
    """``Max(0, ...)`` around a whole law is the cut that is made anyway: nothing bends, and its energy is known."""
    law = CutKelvin(axis="y", stiffness=1e3, damping=3.0)
    same = fm.normal.Spring(axis="y", stiffness=1e3, damping=3.0)
    own, known = (fm.simulate(dropped(each), t_end=3.0, rtol=1e-9) for each in (law, same))
    assert own.stats.method == known.stats.method == "radau"
    assert [e.t for e in own.events] == pytest.approx([e.t for e in known.events], rel=1e-9)
    assert own.energy.potential[-1] == pytest.approx(known.energy.potential[-1], rel=1e-7)


def test_a_tip_on_a_progressive_pad():
    """In a mechanism: an arm on a pin whose tip is borne by a pad that grows stiffer, on a belt."""
    mass, inertia, length, reach = 1.3, 0.2, 0.7, 1.4
    law = Bilinear(axis="y", soft=200.0, stiff=2e3, gap=0.05)
    grid = np.linspace(0.0, 4.0, 81)

    def rate(t, s, beyond):
        apart, further = beyond
        height = reach * np.sin(s[0])
        N = 0.0 if apart else -law.soft * height + (law.stiff * (-height - law.gap) if further else 0.0)
        moment = -mass * 9.81 * length * np.cos(s[0]) + N * reach * np.cos(s[0]) - 0.2 * N * reach * np.sin(s[0])
        return [s[1], moment / (inertia + mass * length**2)]

    sides = (lambda s: reach * np.sin(s[0]), lambda s: -reach * np.sin(s[0]) - law.gap)
    found = by_pieces(rate, sides, [0.1, 0.0], grid)
    place = (length * np.cos(0.1), length * np.sin(0.1))
    points = {"pin": (-length, 0.0), "tip": (reach - length, 0.0)}
    arm = fm.RigidBody("arm", mass=mass, inertia=inertia, angle=0.1, position=place, points=points)
    belt = fm.Driven("belt", velocity={"x": 60.0})
    parts = [
        fm.Revolute("pin", arm.point("pin")),
        fm.Gravity("gravity"),
        fm.Contact("pad", arm.point("tip"), belt, law=fm.laws.Coulomb(mu_s=0.2), normal_force=law, axes="x"),
    ]
    scene, worst = fm.Scene("arm", [arm, belt, *parts]), {}
    for method in ("radau", "bdf"):
        for rtol in RTOL:
            sol = fm.simulate(scene, t_end=4.0, rtol=rtol, method=method, t_eval=grid)
            gaps = np.abs(np.array([sol["arm.angle"], sol.velocity("arm.angle")]) - found).max(axis=1)
            worst[method, rtol] = (gaps / np.abs(found).max(axis=1)).max() / rtol
    assert max(worst.values()) < 20.0, worst


@dataclass(frozen=True, kw_only=True)
class NoIntegral(fm.normal.NormalLaw):
    """A law whose energy SymPy does not find."""

    stiffness: float

    def define_normal(self, e, e_dot):
        return self.stiffness * sympy.log(1 + sympy.exp(-e / 0.01))


def test_a_law_without_a_known_integral_says_what_gives_it():
    with pytest.raises(fm.LawError, match=r"NoIntegral: .*define_stored\(self, e\)"):
        fm.simulate(dropped(NoIntegral(axis="y", stiffness=10.0)), t_end=0.1)


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("rtol", [1e-8, 3e-11, 1e-11, 1e-12])
def test_free_fall_above_a_contact(rtol, method):
    """Steps whose start is right to round-off: no iteration takes anything away, and that was no convergence."""
    grid = np.linspace(0.0, 0.14, 15)
    scene = dropped(fm.normal.Spring(axis="y", stiffness=2e3))
    sol = fm.simulate(scene, t_end=1.0, rtol=rtol, method=method)
    assert sol.events[0].t == pytest.approx(np.sqrt(0.02), rel=1e-12)
    np.testing.assert_allclose(sol.at(grid)["m.y"], 0.1 - 5.0 * grid**2, atol=1e-15)
    omega, bounce = np.sqrt(2e3), sol.events[1].t - sol.events[0].t
    held = 2.0 / omega * (np.pi - np.arctan(np.sqrt(2.0) * omega / 10.0))  # pressed by weight and the spring alone
    assert bounce == pytest.approx(held, rel=20.0 * rtol)
