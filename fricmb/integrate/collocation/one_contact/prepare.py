"""A problem made ready for collocation: structures, ports and step-size tables, kept for the next run."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fricmb.integrate.collocation.exact_room import free_blocks
from fricmb.integrate.collocation.nodes import RUNGS, Z_EXACT, nodes
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.collocation.one_contact.signals import linear_signals
from fricmb.integrate.collocation.structure_blocks import Blocks, blocks
from fricmb.integrate.compile.exchange import with_arrays
from fricmb.integrate.compile.room import room
from fricmb.integrate.model.friction_cone import stick_limits
from fricmb.integrate.problem import LAW_CONSTANT, NORMAL_CONSTANT, Floats, Ints, Problem
from fricmb.integrate.run.array_cache import cached_by_content
from fricmb.integrate.run.problem_cache import once_per_problem


def is_single(problem: Problem) -> bool:
    """Whether the problem is one contact under constant friction with at most linear loads."""
    contacts = problem.contacts
    return bool(
        problem.n_c == 1
        and contacts.law[0] == LAW_CONSTANT
        and contacts.normal[0] == NORMAL_CONSTANT
        and contacts.N[0] > 0
        and contacts.mu_0[0] > 0
        and problem.n_z == 0
        and len(problem.elements.table.address) == 0
        and once_per_problem(problem, "linear signals", lambda: linear_signals(problem)) is not None
    )


def linear_part(problem: Problem) -> tuple[Floats, Floats]:
    """(u at t = 0, u') of signals that are linear in time."""
    found = once_per_problem(problem, "linear signals", lambda: linear_signals(problem))
    return found if found is not None else (np.zeros(problem.n_u), np.zeros(problem.n_u))


class Model(NamedTuple):
    """Constants of a one-contact problem as kernels take them (see :mod:`~fricmb.integrate.collocation.layout`)."""

    blk: Floats
    mat: Floats
    co: Floats
    ci: Floats
    linked: Floats
    row: Floats
    dof: Floats
    vec: Floats
    con: Floats
    lim: Floats
    flags: Ints


class Rows(NamedTuple):
    """What is kept of a run: steps, their mode and phase, phases, and events (time, kind)."""

    steps: Floats
    kinds: Ints
    phases: Floats
    events: Floats


@cached_by_content
def _port(M: Floats, W: Floats) -> tuple[Floats, ...]:
    """Inverse mass, motion of the dofs per contact force, Delassus matrix, its inverse, what holds the rows."""
    Minv = np.asarray(np.linalg.inv(M), dtype=float)
    MW = Minv @ W
    D = W.T @ MW
    Dinv = np.asarray(np.linalg.inv(D), dtype=float)
    return Minv, MW, D, Dinv, Dinv @ MW.T


def _model(problem: Problem) -> Model:
    n, linear, contacts = problem.n, problem.linear, problem.contacts
    M, K, C = (np.asarray(x, float) for x in (linear.M, linear.Kx[:n, :n], linear.Cx[:n, :n]))
    W = np.ascontiguousarray(contacts.W)
    m = W.shape[1]
    slip, stick = free_blocks(problem), blocks(M, K, C, W, tuple(range(m)))
    Minv, MW, D, Dinv, hold = _port(M, W)
    blk, mat = _blocks_by_mode(M, slip, stick)
    row = np.zeros((4, m, n))
    _hold_row(row[:2], hold, K, C, stick)
    row[2], row[3] = W.T, MW.T
    co, ci, linked = _port_weights(W, slip)
    coupled = bool(m == 2 and (linked[0, 1] or linked[1, 0]))
    start, rate = linear_part(problem)
    Ku = linear.B - linear.Kx[:n, n:]
    w = contacts.w + contacts.Wu @ rate
    f0 = linear.fx[:n] + Ku @ start - linear.Cx[:n, n:] @ rate
    fastest = math.sqrt(np.abs(slip.w2).max()) if n else 0.0
    lim = [stick_limits(contacts)[0], contacts.mu_0[0] * contacts.N[0], fastest, *w]
    arrays = [
        blk, mat, co, ci, linked, row, np.array([K, C, Minv]), np.array([f0, Ku @ rate, stick.stuck_motion @ w]),
        np.array([D, Dinv]), np.array(lim),
    ]  # fmt: skip
    flags = np.array([m, len(stick.w2), slip.modal, stick.modal, coupled], dtype=np.int64)
    return Model._make([*arrays, flags])


def _blocks_by_mode(M: Floats, slip: Blocks, stick: Blocks) -> tuple[Floats, Floats]:
    """Coefficients of the blocks (2, 2, n), and what turns states into motion and forces into inputs (2, 8, n, n).

    Of each mode q_u, q_v, v_u, v_v, then force_0, force_1 by force and by momentum; see :class:`Blocks`.
    """
    n = len(M)
    blk, mat = np.zeros((2, 2, n)), np.zeros((2, 8, n, n))
    for z, part in enumerate((slip, stick)):
        b = len(part.w2)
        blk[z, 0, :b], blk[z, 1, :b] = part.w2, part.d
        mat[z, 0, :, :b], mat[z, 3, :, :b] = part.q_u, part.v_v
        mat[z, 5, :b], mat[z, 7, :b] = part.force_1, part.force_1 @ M
        if not part.modal:
            mat[z, 1, :, :b], mat[z, 2, :, :b] = part.q_v, part.v_u
            mat[z, 4, :b], mat[z, 6, :b] = part.force_0, part.force_0 @ M
    return blk, mat


def _hold_row(row: Floats, hold: Floats, K: Floats, C: Floats, stick: Blocks) -> None:
    """The force that holds the contact (2, m, b) by the states u, v of the blocks in stick."""
    b = len(stick.w2)
    if stick.modal:
        row[0, :, :b], row[1, :, :b] = hold @ (K @ stick.q_u), hold @ (C @ stick.v_v)
        return
    row[0, :, :b] = hold @ (K @ stick.q_u + C @ stick.v_u)
    row[1, :, :b] = hold @ (K @ stick.q_v + C @ stick.v_v)


def _port_weights(W: Floats, slip: Blocks) -> tuple[Floats, Floats, Floats]:
    """Relative velocity by the states of the blocks and their inputs by the contact force, (2, m, b) each.

    Also which row (m, m) moves at all by the force of which.
    """
    co = np.array([W.T @ slip.v_u, W.T @ slip.v_v])
    ci = np.array([(slip.force_0 @ W).T, (slip.force_1 @ W).T])
    size_o, size_i = np.abs(co), np.abs(ci)
    return co, ci, ((size_o[0] + size_o[1]) @ (size_i[0] + size_i[1]).T > 0).astype(float)


def model(problem: Problem) -> Model:
    """Constants of a one-contact problem."""
    return once_per_problem(problem, "model", lambda: _model(problem))


def fastest_block(problem: Problem) -> float:
    """Largest frequency or decay rate of a one-contact problem in slip."""
    w2, d = model(problem).blk[0]
    return float(max(np.sqrt(np.abs(w2)).max(initial=0.0), np.abs(d).max(initial=0.0)))


def longest_step(problem: Problem, s: int, span: float) -> float:
    """The top of the ladder: every block takes exact weights, on which the dense output relies too.

    A step that ``span`` does not hold is none; runs of about the same span share their tables.
    """
    fastest = fastest_block(problem)
    within = 2.0 ** math.ceil(math.log2(span))
    return Z_EXACT[s] / fastest if fastest * within > Z_EXACT[s] else within


#: Damping ratio above which a vibration has died out long before the next transition.
CALM = 0.01
#: Steps below which nothing is gained by looking for longer ones, and by how much longer they have to be.
MANY_STEPS, FAR_LONGER = 2000.0, 10.0


def is_stiff(problem: Problem, s: int, span: float) -> bool:
    """Whether blocks that are damped out would force short steps on the kernels for one contact."""
    w2, d = model(problem).blk[0]
    rates = np.maximum(np.sqrt(np.abs(w2)), np.abs(d))
    ringing = rates[d <= 2.0 * CALM * np.sqrt(np.abs(w2))].max(initial=0.0)
    fastest = rates.max(initial=0.0)
    return bool(span * fastest / Z_EXACT[s] > MANY_STEPS and fastest > FAR_LONGER * ringing)


def set_longest_step(run: Run, longest: float) -> None:
    """Let the ladder begin at this step; tables of another ladder are forgotten."""
    if run.ladder[0] != longest:
        run.ladder[:] = longest * 2.0 ** (-0.25 * np.arange(RUNGS + 1))
        run.slots[:-1] = -1
        run.slots[-1] = 0


def rows(n: int, m: int, s: int, size: int) -> Rows:
    """Space for ``size`` steps, phases and events."""
    width = 4 + 3 * n + m * s + s + 1
    kinds = np.zeros((size, 2), dtype=np.int64)
    return Rows(np.zeros((size, width)), kinds, np.zeros((size, 5 * n + 2)), np.zeros((size, 2)))


@lru_cache(maxsize=64)
def _nothing(s: int) -> Run:
    """Empty arrays, and the tables for s nodes."""
    kinds = dict.fromkeys(("flags", "slots", "terms", "si", "kinds", "places"), np.int64)
    axes = dict.fromkeys(("mat", "tb", "tk", "answers"), 4)
    axes |= dict.fromkeys(("blk", "co", "ci", "row", "dof", "con", "nx", "wk"), 3)
    axes |= dict.fromkeys(("lim", "flags", "ladder", "slots", "terms", "sx", "si", "places"), 1)
    empty = {name: np.zeros((0,) * axes.get(name, 2), kinds.get(name, float)) for name in Run._fields}
    return room(Run(**(empty | nodes(s)._asdict())))


def run_of(problem: Problem, s: int, held: Rows) -> Run:
    """The constants of a one-contact problem with s nodes, to look at rows with: there is nothing to work in."""
    return with_arrays(_nothing(s), **model(problem)._asdict(), **held._asdict())


def with_rows(run: Run, new: Rows) -> Run:
    """The same run with other rows."""
    return with_arrays(run, **new._asdict())
