"""Islands under time stepping: alike, they take the same steps; else rows that would mislead are left out."""

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb._simulate import _islands
from fricmb._simulate._alike import alike
from fricmb._simulate._common_times import common_times
from fricmb.integrate import SLIP, STICK

RTOL = 1e-4


def rubbing(count: int, axes: str, pressed: float = 1.0, stiffer: float = 1.0) -> fm.Scene:
    """Masses on springs, each on a belt of its own; load and stiffness of the last are so many times as large."""
    parts: list = []
    for i in range(count):
        last = i == count - 1
        body = fm.Body(f"b{i}", mass=1.0 + 0.37 * i, axes=axes, position={"x": 0.3 + 0.1 * i})
        parts.append(body)
        for axis, stiffness in zip(axes, (1.0 + 0.21 * i, 2.0 + 0.13 * i), strict=False):
            spring = stiffness * (stiffer if last else 1.0)
            parts.append(fm.Spring(f"k{axis}{i}", body, axis=axis, stiffness=spring))
        law = fm.laws.Coulomb(mu_s=0.4, mu_k=0.25)
        slide = (0.1, 0.05)[: len(axes)] if len(axes) > 1 else 0.1
        load = pressed if last else 1.0
        parts.append(fm.Contact(f"c{i}", body, law=law, normal_force=load, axes=axes, slide=slide))
    return fm.Scene("rubbing", parts)


def off(found: fm.Solution, exact: fm.Solution, name: str) -> float:
    """Largest error of a position over its largest value."""
    return float(np.abs(found[name] - exact[name]).max() / np.abs(exact[name]).max())


@pytest.mark.parametrize("axes", ["x", "xy"])
@pytest.mark.parametrize("pressed", [1.0, 15.0])
def test_joined_rows_are_consistent(axes, pressed):
    """Alike or not (a load fifteen times as large): all that the scene's equations say of the rows holds."""
    scene = rubbing(3, axes, pressed=pressed)
    sol = fm.simulate(scene, t_end=20.0, rtol=RTOL, method="timestepping")
    assert len(sol.stats.islands) == (1 if pressed == 1.0 else 3)
    audit = sol.audit()
    assert audit.ok, str(audit)
    t = np.linspace(0.0, 20.0, 301)
    found = fm.simulate(scene, t_end=20.0, rtol=RTOL, method="timestepping", t_eval=t)
    exact = fm.simulate(scene, t_end=20.0, rtol=1e-9, method="radau", t_eval=t)
    assert [(e.contact, e.kind) for e in found.events] == [(e.contact, e.kind) for e in exact.events]
    assert max(off(found, exact, name) for name in scene.dof_names) < 30.0 * RTOL


def test_no_row_lies_in_a_step_over_a_transition_of_another(monkeypatch):
    """Run apart, rows between the ends of such a step would show a mode that the motion there does not have."""
    monkeypatch.setattr(_islands, "alike", lambda problems: False)
    sol = fm.simulate(rubbing(2, "x"), t_end=20.0, rtol=RTOL, method="timestepping")
    runs = [run for _, run in sol.run.pieces[0].trajectory.runs]
    every = np.unique(np.concatenate([run.t for run in runs]))
    assert 0 < every.size - sol.t.size < 0.05 * every.size
    for run in runs:
        for t in run.transitions.t:
            k = int(np.searchsorted(run.t, t, side="right"))
            inside = (sol.t > run.t[k - 1]) & (sol.t < run.t[k])
            assert not inside.any()
    assert sol.audit().ok


def test_hidden_times_are_left_out_but_for_the_ends():
    a, b = np.array([0.0, 1.0, 2.0, 3.0]), np.array([0.0, 0.5, 1.5, 1.7, 2.0, 3.0])
    nothing = (np.zeros(0), np.zeros(0))
    t, thinned = common_times([a, b], 3.0, 1, [(np.array([1.0]), np.array([2.0])), nothing])
    assert not thinned
    assert t.tolist() == [0.0, 0.5, 1.0, 2.0, 3.0]
    cut, _ = common_times([a, b], 1.6, 1, [(np.array([1.0]), np.array([2.0])), nothing])
    assert cut.tolist() == [0.0, 0.5, 1.0, 1.6]


def test_each_part_is_measured_by_itself():
    """A mass 1e5 times as heavy under the same load moves far less: its error counts all the same."""
    parts: list = [
        fm.Body("light", mass=1.0, position={"x": 3.0}), fm.Body("heavy", mass=1e5, velocity={"x": 1e-4}),
    ]  # fmt: skip
    law = fm.laws.Coulomb(mu_s=0.4, mu_k=0.25)
    for body, k in zip(parts[:2], (1.0, 1.3e5), strict=True):
        parts += [
            fm.Spring(f"k {body.name}", body, axis="x", stiffness=k),
            fm.Contact(f"c {body.name}", body, law=law, normal_force=1.0, slide=0.1 if k == 1.0 else 1e-5),
        ]  # fmt: skip
    scene = fm.Scene("light and heavy", parts)
    t = np.linspace(0.0, 20.0, 301)
    options = {"t_end": 20.0, "t_eval": t}
    found = fm.simulate(scene, rtol=RTOL, method="timestepping", **options)
    exact = fm.simulate(scene, rtol=1e-10, method="radau", **options)
    assert len(found.stats.islands) == 1
    assert np.abs(exact["light.x"]).max() > 1e4 * np.abs(exact["heavy.x"]).max()
    assert off(found, exact, "heavy.x") < 10.0 * RTOL
    assert off(found, exact, "light.x") < 10.0 * RTOL


def test_unlike_islands_keep_their_own_steps():
    """One a hundred times as fast would force its steps on all."""
    problems = [m.system.problem for m in _members(rubbing(12, "x", stiffer=1e4))]
    assert alike(problems[:-1])
    assert not alike(problems)
    assert not alike([m.system.problem for m in _members(rubbing(2, "x", pressed=30.0))])


def _members(scene: fm.Scene):
    from fricmb._simulate._mechanics import mechanics_of

    return mechanics_of(scene).members


def test_files_hold_islands_that_were_run_as_one(tmp_path):
    sol = fm.simulate(rubbing(3, "xy"), t_end=5.0, rtol=RTOL, method="timestepping")
    sol.save(tmp_path / "run")
    again = fm.Solution.load(tmp_path / "run")
    t = np.linspace(0.1, 4.9, 50)
    assert np.array_equal(again.at(t)["b2.y"], sol.at(t)["b2.y"])
    assert np.array_equal(again.t, sol.t)


def test_what_rests_is_not_run():
    still = fm.Body("still", mass=1.0)
    parts = [*rubbing(2, "x").parts, still, fm.Spring("ks", still, axis="x", stiffness=1.0)]
    sol = fm.simulate(fm.Scene("with one at rest", parts), t_end=5.0, rtol=RTOL, method="timestepping")
    assert [island.dofs for island in sol.stats.islands] == [("b0.x", "b1.x")]
    assert not sol["still.x"].any()


def test_between_rows_modes_velocities_and_forces_belong_together():
    """In stick nothing moves; in slip friction is what the law says and against the slip, through a reversal, too."""
    scene = fm.Scene(
        "shaken",
        [
            block := fm.Body("block", mass=1.0, velocity={"x": 1.0}),
            fm.Force("push", block, axis="x", value=0.9 * sympy.sin(1.3 * fm.t)),
            fm.Contact("floor", block, law=fm.laws.Coulomb(mu_s=0.4, mu_k=0.4), normal_force=1.0),
        ],
    )
    sol = fm.simulate(scene, t_end=30.0, rtol=1e-3, method="timestepping")
    kinds = {e.kind for e in sol.events}
    assert {"reversal", "stick", "slip"} & kinds
    run = sol.run.pieces[0].trajectory
    begin, end = run.unlocated
    assert begin.size >= 5
    for share in (0.1, 0.5, 0.9):
        seen = run.sample(begin + share * (end - begin))
        stuck, slips = seen.mode[0] == STICK, seen.mode[0] == SLIP
        assert slips.any()
        assert not seen.g[0, stuck].any()
        assert np.abs(seen.F[0, slips] * np.sign(seen.g[0, slips]) + 0.4).max() < 1e-12
