"""What scenes of one family share: those that ``replace`` and ``with_parameters`` made of one another."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from operator import is_
from typing import TypeVar

from fricmb.scene._part import Part
from fricmb.scene._scene import Scene

_T = TypeVar("_T")

#: Parts above which nothing is kept: putting something together is little beside running it.
MANY = 500


def of_same_parts(scene: Scene, key: Hashable, parts: Sequence[Part], make: Callable[[], _T]) -> _T:
    """What ``make`` makes of some parts, or made of the very same ones for another scene of the family.

    Scenes that differ in one value differ in one part, so that a sweep over a stiffness needs its contacts made once,
    and one over a friction coefficient its structure.

    Parameters
    ----------
    scene : Scene
    key : hashable
        What is made, and all that it depends on beside the parts; of each key the last is kept.
    parts : sequence of Part
        All that it is made of; what is kept is found again where these are the same objects in the same order.
    make : callable
        Its result must never be changed.
    """
    if len(scene.parts) > MANY:
        return make()
    kept = scene._shared.setdefault("of same parts", {})
    held, made = kept.get(key, ((), None))
    if len(held) != len(parts) or not parts or not all(map(is_, held, parts)):
        made = make()
        kept[key] = tuple(parts), made
    found: _T = made
    return found
