"""A run of the implicit driver from its start to a trajectory."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from fricmb.integrate.compile.parallel_compile import load_blocks
from fricmb.integrate.formulas.step_control import FREE, SAMPLED, first_step
from fricmb.integrate.formulas.tableau import Tableau
from fricmb.integrate.implicit.bdf.bdf_history import Formula, formula_of, guard_at, no_formula, signals
from fricmb.integrate.implicit.bdf.turns import Differences, differences, no_differences
from fricmb.integrate.implicit.equations.consistent_start import away, check_apart, consistent_start
from fricmb.integrate.implicit.equations.least_change import names_of_rows
from fricmb.integrate.implicit.events.event_functions import FINEST, ROUGH, ROUGHEST
from fricmb.integrate.implicit.impacts.impact import Impacts
from fricmb.integrate.implicit.impacts.impulses import impulse_notes
from fricmb.integrate.implicit.output.failure_text import failure_text, held_notes
from fricmb.integrate.implicit.output.recorder import Record, record_of, width
from fricmb.integrate.implicit.output.step_trajectory import StepTrajectory, complete_at
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech, masses, mech_of
from fricmb.integrate.implicit.scene.state import State, set_out
from fricmb.integrate.implicit.scene.structure import mechanism_of, with_open
from fricmb.integrate.implicit.time_loop import begin, drive
from fricmb.integrate.implicit.workspace import RunWorkspace, run_workspace
from fricmb.integrate.integrator import Tolerance
from fricmb.integrate.mechanism import Mechanism
from fricmb.integrate.problem import LAW_SMOOTH, Codes, Floats, Problem, Start
from fricmb.integrate.run.chunks import Chunks, counters, end_of
from fricmb.integrate.run.outcomes import DONE, FAIL_INFINITE, FAILURES, FULL, SLICE_OVER
from fricmb.integrate.run.stop import ended
from fricmb.integrate.signals.largest_value import largest_forces
from fricmb.integrate.signals.longest_steps import LongestSteps, shortest_of, steps_of_run

#: Steps that a kernel fills before they are taken out: so many, or so many bytes.
CHUNK, CHUNK_BYTES = 1024, 1e6
#: Part that a first step takes of the time in which velocities change.
PART = 0.05
#: Slip velocities are known to a part of what all bodies together could bring by what loads do in so many first steps
#: from rest: by less, long chains of pins pass through many more transitions in the first instants, which move nothing.
FURTHER = 10.0


#: Attempted steps of BDF for the time of one of the one-step method with five stages: 2.0 to 4.2, median 3.3, on six of
#: the models (pendulum, four-bar, slider crank, drive train, car axis, Andrews) at 1e-6 and 1e-8; with three stages 1.2
#: to 2.5, median 1.9.
COST = 3.3


class Setting(NamedTuple):
    """What a loop over steps works on: the run, its workspace, space for rows, and how long inputs let steps be."""

    problem: Problem
    start: Start
    t_end: float
    mech: Mech
    workspace: RunWorkspace
    record: Record
    part: Codes
    limits: LongestSteps


def one_step_loop(setting: Setting) -> partial[int]:
    """Steps by the one-step formula alone."""
    w = setting.workspace
    return _drive(setting, no_differences(), no_formula(w.y, w.st))


def bdf_loop(setting: Setting) -> partial[int]:
    """BDF between transitions, the one-step formula around them."""
    load_blocks("attempt_bdf_step")
    problem, start, w = setting.problem, setting.start, setting.workspace
    guard = guard_at(problem, setting.mech, w.k, w.y, w.st)
    stages = len(w.st.tab.c)
    past = differences(signals(problem), setting.t_end - start.t, COST * stages / 5)
    return _drive(setting, past, formula_of(problem, start, guard))


def _drive(setting: Setting, past: Differences, formula: Formula) -> partial[int]:
    mech, (k, w, y, end, before, st, out, control) = setting.mech, setting.workspace
    seen = setting.limits.edge, setting.limits.longest
    return partial(
        drive, mech, k, w, y, end, before, st, control, out, setting.record, setting.part, past, formula, *seen
    )  # fmt: skip


def run_mechanism(
    problem: Problem,
    start: Start,
    t_end: float,
    tolerance: Tolerance,
    tab: Tableau,
    progress: Callable[[float], None] | None,
    memory: float | None = None,
    *,
    loop: Callable[[Setting], partial[int]] | None = None,
    made: type[StepTrajectory] = StepTrajectory,
) -> StepTrajectory:
    """Steps by a one-step formula, on the index-reduced system; see ``Integrator.integrate``.

    ``loop``: what makes the loop over steps, by default :func:`one_step_loop`; ``made`` the trajectory in the end.
    """
    whole = problem
    if mechanism_of(problem).joints.hands_over.any():
        check_apart(problem, start)
        problem = with_open(problem, away(problem, start))
    start, notes = consistent_start(problem, start)
    if problem.contacts.knots.size:
        load_blocks("knot_within", "off_near_ends", "passes_bend")
    if problem.bends.table.address.size:
        load_blocks("bend_within", "go_over_bend")
    stages = len(tab.c)
    capacity = int(np.clip(CHUNK_BYTES / (8 * (stages + 1) * width(problem)), 16, CHUNK))
    with run_workspace(problem, tab) as workspace:
        with np.errstate(over="ignore", invalid="ignore"):  # what has no value at the start is named below
            small, reach = _set_up(workspace, problem, start, t_end, tolerance)
        mech, record, part = mech_of(problem), record_of(problem, stages, capacity), np.zeros(problem.n_c, np.int8)
        k, w, y, _, _, _, out, control = workspace
        limits = steps_of_run(problem, start.t, t_end, tolerance)
        stepping = (loop or one_step_loop)(Setting(problem, start, t_end, mech, workspace, record, part, limits))
        chunks, impacts = Chunks(record, "values", "span", "force", "ahead", "mode", "opened", "after"), None
        go_on: Callable[[], int] = stepping
        code = begin(mech, k, w, y, control, out, part, start.mode is not None, small, reach)
        if not _has_values(k, y):
            code = FAIL_INFINITE
        if mechanism_of(problem).has_impacts:
            impacts = Impacts(problem, mech, workspace, record, part)
            code = impacts.jump(code) if impacts.may_jump(code) else code
        if code == DONE:
            chunks.note_changes(problem.contacts, start, y.mode, y.n)
            _settle(workspace, problem, start, t_end, limits)
            if impacts is not None:
                code, go_on = impacts.at_start(), impacts.around(stepping)
        if code == DONE:
            code = chunks.fill(go_on, y, memory, progress)
        chunks.take()
        failure = None if code == DONE else ended()
        failure = failure or (impacts.failure if impacts is not None else None)
        failure = failure or (failure_text(code, problem, k, y, out) if code not in (DONE, FULL, SLICE_OVER) else None)
        last, counts = end_of(y), control.counts.copy()
    values, span, force, ahead, mode, opened, after = (np.concatenate(x) for x in zip(*chunks.parts, strict=True))
    if chunks.broken:
        failure = failure or FAILURES[FAIL_INFINITE]
    notes = (*notes, *_dropped_notes(mechanism_of(problem)), *held_notes(problem, span[:, 0], mode, opened))
    notes = (*notes, *impulse_notes(problem, span, values))
    transitions = chunks.transitions()
    if impacts is not None:
        notes = (*notes, *impacts.notes)
        transitions = impacts.log.transitions(transitions, span[:, 0], opened, last.t)
    return made(
        whole, span, values, force, ahead, mode, opened, after, transitions, counters(counts, notes), last, failure,
        np.concatenate([[0.0], tab.c]), tolerance.rtol,
    )  # fmt: skip


def _set_up(
    workspace: RunWorkspace, problem: Problem, start: Start, t_end: float, tolerance: Tolerance
) -> tuple[float, float]:
    """Put start, times, tolerance into an empty workspace; a slip of round-off, the root of energy that loads bring."""
    m, y, c = mechanism_of(problem), workspace.y, workspace.control
    for state in (y, workspace.end, workspace.before):
        set_out(state, start)
    c.rtol, c.mass[:], c.span[:] = tolerance.rtol, masses(m), (start.t, t_end)
    workspace.out.hair = min(max(ROUGH * tolerance.rtol, FINEST), ROUGHEST)
    c.longest = c.bound = _longest_step(problem, t_end - start.t)
    c.q[:], c.v[:], c.z[:] = np.abs(start.q), np.abs(start.v), np.abs(start.z)
    c.push_z[:] = 0.0
    if tolerance.atol_v is not None:
        c.floor_v[:] = tolerance.atol_v / tolerance.rtol
    c.stops[:] = mech_of(problem).breakpoints
    c.knot, c.setting_out, c.sets_out, c.halts = -np.inf, np.inf, 0, 0
    workspace.out.opened = (m.joints.dropped == 2).sum()
    first, weight = _first_speeds(problem, start, t_end), np.sqrt(c.mass)
    trifle = (weight * c.v).max(initial=0.0) <= 1e-12 * (weight * first).max(initial=0.0)
    if trifle and not (problem.contacts.law == LAW_SMOOTH).any():
        y.v[:] = 0.0  # round-off of a start at rest; smooth laws know no rest, and their forces tell such speeds apart
    # what drivers bring is what slip may be round-off of, too, where all that they carry is at rest on them
    workspace.out.top_slip = _slip_of_drivers(problem, start, t_end)
    slip = max(float(_slip_by(problem, start, y.v, first).max(initial=0.0)), float(workspace.out.top_slip))
    return 1e-12 * slip, FURTHER * float(np.linalg.norm(weight * first))


#: Forces of springs and dampers over a step that are stiff, in units of those of inertia.
STIFF = 1e4
#: What is no number to go on with: functions of time are asked 1e-300 behind a start at 0, where 1/t is 1e300.
INFINITE = 1e290


def _has_values(k: Moving, y: State) -> bool:
    """Whether all that acts at the start has a value: no step from there ends, however short."""
    return all(np.all(np.abs(x) < INFINITE) for x in (y.a, y.F, y.N, y.g, y.zd, k.s.X, k.fy))


def _longest_step(problem: Problem, span: float) -> float:
    """The longest step that is taken, whatever its error.

    Where nothing moves no error says what loads, or elements between what moves otherwise, will do: they are looked at
    a hundred times.  So are stiff parts, for what they leave to round-off grows with steps.
    """
    m, h = mechanism_of(problem), FREE * span
    force = np.zeros(m.n)
    for entries, weight in ((m.K, h * h), (m.C, h)):
        own = (entries.row < m.n) & (entries.column < m.n)
        np.maximum.at(force, entries.row[own], weight * np.abs(entries.value[own]))
    nonlinear = problem.elements.table.address.size > 0
    short = problem.loads_bend or nonlinear or bool(np.any(force > STIFF * masses(m)))
    return (SAMPLED if short else FREE) * span


def _settle(workspace: RunWorkspace, problem: Problem, start: Start, t_end: float, limits: LongestSteps) -> None:
    """What counts as 1, and the first step, from what is found at the start; ``limits`` of steps under inputs."""
    y, out, c = workspace.y, workspace.out, workspace.control
    if not np.any(y.v):
        load, pushed = _load(mechanism_of(problem), y), _largest_push(problem, start.t, t_end)
        if (c.mass * np.abs(y.a)).max(initial=0.0) <= max(ROUND_OFF * max(load, pushed), NOTHING):
            shortest = shortest_of(limits, start.t, t_end, mech_of(problem).breakpoints)
            brief = 10.0 * shortest * pushed / c.mass.max() if pushed > 0.0 else 0.0
            slip = max(float(np.abs(y.g).max(initial=0.0)), brief, _slip_of_drivers(problem, start, t_end, limits))
            to_come = _speeds_to_come(problem, start, t_end, (load, pushed), c.mass, slip)
            c.floor_v[:] = np.maximum(c.floor_v, to_come)
            out.top_slip = max(out.top_slip, _slip_by(problem, start, to_come)[0])
    weight = np.sqrt(c.mass)
    omega = float(np.max(problem.omega, initial=0.0))
    c.h = first_step(weight * y.v, weight * y.a, t_end - start.t, PART, omega)
    place, rate = (weight * c.q).max(initial=0.0), (weight * np.abs(y.a)).max(initial=0.0)
    if not np.any(y.v) and c.h * c.h * rate > FAR * FAR * place > 0.0:
        # a step from rest that is long beside all that swings would be damped to nothing, and look right
        c.h = max(PART * math.sqrt(place / rate), 1e-12 * (t_end - start.t))


#: A first step from rest is this much longer than motion takes to change places: only in runs of very many swings.
FAR = 30.0


def _dropped_notes(m: Mechanism) -> tuple[str, ...]:
    """That constraints follow from others, where they do."""
    rows = np.flatnonzero(m.joints.dropped == 1).astype(np.int64)
    if not rows.size:
        return ()
    listed = ", ".join(repr(name) for name in names_of_rows(m, rows))
    what = "reactions are of least norm, and no singular position is looked for"
    return (f"redundant constraints: {len(rows)} of {listed} follow(s) from the others; {what}",)


#: Forces of inertia that are nothing but the round-off of others; those of a load that grows from 0 at the start, which
#: is taken an instant later.
ROUND_OFF, NOTHING = 1e-10, 1e-280


def _load(m: Mechanism, y: State) -> float:
    """Largest of the reactions, friction forces and constant forces."""
    return max(float(np.abs(x).max(initial=0.0)) for x in (y.lam, y.F, m.f))


def _largest_push(problem: Problem, t_start: float, t_end: float) -> float:
    """Largest force of a run that loads prescribed as functions of time bring to one degree of freedom."""
    size, B = largest_forces(problem, t_start, t_end), mechanism_of(problem).B
    return float((np.abs(B.value) * size[B.column]).max(initial=0.0))


def _speeds_to_come(
    problem: Problem, start: Start, t_end: float, loads: tuple[float, float], mass: Floats, slip: float
) -> Floats:
    """Speeds (n,) that count as 1 where everything is at rest: from accelerations a little later, without friction.

    That which would bring most energy, for each its own mass.  Where there are none, either, a small part of what the
    load would bring, or of the largest ``slip`` speed: bristles that drivers have still to bend are all that will push.
    Beside the ``loads``, those at the start and the largest of the run, the tail of a bell (1e-300) is none.
    """
    load, largest = loads[0], max(loads)
    span = t_end - start.t
    for part in LATER:
        a = _without_friction(problem, start, start.t + part * span, np.zeros(problem.n))
        if np.isfinite(a).all() and (mass * np.abs(a)).max() > ROUND_OFF * largest:
            return np.asarray(1e-3 * part * span * (np.sqrt(mass) * np.abs(a)).max() / np.sqrt(mass))
    return np.full(problem.n, 1e-4 * max(span * load / mass.max(), slip))


def _first_speeds(problem: Problem, start: Start, t_end: float) -> Floats:
    """Speeds (n,) that the loads of the start would bring about in a first step from rest."""
    v = np.zeros(problem.n)
    a = _without_friction(problem, start, start.t, v)
    if not np.isfinite(a).all():
        return v
    return np.minimum(first_step(v, a, t_end - start.t, PART), _yielding_times(mechanism_of(problem))) * np.abs(a)


#: What is lighter than this part of the heaviest takes no speeds beyond those at which its springs and dampers yield.
FEATHER = 1e-6


def _yielding_times(m: Mechanism) -> Floats:
    """Times (n,) for which the accelerations of the start last: infinite, but for what is light beside everything else.

    An end of a rope without mass of its own comes to its speed at once, and not by ``a h`` to a billion times that.
    """
    mass, time = masses(m), np.full(m.n, np.inf)
    light = mass < FEATHER * mass.max(initial=0.0)
    for entries, power in ((m.K, 0.5), (m.C, 1.0)) if light.any() else ():
        own = (entries.row == entries.column) & (entries.row < m.n)
        rate = np.bincount(entries.row[own], entries.value[own], m.n) / mass
        stiff = light & (rate > 0.0)
        time[stiff] = np.minimum(time[stiff], rate[stiff] ** -power)
    return time


def _slip_by(problem: Problem, start: Start, *v: Floats) -> Floats:
    """Largest slip velocity that each of some velocities v (n,) brings, by itself, at the start."""
    g = _completed(problem, start, start.t, np.stack([np.zeros(problem.n), *v]))[2]
    slip: Floats = np.abs(g[:, 1:] - g[:, :1]).max(axis=0, initial=0.0)
    return slip


#: Parts of a run after which it is looked at what drivers, or loads, bring.
LATER = 1e-3, 1e-2, 1e-1, 1.0


#: So many of the shortest stretches of inputs are looked at for what they bring.
BRIEFEST = 100


def _slip_of_drivers(problem: Problem, start: Start, t_end: float, limits: LongestSteps | None = None) -> float:
    """Largest slip velocity that signals bring at some later times, where nothing else moves.

    With the ``limits`` of steps under inputs, in the middle of the shortest of these as well: a bell's peak is there.
    """
    if not problem.n_u:
        return 0.0
    t = start.t + np.array(LATER) * (t_end - start.t)
    if limits is not None:
        edge = np.clip(limits.edge, start.t, t_end)
        middle = 0.5 * (edge[:-1] + edge[1:])
        shortest = np.argsort(np.abs(limits.longest), kind="stable")[:BRIEFEST]
        within = middle[shortest]
        t = np.append(t, within[(within > start.t) & (within < t_end)])
    g = np.abs(_completed(problem, start, t, np.zeros((len(t), problem.n)))[2])
    return float(g[np.isfinite(g)].max(initial=0.0))


def _without_friction(problem: Problem, start: Start, t: float, v: Floats) -> Floats:
    """Accelerations (n,) at the start's positions, at time t, with velocities v."""
    return _completed(problem, start, t, v[None])[4].ravel()


def _completed(problem: Problem, start: Start, t: float | Floats, v: Floats) -> tuple[Floats, ...]:
    """What :func:`complete_at` finds at the start's positions, at t (k,), without friction; velocities v (k, n)."""
    k = len(v)
    q, z = np.tile(np.array(start.q, float), (k, 1)), np.tile(np.array(start.z, float), (k, 1))
    force = np.zeros((k, mechanism_of(problem).n_rows + 2 * problem.m))
    return complete_at(problem, np.full(k, t), q, np.array(v, float), z, np.ones((k, problem.n_c), np.int8), force)
