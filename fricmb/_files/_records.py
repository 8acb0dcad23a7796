"""Records of Fortran: bytes between two numbers that say how many they are."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np

from fricmb.errors import FileError

#: First byte and length of a piece of a record.
Piece = tuple[int, int]


def first_mark(data: Any, lengths: Collection[int]) -> tuple[str, int]:
    """Order of the bytes by which the first number is one of ``lengths``, and the number; an empty order if by none."""
    for order in "<>":
        length = int(np.frombuffer(data[:4].tobytes(), order + "i4")[0])
        if length in lengths:
            return order, length
    return "", 0


def record(path: Path, data: Any, at: int, order: str) -> Piece:
    """Where the bytes of the record at ``at`` begin, and how many they are; ``order``: of the bytes of its numbers.

    Raises
    ------
    FileError
        If the file does not hold what the record announces: names the byte.
    """
    if at + 4 > data.size:
        raise FileError(f"{path}: byte {at}: expected another record; the file is cut off")
    mark = data[at : at + 4].tobytes()
    length = int(np.frombuffer(mark, order + "i4")[0])
    end = at + 4 + length
    if length < 0 or end + 4 > data.size:
        there = data.size - at - 4
        raise FileError(f"{path}: byte {at}: a record announces {length} bytes, the file has {there} more")
    if data[end : end + 4].tobytes() != mark:
        raise FileError(f"{path}: byte {end}: expected the length {length} of the record before it again")
    return at + 4, length
