"""The angular velocity of a body as factors of the rates of what turns of it, by the type of the body."""

from __future__ import annotations

from typing import Any

from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._part import GROUND, Part
from fricmb.scene._space_body import SpaceBody
from fricmb.space._ball import Ball
from fricmb.space._directors import RigidBody
from fricmb.space._rotor import Rotor
from fricmb.space._turn import dot

#: What turns, and how many coordinates that has.
KINDS = {"ground": 0, "ball": 3, "rotor": 4, "directors": 9}
_TYPES: tuple[tuple[type, str], ...] = ((Ball, "ball"), (Rotor, "rotor"), (RigidBody, "directors"))


def kind_of(joint: Joint, argument: str) -> str:
    """What turns of an end, a name among KINDS."""
    owner: Part = getattr(joint, argument).owner
    if owner is GROUND:
        return "ground"
    for held, name in _TYPES:
        if isinstance(owner, held):
            return name
    joint._refuse(argument, owner.name, "a body of fm.space or the ground, where there is friction")


def turning_forms(owner: Part) -> tuple[LinearForm, ...]:
    """The coordinates that turn; of the ground none."""
    return owner.turning_forms() if isinstance(owner, SpaceBody) else ()


def turning_rows(kind: str, x: Any) -> list[tuple[Any, ...]]:
    """Factors of the rates of x in the three components of the angular velocity.

    Of a ball the rates themselves; of a rotor ``n x n' + s' n``, n made a unit vector, which stages leave a little; of
    a rigid body ``sum d x d'/2``.
    """
    import sympy

    if kind == "ground":
        return [(), (), ()]
    if kind == "ball":
        return [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    if kind == "rotor":
        length = sympy.sqrt(dot(x[0:3], x[0:3]))
        n = [c / length for c in x[0:3]]
        return [(*(c / length for c in row), n[k]) for k, row in enumerate(_product(n))]
    parts = [_product(x[i : i + 3]) for i in (0, 3, 6)]
    return [tuple(c / 2 for part in parts for c in part[k]) for k in range(3)]


def _product(d: Any) -> list[tuple[Any, Any, Any]]:
    """The matrix of ``d x``, by rows."""
    return [(0, -d[2], d[1]), (d[2], 0, -d[0]), (-d[1], d[0], 0)]
