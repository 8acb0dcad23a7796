"""Which scenes have the same plan: they differ in numbers that a plan does not look at."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import count
from typing import Any

from fricmb.equations import element_facts
from fricmb.plan._acting import is_idle
from fricmb.plan._report import zeros
from fricmb.scene import (
    GROUND,
    Body,
    Contact,
    Driven,
    Element,
    Gravity,
    Joint,
    LinearForm,
    Part,
    RigidBody,
    Scene,
    SpaceBody,
)
from fricmb.values import value_of

#: Ends whose motions are names, whatever their numbers.
_PLAIN = (Body, Driven, type(GROUND))
_numbers = count()
#: Numbers of outlines; scenes that were made apart share them.
_known: dict[Any, int] = {}
#: Outlines that are known at a time.
MANY = 20_000
#: What scenes of one outline keep together, of scenes of up to so many parts; larger ones keep it with their family.
FEW, SMALL = 32, 500
_common: dict[Any, dict[Any, Any]] = {}


def common(scene: Scene) -> dict[Any, Any]:
    """What scenes that differ in numbers alone keep together: nothing that depends on such a number, or is changed."""
    found: dict[Any, Any] | None = scene._cache.get("common")
    if found is None:
        held = _common if len(scene.parts) <= SMALL else scene._shared.setdefault("common", {})
        key = scene.name, outline_of(scene)
        for old in list(held)[: len(held) + 1 - FEW]:
            if old != key:
                held.pop(old, None)
        found = scene._cache["common"] = held.setdefault(key, {})
    return found


def outline_of(scene: Scene) -> tuple[int, ...]:
    """A number for each part: scenes of one name with equal ones have equal plans.

    Parts have equal numbers where all that a plan reads of them is equal (:func:`_outline`); of parts that are not
    known so well, where they are the same object.
    """
    parts = scene._shared.setdefault("outlines", {})
    found = []
    for part in scene.parts:
        known = parts.get(part.name)
        if known is None or known[0] is not part:
            same = known is not None and part.differs_in(known[0]) == set()
            known = parts[part.name] = part, known[1] if same else _number(_outline(scene, part))
        found.append(known[1])
    return tuple(found)


def _number(outline: tuple[Any, ...] | None) -> int:
    """The number of an outline; one of its own for a part without."""
    if outline is None:
        return next(_numbers)
    if len(_known) >= MANY:
        _known.clear()  # numbers are not given again
    return _known.setdefault(outline, next(_numbers))


def _outline(scene: Scene, part: Part) -> tuple[Any, ...] | None:
    """What a plan reads of a part; None where that may be anything."""
    kind = type(part)
    if isinstance(part, Body) and kind is Body:
        return (kind, part.name, part.axes, *_moves(part))
    if isinstance(part, Driven) and kind is Driven:
        return kind, part.name, part.axes, part.moving
    uses = part.uses().values()
    if any(use.motions for use in uses):
        return None
    timed = any(use.time for use in uses)
    if isinstance(part, RigidBody):
        return (kind, part.name, part.dof_names, *_moves(part))
    if isinstance(part, SpaceBody):
        return kind, part.name, part.dof_names
    if isinstance(part, Gravity):
        return kind, part.name, tuple([c for c, value in part.acceleration.items() if value_of(value) != 0.0])
    if isinstance(part, Contact) and kind is Contact:
        return None if timed else _of_contact(scene, part)
    if isinstance(part, Joint):
        return _of_joint(scene, part)
    return (*_of_element(scene, part), timed) if isinstance(part, Element) else None


def _moves(body: Body | RigidBody) -> list[bool]:
    """Which coordinates do not start at 0, and which not at rest."""
    starts = [body.start_values(argument) for argument in ("position", "velocity")]
    return [value_of(value) != 0.0 for start in starts for value in start.values()]


def _expanded(scene: Scene, part: Part, forms: Iterable[LinearForm]) -> list[LinearForm]:
    """Forms in degrees of freedom, prescribed motions and points of bodies in the plane."""
    if all(type(end) in _PLAIN for end in part.ends()):
        return list(forms)
    return [scene.expand(form) for form in forms]


def _of_contact(scene: Scene, contact: Contact) -> tuple[Any, ...] | None:
    if contact.slide is not None or contact.normal_kind != "constant":
        return None
    law, labels = contact.law, contact.labels()
    forms = tuple(_expanded(scene, contact, [direction.form for direction in contact.directions()]))
    states = law.n_states(len(labels)) if law.states else 0
    return Contact, contact.name, labels, forms, is_idle(contact), law.kind, law.states, states


def _of_joint(scene: Scene, joint: Joint) -> tuple[Any, ...]:
    law, ends = joint.friction, tuple([end.owner.name for end in (joint.a, joint.b)])
    rubs = None if law is None else (joint.slip_rows, law.n_states(joint.slip_rows))
    holds = joint.constrains, joint.relative, tuple(joint.observed()) if joint.constrains else ()
    forms = tuple([form.motions for form in _expanded(scene, joint, joint.local_coordinates())])
    return type(joint), joint.name, ends, rubs, holds, forms


def _of_element(scene: Scene, element: Element) -> tuple[Any, ...]:
    facts = element_facts(element)
    expanded = _expanded(scene, element, element.local_coordinates())
    forms = tuple([(form.motions, form.constant != 0.0) for form in expanded])
    return type(element), element.name, forms, facts, zeros(element) if facts.empty else ()
