"""Assembling elements: constant matrices, signals of force, nonlinear remainders, and what each stores."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fricmb.equations import (
    Template,
    bend_expression,
    bend_template,
    element_template,
    force_expression,
    force_terms,
    numbers,
    signal_expression,
)
from fricmb.errors import SceneError
from fricmb.integrate.problem import Elements, Floats, Linear, SparseLinear
from fricmb.scene import (
    Body,
    Element,
    Force,
    MatrixElement,
    ModalBody,
    PointDamper,
    PointSpring,
    RigidBody,
    SpaceBody,
    modal_matrices,
)
from fricmb.system._bends import Bend
from fricmb.system._lined import Entries
from fricmb.system._matrices import DENSE, FEW, dense_of, is_sparse, matrix_of
from fricmb.system._motions import Motions
from fricmb.system._tables import TIME_ARGUMENT, Argument, Row, TableBuilder
from fricmb.values import value_of

Local = Sequence[tuple[int, int, float]]


@dataclass(frozen=True, kw_only=True, slots=True)
class Store:
    """Potential of one element: ``x K x/2 - f x + constant`` on its local rows, and that of its nonlinear remainder.

    ``nonlinear``: index in the table of nonlinear elements, or None.  ``is_load``: what the linear part gives up is
    work from outside, and nothing is stored; ``rubs``: it is lost in the contact of that name.
    """

    name: str
    rows: tuple[Row, ...]
    K: Local
    f: Local
    constant: float = 0.0
    nonlinear: int | None = None
    is_load: bool = False
    rubs: bool = False

    @property
    def is_held(self) -> bool:
        """Whether its linear part stores anything."""
        return not (self.is_load or self.rubs)


@dataclass(frozen=True, kw_only=True)
class Structure:
    """Arrays under construction; places in [dofs, signals].  ``made``: what came of them, by the number of signals.

    ``wide``: entries of matrices over many degrees of freedom, as arrays: the matrix, rows, columns, values.
    """

    motions: Motions
    M: list[tuple[int, int, float]] = field(default_factory=list)
    K: list[tuple[int, int, float]] = field(default_factory=list)
    C: list[tuple[int, int, float]] = field(default_factory=list)
    f: list[tuple[int, float]] = field(default_factory=list)
    B: list[tuple[int, int, float]] = field(default_factory=list)
    stores: list[Store] = field(default_factory=list)
    lined: Entries = field(default_factory=Entries)
    wide: list[tuple[str, Any, Any, Floats]] = field(default_factory=list)
    table: TableBuilder = field(default_factory=TableBuilder)
    spread: list[list[Row]] = field(default_factory=list)
    bends: list[Bend] = field(default_factory=list)
    nonlinear: list[tuple[Element, tuple[Row, ...]]] = field(default_factory=list)
    timed: list[tuple[Template, tuple[float, ...]]] = field(default_factory=list)
    made: dict[int, tuple[Linear, Elements]] = field(default_factory=dict)

    @property
    def n(self) -> int:
        """Number of degrees of freedom."""
        return len(self.motions.dofs)

    def lists(self) -> tuple[list[Any], ...]:
        """See :class:`Growing`."""
        return self.M, self.K, self.C, self.f, self.stores, self.wide

    def marks(self) -> tuple[int, ...]:
        """See :class:`Growing`: signals and nonlinear elements are told by their numbers."""
        return self.motions.signals.asked, len(self.table), len(self.B)

    @property
    def has_plain_masses(self) -> bool:
        """Whether each degree of freedom has a mass > 0 and nothing else: the matrix needs no look."""
        masses = self.M
        if any(target == "M" for target, *_ in self.wide):
            return False
        one_each = len(masses) == len({i for i, _, _ in masses}) == self.n
        return one_each and all(i == j and mass > 0.0 for i, j, mass in masses)

    # -- bodies -------------------------------------------------------------------------------------------------
    def add_body(self, body: Body | ModalBody | RigidBody | SpaceBody) -> None:
        """Masses; of a modal body also modal stiffness and damping."""
        names, index = body.dof_names, self.motions.dofs
        if isinstance(body, RigidBody | SpaceBody):
            masses = body.masses()
            self.M.extend((index[name], index[name], mass) for name, mass in zip(names, masses, strict=True))
            return
        built = [i for i, name in enumerate(names) if name in index]
        places = [index[names[i]] for i in built]
        if isinstance(body, Body):
            mass = float(value_of(body.mass))
            self.M.extend((i, i, mass) for i in places)
            return
        m, stiffness, damping = modal_matrices(body)
        m, stiffness = m[built], stiffness[built]
        if damping.ndim == 2:
            damping = damping[np.ix_(built, built)]
            a, b = np.nonzero(damping)
            self._add_entries("C", np.array(places), a, b, damping[a, b])
            damping = np.zeros(len(built))
        else:
            damping = damping[built]
        self.M.extend((i, i, float(v)) for i, v in zip(places, m, strict=True))
        self.K.extend((i, i, float(v)) for i, v in zip(places, stiffness, strict=True) if v != 0.0)
        self.C.extend((i, i, float(v)) for i, v in zip(places, damping, strict=True) if v != 0.0)
        rows = tuple(Row(((i, 1.0),)) for i in places)
        diagonal = [(i, i, float(v)) for i, v in enumerate(stiffness) if v != 0.0]
        self.stores.append(Store(name=body.name, rows=rows, K=diagonal, f=()))

    def add_matrix(self, part: MatrixElement) -> None:
        """Matrices over named dofs."""
        places = np.array([self.motions.dofs[name] for name in part.dofs])
        for target in ("M", "C", "K"):
            matrix = part.scaled(target)
            if matrix is None:
                continue
            sparse = not isinstance(matrix, np.ndarray)
            coo = matrix.tocoo() if sparse else None
            rows, columns = (coo.row, coo.col) if coo is not None else np.nonzero(matrix)
            entries = coo.data if coo is not None else matrix[rows, columns]
            self._add_entries(target, places, rows, columns, entries)
            if target == "K":
                local = list(zip(rows.tolist(), columns.tolist(), entries.tolist(), strict=True))
                held = tuple(Row(((int(i), 1.0),)) for i in places)
                self.stores.append(Store(name=part.name, rows=held, K=local, f=()))

    def _add_entries(self, target: str, places: Any, rows: Any, columns: Any, values: Floats) -> None:
        """Entries over local rows and columns, which stand at ``places``: one by one, or many as arrays."""
        if values.size > FEW:
            self.wide.append((target, places[rows], places[columns], values))
            return
        held = zip(places[rows].tolist(), places[columns].tolist(), values.tolist(), strict=True)
        getattr(self, target).extend(held)

    # -- elements -----------------------------------------------------------------------------------------------
    def add_element(self, element: Element) -> None:
        """Affine part into the matrices; the rest, if anything is left, as a nonlinear element."""
        if isinstance(element, Force):
            self.add_force(element)
            return
        rows = tuple(self.motions.row(form) for form in element.local_coordinates())
        driven = any(row.u for row in rows)
        template = element_template(element, driven=driven)
        p = numbers(element)
        terms = template.terms(p)
        self._affine(rows, terms.K, terms.f)
        self._damping(rows, terms.C)
        nonlinear = None
        if terms.rest:
            self.nonlinear.append((element, rows))
            nonlinear = len(self.table)
            arguments = [_argument(kind, i, rows) for kind, i in template.facts["arguments"]]
            self.table.add(template.address, p, arguments)
            self.spread.append(list(rows))
            if (bends := bend_template(element)) is not None:
                given = [_argument(kind, i, rows) for kind, i in bends.facts["arguments"]]
                self.bends.append((bends, p, given))
        self.stores.append(
            Store(
                name=element.name,
                rows=rows,
                K=terms.K,
                f=terms.f,
                constant=terms.constant,
                nonlinear=nonlinear,
                is_load=element.is_load,
                rubs=element.rubs,
            )
        )

    def _affine(self, rows: Sequence[Row], K: Local, f: Local) -> None:
        for i, j, k in K:
            for place, a in rows[i].extended(self.n):
                self.K.extend((place, other, k * a * b) for other, b in rows[j].extended(self.n))
                if rows[j].constant != 0.0:
                    self.f.append((place, -k * a * rows[j].constant))
        for i, _, value in f:
            self.f.extend((place, value * a) for place, a in rows[i].extended(self.n))

    def _damping(self, rows: Sequence[Row], C: Local) -> None:
        for i, j, c in C:
            for place, a in rows[i].extended(self.n):
                self.C.extend((place, other, c * a * b) for other, b in rows[j].extended(self.n))

    # -- forces -------------------------------------------------------------------------------------------------
    def add_force(self, force: Force) -> None:
        """A force term by term: constant or linear in coordinates, or of time alone (a signal)."""
        what = f"Force {force.name!r}: value"
        own, *_ = force.local_coordinates()
        row = self.motions.row(own)
        terms = force_terms(force.value, what, self.motions.driven)
        K: list[tuple[int, int, float]] = []
        rows = [row]
        for kind, motion, slope in terms.slopes:
            other = self.motions.named_row(motion)
            if kind == "coordinate":
                K.append((0, len(rows), -slope))
                rows.append(other)
            else:
                self._damping([row, other], [(0, 1, -slope)])
        f = [(0, 0, terms.constant)] if terms.constant != 0.0 else []
        self._affine(rows, K, f)
        nonlinear = None
        if terms.signal is not None:
            signal = terms.signal
            j = self.motions.signals.add(force.signal_name, lambda: signal_expression(signal, "force", 0.0, what))
            self.B.extend((i, j, c) for i, c in row.q)
        if terms.rest is not None:
            nonlinear = self._moving_force(row, terms.rest, what)
        self.stores.append(Store(name=force.name, rows=tuple(rows), K=K, f=f, nonlinear=nonlinear, is_load=True))

    def _moving_force(self, row: Row, value: Any, what: str) -> int:
        expression = force_expression(value, what)
        arguments = [*self.motions.arguments(expression), row.rate()]
        self.timed.append((expression.template, expression.parameters))
        self.table.add(expression.template.address, expression.parameters, arguments)
        self.spread.append([row])
        bends = bend_expression(value, what)
        if bends.template.facts["count"]:
            self.bends.append((bends.template, bends.parameters, self.motions.arguments(bends)))
        return len(self.table) - 1

    # -- arrays -------------------------------------------------------------------------------------------------
    def arrays(self, n_u: int) -> tuple[Linear, Elements]:
        """The constant matrices and the nonlinear elements for so many signals, once."""
        found = self.made.get(n_u)
        if found is None:
            found = self.made[n_u] = self.linear(n_u), self.elements(n_u)
        return found

    def linear(self, n_u: int) -> Linear:
        """The constant matrices."""
        n = self.n
        both = (n + n_u, n + n_u)
        fx = self._constant_force(n + n_u)
        given: Any = {
            "M": (self.M, (n, n), self._many("M")),
            "Kx": (self.K, both, [*self.lined.K, *self._many("K")]),
            "Cx": (self.C, both, [*self.lined.C, *self._many("C")]),
            "B": (self.B, (n, n_u)),
        }  # fmt: skip
        if n > DENSE:
            found = {name: matrix_of(*entries) for name, entries in given.items()}
            if is_sparse(n, sum(len(found[name].value) for name in ("M", "Kx", "Cx"))):
                return SparseLinear(**found, fx=fx)
        return Linear(**{name: dense_of(*entries) for name, entries in given.items()}, fx=fx)

    def triples(self, target: str) -> list[tuple[int, int, float]]:
        """All entries of "M", "K" or "C" one by one."""
        held = [zip(i.tolist(), j.tolist(), values.tolist(), strict=True) for i, j, values in self._many(target)]
        return [*getattr(self, target), *(entry for entries in held for entry in entries)]

    def _many(self, target: str) -> list[tuple[Any, Any, Floats]]:
        return [entries for name, *entries in self.wide if name == target]  # type: ignore[misc]

    def _constant_force(self, length: int) -> Floats:
        if not self.lined.f:
            return dense_of([(i, 0, value) for i, value in self.f], (length, 1)).ravel()
        places = np.concatenate([np.array([i for i, _ in self.f], dtype=np.int64), *(i for i, _ in self.lined.f)])
        forces = np.concatenate([np.array([v for _, v in self.f], dtype=float), *(v for _, v in self.lined.f)])
        return np.bincount(places, forces, length).astype(float)

    def elements(self, n_u: int) -> Elements:
        """The nonlinear elements."""
        if not self.spread:
            return NO_ELEMENTS
        rows = [row for element in self.spread for row in element]
        return Elements(
            table=self.table.build(self.n, n_u),
            f_start=np.cumsum([0, *(len(element) for element in self.spread)], dtype=np.int64),
            spread_start=np.cumsum([0, *(len(row.q) for row in rows)], dtype=np.int64),
            spread_dof=np.array([i for row in rows for i, _ in row.q], dtype=np.int64),
            spread_coefficient=np.array([c for row in rows for _, c in row.q], dtype=float),
        )


#: Of a structure that is linear.
NO_ELEMENTS = Elements()

def _argument(kind: str, i: int, rows: Sequence[Row]) -> Argument:
    if kind == "t":
        return TIME_ARGUMENT
    if kind == "x":
        return rows[i].value()
    return rows[i].rate() if kind == "v" else rows[i].driven_rate()


def check_initial(element: Element, rows: Sequence[Row], q: Floats, u: Floats) -> None:
    """Refuse a point spring or damper whose ends coincide at the start: its direction is not defined there."""
    if not isinstance(element, PointSpring | PointDamper):
        return
    x = [row.constant + sum(c * q[i] for i, c in row.q) + sum(c * u[j] for j, c in row.u) for row in rows]
    if max(abs(value) for value in x) == 0.0:
        raise SceneError(
            f"{element._label()}: its two points coincide at the start, so the line between them has no direction;"
            " give position= or anchor="
        )
