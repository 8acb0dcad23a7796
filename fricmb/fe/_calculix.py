"""Matrices of CalculiX: ``*FREQUENCY, SOLVER=MATRIXSTORAGE`` writes ``.sti``, ``.mas`` and ``.dof``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

from fricmb._files import text_of
from fricmb.errors import FileError

ENDINGS = {"K": ".sti", "M": ".mas", "labels": ".dof"}


def stem(path: Path) -> Path:
    """What the three files have in common."""
    bare = path.with_suffix("") if path.suffix == ".gz" else path
    return bare.with_suffix("") if bare.suffix in ENDINGS.values() else bare


def read(path: Path, names: Mapping[str, str] | None) -> dict[str, Any]:
    """Triangles of stiffness and mass, and the node and direction of each row."""
    files = {key: _beside(path, ending) for key, ending in ENDINGS.items()}
    labels, expanded = _told_apart(_labels(files["labels"]))
    n = len(labels)
    notes = ("nodes of expanded beams and shells stand several times: further ones have larger numbers",)
    return {
        "notes": notes if expanded else (),
        "M": _triangle(files["M"], n),
        "K": _triangle(files["K"], n),
        "labels": labels,
        "triangles": {"M": "symmetric", "K": "symmetric"},
    }


def _beside(path: Path, ending: str) -> Path:
    plain = Path(f"{stem(path)}{ending}")
    for file in (plain, Path(f"{plain}.gz")):
        if file.exists():
            return file
    raise FileError(f"{path}: expected {plain.name} beside it")


def _labels(path: Path) -> NDArray[np.int64]:
    """Lines ``node.direction``."""
    found = []
    for number, line in enumerate(text_of(path, "a text file of CalculiX").split("\n"), 1):
        if not line.strip():
            continue
        node, _, dof = line.strip().partition(".")
        if not (node.isdecimal() and dof.isdecimal()) or len(node) > 15 or not 1 <= int(dof) <= 6:
            raise FileError(f"{path}: line {number}: expected node.direction such as 12.3, got {line.strip()[:40]!r}")
        found.append((int(node), int(dof)))
    if not found:
        raise FileError(f"{path}: expected a line node.direction for each row, found none")
    return np.array(found, dtype=np.int64)


def _told_apart(labels: NDArray[np.int64]) -> tuple[NDArray[np.int64], bool]:
    """Labels that are all different, and whether they were not.

    Beams and shells are expanded to solids, whose nodes go by the number of the one they came from: further ones get
    numbers of their own.
    """
    found, step = labels.copy(), 10 ** len(str(int(labels[:, 0].max())))
    copies: dict[int, int] = {}
    before = (-1, 0)
    for i, (node, dof) in enumerate(labels.tolist()):
        if node != before[0] or dof <= before[1]:
            copies[node] = copies.get(node, -1) + 1
        found[i, 0] = node + copies[node] * step
        before = (node, dof)
    return found, bool((found != labels).any())


def _triangle(path: Path, n: int) -> Any:
    """Lines ``row column value``, from 1, of one triangle."""
    text = text_of(path, "a text file of CalculiX")
    if not text.endswith("\n"):
        raise FileError(f"{path}: its last line is cut off")
    try:
        entries = np.loadtxt(text.splitlines(), dtype=float, ndmin=2)
    except ValueError as error:
        raise FileError(f"{path}: expected lines of row, column, value ({error})") from error
    if entries.ndim != 2 or entries.shape[1] != 3:
        raise FileError(f"{path}: expected lines of row, column, value")
    places = entries[:, :2].astype(np.int64) - 1
    wrong = np.flatnonzero(((places < 0) | (places >= n)).any(axis=1) | (places + 1 != entries[:, :2]).any(axis=1))
    if wrong.size:
        raise FileError(
            f"{path}: line {wrong[0] + 1}: rows and columns must be from 1 to {n}, the lines of the .dof file; got"
            f" {entries[wrong[0], 0]:g} {entries[wrong[0], 1]:g}"
        )
    seen = np.zeros(n, dtype=bool)
    seen[places[:, 0][places[:, 0] == places[:, 1]]] = True
    if not seen.all():
        row = int(np.argmin(seen)) + 1
        raise FileError(f"{path}: row {row} of {n} has no diagonal entry: the file is cut off, or of another model")
    return scipy.sparse.csr_array((entries[:, 2], (places[:, 0], places[:, 1])), shape=(n, n))
