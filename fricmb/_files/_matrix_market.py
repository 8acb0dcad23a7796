"""Matrix Market.  scipy's reader ends the process at a number that is cut off, so numpy reads the numbers here."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from fricmb._files._text import text_of
from fricmb.errors import FileError

HEAD = "%%matrixmarket"
#: Columns of numbers beside those of places.
FIELDS = {"real": 1, "integer": 1, "complex": 2}
#: What a triangle stands for: what the other one is of it.
SYMMETRIES = {"general": None, "symmetric": 1.0, "skew-symmetric": -1.0, "hermitian": 1.0}
#: More rows than any model has.
MOST = 50_000_000


def matrix_market(path: Path) -> Any:
    """The matrix of a file, sparse or dense.

    Raises
    ------
    FileError
        Names the line.
    """
    text = text_of(path, "text, Matrix Market")
    lines = text.splitlines()
    words = lines[0].lower().split() if lines else []
    known = len(words) == 5 and words[:2] == [HEAD, "matrix"] and words[2] in ("coordinate", "array")
    if not known or words[3] not in FIELDS or words[4] not in SYMMETRIES:
        raise FileError(f"{path}: line 1: expected '%%MatrixMarket matrix', coordinate or array, real or complex")
    kept = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.startswith("%")]
    sparse = words[2] == "coordinate"
    if not kept:
        raise FileError(f"{path}: expected a line of sizes, found none")
    sizes = _sizes(path, *kept[0], 3 if sparse else 2)
    count = _count(sizes, sparse, words[4])
    if len(kept) - 1 != count or not text.endswith("\n"):
        raise FileError(f"{path}: expected {count} lines of numbers, got {len(kept) - 1}, or the last one is cut off")
    body = _numbers(path, kept[1:], FIELDS[words[3]] + 2 * sparse)
    values = body[:, -1] if FIELDS[words[3]] == 1 else body[:, -2] + 1j * body[:, -1]
    rows, columns = _places(path, sizes, body) if sparse else _all_places(sizes, words[4])
    found = scipy.sparse.csr_array((values, (rows, columns)), shape=(sizes[0], sizes[1]))
    other = SYMMETRIES[words[4]]
    if other is not None:
        below = scipy.sparse.tril(found, -1)
        found = found + other * (below.conj() if words[4] == "hermitian" else below).T
    return scipy.sparse.csr_array(found) if sparse else found.toarray()


def _sizes(path: Path, number: int, line: str, width: int) -> list[int]:
    words = line.split()
    if len(words) != width or not all(word.isdecimal() for word in words) or not 0 < int(words[0]) <= MOST:
        accepted = f"{width} sizes, rows from 1 to {MOST}"
        raise FileError(f"{path}: line {number}: expected {accepted}, got {line.strip()[:40]!r}")
    return [int(word) for word in words]


def _count(sizes: list[int], sparse: bool, symmetry: str) -> int:
    """Lines of numbers."""
    if sparse:
        return sizes[2]
    n = sizes[0]
    return {"general": n * sizes[1], "skew-symmetric": n * (n - 1) // 2}.get(symmetry, n * (n + 1) // 2)


def _numbers(path: Path, kept: list[tuple[int, str]], width: int) -> Any:
    try:
        body = np.loadtxt([line for _, line in kept], dtype=float, ndmin=2) if kept else np.zeros((0, width))
    except ValueError as error:
        raise FileError(f"{path}: behind line {kept[0][0]}: expected {width} numbers a line ({error})") from error
    if body.shape[1] != width:
        raise FileError(f"{path}: line {kept[0][0]}: expected {width} numbers, got {body.shape[1]}")
    return body


def _places(path: Path, sizes: list[int], body: Any) -> tuple[Any, Any]:
    places = body[:, :2]
    wrong = (places != np.round(places)) | (places < 1) | (places > np.array(sizes[:2]))
    if wrong.any():
        row = int(np.argmax(wrong.any(axis=1))) + 1
        raise FileError(f"{path}: entry {row}: expected a row and a column from 1 to {sizes[0]} and {sizes[1]}")
    return tuple(places.astype(np.int64).T - 1)


def _all_places(sizes: list[int], symmetry: str) -> tuple[Any, Any]:
    """Places of a dense matrix by columns; of a symmetric one those of its lower triangle."""
    rows, columns = np.indices(sizes[:2]).reshape(2, -1, order="F")
    if symmetry != "general":
        kept = rows > columns if symmetry == "skew-symmetric" else rows >= columns
        rows, columns = rows[kept], columns[kept]
    return rows, columns
