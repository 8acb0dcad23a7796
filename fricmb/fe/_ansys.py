"""Matrices of Ansys: the ``.full`` file, by ansys-mapdl-reader (extra ``ansys``)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fricmb.errors import FileError, MissingExtraError


def read(path: Path, names: Mapping[str, str] | None) -> dict[str, Any]:
    """Upper triangles of M and K, numbers of nodes, and which degrees of freedom are fixed."""
    library = reader(f"fe.read of {path.name}")
    full = library.read_binary(str(path))
    if not hasattr(full, "load_km"):
        raise FileError(f"{path}: expected a file of assembled matrices (.full), got results")
    places, K, M = full.load_km(as_sparse=True, sort=False)
    if places[:, 1].max() > 5:
        raise FileError(f"{path}: expected displacements and rotations, got degree of freedom {places[:, 1].max()}")
    labels = np.column_stack([places[:, 0], places[:, 1] + 1]).astype(np.int64)
    held = np.asarray(full.const)
    fixed = np.flatnonzero(held) if held.dtype == bool else held
    if fixed.ndim == 2:  # (node, dof from 0)
        fixed = np.column_stack([fixed[:, 0], fixed[:, 1] + 1])
    return {"M": M, "K": K, "labels": labels, "fixed": fixed if fixed.size else None}


def reader(what: str) -> Any:
    """The library."""
    try:
        from ansys.mapdl import reader as library
    except ImportError:
        raise MissingExtraError(what, "ansys-mapdl-reader", "ansys") from None
    return library
