"""How fast the prescribed loads and motions of a scene change."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from fricmb.scene import Scene
from fricmb.values import is_expression, value_of


def highest_frequency(scene: Scene) -> float:
    """Largest angular frequency of ``sin`` and ``cos`` of time in the scene's expressions; 0 where there is none.

    Of a phase that is not linear in time nothing can be said before the run; it counts nothing.
    """
    return max((omega for value in _expressions(scene) for omega in _frequencies(value)), default=0.0)


def _expressions(scene: Scene) -> Iterator[Any]:
    for part in scene.parts:
        for field in dataclasses.fields(part):
            value = getattr(part, field.name)
            inside = value.values() if isinstance(value, Mapping) else value if isinstance(value, tuple) else (value,)
            yield from (entry for entry in inside if is_expression(entry))


def _frequencies(value: Any) -> Iterator[float]:
    import sympy

    from fricmb.values._symbols import TIME

    for wave in value.atoms(sympy.sin, sympy.cos):
        try:
            omega = abs(float(value_of(sympy.diff(wave.args[0], TIME))))
        except TypeError:
            continue
        if np.isfinite(omega):
            yield omega
