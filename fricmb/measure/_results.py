"""Modes that finite element programs wrote beside their matrices."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fricmb.errors import FileError
from fricmb.fe import _ansys
from fricmb.measure._types import Measured, Modes


def read_rst(path: Path, over: tuple[float, float] | str | None) -> Measured:
    """Of a modal run of Ansys: frequencies, shapes of unit modal mass, coordinates."""
    result = _ansys.reader(f"measure.read of {path.name}").read_binary(str(path))
    if not hasattr(result, "nodal_solution"):
        raise FileError(f"{path}: expected results of a modal run (.rst), got matrices")
    hertz = np.asarray(result.time_values, dtype=float)
    shapes = []
    for i in range(hertz.size):
        nodes, shape = result.nodal_solution(i)
        shapes.append(shape[:, : 6 if shape.shape[1] >= 6 else 3])
    places = dict(zip(result.mesh.nnum.tolist(), np.asarray(result.mesh.nodes)[:, :3], strict=True))
    modes = Modes(
        frequencies=2.0 * np.pi * hertz,
        damping_ratios=np.zeros(hertz.size),
        masses=np.ones(hertz.size),
        nodes=np.asarray(nodes, dtype=np.int64),
        shapes=np.array(shapes),
    )
    return Measured(modes=modes, points=places)
