"""Bounds of the Taylor coefficients of a function of time on intervals, by interval arithmetic.

A function is a *tape*: a list of operations, each a name and its arguments, which are numbers of earlier entries.  Its
coefficients f^(k)/k!, k = 0 ... n, are found by the recurrences of automatic differentiation (A. Griewank, A. Walther,
*Evaluating Derivatives*, 2008, chapter 13) with intervals for numbers, for many intervals of time at once.  Round-off
is not enclosed: it is far below what the bounds are used for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.problem import Floats
from fricmb.integrate.signals.pieces import Table, table_at

#: An entry of a tape: the name of an operation and its arguments.
Entry = Sequence[Any]
#: Whether a condition holds on intervals, and whether it fails: both False where it does both.
Known = tuple[NDArray[np.bool_], NDArray[np.bool_]]


class Jet:
    """Bounds ``low``, ``high`` (n + 1, k) of Taylor coefficients on k intervals."""

    def __init__(self, low: Floats, high: Floats) -> None:
        self.low, self.high = low, high

    def size(self, order: int) -> Floats:
        """Bound of |coefficient| of that order (k,)."""
        found: Floats = np.maximum(np.abs(self.low[order]), np.abs(self.high[order]))
        return np.where(np.isnan(found), np.inf, found)

    def at(self, i: int) -> tuple[Floats, Floats]:
        """Bounds of coefficient i."""
        return self.low[i], self.high[i]

    @classmethod
    def filled(cls, parts: Sequence[tuple[Floats, Floats]]) -> Jet:
        """From bounds of each coefficient."""
        return cls(np.array([low for low, _ in parts]), np.array([high for _, high in parts]))

    @classmethod
    def constant(cls, value: float, shape: tuple[int, int]) -> Jet:
        """A number."""
        low = np.zeros(shape)
        low[0] = value
        return cls(low, low.copy())

    def __add__(self, other: Jet) -> Jet:
        return Jet(self.low + other.low, self.high + other.high)

    def __neg__(self) -> Jet:
        return Jet(-self.high, -self.low)

    def __mul__(self, other: Jet) -> Jet:
        low, high = np.zeros_like(self.low), np.zeros_like(self.low)
        for k in range(len(low)):
            for j in range(k + 1):
                below, above = _times(self.at(j), other.at(k - j))
                low[k] += below
                high[k] += above
        return Jet(low, high)

    def hull(self, other: Jet) -> Jet:
        """What encloses both."""
        return Jet(np.minimum(self.low, other.low), np.maximum(self.high, other.high))

    def where(self, chosen: NDArray[np.bool_], other: Jet) -> Jet:
        """One on chosen intervals, the other elsewhere."""
        return Jet(np.where(chosen, self.low, other.low), np.where(chosen, self.high, other.high))


def _times(a: tuple[Floats, Floats], b: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    with np.errstate(invalid="ignore", over="ignore"):
        ends = np.array([x * y for x in a for y in b])
    ends = np.where(np.isnan(ends), 0.0, ends)  # 0 times infinity: the other ends tell
    return ends.min(axis=0), ends.max(axis=0)


def _scaled(a: tuple[Floats, Floats], by: float) -> tuple[Floats, Floats]:
    return (a[0] * by, a[1] * by) if by >= 0.0 else (a[1] * by, a[0] * by)


def _plus(a: tuple[Floats, Floats], b: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    return a[0] + b[0], a[1] + b[1]


def _over(a: tuple[Floats, Floats], b: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    """Quotient; everything where the divisor may be 0."""
    with np.errstate(divide="ignore"):
        through = _times(a, (1.0 / b[1], 1.0 / b[0]))
    pole = (b[0] <= 0.0) & (b[1] >= 0.0)
    return np.where(pole, -np.inf, through[0]), np.where(pole, np.inf, through[1])


def _weighted(u: Jet, w: list[tuple[Floats, Floats]], k: int) -> tuple[Floats, Floats]:
    """The sum of j u_j w_(k-j) over k, j = 1 ... k: coefficient k of the integral of w u'."""
    total = _scaled(_times(u.at(1), w[k - 1]), 1.0 / k)
    for j in range(2, k + 1):
        total = _plus(total, _scaled(_times(u.at(j), w[k - j]), j / k))
    return total


def _rising(function: Callable[[Floats], Floats], a: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    with np.errstate(all="ignore"):
        return function(a[0]), function(a[1])


def _wave(a: tuple[Floats, Floats], shift: float) -> tuple[Floats, Floats]:
    """Range of cos(x - shift) on intervals."""
    low, high = a[0] - shift, a[1] - shift
    with np.errstate(invalid="ignore"):
        ends = np.cos(low), np.cos(high)
        top = np.floor(high / (2.0 * math.pi)) >= np.ceil(low / (2.0 * math.pi))
        bottom = np.floor((high - math.pi) / (2.0 * math.pi)) >= np.ceil((low - math.pi) / (2.0 * math.pi))
    most, least = np.maximum(*ends), np.minimum(*ends)
    return np.where(bottom | np.isnan(least), -1.0, least), np.where(top | np.isnan(most), 1.0, most)


def _exp(u: Jet) -> Jet:
    out = [_rising(np.exp, u.at(0))]
    for k in range(1, len(u.low)):
        out.append(_weighted(u, out, k))
    return Jet.filled(out)


def _sin_cos(u: Jet) -> tuple[Jet, Jet]:
    s, c = [_wave(u.at(0), 0.5 * math.pi)], [_wave(u.at(0), 0.0)]
    for k in range(1, len(u.low)):
        rise, fall = _weighted(u, c, k), _weighted(u, s, k)
        s.append(rise)
        c.append(_scaled(fall, -1.0))
    return Jet.filled(s), Jet.filled(c)


def _tanh(u: Jet) -> Jet:
    """From y' = (1 - y^2) u'."""
    out = [_rising(np.tanh, u.at(0))]
    slope: list[tuple[Floats, Floats]] = []
    for k in range(1, len(u.low)):
        rest = _scaled(_square(out), -1.0)
        slope.append(_plus(rest, (np.ones_like(rest[0]), np.ones_like(rest[0]))) if k == 1 else rest)
        out.append(_weighted(u, slope, k))
    return Jet.filled(out)


def _square(y: list[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    """The last coefficient of y^2 that the coefficients so far give."""
    k = len(y) - 1
    total = _times(y[0], y[k])
    for j in range(1, k + 1):
        total = _plus(total, _times(y[j], y[k - j]))
    if k == 0:
        return np.maximum(total[0], 0.0), total[1]
    return total


def _quotient(a: Jet, b: Jet) -> Jet:
    """A / b, coefficient by coefficient."""
    out: list[tuple[Floats, Floats]] = []
    for k in range(len(a.low)):
        rest = a.at(k)
        for j in range(1, k + 1):
            rest = _plus(rest, _scaled(_times(b.at(j), out[k - j]), -1.0))
        out.append(_over(rest, b.at(0)))
    return Jet.filled(out)


def _integral_of(slope: Jet, u: Jet, value: tuple[Floats, Floats]) -> Jet:
    """f(u) from f'(u) and the value."""
    rates = [slope.at(i) for i in range(len(u.low))]
    return Jet.filled([value, *(_weighted(u, rates, k) for k in range(1, len(u.low)))])


def _log(u: Jet) -> Jet:
    return _integral_of(_quotient(Jet.constant(1.0, u.low.shape), u), u, _rising(np.log, u.at(0)))


def _atan(u: Jet) -> Jet:
    one = Jet.constant(1.0, u.low.shape)
    return _integral_of(_quotient(one, one + u * u), u, _rising(np.arctan, u.at(0)))


def _erf(u: Jet) -> Jet:
    from scipy.special import erf

    bell = Jet.constant(2.0 / math.sqrt(math.pi), u.low.shape) * _exp(-_power(u, 2.0))
    return _integral_of(bell, u, _rising(erf, u.at(0)))


def _series(u: Jet, table: Table, order: int) -> Jet:
    """Pieces of polynomials of u, which is linear in time: between kinks, to which steps go."""
    parts, factor = [], (np.ones_like(u.low[0]), np.ones_like(u.low[0]))
    for k in range(len(u.low)):
        found = table.ranges(u.low[0], u.high[0], order + k)
        parts.append(_scaled(_times(found, factor), 1.0 / math.factorial(k)))
        factor = _times(factor, u.at(1))
    return Jet.filled(parts)


def _power(u: Jet, a: float) -> Jet:
    if a == int(a) and 0 <= a <= 16:
        found = Jet.constant(1.0, u.low.shape)
        for _ in range(int(a)):
            found = found * u
        if int(a) % 2 == 0 and a > 0:
            found.low[0] = np.maximum(found.low[0], 0.0)
        return found
    if a == int(a) and a < 0:
        return _quotient(Jet.constant(1.0, u.low.shape), _power(u, -a))
    # u y' = a u' y
    with np.errstate(all="ignore"):
        ends = np.power(u.low[0], a), np.power(u.high[0], a)
    out = [(np.fmin(*ends), np.fmax(*ends))]
    for k in range(1, len(u.low)):
        total = (np.zeros_like(u.low[0]), np.zeros_like(u.low[0]))
        for j in range(1, k + 1):
            total = _plus(total, _scaled(_times(u.at(j), out[k - j]), (a * j - (k - j)) / k))
        out.append(_over(total, u.at(0)))
    return Jet.filled(out)


def _absolute(u: Jet) -> Jet:
    found = u.where(u.low[0] >= 0.0, (-u).where(u.high[0] <= 0.0, u.hull(-u)))
    found.low[0] = np.maximum(found.low[0], 0.0)
    return found


def _step(u: Jet, below: float, above: float) -> Jet:
    """One number where u < 0, another where u > 0."""
    shape = u.low.shape
    a, b = Jet.constant(below, shape), Jet.constant(above, shape)
    return b.where(u.low[0] > 0.0, a.where(u.high[0] < 0.0, a.hull(b)))


def _stairs(function: Callable[[Floats], Floats], u: Jet) -> Jet:
    """Rounding: constant between its jumps."""
    low, high = np.zeros_like(u.low), np.zeros_like(u.low)
    low[0], high[0] = function(u.low[0]), function(u.high[0])
    return Jet(low, high)


def _asin(u: Jet) -> Jet:
    slope = _power(Jet.constant(1.0, u.low.shape) + -_power(u, 2.0), -0.5)
    return _integral_of(slope, u, _rising(np.arcsin, u.at(0)))


def _larger(parts: Sequence[Jet]) -> Jet:
    found = parts[0]
    for other in parts[1:]:
        both = found.hull(other)
        both.low[0] = np.maximum(found.low[0], other.low[0])
        found = found.where(found.low[0] >= other.high[0], other.where(other.low[0] >= found.high[0], both))
    return found


def _smaller(parts: Sequence[Jet]) -> Jet:
    return -_larger([-part for part in parts])


def _pieces(arguments: Sequence[Any]) -> Jet:
    """Conditions and values in turn: the first whose condition holds; what may be is enclosed."""
    found: Jet | None = None
    for known, value in reversed(list(zip(arguments[::2], arguments[1::2], strict=True))):
        holds, fails = known
        found = value if found is None else value.where(holds, found.where(fails, value.hull(found)))
    assert found is not None
    return found


def _less(a: Jet, b: Jet) -> Known:
    return a.high[0] < b.low[0], a.low[0] > b.high[0]


def _all(parts: Sequence[Known]) -> Known:
    return np.logical_and.reduce([p[0] for p in parts]), np.logical_or.reduce([p[1] for p in parts])


def _any(parts: Sequence[Known]) -> Known:
    return np.logical_or.reduce([p[0] for p in parts]), np.logical_and.reduce([p[1] for p in parts])


_PLAIN: dict[str, Callable[[Jet], Jet]] = {
    "exp": _exp, "log": _log, "atan": _atan, "erf": _erf, "tanh": _tanh, "abs": _absolute,
    "sin": lambda u: _sin_cos(u)[0], "cos": lambda u: _sin_cos(u)[1],
    "floor": lambda u: _stairs(np.floor, u), "ceiling": lambda u: _stairs(np.ceil, u), "asin": _asin,
    "acos": lambda u: Jet.constant(0.5 * math.pi, u.low.shape) + -_asin(u),
    "erfc": lambda u: Jet.constant(1.0, u.low.shape) + -_erf(u),
    "sign": lambda u: _step(u, -1.0, 1.0), "heaviside": lambda u: _step(u, 0.0, 1.0),
}  # fmt: skip
#: Operations on any number of jets or conditions.
_MANY: dict[str, Callable[[Sequence[Any]], Any]] = {
    "max": _larger, "min": _smaller, "pieces": _pieces, "and": _all, "or": _any,
    "less": lambda parts: _less(*parts), "not": lambda parts: (parts[0][1], parts[0][0]),
}  # fmt: skip
#: Operations of tapes.
OPERATIONS = frozenset({*_PLAIN, *_MANY, "t", "p", "c", "add", "mul", "div", "pow", "series", "true"})


def bounds(tape: Sequence[Entry], p: Sequence[float], low: Floats, high: Floats, order: int) -> Jet:
    """Bounds of the Taylor coefficients up to ``order`` of a tape with parameters p on intervals (k,)."""
    shape = (order + 1, low.size)
    found: list[Any] = []
    with np.errstate(all="ignore"):
        for name, *given in tape:
            if name == "t":
                time = Jet(np.zeros(shape), np.zeros(shape))
                time.low[0], time.high[0] = low, high
                time.low[1] = time.high[1] = 1.0
                found.append(time)
            elif name in ("p", "c"):
                found.append(Jet.constant(float(p[given[0]] if name == "p" else given[0]), shape))
            elif name == "true":
                found.append((np.ones(low.size, dtype=bool), np.zeros(low.size, dtype=bool)))
            elif name == "series":
                found.append(_series(found[given[0]], table_at(p[given[1]]), int(given[2])))
            elif name == "pow":
                found.append(_power(found[given[0]], float(given[1])))
            else:
                parts = [found[i] for i in given]
                found.append(_combined(name, parts))
    last: Jet = found[-1]
    return last


def _combined(name: str, parts: list[Any]) -> Any:
    if name == "div":
        return _quotient(*parts)
    if name in _PLAIN:
        return _PLAIN[name](parts[0])
    if name in _MANY:
        return _MANY[name](parts)
    total = parts[0]
    for part in parts[1:]:
        total = total + part if name == "add" else total * part
    return total
