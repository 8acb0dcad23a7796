"""Matrices of Abaqus in text: ``*SUBSTRUCTURE MATRIX OUTPUT`` and ``*MATRIX GENERATE``."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io
import scipy.sparse

from fricmb._files import text_of
from fricmb.errors import FileError
from fricmb.fe import _named

#: What ``*MATRIX GENERATE`` adds to the name of the job.
GENERATED = {"STIF": "K", "MASS": "M", "DMPV": "C", "DMPS": "H"}
_JOB = re.compile(r"(.*)_(STIF|MASS|DMPV|DMPS)(\d+)$")
#: Blocks of ``*MATRIX, TYPE=``.
TYPES = {"STIFFNESS": "K", "MASS": "M", "VISCOUS DAMPING": "C", "STRUCTURAL DAMPING": "H"}


def stem(path: Path) -> Path:
    """What files of one job have in common."""
    match = _JOB.match(path.stem)
    return path.with_name(match[1] + match[3]) if match else path


def read(path: Path, names: Mapping[str, str] | None) -> dict[str, Any]:
    """Of a substructure, or of all files of ``*MATRIX GENERATE`` beside each other."""
    match = _JOB.match(path.stem)
    if match is not None:
        return _generated(path, match)
    lines = _lines(path)
    if lines and lines[0].startswith("%%MatrixMarket"):
        raise FileError(
            f"{path}: a Matrix Market file holds one matrix; read the model by fe.read({{'M': ..., 'K': ...}})"
        )
    return _substructure(path, lines)


def _lines(path: Path) -> list[str]:
    text = text_of(path, "a text file of Abaqus")
    if not text.endswith("\n"):
        raise FileError(f"{path}: its last line is cut off")
    return text.splitlines()


# ---- substructures


def _substructure(path: Path, lines: list[str]) -> dict[str, Any]:
    nodes: list[int] = []
    dofs: dict[int, list[int]] = {}
    matrices: dict[str, tuple[int, list[str], bool]] = {}
    whole = False
    for at, head, block in _blocks(lines):
        words = [word.strip() for word in head.lstrip("*").upper().split(",")]
        if words[0] == "USER ELEMENT":
            nodes, dofs = _element(path, at, words, block)
            whole = "UNSYMM" in words or "UNSYM" in words
        elif words[0] == "MATRIX":
            kind = next((word.split("=")[1].strip() for word in words if word.startswith("TYPE")), "")
            if kind not in TYPES:
                raise FileError(f"{path}: line {at}: expected *MATRIX, TYPE= {', '.join(TYPES)}, got {head[:60]!r}")
            matrices[TYPES[kind]] = (
                at,
                [line for line in block if not line.startswith("**")],
                whole and kind == "STIFFNESS",
            )
    if not nodes or "K" not in matrices or "M" not in matrices:
        raise FileError(
            f"{path}: expected *USER ELEMENT and *MATRIX of stiffness and mass, as Abaqus writes substructures"
        )
    labels = [(node, dof) for i, node in enumerate(nodes, 1) for dof in dofs[max(k for k in dofs if k <= i)]]
    if max(dof for _, dof in labels) > 6:
        raise FileError(f"{path}: expected displacements and rotations, dofs 1 to 6; got {max(d for _, d in labels)}")
    found = {key: _numbers(path, key, len(labels), *held) for key, held in matrices.items()}
    return {**found, "labels": np.array(labels, dtype=np.int64)}


def _blocks(lines: list[str]) -> Iterator[tuple[int, str, list[str]]]:
    """Keyword lines with their number, and the lines below each."""
    starts = [i for i, line in enumerate(lines) if line.startswith("*") and not line.startswith("**")]
    for a, b in zip(starts, [*starts[1:], len(lines)], strict=True):
        yield a + 1, lines[a], lines[a + 1 : b]


def _element(path: Path, at: int, words: list[str], block: list[str]) -> tuple[list[int], dict[int, list[int]]]:
    """Numbers of the nodes, and degrees of freedom from the k-th node on."""
    texts = [line.lstrip("*").strip() for line in block if line.startswith("**") and "NODES" not in line.upper()]
    rows = [line for line in block if not line.startswith("*") and line.strip()]
    try:
        count = next(int(word.split("=")[1]) for word in words if word.startswith("NODES"))
        nodes = [int(word) for text in texts for word in text.split(",") if word.strip()]
        lists = [[int(word) for word in row.split(",") if word.strip()] for row in rows]
        dofs = {1: lists[0]} | {numbers[0]: numbers[1:] for numbers in lists[1:]}
    except (ValueError, StopIteration, IndexError):
        raise FileError(f"{path}: line {at}: expected numbers of nodes and their degrees of freedom") from None
    if len(nodes) != count:
        raise FileError(f"{path}: line {at}: expected {count} numbers of nodes, got {len(nodes)}")
    return nodes, dofs


def _numbers(path: Path, name: str, n: int, at: int, rows: list[str], whole: bool) -> Any:
    try:
        values = np.array(" ".join(rows).replace(",", " ").split(), dtype=float)
    except ValueError as error:
        raise FileError(f"{path}: matrix at line {at}: expected numbers ({error})") from error
    expected = n * n if whole else n * (n + 1) // 2
    if values.size != expected:
        shape = f"all of {n} rows" if whole else f"the lower triangle of {n} rows"
        raise FileError(f"{path}: matrix at line {at}: expected {expected} numbers, {shape}; got {values.size}")
    if whole:
        return values.reshape(n, n)
    matrix = np.zeros((n, n))
    matrix[np.tril_indices(n)] = values
    return matrix + np.tril(matrix, -1).T


# ---- *MATRIX GENERATE


def _generated(path: Path, match: re.Match[str]) -> dict[str, Any]:
    """All matrices of one job: lines ``node, dof, node, dof, value`` or ``row column value``."""
    files = {key: path.with_name(f"{match[1]}_{mark}{match[3]}{path.suffix}") for mark, key in GENERATED.items()}
    entries = {key: _entries(file) for key, file in files.items() if file.exists()}
    for key in ("M", "K"):
        if key not in entries:
            raise FileError(f"{path}: expected {files[key].name} beside it")
    widths = {held.shape[1] for held in entries.values()}
    if len(widths) > 1:
        raise FileError(f"{path}: files of one job are in different formats ({widths} columns)")
    labelled = widths == {5}
    index: dict[tuple[int, int], int] = {}
    if labelled:
        ends = np.unique(np.vstack([held[:, at : at + 2] for held in entries.values() for at in (0, 2)]), axis=0)
        index = {(int(node), int(dof)): i for i, (node, dof) in enumerate(ends)}
    n = len(index) if labelled else int(max(held[:, :2].max() for held in entries.values()))
    if n > _named.MOST:
        raise FileError(f"{path}: {n} rows are more than any model has")
    _complete(files["K"], entries, labelled)
    found: dict[str, Any] = {}
    for key, held in entries.items():
        if labelled:
            rows, columns = ([index[int(a), int(b)] for a, b in held[:, at : at + 2]] for at in (0, 2))
        else:
            rows, columns = (held[:, :2].T - 1).astype(np.int64).tolist()
        found[key] = scipy.sparse.csr_array((held[:, -1], (rows, columns)), shape=(n, n))
    if labelled:
        found["labels"] = np.array(list(index), dtype=np.int64)
    return found


def _complete(path: Path, entries: dict[str, Any], labelled: bool) -> None:
    """Refuse a stiffness without a diagonal entry in a row that another matrix has."""
    width = 2 if labelled else 1
    held = entries["K"]
    there = {tuple(row[:width]) for row in held[(held[:, :width] == held[:, width : 2 * width]).all(axis=1)]}
    for matrix in entries.values():
        for row in map(tuple, matrix[:, :width]):
            if row not in there:
                name = " ".join(f"{x:g}" for x in row)
                raise FileError(f"{path}: row {name} has no diagonal entry: the file is cut off, or of another model")


def _entries(path: Path) -> Any:
    rows = [line.replace(",", " ") for line in _lines(path) if line.strip() and not line.startswith(("*", "%"))]
    if not rows:
        raise FileError(f"{path}: expected lines of node, dof, node, dof, value, found none")
    try:
        entries = np.loadtxt(rows, dtype=float, ndmin=2)
    except ValueError as error:
        raise FileError(f"{path}: expected lines of node, dof, node, dof, value ({error})") from error
    if entries.shape[0] == 0 or entries.shape[1] not in (3, 5):
        raise FileError(f"{path}: expected lines of node, dof, node, dof, value or of row, column, value")
    places = entries[:, :-1]
    least = 1 if entries.shape[1] == 3 else -np.inf  # Abaqus numbers inner nodes below 0
    if (places != np.round(places)).any() or (places < least).any():
        line = int(np.argmax((places != np.round(places)).any(axis=1) | (places < least).any(axis=1))) + 1
        raise FileError(f"{path}: entry {line}: expected whole numbers of nodes and degrees of freedom")
    return entries
