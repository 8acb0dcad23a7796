"""Nastran's OUTPUT2 as blocks of records.  A length in a head is held against the file before anything is asked for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fricmb._files._records import Piece, first_mark, record
from fricmb.errors import FileError


@dataclass(frozen=True, kw_only=True, eq=False)
class Block:
    """A table or a matrix: ``records`` are those of the table, or the columns of the matrix, each in pieces."""

    name: str
    trailer: tuple[int, ...]
    is_matrix: bool
    records: tuple[tuple[Piece, ...], ...]


class Output2:
    """Blocks of a file.

    Raises
    ------
    FileError
        If the file is of another kind, or ends before what it announces: names the byte.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        if path.stat().st_size < 12:
            raise FileError(f"{path}: expected OUTPUT2 of Nastran, got {path.stat().st_size} bytes")
        self._data = np.memmap(path, np.uint8, "r")
        #: Bytes of a word, and their order in it.
        self._order, self.word = first_mark(self._data, (4, 8))
        if not self._order:
            raise FileError(f"{path}: byte 0: expected OUTPUT2 of Nastran, whose first record has 4 or 8 bytes")
        self.blocks = tuple(self._blocks(list(self._keys())))

    def integers(self, pieces: tuple[Piece, ...]) -> Any:
        """Words as whole numbers."""
        return self._numbers(pieces, f"i{self.word}")

    def floats(self, pieces: tuple[Piece, ...]) -> Any:
        """Words as numbers."""
        return self._numbers(pieces, f"f{self.word}")

    def split(self, piece: Piece, kind: str) -> tuple[int, Any]:
        """The first word, and the numbers behind it: how a matrix is written."""
        start, length = piece
        first = int(self.integers(((start, self.word),))[0])
        return first, self._numbers(((start + self.word, length - self.word),), kind)

    def _numbers(self, pieces: tuple[Piece, ...], kind: str) -> Any:
        data = b"".join(self._data[start : start + length].tobytes() for start, length in pieces)
        size = np.dtype(kind).itemsize
        return np.frombuffer(data[: len(data) // size * size], self._order + kind)

    def _keys(self) -> Iterator[tuple[int, int, int]]:
        """Numbers that say how many words follow, with place and length of these; both 0 where none follow."""
        at = 0
        while at < self._data.size:
            start, length = record(self.path, self._data, at, self._order)
            if length != self.word:
                raise FileError(f"{self.path}: byte {at}: expected a number of {self.word} bytes, got {length}")
            key = int(self.integers(((start, length),))[0])
            at = start + length + 4
            if key <= 0:
                yield key, 0, 0
                continue
            start, length = record(self.path, self._data, at, self._order)
            if key * self.word > length:
                words = f"{key} words of {self.word} bytes are announced, the record has {length} bytes"
                raise FileError(f"{self.path}: byte {at}: {words}")
            yield key, start, length
            at = start + length + 4

    def _blocks(self, keys: list[tuple[int, int, int]]) -> Iterator[Block]:
        ends = [i for i, (key, _, _) in enumerate(keys) if key == 0]
        at = 0
        if keys[0][0] == 3:  # date and label of the file
            at = (ends[0] if ends else len(keys)) + 1
        while at < len(keys):
            if keys[at][0] == 0:
                at += 1
                continue
            end = next((i for i in ends if i > at), None)
            if end is None:
                raise FileError(f"{self.path}: expected the end of its last block; the file is cut off")
            yield self._block(keys[at:end])
            at = end + 1

    def _block(self, keys: list[tuple[int, int, int]]) -> Block:
        """Name; then groups, each behind a negative number: trailer, head, and records."""
        groups: list[list[Piece]] = []
        for key, start, length in keys[1:]:
            if key < 0:
                groups.append([])
            elif groups:
                groups[-1].append((start, length))
        start, length = keys[0][1:]
        letters = self._data[start : start + length].tobytes().decode("ascii", "replace")
        name = "".join(letter for letter in letters if letter.isalnum())
        if len(groups) < 3 or not all(group for group in (groups[0], *groups[2:])):
            raise FileError(f"{self.path}: block {name[:16]!r}: expected a trailer, a head and records")
        kinds = [self.integers((group[0],)) for group in groups[2:]]
        return Block(
            name=name,
            trailer=tuple(self.integers((groups[0][0],)).tolist()),
            is_matrix=bool(kinds[0].size and kinds[0][0] == 1),
            records=tuple(tuple(group[1:]) for group in groups[2:-1]),
        )
