"""What stands in brackets on an axis."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from fricmb.scene import Torque, TorsionDamper, TorsionSpring
from fricmb.solution import owner_of
from fricmb.values import Units

if TYPE_CHECKING:
    from fricmb.solution import Solution

__all__ = [
    "Units", "bare", "is_angle", "is_direction", "unit_in_scene", "unit_of", "unit_of_rate",
    "unit_of_signal",
]  # fmt: skip

#: A unit that says nothing: a plain number, or a dimension, of a scene that names no units.
_SAYS_NOTHING = re.compile(r"\s*\[(1|[^\]]*\b(?:time|length|force)\b[^\]]*|)\]")


def bare(label: str) -> str:
    """A label without brackets that say nothing: "velocity [1]", "time [time]"."""
    return _SAYS_NOTHING.sub("", label)


def is_angle(name: str) -> bool:
    """Whether a motion is a rotation: of a body in the plane, the spin of a rotor, the turns of a ball."""
    last = name.rpartition(".")[2]
    return last in ("angle", "spin") or last.startswith("turn_")


def is_direction(name: str) -> bool:
    """Whether a motion is a component of a unit vector: an axis of a body in space."""
    last = name.rpartition(".")[2]
    return last[-2:-1] == "_" and last[:-2] in ("axis", "d1", "d2", "d3")


def unit_of(name: str, units: Units) -> str:
    """Unit of a motion."""
    if is_direction(name):
        return "1"
    return ("1" if units.dimensionless else "rad") if is_angle(name) else units.length


def unit_of_rate(name: str, units: Units) -> str:
    """Unit of the rate of a motion."""
    if is_direction(name):
        return units.rate
    return units.angular_velocity if is_angle(name) else units.velocity


def unit_of_signal(sol: Solution, name: str, units: Units) -> tuple[str, str]:
    """What a signal of ``sol[name]`` is, and its unit.

    Modal coordinates are taken for lengths, which they are for shapes that are plain numbers.
    """
    return _signal(sol.scene, name, units)


def unit_in_scene(scene: Any, name: str) -> str:
    """Unit of a signal of a run of the scene; "" for what is no name of one."""
    return _signal(scene, name, scene.units)[1] if owner_of(name) or scene.has_motion(name) else ""


def _signal(scene: Any, name: str, units: Units) -> tuple[str, str]:
    owner = owner_of(name)
    if owner is None:
        return _kind(name, ("position", "angle", "axes", "modal coordinate")), unit_of(name, units)
    quantity = name[len(owner) + 1 :].partition(".")[0]
    if quantity == "velocity":
        kinds = ("velocity", "angular velocity", "rate of axes", "modal velocity")
        return _kind(owner, kinds), unit_of_rate(owner, units)
    if quantity == "acceleration":
        kinds = ("acceleration", "angular acceleration", "second rate of axes", "modal acceleration")
        rate = unit_of_rate(owner, units)
        return _kind(owner, kinds), "1" if rate == "1" else f"{rate.partition('/')[0]}/{units.time}²"
    if quantity in ("force", "normal_force"):
        turns = owner in _turning(scene)
        kind = "torque" if turns else quantity.replace("_", " ")
        return kind, units.torque if turns else units.force
    if quantity == "elongation":
        turns = owner in _turning(scene)
        return "elongation", ("1" if units.dimensionless else "rad") if turns else units.length
    if quantity == "relative_velocity":
        turns = owner in _turning(scene)
        return ("angular velocity" if turns else "relative velocity"), (
            units.angular_velocity if turns else units.velocity
        )
    return {"mode": "mode (0 stick, 1 slip, 2 open)", "state": "state of the law"}.get(quantity, quantity), ""


def _kind(motion: str, kinds: tuple[str, str, str, str]) -> str:
    """Which of four it is: of a place, an angle, a direction, a mode."""
    last = motion.rpartition(".")[2]
    modal = last.startswith("mode") and last[4:].isdigit()
    return kinds[3 if modal else 2 if is_direction(motion) else 1 if is_angle(motion) else 0]


def _turning(scene: Any) -> set[str]:
    """Parts whose force is a torque."""
    kinds = Torque | TorsionDamper | TorsionSpring
    return {part.name for part in getattr(scene, "parts", ()) if isinstance(part, kinds)}
