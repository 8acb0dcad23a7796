"""Nastran's OUTPUT4: a binary one is held against what it announces before its reader believes it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fricmb._files._records import first_mark, record
from fricmb.errors import FileError

#: Length of the first record, the head of a matrix, and the integers in it.
HEADS = {24: "i4", 48: "i8"}
#: A matrix of more rows, or of fewer than none, has columns in pieces, each behind two integers.
MOST_ROWS = 65535


def op4_fits(path: Path) -> None:
    """Each record of a binary OUTPUT4 lies within it, and each column has the words that it announces.

    Raises
    ------
    FileError
        Names the byte.
    """
    if path.stat().st_size < 4:
        return  # what is too short is told by the reader
    data = np.memmap(path, np.uint8, "r")
    order, head = first_mark(data, HEADS)
    if not order:
        return  # text, or what the reader refuses
    kind = order + HEADS[head]
    at, columns, in_pieces = 0, 0, False
    while at < data.size:
        start, length = record(path, data, at, order)
        words = np.frombuffer(data[start : start + length // 4 * 4].tobytes(), kind, length // np.dtype(kind).itemsize)
        if not columns:  # a head: columns, rows, form, kind, name
            if length != head:
                raise FileError(f"{path}: byte {at}: expected the head of a matrix, {head} bytes, got {length}")
            columns, in_pieces = max(int(words[0]), 0) + 1, not 0 <= words[1] <= MOST_ROWS
        elif _column(path, at, words, in_pieces) >= columns:
            columns = 0  # a column behind the last one ends the matrix
        at = start + length + 4


def _column(path: Path, at: int, words: Any, in_pieces: bool) -> int:
    """Number of a column; its words, and the pieces of rows that they stand for, are in its record."""
    if words.size < 3:
        raise FileError(f"{path}: byte {at}: expected a column: its number, a row, a count of words")
    column, row, held = (int(word) for word in words[:3])
    if held > words.size - 3:
        raise FileError(f"{path}: byte {at}: column {column} announces {held} words, its record has {words.size - 3}")
    place = 3
    while in_pieces and row == 0 and place + 2 <= words.size:
        piece = int(words[place])
        if not 1 <= piece < words.size - place:
            left = words.size - place - 1
            raise FileError(f"{path}: byte {at}: column {column}: a piece announces {piece} words of {left}")
        place += piece + 1
    return column
