"""The way along a guide whose line may turn: what stops and play on it limit."""

from __future__ import annotations

from typing import Any

from fricmb.scene._axes import check_axis
from fricmb.scene._forms import LinearForm
from fricmb.scene._joints import Prismatic
from fricmb.scene._one_coordinate import ANGLE, joint_ends, one_coordinate
from fricmb.scene._rigid import angle_of, plane_motion

#: Axis of a part whose coordinate is that of a guide.
GUIDE = "guide"


def take_guide(part: Any, guide: Prismatic) -> None:
    """Ends, name and angle of a guide, along whose line the coordinate of a part is."""
    mine, other = joint_ends(part, part.a, part.b, guide)
    if mine is not guide.a:
        part._refuse("a", mine.end_name, f"the end of the guide {guide.name!r} that slides, {guide.a.end_name!r}")
    for field, value in (("a", mine), ("b", other), ("guide", guide.name), ("angle", guide.angle)):
        part._set(field, value)


def is_on_guide(part: Any) -> bool:
    """Whether a part is along a guide, with its fields put right; an angle alone is refused."""
    if part.guide is not None:
        part._set("axis", GUIDE)
        part._set("angle", part._number("angle", part.angle))
        return True
    if part.angle is not None:
        part._refuse("angle", part.angle, "left out: a guide brings it")
    return False


def check_way(part: Any) -> None:
    """Refuse an axis that is not accepted, and take what a joint stands for."""
    if isinstance(part.axis, Prismatic):
        take_guide(part, part.axis)
    if is_on_guide(part):
        return
    b, axis = one_coordinate(part, part.a, part.b, part.axis)
    part._set("b", b)
    part._set("axis", axis if axis == ANGLE else check_axis(part, "axis", axis))


def guide_coordinates(part: Any) -> tuple[LinearForm, LinearForm, LinearForm]:
    """Distance of the points, in x and y, and the angle of the line's body."""
    (ax, ay), (bx, by) = plane_motion(part, "a", part.a), plane_motion(part, "b", part.b)
    return ax - bx, ay - by, angle_of(part, "b", part.b)


def along(x: Any, angle: Any, functions: Any) -> Any:
    """The way of the local coordinates x; ``angle``: of the line in its body; ``functions``: NumPy or SymPy."""
    return x[0] * functions.cos(x[2] + angle) + x[1] * functions.sin(x[2] + angle)


def along_rate(x: Any, rates: Any, angle: Any, functions: Any) -> Any:
    """Its rate."""
    cos, sin = functions.cos(x[2] + angle), functions.sin(x[2] + angle)
    across = x[1] * cos - x[0] * sin
    return rates[0] * cos + rates[1] * sin + across * rates[2]
