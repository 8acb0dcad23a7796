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
    scene: Scene, key: tuple[Hashable, ...], parts: Sequence[Part], signals: Signals, build: Callable[[], _T]
) -> _T:
    """What ``build`` makes of some parts, or made of them for another scene; what it adds to the signals is added.

    ``key``: which half it is, and for which degrees of freedom.
    """
    before = tuple(signals.index)

    def make() -> tuple[list[tuple[str, Signal]], _T]:
        built = build()
        return list(zip(signals.index, signals.held, strict=True))[len(before) :], built

    added, built = of_same_parts(scene, (*key, before), parts, make)
    for name, signal in added[len(signals.index) - len(before) :]:  # none of what was built just now
        signals.put(name, signal)
    return built
