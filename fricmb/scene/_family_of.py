"""Families of scenes that were made apart: what one of them has found, the next one need not find again.

A function that makes a scene is called once for every value that somebody wants to try, and makes every part anew.
Such scenes share what scenes share that :meth:`Scene.with_parameters` made of one another; whoever takes something from
there compares the parts that it was made of (:func:`~fricmb.scene._family.of_same_parts`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fricmb.scene._part import Part

#: Families that are known at a time, and parts above which a scene keeps to itself: what it keeps would be large.
FAMILIES, SMALL = 32, 50
_families: dict[Any, dict[Any, Any]] = {}


def forget_families() -> None:
    """Let scenes that are made from now on share nothing with earlier ones (for tests)."""
    _families.clear()


def family_of(name: str, parts: tuple[Part, ...]) -> dict[Any, Any]:
    """What scenes of this name share whose parts have the same types and names in the same order."""
    if len(parts) > SMALL:
        return {}
    key = name, tuple([(type(part), part.name) for part in parts])
    for old in list(_families)[: len(_families) + 1 - FAMILIES]:
        if old != key:
            _families.pop(old, None)
    return _families.setdefault(key, {})
