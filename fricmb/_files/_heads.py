"""What a head announces is held against what the file holds, before a library believes it."""

from __future__ import annotations

import io
import struct
from pathlib import Path

from fricmb.errors import FileError

#: First letters of a sound file, and the order of bytes in its numbers.
_RIFF = {b"RIFF": "<", b"RF64": "<", b"RIFX": ">"}
#: What stands for a size that is said elsewhere, or that a program which wrote on and on never knew.
_UNKNOWN = 0xFFFFFFFF


class Clipped(io.BufferedReader):
    """A file of which no reader gets, or makes room for, more than it holds."""

    def __init__(self, path: Path) -> None:
        super().__init__(io.FileIO(path))
        self._size = path.stat().st_size

    def read(self, size: int | None = -1, /) -> bytes:
        """So many bytes at most."""
        left = max(self._size - self.tell(), 0)
        return super().read(left if size is None or size < 0 else min(size, left))


def wav_fits(path: Path) -> None:
    """Each part of a sound file, up to the samples, lies within it.

    Raises
    ------
    FileError
        Names the part, what it announces and what there is.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(12)
        order = _RIFF.get(head[:4])
        if order is None or head[8:] != b"WAVE":
            raise FileError(f"{path}: expected a sound file, WAV, whose first letters are RIFF and WAVE")
        long = 0
        while len(part := file.read(8)) == 8:
            name, length = struct.unpack(order + "4sI", part)
            left = size - file.tell()
            if name == b"ds64" and 16 <= length <= left:
                long = struct.unpack(order + "8xQ", file.read(16))[0]
                file.seek(-16, 1)
            if name == b"data" and length == _UNKNOWN and long:
                length = long
            if length > left:
                raise FileError(_short(path, name, length, left))
            if name == b"data":
                return
            file.seek(length + length % 2, 1)
    raise FileError(f"{path}: expected samples (a part 'data'), found none")


def _short(path: Path, name: bytes, length: int, left: int) -> str:
    if name != b"data":
        letters = name.decode("ascii", "replace")
        return f"{path}: part {letters!r} announces {length} bytes, the file has {left} more; it is cut off"
    return (
        f"{path}: its head announces {length} bytes of samples, the file has {left}; it is cut off, or was never"
        " closed: write it anew with a sound program"
    )
