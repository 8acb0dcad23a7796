"""Hertz's contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fricmb.normal._base import NormalLaw


@dataclass(frozen=True, kw_only=True)
class Hertz(NormalLaw):
    """N = max(0, stiffness delta^(3/2) (1 - damping e')) with the approach delta = delta_0 - e, N = preload at e = 0.

    No force where the bodies are apart (delta < 0), however fast they part.

    Parameters
    ----------
    axis : str or tuple of float
        Letter or direction, pointing from the contact's b to its a.
    stiffness : float
        Force per length^(3/2), > 0; for a sphere of radius R on a plane (4/3) E* sqrt(R).
    damping : float
        Of Hunt and Crossley, 1/speed, >= 0: it grows with the approach, so that N does not jump when contact is made.
    preload : float
        Force at e = 0, >= 0; both bodies feel N - preload.

    References
    ----------
    K. L. Johnson, Contact Mechanics (Cambridge 1985), equation 4.23; K. H. Hunt, F. R. E. Crossley, Coefficient of
    restitution interpreted as damping in vibroimpact, Journal of Applied Mechanics 42 (1975) 440-445.
    """

    positive: ClassVar[tuple[str, ...]] = ("stiffness",)

    stiffness: Any
    damping: Any = 0.0
    preload: Any = 0.0

    def __post_init__(self) -> None:
        self._set("stiffness", self._number("stiffness", self.stiffness, above=0.0))
        self._set("damping", self._number("damping", self.damping, minimum=0.0))
        super().__post_init__()

    def _approach(self, e: Any) -> tuple[Any, Any]:
        """Approach and its magnitude; real also for SymPy, and with derivatives that are finite at 0."""
        import sympy

        from fricmb.values._symbols import norm

        delta = sympy.cbrt(self.preload / self.stiffness) ** 2 - e
        return delta, norm((delta,))

    def define_normal(self, e: Any, e_dot: Any) -> Any:
        """Normal force; negative beyond the opening, so that the contact opens where it changes sign.

        Damping acts only while the contact is pressed.
        With ``1 - damping e'`` on both sides, bodies apart that part faster than 1/damping would push each other away.
        """
        import sympy

        delta, size = self._approach(e)
        pressed = (delta + size) / 2
        return self.stiffness * sympy.sqrt(size) * (delta - self.damping * e_dot * pressed)

    def define_stored(self, e: Any) -> Any:
        """Antiderivative of N(e, 0) up to the opening."""
        import sympy

        _, size = self._approach(e)
        return -2 * self.stiffness * size**2 * sympy.sqrt(size) / 5
