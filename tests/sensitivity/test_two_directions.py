"""Derivatives through slip in two directions: the brake against certified digits, other cases against differences."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb import models
from tests.oracle.random_scenes import generate
from tests.oracle.space import case_of
from tests.oracle.spec import scene as scene_of
from tests.oracle.table import case

from .differences import said, shares_off, worst

#: Derivatives of case 2 at t = 20 and of its transitions, from an event-driven solution in desingularised time,
#: confirmed by differences of runs; columns: friction mu N, rotor mass R, initial velocities, frequencies.
REFERENCE = json.loads(Path(__file__).with_name("brake4dof_case2.json").read_text())
NAMES = (
    "lining.normal_force", "rotor.mass", "rotor.velocity.x", "rotor.velocity.y", "k1y.stiffness", "k2y.stiffness",
)  # fmt: skip


def as_in_the_reference(values):
    """Derivatives by mass, frequencies instead of stiffnesses: k1y = Omega1^2, k2y = R Omega2^2."""
    slow, fast = REFERENCE["values"]["Omega2"], REFERENCE["values"]["Omega1"]
    found = values.copy()
    found[:, 1] += slow**2 * values[:, 5]
    found[:, 4] *= 2.0 * fast
    found[:, 5] *= 2.0 * REFERENCE["values"]["R"] * slow
    return found


@pytest.mark.parametrize("method", ["auto", "radau"])
def test_brake(method):
    sol = fm.simulate(models.brake4dof(case=2), t_end=20.0, rtol=1e-8, method=method, sensitivities=NAMES)
    expected = np.array(REFERENCE["S"])[:, :6]
    error = np.abs(as_in_the_reference(sol.derivatives.end) - expected) / np.abs(expected).max(axis=0)
    assert error.max() < 1e-6
    assert [event.kind for event in sol.events] == [kind for kind, _, _ in REFERENCE["events"]]
    moved = as_in_the_reference(np.array([[event.sensitivity(name) for name in NAMES] for event in sol.events]))
    expected = np.array([row for _, _, row in REFERENCE["events"]])[:, :6]
    error = np.abs(moved - expected) / np.abs(expected).max(axis=0)
    assert error.max() < (1e-6 if method == "auto" else 1e-5)


def puck(law):
    """A block on a belt that moves along x, pulled along y."""
    belt, block = fm.Driven("belt", velocity={"x": 0.3}), fm.Body("block", mass=1.0, axes="xy", velocity={"y": 0.4})
    springs = [fm.Spring("kx", block, axis="x", stiffness=1.0), fm.Spring("ky", block, axis="y", stiffness=2.3)]
    rub = fm.Contact("rub", block, belt, law=law, normal_force=1.0, axes="xy")
    return fm.Scene("puck", [block, belt, *springs, rub])


NAMES_OF_PUCK = ("belt.velocity.x", "rub.normal_force", "kx.stiffness", "block.velocity.y", "block.mass")


@pytest.mark.parametrize("law", [fm.laws.Coulomb(mu_s=0.5), fm.laws.Coulomb(mu_s=0.6, mu_k=0.4)])
def test_block_on_a_belt(law):
    found = worst(puck(law), NAMES_OF_PUCK, rtol=1e-8, t_end=12.0)
    assert set(found) == set(NAMES_OF_PUCK)
    assert max(found.values()) < 1e3


def test_landing_whose_direction_hardly_settles():
    """Towards the second landing the direction settles like the fifth root of time."""
    scene = puck(fm.laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.2))
    found = worst(scene, NAMES_OF_PUCK, rtol=1e-8, t_end=12.0)
    assert set(found) == set(NAMES_OF_PUCK)
    assert max(found.values()) < 1e3


def test_anisotropic_friction():
    """Half as much friction again along y; the ratio of the axes is a parameter as well."""
    scene = puck(fm.laws.Elliptic(law=fm.laws.Coulomb(mu_s=0.6, mu_k=0.4), ratio=1.5))
    names = ("rub.law.ratio", "rub.law.law.mu_k", "rub.law.law.mu_s", "belt.velocity.x", "block.mass")
    found = worst(scene, names, rtol=1e-8, t_end=12.0)
    assert set(found) == set(names)
    assert max(found.values()) < 1e3


#: Derivatives of the time of the last landing, by Richardson's differences of runs at 1e-12; surer than 3e-7.
SLOW = {
    0: {"c0.law.mu_k": -0.05122584356851546, "b0.position.y": -0.02627608549620354, "b0.mass": 0.8483062822538415},
    6: {"belt.velocity.x": -1.1567304791080602, "k1.stiffness": 0.2509621030680536},
}


@pytest.mark.parametrize("seed", list(SLOW))
def test_landing_that_settles_too_slowly_says_so(seed):
    """Of a landing that hardly settles the time is known less well than the tolerance asks: a note says how well."""
    spec = generate("plane", seed)
    t_end = min(spec.t_end, 7.0)
    sol = fm.simulate(scene_of(spec), t_end=t_end, rtol=1e-8, sensitivities=tuple(SLOW[seed]))
    note = next(note for note in sol.stats.notes if "before its direction has settled" in note)
    for name, exact in SLOW[seed].items():
        named = note.split(f"{name!r} to ")
        said = float(named[1].split()[0].rstrip(",")) if len(named) > 1 else 1e3 * 1e-8
        assert abs(sol.events[-1].sensitivity(name) / exact - 1.0) < said < 1e-3


def test_slip_that_ends_is_projected():
    """M-orthogonal projection: S_v+ = S_v- - M^-1 W D^-1 (W^T S_v- - w_p)."""
    sol = fm.simulate(puck(fm.laws.Coulomb(mu_s=0.5)), t_end=12.0, rtol=1e-10, sensitivities=("belt.velocity.x",))
    stick = next(event for event in sol.events if event.kind == "stick")
    i = int(np.searchsorted(sol.t, stick.t)) + 1
    assert sol.mode("rub")[i] == 0
    assert sol.sensitivity("block.x.velocity", "belt.velocity.x")[i] == pytest.approx(1.0, abs=1e-12)
    assert sol.sensitivity("block.y.velocity", "belt.velocity.x")[i] == pytest.approx(0.0, abs=1e-12)


def test_slip_that_passes_rest():
    """Under an elliptic law slip comes to rest and sets out at once in another direction: a jump that no event names.

    Beside differences of runs; without the jump the velocity's derivative would be off by 0.24.  Later slip passes rest
    at 1e-8 of its largest speed without coming to it, which a note tells.
    """
    scene, t = case("Elliptic", "reversal").scene, np.array([3.75])
    name = "sole.law.law.mu_k"
    p, h = scene.parameters[name], 1e-4
    ends = [fm.simulate(scene, t_end=4.0, rtol=1e-12, parameters={name: p + s * h}, t_eval=t).v[0, 0] for s in (1, -1)]
    expected = (ends[0] - ends[1]) / (2.0 * h)
    sol = fm.simulate(scene, t_end=4.0, rtol=1e-10, sensitivities=(name,), t_eval=t, method="radau")
    assert not [event for event in sol.events if event.t > 1.0]
    assert sol.sensitivity("m.mode1.velocity", name)[0] == pytest.approx(expected, rel=2e-5)
    sol = fm.simulate(scene, t_end=5.0, rtol=1e-8, sensitivities=(name,))
    assert any(re.search(r"passes rest at [1-3]e-08 of its largest speed", note) for note in sol.stats.notes)


def test_start_at_rest_about_to_slip_is_one_sided():
    """A speed along the slip that begins and one against it shift what follows by different amounts."""
    block = fm.Body("block", mass=1.0, axes="xy", position={"x": 0.2, "y": 0.9})
    springs = [fm.Spring("kx", block, axis="x", stiffness=1.0), fm.Spring("ky", block, axis="y", stiffness=2.3)]
    rub = fm.Contact("rub", block, law=fm.laws.Coulomb(mu_s=0.6, mu_k=0.4), normal_force=1.0, axes="xy")
    scene = fm.Scene("puck", [block, *springs, rub])
    sol = fm.simulate(scene, t_end=1.0, sensitivities=("block.velocity.x", "kx.stiffness"))
    assert any("starts at rest" in note and "'block.velocity.x', which" in note for note in sol.stats.notes)
    sol = fm.simulate(scene, t_end=1.0, sensitivities=("kx.stiffness",))
    assert not any("one-sided" in note for note in sol.stats.notes)


def shaped_plate():
    """A point of a body of modes, which is not as easily moved in all directions, of no special ones."""
    spec = generate("modes", 101)
    return scene_of(spec), spec.t_end


def test_slip_that_ends_in_the_direction_that_its_own_turns_into():
    """Where accelerations differ in their directions: the time of the landing was off by 0.4."""
    scene, t_end = shaped_plate()
    found = worst(scene, ("belt.velocity.x", "plate.position.mode3"), rtol=1e-8, t_end=t_end)
    assert max(found.values()) < 1e3


@pytest.mark.parametrize(
    ("kind", "seed", "name"),
    [
        ("roller", 101, "j0.friction.mu_k"),  # lands twice; a ball joint on it rubs under a load that this changes
        ("tree", 107, "gravity.acceleration.z"),  # a ball joint below another one
        ("roller", 103, "b0.inertia_across"),  # a direction that hardly settles
        ("roller", 202, "k1.stiffness"),  # a ball whose slip passes rest along a line
    ],
)
def test_bodies_in_space_whose_friction_changes_its_own_load(kind, seed, name):
    """To a thousand tolerances or to what a note says."""
    spec = generate(kind, seed)
    sol = fm.simulate(case_of(spec).scene, t_end=spec.t_end, rtol=1e-8, sensitivities=(name,))
    off = shares_off(sol, (name,), steps=(1e-3,), t_end=spec.t_end)
    assert off[name] < max([1e3 * 1e-8, *said(sol)]), (off, sol.stats.notes)


@pytest.mark.parametrize("method", ["radau", "taylor"])
def test_a_short_way_behind_a_break_away(method):
    """The speed of slip that has just begun is (mu_s - mu_k) N/m times the time since: with mu_s that time shrinks."""
    mu_s, mu_k, turns = 0.6, 0.4, 0.3
    for after in (1e-3, 1e-4, 1e-5):
        for begins in (1.3, 6.5, 50.0):
            block = fm.Body("block", mass=1.0, axes="xy")
            rate = mu_s / begins
            loads = [rate * fm.t * way(turns * fm.t) for way in (sympy.cos, sympy.sin)]
            pull = [fm.Force(f"f{axis}", block, axis=axis, value=F) for axis, F in zip("xy", loads, strict=True)]
            sole = fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k), normal_force=1.0)
            scene, name = fm.Scene("pulled", [block, *pull, sole]), "sole.law.mu_s"
            sol = fm.simulate(scene, t_end=begins + after, rtol=1e-9, method=method, sensitivities=(name,))
            found = [sol.sensitivity(f"block.{axis}", name)[-1] / after for axis in "xy"]
            along = np.array([np.cos(turns * begins), np.sin(turns * begins)])
            np.testing.assert_allclose(found, -(mu_s - mu_k) / rate * along, rtol=10.0 * after + 1e-5)
