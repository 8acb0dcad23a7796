"""Modes left out: the estimate that the plan prints, against runs with all modes."""

import re

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.plan import truncated

N = 40
OMEGA = np.pi * (np.arange(1, N + 1) - 0.5)


def bar(truncation, **changes):
    """A bar fixed at one end whose other end rubs on a belt: modes sqrt(2) sin(w x) of unit mass."""
    shapes = {"tip": np.sqrt(2) * np.sin(OMEGA)[None], "middle": np.sqrt(2) * np.sin(0.6 * OMEGA)[None]}
    body = fm.ModalBody("bar", frequencies=OMEGA, damping_ratios=0.02, shapes=shapes, truncation=truncation, **changes)
    belt = fm.Driven("belt", velocity={"x": 0.5})
    law = fm.laws.Coulomb(mu_s=1.0, mu_k=0.7)
    return fm.Scene("bar", [body, belt, fm.Contact("rub", body.point("tip"), belt, law=law, normal_force=1.0)])


def estimate(scene):
    (note,) = scene.plan().notes
    return float(re.search(r"at most about (\S+) of its elastic part", note)[1])


@pytest.fixture(scope="module")
def full():
    return fm.simulate(bar(None), t_end=3.0, rtol=1e-8, t_eval=np.linspace(0, 3, 601))


@pytest.mark.parametrize("tolerance", [0.3, 0.1, 0.03])
def test_the_error_is_within_the_estimate_and_near_it(full, tolerance):
    scene = bar(tolerance)
    short = fm.simulate(scene, t_end=3.0, rtol=1e-8, t_eval=full.t)
    assert len(short.dof_names) < N / 2
    assert short.dof_names[-1] == "bar.residual1"
    promised = estimate(scene)
    assert promised <= tolerance
    for point in ("bar.tip.x", "bar.middle.x"):
        error = np.abs(short[point] - full[point]).max() / np.abs(full["bar.tip.x"]).max()
        assert promised / 50 < error < promised


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.0, 0.01, 0.1])
@pytest.mark.parametrize("loads", ["one", "several", "slow", "resonant", "vibrating belt"])
def test_the_estimate_holds_for_many_loads_and_dampings(loads, ratio):
    """Loads near a mode that would be left out keep it; undamped runs are compared until transitions part."""
    shapes = {p: np.sqrt(2) * np.sin(x * OMEGA)[None] for p, x in (("tip", 1.0), ("middle", 0.6), ("third", 0.31))}
    speed = 0.5 + (0.2 * sympy.sin(OMEGA[7] * fm.t) if loads == "vibrating belt" else 0)
    belt = fm.Driven("belt", velocity={"x": speed})
    law = fm.laws.Coulomb(mu_s=1.0, mu_k=0.7)

    def scene(truncation):
        body = fm.ModalBody("bar", frequencies=OMEGA, damping_ratios=ratio, shapes=shapes, truncation=truncation)
        at = {"tip": 0.5, "middle": 0.3, "third": 0.4} if loads == "several" else {"tip": 1.0}
        parts = [fm.Contact(f"on {p}", body.point(p), belt, law=law, normal_force=N) for p, N in at.items()]
        if loads in ("slow", "resonant"):
            omega = fm.parameter("omega", 2.0 if loads == "slow" else float(OMEGA[5]))
            value = 0.5 * sympy.sin(fm.t * omega)
            parts.append(fm.Force("push", body.point("middle"), axis="x", value=value))
        return fm.Scene(loads, [body, belt, *parts])

    full = fm.simulate(scene(None), t_end=0.9, rtol=1e-7, t_eval=np.linspace(0, 0.9, 301))
    short = fm.simulate(scene(0.1), t_end=0.9, rtol=1e-7, t_eval=full.t)
    promised = estimate(scene(0.1))
    if loads == "resonant":
        assert "bar.mode6" in short.dof_names
    error = np.abs(short["bar.tip.x"] - full["bar.tip.x"]).max() / np.abs(full["bar.tip.x"]).max()
    assert promised / 100 < error < promised


def test_static_flexibility_is_that_of_all_modes():
    (body,) = [part for part in truncated(bar(0.1)).scene.parts if isinstance(part, fm.ModalBody)]
    tip, middle = body.shapes["tip"][0], body.shapes["middle"][0]
    omega = np.array(body.frequencies)
    assert np.sum(tip**2 / omega**2) == pytest.approx(np.sum(2 * np.sin(OMEGA) ** 2 / OMEGA**2), rel=1e-12)
    assert np.sum(tip * middle / omega**2) == pytest.approx(
        np.sum(2 * np.sin(OMEGA) * np.sin(0.6 * OMEGA) / OMEGA**2), rel=1e-12
    )


def test_what_a_start_needs_is_kept():
    scene = bar(0.3, position={"mode20": 1e-3})
    names = fm.simulate(scene, t_end=0.1).dof_names
    assert "bar.mode20" in names
    assert "bar.mode21" not in names


def test_modes_that_nothing_excites_are_left_out_without_error():
    shapes = {"tip": [[1.0, 0.0, 0.5, 0.0]]}
    body = fm.ModalBody("b", frequencies=[1.0, 2.0, 3.0, 4.0], damping_ratios=0.0, shapes=shapes)
    scene = fm.Scene("s", [body, fm.Force("f", body.point("tip"), axis="x", value=1.0)])
    plan = scene.plan()
    assert {item.names for item in plan.resting} == {("b.mode2",), ("b.mode4",)}
    sol = fm.simulate(scene, t_end=5.0, rtol=1e-10)
    assert not sol["b.mode2"].any()
    np.testing.assert_allclose(sol["b.mode1"], 1 - np.cos(sol.t), atol=1e-9)


def test_all_modes_where_all_are_needed():
    scene = bar(1e-9)
    assert "all 40 modes are needed" in str(scene.plan())
    assert len(truncated(scene).scene.dof_names) == N


def test_coupled_damping_is_not_truncated():
    scene = bar(0.1)
    damped = scene.replace("bar", damping=0.1 * np.eye(N), damping_ratios=0.0)
    assert "damping couples them" in str(damped.plan())


def test_masses_and_damping_are_those_of_the_modes():
    heavy = bar(0.1).replace("bar", masses=4.0 * np.ones(N))
    (body,) = [part for part in truncated(heavy).scene.parts if isinstance(part, fm.ModalBody)]
    assert set(body.masses[: -body.residual]) == {4.0}
    flexible = np.sum(body.shapes["tip"][0] ** 2 / np.array(body.masses) / np.array(body.frequencies) ** 2)
    assert flexible == pytest.approx(np.sum(2 * np.sin(OMEGA) ** 2 / OMEGA**2) / 4, rel=1e-12)
    np.testing.assert_allclose(body.damping_ratios[: -body.residual], 0.02)
    assert body.damping_ratios[-1] == pytest.approx(0.02, rel=0.2)
