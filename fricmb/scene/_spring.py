"""A spring along a direction."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any

from fricmb.scene._axial import AxialElement


@dataclass(frozen=True, eq=False)
class Spring(AxialElement):
    """Force on a: ``-stiffness e - cubic e^3`` with the elongation ``e = a - b - length`` along an axis.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    a, b : Body, Driven, point of a ModalBody or GROUND
        Ends; b defaults to GROUND.
    axis : str or tuple of float
        Letter, or direction over the first axes of the body.
    stiffness, cubic : float
        Force per length and per length cubed.
    length : float
        Natural length.
    """

    _: KW_ONLY
    stiffness: Any
    cubic: Any = 0.0
    length: Any = 0.0

    def __post_init__(self) -> None:
        self._settle("stiffness", "cubic", "length")
        super().__post_init__()

    def define_potential(self, x: tuple[Any, ...]) -> Any:
        """Quadratic and quartic in the elongation."""
        e = x[0] - self.length
        return self.stiffness * e**2 / 2 + self.cubic * e**4 / 4
