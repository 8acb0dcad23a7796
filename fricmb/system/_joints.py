"""Assembling joints: constraints, and their friction among the contacts."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import accumulate
from math import nan
from typing import Any, NamedTuple

import numpy as np

from fricmb.equations import joint_template, numbers, signal_expression, uniform_signal
from fricmb.integrate.mechanism import APART, RIGID, Joints
from fricmb.scene import Joint, Part
from fricmb.system._contacts import ContactArrays
from fricmb.system._motions import Motions
from fricmb.system._shares import Shares, add_share
from fricmb.system._tables import Row, TableBuilder
from fricmb.values import is_expression, value_of


def _hold_alike(one: Part, other: Part) -> bool:
    """Whether two joints are the same but for the numbers of their friction, which is among the contacts."""
    if not isinstance(one, Joint) or not isinstance(other, Joint) or type(one.friction) is not type(other.friction):
        return False
    differs = one.differs_in(other)
    return differs is not None and differs <= {"friction"}


class Kept(NamedTuple):
    """What single parts add to each kind of arrays."""

    structure: Shares | None
    contacts: Shares | None
    joints: Shares | None


@dataclass(kw_only=True)
class JointArrays:
    """Joints under construction."""

    motions: Motions
    contacts: ContactArrays
    table: TableBuilder = field(default_factory=TableBuilder)
    rows: list[int] = field(default_factory=list)
    port: list[int] = field(default_factory=list)
    one_sided: list[int] = field(default_factory=list)
    hands_over: list[int] = field(default_factory=list)
    inner: list[int] = field(default_factory=list)
    impact: list[tuple[float, float, float]] = field(default_factory=list)
    side: list[int] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    loaded_by: list[str] = field(default_factory=list)

    def lists(self) -> tuple[list[Any], ...]:
        """See :class:`Growing`."""
        return (
            self.table.entries, self.rows, self.one_sided, self.hands_over, self.inner, self.impact,
            self.side, self.names, self.loaded_by,
        )  # fmt: skip

    def marks(self) -> tuple[int, ...]:
        """See :class:`Growing`: signals are told by their numbers."""
        return (self.motions.signals.asked,)

    def add(self, joint: Joint, kept: Kept, *, inner: bool = False) -> None:
        """Append a joint, and its friction to the contacts; ``inner``: of one body alone."""
        for side in joint.sides():
            self._add(side, kept, inner)

    def _add(self, joint: Joint, kept: Kept, inner: bool) -> None:
        add_share(kept.joints, joint, self, lambda joint: self._append(joint, inner), _hold_alike)
        self.port.append(-1)
        if joint.friction is not None:
            self.port[-1] = len(self.contacts.law)
            add_share(kept.contacts, joint, self.contacts, self.contacts.add_joint)

    def _append(self, joint: Joint, inner: bool) -> None:
        template = joint_template(joint)
        rows = [self.motions.row(form) for form in joint.local_coordinates()]
        rows += [self._drive(joint, i, drive) for i, drive in enumerate(joint.drives())]
        self.table.add(template.address, numbers(joint.bare()), [*(r.value() for r in rows), *(r.rate() for r in rows)])
        self.rows.append(int(template.facts["rows"]))
        self.one_sided.append(int(joint.one_sided))
        self.hands_over.append(int(joint.hands_over) if joint.impact is None else RIGID)
        self.impact.append(joint.impact or (nan, nan, nan))
        self.side.append(joint.side)
        self.inner.append(int(inner))
        self.names.append(joint.name)
        self.loaded_by.append(joint.loaded_by or joint.name)

    def _drive(self, joint: Joint, i: int, drive: tuple[str, Any, float]) -> Row:
        given, value, start = drive
        name = joint.name if i == 0 else f"{joint.name}.{i}"
        if is_expression(value) and not _is_number(value):
            what = f"{type(joint).__name__} {joint.name!r}"
            j = self.motions.signals.add(name, lambda: signal_expression(value, given, start, what))
        else:
            number = float(value_of(value))
            rate, offset = (0.0, number + start) if given == "value" else (number, start)
            j = self.motions.signals.add(name, lambda: uniform_signal(rate, offset))
        return Row((), ((j, 1.0),))

    def build(self, n_y: int, n_u: int) -> Joints:
        """The arrays; what is rigid is open until a run finds it held."""
        impact = np.array(self.impact, dtype=float).reshape(-1, 3)
        hands_over = np.array(self.hands_over, dtype=np.int8)
        apart = np.where(hands_over == RIGID, APART, 0).astype(np.int8)
        return Joints(
            table=self.table.build(n_y, n_u),
            row=np.array([0, *accumulate(self.rows)], dtype=np.int64),
            load_of=np.array([self.names.index(name) for name in self.loaded_by], dtype=np.int64),
            port=np.array(self.port, dtype=np.int64),
            one_sided=np.array(self.one_sided, dtype=np.int8),
            hands_over=hands_over,
            inner=np.array(self.inner, dtype=np.int8),
            restitution=impact[:, 0].copy(),
            tangential=impact[:, 1].copy(),
            mu_impact=impact[:, 2].copy(),
            side=np.array(self.side, dtype=np.int8),
            names=tuple(self.names),
            dropped=np.repeat(apart, np.array(self.rows, dtype=np.int64)),
        )


def _is_number(value: Any) -> bool:
    try:
        value_of(value)
    except TypeError:
        return False
    return True
