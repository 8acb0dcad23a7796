"""The parameters of a scene by name, and a scene's parts with other values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fricmb.errors import SceneError, shown, unknown_name
from fricmb.scene._expressions import expression_uses
from fricmb.scene._part import Part
from fricmb.values import is_expression, parameter, parameters_in

if TYPE_CHECKING:
    from fricmb.scene._scene import Scene


def collect(scene: Scene) -> dict[str, Any]:
    """Every number of a scene by name, part by part; named parameters once, under their own name."""
    found: dict[str, Any] = {}
    for part in scene.parts:
        for path, value in part.slots().items():
            named = list(parameters_in(value))
            found.update({p.name: p.value for p in named})
            if not named and not _holds_expression(value):
                found[f"{part.name}.{path}"] = value
    return found


def _holds_expression(value: Any) -> bool:
    entries = value if isinstance(value, tuple) else (value,)
    return any(is_expression(entry) and not expression_uses(entry).constant for entry in entries)


def apply(scene: Scene, values: Mapping[str, Any]) -> dict[str, Part]:
    """The parts that other values change, by name.

    A value for a slot that a named parameter gives detaches the slot from it.
    """
    if not isinstance(values, Mapping):
        raise SceneError(f"Scene {scene.name!r}: parameters must be a dict of name to value, got {shown(values)}")
    named = {name: value for name, value in values.items() if isinstance(name, str) and "." not in name}
    slots: dict[str, dict[str, Any]] = {}
    for name, value in values.items():
        if name in named:
            continue
        head, _, path = str(name).partition(".")
        if head not in scene or not scene[head].accepts(path):
            near = [f"{head}.{p}" for p in scene[head].settable()] if head in scene else []
            raise unknown_name(f"parameter of scene {scene.name!r}", name, dict.fromkeys([*near, *collect(scene)]))
        slots.setdefault(head, {})[path] = value
    return _changed(scene, slots, _checked(scene, named))


def _checked(scene: Scene, named: dict[str, Any]) -> dict[str, float]:
    if not named:
        return {}
    known = collect(scene)
    for name, value in named.items():
        if name not in known:
            raise unknown_name(f"parameter of scene {scene.name!r}", name, known)
        named[name] = parameter(name, value).value
    return named


def _changed(scene: Scene, slots: dict[str, dict[str, Any]], named: dict[str, float]) -> dict[str, Part]:
    if not named:
        return {name: scene[name].with_slots(entries) for name, entries in slots.items()}
    changed: dict[str, Part] = {}
    for part in scene.parts:
        new = part.with_named(named)
        if part.name in slots:
            new = new.with_slots(slots[part.name])
        if new is not part:
            changed[part.name] = new
    return changed
