"""Measurements in other units: those that a universal file states, by its factors of length and force."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fricmb.errors import SceneError
from fricmb.fe._units import factors

if TYPE_CHECKING:
    from fricmb.measure._types import Measured

#: What is measured, as powers of length and force; times are in seconds in every file.
POWERS = {
    "displacement": (1, 0), "velocity": (1, 0), "acceleration": (1, 0), "force": (0, 1),
    "receptance": (1, -1), "mobility": (1, -1), "accelerance": (1, -1),
}  # fmt: skip


def in_units(found: Measured, units: str) -> Measured:
    """See :meth:`Measured.in_units`."""
    if not {"length", "force"} <= found.units.keys():
        raise SceneError(
            "Measured.in_units: the file does not state its units; say them first:"
            " dataclasses.replace(found, units={'length': 1000.0, 'force': 1.0}) for mm and N"
        )
    mass, length, time = factors("Measured.in_units", units)
    if time != 1.0:
        raise SceneError(f"Measured.in_units: units must have seconds, as files of measurements have; got {units!r}")
    # one unit of the file in those wanted
    of_length = 1.0 / (found.units["length"] * length)
    of_force = 1.0 / (found.units["force"] * mass * length)
    sizes = {key: of_length**a * of_force**b for key, (a, b) in POWERS.items()}
    modes = found.modes
    if modes is not None:
        # shapes count displacements in one another; rotations are angles by lengths
        turned = np.r_[np.ones(3), np.full(modes.shapes.shape[2] - 3, 1.0 / of_length)]
        modes = replace(modes, masses=modes.masses * (of_force / of_length), shapes=modes.shapes * turned)
    unknown = sum(not x.quantity for x in found.signals) + sum(not x.kind for x in found.frfs)
    note = f"{unknown} signals or responses keep their units, since the file does not state their quantities"
    return replace(
        found,
        signals=tuple(replace(x, y=x.y * sizes.get(x.quantity, 1.0), unit=_label(x, sizes)) for x in found.signals),
        frfs=tuple(replace(x, values=x.values * sizes.get(x.kind, 1.0), unit=_label(x, sizes)) for x in found.frfs),
        modes=modes,
        points={node: np.asarray(at) * of_length for node, at in found.points.items()},
        units={"length": 1.0 / length, "force": 1.0 / (mass * length)},
        notes=(*found.notes, *([note] if unknown else [])),
    )


def _label(held: object, sizes: Mapping[str, float]) -> str:
    """The unit that a file names, where it stays; a name of another unit would be wrong."""
    changed = sizes.get(getattr(held, "quantity", "") or getattr(held, "kind", ""), 1.0) != 1.0
    return "" if changed else str(getattr(held, "unit", ""))
