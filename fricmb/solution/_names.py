"""Names of what a solution holds, and where it is found in the arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fricmb.errors import unknown_name
from fricmb.integrate.problem import Floats, Ints


@dataclass(frozen=True, kw_only=True)
class Motion:
    """A motion that is a function of the degrees of freedom: a point of a modal or of a rigid body, a joint's angle.

    ``x = sum(coefficient * q[index]) + offset``, and for a point fixed in a body that turns by q[angle] also
    ``+ arm[0] cos(q[angle]) + arm[1] sin(q[angle])``; ``angle`` -1: none.
    """

    index: Ints
    coefficient: Floats
    offset: float = 0.0
    angle: int = -1
    arm: tuple[float, float] = (0.0, 0.0)

    def position(self, q: Floats) -> Floats:
        """Value for q (n, n_t); shape (n_t,)."""
        value: Floats = self.coefficient @ q[self.index] + self.offset
        if self.angle >= 0:
            value = value + self.arm[0] * np.cos(q[self.angle]) + self.arm[1] * np.sin(q[self.angle])
        return value

    def velocity(self, q: Floats, v: Floats) -> Floats:
        """Rate for q and v (n, n_t); shape (n_t,)."""
        value: Floats = self.coefficient @ v[self.index]
        if self.angle >= 0:
            turn = self.arm[1] * np.cos(q[self.angle]) - self.arm[0] * np.sin(q[self.angle])
            value = value + v[self.angle] * turn
        return value


    def acceleration(self, q: Floats, v: Floats, a: Floats) -> Floats:
        """Second derivative for q, v and accelerations a (n, n_t); shape (n_t,)."""
        value: Floats = self.coefficient @ a[self.index]
        if self.angle >= 0:
            sin, cos = np.sin(q[self.angle]), np.cos(q[self.angle])
            turn, bend = self.arm[1] * cos - self.arm[0] * sin, self.arm[0] * cos + self.arm[1] * sin
            value = value + a[self.angle] * turn - v[self.angle] ** 2 * bend
        return value


@dataclass(frozen=True, kw_only=True)
class Vector:
    """What several coordinates of a body in space say together; ``index`` (k,) of those that turn.

    ``kind``: "rotation", the matrix whose columns are the body's axes; "axis", that of a rotor; "directors", "rotor"
    and "ball", the angular velocity along the axes of space.
    """

    kind: str
    index: Ints

    def value(self, q: Floats, v: Floats) -> Floats:
        """(3, n_t), of a rotation (3, 3, n_t), for q and v (n, n_t)."""
        x, rate = q[self.index], v[self.index]
        found: Floats
        if self.kind == "rotation":
            found = x.reshape(3, 3, -1).transpose(1, 0, 2)
        elif self.kind == "axis":
            found = x[:3]
        elif self.kind == "ball":
            found = rate
        elif self.kind == "rotor":
            found = np.cross(x[:3], rate[:3], axis=0) + rate[3] * x[:3]
        else:
            turns = (np.cross(x[i : i + 3], rate[i : i + 3], axis=0) for i in (0, 3, 6))
            found = 0.5 * np.sum(list(turns), axis=0)
        return found


#: Number of coordinates behind each kind of vector.
VECTORS = {"rotation": 9, "axis": 4, "ball": 3, "rotor": 4, "directors": 9}


@dataclass(frozen=True, kw_only=True)
class Names:
    """Names of degrees of freedom, contacts, directions and law states of a run.

    Attributes
    ----------
    dofs, contacts : tuple of str
        In the order of the arrays.
    directions : tuple of tuple of str
        By contact: labels of its tangential directions ("x", "y"; "1", "2" for slanted ones).
    states : tuple of tuple of str
        By contact: labels of the internal states of its law.
    motions : mapping of str to Motion
        Further motions: points of modal and rigid bodies, relative motions of joints.
    vectors : mapping of str to Vector
        Orientation and angular velocity of bodies in space.
    signals : mapping of str to int
        Motions of driven bodies by the index of their signal.
    scale : tuple of tuple of float
        By contact: factor s of every row; a run holds s v and F/s.  Empty: all 1.
    offset : tuple of tuple of float
        By contact: centre of the cone along every row, over the normal force; a run holds the force about it.  Empty:
        all 0.
    """

    dofs: tuple[str, ...]
    contacts: tuple[str, ...] = ()
    directions: tuple[tuple[str, ...], ...] = ()
    states: tuple[tuple[str, ...], ...] = ()
    motions: Mapping[str, Motion] = field(default_factory=dict)
    vectors: Mapping[str, Vector] = field(default_factory=dict)
    signals: Mapping[str, int] = field(default_factory=dict)
    scale: tuple[tuple[float, ...], ...] = ()
    offset: tuple[tuple[float, ...], ...] = ()

    @cached_property
    def dof_index(self) -> dict[str, int]:
        """Row of q and v by name."""
        return {name: i for i, name in enumerate(self.dofs)}

    @cached_property
    def contact_index(self) -> dict[str, int]:
        """Number of a contact by name."""
        return {name: i for i, name in enumerate(self.contacts)}

    @cached_property
    def row(self) -> Ints:
        """Contact k owns the rows ``row[k]:row[k+1]`` of forces and relative velocities."""
        return _starts(self.directions)

    @cached_property
    def row_scale(self) -> Floats:
        """Factor of every row of forces and relative velocities (m, 1)."""
        held = [s for scale in self.scale for s in scale] or [1.0] * int(self.row[-1])
        return np.array(held, dtype=float)[:, None]

    @cached_property
    def row_offset(self) -> Floats | None:
        """Centre of the cone in every row (m, 1), over the normal force; None: all 0."""
        held = np.array([c for offset in self.offset for c in offset], dtype=float)
        return held[:, None] if held.any() else None

    def centres(self, N: Floats) -> Floats | float:
        """What a run leaves out of the friction in every row (m, n_t) under the normal forces N (n_c, n_t)."""
        if self.row_offset is None:
            return 0.0
        found: Floats = self.row_offset * np.repeat(N, np.diff(self.row), axis=0)
        return found

    @cached_property
    def z_start(self) -> Ints:
        """Contact k owns the law states ``z_start[k]:z_start[k+1]``."""
        return _starts(self.states)

    def contact(self, name: str) -> int:
        """Number of the contact ``name``; UnknownNameError lists those near."""
        try:
            return self.contact_index[name]
        except (KeyError, TypeError):
            raise unknown_name("contact", name, self.contacts) from None

    def axes(self, contact: str) -> tuple[str, ...]:
        """Labels of a contact's tangential directions."""
        return self.directions[self.contact(contact)]

    def known_motions(self) -> list[str]:
        """All names of motions: degrees of freedom, points, vectors of bodies in space, driven bodies."""
        return [*self.dofs, *self.motions, *self.vectors, *self.signals]


def _starts(groups: tuple[tuple[str, ...], ...]) -> Ints:
    return np.concatenate(([0], np.cumsum([len(group) for group in groups], dtype=np.int64))).astype(np.int64)
