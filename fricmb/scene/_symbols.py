"""The symbols of scene expressions: time, coordinates, speeds."""

from __future__ import annotations

from typing import Any

from fricmb._calls import answers
from fricmb.errors import SceneError, shown


@answers
def coordinate(name: str) -> Any:
    """SymPy symbol of a coordinate, for expressions of forces and normal forces.

    Parameters
    ----------
    name : str
        A dof ("pad.x"), a point of a modal body ("plate.tip.x") or a driven body ("belt.x").
    """
    from fricmb.values import _symbols

    return _symbols.coordinate(_motion(name, "coordinate"))


@answers
def speed(name: str) -> Any:
    """SymPy symbol of the velocity of a dof, point or driven body; names as in :func:`coordinate`."""
    from fricmb.values import _symbols

    return _symbols.speed(_motion(name, "speed"))


def time() -> Any:
    """SymPy symbol of time (``fm.t``)."""
    from fricmb.values import _symbols

    return _symbols.TIME


def _motion(name: object, what: str) -> str:
    if not isinstance(name, str) or "." not in name or name.startswith(".") or name.endswith("."):
        raise SceneError(f"{what}: name must be 'body.axis' or 'body.point.axis', got {shown(name)}")
    return name
