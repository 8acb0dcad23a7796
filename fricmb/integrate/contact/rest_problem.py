"""The contacts at rest at an instant as a problem of accelerations: trials of modes until one set of them holds.

With a = a0 + D F, a stuck contact has a = 0 and |F| <= mu_s N, a slipping one F = -mu_0 N n and a = rho n, rho >= 0 the
initial growth of its slip speed.  It is the port problem of a step with D for G and accelerations for velocities, so
the same Newton solves it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.contact.disc_projection import release
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.friction_cone import break_away, load_factor
from fricmb.integrate.model.friction_discs import relative_acceleration, share
from fricmb.integrate.model.law_values import coefficient, point_along
from fricmb.integrate.model.problem_structs import Packed, Ports, packed_of
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Codes, Contacts, Floats, Floats2, Problem
from fricmb.integrate.step.contact_newton import solve_ports
from fricmb.integrate.step.contact_unknowns import PortState, port_state

#: Relative excess over the cone that still counts as on it: round-off of D^-1 a.
MARGIN = 1e-11


class Rest(Layout):
    """Space for the problem of accelerations: constant-law ports, their state, modes, and who takes part.

    ``part`` (n_c,): 1 a contact at rest, 2 one that is just released (its direction n is a hint, and F is on the cone).
    ``rested`` (n_c,): 1 where one at rest has been so before this instant, 0 where it comes to rest now.
    ``small`` (n_c,): relative velocities that are round-off beside what the scene's forces bring.
    """

    ports: Ports
    w: PortState
    mode: Codes
    part: Codes
    rested: Codes
    tol: Floats
    hA: Floats2
    small: Floats


def rest_of(problem: Problem) -> Rest:
    """Arrays for the acceleration problem of a scene."""
    nc, ports = problem.n_c, packed_of(problem).ports
    plain = Contacts(
        row=problem.contacts.row, W=problem.contacts.W, w=problem.contacts.w, Wu=problem.contacts.Wu,
        z_start=np.zeros(nc + 1, np.int64), law=np.zeros(nc, np.int8), normal=np.zeros(nc, np.int8),
        Wn=problem.contacts.Wn,
    )  # fmt: skip
    w = port_state(replace(problem, contacts=plain), 1)
    own: dict[str, Any] = {
        "mu_s": ports.mu_s.copy(), "mu_0": ports.mu_0.copy(), "law": np.zeros(nc, np.int8), "N": np.zeros(nc),
        "var": np.full(nc, -1, np.int64), "acts": np.zeros(nc, np.int8), "z_start": np.zeros(nc + 1, np.int64),
    }  # fmt: skip
    ports = Ports(**{name: own.get(name, getattr(ports, name)) for name in Ports._fields})
    mode, part, rested = (np.zeros(nc, np.int8) for _ in range(3))
    return Rest(ports, w, mode, part, rested, np.zeros(nc), np.zeros((1, 1)), np.zeros(nc))


def fill_rest(r: Rest, packed: Packed) -> None:
    """Put the contacts of a scene into arrays made for another of the same sizes."""
    for name in ("row", "W", "w", "Wu", "D", "mu_s", "mu_0", "lean", "Wn", "N0"):
        mine, given = getattr(r.ports, name), getattr(packed.ports, name)
        if mine is not given:
            mine[...] = given
    r.ports.soft = packed.ports.soft


@kernel
def solve_rest(packed: Packed, s: Scratch, y: State, r: Rest) -> int:
    """Forces, modes and directions of the contacts in ``r.part``; a0 must hold their accelerations without friction.

    Returns the number of trials, or -1 where none of them holds.
    """
    ports = r.ports
    nc = r.mode.shape[0]
    w = r.w
    held = np.zeros(nc)
    # of redundant contacts one that is released may be held by the others: it does not slip
    least = 1e-9 if ports.soft > 0.0 else -1e-9
    big = 1e-300
    for a in range(y.a0.shape[0]):
        big = max(big, abs(y.a0[a]))
        for b in range(y.a0.shape[0]):
            w.G[a, b] = ports.D[a, b]
    for k in range(nc):
        w.N[0, k] = y.N[k]
        if packed.ports.law[k] != LAW_SMOOTH and packed.ports.var[k] >= 0:
            ports.mu_0[k] = coefficient(packed.ports, packed.laws, k, s, 0.0, y.N[k])[0]
            ports.mu_s[k] = break_away(packed.ports, packed.laws, k, s, y.N[k])
        r.tol[k] = 1e-13 * big
        r.mode[k] = OPEN
        if r.part[k] == 1:
            r.mode[k] = STICK
        elif r.part[k] == 2:
            r.mode[k] = SLIP
    for trial in range(6 * nc + 10):
        if not try_modes(packed, y, r, s) or torn(y, r, big):
            break
        worst, back = find_wrong(y, r, held, least * big, big)
        if worst >= 0:
            if taken_along(y, r, worst, big):
                point_along(ports.row, worst, y.a0, 1.0, y.n)
            else:
                point_along(ports.row, worst, w.F[0], -1.0, y.n)
            r.mode[worst] = SLIP
        elif back >= 0:
            r.mode[back] = STICK
        elif not hold_again(packed, y, r, s, held, least * big, big):
            break
        else:
            take_modes(packed, y, r, w.n[0], w.F[0])
            return trial + 1
    # releases that call each other back, or no convergence
    if not release(ports, y, r.part, r.mode, y.F):
        return -1
    take_modes(packed, y, r, y.n, y.F)
    return 1


@kernel
def torn(y: State, r: Rest, big: float) -> bool:
    """Whether redundant contacts that are held are drawn apart by what they rub on: no forces, however large, do that.

    A body between a belt that turns round and the ground rests on neither's account; forces of least squares are small.
    """
    ports, found = r.ports, False
    for k in range(r.mode.shape[0] if ports.soft > 0.0 else 0):
        for a in range(ports.row[k], ports.row[k + 1] if r.mode[k] == STICK else ports.row[k]):
            rate = relative_acceleration(ports, y.a0, r.w.F[0], a)
            found = found or (ports.D[a, a] > 0.0 and abs(rate) > 1e-6 * big)
    return bool(found)


@kernel
def taken_along(y: State, r: Rest, k: int, big: float) -> bool:
    """Whether slip of contact k across a guide, which no force changes, begins: beyond any cone."""
    found = False
    for a in range(r.ports.row[k], r.ports.row[k + 1]):
        found = found or (r.ports.D[a, a] == 0.0 and abs(y.a0[a]) > MARGIN * big)
    return bool(found)


@kernel
def find_wrong(y: State, r: Rest, held: Floats, least: float, big: float) -> tuple[int, int]:
    """The contact that is to be released next, being beyond its cone, and one that would slip against its force.

    Either is -1 where there is none.  What comes to rest is released before what has rested.
    """
    ports, w = r.ports, r.w
    if ports.soft > 0.0:
        for k in range(r.mode.shape[0]):
            held[k] = ports.mu_s[k] * y.N[k]
        share(ports, r.mode, held, w.F[0], y.way)
    worst, back, excess = -1, -1, 1.0 + MARGIN
    for k in range(r.mode.shape[0]):
        if r.mode[k] == STICK:
            ratio = load_factor(ports, k, w.F[0], ports.mu_s[k] * y.N[k])
            if taken_along(y, r, k, big):
                ratio = np.inf
            first = worst < 0 or r.rested[k] < r.rested[worst]
            if ratio > 1.0 + MARGIN and (first or (r.rested[k] == r.rested[worst] and ratio > excess)):
                excess, worst = ratio, k
        elif r.mode[k] == SLIP and w.r[0, k] < least and r.part[k] == 1:
            back = k
    return worst, back


@kernel
def hold_again(packed: Packed, y: State, r: Rest, s: Scratch, held: Floats, least: float, big: float) -> bool:
    """Where several were released, hold those that come to rest and need not slip; False without convergence.

    A contact that was released first may be able to stick once another has let go.  What breaks away (part 2) takes
    along whom it will.
    """
    count = 0
    for k in range(r.mode.shape[0]):
        if r.part[k] == 2:
            return True
        if r.mode[k] == SLIP and r.part[k] == 1:
            count += 1
    changed = False
    for k in range(r.mode.shape[0]):
        if r.mode[k] != SLIP or r.part[k] != 1 or r.rested[k] == 1 or count < 2:
            continue
        r.mode[k] = STICK
        changed = not try_modes(packed, y, r, s)
        if not changed:
            worst, back = find_wrong(y, r, held, least, big)
            changed = worst >= 0 or back >= 0
        if changed:
            r.mode[k] = SLIP
        else:
            count -= 1
    return not changed or try_modes(packed, y, r, s)


@kernel
def try_modes(packed: Packed, y: State, r: Rest, s: Scratch) -> bool:
    """Forces and directions under ``r.mode``, from directions ``y.n``; False without convergence."""
    w = r.w
    for k in range(r.mode.shape[0]):
        w.r[0, k] = 0.0
        for a in range(r.ports.row[k], r.ports.row[k + 1]):
            w.F[0, a] = 0.0
            w.Fo[0, a] = 0.0
            w.gb[0, a] = y.a0[a]
            w.n[0, a] = y.n[a]
    return bool(solve_ports(r.ports, packed.laws, s, w, r.hA, r.mode, r.tol) >= 0)


@kernel
def take_modes(packed: Packed, y: State, r: Rest, n: Floats, F: Floats) -> None:
    """Give the contacts that take part the modes found, with their directions and forces."""
    for k in range(r.mode.shape[0]):
        if r.mode[k] != OPEN:
            y.mode[k] = r.mode[k]
            for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
                y.n[a] = n[a]
                y.F[a] = F[a]
