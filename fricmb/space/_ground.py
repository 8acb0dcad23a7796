"""Fixed points of space."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fricmb._calls import answers
from fricmb.errors import SceneError, shown
from fricmb.scene._forms import LinearForm
from fricmb.scene._part import GROUND, LETTERS, End, Part
from fricmb.values import as_float


@dataclass(frozen=True)
class SpaceGroundPoint(End):
    """A fixed point of space; made by :func:`ground_point`."""

    x: float
    y: float
    z: float

    @property
    def end_name(self) -> str:
        """Such as ``"ground(1, 0, 0)"``."""
        return f"ground({self.x:g}, {self.y:g}, {self.z:g})"

    @property
    def owner(self) -> Part:
        """The ground."""
        return GROUND

    @property
    def letters(self) -> tuple[str, ...]:
        """Letters of space."""
        return LETTERS

    @property
    def movable(self) -> bool:
        """False: the ground rests."""
        return False

    def motion(self, letter: str) -> LinearForm:
        """Where it is."""
        return LinearForm((), {"x": self.x, "y": self.y, "z": self.z}[letter])

    def moved_to(self, part: Part) -> End:
        """There is one ground."""
        return self


@answers
def ground_point(x: float, y: float, z: float) -> SpaceGroundPoint:
    """A fixed point of space, an end for joints and elements.

    Examples
    --------
    >>> import fricmb as fm
    >>> fm.space.ground_point(0, 0, 1).end_name
    'ground(0, 0, 1)'
    """
    for argument, value in (("x", x), ("y", y), ("z", z)):
        if not math.isfinite(as_float(value)):
            raise SceneError(f"ground_point: {argument} must be a finite number, got {shown(value)}")
    return SpaceGroundPoint(float(x), float(y), float(z))
