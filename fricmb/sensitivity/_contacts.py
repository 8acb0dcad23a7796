"""Contacts of a scene at many times with their slopes: slip, normal force, friction."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb import stated
from fricmb.integrate.problem import OPEN, Codes, Floats
from fricmb.scene import Contact
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._found import Found, masked
from fricmb.sensitivity._friction import Friction
from fricmb.sensitivity._functions import Function
from fricmb.sensitivity._motions import Given, Moment, Row
from fricmb.sensitivity._seeds import Seeds


class Rubs(Friction):
    """A contact; ``number``: its place among those of the run; ``states``: first row of its law's states."""

    def __init__(self, contact: Contact, number: int, states: int, seeds: Seeds) -> None:
        self.directions = [direction.form for direction in contact.directions()]
        names = [f"{contact.name}.slide.{i}" for i in range(len(self.directions))]
        slides = contact.slides()
        self.slides = [Given(s, name, seeds) for s, name in zip(slides, names, strict=True)]
        self.slide_rates = [Given(s, name, seeds, order=1) for s, name in zip(slides, names, strict=True)]
        self._normal(contact, seeds)
        super().__init__(contact, contact.law, number, len(self.directions), states, f"{contact.name}.law.", seeds)

    def _normal(self, contact: Contact, seeds: Seeds) -> None:
        given: Any = contact.normal_force
        normal = contact.normal_direction()
        self.approach = None if normal is None else normal.form
        if normal is None:
            self.given = Given(given, f"{contact.name}.normal_force", seeds)
            self.varies = contact.normal_kind != "constant"
            return
        self.varies = True
        self.press = Function(stated.normal(given))
        self.branches = self.press.roots()
        prefix = f"{contact.name}.normal_force."
        self.press_numbers = seeds.numbers(given, prefix)
        self.preload = seeds.dual(given.preload, f"{prefix}preload")

    def add(self, moment: Moment, found: Found, mode: Codes, sign: Floats) -> None:
        """Slip, normal force and friction; ``mode``, ``sign`` (d, n_t): of the phases."""
        motions = [moment.form(form) for form in self.directions]
        k = self.number
        g = [m.rate + slide.over(moment.time) for m, slide in zip(motions, self.slides, strict=True)]
        drift = [m.drift + rate.over(moment.time) for m, rate in zip(motions, self.slide_rates, strict=True)]
        rows: list[Row] = [m.row for m in motions]
        if self.scales:  # in scaled velocities and forces the law is isotropic, the power the same
            g, drift = ([x.times(s) for x, s in zip(own, self.scales, strict=True)] for own in (g, drift))
            rows = [[(i, _product(s, c)) for i, c in row] for row, s in zip(rows, self.scales, strict=True)]
        found.g[k], found.drift[k], found.rows[k] = moment.slipping(k, g), drift, rows
        N = found.N[k] = self._pressed(moment, found, mode)
        if self.varies:
            # not where it is positive: at the very end of a contact it is 0 but for round-off, and its slopes count
            N = masked(N, mode != OPEN)
        self.rub(moment, found, N, mode, sign)

    def _pressed(self, moment: Moment, found: Found, mode: Codes) -> Dual:
        if self.approach is None:
            return self.given.at(moment)
        motion = moment.form(self.approach)
        N = self.press([motion.position, motion.rate, *self.press_numbers])[0]
        found.push(motion.row, masked(N, mode != OPEN) + self.preload * -1.0)
        return N


def _product(scale: Dual, c: Any) -> Any:
    """Of a scale and a coefficient; a number where neither has slopes."""
    found = scale.times(c) if isinstance(c, Dual) else scale * c
    return found if found.slopes or np.ndim(found.value) else float(found.value)
