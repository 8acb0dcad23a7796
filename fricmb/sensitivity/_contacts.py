"""Contacts of a scene at many times with their slopes: slip, normal force, friction in slip, limit in stick."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fricmb import stated
from fricmb.integrate.problem import OPEN, SLIP, Codes, Floats
from fricmb.scene import Contact
from fricmb.sensitivity._dual import Dual, composed
from fricmb.sensitivity._found import Found, masked
from fricmb.sensitivity._functions import Function
from fricmb.sensitivity._motions import Given, Moment
from fricmb.sensitivity._parts import refuse
from fricmb.sensitivity._seeds import Seeds

#: Slip speed that stands for rest, where a formula is singular there.
_REST = 1e-100


class Rubs:
    """A contact; ``number``: its place among those of the run; ``states``: first row of its law's states."""

    def __init__(self, contact: Contact, number: int, states: int, seeds: Seeds) -> None:
        self.contact, self.number, self.states, self.name = contact, number, states, contact.name
        self.directions = [direction.form for direction in contact.directions()]
        names = [f"{contact.name}.slide.{i}" for i in range(len(self.directions))]
        slides = contact.slides()
        self.slides = [Given(s, name, seeds) for s, name in zip(slides, names, strict=True)]
        self.slide_rates = [Given(s, name, seeds, order=1) for s, name in zip(slides, names, strict=True)]
        self.d = len(self.directions)
        self._normal(contact, seeds)
        self._law(contact.law, seeds)

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
        prefix = f"{contact.name}.normal_force."
        self.press_numbers = seeds.numbers(given, prefix)
        self.preload = seeds.dual(given.preload, f"{prefix}preload")

    def _law(self, law: Any, seeds: Seeds) -> None:
        self.law = law
        self.smooth = law.kind == "smooth"
        self.numbers = seeds.numbers(law, f"{self.name}.law.")
        own = law.compiled_force(self.d) if self.smooth else law.compiled_coefficient()
        self.compiled = own is not None
        if self.compiled and (self.smooth or (any(x.slopes for x in self.numbers) and law.static_path is None)):
            refuse(self.contact, f"the law {type(law).__name__}, which brings compiled code")
        if not self.smooth and law.axis_scale():
            refuse(self.contact, f"the anisotropic law {type(law).__name__}")
        if self.smooth:
            self.function = Function(stated.smooth(law, self.d))
            return
        if not self.compiled:
            self.function = Function(stated.coefficient(law))
        path = law.static_path
        self.mu_s = None if path is None else seeds.dual(law.slots()[path], f"{self.name}.law.{path}")

    def add(self, moment: Moment, found: Found, mode: Codes, sign: Floats) -> None:
        """Slip, normal force and friction; ``mode``, ``sign`` (d, n_t): of the phases."""
        motions = [moment.form(form) for form in self.directions]
        k = self.number
        g = [m.rate + slide.over(moment.time) for m, slide in zip(motions, self.slides, strict=True)]
        found.g[k], found.rows[k] = g, [m.row for m in motions]
        drifts = zip(motions, self.slide_rates, strict=True)
        found.drift[k] = [m.drift + rate.over(moment.time) for m, rate in drifts]
        N = found.N[k] = self._pressed(moment, found, mode)
        N = masked(N, (mode != OPEN) & (np.asarray(N.value) > 0.0)) if self.varies else N
        if self.smooth:
            self._smooth(moment, found, g, N)
            return
        found.limit[k] = self._limit(N)
        for row, F in zip(found.rows[k], self._slipping(g, N, sign), strict=True):
            found.push(row, masked(F, mode == SLIP))

    def _pressed(self, moment: Moment, found: Found, mode: Codes) -> Dual:
        if self.approach is None:
            return self.given.at(moment)
        motion = moment.form(self.approach)
        N = self.press([motion.position, motion.rate, *self.press_numbers])[0]
        found.push(motion.row, masked(N, mode != OPEN) + self.preload * -1.0)
        return N

    def _smooth(self, moment: Moment, found: Found, g: list[Dual], N: Dual) -> None:
        first = 2 * moment.frame.n + self.states
        count = self.law.n_states(self.d)
        z = [Dual(value=moment.z[self.states + i], slopes={first + i: 1.0}) for i in range(count)]
        values = self.function([*g, N, *z, *self.numbers])
        for row, F in zip(found.rows[self.number], values[: self.d], strict=True):
            found.push(row, F)
        for i, rate in enumerate(values[self.d :]):
            found.put_rate(self.states + i, rate)

    def _slipping(self, g: list[Dual], N: Dual, sign: Floats) -> list[Dual]:
        """Friction in slip: against the sign that a phase has in one direction, against its direction in two."""
        if self.d == 1:
            (sign,) = sign
            r = Dual(value=np.maximum(sign * g[0].value, _REST), slopes={j: sign * s for j, s in g[0].slopes.items()})
            return [self._coefficient(r, N).times(N) * -sign]
        if not np.isnan(sign).any():
            return self.beginning(N, sign)
        length = np.maximum(np.sqrt(sum(np.square(x.value) for x in g)), _REST)
        n = [x.value / length for x in g]
        r = composed(length, zip(n, g, strict=True))
        size = self._coefficient(r, N).times(N)
        found = []
        for i, x in enumerate(g):
            turned = composed(n[i], [(1.0 / length, x), (-n[i] / length, r)])
            found.append(size.times(turned) * -1.0)
        return found

    def beginning(self, N: Dual, direction: Floats) -> list[Dual]:
        """Friction at r = 0 in slip along a given direction (d, n_t)."""
        size = self._coefficient(Dual(value=np.full(direction.shape[1:], _REST)), N).times(N)
        return [size * -n for n in direction]

    def size_at_rest(self, N: Dual, i: int) -> float:
        """Friction at r = 0 in slip, by size, at time number i of a normal force."""
        value = float(N.value) if np.ndim(N.value) == 0 else float(N.value[i])
        return -float(np.ravel(self.beginning(Dual(value=value), np.ones((1, 1)))[0].value)[0])

    def _coefficient(self, r: Dual, N: Dual) -> Dual:
        if self.compiled:
            load = np.broadcast_to(N.value, np.shape(r.value))
            return composed(self.law.coefficient(r.value, load), [(self.law.derivative(r.value, load), r)])
        return self.function([r, N, *self.numbers])[0]

    def _limit(self, N: Dual) -> Dual:
        mu = self.mu_s
        if mu is None and self.compiled:
            mu = Dual(value=self.law.slip_limit())
        if mu is None:
            at_rest = self.function([Dual(value=_REST), N, *self.numbers])[0]
            mu = replace(at_rest, value=np.where(np.isfinite(at_rest.value), at_rest.value, self.law.slip_limit()))
        return mu.times(N)
