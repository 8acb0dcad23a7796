"""Outcomes that hang on less than a run resolves: passes of rest in two directions, point springs through zero."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from fricmb._simulate._joined import runs_of
from fricmb.integrate.event_kinds import EVENT_STICK
from fricmb.integrate.implicit.output.step_trajectory import StepTrajectory
from fricmb.integrate.problem import LAW_SMOOTH, SLIP, STICK, Floats, Ints, Problem
from fricmb.integrate.run.chunked_run import KeptTrajectory
from fricmb.integrate.trajectory import Trajectory
from fricmb.solution import Solution

#: How much nearer than this many ``rtol`` of the largest value something passes for its outcome to be in doubt; the
#: ``rtol`` that is taken for methods with fixed steps.
NEAR, FIXED = 10.0, 1e-4
#: Minima that are looked at in a run, the lowest ones; points and rounds in which each is closed in on.
MOST, POINTS, ROUNDS = 100, 17, 10
#: Relative angle within which a path is a straight line, on which rest cannot be missed.
STRAIGHT = 1e-9


def miss_notes(sol: Solution, trajectory: Trajectory, rtol: float | None) -> tuple[str, ...]:
    """Sentences for ``stats.notes``; ``rtol`` None: fixed steps."""
    near = NEAR * (FIXED if rtol is None else rtol)
    runs = runs_of(trajectory)
    notes = [note for run in runs for note in _passes(run, near)]
    # steps that are controlled by their error see the jump
    seen = rtol is not None and all(isinstance(run, StepTrajectory) for run in runs)
    if not seen and not any(isinstance(run, KeptTrajectory) for run in runs):
        notes += _through_zero(sol, trajectory, near)
    return tuple(notes)


def _lowest(f: Callable[[Floats], Floats], low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Minima of f between bounds (k,): where and how low."""
    t, value = 0.5 * (low + high), np.full(low.shape, np.inf)
    each = np.arange(low.size)
    for _ in range(ROUNDS if low.size else 0):
        grid = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, POINTS)
        found = f(grid.ravel()).reshape(grid.shape)
        i = np.argmin(found, axis=1)
        t, value = grid[each, i], found[each, i]
        low, high = grid[each, np.maximum(i - 1, 0)], grid[each, np.minimum(i + 1, POINTS - 1)]
    return t, value


def _minima(size: Floats, allowed: Any, below: float) -> Ints:
    """Places of inner minima of ``size`` (n,) below a bound, the lowest ones, where ``allowed`` (n,)."""
    inner = np.flatnonzero((size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:]) & (size[1:-1] < below)) + 1
    inner = inner[[bool(allowed[i - 1] and allowed[i] and allowed[i + 1]) for i in inner]] if inner.size else inner
    return np.sort(inner[np.argsort(size[inner], kind="stable")[:MOST]])


def _way_off(r: Floats, slips: Any, i: int, step: int, clear: float) -> int:
    """The row from i on, forwards or backwards within the slip, at which r is ``clear``; else the slip's last."""
    i += step
    while 0 < i < r.size - 1 and r[i] < clear and slips[i + step]:
        i += step
    return i


def _in_band(problem: Problem, run: Trajectory, k: int, t: float, back: float) -> bool:
    """Whether the force that would hold contact k at rest at t lies above mu_0 N and not above mu_s N.

    Taken a little before: its change is small, and the direction of slip does not swing yet.
    """
    contacts = problem.contacts
    rows = slice(contacts.row[k], contacts.row[k + 1])
    at = t - back + 0.1 * back * np.array([-1.0, 0.0, 1.0])
    seen = run.motion(np.maximum(at, run.t[0]))
    W = contacts.W[:, rows]
    D = W.T @ np.linalg.solve(problem.linear.M, W)
    rate = (seen.g[rows, 2] - seen.g[rows, 0]) / (0.2 * back)
    held = float(np.linalg.norm(np.linalg.solve(D, rate) - seen.F[rows, 1]))
    N = float(seen.N[k, 1])
    return bool(0.999 * contacts.mu_0[k] * N < held <= 1.001 * contacts.mu_s[k] * N)


def _passes(run: Trajectory, near: float) -> Iterator[str]:
    """Notes on contacts in two directions that pass rest so closely, or are caught where they might have passed."""
    problem = run.problem
    contacts = problem.contacts
    if problem.mechanism is not None or isinstance(run, KeptTrajectory):
        return
    for k in np.flatnonzero((np.diff(contacts.row) == 2) & (contacts.law != LAW_SMOOTH)):
        if not contacts.mu_s[k] > contacts.mu_0[k] * (1.0 + 1e-9):
            continue
        rows = slice(contacts.row[k], contacts.row[k + 1])
        seen = run.row_motion()
        r, slips = np.hypot(*seen.g[rows]), seen.mode[k] == SLIP
        top = float(r.max(initial=0.0))

        def speed(t: Floats, rows: slice = rows) -> Floats:
            return np.asarray(np.hypot(*run.motion(t).g[rows]))

        i = _minima(r, slips, 0.05 * top)
        t, least = _lowest(speed, seen.t[i - 1], seen.t[i + 1])
        times = []
        for at, low, j in zip(t, least, i, strict=True):
            clear = max(100.0 * low, 0.01 * near * top)
            before, after = _way_off(r, slips, j, -1, clear), _way_off(r, slips, j, 1, clear)
            back = float(at - seen.t[before])
            # what does not get clear of rest again has landed
            passes = low <= near * top and r[after] >= clear and back > 0.0
            if passes and _in_band(problem, run, int(k), float(at), back):
                times.append(float(at))
        times += _caught(run, int(k), r, top)
        if times:
            more = f" (and {len(times) - 1} times more)" if len(times) > 1 else ""
            yield (
                f"contact {problem.contact_names[k]!r} passes rest at t = {min(times):.6g}{more} within the"
                " tolerance: whether it sticks there or slips on depends on the error of the run"
            )


def _caught(run: Trajectory, k: int, r: Floats, top: float) -> list[float]:
    """When a slip ended in stick by a force above mu_0 N though its path was no straight line."""
    problem, seen = run.problem, run.row_motion()
    contacts, events = problem.contacts, run.transitions
    rows = slice(contacts.row[k], contacts.row[k + 1])
    times = []
    for t in events.t[(events.contact == k) & (events.kind == EVENT_STICK)]:
        stuck = np.flatnonzero((seen.t >= t) & (seen.mode[k] == STICK))
        if not stuck.size:
            continue
        force, N = seen.F[rows, stuck[0]], seen.N[k, stuck[0]]
        if np.linalg.norm(force) <= 1.000001 * contacts.mu_0[k] * N:
            continue
        before = np.flatnonzero((seen.t < t) & (r > 1e-3 * top))
        if before.size:
            g = seen.g[rows, before[-1]]
            if abs(g[0] * force[1] - g[1] * force[0]) > STRAIGHT * np.linalg.norm(g) * np.linalg.norm(force):
                times.append(float(t))
    return times


def _through_zero(sol: Solution, trajectory: Trajectory, near: float) -> Iterator[str]:
    """Notes on springs and dampers between two points that meet: the direction of their force jumps there."""
    from fricmb.scene import PointDamper, PointSpring
    from fricmb.values import value_of

    for part in sol.scene.parts:
        if not isinstance(part, PointSpring | PointDamper):
            continue
        if isinstance(part, PointSpring) and value_of(part.length) == 0.0:
            continue
        forms = part.local_coordinates()

        def distance(t: Floats, forms: Any = forms) -> Floats:
            here = sol.at(t)
            parts = [f.constant + sum((c * here[name] for name, c in f.terms), np.zeros(t.shape)) for f in forms]
            return np.sqrt(sum((x**2 for x in parts), np.zeros(t.shape)))

        t = np.unique(trajectory.t[trajectory.t <= sol.run.t_end])
        t = np.sort(np.concatenate((t, 0.5 * (t[1:] + t[:-1]))))
        size = distance(t)
        top = float(size.max(initial=0.0))
        i = _minima(size, np.ones(size.shape, bool), 0.5 * top)
        at, least = _lowest(distance, t[i - 1], t[i + 1])
        times = at[least <= near * top]
        if times.size:
            more = f" (and {times.size - 1} times more)" if times.size > 1 else ""
            yield (
                f"the ends of {part.name!r} meet at t = {times.min():.6g}{more}: the direction of its force jumps"
                " there, which steps do not locate, and the run may be less accurate from there on"
            )
