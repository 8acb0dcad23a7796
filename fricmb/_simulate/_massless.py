"""Bodies without mass: what determines their velocity, and what is solved in their place.

A slider between a spring and dry friction is a Jenkins element, exact but for its rounded corner.  A body that a damper
or a viscous law holds back follows its forces at once: it gets so small a mass that it does so within a billionth of
the time c/k in which its spring gives way, which is what its velocity is off by then, in parts of itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NoReturn

from fricmb.errors import SceneError
from fricmb.laws import Coulomb, Jenkins
from fricmb.scene import Body, Contact, Damper, Scene, Spring
from fricmb.scene._rigid import start_place
from fricmb.values import value_of

#: Share of its limit within which a slider begins to yield: its corner costs less than 1e-9 of a motion.
CORNER = 1e-5
#: Time in which a damped body follows its forces, over that in which its spring gives way.
FOLLOWS = 1e-9
_ADVICE = (
    "a body without mass needs what determines its velocity: along each axis a fm.Damper, or a contact whose law is"
    " viscous, beside a fm.Spring; or it is a slider, of one axis, between one fm.Spring and one contact under"
    " fm.laws.Coulomb with mu_k = mu_s and a constant normal force"
)


def with_masses(scene: Scene) -> Scene:
    """The scene that is solved, with what is said of it; itself where every body has its mass."""
    return scene._once("with masses", lambda: _with_masses(scene))


def _with_masses(scene: Scene) -> Scene:
    bodies = [part for part in scene.parts if isinstance(part, Body) and value_of(part.mass) == 0.0]
    if not bodies:
        return scene
    new: dict[str, Any] = {}
    masses: dict[str, float] = {}
    notes = []
    for body in bodies:
        beside = [part for part in scene.parts if part is not body and _touches(part, body)]
        if _is_slider(body, beside):
            spring, contact = sorted(beside, key=lambda part: isinstance(part, Contact))
            new |= {body.name: None, spring.name: None, contact.name: _element(body, spring, contact)}
            notes.append(
                f"body {body.name!r} without mass is a slider: {contact.name!r} holds it as a Jenkins element, and its"
                f" position is that of the other end of {spring.name!r} less sol.state({contact.name!r})"
            )
            continue
        masses[body.name] = mass = _small_mass(body, beside)
        notes.append(
            f"body {body.name!r} without mass is solved with {mass:.2g}, which delays it by {FOLLOWS:g} of c/k"
        )
    for name, mass in masses.items():
        scene = scene.replace(name, mass=mass)
    if new:
        parts = [new.get(part.name, part) for part in scene.parts]
        scene = Scene(scene.name, [part for part in parts if part is not None], units=scene.units)
    scene._cache["notes"] = tuple(notes)
    return scene


def _touches(part: Any, body: Body) -> bool:
    return any(end.owner is not None and end.owner.name == body.name for end in part.ends())


def _refuse(body: Body) -> NoReturn:
    raise SceneError(f"Body {body.name!r}: mass is 0; {_ADVICE}")


# -- sliders ------------------------------------------------------------------------------------------------------
def _is_slider(body: Body, beside: list[Any]) -> bool:
    """Whether one spring and one contact under Coulomb's law are all there is."""
    if len(body.axes) != 1 or sorted(type(part).__name__ for part in beside) != ["Contact", "Spring"]:
        return False
    spring, contact = sorted(beside, key=lambda part: isinstance(part, Contact))
    law = contact.law
    plain = isinstance(law, Coulomb) and (law.mu_k is None or value_of(law.mu_k) == value_of(law.mu_s))
    return bool(
        plain and contact.normal_kind == "constant" and contact.slide is None and contact.labels() == (body.axes,)
        and spring.axis == body.axes and value_of(spring.cubic) == 0.0 and value_of(contact.normal_force) > 0.0
        and law.slip_limit() > 0.0 and value_of(spring.stiffness) > 0.0
    )  # fmt: skip


def _element(body: Body, spring: Any, contact: Any) -> Contact:
    """The contact that spring and slider are together."""
    held = spring.b if spring.a.owner.name == body.name else spring.a
    turned = contact.a.owner.name != body.name
    ends = (contact.a, held) if turned else (held, contact.b)
    if not (ends[0].movable or ends[1].movable):
        _refuse(body)
    _check_relaxed(body, spring, held)
    N = contact.normal_force
    law = Jenkins(stiffness=value_of(spring.stiffness) / value_of(N), mu=contact.law.slip_limit(), corner=CORNER)
    return Contact(contact.name, *ends, law=law, normal_force=N, axes=body.axes)


def _check_relaxed(body: Body, spring: Any, held: Any) -> None:
    """Refuse a slider whose spring is not relaxed at the start, which is where the element begins."""
    at: Mapping[str, float] = start_place(held) or {}
    way = float(at.get(body.axes, 0.0)) - float(value_of(body.position[body.axes]))
    sign = 1.0 if spring.a is held else -1.0
    if abs(way - sign * float(value_of(spring.length))) > 1e-12 * max(1.0, abs(way)):
        raise SceneError(
            f"Body {body.name!r}: mass is 0, a slider, whose spring {spring.name!r} is not relaxed at the start;"
            " position must be the one at which it is"
        )


# -- damped bodies ------------------------------------------------------------------------------------------------
def _small_mass(body: Body, beside: list[Any]) -> float:
    """A mass that follows its damper within FOLLOWS of the time in which its springs give way."""
    masses = []
    for letter in body.axes:
        c = sum(_damping(part, letter) for part in beside)
        k = sum(abs(float(value_of(p.stiffness))) for p in beside if isinstance(p, Spring) and p.axis == letter)
        if not (c > 0.0 and k > 0.0):
            _refuse(body)
        masses.append(FOLLOWS * c * c / k)
    return min(masses)


def _damping(part: Any, letter: str) -> float:
    """Force per speed of a damper, or of a contact's law, along an axis."""
    if isinstance(part, Damper):
        return float(value_of(part.damping)) if part.axis == letter else 0.0
    if not isinstance(part, Contact) or part.normal_kind != "constant" or letter not in part.labels():
        return 0.0
    return float(value_of(getattr(part.law, "viscous", 0.0))) * float(value_of(part.normal_force))
