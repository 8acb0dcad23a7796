"""A problem made ready for collocation: structures, ports and step-size tables, kept for the next run."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from fricmb.integrate.collocation.exact_room import free_blocks
from fricmb.integrate.collocation.nodes import RUNGS, Z_EXACT, nodes
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.collocation.one_contact.signals import linear_signals
from fricmb.integrate.collocation.structure_blocks import Blocks, blocks
from fricmb.integrate.compile.exchange import with_arrays
from fricmb.integrate.compile.room import room
from fricmb.integrate.model.friction_cone import stick_limits
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import LAW_CONSTANT, NORMAL_CONSTANT, Floats, Ints, Problem
from fricmb.integrate.run.array_cache import cached_by_content
from fricmb.integrate.run.workspace import empty_arrays


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
        and once_per(problem, "linear signals", lambda: linear_signals(problem)) is not None
    )


def linear_part(problem: Problem) -> tuple[Floats, Floats]:
    """(u at t = 0, u') of signals that are linear in time."""
    found = once_per(problem, "linear signals", lambda: linear_signals(problem))
    return found if found is not None else (np.zeros(problem.n_u), np.zeros(problem.n_u))


#: Constants of a one-contact problem under their names in :class:`Run`.
Model = dict[str, Any]


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


def _both_structures(slip: Blocks, stick: Blocks, M: Floats) -> Model:
    """Blocks of the structure in slip (0) and in stick (1)."""
    n = len(M)
    by_force = {"force_0": "start_0", "force_1": "start_1"}
    parts: Model = {name: np.zeros((2, n, n)) for name in ("q_u", "q_v", "v_u", "v_v", *by_force, *by_force.values())}
    parts |= {"w2": np.zeros((2, n)), "damp": np.zeros((2, n))}
    for z, part in enumerate((slip, stick)):
        b = len(part.w2)
        parts["w2"][z, :b], parts["damp"][z, :b] = part.w2, part.d
        for name in ("q_u", "q_v", "v_u", "v_v"):
            parts[name][z, :, :b] = getattr(part, name)
        for name, by_velocity in by_force.items():
            parts[name][z, :b], parts[by_velocity][z, :b] = getattr(part, name), getattr(part, name) @ M
    return parts


def _model(problem: Problem) -> Model:
    n, linear, contacts = problem.n, problem.linear, problem.contacts
    M, K, C = (np.asarray(x, float) for x in (linear.M, linear.Kx[:n, :n], linear.Cx[:n, :n]))
    W = np.ascontiguousarray(contacts.W)
    m = W.shape[1]
    slip, stick = free_blocks(problem), blocks(M, K, C, W, tuple(range(m)))
    start, rate = linear_part(problem)
    Ku = linear.B - linear.Kx[:n, n:]
    Minv, MW, D, Dinv, hold = _port(M, W)
    w = contacts.w + contacts.Wu @ rate
    b = len(stick.w2)
    hold_u, hold_v = np.zeros((m, n)), np.zeros((m, n))
    hold_u[:, :b], hold_v[:, :b] = hold @ (K @ stick.q_u + C @ stick.v_u), hold @ (K @ stick.q_v + C @ stick.v_v)
    c0, c1, b0, b1 = W.T @ slip.v_u, W.T @ slip.v_v, (slip.force_0 @ W).T, (slip.force_1 @ W).T
    linked = ((np.abs(c0) + np.abs(c1)) @ (np.abs(b0) + np.abs(b1)).T > 0).astype(float)
    N = contacts.N[0]
    numbers = {
        "mu_s_N": stick_limits(contacts)[0], "mu_0_N": contacts.mu_0[0] * N,
        "fastest": np.sqrt(np.abs(slip.w2)).max(initial=0.0),
    }  # fmt: skip
    floats = _both_structures(slip, stick, M) | {
        "c0": c0, "c1": c1, "b0": b0, "b1": b1, "linked": linked, "hold_u": hold_u, "hold_v": hold_v, "wt": W.T,
        "mw": MW.T, "D": D, "D_inv": Dinv, "belt": w, "stiff": K, "visc": C, "minv": Minv,
        "load_0": linear.fx[:n] + Ku @ start - linear.Cx[:n, n:] @ rate, "load_1": Ku @ rate,
        "stuck_v": stick.stuck_motion @ w,
    }  # fmt: skip
    whole = {
        "stuck_blocks": b, "coupled": int(m == 2 and bool(linked[0, 1] or linked[1, 0])),
        "modal": np.array([slip.modal, stick.modal], np.int64),
    }  # fmt: skip
    return {name: np.ascontiguousarray(x, dtype=float) for name, x in floats.items()} | numbers | whole


def model(problem: Problem) -> Model:
    """Constants of a one-contact problem."""
    return once_per(problem, "model", lambda: _model(problem))


def fastest_block(problem: Problem) -> float:
    """Largest frequency or decay rate of a one-contact problem in slip."""
    w2, d = model(problem)["w2"][0], model(problem)["damp"][0]
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
    w2, d = model(problem)["w2"][0], model(problem)["damp"][0]
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
    return room(Run(**(empty_arrays(Run) | nodes(s)._asdict())))


def run_of(problem: Problem, s: int) -> Run:
    """The constants of a one-contact problem with s nodes, to look at rows with: there is nothing to work in."""
    return once_per(problem, ("run", s), lambda: with_arrays(_nothing(s), **model(problem)))


def with_rows(run: Run, new: Rows) -> Run:
    """The same run with other rows."""
    return with_arrays(run, **new._asdict())
