"""Which scenes have the same plan: they differ in numbers that a plan does not look at."""

from __future__ import annotations

from itertools import count
from typing import Any

from fricmb.plan._acting import is_idle
from fricmb.plan._report import zeros
from fricmb.scene import GROUND, Body, Contact, Driven, Element, Part, Scene
from fricmb.values import value_of

#: Ends whose motions are names, whatever their numbers.
_PLAIN = (Body, Driven, type(GROUND))
_numbers = count()


def outline_of(scene: Scene) -> tuple[int, ...]:
    """A number for each part: scenes of one family with equal ones have equal plans.

    Parts have equal numbers where all that a plan reads of them is equal (:func:`_outline`); of parts that are not
    known so well, where they are the same object.
    """
    parts, outlines = scene._shared.setdefault("outlines", ({}, {}))
    found = []
    for part in scene.parts:
        known = parts.get(part.name)
        if known is None or known[0] is not part:
            outline = _outline(part)
            number = next(_numbers) if outline is None else outlines.setdefault(outline, next(_numbers))
            known = parts[part.name] = part, number
        found.append(known[1])
    return tuple(found)


def _outline(part: Part) -> tuple[Any, ...] | None:
    """What a plan reads of a part whose ends are bodies, and of those; None where that may be anything."""
    kind = type(part)
    if isinstance(part, Body) and kind is Body:
        starts = [value_of(value) != 0.0 for start in (part.position, part.velocity) for value in start.values()]
        return (kind, part.name, part.axes, *starts)
    if isinstance(part, Driven) and kind is Driven:
        return kind, part.name, part.axes, part.moving
    if not all(type(end) in _PLAIN for end in part.ends()) or not all(use.constant for use in part.uses().values()):
        return None
    if isinstance(part, Contact) and kind is Contact:
        return _of_contact(part)
    return _of_element(part) if isinstance(part, Element) else None


def _of_contact(contact: Contact) -> tuple[Any, ...] | None:
    if contact.slide is not None or contact.normal_kind != "constant":
        return None
    law, labels = contact.law, contact.labels()
    forms = tuple([direction.form for direction in contact.directions()])
    states = law.n_states(len(labels)) if law.states else 0
    return Contact, contact.name, labels, forms, is_idle(contact), law.kind, law.states, states


def _of_element(element: Element) -> tuple[Any, ...]:
    # what is left of an element for its numbers is known to the equations, one floor up
    from fricmb.equations import element_facts

    facts = element_facts(element)
    forms = tuple([(form.motions, form.constant != 0.0) for form in element.local_coordinates()])
    return type(element), element.name, forms, facts, zeros(element) if facts.empty else ()
