"""What single parts add to arrays under construction, kept for scenes in which they are the same.

Scenes of a family differ in one part or two: only these are looked at anew, and what all others bring is put together.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, Protocol, TypeVar

from fricmb.scene import Part
from fricmb.scene._family import STARTS, is_same_part
from fricmb.scene._other_values import MANY

_P = TypeVar("_P", bound=Part)


class Growing(Protocol):
    """Arrays under construction."""

    def lists(self) -> tuple[list[Any], ...]:
        """Lists that a part may add to; no entry depends on those before it."""

    def marks(self) -> tuple[int, ...]:
        """Numbers that stay the same while what a part adds is in the lists, and follows from the part alone."""


#: By the names of parts: the part, and what it added to each list.
Shares = dict[str, tuple[Part, tuple[list[Any], ...]]]


def shares_of(scene: Any, key: Hashable) -> Shares | None:
    """The shares of a family of scenes; None for large scenes, which keep nothing.  ``key``: of what kind of arrays."""
    if len(scene.parts) > MANY:
        return None
    found: Shares = scene._shared.setdefault(("shares", key), {})
    return found


def is_equal(one: Part, other: Part) -> bool:
    """Whether two parts hold the same values."""
    return is_same_part(one, other, frozenset())


def is_equal_but_start(one: Part, other: Part) -> bool:
    """Whether two parts hold the same values, bodies but for where they start."""
    return is_same_part(one, other, STARTS)


def add_share(
    shares: Shares | None, part: _P, target: Growing, add: Callable[[_P], object],
    same: Callable[[Part, Part], bool] = is_equal,
) -> None:  # fmt: skip
    """Let a part add to arrays, or add what another one added that is the ``same`` to them."""
    if shares is None:
        add(part)
        return
    known = shares.get(part.name)
    if known is not None and (known[0] is part or same(known[0], part)):
        for grown, share in zip(target.lists(), known[1], strict=True):
            grown.extend(share)
        return
    lists, marks = target.lists(), target.marks()
    lengths = [len(grown) for grown in lists]
    add(part)
    if target.marks() == marks and part.only_numbers():
        shares[part.name] = part, tuple([grown[n:] for grown, n in zip(lists, lengths, strict=True)])
