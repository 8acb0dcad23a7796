"""Laws that give the cone of another one a shape: the curve over the slip speed is that of the law inside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.laws._base import FrictionLaw, LawKind


@dataclass(frozen=True, kw_only=True)
class Shaped(FrictionLaw):
    """Base of laws that reshape the cone of ``law``, which is set-valued."""

    law: Any

    def define_coefficient(self, r: Any) -> Any:
        """That of the law inside."""
        return self.law.define_coefficient(r)

    @property
    def kind(self) -> LawKind:
        """As the law inside."""
        kind: LawKind = self.law.kind
        return kind

    @property
    def has_coefficient(self) -> bool:
        """As the law inside."""
        return bool(self.law.has_coefficient)

    @property
    def static_path(self) -> str | None:
        """That of the law inside."""
        path = self.law.static_path
        return None if path is None else f"law.{path}"

    def remark(self) -> str:
        """That of the law inside."""
        return str(self.law.remark())

    def slip_limit(self, normal_force: float = 1.0) -> float:
        """That of the law inside."""
        return float(self.law.slip_limit(normal_force))

    def knots(self) -> tuple[float, ...]:
        """Those of the law inside."""
        return tuple(self.law.knots())

    def compiled_coefficient(self) -> Callable[..., None] | None:
        """That of the law inside."""
        function: Callable[..., None] | None = self.law.compiled_coefficient()
        return function

    def parameter_block(self) -> NDArray[np.float64]:
        """That of the law inside: the shape is in the rows of the contact."""
        return np.asarray(self.law.parameter_block(), dtype=float)

    def coefficient(self, r: Any, normal_force: Any = 1.0) -> Any:
        """That of the law inside (along the first direction, at the scaled speed)."""
        return self.law.coefficient(r, normal_force)

    def derivative(self, r: Any, normal_force: Any = 1.0) -> Any:
        """Slope of :meth:`coefficient`."""
        return self.law.derivative(r, normal_force)
