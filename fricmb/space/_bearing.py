"""What the ends of a bearing bear: two forces a length apart."""

from __future__ import annotations

from typing import Any


def lever(torque: Any, length: Any) -> Any:
    """The force of a couple ``length`` apart; of length 0 none: there the torque brings no friction."""
    import sympy

    return sympy.Piecewise((torque / sympy.Max(length, sympy.Float("1e-300")), length > 0), (0, True))


def end_forces(force: tuple[Any, Any], torque: tuple[Any, Any], length: Any) -> list[tuple[Any, Any]]:
    """``F/2 +- M x e/length`` along two directions u, w across the axis e = u x w: at the front end and the rear."""
    across = (torque[1], -torque[0])
    return [
        (force[0] / 2 + sign * lever(across[0], length), force[1] / 2 + sign * lever(across[1], length))
        for sign in (1, -1)
    ]
