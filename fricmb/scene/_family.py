"""What scenes of one family share: those that ``replace`` and ``with_parameters`` made of one another, or look so."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import TypeVar

from fricmb.scene._bodies import Body
from fricmb.scene._other_values import MANY
from fricmb.scene._part import Part
from fricmb.scene._rigid import RigidBody
from fricmb.scene._scene import Scene

_T = TypeVar("_T")

#: Fields of bodies: where they start, and all numbers, by which no motion is named.
STARTS = frozenset(("position", "velocity"))
NUMBERS = STARTS | {"mass", "inertia"}


def of_same_parts(
    scene: Scene, key: Hashable, parts: Sequence[Part], make: Callable[[], _T], *, but: frozenset[str] = frozenset(),
    alike: Callable[[Part, Part, frozenset[str]], bool] | None = None,
) -> _T:  # fmt: skip
    """What ``make`` makes of some parts, or made of equal ones for another scene of the family.

    Scenes that differ in one value differ in one part, so that a sweep over a stiffness needs its contacts made once,
    and one over a friction coefficient its structure.

    Parameters
    ----------
    scene : Scene
    key : hashable
        What is made, and all that it depends on beside the parts; of each key the last is kept.
    parts : sequence of Part
        All that it is made of; what is kept is found again where these hold the same values in the same order.
    but : set of str
        Fields of bodies that it does not depend on.
    alike : callable, optional
        Whether one part may stand for another; default: :func:`is_same_part`.
    make : callable
        Its result must never be changed.
    """
    if len(scene.parts) > MANY:
        return make()
    kept = scene._shared.setdefault("of same parts", {})
    held, made = kept.get(key, ((), None))
    same = alike or is_same_part
    equal = (a is b or same(a, b, but) for a, b in zip(held, parts, strict=False))
    if len(held) != len(parts) or not parts or not all(equal):
        made = make()
        kept[key] = tuple(parts), made
    found: _T = made
    return found


def is_same_part(one: Part, other: Part, but: frozenset[str]) -> bool:
    """Whether two parts hold the same values, in bodies those fields left out."""
    if one is other:
        return True
    differs = one.differs_in(other)
    return differs is not None and differs <= (but if type(one) in (Body, RigidBody) else frozenset())
