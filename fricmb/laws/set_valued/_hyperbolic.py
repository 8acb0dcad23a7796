"""Friction that falls hyperbolically with slip speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

from fricmb.laws._base import FrictionLaw


@dataclass(frozen=True, kw_only=True)
class HyperbolicStribeck(FrictionLaw):
    """mu(r) = mu_k + (mu_s - mu_k)/(1 + delta r).

    Parameters
    ----------
    mu_s : float
        Coefficient at rest, >= mu_k.
    mu_k : float
        Limit in fast slip, >= 0.
    delta : float
        Per speed, >= 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    R. I. Leine, D. H. van Campen, A. de Kraker, L. van den Steen, Stick-slip vibrations induced by alternate friction
    models, Nonlinear Dynamics 16 (1998) 41-54.
    """

    mu_s: Any
    mu_k: Any = 0.0
    delta: Any

    def define_coefficient(self, r: Any) -> Any:
        """Hyperbola in the slip speed."""
        return self.mu_k + (self.mu_s - self.mu_k) / (1 + self.delta * r)

    def validate(self) -> None:
        """Ranges of all fields."""
        self._number("mu_s", self.mu_s, minimum=0.0)
        self._number("mu_k", self.mu_k, minimum=0.0)
        self._number("delta", self.delta, minimum=0.0)
        if self.mu_k > self.mu_s:
            self._refuse("mu_k", self.mu_k, f"<= mu_s = {self.mu_s:g}")

    def slip_limit(self, normal_force: float = 1.0) -> float:
        """mu_s: there is no jump at r = 0."""
        return float(self.numeric_slots()["mu_s"])

    @classmethod
    def example(cls) -> Self:
        """A belt, dimensionless."""
        return cls(mu_s=1.0, mu_k=0.2, delta=3.0)
