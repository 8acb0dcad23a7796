"""Islands that stay at rest, provably: nothing in them can set anything in motion."""

from __future__ import annotations

from collections.abc import Sequence

from fricmb.plan._links import Link, uses_time
from fricmb.scene import Contact, Element, ModalBody, Scene
from fricmb.values import value_of


def moving_motions(scene: Scene) -> frozenset[str]:
    """Motions of driven bodies that really move, or may."""
    return frozenset(f"{body.name}.{c}" for body in scene.driven for c in body.moving)


def can_start(scene: Scene, link: Link, moving: frozenset[str]) -> bool:
    """Whether a part may set bodies in motion that rest at the origin."""
    part = link.part
    if link.idle:
        return False
    if isinstance(part, Contact):
        return _contact_can_start(scene, part, moving)
    if not isinstance(part, Element):
        return False  # matrices give forces in proportion to position and velocity
    found = link.facts
    forms = [scene.expand(form) for form in part.local_coordinates()]
    prescribed = any(name not in scene.dof_names for form in forms for name in form.motions)
    shifted = any(form.constant != 0.0 for form in forms)
    return bool(
        prescribed or shifted or found.constant or found.signal or found.nonlinear or link.reads or uses_time(part)
    )


def _contact_can_start(scene: Scene, part: Contact, moving: frozenset[str]) -> bool:
    """Friction opposes slip: only a moving partner, a slide or a law with a memory sets anything in motion.

    Normal forces that are not a number, and laws that never stick, are not argued about: those contacts are run.
    """
    forms = [scene.expand(direction.form) for direction in part.directions()]
    return (
        part.slide is not None
        or part.normal_kind != "constant"
        or bool(part.law.states)
        or part.law.kind == "smooth"
        or any(name in moving for form in forms for name in form.motions)
    )


def is_held(scene: Scene, dofs: Sequence[str], links: Sequence[Link]) -> bool:
    """Whether forces on degrees of freedom depend on where these are."""
    if any(not isinstance(link.part, Contact) for link in links):
        return True
    bodies = {name.partition(".")[0] for name in dofs}
    modal = [scene[name] for name in bodies]
    return any(max(value_of(body.frequencies)) > 0.0 for body in modal if isinstance(body, ModalBody))
