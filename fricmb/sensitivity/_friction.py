"""Friction laws at many times with their slopes: forces in slip, limits in stick, rates of states."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fricmb import stated
from fricmb.integrate.problem import SLIP, Codes, Floats
from fricmb.sensitivity._dual import Dual, composed
from fricmb.sensitivity._found import Found, masked
from fricmb.sensitivity._functions import Function
from fricmb.sensitivity._motions import Moment
from fricmb.sensitivity._parts import refuse
from fricmb.sensitivity._seeds import Seeds

#: Slip speed that stands for rest, where a formula is singular there.
_REST = 1e-100


class Friction:
    """The law of a contact or joint.

    Parameters
    ----------
    part : Contact or Joint
    number : int
        Its place among the contacts of the run.
    states : int
        First row of its law's states.
    prefix : str
        Of the names of the law's numbers.
    """

    #: Whether its normal force is like a root where it sets in and ends.
    branches = False

    def __init__(self, part: Any, law: Any, number: int, d: int, states: int, prefix: str, seeds: Seeds) -> None:
        self.part, self.number, self.states, self.name, self.d = part, number, states, part.name, d
        self.law = law
        self.smooth = law.kind == "smooth"
        if not self.smooth and law.lean():
            refuse(part, "friction whose break-away exceeds slip by another amount forward than back")
        self.numbers = seeds.numbers(law, prefix)
        own = law.compiled_force(self.d) if self.smooth else law.compiled_coefficient()
        self.compiled = own is not None
        if self.compiled and self.smooth:
            refuse(part, f"the law {type(law).__name__}, which brings compiled code")
        self.scales = Function(stated.scale(law))(self.numbers) if not self.smooth and law.axis_scale() else []
        if self.smooth:
            self.function = Function(stated.smooth(law, self.d))
            return
        if not self.compiled:
            self.function = Function(stated.coefficient(law))
        self.others = self._others(part, law, seeds) if self.compiled else {}
        path = law.static_path
        self.mu_s = None if path is None else seeds.dual(law.slots()[path], f"{prefix}{path}")

    def _others(self, part: Any, law: Any, seeds: Seeds) -> dict[int, list[tuple[float, Any]]]:
        """By column of a number of a compiled law: laws with other numbers, whose weighted sums are its slope."""
        own = {j for number in self.numbers for j in number.slopes}
        if not own:
            return {}
        field = "law" if part.slots().keys() & {f"law.{path}" for path in law.slots()} else "friction"
        varied = seeds.varied(part).items()
        return {j: [(w, getattr(one, field).numeric()) for w, one in ones] for j, ones in varied if j in own}

    def rub(self, moment: Moment, found: Found, N: Dual, mode: Codes, sign: Floats) -> None:
        """Forces of slip and rates of states, g and rows being found; ``mode``, ``sign`` (d, n_t): of the phases."""
        k, g = self.number, found.g[self.number]
        if self.smooth:
            self._smooth(moment, found, g, N)
            return
        found.limit[k] = self._limit(N)
        for row, F in zip(found.rows[k], self._slipping(g, N, sign), strict=True):
            found.push(row, masked(F, mode == SLIP))

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
        """Friction in slip: against the sign that a phase has in one direction, against its direction in two.

        ``sign`` in two directions is nan, but at times at which this contact's slip begins or ends: its direction then.
        """
        if self.d == 1:
            (sign,) = sign
            r = Dual(value=np.maximum(sign * g[0].value, _REST), slopes={j: sign * s for j, s in g[0].slopes.items()})
            return [self._coefficient(r, N).times(N) * -sign]
        rests = ~np.isnan(sign).any(axis=0)
        if not rests.any():
            return self._turning(g, N)
        begins, slides = self.beginning(N, np.where(rests, sign, 0.0)), self._turning(g, N)
        return [masked(one, rests) + masked(other, ~rests) for one, other in zip(begins, slides, strict=True)]

    def _turning(self, g: list[Dual], N: Dual) -> list[Dual]:
        """Friction against the direction of slip g."""
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

    def depends_on_speed(self) -> bool:
        """Whether friction in slip depends on its speed."""
        if self.smooth:
            return False
        return 0 in self._coefficient(Dual(value=np.ones(1), slopes={0: 1.0}), Dual(value=1.0)).slopes

    def coefficient_slope(self, r: Floats, N: Dual) -> Any:
        """Slope of the coefficient by the slip speed."""
        return self._coefficient(Dual(value=np.maximum(r, _REST), slopes={0: 1.0}), N).slopes[0]

    def size_at_rest(self, N: Dual, i: int) -> float:
        """Friction at r = 0 in slip, by size, at time number i of a normal force."""
        value = float(N.value) if np.ndim(N.value) == 0 else float(N.value[i])
        return -float(np.ravel(self.beginning(Dual(value=value), np.ones((1, 1)))[0].value)[0])

    def _coefficient(self, r: Dual, N: Dual) -> Dual:
        if self.compiled:
            load = np.broadcast_to(N.value, np.shape(r.value))
            found = composed(self.law.coefficient(r.value, load), [(self.law.derivative(r.value, load), r)])
            for j, ones in self.others.items():
                own = sum(weight * law.coefficient(r.value, load) for weight, law in ones)
                found.slopes[j] = found.slopes.get(j, 0.0) + own
            return found
        return self.function([r, N, *self.numbers])[0]

    def _limit(self, N: Dual) -> Dual:
        mu = self.mu_s
        if mu is None and self.compiled:
            slopes = {
                j: sum(weight * law.slip_limit() for weight, law in ones) for j, ones in self.others.items()
            }  # fmt: skip
            mu = Dual(value=self.law.slip_limit(), slopes=slopes)
        if mu is None:
            at_rest = self.function([Dual(value=_REST), N, *self.numbers])[0]
            mu = replace(at_rest, value=np.where(np.isfinite(at_rest.value), at_rest.value, self.law.slip_limit()))
        return mu.times(N)
