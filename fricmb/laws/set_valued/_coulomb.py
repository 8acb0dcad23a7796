"""Coulomb's law with a break-away coefficient."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

from fricmb.laws._base import FrictionLaw, LawKind
from fricmb.values import value_of


@dataclass(frozen=True, kw_only=True)
class Coulomb(FrictionLaw):
    """|F| <= mu_s N while sticking, |F| = mu_k N while slipping.

    Parameters
    ----------
    mu_s : float
        Coefficient of static friction, >= 0.
    mu_k : float, optional
        Coefficient of kinetic friction, 0 <= mu_k <= mu_s; None: follows ``mu_s``.
    insist : bool
        Accept ``mu_k > mu_s``.  A force between the two allows neither rest nor slip; the run then follows the limit of
        ever faster changes between them, a contact that holds up to ``mu_k``, as for ``mu_s = mu_k``.

    Raises
    ------
    LawError
        If a coefficient is negative or not finite, or mu_k > mu_s.

    References
    ----------
    C. A. Coulomb, Theorie des machines simples, Memoires de mathematique et de physique presentes a l'Academie des
    Sciences 10 (1785) 161-331.
    """

    mu_s: Any
    mu_k: Any = None
    insist: bool = False

    def define_coefficient(self, r: Any) -> Any:
        """Constant in slip."""
        return self.mu_s if self.mu_k is None else self.mu_k

    def validate(self) -> None:
        """0 <= mu_k <= mu_s."""
        self._number("mu_s", self.mu_s, minimum=0.0)
        if self.mu_k is not None:
            self._number("mu_k", self.mu_k, minimum=0.0)
            if self.mu_k > self.mu_s and not self.insist:
                self._refuse("mu_k", self.mu_k, f"<= mu_s = {self.mu_s:g} (insist=True takes more, and holds up to it)")
        if self.insist and (self.mu_k is None or self.mu_k <= self.mu_s):
            self._refuse("insist", self.insist, "left out where mu_k is not above mu_s")

    @property
    def kind(self) -> LawKind:
        """Constant coefficients."""
        return "constant"

    def slip_limit(self, normal_force: float = 1.0) -> float:
        """mu_k."""
        return float(value_of(self.mu_s if self.mu_k is None else self.mu_k))

    def break_away(self, normal_force: float = 1.0) -> float:
        """mu_s; where slip is insisted to need more, that."""
        return self.slip_limit() if self.insist else float(value_of(self.mu_s))

    @property
    def static_path(self) -> str | None:
        """None where break-away is that of slip."""
        return None if self.insist else super().static_path

    def remark(self) -> str:
        """What is solved in place of a break-away below slip."""
        if not self.insist:
            return ""
        return (
            f"mu_k = {self.slip_limit():g} is above mu_s = {float(value_of(self.mu_s)):g}: the contact sticks up to"
            " mu_k, the limit of ever faster changes between stick and slip"
        )

    def coefficient(self, r: Any, normal_force: Any = 1.0) -> Any:
        """mu_k at every slip speed."""
        from fricmb.laws._without_sympy import constant

        return constant(self, r, self.slip_limit())

    def derivative(self, r: Any, normal_force: Any = 1.0) -> Any:
        """0 at every slip speed."""
        from fricmb.laws._without_sympy import constant

        return constant(self, r, 0.0)

    @classmethod
    def example(cls) -> Self:
        """Steel on steel, dry."""
        return cls(mu_s=0.6, mu_k=0.4)
