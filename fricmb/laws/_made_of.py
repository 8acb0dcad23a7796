"""Laws made of a set-valued one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fricmb.errors import LawError
from fricmb.laws._base import FrictionLaw


@dataclass(frozen=True, kw_only=True)
class MadeOf(FrictionLaw):
    """A law in another regime than ``law``, a set-valued one."""

    law: Any

    def inner(self, r: Any, N: Any) -> Any:
        """The coefficient of the law inside."""
        law = self.law
        return law.define_coefficient(r, N) if law.load_dependent else law.define_coefficient(r)

    def jump(self, N: Any) -> Any:
        """Break-away less slip limit, in symbols on a stand-in; 0 where there is no jump."""
        law = self.law
        if law.static_path is None:
            return 0
        static = law
        for name in law.static_path.split("."):
            static = getattr(static, name)
        import sympy

        r = sympy.Symbol("r_0", nonnegative=True)
        return sympy.simplify(static - self.inner(r, N).subs(r, 0))

    @property
    def load_dependent(self) -> bool:
        """As the law inside."""
        return bool(self.law.load_dependent)

    @property
    def isotropic(self) -> bool:  # type: ignore[override]
        """As the law inside."""
        return bool(self.law.isotropic)

    @property
    def dimensions(self) -> tuple[int, ...]:  # type: ignore[override]
        """As the law inside."""
        return tuple(self.law.dimensions)

    def compiled_force(self, d: int) -> Callable[..., None] | None:
        """None: derived."""
        return None

    def check(self) -> None:
        """The law inside is set-valued, and SymPy can state it."""
        law = self.law
        if not isinstance(law, FrictionLaw) or law.kind == "smooth" or law.offsets():
            self._refuse("law", law, "a set-valued law without an offset, such as fm.laws.Coulomb(mu_s=0.5)")
        if law.compiled_coefficient() is not None:
            raise LawError(
                f"{self._label()}: law must be stated in SymPy; {type(law).__name__} brings a compiled coefficient"
            )
        super().check()
