"""What lies between bodies along a letter, all of it at a time: where its ends are, in arrays.

A large scene is mostly springs, dampers and contacts of plain numbers between bodies.  What they act on follows from
their fields; no linear form is made for each of them.  Everything else is looked at one by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.scene._axial import AxialElement
from fricmb.scene._bodies import Body, Driven
from fricmb.scene._contact import Contact
from fricmb.scene._part import GROUND, LETTERS, Part
from fricmb.scene._scene import BODIES, Scene

Ints = NDArray[np.int64]

#: An end that never moves; smaller numbers are prescribed motions: MOVING - j is number j of ``Lines.motions``.
STILL, MOVING = -1, -2


@dataclass(frozen=True, kw_only=True)
class Rows:
    """Motions of a less that of b along a letter.

    Attributes
    ----------
    at : (k,) int
        Place of the part in the scene, rising; once for each of its directions.
    a, b : (k,) int
        The degree of freedom that each end is, by its place in the scene, or STILL, or a prescribed motion.
    """

    at: Ints
    a: Ints
    b: Ints


@dataclass(frozen=True, kw_only=True)
class Lines:
    """Elements of plain numbers between bodies along a letter, neither end prescribed; contacts of a plain law.

    Attributes
    ----------
    elements, contacts : Rows
        Contacts have a constant normal force, no slide and a law without states that sticks and is isotropic.
    motions : tuple of str
        Names of prescribed motions that ``contacts`` refers to.
    others : list of int
        Places of all parts that are in neither, bodies included.
    """

    elements: Rows
    contacts: Rows
    motions: tuple[str, ...]
    others: list[int]


def lines_of(scene: Scene) -> Lines:
    """The lines of a scene; kept with it."""
    return scene._once("lines", lambda: _find(scene))


def _find(scene: Scene) -> Lines:
    spots, motions = _spots(scene)
    elements: tuple[list[int], ...] = ([], [], [])
    contacts: tuple[list[int], ...] = ([], [], [])
    others: list[int] = []
    for i, part in enumerate(scene.parts):
        kind: Any = type(part)
        if isinstance(part, Contact):
            ends, (at, first, second) = _contact(part, spots), contacts
        else:
            ends, (at, first, second) = _element(part, spots) if _is_axial(kind) else (), elements
        for a, b in ends:
            at.append(i)
            first.append(a)
            second.append(b)
        if not ends:
            others.append(i)
    return Lines(elements=_rows(elements), contacts=_rows(contacts), motions=tuple(motions), others=others)


def _rows(columns: Sequence[list[int]]) -> Rows:
    at, a, b = (np.array(column, dtype=np.int64) for column in columns)
    return Rows(at=at, a=a, b=b)


Spots = dict[str, dict[int, int]]


def _spots(scene: Scene) -> tuple[Spots, list[str]]:
    """Where each body of the scene stands along each letter, by its identity."""
    spots: Spots = {c: {id(GROUND): STILL} for c in LETTERS}
    motions: list[str] = []
    place = 0
    for part in scene.parts:
        kind: Any = type(part)
        if isinstance(part, Body):
            if kind.motion is Body.motion and kind.dof_names is Body.dof_names:
                for i, c in enumerate(part.axes):
                    spots[c][id(part)] = place + i
            place += len(part.axes)
        elif isinstance(part, BODIES):
            place += len(part.dof_names)
        elif isinstance(part, Driven) and kind.motion is Driven.motion:
            for c in part.letters or LETTERS:
                spots[c][id(part)] = MOVING - len(motions) if c in part.moving else STILL
                if c in part.moving:
                    motions.append(f"{part.name}.{c}")
    return spots, motions


@cache
def _is_axial(kind: type) -> bool:
    """Whether all of a type's elements lie along their axis, and no field of its own but numbers selects a formula."""
    if not issubclass(kind, AxialElement) or kind.local_coordinates is not AxialElement.local_coordinates:
        return False
    return set(kind._fixed).issubset(("name", "a", "b", "body", "axis", "axes"))


def _element(part: Any, spots: Spots) -> Sequence[tuple[int, int]]:
    if type(part.axis) is not str or part.plain_numbers() is None:
        return ()
    spot = spots[part.axis]
    a, b = spot.get(id(part.a)), spot.get(id(part.b))
    return () if a is None or b is None or a <= MOVING or b <= MOVING else ((a, b),)


def _contact(part: Contact, spots: Spots) -> Sequence[tuple[int, int]]:
    law = part.law
    if type(part.normal_force) is not float or part.slide is not None or law.states or law.kind == "smooth":
        return ()
    letters = part.letters_along()
    if letters is None or law.axis_scale() or law.offsets():
        return ()
    found = [(spots[c].get(id(part.a)), spots[c].get(id(part.b))) for c in letters]
    plain = [(a, b) for a, b in found if a is not None and b is not None]
    return plain if len(plain) == len(found) else ()


def parts_at(scene: Scene, places: Ints) -> list[Part]:
    """The parts at places in a scene."""
    parts = scene.parts
    return [parts[i] for i in places.tolist()]
