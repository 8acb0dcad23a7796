"""A Problem as nested tuples of contiguous arrays: what kernels take."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.array_cache import cached_by_content
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.csr import is_diagonal
from fricmb.integrate.model.structure import dense_inverse, inverse_mass
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import (
    Contacts,
    Floats,
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


class Spread(Layout):
    """Where the local forces of nonlinear elements act."""

    f_start: Ints
    start: Ints
    dof: Ints
    coefficient: Floats


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
