"""One coordinate of two bodies: along a letter or a direction, an angle in the plane, or what a pin leaves free."""

from __future__ import annotations

from typing import Any

from fricmb.errors import SceneError
from fricmb.scene._axes import is_direction_tuple
from fricmb.scene._joint import Joint
from fricmb.scene._joints import Revolute
from fricmb.scene._part import GROUND, LETTERS, End, Part

#: The word for the relative angle of two bodies that turn in the plane.
ANGLE = "angle"
#: What an axis may be.
ACCEPTED = "'x', 'y', 'z', 'angle', a direction tuple, or a Revolute of the plane"
#: What is said of other joints: the angle of a guide is a number of its own, which a copy of it would not follow.
ONLY_PINS = "a Revolute of the plane; along a guide that does not turn give the direction, (cos, sin) of its angle"


def joint_ends(part: Part, a: Any, b: Any, joint: Joint) -> tuple[End, End]:
    """Ends of a joint, first the one that belongs to the body of a; b is left out or belongs to the other."""
    ends = (joint.a, joint.b)
    mine = [end for end in ends if isinstance(a, End) and end.owner is a.owner]
    if not mine:
        names = " or ".join(repr(end.owner.name) for end in ends)
        part._refuse("a", getattr(a, "end_name", a), f"of a body that the joint {joint.name!r} ties: {names}")
    other = ends[1] if mine[0] is ends[0] else ends[0]
    if b is not GROUND and (not isinstance(b, End) or b.owner is not other.owner):
        part._refuse("b", getattr(b, "end_name", b), f"left out, or the other end of the joint, {other.end_name!r}")
    return mine[0], other


def one_coordinate(part: Part, a: Any, b: Any, axis: Any) -> tuple[Any, Any]:
    """The second end and the axis as declared; a pin stands for the other end of it and for the angle."""
    if axis is None:
        raise SceneError(f"{part._label()}: axis must be given: {ACCEPTED}")
    if isinstance(axis, Joint):
        _, other = joint_ends(part, a, b, axis)
        if not isinstance(axis, Revolute):
            part._refuse("axis", axis.name, ONLY_PINS)
        return other, ANGLE
    if not is_direction_tuple(axis) and not (isinstance(axis, str) and axis in (*LETTERS, ANGLE)):
        part._refuse("axis", axis, ACCEPTED)
    return b, axis
