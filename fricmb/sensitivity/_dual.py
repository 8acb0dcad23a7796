"""Values over time with their slopes: what the chain rule needs, sparse in what a value depends on."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

#: Slopes of a value by column: positions, velocities, law states, parameters, and time last.
Slopes = dict[int, Any]


@dataclass(frozen=True, kw_only=True)
class Dual:
    """A value, a number or (n_t,), and its partial derivatives by column, each a number or (n_t,)."""

    value: Any
    slopes: Slopes = field(default_factory=dict)

    def __mul__(self, factor: Any) -> Dual:
        """Times a factor that depends on nothing."""
        return Dual(value=self.value * factor, slopes={j: s * factor for j, s in self.slopes.items()})

    __rmul__ = __mul__

    def __add__(self, other: Dual) -> Dual:
        return Dual(value=self.value + other.value, slopes=merged((self.slopes, other.slopes)))

    def times(self, other: Dual) -> Dual:
        """The product of two values."""
        return composed(self.value * other.value, ((other.value, self), (self.value, other)))


def merged(parts: Iterable[Slopes]) -> Slopes:
    """Sums of slopes."""
    found: Slopes = {}
    for part in parts:
        for j, slope in part.items():
            found[j] = found[j] + slope if j in found else slope
    return found


def composed(value: Any, partials: Iterable[tuple[Any, Dual]]) -> Dual:
    """A function's value, and its slopes from its partial derivatives with respect to values it is made of."""
    return Dual(value=value, slopes=merged({j: c * s for j, s in dual.slopes.items()} for c, dual in partials))


def summed(parts: Iterable[Dual]) -> Dual:
    """The sum of values."""
    found = Dual(value=0.0)
    for part in parts:
        found = found + part
    return found
