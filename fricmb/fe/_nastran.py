"""Matrices of Nastran: OUTPUT4, op2 and DMIG, by pyyeti (extra ``nastran``)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from fricmb._files import Block, Output2, op4_fits
from fricmb.errors import FileError, MissingExtraError, unknown_name

#: Names of mass, stiffness, viscous and structural damping, for each ending such as "xx", "aa", "gg", "aax".
NAMES = {"M": "m", "K": "k", "C": "b", "H": "k4"}


def read(path: Path, names: Mapping[str, str] | None) -> dict[str, Any]:
    """Matrices, and where an ``.asm`` file or DMIG says so the nodes of the boundary and their axes."""
    library(f"fe.read of {path.name}")
    ending = path.suffix.lower()
    labels: Any = None
    if ending in (".pch", ".dmig", ".bdf", ".dat"):
        matrices, labels = _dmig(path)
    else:
        matrices = _op2(path) if ending == ".op2" else _op4(path)
    found = _named(path, matrices, names)
    n = found["M"].shape[0]
    fields: dict[str, Any] = {**found, "labels": labels}
    if labels is None:
        boundary = _boundary(found["K"])
        fields |= {"boundary": boundary} | _assembly(path, n, boundary)
    return fields


def library(what: str) -> Any:
    """The part of pyyeti that reads Nastran."""
    try:
        with np.printoptions():  # pyyeti changes how arrays print
            from pyyeti import nastran
    except ImportError:
        raise MissingExtraError(what, "pyyeti", "nastran") from None
    return nastran


def _op4(path: Path) -> dict[str, Any]:
    from pyyeti.nastran import op4

    op4_fits(path)
    try:
        found = op4.read(str(path), sparse=True)  # what a matrix announces is not allocated
    except Exception as error:
        raise FileError(f"{path}: expected matrices of OUTPUT4 ({type(error).__name__}: {error})") from error
    if not found:
        raise FileError(f"{path}: expected matrices of OUTPUT4, found none")
    return {key.lower(): value for key, value in found.items()}


def _op2(path: Path) -> dict[str, Any]:
    file = Output2(path)
    found = {block.name.lower(): _matrix(file, block) for block in file.blocks if block.is_matrix}
    if not found:
        raise FileError(f"{path}: expected matrices, found results alone (modes: fm.measure.read)")
    return found


#: Kinds of numbers of a matrix, by what its trailer says: single and double precision, real and complex.
_KINDS = {1: ("f4", 1), 2: ("f8", 1), 3: ("f4", 2), 4: ("f8", 2)}


def _matrix(file: Output2, block: Block) -> Any:
    """Columns of an op2, sparse: pieces of rows that follow one another."""
    _, columns, rows, _, kind, *_ = (*block.trailer, *[0] * 5)
    if kind not in _KINDS or len(block.records) != columns or rows < 0:
        got = f"{len(block.records)} columns of kind {kind}"
        raise FileError(f"{file.path}: matrix {block.name}: expected {columns} columns of kind 1 to 4, got {got}")
    number, parts = _KINDS[kind]
    number = "f8" if file.word == 8 else number
    places, starts, values = [np.zeros(0, dtype=np.int64)], [0], [np.zeros(0)]
    for column in block.records:
        for piece in column:
            row, part = file.split(piece, number)
            part = part if parts == 1 else part[::2] + 1j * part[1::2]
            if not 0 < row <= rows + 1 - part.size:
                last = row + part.size - 1
                raise FileError(f"{file.path}: matrix {block.name}: rows {row} to {last} of {rows} are announced")
            places.append(np.arange(row - 1, row - 1 + part.size))
            values.append(part)
        starts.append(starts[-1] + sum(part.size for part in values[len(values) - len(column) :]))
    return scipy.sparse.csc_array(
        (np.concatenate(values), np.concatenate(places), np.array(starts)), shape=(rows, columns)
    )


def _dmig(path: Path) -> tuple[dict[str, Any], Any]:
    """DMIG entries, over all rows that any of them names."""
    found = library(f"fe.read of {path.name}").rddmig(str(path), square=True)
    if not found:
        raise FileError(f"{path}: expected DMIG entries, found none")
    every = sorted({(int(a), int(b)) for frame in found.values() for a, b in frame.index})
    place = {label: i for i, label in enumerate(every)}
    if not path.read_bytes().endswith(b"\n"):
        raise FileError(f"{path}: its last line is cut off")
    matrices = {}
    for key, frame in found.items():
        if not frame.to_numpy().any():
            raise FileError(f"{path}: {key}: expected entries, found none; the file is cut off")
        at = np.array([place[int(a), int(b)] for a, b in frame.index])
        matrices[key.lower()] = np.zeros((len(every), len(every)), dtype=frame.to_numpy().dtype)
        matrices[key.lower()][np.ix_(at, at)] = frame.to_numpy()
    return matrices, np.array(every, dtype=np.int64)


def _named(path: Path, matrices: dict[str, Any], names: Mapping[str, str] | None) -> dict[str, Any]:
    """M, K, C, H and parts, by the names given or those that Nastran gives."""
    if names is not None:
        for wanted in names.values():
            if wanted.lower() not in matrices:
                raise FileError(f"{path}: {unknown_name('matrix', wanted, matrices)}")
        found = {key: matrices[wanted.lower()] for key, wanted in names.items()}
        for key in ("M", "K"):
            if key not in found:
                raise FileError(f"{path}: names must say which matrix is {key}")
        own = {key: found.pop(key) for key in NAMES if key in found}
        return {**own, "parts": found}
    for key in matrices:
        ending = re.fullmatch(r"k([a-z]{2,3})", key)
        if ending and f"m{ending[1]}" in matrices:
            shape = matrices[key].shape
            held = {name: matrices.get(start + ending[1]) for name, start in NAMES.items()}
            return {name: value for name, value in held.items() if value is not None and value.shape == shape}
    there = ", ".join(list(matrices)[:12])
    raise FileError(
        f"{path}: expected a pair such as mxx and kxx, found {there}; say which by names={{'M': ..., 'K': ...}}"
    )


def _boundary(K: Any) -> int | None:
    """How many rows come before the modal ones of a superelement, which K ties to nothing; None if there are none."""
    size = abs(scipy.sparse.csr_array(K))
    ties = size - scipy.sparse.diags_array(size.diagonal())
    alone = (ties.max(axis=1).toarray().ravel() if ties.nnz else np.zeros(ties.shape[0])) <= 1e-12 * size.max()
    modal = int(np.argmin(alone[::-1])) if not alone.all() else 0
    return alone.size - modal if modal else None


def _assembly(path: Path, n: int, boundary: int | None) -> dict[str, Any]:
    """Labels, coordinates and axes from the ``.asm`` file of an external superelement, where there is one."""
    files = [path.with_suffix(".asm"), *sorted(path.parent.glob(f"*_{path.stem}.asm"))]
    file = next((file for file in files if file.exists()), None)
    if file is None:
        return {}
    nastran = library("fe.read")
    try:
        grids = nastran.bulk2uset(str(file))[0]
        scalars = np.atleast_1d(nastran.rdspoints(str(file)))
    except Exception as error:
        raise FileError(f"{file}: expected GRID and SPOINT entries ({type(error).__name__}: {error})") from error
    table, index = grids.iloc[:, 1:].to_numpy(dtype=float), grids.index.to_list()
    labels = [(int(node), int(dof)) for node, dof in index] + [(int(node), 0) for node in scalars]
    if len(labels) != n:
        raise FileError(f"{file}: names {len(labels)} degrees of freedom, {path.name} has {n}")
    coordinates, frames = {}, {}
    for start in range(0, len(table), 6):
        node = int(index[start][0])
        coordinates[node] = table[start]
        frames[node] = table[start + 3 : start + 6].T  # columns are the axes
    return {
        "labels": np.array(labels, dtype=np.int64),
        "coordinates": coordinates,
        "frames": frames,
        "boundary": len(index),
        "notes": (f"numbers of nodes and axes from {file.name}",),
    }
