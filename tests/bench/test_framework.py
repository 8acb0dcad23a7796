"""The suite's instruments: each metric sees the fault it is for, and a right run passes all of them."""

import importlib.util
import json
import os
import time
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import fricmb as fm
from fricmb.bench import SCENES, Method, Own, Run, SceneCase, Setting, Store, Transitions, measure, measure_cell
from fricmb.bench import _closed as closed
from fricmb.bench._fit import exponent, order
from fricmb.bench._peers import Answer, Smoothed
from fricmb.bench._reference import shipped
from fricmb.bench._smooth import smooth
from fricmb.bench._tables import fastest, scoreboard, tolerance_statistic
from fricmb.bench._worker import CellEnded, Worker

_spec = importlib.util.spec_from_file_location("pack", Path(__file__).parent / "pack.py")
pack = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(pack)

BELT = next(case for case in SCENES if case.name == "belt")
FREE = next(case for case in SCENES if case.name == "free")


@pytest.mark.parametrize("name", pack.NAMES)
def test_shipped_references_are_the_certified_ones(name):
    held = shipped(name)
    for key, value in pack.packed(name).items():
        if key in ("t", "q", "v", "F"):
            assert np.array_equal(getattr(held, key), value)
    assert held.growth.shape == held.t.shape
    assert (held.growth >= 1.0).all()


def truth(reference):
    """The run that makes no error."""
    return Run(q=reference.q, v=reference.v, F=reference.F, g=reference.v - 0.1, transitions=reference.transitions)


def test_the_reference_itself_has_no_error():
    metrics = measure(truth(BELT.reference()), BELT.reference(), (1,))
    assert (metrics.state, metrics.grown, metrics.time) == (0.0, 0.0, 0.0)
    assert (metrics.missed, metrics.false, metrics.force) == (0, 0, 0.0)
    assert metrics.creep < 1e-15


@pytest.mark.parametrize("size", [1e-3, 1e-9])
def test_each_fault_is_seen_by_its_own_metric(size):
    """A deliberately bad run: what is wrong shows where it should, by the right amount, and nowhere else."""
    reference = BELT.reference()
    right = truth(reference)
    stuck = reference.stuck(1)[0]
    largest = np.abs(reference.q).max()

    bad = measure(replace(right, q=right.q + size * largest), reference, (1,))
    assert bad.state == pytest.approx(size, rel=1e-6)
    assert (bad.missed, bad.force) == (0, 0.0)

    late = replace(reference.transitions, t=reference.transitions.t + size)
    bad = measure(replace(right, transitions=late), reference, (1,))
    assert bad.time == pytest.approx(size / 200.0, rel=1e-3)
    assert (bad.state, bad.missed, bad.false) == (0.0, 0, 0)

    bad = measure(replace(right, F=right.F + size * np.where(stuck, np.abs(right.F).max(), 0.0)), reference, (1,))
    assert bad.force == pytest.approx(size, rel=1e-5)
    # outside stick the force of a smoothed law is none of this metric's business
    assert measure(replace(right, F=right.F + np.where(stuck, 0.0, 9.0)), reference, (1,)).force == 0.0

    bad = measure(replace(right, g=np.where(stuck, size * np.abs(right.g).max(), right.g)), reference, (1,))
    assert bad.creep == pytest.approx(size, rel=1e-6)

    assert measure(replace(right, energy=size), reference, (1,)).energy == size


def test_missed_and_false_transitions_are_counted_apart():
    reference = BELT.reference()
    true = reference.transitions
    without = Transitions(t=np.delete(true.t, 5), contact=np.delete(true.contact, 5), kind=np.delete(true.kind, 5))
    assert counts(reference, without) == (1, 0)
    # two more within a stick phase: in and out of slip where there is none
    more = Transitions.of([*rows(true), (22.0, 0, "slip"), (22.1, 0, "stick")])
    assert counts(reference, more) == (0, 2)
    # a turn taken for a stop is one missed and one made up
    kind = true.kind.copy()
    kind[3] = 2
    assert counts(reference, Transitions(t=true.t, contact=true.contact, kind=kind)) == (1, 1)
    # of another contact altogether
    assert counts(reference, Transitions(t=true.t, contact=true.contact + 1, kind=true.kind)) == (28, 28)


def rows(transitions):
    kinds = ("stick", "slip", "reversal")
    columns = (transitions.t, transitions.contact, transitions.kind)
    return [(float(t), int(c), kinds[k]) for t, c, k in zip(*columns, strict=True)]


def counts(reference, transitions):
    found = measure(replace(truth(reference), transitions=transitions), reference, (1,))
    return found.missed, found.false


def test_what_is_not_a_number_is_an_error_without_bound():
    reference = BELT.reference()
    q = reference.q.copy()
    q[0, 7] = np.nan
    assert measure(replace(truth(reference), q=q), reference, (1,)).state == np.inf


def test_errors_are_divided_by_the_growth_of_the_problem():
    reference = shipped("p4_vdr0.1")
    q = reference.q.copy()
    q[:, -1] += 1e-3 * np.abs(reference.q).max(axis=1)
    metrics = measure(Run(q=q, v=reference.v), reference, (1, 1))
    assert metrics.state == pytest.approx(1e-3, rel=1e-6)
    assert metrics.grown == pytest.approx(1e-3 / reference.growth[-1], rel=1e-6)


@pytest.mark.parametrize("case", SCENES, ids=lambda case: case.name)
def test_a_reference_fits_its_scene(case):
    """Positions and velocities at the start are the scene's own, and the shapes those of its dofs and contacts."""
    from fricmb.system import build

    system, reference = build(case.build()), case.reference()
    assert reference.q.shape == (len(system.dof_names), len(reference.t))
    if reference.t[0] == 0.0:
        assert reference.q[:, 0] == pytest.approx(system.start.q, abs=1e-15)
    if reference.F is not None:
        assert reference.F.shape == (system.problem.m, len(reference.t))
    if reference.transitions is not None:
        assert reference.transitions.contact.max(initial=0) < len(system.contact_names)


def test_closed_form_of_the_free_oscillator():
    """x'' + x + friction sign(x') = 0 between the turns, by differences."""
    reference = closed.free_oscillator()
    x, v, F = reference.q[0], reference.v[0], reference.F[0]
    h = reference.t[1]
    slope = (v[2:] - v[:-2]) / (2 * h)
    inside = np.array([np.abs(reference.transitions.t - t).min() > h for t in reference.t[1:-1]])
    assert np.abs(slope + x[1:-1] - F[1:-1])[inside].max() < 1e-2
    assert len(reference.transitions) == 14
    assert x[-1] == pytest.approx(-0.0817 if len(reference.transitions) % 2 else 2.7183 - 28 * 0.1, abs=1e-12)


@dataclass(frozen=True)
class Careless(Method):
    """A deliberately bad integrator: the right answer with the last stick forgotten, or an exception."""

    fails: bool = False
    name: str = "careless"
    peer: bool = True

    def settings(self, case, quick):
        return [Setting(rtol=1e-6)]

    def refuses(self, case):
        return None

    def run(self, case, setting, *, detail):
        if self.fails:
            raise ArithmeticError("lost\nits way")
        sol = fm.simulate(case.build(), t_end=case.t_end, t_eval=case.reference().t, rtol=1e-6)
        x, v = sol.q.copy(), sol.v.copy()
        rest = sol.t > 43.98  # goes on to vibrate instead of coming to rest
        x[0, rest] *= np.cos(sol.t[rest] - 43.98)
        found = [(e.t, 0, e.kind) for e in sol.events if e.kind != "stick"]
        return Run(q=x, v=v, F=0.5 * sol.force("sole"), g=v + 1e-3, transitions=Transitions.of(found), energy=0.1)


def test_a_bad_integrator_is_caught_by_every_metric():
    good, bad = (measure_cell(FREE, method, Setting(rtol=1e-6)) for method in (Own("auto"), Careless()))
    assert good.metrics.state < 1e-5
    assert (good.metrics.missed, good.metrics.false, good.metrics.creep) == (0, 0, 0.0)
    assert max(good.metrics.time, good.metrics.force, good.metrics.energy) < 1e-4
    assert bad.metrics.state > 1e-2
    assert bad.metrics.missed == 1
    assert bad.metrics.force > 0.1
    assert bad.metrics.creep > 1e-4
    assert bad.metrics.energy == 0.1
    assert good.seconds > 0.0
    assert good.counters["n_steps"] > 0
    assert good.used in fm.integrators


def test_a_method_that_fails_is_shown_failing_with_its_message():
    outcome = measure_cell(FREE, Careless(fails=True), Setting(rtol=1e-6))
    assert outcome.failure == "ArithmeticError: lost its way"
    assert outcome.metrics is None
    assert type(outcome).from_dict(json.loads(json.dumps(outcome.as_dict()))) == outcome


@pytest.mark.parametrize("name", ["brake2", "belt_stribeck", "two_blocks", "lugre", "forced0.5", "stewart"])
def test_smoothed_equations_have_the_right_jacobian(name):
    """Against differences, at a state where every contact slips slowly."""
    case = next(case for case in SCENES if case.name == name)
    scene = smooth(case.build(), 1e-2, case.t_end)
    rng = np.random.default_rng(1)
    y = scene.start + 0.05 * rng.normal(size=len(scene.start))
    y[2 * scene.n :] *= 1e-4
    J = scene.jac(0.3, y)
    h = np.where(np.arange(len(y)) < 2 * scene.n, 1e-6, 1e-10)
    columns = [(scene.rhs(0.3, y + e) - scene.rhs(0.3, y - e)) / (2 * h[j]) for j, e in enumerate(np.diag(h))]
    assert pytest.approx(np.stack(columns, axis=1), abs=1e-6 * np.abs(J).max()) == J
    assert not np.triu(J, scene.band + 1).any()


def test_smoothed_friction_tends_to_the_law():
    """Far above eps the smoothed force is the slip force; at 10 eps it is the break-away force."""
    scene = smooth(BELT.build(), 1e-4, 200.0)
    y = np.array([[0.0, 0.0], [0.5, 0.1 + 1e-3]])
    g, F = scene.contacts(np.zeros(2), y)
    assert g[0] == pytest.approx([0.4, 1e-3])
    assert F[0] == pytest.approx([-1.0, -1.5], rel=1e-6)


@dataclass(frozen=True)
class Exact(Smoothed):
    """A solver that returns a given motion."""

    name: str = "exact"

    def solve(self, scene, t, rtol, atol, steps):
        fine = np.linspace(t[0], t[-1], 200_001) if steps else t
        truth = BELT.reference()
        v = np.interp(fine, truth.t, truth.v[0])
        return Answer(t=fine, y=np.stack([np.interp(fine, truth.t, truth.q[0]), v]))


def test_transitions_of_a_smoothed_run_are_found():
    run = Exact().run(BELT, Setting(rtol=1e-6, eps=1e-5), detail=True)
    metrics = measure(run, BELT.reference(), (1,))
    assert (metrics.missed, metrics.false) == (0, 0)
    assert metrics.time < 0.5 / 200.0  # the grid of the reference, over the duration


def test_a_store_goes_on_where_it_stopped(tmp_path):
    path = tmp_path / "cells.jsonl"
    Store(path, "a").put("x", {"value": 1})
    with path.open("a") as stream:
        stream.write('{"of": "a", "key": "cut')  # the process died here
    again = Store(path, "a")
    assert again.get("x") == {"value": 1}
    assert len(again) == 1
    assert Store(path, "b").get("x") is None


def test_a_worker_survives_what_hangs_or_dies():
    with Worker() as worker:
        first = worker.run(os.getpid, limit=30.0)
        assert worker.run(os.getpid, limit=30.0) == first != os.getpid()
        with pytest.raises(CellEnded, match="ValueError: invalid literal"):
            worker.run(int, "what", limit=30.0)
        with pytest.raises(CellEnded, match="exit status 7"):
            worker.run(os._exit, 7, limit=30.0)
        assert worker.run(os.getpid, limit=30.0) != first
        with pytest.raises(CellEnded, match=r"not done after 0\.1 s"):
            worker.run(time.sleep, 30.0, limit=0.1)


def test_exponents():
    n = np.array([10.0, 100.0, 1000.0])
    assert exponent(n, 3e-6 * n**1.5) == pytest.approx(1.5)
    assert order(n, 5.0 * n**-5.0) == pytest.approx(5.0)
    assert exponent([10.0], [1.0]) is None
    assert order(n, [1e-15, 1e-15, 1e-15]) is None


def cell(method, seconds, state, *, rtol=1e-6, peer=False, missed=0):
    metrics = {"state": state, "grown": state, "missed": missed, "false": 0}
    setting = {"rtol": rtol, "step": None, "eps": None}
    row = {"case": "c", "method": method, "peer": peer, "seconds": seconds, "metrics": metrics, "setting": setting}
    return row | {"used": method, "failure": ""}


def test_the_scoreboard_takes_the_fastest_run_that_is_right():
    cells = [cell("auto", 1.0, 1e-7), cell("bdf", 0.5, 1e-3), cell("LSODA", 0.1, 1e-9, peer=True, missed=2)]
    assert fastest(cells, 1e-6)["method"] == "auto"
    assert fastest(cells, 1e-2)["method"] == "LSODA"
    assert fastest(cells, 1e-12) is None
    board = {row["level"]: row for row in scoreboard(cells)}
    assert board[1e-6]["peer"] is None
    assert board[1e-2]["own"]["method"] == "bdf"


def test_the_tolerance_statistic_lists_what_is_outside():
    cells = [cell("auto", 1.0, 5e-6), cell("auto", 1.0, 5e-3), cell("auto", 1.0, 1e-9), cell("bdf", 1.0, 1.0)]
    found = tolerance_statistic(cells)
    assert found["runs"] == 3
    assert found["within"] == pytest.approx(1 / 3)
    assert found["not_above"] == pytest.approx(2 / 3)
    assert [row["ratio"] for row in found["exceptions"]] == [pytest.approx(5e3), pytest.approx(1e-3)]
    assert found["fair"] == pytest.approx(1 / 3)  # no steps are known


def test_accuracy_that_costs_nothing_is_told_from_waste():
    def run(rtol, steps, error):
        made = cell("auto", 1.0, error)
        return {**made, "setting": {**made["setting"], "rtol": rtol}, "counters": {"n_steps": steps}}

    exact = [run(1e-3, 40, 1e-12), run(1e-6, 44, 1e-12), run(1e-9, 80, 1e-12)]
    found = tolerance_statistic(exact)
    assert found["within"] == pytest.approx(0.0)
    assert found["fair"] == pytest.approx(2 / 3)
    assert [row["rtol"] for row in found["exceptions"] if row["why"] == "more accurate than rtol"] == [1e-9]


def test_a_case_can_be_declared_outside():
    """What someone else needs for a problem of their own."""
    case = SceneCase(
        name="mine", title="mine", build=partial(fm.models.friction_oscillator, x0=1.05),
        reference=partial(closed.free_oscillator, 1.05, 0.1, 20.0),
    )  # fmt: skip
    outcome = measure_cell(case, Own("radau"), Setting(rtol=1e-8))
    assert outcome.failure == ""
    assert outcome.metrics.state < 1e-7


def test_a_run_that_compiles_is_not_the_one_that_counts():
    from numba import njit

    from fricmb.bench._timed import timed

    runs = []

    @njit
    def inner(x):
        return x + 1

    def run():
        runs.append(inner(len(runs)))
        return len(runs)

    result, seconds = timed(run)
    assert result == 2
    assert seconds < 0.02
    assert timed(run)[0] == 3
