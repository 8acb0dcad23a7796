"""MAT-files of version 5 to 7: numbers, dense and sparse.  scipy's reader ends the process at some damaged ones."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from fricmb.errors import FileError

#: Numbers by type of element.
NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
MATRIX, COMPRESSED = 14, 15
#: Classes of arrays that hold numbers, and the one of sparse matrices.
NUMERIC, SPARSE = range(6, 16), 5
COMPLEX = 0x0800
_HEAD = 128


def mat_5(path: Path) -> dict[str, Any]:
    """Variables that hold numbers; texts, cells and objects are passed over.

    Raises
    ------
    FileError
        Names the variable or the place.
    """
    data = path.read_bytes()
    order = {b"IM": "<", b"MI": ">"}.get(data[126:_HEAD])
    if order is None:
        raise FileError(f"{path}: expected a MAT-file of MATLAB, version 5 to 7")
    found: dict[str, Any] = {}
    for at, kind, content in _elements(path, data[_HEAD:], order, _HEAD):
        if kind == COMPRESSED:
            try:
                content = zlib.decompress(content)
            except zlib.error as error:
                raise FileError(f"{path}: byte {at}: expected a packed variable ({error})") from error
            ((_, kind, content),) = _elements(path, content, order, at)
        if kind == MATRIX:
            name, value = _array(path, at, list(_elements(path, content, order, at)), order)
            if value is not None:
                found[name] = value
    return found


def _elements(path: Path, data: bytes, order: str, start: int) -> Iterator[tuple[int, int, bytes]]:
    """Place, type and content of each element."""
    at = 0
    while at < len(data):
        if at + 8 > len(data):
            raise FileError(f"{path}: byte {start + at}: expected another element; the file is cut off")
        kind, size = struct.unpack(order + "II", data[at : at + 8])
        first, step = at + 8, 8 + size + (-size % 8 if kind != COMPRESSED else 0)
        if kind >> 16:  # four bytes at most stand in the tag itself
            kind, size, first, step = kind & 0xFFFF, kind >> 16, at + 4, 8
        if first + size > len(data) or (step == 8 and size > 4 and first == at + 4):
            raise FileError(f"{path}: byte {start + at}: expected {size} bytes of an element; the file is cut off")
        yield start + at, kind, data[first : first + size]
        at += step


def _array(path: Path, at: int, parts: list[tuple[int, int, bytes]], order: str) -> tuple[str, Any]:
    """Name and numbers of a variable; None where it holds none."""
    if len(parts) < 3 or len(parts[0][2]) != 8:
        raise FileError(f"{path}: byte {at}: expected flags, sizes and a name of a variable")
    flags = struct.unpack(order + "II", parts[0][2])[0]
    sizes = np.frombuffer(parts[1][2], order + "i4").astype(np.int64)
    name = parts[2][2].decode("ascii", "replace")
    kind, content = flags & 0xFF, parts[3:]
    if kind != SPARSE and kind not in NUMERIC:
        return name, None
    label = f"{path}: {name}"
    expected = (2 if flags & COMPLEX else 1) + (2 if kind == SPARSE else 0)
    if len(content) != expected or sizes.size < 2 or (sizes < 0).any():
        raise FileError(f"{label}: expected sizes and {expected} lists of numbers, got {len(content)}")
    lists = [_numbers(label, part, order) for part in content]
    if kind == SPARSE:
        return name, _sparse(label, sizes.tolist(), lists)
    if any(x.size != np.prod(sizes, dtype=float) for x in lists):
        raise FileError(f"{label}: expected {' x '.join(map(str, sizes.tolist()))} numbers, got {lists[0].size}")
    whole = lists[0] if len(lists) == 1 else lists[0] + 1j * lists[1]
    return name, whole.reshape(sizes.tolist(), order="F")


def _numbers(label: str, part: tuple[int, int, bytes], order: str) -> Any:
    _, kind, content = part
    if kind not in NUMBERS or len(content) % np.dtype(NUMBERS[kind]).itemsize:
        raise FileError(f"{label}: expected numbers, got an element of type {kind}")
    values = np.frombuffer(content, order + NUMBERS[kind])
    return values.astype(values.dtype.newbyteorder("="))


def _sparse(label: str, sizes: list[int], lists: list[Any]) -> Any:
    rows, starts, values = lists[0].astype(np.int64), lists[1].astype(np.int64), lists[2]
    good = len(sizes) == 2 and starts.size == sizes[1] + 1 and starts[0] == 0 and (np.diff(starts) >= 0).all()
    good = good and starts[-1] <= min(rows.size, values.size) and (rows >= 0).all() and (rows < sizes[0]).all()
    if not good:
        raise FileError(f"{label}: expected a sparse matrix: rows, starts of columns and values that fit its sizes")
    n = int(starts[-1])
    if len(lists) == 4:
        values = values[:n] + 1j * lists[3][:n]
    return scipy.sparse.csc_array((values[:n], rows[:n], starts), shape=(sizes[0], sizes[1]))
