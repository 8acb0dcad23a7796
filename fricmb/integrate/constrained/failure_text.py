"""Why a run of a mechanism stopped, in words: which part, which condition."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.constrained.redundancy import singular_joints
from fricmb.integrate.constrained.structure import mechanism_of
from fricmb.integrate.problem import SLIP, STICK, Codes, Floats, Problem
from fricmb.integrate.run.outcomes import (
    FAIL_CHATTER,
    FAIL_CREEP,
    FAIL_HIT,
    FAIL_INFINITE,
    FAIL_LOST,
    FAIL_MARGIN,
    FAIL_MODES,
    FAIL_PROJECT,
    FAIL_SEVERAL,
    FAIL_SINGULAR,
    FAIL_STEP,
    FAILURES,
)

#: A margin of uniqueness that is as good as gone.
NEAR = 0.02


def failure_text(code: int, problem: Problem, k: Any, y: Any, out: Any) -> str:
    """The reason for a code of failure."""
    if code in (FAIL_CHATTER, FAIL_INFINITE):
        return FAILURES[code]
    if code == FAIL_CREEP:
        return "the step size fell again and again, as equations were not solved: a law is far steeper here than there"
    if code in (FAIL_MODES, FAIL_MARGIN) and k.unsolved > 0:
        return _none_found(problem, k, y, out)
    names, joints = problem.contact_names, mechanism_of(problem).joints
    port = int(np.argmin(out.margin)) if problem.n_c else -1
    least = float(out.margin.min(initial=1.0))
    minor = float(out.together)
    # a margin is a minor over a smaller one: where that one goes through 0, it jumps
    if code == FAIL_MARGIN and (minor <= 0.0 < least or minor < NEAR <= least):
        together = ", ".join(repr(names[c]) for c in np.flatnonzero(np.asarray(y.mode) == SLIP))
        return (
            f"the friction of {together} together has no single solution: a principal minor of 1 + mu dN/dF over them"
            f" is {minor:.3g}, and all have to be positive (jamming: each presses on the other)"
        )
    if code == FAIL_MARGIN or (code in (FAIL_STEP, FAIL_MODES) and least < NEAR):
        return (
            f"the friction of {names[port]!r} has no single solution: 1 + mu dN/dF has fallen to {least:.3g} and has"
            " to be positive (the reaction grows with the friction that it causes faster than friction sheds it:"
            " Painleve, jamming)"
        )
    at_rest, stuck = _at_rest(problem, y, out), _stuck(problem, y)
    if code == FAIL_MODES:
        return f"no combination of stick and slip satisfies friction and reactions together{at_rest}"
    if code == FAIL_SEVERAL:
        return f"several combinations of stick and slip satisfy friction and reactions together{at_rest}"
    row = joints.row[:-1]
    if code == FAIL_LOST:
        held = (joints.one_sided != 0) & (joints.hands_over == 0)
        name = joints.names[int(np.argmin(np.where(held, y.lam[np.minimum(row, len(y.lam) - 1)], np.inf)))]
        return (
            f"contact of {name!r} is lost: its reaction has fallen to 0 and cannot turn round"
            " (surfaces only push, ropes pull)"
        )
    if code == FAIL_HIT:
        opened = (joints.hands_over == 1) & (joints.dropped[np.minimum(row, len(y.lam) - 1)] == 2)
        name = joints.names[int(np.argmin(np.where(opened, out.gap, np.inf)))]
        return f"contact of {name!r} closes again, and impacts are not computed without restitution="
    if code == FAIL_SINGULAR:
        names_now = ", ".join(repr(name) for name in singular_joints(problem, float(y.t), y.q, y.v))
        risen = (out.sigma_top / max(out.sigma, 1e-300)) ** 2
        return (
            f"singular position: the constraints of {names_now} depend on one another (the condition of G M^-1 G^T has"
            f" risen by {risen:.1e} since it was smallest)"
        )
    if code == FAIL_PROJECT:
        return "velocities could not be brought onto the constraints of what sticks"
    return f"the step size fell to round-off: the solution is not smooth here, or grows without bound{stuck}"


def _none_found(problem: Problem, k: Any, y: Any, out: Any) -> str:
    """What a decision has found of combinations of stick and slip that have no solution, not even by shares."""
    share, combinations = k.furthest, k.unsolved
    at_rest = _at_rest(problem, y, out)
    if at_rest:
        return (
            f"no combination of stick and slip satisfies friction and reactions together{at_rest}; for"
            f" {combinations} of them no forces of friction were found at all (Painleve, jamming)"
        )
    of_joints = np.isin(np.arange(problem.n_c), mechanism_of(problem).joints.port)
    slips = (np.asarray(y.mode) == SLIP) & of_joints
    jammed = slips & (out.margin <= 0.0)
    names = ", ".join(repr(problem.contact_names[c]) for c in np.flatnonzero(jammed if jammed.any() else slips))
    return (
        f"the friction of {names} has no solution in slip as it is: the reaction grows with the friction that it causes"
        f" faster than friction sheds it (Painleve, jamming); with up to some {share:.2f} of the coefficient there is"
        " one, or with springs in place of the joint"
    )


def _stuck(problem: Problem, y: Any) -> str:
    """What sticks, in brackets."""
    names = [repr(name) for name, mode in zip(problem.contact_names, y.mode, strict=True) if mode == STICK]
    return f" (what sticks: {', '.join(names)})" if names else ""


def _at_rest(problem: Problem, y: Any, out: Any) -> str:
    """What is at rest, in brackets."""
    row = problem.contacts.row
    g = np.asarray(y.g)
    slow = [c for c in range(problem.n_c) if np.linalg.norm(g[row[c] : row[c + 1]]) <= 1e-9 * out.top_slip]
    return f" (at rest: {', '.join(repr(problem.contact_names[c]) for c in slow)})" if slow else ""


def held_notes(problem: Problem, t: Floats, mode: Codes, opened: Codes) -> tuple[str, ...]:
    """A note where ports stick that hold more than there is to hold: step starts t (k,), modes and open joints."""
    m = mechanism_of(problem)
    free = m.n - m.n_rows + int((m.joints.dropped == 1).sum()) + opened.sum(axis=1)
    more = np.flatnonzero((mode == STICK) @ np.diff(problem.contacts.row) > free)
    if not len(more):
        return ()
    stuck = ", ".join(repr(problem.contact_names[c]) for c in np.flatnonzero(mode[more[0]] == STICK))
    return (
        f"{stuck} stick together (first at t = {t[more[0]]:.6g}): what each of them holds is not determined, nor"
        " does the motion depend on it; they let go where no shares within their cones hold, and the forces of least"
        " norm are given while these lie within the cones",
    )
