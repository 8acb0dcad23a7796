"""Elements between two ends along an axis."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import Any, Self

from fricmb.scene._axes import check_axis, check_ends, components, direction
from fricmb.scene._element import Element
from fricmb.scene._forms import LinearForm
from fricmb.scene._part import GROUND, End


@dataclass(frozen=True, eq=False)
class AxialElement(Element):
    """Base of elements of one coordinate: the motion of a less that of b along an axis.

    What is between bodies along a letter, with numbers for its fields, is put into arrays with all others of its type
    at a time, not one by one: scenes of many are built fast (an element of one's own that derives from this, too).

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    a, b : Body, Driven, point of a ModalBody or GROUND
        Ends; b defaults to GROUND.
    axis : str or tuple of float
        Letter, or direction over the first axes of the body.
    """

    a: End
    b: End = GROUND
    _: KW_ONLY
    axis: Any

    def __post_init__(self) -> None:
        super().__post_init__()
        check_ends(self, self.a, self.b)
        if not isinstance(self.axis, str):
            self._set("axis", check_axis(self, "axis", self.axis))
        elif self.axis not in ("x", "y", "z"):
            check_axis(self, "axis", self.axis)
        components(self, "axis", self.axis, self.a, self.b)

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the ends along the axis."""
        return self._coordinates

    def _take_over(self, other: Self) -> None:
        if self.a is other.a and self.b is other.b and self.axis is other.axis:
            vars(self)["_coordinates"] = other._coordinates

    @cached_property
    def _coordinates(self) -> tuple[LinearForm, ...]:
        return (direction(self, "axis", self.axis, self.a, self.b).form,)
