"""A Problem as nested tuples of contiguous arrays: what kernels take."""

from __future__ import annotations

import math
import weakref
from typing import NamedTuple

import numpy as np

from fricmb.integrate._problem import NORMAL_CONSTANT, NORMAL_LAW, Codes, Floats, Floats2, Ints, Problem, Templates
from fricmb.integrate._room import room


class Table(NamedTuple):
    """Compiled functions with their parameters and the linear forms of their arguments (see Templates)."""

    address: Ints
    p_start: Ints
    p: Floats
    x_start: Ints
    form_start: Ints
    form_index: Ints
    form_coefficient: Floats
    form_constant: Floats


class Structure(NamedTuple):
    """Linear part; ``Kd``, ``Cd``, ``fd`` are the rows of the drivers, ``Ka`` the antisymmetric part of K.

    ``tie`` (n, n), ``alone`` (n,): K q = sum_j K_ij (q_j - tie_ij q_i) + alone_i q_i, see :func:`_ties`.
    """

    M: Floats2
    Minv: Floats2
    K: Floats2
    C: Floats2
    Ku: Floats2
    Cu: Floats2
    f: Floats
    B: Floats2
    Kd: Floats2
    Cd: Floats2
    fd: Floats
    Ka: Floats2
    tie: Floats2
    alone: Floats


class Ports(NamedTuple):
    """Contacts.

    ``var`` (n_c,) numbers those with a varying normal force, -1 for the others; ``acts``: both bodies feel it;
    D = W^T M^-1 W; ``soft`` (1,) relative softening of stuck contacts whose forces would not be determined;
    ``noise`` (n_c,) relative velocities that are nothing beside what the scene's forces bring (set at the start).
    """

    row: Ints
    W: Floats2
    w: Floats
    Wu: Floats2
    D: Floats2
    law: Codes
    mu_s: Floats
    mu_0: Floats
    z_start: Ints
    N: Floats
    Wn: Floats2
    N0: Floats
    var: Ints
    acts: Codes
    soft: Floats
    noise: Floats


class Spread(NamedTuple):
    """Where the local forces of nonlinear elements act."""

    f_start: Ints
    start: Ints
    dof: Ints
    coefficient: Floats


class Packed(NamedTuple):
    """All of a problem."""

    structure: Structure
    ports: Ports
    signals: Table
    laws: Table
    normals: Table
    elements: Table
    spread: Spread
    breakpoints: Floats


def _softness(D: Floats) -> float:
    """Relative softening of stuck contacts: 0, or a trifle where rows of W depend on one another (least-norm force)."""
    if len(D) == 0 or np.linalg.matrix_rank(D, hermitian=True) == len(D):
        return 0.0
    return 1e-7  # squared in two iterations below round-off; shares of a load differ by round-off over it


#: Ratio of frequencies from which on forces of stiff springs are taken from differences of positions.
SPREAD = 3e3


def _ties(K: Floats2, omega: Floats) -> tuple[Floats2, Floats]:
    """Which entries of K (n, n) are springs between two dofs, and what of each row is none; (0, 0) for soft structures.

    The forces of a spring on its two ends are opposite to the last digit only where both come from q_j - q_i; the
    round-off of K q on large positions would push the whole by as much as a soft spring does.
    """
    moving = omega[omega > 0.0]
    # a frequency of 0 is a rigid motion, or one that is lost in round-off beside the largest
    if len(omega) < 2 or (len(moving) == len(omega) and moving.max() < SPREAD * moving.min()):
        return np.zeros((0, 0)), np.zeros(0)
    own = np.diag(K)
    spring = (K < 0.0) & (np.minimum(own[:, None], own[None, :]) >= -K)
    np.fill_diagonal(spring, val=False)
    alone = np.array([math.fsum([own[i], *line[ties]]) for i, (line, ties) in enumerate(zip(K, spring, strict=True))])
    np.fill_diagonal(spring, val=True)
    return spring.astype(float), alone


def _table(templates: Templates) -> Table:
    ints = [templates.address, templates.p_start, templates.x_start, templates.form_start, templates.form_index]
    address, p_start, x_start, form_start, form_index = (np.ascontiguousarray(x, dtype=np.int64) for x in ints)
    floats = [templates.p, templates.form_coefficient, templates.form_constant]
    # one spare entry: kernels take the address of p[p_start], also of an empty block
    p, coefficient, constant = (np.append(np.asarray(x, dtype=float), 0.0) for x in floats)
    return Table(address, p_start, p, x_start, form_start, form_index, coefficient, constant)


def packed_of(problem: Problem) -> Packed:
    """The problem as the kernels take it, made once per problem object."""
    kept = _kept.get(id(problem))
    if kept is None:
        kept = _pack(problem)
        _kept[id(problem)] = kept
        weakref.finalize(problem, _kept.pop, id(problem), None)
    return kept


_kept: dict[int, Packed] = {}


def _pack(problem: Problem) -> Packed:
    n, linear, contacts = problem.n, problem.linear, problem.contacts
    solid = np.ascontiguousarray
    Kx, Cx = np.asarray(linear.Kx, float), np.asarray(linear.Cx, float)
    K = solid(Kx[:n, :n])
    Minv = solid(np.linalg.inv(linear.M)) if n else np.zeros((0, 0))
    structure = Structure(
        solid(linear.M), Minv, K, solid(Cx[:n, :n]), solid(Kx[:n, n:]), solid(Cx[:n, n:]), solid(linear.fx[:n]),
        solid(linear.B), solid(Kx[n:]), solid(Cx[n:]), solid(linear.fx[n:]), solid(0.5 * (K - K.T)),
        *_ties(K, np.asarray(problem.omega, float)),
    )  # fmt: skip
    varies = contacts.normal != NORMAL_CONSTANT
    var = np.where(varies, np.cumsum(varies) - 1, -1).astype(np.int64)
    W = solid(contacts.W)
    ports = Ports(
        solid(contacts.row, np.int64), W, solid(contacts.w), solid(contacts.Wu), solid(W.T @ Minv @ W),
        solid(contacts.law, np.int8), solid(contacts.mu_s), solid(contacts.mu_0), solid(contacts.z_start, np.int64),
        np.where(varies, 0.0, contacts.N), solid(contacts.Wn), solid(contacts.N0), var,
        (contacts.normal == NORMAL_LAW).astype(np.int8), np.array([_softness(W.T @ Minv @ W)]),
        np.zeros(problem.n_c),
    )  # fmt: skip
    spread = Spread(
        problem.elements.f_start, problem.elements.spread_start, problem.elements.spread_dof,
        np.append(problem.elements.spread_coefficient, 0.0),
    )  # fmt: skip
    return room(Packed(
        structure, ports, _table(problem.signals.table), _table(contacts.law_table), _table(contacts.normal_table),
        _table(problem.elements.table), spread, np.sort(np.asarray(problem.signals.breakpoints, float)),
    ))  # fmt: skip
