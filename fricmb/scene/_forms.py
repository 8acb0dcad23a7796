"""Linear forms in named motions: how ends, elongations and slip are written before there are arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LinearForm:
    """``constant + sum(coefficient * motion)``.

    Attributes
    ----------
    terms : tuple of (str, float)
        Named motions (dofs "pad.x", points "plate.tip.x", driven bodies "belt.x") and their coefficients, none 0.
    constant : float
    """

    terms: tuple[tuple[str, float], ...] = ()
    constant: float = 0.0

    @classmethod
    def of(cls, terms: Mapping[str, float], constant: float = 0.0) -> LinearForm:
        """From a mapping; coefficients of 0 are left out."""
        return cls(tuple([(name, float(c)) for name, c in terms.items() if c != 0.0]), float(constant))

    def __add__(self, other: LinearForm) -> LinearForm:
        merged = dict(self.terms)
        for name, coefficient in other.terms:
            merged[name] = merged.get(name, 0.0) + coefficient
        return LinearForm.of(merged, self.constant + other.constant)

    def __sub__(self, other: LinearForm) -> LinearForm:
        return self + other * -1.0

    def __mul__(self, factor: float) -> LinearForm:
        return LinearForm.of({name: factor * c for name, c in self.terms}, factor * self.constant)

    __rmul__ = __mul__

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of the motions."""
        return tuple(name for name, _ in self.terms)
