"""A Problem as nested tuples of contiguous arrays: what kernels take."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.array_cache import cached_by_content
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.room import room
from fricmb.integrate.csr import is_diagonal
from fricmb.integrate.model.damped_normals import damped_normals
from fricmb.integrate.model.structure import Structure, dense_inverse, inverse_mass, pack_structure
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import (
    NORMAL_CONSTANT,
    NORMAL_LAW,
    Codes,
    Contacts,
    Floats,
    Floats2,
    Ints,
    Problem,
    SparseLinear,
    Templates,
)


class Table(Layout):
    """Compiled functions with their parameters and the linear forms of their arguments (see Templates)."""

    address: Ints
    p_start: Ints
    p: Floats
    x_start: Ints
    form_start: Ints
    form_index: Ints
    form_coefficient: Floats
    form_constant: Floats


class Ports(Layout):
    """Contacts.

    ``var`` (n_c,) numbers those with a varying normal force, -1 for the others; ``acts``: both bodies feel it;
    ``damped``: it depends on a rate; D = W^T M^-1 W; ``knot_start``, ``knots``: see ``Contacts``;
    ``soft`` relative softening of stuck contacts whose forces would not be determined.
    """

    row: Ints
    W: Floats2
    w: Floats
    Wu: Floats2
    D: Floats2
    law: Codes
    mu_s: Floats
    mu_0: Floats
    lean: Floats
    knot_start: Ints
    knots: Floats
    z_start: Ints
    N: Floats
    Wn: Floats2
    N0: Floats
    var: Ints
    acts: Codes
    damped: Codes
    soft: float


class Spread(Layout):
    """Where the local forces of nonlinear elements act."""

    f_start: Ints
    start: Ints
    dof: Ints
    coefficient: Floats


class Packed(Layout):
    """All of a problem; ``bends``, ``bend_start``: see ``Bends``."""

    structure: Structure
    ports: Ports
    signals: Table
    laws: Table
    normals: Table
    elements: Table
    spread: Spread
    breakpoints: Floats
    bends: Table
    bend_start: Ints


@cached_by_content
def softening(D: Floats) -> float:
    """Relative softening of stuck contacts: 0, or a trifle where rows of W depend on one another (least-norm force)."""
    if len(D) == 0:
        return 0.0
    sizes = np.abs(np.linalg.eigvalsh(D))
    if sizes.min() > sizes.max() * len(D) * np.finfo(float).eps:
        return 0.0
    return 1e-7  # squared in two iterations below round-off; shares of a load differ by round-off over it


def mobility_at_contacts(problem: Problem) -> Floats:
    """D = W^T M^-1 W (m, m), made once per problem object."""

    def make() -> Floats:
        W = np.ascontiguousarray(problem.contacts.W)
        if isinstance(problem.linear, SparseLinear):
            return np.ascontiguousarray(W.T @ (inverse_mass(problem) @ W))
        return moved_by(np.asarray(problem.linear.M, dtype=float), W)[1]

    return once_per(problem, "mobility at contacts", make)


@cached_by_content
def moved_by(M: Floats, W: Floats) -> tuple[Floats, Floats]:
    """Accelerations (n, m) of the dofs by contact forces, M^-1 W, and those of the contacts (m, m), D = W^T M^-1 W."""
    MW = (1.0 / np.diagonal(M))[:, None] * W if is_diagonal(M) else dense_inverse(M) @ W
    return MW, np.ascontiguousarray(W.T @ MW)


def softness(problem: Problem) -> float:
    """What :class:`Ports` calls ``soft``; known without all that is packed beside it."""

    def find() -> float:
        if problem.m == 1 and np.any(problem.contacts.W):  # one row that moves depends on no other
            return 0.0
        return softening(mobility_at_contacts(problem))

    return once_per(problem, "softness", find)


def table_of(templates: Templates) -> Table:
    """Templates as kernels take them."""
    ints = [templates.address, templates.p_start, templates.x_start, templates.form_start, templates.form_index]
    address, p_start, x_start, form_start, form_index = (np.ascontiguousarray(x, dtype=np.int64) for x in ints)
    floats = [templates.p, templates.form_coefficient, templates.form_constant]
    # one spare entry: kernels take the address of p[p_start], also of an empty block
    p, coefficient, constant = (np.append(np.asarray(x, dtype=float), 0.0) for x in floats)
    return Table(address, p_start, p, x_start, form_start, form_index, coefficient, constant)


def knot_starts(contacts: Contacts) -> Ints:
    """Where the knots of each contact begin (n_c+1,), those of contacts that have none among them."""
    if len(contacts.knot_start):
        return np.ascontiguousarray(contacts.knot_start, np.int64)
    return np.zeros(len(contacts.law) + 1, np.int64)


def leans(contacts: Contacts) -> Floats:
    """How far the centre of each cone is off 0 at rest (n_c,)."""
    if len(contacts.lean):
        return np.ascontiguousarray(contacts.lean)
    return np.zeros(len(contacts.law))


def spread_of(problem: Problem) -> Spread:
    """Where the forces of a problem's elements act; one spare coefficient, as in a table."""
    elements = problem.elements
    return Spread(
        elements.f_start, elements.spread_start, elements.spread_dof, np.append(elements.spread_coefficient, 0.0)
    )


def packed_of(problem: Problem) -> Packed:
    """The problem as the kernels take it, made once per problem object."""
    return once_per(problem, "packed", lambda: _pack(problem))


def _pack(problem: Problem) -> Packed:
    contacts = problem.contacts
    solid = np.ascontiguousarray
    structure = pack_structure(problem)
    varies = contacts.normal != NORMAL_CONSTANT
    var = np.where(varies, np.cumsum(varies) - 1, -1).astype(np.int64)
    W = solid(contacts.W)
    ports = Ports(
        solid(contacts.row, np.int64), W, solid(contacts.w), solid(contacts.Wu),
        mobility_at_contacts(problem),
        solid(contacts.law, np.int8), solid(contacts.mu_s), solid(contacts.mu_0),
        leans(contacts),
        knot_starts(contacts), solid(contacts.knots), solid(contacts.z_start, np.int64),
        np.where(varies, 0.0, contacts.N), solid(contacts.Wn), solid(contacts.N0), var,
        (contacts.normal == NORMAL_LAW).astype(np.int8), damped_normals(problem), softness(problem),
    )  # fmt: skip
    return room(Packed(
        structure, ports, table_of(problem.signals.table), table_of(contacts.law_table),
        table_of(contacts.normal_table), table_of(problem.elements.table), spread_of(problem),
        np.sort(np.asarray(problem.signals.breakpoints, float)), table_of(problem.bends.table),
        np.ascontiguousarray(problem.bends.start, np.int64),
    ))  # fmt: skip
