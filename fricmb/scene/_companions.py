"""Parts that stand beside others in a scene without being listed: what a joint's argument stands for."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fricmb.scene._joint import Joint
from fricmb.scene._joints import Prismatic
from fricmb.scene._resistance import Resistance
from fricmb.scene._rope_ends import RopeEnd, RopePull, RopeSpan
from fricmb.values._same import is_same

#: What stands beside a rope.
ROPE = RopeEnd, RopeSpan, RopePull


def with_companions(parts: tuple[Any, ...]) -> tuple[Any, ...]:
    """Parts, with behind each joint what stands beside it.

    What is there already under its name, from the same declaration, stays: it may have other values by now.
    """
    asked = {id(part): part.companions() for part in parts if isinstance(part, Joint)}
    named = {one.name: one for companions in asked.values() for one in companions}
    if not named and not any(_belongs(part) for part in parts):
        return parts
    here = {part.name: part for part in parts if _belongs(part)}
    found: list[Any] = []
    for part in parts:
        if _belongs(part):
            continue
        found.append(part)
        for one in asked.get(id(part), ()):
            old = here.get(one.name)
            found.append(_beside_rope(part, old, one) if isinstance(one, ROPE) else _kept(old, one))
    return tuple(found)


def keeps_companions(old: Any, new: Any) -> bool:
    """Whether a part that was changed asks for the same beside it."""
    if not isinstance(old, Joint) or not isinstance(new, Joint):
        return True
    before, after = old.companions(), new.companions()
    return len(before) == len(after) and all(_alike(*pair) for pair in zip(before, after, strict=True))


def with_guides(parts: tuple[Any, ...], changed: dict[str, Any]) -> dict[str, Any]:
    """Changed parts, and behind guides whose angle is another what acts along them."""
    turned = {name: part.angle for name, part in changed.items() if isinstance(part, Prismatic)}
    if not turned:
        return changed
    along = [part for part in parts if getattr(part, "guide", None) in turned and hasattr(part, "angle")]
    follow = {part.name: replace(part, angle=turned[part.guide]) for part in along if part.name not in changed}
    return {**changed, **follow}


def _kept(old: Any, new: Any) -> Any:
    """What is there, with its own values by now, or what is declared."""
    if old is None or type(old) is not type(new) or old.declared[0] is not new.declared[0]:
        return new
    return old if _alike(old, new) else replace(new, friction=old.friction)


def _beside_rope(rope: Any, old: Any, new: Any) -> Any:
    """The end that a rope has by now; the span or the pull that is there with it, or else the declared one with it."""
    ends = {end.name: end for end in (rope.a, rope.b) if isinstance(end, RopeEnd)}
    if isinstance(new, RopeEnd):
        return ends[new.name]
    same = type(old) is type(new) and is_same(old.declared, new.declared)
    return old if same and ends.get(_end(old).name) is _end(old) else new.with_ends(ends)


def _end(part: Any) -> RopeEnd:
    """The rope's end of a span or a pull."""
    end: RopeEnd = part.b if isinstance(part, RopeSpan) else part.body
    return end


def _alike(one: Any, other: Any) -> bool:
    return one.name == other.name and all(a is b for a, b in zip(one.declared, other.declared, strict=True))


def _belongs(part: Any) -> bool:
    """Whether a part stands beside another one."""
    return isinstance(part, (Resistance, *ROPE))
