"""Elements of one type at a time: one template, and what is left of it for each set of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.equations._facts import ElementFacts, facts_of
from fricmb.equations._templates import Template, Terms, element_template
from fricmb.scene import Scene
from fricmb.scene._lines import lines_of, parts_at
from fricmb.values._declaration import slot_values


@dataclass(frozen=True, kw_only=True)
class Group:
    """Elements of one type along one letter, with numbers for their fields.

    Attributes
    ----------
    index : (k,) int
        Which of the given elements they are.
    template : Template
    terms : tuple of Terms
        For each different set of numbers.
    which : (k,) int
        The set of each element.
    """

    index: NDArray[np.int64]
    template: Template
    terms: tuple[Terms, ...]
    which: NDArray[np.int64]

    def facts(self) -> list[ElementFacts]:
        """Which terms there are, for each different set of numbers."""
        return [facts_of(terms, self.template) for terms in self.terms]


def groups_of(elements: Sequence[Any]) -> list[Group]:
    """Elements by type and letter."""
    held: dict[tuple[type, str], list[int]] = {}
    for i, element in enumerate(elements):
        held.setdefault((type(element), element.axis), []).append(i)
    return [_group([elements[i] for i in index], index) for index in held.values()]


def element_groups(scene: Scene) -> list[Group]:
    """Those of a scene's lines (``index``: of ``lines_of(scene).elements``); kept with it."""
    lines = lines_of(scene).elements
    return list(scene._once("element groups", lambda: groups_of(parts_at(scene, lines.at))))


def _group(elements: Sequence[Any], index: list[int]) -> Group:
    template = element_template(elements[0], driven=False)
    number: dict[tuple[float, ...], int] = {}
    kind: Any = type(elements[0])
    read = slot_values(kind)
    which = [number.setdefault(read(element), len(number)) for element in elements]
    return Group(
        index=np.array(index, dtype=np.int64),
        template=template,
        terms=tuple([template.terms(p) for p in number]),
        which=np.array(which, dtype=np.int64),
    )
