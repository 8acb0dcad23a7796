"""Rate weakening: friction that falls with the inverse of slip speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import check_order


@dataclass(frozen=True, kw_only=True)
class FlashHeating(FrictionLaw):
    """mu(r) = mu_k + (mu_s - mu_k)/(1 + (r/v_w)^exponent)^(1/exponent).

    Contacts that heat up weaken friction as v_w/r beyond the speed v_w; the exponent says how sharp the onset is.

    Parameters
    ----------
    mu_s, mu_k : float
        Coefficients at rest and in fast slip, 0 <= mu_k <= mu_s.
    v_w : float
        Weakening speed, > 0.
    exponent : float
        > 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    J. R. Rice, Heating and weakening of faults during earthquake slip, Journal of Geophysical Research 111 (2006)
    B05311 (the law with a sharp onset); E. M. Dunham et al., Earthquake ruptures with strongly rate-weakening friction
    and off-fault plasticity, part 1, Bulletin of the Seismological Society of America 101 (2011) 2296-2307 (with
    exponent 8).
    """

    positive: ClassVar[tuple[str, ...]] = ("v_w", "exponent")

    mu_s: Any
    mu_k: Any
    v_w: Any
    exponent: Any = 8.0

    def define_coefficient(self, r: Any) -> Any:
        """Falls as v_w/r beyond v_w."""
        fall = (1 + (r / self.v_w) ** self.exponent) ** (-1 / self.exponent)
        return self.mu_k + (self.mu_s - self.mu_k) * fall

    def validate(self) -> None:
        """0 <= mu_k <= mu_s."""
        check_order(self)

    def slip_limit(self, normal_force: float = 1.0) -> float:
        """mu_s: there is no jump at r = 0."""
        return float(self.numeric_slots()["mu_s"])

    @classmethod
    def example(cls) -> Self:
        """A fault, in metres and seconds."""
        return cls(mu_s=0.7, mu_k=0.13, v_w=0.17)
