"""The constants of a one-contact problem: what its structure gives, and what contact and loads add to that.

Another coefficient, normal force or load leaves what takes eigenproblems, and with it all weights by step size.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from fricmb.integrate.collocation.free_blocks import free_blocks
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.collocation.one_contact.signals import linear_signals
from fricmb.integrate.collocation.structure_blocks import Blocks, blocks
from fricmb.integrate.compile.piece import Pattern, Piece
from fricmb.integrate.model.friction_cone import stick_limits
from fricmb.integrate.model.problem_structs import moved_by
from fricmb.integrate.model.structure import dense_inverse
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Floats, Problem

#: Arrays under their names in :class:`Run`: blocks of the structure in slip and in stick, and what the contact has of
#: them; letters are their sizes.
BLOCKS = ("q_u", "q_v", "v_u", "v_v", "force_0", "force_1", "start_0", "start_1")
BY_ROW = ("c0", "c1", "b0", "b1", "hold_u", "hold_v", "wt", "mw")
BY_DOF = ("stiff", "visc", "minv")
LOADS = ("load_0", "load_1", "stuck_v")
#: Numbers of both.
NUMBERS_OF_CONSTANTS = ("stuck_blocks", "coupled", "fastest", "mu_s_N", "mu_0_N")
#: Damping ratio above which a vibration has died out long before the next transition.
CALM = 0.01


class Structure(NamedTuple):
    """What a structure gives: arrays in one piece, and numbers, under their names in :class:`Run`.

    ``content``: bytes of all, by which weights by step size are known again; ``stuck_motion`` (n, m): see
    :class:`Blocks`; ``quickest`` rate of a block in slip, be it frequency or decay, ``ringing`` of one hardly damped.
    """

    piece: Piece
    numbers: dict[str, Any]
    content: bytes
    stuck_motion: Floats
    quickest: float
    ringing: float


class Loads(NamedTuple):
    """The same of what contact and loads add."""

    piece: Piece
    numbers: dict[str, Any]


@lru_cache(maxsize=64)
def structure_pattern(n: int, m: int) -> Pattern:
    """The arrays that a structure gives."""
    sizes = {"w2": (2, n), "damp": (2, n)} | dict.fromkeys(BLOCKS, (2, n, n)) | dict.fromkeys(BY_ROW, (m, n))
    sizes |= dict.fromkeys(BY_DOF, (n, n)) | dict.fromkeys(("linked", "D", "D_inv"), (m, m))
    return Pattern(Run, sizes, {"modal": (2,)})


@lru_cache(maxsize=64)
def load_pattern(n: int, m: int) -> Pattern:
    """The arrays that loads and the contact give."""
    return Pattern(Run, {"belt": (m,), **dict.fromkeys(LOADS, (n,))})


def _put_blocks(held: dict[str, Any], z: int, part: Blocks, M: Floats) -> None:
    """Blocks of the structure in slip (0) or in stick (1)."""
    b = len(part.w2)
    held["w2"][z, :b], held["damp"][z, :b], held["modal"][z] = part.w2, part.d, part.modal
    held["q_u"][z, :, :b], held["v_v"][z, :, :b] = part.q_u, part.v_v
    held["force_1"][z, :b], held["start_1"][z, :b] = part.force_1, part.force_1 @ M
    if not part.modal:
        held["q_v"][z, :, :b], held["v_u"][z, :, :b] = part.q_v, part.v_u
        held["force_0"][z, :b], held["start_0"][z, :b] = part.force_0, part.force_0 @ M


def _put_contact(held: dict[str, Any], slip: Blocks, W: Floats) -> None:
    """What the contact feels of the blocks in slip."""
    c1, b1 = W.T @ slip.v_v, (slip.force_1 @ W).T
    held["c1"][...], held["b1"][...] = c1, b1
    by_velocity, by_force = np.abs(c1), np.abs(b1)
    if not slip.modal:
        c0, b0 = W.T @ slip.v_u, (slip.force_0 @ W).T
        held["c0"][...], held["b0"][...] = c0, b0
        by_velocity, by_force = np.abs(c0) + by_velocity, np.abs(b0) + by_force
    held["linked"][...] = by_velocity @ by_force.T > 0


def _put_hold(held: dict[str, Any], stick: Blocks, hold: Floats, K: Floats, C: Floats) -> None:
    """The force of the contact in stick by the blocks."""
    b = len(stick.w2)
    if not stick.modal:
        held["hold_u"][:, :b] = hold @ (K @ stick.q_u + C @ stick.v_u)
        held["hold_v"][:, :b] = hold @ (K @ stick.q_v + C @ stick.v_v)
        return
    held["hold_u"][:, :b] = hold @ (K @ stick.q_u)
    if np.count_nonzero(C):
        held["hold_v"][:, :b] = hold @ (C @ stick.v_v)


def _structure(problem: Problem) -> Structure:
    n, m, linear = problem.n, problem.m, problem.linear
    M, K, C = (np.asarray(x, float) for x in (linear.M, linear.Kx[:n, :n], linear.Cx[:n, :n]))
    W = np.ascontiguousarray(problem.contacts.W)
    slip, stick = free_blocks(problem), blocks(M, K, C, W, tuple(range(m)))
    MW, D = moved_by(M, W)
    Dinv = np.asarray(np.linalg.inv(D), dtype=float)
    piece = structure_pattern(n, m).zeros()
    held = piece.arrays
    _put_blocks(held, 0, slip, M)
    _put_blocks(held, 1, stick, M)
    _put_hold(held, stick, Dinv @ MW.T, K, C)
    _put_contact(held, slip, W)
    held["wt"][...], held["mw"][...], held["D"][...], held["D_inv"][...] = W.T, MW.T, D, Dinv
    held["stiff"][...], held["visc"][...], held["minv"][...] = K, C, dense_inverse(M).dense()
    frequencies, linked, b = np.sqrt(np.abs(slip.w2)), held["linked"], len(stick.w2)
    rates = np.maximum(frequencies, np.abs(slip.d))
    numbers = {
        "stuck_blocks": b, "coupled": int(m == 2 and bool(linked[0, 1] or linked[1, 0])),
        "fastest": frequencies.max(initial=0.0),
    }  # fmt: skip
    return Structure(
        piece=piece, numbers=numbers, content=piece.memory.tobytes() + b.to_bytes(4, "little"),
        stuck_motion=stick.stuck_motion,
        quickest=float(rates.max(initial=0.0)),
        ringing=float(rates[slip.d <= 2.0 * CALM * frequencies].max(initial=0.0)),
    )  # fmt: skip


def linear_part(problem: Problem) -> tuple[Floats, Floats]:
    """(u at t = 0, u') of signals that are linear in time."""
    found = once_per(problem, "linear signals", lambda: linear_signals(problem))
    return found if found is not None else (np.zeros(problem.n_u), np.zeros(problem.n_u))


def _loads(problem: Problem) -> Loads:
    n, linear, contacts = problem.n, problem.linear, problem.contacts
    piece = load_pattern(n, problem.m).zeros()
    held = piece.arrays
    held["belt"][...], held["load_0"][...] = contacts.w, linear.fx[:n]
    if problem.n_u:
        start, rate = linear_part(problem)
        by_signal = linear.B - linear.Kx[:n, n:]
        held["belt"] += contacts.Wu @ rate
        held["load_0"] += by_signal @ start
        held["load_0"] -= linear.Cx[:n, n:] @ rate
        held["load_1"][...] = by_signal @ rate
    held["stuck_v"][...] = structure(problem).stuck_motion @ held["belt"]
    return Loads(piece, {"mu_s_N": stick_limits(contacts)[0], "mu_0_N": contacts.mu_0[0] * contacts.N[0]})


def structure(problem: Problem) -> Structure:
    """What the structure of a one-contact problem gives: problems of other loads and coefficients have the same."""
    key = "one contact", problem.contacts.W.tobytes()
    return once_per(problem.linear, key, lambda: _structure(problem))


def loads(problem: Problem) -> Loads:
    """What contact and loads of a one-contact problem add."""
    return once_per(problem, "loads of one contact", lambda: _loads(problem))


def stick_forces(problem: Problem) -> tuple[Floats, Floats]:
    """What a contact holds in stick: (2, m, n) of positions and velocities, (2, m) of the load and its rate."""

    def hold() -> tuple[Floats, Floats]:
        held = structure(problem).piece.arrays
        inverse = held["D_inv"] @ held["mw"]
        by_motion = np.empty((2, *inverse.shape))
        by_motion[0], by_motion[1] = inverse @ held["stiff"], inverse @ held["visc"]
        return inverse, by_motion

    def both() -> tuple[Floats, Floats]:
        inverse, by_motion = once_per(problem.linear, ("held by", problem.contacts.W.tobytes()), hold)
        held = loads(problem).piece.arrays
        by_load = np.empty((2, len(inverse)))
        by_load[0], by_load[1] = inverse @ held["load_0"], inverse @ held["load_1"]
        return by_motion, by_load

    return once_per(problem, "stick forces", both)


def put_constants(run: Run, problem: Problem) -> None:
    """Let a run have the constants of a problem of its size; it never writes to them."""
    first, second = structure(problem), loads(problem)
    if run.belt is second.piece.arrays["belt"]:
        return  # it had them last time
    n, m = problem.n, problem.m
    structure_pattern(n, m).put(run, first.piece)
    load_pattern(n, m).put(run, second.piece)
    for name, number in (*first.numbers.items(), *second.numbers.items()):
        setattr(run, name, number)
