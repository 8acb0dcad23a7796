"""The parts of a scene in which some have other values: what refers to them, and what need not be checked again."""

from __future__ import annotations

from collections.abc import Mapping
from operator import is_
from typing import TYPE_CHECKING, Any

from fricmb.scene._bodies import Body, Driven
from fricmb.scene._parameters import apply
from fricmb.scene._part import GROUND, End, Part, original_of
from fricmb.values import Declaration

if TYPE_CHECKING:
    from fricmb.scene._scene import Scene

#: Parts above which scenes keep nothing for others of their family: putting it together is little beside a run.
MANY = 500


def with_changed(scene: Scene, changed: dict[str, Part]) -> list[Part]:
    """The parts of a scene with the changed ones in their places; others refer to these."""
    parts = [changed.get(part.name, part) for part in scene.parts]
    if not any(isinstance(part, End) or hasattr(part, "dof_names") for part in changed.values()):
        return parts
    if len(parts) > MANY:
        return [part.with_ends(changed) for part in parts]
    referring = _referring(scene)
    for i in {i for name in changed for i in referring.get(name, ())}:
        parts[i] = parts[i].with_ends(changed)
    return parts


def _referring(scene: Scene) -> dict[str, tuple[int, ...]]:
    """Places of the parts that refer to each part, by its name."""
    found: dict[str, tuple[int, ...]] | None = scene._cache.get("referring")
    if found is None:
        held: dict[str, list[int]] = {}
        for i, part in enumerate(scene.parts):
            for end in part.ends():
                if end.owner is not GROUND:
                    held.setdefault(end.owner.name, []).append(i)
        found = scene._cache["referring"] = {name: tuple(places) for name, places in held.items()}
    return found


def numbers_alone(scene: Scene, changed: dict[str, Part], parts: list[Part]) -> bool:
    """Whether the parts differ from those of a scene in plain numbers: then what holds for the scene holds for them.

    Each part has been checked when it was made; names, ends and motions are those that the scene was checked with.
    """
    for old, new in zip(scene.parts, parts, strict=True):
        if new is old or original_of(old) is original_of(new):
            continue
        if new.name not in changed or not _is_numbers(old, new):
            return False
    return True


def check_values(scene: Scene, values: Mapping[str, Any]) -> None:
    """Raise what :meth:`Scene.with_parameters` would; where numbers alone change, no scene is made for that."""
    changed = apply(scene, values)
    if not _stand_alone(scene, changed):
        scene._with_parts(changed)


def stands_alone(scene: Scene, values: Mapping[str, Any]) -> bool:
    """Whether values are accepted or refused by the parts that have them, whatever values others have; checks them."""
    changed = apply(scene, values)
    return _stand_alone(scene, changed) and all(map(_is_built_in, changed.values()))


def _stand_alone(scene: Scene, changed: Mapping[str, Part]) -> bool:
    return all(_is_numbers(scene[name], part) and _leaves_others(scene, part) for name, part in changed.items())


def _is_built_in(thing: Declaration) -> bool:
    """Whether a part is of this package, and the laws that it holds are."""
    inner = [held for held in vars(thing).values() if isinstance(held, Declaration) and not held._referred]
    return type(thing).__module__.startswith("fricmb.") and all(map(_is_built_in, inner))


def _leaves_others(scene: Scene, part: Part) -> bool:
    """Whether nothing that refers to a part reads its numbers: parts of other packages may, and refuse them."""
    if not isinstance(part, End):
        return True
    kind: Any = type(part)
    if kind not in (Body, Driven) or len(scene.parts) > MANY:
        return False
    referring = [scene.parts[i] for i in _referring(scene).get(part.name, ())]
    return all(type(other).__module__.startswith("fricmb.") for other in referring)


def _is_numbers(old: Part, new: Part) -> bool:
    one: Any = type(old)
    if one is not type(new) or old.name != new.name or not new.only_numbers():
        return False
    if one is Body:
        return bool(new.axes == old.axes)  # type: ignore[attr-defined]
    if one is Driven:
        return bool(new.letters == old.letters and new.moving == old.moving)  # type: ignore[attr-defined]
    return all(map(is_, old.ends(), new.ends())) and getattr(old, "dof_names", ()) == getattr(new, "dof_names", ())
