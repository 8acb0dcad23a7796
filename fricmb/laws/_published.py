"""Laws and models that installed packages publish."""

from __future__ import annotations

from typing import Any


def published(group: str) -> tuple[dict[str, Any], dict[str, str]]:
    """Objects that installed packages publish under an entry point group, by name, and why others cannot be used.

    Groups are ``fricmb.friction_laws`` (subclasses of FrictionLaw) and ``fricmb.models`` (functions that return a
    Scene).
    """
    from importlib.metadata import entry_points

    found: dict[str, Any] = {}
    broken: dict[str, str] = {}
    for point in sorted(entry_points(group=group), key=lambda point: point.name):
        package = point.dist.name if point.dist is not None else "an unknown package"
        try:
            held = point.load()
            _check(group, held)
        except Exception as error:  # whatever somebody else's import raises
            broken[point.name] = f"{point.value} of {package}: {type(error).__name__}: {error}"
        else:
            found[point.name] = held
    return found, broken


def _check(group: str, held: Any) -> None:
    from fricmb.laws._base import FrictionLaw

    if group == "fricmb.friction_laws" and not (isinstance(held, type) and issubclass(held, FrictionLaw)):
        raise TypeError(f"expected a subclass of fricmb.FrictionLaw, got {held!r}")
    if not callable(held):
        raise TypeError(f"expected a function that returns a Scene, got {held!r}")
