"""Friction that falls to a least value and rises again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import fricmb as fm


@dataclass(frozen=True, kw_only=True)
class Valley(fm.FrictionLaw):
    """mu(r) = mu_s - (mu_s - mu_min) x exp(1 - x), x = r/v_min.

    Parameters
    ----------
    mu_s : float
        Coefficient at rest, and again at high speed, >= mu_min.
    mu_min : float
        Least coefficient, >= 0.
    v_min : float
        Slip speed at which it is reached, > 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    Notes
    -----
    Write here where the law comes from: authors, title, journal, number of the equation.
    """

    # checked to be > 0; the symbol that stands for it is positive, too
    positive = ("v_min",)

    mu_s: Any
    mu_min: Any
    v_min: Any

    def define_coefficient(self, r: Any) -> Any:
        """In SymPy: the fields are symbols here, as r is."""
        import sympy

        x = r / self.v_min
        return self.mu_s - (self.mu_s - self.mu_min) * x * sympy.exp(1 - x)

    def validate(self) -> None:
        """In numbers: what no symbol can check."""
        if not 0.0 <= self.mu_min <= self.mu_s:
            raise fm.LawError(f"Valley: mu_min must be from 0 to mu_s = {self.mu_s:g}; got {self.mu_min:g}")

    @classmethod
    def example(cls) -> Self:
        """Values that ``fricmb list laws`` and ``fricmb law Valley`` show."""
        return cls(mu_s=0.6, mu_min=0.4, v_min=0.1)
