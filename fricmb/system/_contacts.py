"""Assembling contacts: rows of relative velocity, laws, normal forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fricmb.equations import (
    Template,
    bend_expression,
    law_template,
    normal_bend_template,
    normal_template,
    numbers,
    signal_expression,
    value_expression,
)
from fricmb.errors import LawError
from fricmb.integrate.problem import (
    LAW_COEFFICIENT,
    LAW_CONSTANT,
    LAW_SMOOTH,
    NORMAL_CONSTANT,
    NORMAL_EXPRESSION,
    NORMAL_LAW,
    NORMAL_REACTION,
    Contacts,
    Ints,
    SparseContacts,
    Templates,
)
from fricmb.laws import LinearRegularised
from fricmb.scene import Contact, Joint
from fricmb.scene._lines import Rows
from fricmb.system._bends import Bend
from fricmb.system._knots import knots_of
from fricmb.system._lined import built_places, prescribed
from fricmb.system._matrices import DENSE, dense_of, is_sparse, matrix_of
from fricmb.system._motions import Motions
from fricmb.system._tables import NO_TEMPLATE, Row, TableBuilder, starts
from fricmb.system._try_law import try_law
from fricmb.values import is_expression, value_of

#: What stands for a row that is empty, or whose entries are elsewhere.
NO_ROW = Row()
#: Coefficients of friction that are none.
NO_FRICTION = 1e-100
#: Factors of the rows of a contact with an isotropic law, by their number; one object for all.
UNIT = {d: (1.0,) * d for d in range(4)}


@dataclass(kw_only=True)
class ContactArrays:
    """Contacts under construction."""

    motions: Motions
    rows: list[Row] = field(default_factory=list)
    w: list[float] = field(default_factory=list)
    law: list[int] = field(default_factory=list)
    law_table: TableBuilder = field(default_factory=TableBuilder)
    mu_s: list[float] = field(default_factory=list)
    mu_0: list[float] = field(default_factory=list)
    lean: list[float] = field(default_factory=list)
    piecewise: list[bool] = field(default_factory=list)
    knots: list[tuple[float, ...]] = field(default_factory=list)
    normal: list[int] = field(default_factory=list)
    straight: list[bool] = field(default_factory=list)
    N: list[float] = field(default_factory=list)
    normal_table: TableBuilder = field(default_factory=TableBuilder)
    normal_rows: list[Row] = field(default_factory=list)
    N0: list[float] = field(default_factory=list)
    labels: list[tuple[str, ...]] = field(default_factory=list)
    states: list[tuple[str, ...]] = field(default_factory=list)
    scale: list[tuple[float, ...]] = field(default_factory=list)
    timed: list[tuple[Template, tuple[float, ...]]] = field(default_factory=list)
    bends: list[Bend] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    #: Entries of W and Wu of contacts that are put in together.
    lined: list[tuple[Any, Any, Any]] = field(default_factory=list)
    driven: list[tuple[Any, Any, Any]] = field(default_factory=list)

    def lists(self) -> tuple[list[Any], ...]:
        """See :class:`Growing`."""
        return (
            self.rows, self.w, self.law, self.law_table.entries, self.mu_s, self.mu_0, self.lean, self.piecewise,
            self.knots, self.normal, self.straight, self.N, self.normal_table.entries, self.normal_rows, self.N0,
            self.labels, self.states, self.scale, self.names,
        )  # fmt: skip

    def marks(self) -> tuple[int, ...]:
        """See :class:`Growing`: signals are told by their numbers."""
        return self.motions.signals.asked, len(self.timed)

    def add(self, contact: Contact) -> None:
        """Append a contact."""
        self.names.append(contact.name)
        directions = contact.directions()
        scale = contact.law.numeric().axis_scale() or (1.0,) * len(directions)
        for direction, slide, s in zip(directions, contact.slides(), scale, strict=True):
            self._add_row(contact, direction.label, direction.form, slide, s)
        self.scale.append(tuple(float(s) for s in scale))
        self.labels.append(tuple(direction.label for direction in directions))
        self._add_normal(contact)
        self._add_law(contact, contact.law, len(directions), max(self.N[-1], self.N0[-1]))

    def add_lined(self, contacts: Sequence[Contact], rows: Rows, names: Sequence[str], place: Ints) -> None:
        """Append contacts along letters, of constant normal force; ``names``: of the prescribed motions in rows."""
        first, count = len(self.rows), rows.at.size
        w = np.zeros(count)
        for ends, sign in ((rows.a, 1.0), (rows.b, -1.0)):
            at, i = np.flatnonzero(ends >= 0), built_places(ends, place)
            self.lined.append((i[at], first + at, np.full(at.size, sign)))
            for number, which in prescribed(ends):
                motion, here = self.motions.driven[names[number]], np.flatnonzero(which)
                if motion.rate is not None:
                    w[here] -= sign * motion.rate
                    continue
                j = self.motions.signals.add(motion.name, motion.signal)
                self.driven.append((first + here, np.full(here.size, j), np.full(here.size, -sign)))
        self.rows.extend([NO_ROW] * count)
        self.w.extend(w.tolist())
        self.normal_table.skip(len(contacts))
        for contact in contacts:
            labels = contact.labels()
            self.names.append(contact.name)
            self.scale.append(UNIT[len(labels)])
            self.labels.append(labels)
            self.normal.append(NORMAL_CONSTANT)
            self.straight.append(True)
            self._normal(contact.normal_force, NO_ROW, 0.0)
            self._add_law(contact, contact.law, len(labels), contact.normal_force)

    def add_joint(self, joint: Joint) -> None:
        """Append the friction of a joint: the reaction for normal force."""
        labels = joint.labels()
        self.names.append(joint.name)
        self.rows.extend(Row() for _ in labels)
        self.w.extend(0.0 for _ in labels)
        self.scale.append(UNIT[len(labels)])
        self.labels.append(labels)
        self.normal.append(NORMAL_REACTION)
        self.straight.append(False)
        self.normal_table.add(NO_TEMPLATE)
        self._normal(0.0, NO_ROW, 0.0)
        self._add_law(joint, joint.friction, len(labels), 0.0)

    def _add_row(self, contact: Contact, label: str, form: Any, slide: Any, scale: float) -> None:
        """A row of relative velocity; that of a law that is not isotropic in its scaled direction."""
        row, uniform = self.motions.slip_row(form)
        u = row.u
        w = -uniform
        if not is_expression(slide):
            w -= float(value_of(slide))
        else:
            what = f"Contact {contact.name!r}: slide"
            name = f"{contact.name}.slide.{label}"
            j = self.motions.signals.add(name, lambda: signal_expression(slide, "rate", 0.0, what))
            u = (*u, (j, 1.0))
        self.rows.append(Row(tuple((i, scale * c) for i, c in row.q), tuple((j, scale * c) for j, c in u)))
        self.w.append(scale * w)

    def _add_law(self, contact: Contact | Joint, law: Any, d: int, normal: float) -> None:
        template = law_template(law, d)
        compiled = template.function is not None
        p: Sequence[float] = law.parameter_block().tolist() if compiled else numbers(law)
        labels = law.state_labels(self.labels[-1])
        self.piecewise.append(compiled)
        self.states.append(labels)
        self.lean.append(0.0 if compiled or not law.offsets() else float(law.numeric().lean()))
        constant = template.is_constant(p)
        bends = not constant and template.facts["kind"] != "smooth"
        load = normal if self.normal[-1] == NORMAL_CONSTANT else None
        self.knots.append(knots_of(law, template, p, load) if bends else ())
        if not constant:
            try_law(law, f"{type(contact).__name__} {contact.name!r}", template, p, d, len(labels))
        if template.facts["kind"] == "smooth":
            self.law.append(LAW_SMOOTH)
            self.law_table.add(template.address, p)
            self.mu_s.append(0.0)
            self.mu_0.append(0.0)
            return
        N = normal or 1.0
        limit = law.slip_limit(N) if template.at_rest is None else float(template.at_rest((*p, N)))
        path = law.static_path
        mu_s = limit if path is None else law.break_away(N)
        _check_cone(contact, mu_s, limit)
        nothing = LinearRegularised(mu=0.0, v_reg=1.0)
        if constant and max(mu_s, limit) <= NO_FRICTION and d in nothing.dimensions:
            # never sticks, and has no cone whose edge could be found: a law of forces, all of them 0
            self.law.append(LAW_SMOOTH)
            self.law_table.add(law_template(nothing, d).address, numbers(nothing))
            self.mu_s.append(0.0)
            self.mu_0.append(0.0)
            return
        self.law.append(LAW_CONSTANT if constant else LAW_COEFFICIENT)
        self.law_table.add(NO_TEMPLATE if constant else template.address, () if constant else p)
        follows = path is None and template.facts.get("load_dependent", compiled)
        varies = isinstance(contact, Contact) and contact.normal_kind != "constant"
        self.mu_s.append(-max(limit, 1e-290) if follows and varies else max(mu_s, limit))
        self.mu_0.append(limit)

    def _add_normal(self, contact: Contact) -> None:
        kind = contact.normal_kind
        direction = contact.normal_direction()
        if kind == "law" and direction is not None:
            law = contact.normal_force
            template = normal_template(law)
            row = self.motions.row(direction.form)
            self.normal.append(NORMAL_LAW)
            self.straight.append(bool(template.facts.get("linear", False)))
            self.normal_table.add(template.address, numbers(law), [row.value(), row.rate()])
            self._normal(0.0, row, float(value_of(law.preload)))
            bent = normal_bend_template(law)
            if bent is not None:
                given = (row.value(), row.rate())
                self.bends.append((bent, numbers(law), [given[i] for i in bent.facts["arguments"]]))
        elif kind == "constant":
            self.normal.append(NORMAL_CONSTANT)
            self.straight.append(True)
            self.normal_table.add(NO_TEMPLATE)
            self._normal(max(0.0, float(value_of(contact.normal_force))), NO_ROW, 0.0)
        else:
            expression = value_expression(contact.normal_force, f"Contact {contact.name!r}: normal_force")
            self.normal.append(NORMAL_EXPRESSION)
            self.straight.append(False)
            arguments = self.motions.arguments(expression)
            self.timed.append((expression.template, expression.parameters))
            bends = bend_expression(contact.normal_force, f"Contact {contact.name!r}: normal_force")
            if bends.template.facts["count"]:
                self.bends.append((bends.template, bends.parameters, self.motions.arguments(bends)))
            self.normal_table.add(expression.template.address, expression.parameters, arguments)
            self._normal(0.0, NO_ROW, 0.0)

    def _normal(self, N: float, row: Row, preload: float) -> None:
        self.N.append(N)
        self.normal_rows.append(row)
        self.N0.append(preload)

    def slip_table(self, n: int, n_u: int) -> Templates:
        """Of every contact (of joints nothing) slip coordinate and slip velocity in each direction as linear forms."""
        table, start = TableBuilder(), starts(self.labels)
        for k, kind in enumerate(self.normal):
            rows = () if kind == NORMAL_REACTION else self.rows[start[k] : start[k + 1]]
            table.add(NO_TEMPLATE, (), tuple(form for row in rows for form in (row.value(), row.rate())))
        return table.build(n, n_u)

    def build(self, n: int, n_u: int, *, dense: bool = True) -> Contacts:
        """The arrays; not ``dense``: without the matrices, which a mechanism holds as forms."""
        m, n_c = len(self.rows), len(self.law)
        rows, normal_rows = (self.rows, self.normal_rows) if dense else ([], [])
        size = n if dense else 0
        given: Any = {
            "W": ([(i, a, c) for a, row in enumerate(rows) for i, c in row.q], (size, m), self.lined),
            "Wu": ([(a, j, -c) for a, row in enumerate(rows) for j, c in row.u], (m, n_u), self.driven),
            "Wn": ([(i, k, c) for k, row in enumerate(normal_rows) for i, c in row.q], (size, n_c)),
        }
        others: dict[str, Any] = {
            "row": starts(self.labels),
            "w": np.array(self.w, dtype=float) + 0.0,
            "law": np.array(self.law, dtype=np.int8),
            "law_table": self.law_table.build(n, n_u),
            "mu_s": np.array(self.mu_s, dtype=float),
            "piecewise": np.array(self.piecewise, dtype=bool),
            "mu_0": np.array(self.mu_0, dtype=float),
            "lean": np.array(self.lean, dtype=float),
            "knot_start": starts(self.knots),
            "knots": np.array([r for own in self.knots for r in own], dtype=float),
            "z_start": starts(self.states),
            "normal": np.array(self.normal, dtype=np.int8),
            "straight": np.array(self.straight, dtype=bool),
            "N": np.array(self.N, dtype=float),
            "normal_table": self.normal_table.build(n, n_u),
            "N0": np.array(self.N0, dtype=float),
        }
        if n > DENSE:
            found = {name: matrix_of(*entries) for name, entries in given.items()}
            if is_sparse(n, len(found["W"].value) + len(found["Wn"].value)):
                return SparseContacts(**found, **others)
        others |= {name: dense_of(*entries) for name, entries in given.items()}
        return Contacts(**others)


def _check_cone(contact: Contact | Joint, mu_s: float, limit: float) -> None:
    if not (np.isfinite(limit) and limit >= 0.0 and mu_s >= limit * (1.0 - 1e-12)):
        raise LawError(
            f"{type(contact).__name__} {contact.name!r}: the break-away coefficient of its law ({mu_s:g}) must be at"
            f" least its coefficient of slip for r -> 0 ({limit:g}), and both >= 0"
        )
