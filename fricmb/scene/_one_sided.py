"""Joints that hold from both sides, or push only; and what happens where contact is lost."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from math import nan
from typing import Any, ClassVar

from fricmb.laws import Coulomb
from fricmb.scene._joint import Joint
from fricmb.scene._restitution import check_restitution
from fricmb.scene._space_body import SpaceBody
from fricmb.values import is_one_of, value_of


@dataclass(frozen=True, eq=False)
class OneSided(Joint):
    """A surface that something stays on: its single multiplier is the force of the surface."""

    takes_friction: ClassVar[bool] = True
    _: KW_ONLY
    push_only: bool = False
    when_lost: str = "end"
    restitution: Any = None
    tangential_restitution: Any = None
    mu_impact: Any = None

    _beside: ClassVar[frozenset[str]] = frozenset(
        ("friction", "restitution", "tangential_restitution", "mu_impact")
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.push_only, bool):
            self._refuse("push_only", self.push_only, "True or False")
        if not is_one_of(self.when_lost, "end", "open"):
            self._refuse("when_lost", self.when_lost, "'end' or 'open'")
        if self.when_lost == "open" and not self.push_only:
            self._refuse("when_lost", self.when_lost, "left out: without push_only contact is never lost")
        self._check_impacts()

    def _check_impacts(self) -> None:
        """Refuse what impacts cannot be computed with; what bounces lets go."""
        if self.restitution is None:
            for argument in ("tangential_restitution", "mu_impact"):
                if getattr(self, argument) is not None:
                    self._refuse(argument, getattr(self, argument), "left out without restitution")
            return
        check_restitution(self, "restitution", self.restitution)
        if not self.push_only:
            self._refuse("restitution", self.restitution, "left out without push_only=True: nothing is ever met")
        if any(isinstance(end.owner, SpaceBody) for end in (self.a, self.b)):
            self._refuse("restitution", self.restitution, "left out in space: impacts are computed in the plane alone")
        self._set("when_lost", "open")
        for argument in ("tangential_restitution", "mu_impact"):
            if getattr(self, argument) is not None and self.friction is None:
                self._refuse(argument, getattr(self, argument), "left out without friction")
        if self.tangential_restitution is not None:
            check_restitution(self, "tangential_restitution", self.tangential_restitution, least=-1.0)
        if self.mu_impact is not None:
            self._set("mu_impact", self._number("mu_impact", self.mu_impact, minimum=0.0))
        elif self.friction is not None and not isinstance(self.friction, Coulomb):
            accepted = "given: this friction law has no single coefficient, and knows no slip speed within an impact"
            self._refuse("mu_impact", None, accepted)
        if self.friction is not None and self.slip_rows > 1:
            self._refuse("restitution", self.restitution, "left out where slip has two directions")

    @property
    def impact(self) -> tuple[float, float, float] | None:
        """Coefficients of restitution along the normal and slip, and of friction in impacts (nan: that of slip)."""
        if self.restitution is None:
            return None
        along = 0.0 if self.tangential_restitution is None else float(value_of(self.tangential_restitution))
        mu = nan if self.mu_impact is None else float(value_of(self.mu_impact))
        return float(value_of(self.restitution)), along, mu

    @property
    def one_sided(self) -> bool:
        """As ``push_only``."""
        return self.push_only

    @property
    def hands_over(self) -> bool:
        """As ``when_lost``."""
        return self.when_lost == "open"

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Magnitude of the reaction."""
        import sympy

        return lam[0] if self.push_only else sympy.Abs(lam[0])
