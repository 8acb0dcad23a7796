"""Weight of bodies."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from fricmb.scene import Body, Gravity, RigidBody, SpaceBody
from fricmb.system._structure import Store, Structure
from fricmb.system._tables import Row
from fricmb.values import value_of


def add_gravity(gravity: Gravity, parts: Iterable[Any], structure: Structure) -> None:
    """Constant forces on all bodies among the parts, and their potential."""
    rows: list[Row] = []
    index = structure.motions.dofs
    f: list[tuple[int, int, float]] = []
    for body in parts:
        if not isinstance(body, Body | RigidBody | SpaceBody):
            continue
        mass = float(value_of(body.mass))
        for letter, value in gravity.acceleration.items():
            name = f"{body.name}.{letter}"
            if name in index and float(value_of(value)) != 0.0:
                weight = mass * float(value_of(value))
                structure.f.append((index[name], weight))
                f.append((len(rows), 0, weight))
                rows.append(Row(((index[name], 1.0),)))
    structure.stores.append(Store(name=gravity.name, rows=tuple(rows), K=(), f=f))
