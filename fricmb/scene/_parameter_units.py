"""Units of the parameters of a scene, for labels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fricmb.scene._damper import Damper
from fricmb.scene._point import PointDamper, PointSpring
from fricmb.scene._spring import Spring
from fricmb.values import Units

if TYPE_CHECKING:
    from fricmb.scene._scene import Scene

#: Fields that mean the same wherever they stand: length, time and force to these powers.
_POWERS = {
    "mass": (-1, 2, 1), "position": (1, 0, 0), "length": (1, 0, 0), "preload": (0, 0, 1), "normal_force": (0, 0, 1),
    "v_s": (1, -1, 0), "v_t": (1, -1, 0), "v_reg": (1, -1, 0), "v_0": (1, -1, 0), "v_m": (1, -1, 0),
    "sigma0": (-1, 0, 0), "sigma1": (-1, 1, 0), "sigma2": (-1, 1, 0), "viscous": (-1, 1, 0), "delta": (-1, 1, 0),
    "decay": (-1, 1, 0), "N_0": (0, 0, 1),
}  # fmt: skip
#: Those of springs and dampers along a line.
_ALONG = {"stiffness": (-1, 0, 1), "damping": (-1, 1, 1), "cubic": (-3, 0, 1)}
_RAISED = {1: "", 2: "²", 3: "³"}


def parameter_unit(scene: Scene, name: str) -> str:
    """Unit of a parameter, or of the speed of a motion; "" where it has none or it is not known."""
    units = scene.units
    if units.dimensionless or units == Units():
        return ""
    owner, _, rest = name.partition(".")
    words = rest.split(".")
    if scene.has_motion(name):
        return units.velocity  # a speed that an analysis holds
    part = next((part for part in scene.parts if part.name == owner), None)
    if isinstance(part, Spring | Damper | PointSpring | PointDamper) and words[-1] in _ALONG:
        return _written(units, _ALONG[words[-1]])
    if words[0] == "velocity" and words[-1] in "xyz":
        return units.velocity
    if words[0] == "position" and words[-1] not in "xyz":
        return ""
    found = _POWERS.get(words[-1]) or _POWERS.get(words[0])
    return "" if found is None else _written(units, found)


def _written(units: Units, powers: tuple[int, int, int]) -> str:
    """Powers of length, time and force as a unit: "N s/m"."""
    if powers == _POWERS["mass"] and (units.length, units.time, units.force) == ("m", "s", "N"):
        return "kg"
    named = list(zip((units.force, units.time, units.length), (powers[2], powers[1], powers[0]), strict=True))
    above = " ".join(f"{unit}{_RAISED[n]}" for unit, n in named if n > 0)
    below = " ".join(f"{unit}{_RAISED[-n]}" for unit, n in named if n < 0)
    return f"{above or '1'}/{below}" if below else above
