"""Joints that hold from both sides, or push only; and what happens where contact is lost."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.scene._joint import Joint
from fricmb.values import is_one_of


@dataclass(frozen=True, eq=False)
class OneSided(Joint):
    """A surface that something stays on: its single multiplier is the force of the surface."""

    takes_friction: ClassVar[bool] = True
    _: KW_ONLY
    push_only: bool = False
    when_lost: str = "end"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.push_only, bool):
            self._refuse("push_only", self.push_only, "True or False")
        if not is_one_of(self.when_lost, "end", "open"):
            self._refuse("when_lost", self.when_lost, "'end' or 'open'")
        if self.when_lost == "open" and not self.push_only:
            self._refuse("when_lost", self.when_lost, "left out: without push_only contact is never lost")

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
