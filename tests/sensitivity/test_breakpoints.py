"""Breakpoints of functions of time that a parameter moves: closed forms and differences of runs."""

import numpy as np
import pytest
import sympy

import fricmb as fm

from .differences import difference, worst


def test_load_that_sets_in():
    """x'' + x = F after t_b: dx/dt_b = -F sin(t - t_b)."""
    begin = fm.parameter("begin", 1.3)
    block = fm.Body("block", mass=1.0)
    load = fm.Force("load", block, axis="x", value=2.0 * sympy.Heaviside(fm.t - begin))
    scene = fm.Scene("load", [block, fm.Spring("spring", block, axis="x", stiffness=1.0), load])
    sol = fm.simulate(scene, t_end=3.0, rtol=1e-10, sensitivities=("begin",))
    after = sol.t >= 1.3 + 1e-9
    assert sol.sensitivity("block.x", "begin")[after] == pytest.approx(-2.0 * np.sin(sol.t[after] - 1.3), abs=1e-8)
    assert np.all(sol.sensitivity("block.x", "begin")[sol.t < 1.3] == 0.0)


def belt(speed, *more, mu_s=0.7):
    moving, block = fm.Driven("belt", velocity={"x": speed}), fm.Body("block", mass=1.3, position={"x": 0.2})
    spring = fm.Spring("spring", block, axis="x", stiffness=1.5)
    rub = fm.Contact("rub", block, moving, law=fm.laws.Coulomb(mu_s=mu_s, mu_k=0.5), normal_force=1.0)
    return fm.Scene("belt", [moving, block, spring, rub, *(make(block, moving) for make in more)])


def of_belt():
    switch, speed = fm.parameter("switch", 5.0), fm.parameter("speed", 0.4)
    return sympy.Piecewise((speed, fm.t < switch), (2 * speed, True))


@pytest.mark.parametrize("method", ["auto", "radau"])
@pytest.mark.parametrize("at", [0.25, 1.05, 5.0])
def test_belt_that_jumps(method, at):
    """In slip, and in stick, which ends there."""
    value = of_belt()
    scene = belt(value).with_parameters({"switch": at})
    found = worst(scene, ("switch", "speed", "rub.law.mu_k"), rtol=1e-8, t_end=9.0, method=method)
    assert len(found) == 3
    assert max(found.values()) < 1e3, found


def test_spring_to_a_belt_that_jumps():
    """The position of a motion given by its velocity moves with the breakpoint as well."""
    value = of_belt()
    scene = belt(value, lambda block, moving: fm.Spring("tie", block, moving, axis="x", stiffness=0.2))
    found = worst(scene, ("switch", "speed"), rtol=1e-8, t_end=9.0)
    assert len(found) == 2
    assert max(found.values()) < 1e3, found


def test_square_wave_whose_frequency_changes():
    """Breakpoints that are searched, each moved by -t/omega."""
    omega = fm.parameter("omega", 1.1)
    wave = 0.3 * sympy.sign(sympy.sin(omega * fm.t + 0.2))
    scene = belt(0.3, lambda block, _: fm.Force("wave", block, axis="x", value=wave))
    found = worst(scene, ("omega", "spring.stiffness"), rtol=1e-8, step=2e-4, t_end=11.0)
    assert len(found) == 2
    assert max(found.values()) < 1e3, found


def test_load_that_makes_slip_begin():
    """A jump of the load beyond what sticks: slip begins at the breakpoint."""
    begin = fm.parameter("begin", 1.7)
    block = fm.Body("block", mass=1.0)
    scene = fm.Scene("pushed", [
        block, fm.Spring("spring", block, axis="x", stiffness=1.0),
        fm.Force("load", block, axis="x", value=sympy.Piecewise((0.0, fm.t < begin), (1.5, True))),
        fm.Contact("rub", block, law=fm.laws.Coulomb(mu_s=0.6, mu_k=0.4), normal_force=1.0),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=4.0, rtol=1e-8, sensitivities=("begin",))
    assert next(e.kind for e in sol.events) == "slip"
    assert sol.events[0].sensitivity("begin") == pytest.approx(1.0, abs=1e-14)
    value, _ = difference(scene, "begin", t_end=4.0)
    assert sol.derivatives.end[:, 0] == pytest.approx(value[:2], abs=1e-6)
    assert not sol.stats.notes


def test_breakpoints_that_move_apart_are_refused():
    one, other = fm.parameter("one", 1.0), fm.parameter("other", 1.0)
    block = fm.Body("block", mass=1.0)
    loads = [
        fm.Force(p.name + "_load", block, axis="x", value=sympy.Heaviside(fm.t - p)) for p in (one, other)
    ]  # fmt: skip
    scene = fm.Scene("two", [block, fm.Spring("spring", block, axis="x", stiffness=1.0), *loads])
    with pytest.raises(fm.SceneError, match=r"one_load.*other_load.*'one' moves apart"):
        fm.simulate(scene, t_end=2.0, sensitivities=("one",))


@pytest.mark.parametrize("at", [0.3, 4.0])
def test_belt_that_jumps_under_slip_in_two_directions(at):
    """In slip, and in stick, which ends there with a speed."""
    value = of_belt()
    moving = fm.Driven("belt", velocity={"x": value})
    block = fm.Body("block", mass=1.0, axes="xy", velocity={"y": 0.4})
    springs = [fm.Spring("kx", block, axis="x", stiffness=0.3), fm.Spring("ky", block, axis="y", stiffness=0.5)]
    rub = fm.Contact("rub", block, moving, law=fm.laws.Coulomb(mu_s=0.9), normal_force=1.0, axes="xy")
    scene = fm.Scene("puck", [moving, block, *springs, rub]).with_parameters({"switch": at, "speed": 0.1})
    found = worst(scene, ("switch", "speed", "kx.stiffness"), rtol=1e-8, t_end=5.0, events=False)
    assert len(found) == 3
    assert max(found.values()) < 1e3, found
