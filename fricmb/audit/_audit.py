"""A run against the equations of its scene."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fricmb._simulate._arguments import check_tolerance, floors, number
from fricmb._simulate._closes import unclosed
from fricmb.audit import _onset
from fricmb.audit._fading import Fading
from fricmb.audit._gather import LIMIT, Gathered
from fricmb.audit._points import Points
from fricmb.audit._result import Audit
from fricmb.audit._transitions import Changes
from fricmb.audit._units import DENSE, ROUND_OFF, Units, at_rest, units_of
from fricmb.audit._weak import NODES, Weak
from fricmb.errors import SceneError, shown
from fricmb.field._statements import Statements
from fricmb.integrate.problem import Floats, Ints
from fricmb.integrate.run.chunked_run import KeptTrajectory, take
from fricmb.integrate.trajectory import Samples

#: Tolerance that a run of fixed steps is measured by, which nobody has asked for.
FIXED = 1e-3
#: Steps that are looked at: at most so many, and so many numbers at the nodes within them.
STEPS, NUMBERS, STEPS_OF_MECHANISMS = 250, 6_000_000, 60


def audit(sol: Any, *, rtol: float | None = None, atol: Any = None, seed: int = 0) -> Audit:
    """See :meth:`fricmb.Solution.audit`."""
    tolerance = sol.stats.rtol if rtol is None else rtol
    if tolerance is None:
        tolerance = FIXED
    tolerance = number("audit: rtol", tolerance, "a finite number > 0", lambda r: r > 0.0)
    floor = sol.stats.atol if atol is None else floors(check_tolerance(FIXED, atol, len(sol.names.dofs)))
    if not isinstance(seed, int | np.integer) or isinstance(seed, bool) or seed < 0:
        raise SceneError(f"audit: seed: got {shown(seed)}; expected an integer of at least 0")
    gathered, notes = Gathered(), []
    rng = np.random.default_rng(seed)
    steps = looked = 0
    transitions = sol.events.transitions
    for piece in sol.run.pieces:
        statements = Statements(sol, piece)
        rows = piece.rows()
        units = at_rest(units_of(rows, sol.names.row_scale, tolerance, floor), statements, rows)
        if isinstance(piece.trajectory, KeptTrajectory):
            notes.append("what lies between the times that this long run has kept")
            Points(statements, units, gathered).look(take(rows, _some(rows.t.size, statements, rng)), rng)
            steps += rows.t.size
            continue
        begin = np.flatnonzero(np.diff(rows.t) > 0.0)
        chosen = _chosen(begin, rows, statements, rng)
        steps, looked = steps + begin.size, looked + chosen.size
        _look(statements, units, gathered, rows, chosen, piece.sample, np.asarray(transitions.t), rng)
        Changes(statements, units, gathered, rows, piece.sample).look(transitions, rng)
        _onset.look(statements, units, gathered, rows, piece.sample, transitions)
    _energy(sol, tolerance, gathered)
    return Audit(
        checks=gathered.checks(), rtol=tolerance, n_steps=steps, n_looked=looked, notes=tuple(dict.fromkeys(notes))
    )


def _some(count: int, statements: Statements, rng: np.random.Generator) -> Ints:
    """Numbers of rows, at most as many as there is room for."""
    room = max(20, NUMBERS // (60 * max(1, len(statements.names.dofs))))
    return np.arange(count) if count <= room else np.sort(rng.choice(count, room, replace=False))


def _chosen(begin: Ints, rows: Samples, statements: Statements, rng: np.random.Generator) -> Ints:
    """First rows of the steps that are looked at: half of them next to transitions, the others anywhere."""
    most = STEPS_OF_MECHANISMS if statements.joints else STEPS
    room = int(np.clip(NUMBERS // (4 * len(NODES) * max(1, len(statements.names.dofs))), 10, most))
    if begin.size <= room:
        return begin
    change = np.flatnonzero((np.diff(rows.mode, axis=1) != 0).any(axis=0))
    near = np.intersect1d(np.unique(np.concatenate([change - 1, change, change + 1])), begin)
    near = near if near.size <= room // 2 else rng.choice(near, room // 2, replace=False)
    others = rng.choice(np.setdiff1d(begin, near), room - near.size, replace=False)
    found: Ints = np.sort(np.concatenate([near, others]))
    return found


def _look(
    statements: Statements, units: Units, gathered: Gathered, rows: Samples, chosen: Ints, sample: Any,
    events: Floats, rng: np.random.Generator,
) -> None:  # fmt: skip
    """Steps from their begin to a time within, and from there to their end."""
    points = Points(statements, units, gathered)
    points.cones(rows, sample)
    if not chosen.size:
        points.look(rows, rng)
        return
    begin, end = take(rows, chosen), take(rows, chosen + 1)
    inside: Floats = begin.t + (end.t - begin.t) * rng.uniform(0.2, 0.8, chosen.size)
    middle = sample(inside)
    weak = Weak(statements, units, sample)
    open_ = _unlocated(rows, chosen, events)
    sure = ~open_
    if sure.any():
        first, half, last = (take(samples, sure) for samples in (begin, middle, end))
        one, two = weak.residual(first, half, rng), weak.residual(half, last, rng)
        fading = Fading(statements, units, rows, sample)
        whole = weak.judged(one[0] + two[0], np.maximum(one[1], two[1]), last.t, fading)
        _put(weak, gathered, whole, first.t, "")
        parts = [weak.judged(*part, now.t, fading) for part, now in ((one, half), (two, last))]
        _put(weak, gathered, np.maximum(*parts) / DENSE, half.t, ", between steps")
    if open_.any():
        first, last = take(begin, open_), take(end, open_)
        difference, allowed = weak.residual(first, last, rng, statements.jump(first, last))
        _put(weak, gathered, difference / allowed, first.t, "")
    points.look(take(middle, sure), rng)
    # where a function of time jumps, what begins a step has seen it, and what ends one has not yet
    beside = ROUND_OFF * (np.abs(begin.t) + np.abs(end.t))
    points.look(replace(begin, t=begin.t + beside), rng)
    points.look(replace(end, t=end.t - beside), rng)


def _put(weak: Weak, gathered: Gathered, ratio: Floats, t: Floats, where: str) -> None:
    """Ratios (n_rows, n_t) by what the rows are."""
    for name, (own, parts) in weak.groups.items():
        for row, part in zip(np.abs(ratio[own]), parts, strict=True):
            gathered.add(name + where, row, t, part)


def _unlocated(rows: Samples, chosen: Ints, events: Floats) -> Any:
    """Steps within which something happens: their dense output cannot tell when."""
    a, b = rows.t[chosen], rows.t[chosen + 1]
    margin = 1e-6 * (b - a)
    inside = np.searchsorted(events, b - margin) > np.searchsorted(events, a + margin)
    return inside | (rows.mode[:, chosen] != rows.mode[:, chosen + 1]).any(axis=0)


def _energy(sol: Any, rtol: float, gathered: Gathered) -> None:
    """The run's own ledger: what is missing of the energy that is exchanged."""
    lost, scale = unclosed(sol)
    unit = 100.0 / LIMIT * max(rtol, 1e-10) * scale + 1e-300
    gathered.add("energy", [lost / unit], sol.t_end, "")
