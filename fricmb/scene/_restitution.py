"""Coefficients of restitution as arguments of parts."""

from __future__ import annotations

from typing import Any

from fricmb.scene._part import Part
from fricmb.values import value_of


def check_restitution(part: Part, argument: str, value: Any, *, least: float = 0.0) -> None:
    """Settle a coefficient from ``least`` to 1, or refuse it by name."""
    found = part._number(argument, value)
    if not least <= float(value_of(found)) <= 1.0:
        part._refuse(argument, value, f"a number from {least:g} to 1")
    part._set(argument, found)
