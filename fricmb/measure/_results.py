"""Modes that finite element programs wrote beside their matrices."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np

from fricmb._files import Output2
from fricmb.errors import FileError
from fricmb.fe import _ansys, _nastran
from fricmb.measure._op2_modes import op2_modes
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


def read_op2(path: Path, over: object) -> Measured:
    """Of a modal run of Nastran: frequencies, shapes along the axes of each node, modal masses, coordinates."""
    _nastran.library(f"measure.read of {path.name}")
    file = Output2(path)
    modes, notes = op2_modes(file)
    if not any(block.name.startswith("EQEXIN") for block in file.blocks):
        return Measured(modes=modes, notes=notes)
    points, more = _coordinates(path)
    return Measured(modes=modes, points=points, notes=(*notes, *more))


def _coordinates(path: Path) -> tuple[dict[int, Any], tuple[str, ...]]:
    """Places of nodes, where they can be understood."""
    from pyyeti.nastran.op2 import OP2

    with contextlib.redirect_stdout(io.StringIO()):
        try:
            found = OP2(str(path)).rdparampost(get_ougs=False, get_mats=False, get_dr_tables=False)
        except Exception as error:  # shapes can be read without them
            return {}, (f"coordinates of nodes are not read ({type(error).__name__})",)
    return _points(found.get("uset")), ()


def _points(uset: Any) -> dict[int, Any]:
    """Coordinates of nodes from the table of degrees of freedom, where there is one."""
    if uset is None:
        return {}
    labels = np.array([(int(node), int(dof)) for node, dof in uset.index], dtype=np.int64).reshape(-1, 2)
    rows = np.flatnonzero(labels[:, 1] == 1)
    places = uset[["x", "y", "z"]].to_numpy(dtype=float)
    return {int(labels[i, 0]): places[i] for i in rows}
