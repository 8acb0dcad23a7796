"""Checks that need the whole scene."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from fricmb.errors import SceneError, UnknownNameError, shown, unknown_name
from fricmb.scene._expressions import Uses
from fricmb.scene._impact_law import check_impact_law
from fricmb.scene._matrix import MatrixElement
from fricmb.scene._part import GROUND, End, Ground, Part
from fricmb.scene._space_body import SpaceBody
from fricmb.scene._turning import Gravity, PlaneDefault

if TYPE_CHECKING:
    from fricmb.scene._scene import Scene


def check_scene(scene: Scene) -> None:
    """Names, references, motions in expressions, named parameters."""
    label = f"Scene {scene.name!r}"
    for part in scene.parts:
        if not isinstance(part, Part) or isinstance(part, Ground):
            raise SceneError(f"{label}: parts must hold parts (Body, Spring, Contact, ...), got {shown(part)}")
    held = {part.name: part for part in scene.parts}
    if len(held) < len(scene.parts):
        name, _ = Counter(part.name for part in scene.parts).most_common(1)[0]
        raise SceneError(f"{label}: the name {name!r} is used twice; names must be unique")
    if not scene.dof_names:
        raise SceneError(f"{label}: parts must hold at least one Body or ModalBody")
    for part in scene.parts:
        for end in part.ends():
            if held.get(end.owner.name) is not end.owner:
                _check_end(scene, part, end, label)
    if any(isinstance(part, SpaceBody) for part in scene.parts):
        _check_gravity(scene)
    check_impact_law(scene)
    values: dict[str, float] = {}
    for part in scene.parts:
        uses = part.uses()
        if uses or isinstance(part, MatrixElement):
            _check_motions(scene, part, uses)
            _check_parameters(part, uses, values, label)


def _check_gravity(scene: Scene) -> None:
    """In space nobody can guess which way is down."""
    for part in scene.parts:
        if isinstance(part, Gravity) and isinstance(part.acceleration, PlaneDefault):
            raise SceneError(
                f"{part._label()}: in a scene with bodies in space acceleration has to be given, such as"
                " {'z': -9.81}"
            )


def _check_end(scene: Scene, part: Part, end: End, label: str) -> None:
    owner = end.owner
    if owner is GROUND:
        return
    if owner.name not in scene:
        error = unknown_name(f"end of {part._label()}", end.end_name, [p.name for p in scene.bodies + scene.driven])
        raise UnknownNameError(f"{label}: {error}; every body must be among the parts of the scene")
    if scene[owner.name] != owner:
        raise SceneError(f"{label}: {part._label()} refers to another {owner.name!r} than the one among the parts")


def _check_motions(scene: Scene, part: Part, all_uses: dict[str, Uses]) -> None:
    if isinstance(part, MatrixElement):
        dofs = set(scene.dof_names)
        for name in part.dofs:
            if name not in dofs:
                raise unknown_name(f"degree of freedom in dofs of {part._label()}", name, scene.dof_names)
        return
    for path, uses in all_uses.items():
        for name in uses.motions:
            if not scene.has_motion(name):
                raise unknown_name(f"motion in {path} of {part._label()}", name, scene.motion_names)


def _check_parameters(part: Part, all_uses: dict[str, Uses], values: dict[str, float], label: str) -> None:
    for uses in all_uses.values():
        for parameter in uses.parameters:
            if values.setdefault(parameter.name, parameter.value) != parameter.value:
                raise SceneError(
                    f"{label}: parameter {parameter.name!r} has two values, {values[parameter.name]!r} and"
                    f" {parameter.value!r} (in {part._label()})"
                )
