"""Halves of a system, structure and contacts, with the signals that each brings."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import TypeVar

from fricmb.equations import Signal
from fricmb.scene import Part, Scene
from fricmb.scene._family import of_same_parts
from fricmb.system._motions import Signals

_T = TypeVar("_T")


def half_of(
    scene: Scene, key: tuple[Hashable, ...], parts: Sequence[Part], signals: Signals, build: Callable[[], _T],
    but: frozenset[str],
) -> _T:  # fmt: skip
    """What ``build`` makes of some parts, or made of them for another scene; what it adds to the signals is added.

    ``key``: which half it is, and for which degrees of freedom; ``but``: fields of bodies that it does not depend on.
    """
    before = tuple(signals.index)

    def make() -> tuple[list[tuple[str, Signal]], _T]:
        built = build()
        return list(zip(signals.index, signals.held, strict=True))[len(before) :], built

    added, built = of_same_parts(scene, (*key, before), parts, make, but=but)
    for name, signal in added[len(signals.index) - len(before) :]:  # none of what was built just now
        signals.put(name, signal)
    return built
