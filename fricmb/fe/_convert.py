"""A model in other units."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse

from fricmb.errors import SceneError
from fricmb.fe._units import factors

if TYPE_CHECKING:
    from fricmb.fe._model import FEModel


def convert(fe: FEModel, units: str) -> FEModel:
    """See :meth:`FEModel.in_units`.

    Displacements are counted in lengths, rotations and coordinates without nodes in none: entries of K are energies
    over the squares of these, those of C and M have one and two units of time more.
    """
    label = fe._label()
    if fe.units is None:
        raise SceneError(f"{label}: its units are not known; give units= when it is read or made")
    mass, length, time = (a / b for a, b in zip(factors(label, fe.units), factors(label, units), strict=True))
    size = np.full(fe.n, length)
    if fe.labels is not None:
        size[(fe.labels[:, 1] == 0) | (fe.labels[:, 1] > 3)] = 1.0
    side = scipy.sparse.diags_array(1.0 / size, format="csr")
    energy = mass * length**2 / time**2

    def scaled(matrix: Any, power: int) -> Any:
        return None if matrix is None else energy * time**power * (side @ matrix @ side)

    power = {key: (1 if part_target(key) == "C" else 2 if part_target(key) == "M" else 0) for key in fe.parts}
    return replace(
        fe,
        M=scaled(fe.M, 2),
        K=scaled(fe.K, 0),
        C=scaled(fe.C, 1),
        H=scaled(fe.H, 0),
        parts={key: scaled(matrix, power[key]) for key, matrix in fe.parts.items()},
        coordinates={node: length * at for node, at in fe.coordinates.items()},
        triangles=dict.fromkeys(fe.parts, "full"),
        units=units,
    )


def part_target(name: str) -> str:
    """Where a part belongs by its first letter: M to the mass, K to the stiffness, C, D and G to the damping.

    Raises
    ------
    SceneError
        For another letter.
    """
    found = {"M": "M", "K": "K", "C": "C", "D": "C", "G": "C"}.get(name[:1].upper())
    if found is None:
        raise SceneError(
            f"part {name!r}: its name must begin with K (stiffness), C, D or G (damping) or M (mass), which says where"
            " it belongs"
        )
    return found
