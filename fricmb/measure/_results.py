"""Modes that finite element programs wrote beside their matrices."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np

from fricmb.errors import FileError
from fricmb.fe import _ansys, _nastran
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
    from pyyeti.nastran.op2 import OP2

    with contextlib.redirect_stdout(io.StringIO()):
        file = OP2(str(path))
        tables = [name for name in file.dbnames if name.startswith(("OUG", "BOPHIG"))]
        try:
            found = file.rdparampost(get_ougs=True, get_mats=False, get_dr_tables=False)
        except Exception as error:
            there = ", ".join(list(file.dbnames)[:12])
            words = f"({type(error).__name__}: {error})"
            raise FileError(f"{path}: expected LAMA and OUG of a modal run among {there} {words}") from error
    table = next((found[name.lower()] for name in tables if name.lower() in found), None)
    lama = np.atleast_2d(np.asarray(found.get("lama", np.zeros((0, 7)))))
    if table is None or not len(lama):
        there = ", ".join(list(file.dbnames)[:12])
        raise FileError(f"{path}: expected frequencies (LAMA) and real modes (OUG, SOL 103), found {there}")
    if table.shape[1] != len(lama):
        raise FileError(f"{path}: expected {len(lama)} shapes, as many as frequencies; got {table.shape[1]}")
    labels = np.array([(int(node), int(dof)) for node, dof in table.index], dtype=np.int64)
    plain = (labels[:, 1] >= 1) & (labels[:, 1] <= 6)
    nodes = np.unique(labels[plain, 0])
    shapes = np.full((len(lama), nodes.size, 6), np.nan)
    shapes[:, np.searchsorted(nodes, labels[plain, 0]), labels[plain, 1] - 1] = table.to_numpy()[plain].T
    # of a free structure eigenvalues round 0 may be negative
    modes = Modes(
        frequencies=np.sqrt(np.maximum(lama[:, 2], 0.0)),
        damping_ratios=np.zeros(len(lama)),
        masses=lama[:, 5],
        nodes=nodes,
        shapes=shapes,
        round_off=float(np.finfo(np.float32).eps),
    )
    return Measured(modes=modes, points=_points(found.get("uset")))


def _points(uset: Any) -> dict[int, Any]:
    """Coordinates of nodes from the table of degrees of freedom, where there is one."""
    if uset is None:
        return {}
    labels = np.array([(int(node), int(dof)) for node, dof in uset.index], dtype=np.int64).reshape(-1, 2)
    rows = np.flatnonzero(labels[:, 1] == 1)
    places = uset[["x", "y", "z"]].to_numpy(dtype=float)
    return {int(labels[i, 0]): places[i] for i in rows}
