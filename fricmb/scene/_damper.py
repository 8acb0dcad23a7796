"""A linear damper along a direction."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any

from fricmb.scene._axial import AxialElement


@dataclass(frozen=True, eq=False)
class Damper(AxialElement):
    """Force on a: ``-damping e'`` with ``e = a - b`` along an axis.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    a, b : Body, Driven, point of a ModalBody or GROUND
        Ends; b defaults to GROUND.
    axis : str or tuple of float
        Letter, or direction over the first axes of the body.
    damping : float
        Force per speed.
    """

    _: KW_ONLY
    damping: Any

    def __post_init__(self) -> None:
        self._settle("damping")
        super().__post_init__()

    def define_dissipation(self, x: tuple[Any, ...], x_dot: tuple[Any, ...]) -> Any:
        """Quadratic in the rate."""
        return self.damping * x_dot[0] ** 2 / 2
