"""What stays at rest, provably: parts that cannot set anything in motion."""

from __future__ import annotations

from collections.abc import Iterable, Set
from typing import Any

from fricmb.scene import Contact, Element, Joint, ModalBody, Part, Scene, SpaceBody, expression_uses
from fricmb.values import value_of


def can_start(scene: Scene, part: Part, facts: Any, prescribed: Set[str], reads: bool) -> bool:
    """Whether a part may set bodies in motion that rest at the origin.

    Parameters
    ----------
    scene : Scene
    part : Part
    facts : ElementFacts or None
        Of an element: which terms it has.
    prescribed : set of str
        Prescribed motions that it depends on.
    reads : bool
        Whether its expressions look at coordinates.
    """
    if isinstance(part, Contact):
        return _contact_can_start(scene, part, prescribed)
    if isinstance(part, Joint | SpaceBody):
        return True
    if not isinstance(part, Element):
        return False  # matrices give forces in proportion to position and velocity
    shifted = any(scene.expand(form).constant != 0.0 for form in part.local_coordinates())
    timed = any(expression_uses(value).time for value in part.expressions().values())
    return bool(prescribed or shifted or facts.constant or facts.signal or facts.nonlinear or reads or timed)


def _contact_can_start(scene: Scene, part: Contact, prescribed: Set[str]) -> bool:
    """Friction opposes slip: only a moving partner, a slide or a law with a memory sets anything in motion.

    Normal forces that are not a number, and laws that never stick, are not argued about: those contacts are run.
    """
    moving = {f"{body.name}.{c}" for body in scene.driven for c in body.moving}
    return (
        part.slide is not None
        or part.normal_kind != "constant"
        or bool(part.law.states)
        or part.law.kind == "smooth"
        or not moving.isdisjoint(prescribed)
    )


def is_held(scene: Scene, bodies: Iterable[str]) -> bool:
    """Whether bodies hold themselves where they are: modes do, as parts other than contacts do."""
    modal = (scene[name] for name in bodies)
    return any(max(value_of(body.frequencies)) > 0.0 for body in modal if isinstance(body, ModalBody))
