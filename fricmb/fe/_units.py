"""Systems of units of finite element programs: "t-mm-s" and their like."""

from __future__ import annotations

from fricmb.errors import SceneError, shown

#: In kilograms, metres, seconds.
MASS = {"kg": 1.0, "g": 1e-3, "t": 1e3, "lb": 0.45359237, "slug": 14.593902937206364, "slinch": 175.12683524647636}
LENGTH = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": 0.0254, "ft": 0.3048}
TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6}


def factors(label: str, units: object) -> tuple[float, float, float]:
    """One unit of mass, length and time in kilograms, metres and seconds.

    Raises
    ------
    SceneError
    """
    text = "kg-m-s" if units == "SI" else units
    parts = text.split("-") if isinstance(text, str) else []
    if len(parts) != 3 or parts[0] not in MASS or parts[1] not in LENGTH or parts[2] not in TIME:
        raise SceneError(
            f"{label}: units must be 'SI' or mass-length-time such as 't-mm-s' (masses {', '.join(MASS)}; lengths"
            f" {', '.join(LENGTH)}; times {', '.join(TIME)}), got {shown(units)}"
        )
    return MASS[parts[0]], LENGTH[parts[1]], TIME[parts[2]]
