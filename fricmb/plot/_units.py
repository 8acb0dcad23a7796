"""What stands in brackets on an axis."""

from __future__ import annotations

from fricmb.values import DIMENSIONS, Units

#: Labels for a scene whose units are not known.
SCENE_UNITS = DIMENSIONS

__all__ = ["SCENE_UNITS", "Units", "is_angle", "is_direction", "unit_of", "unit_of_rate"]


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
