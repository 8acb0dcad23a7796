"""Contacts of a scene at many times, in numpy: normal force, slip velocity, and what the law makes of them."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb import stated
from fricmb.equations import numbers
from fricmb.field._functions import Given, function
from fricmb.field._motions import Moment, Row
from fricmb.field._parts import Found
from fricmb.integrate.problem import Floats
from fricmb.scene import Contact
from fricmb.values import value_of


class Presses:
    """A contact.

    ``number``: its place among the contacts of the run.
    """

    def __init__(self, contact: Contact, number: int, rows: slice) -> None:
        self.contact, self.number, self.rows = contact, number, rows
        self.directions = [direction.form for direction in contact.directions()]
        self.slides = [Given(slide) for slide in contact.slides()]
        self.kind = contact.normal_kind
        self.given = Given(contact.normal_force) if self.kind != "law" else None
        normal = contact.normal_direction()
        self.approach = None if normal is None else normal.form

    def add(self, moment: Moment, found: Found) -> None:
        """Friction of the run and the normal force."""
        motions = [moment.form(form) for form in self.directions]
        shape = moment.t.shape
        slides = [slide.at(moment) for slide in self.slides]
        g = [np.broadcast_to(rate + s, shape) for (_, rate, _), s in zip(motions, slides, strict=True)]
        rows: list[Row] = [row for _, _, row in motions]
        found.g[self.number], found.rows[self.number] = np.array(g), rows
        for row, F in zip(rows, moment.F[self.rows], strict=True):
            found.push(row, F)
        found.N[self.number] = np.broadcast_to(self._pressed(moment, found), shape)

    def _pressed(self, moment: Moment, found: Found) -> Any:
        if self.given is not None:
            return np.maximum(self.given.at(moment), 0.0)
        law: Any = self.contact.normal_force
        assert self.approach is not None
        e, rate, row = moment.form(self.approach)
        N = np.maximum(function(stated.normal(law))(e, rate, *numbers(law))[0], 0.0)
        found.push(row, N - float(value_of(law.preload)))
        return N


class Rubs:
    """What a contact's law says of velocity, normal force and states."""

    def __init__(self, name: str, law: Any, steady: bool = False) -> None:
        """``steady``: under a normal force that is a number, where losses hold what the centre of the cone brings."""
        self.name, self.law = name, law
        self.numeric = law.numeric().centred
        self.smooth = law.kind == "smooth"
        self.lean = 0.0 if self.smooth else float(law.numeric().lean())
        held = law.numeric().offsets() if steady and law.offsets() else ()
        self.offsets = np.array(held, dtype=float)[:, None] if held else None

    def scale(self, d: int) -> Floats:
        """Friction along the directions relative to the first (d, 1); 1 for an isotropic law."""
        return np.array(self.numeric.axis_scale() or (1.0,) * d, dtype=float)[:, None]

    def force(self, g: Floats, N: Floats, z: Floats) -> Floats:
        """Force (d, n_t) in slip (of a force law: always)."""
        found: Floats = self.numeric.force(g, N, z if self.smooth else None)
        return found

    def rate(self, g: Floats, N: Floats, z: Floats) -> Floats:
        """Rates of the states."""
        found: Floats = self.numeric.rate(g, N, z)
        return found

    def limit(self, N: Floats) -> Floats:
        """Largest force (n_t,) of a sticking contact."""
        path = self.law.static_path
        mu = self.law.break_away() if path is not None else self.numeric.coefficient(np.zeros(N.shape), N)
        found: Floats = np.asarray(mu) * N
        return found

    def held(self, F: Floats, N: Floats) -> Floats:
        """Length (n_t,) of a force that holds, about the centre of the cone at rest; within :meth:`limit` it sticks."""
        return self.size(F + self.lean * self.limit(N)) if self.lean else self.size(F)

    def size(self, F: Floats) -> Floats:
        """Length (n_t,) of a force, over the cone's axes."""
        found: Floats = np.sqrt(((F / self.scale(len(F))) ** 2).sum(axis=0))
        return found
