"""Text, packed or not."""

from __future__ import annotations

import gzip
import io
import zlib
from pathlib import Path
from typing import BinaryIO

from fricmb.errors import FileError

#: Bytes to which packed files grow at most: matrices of a million rows in text are a tenth of it.
MOST_UNPACKED = 8 << 30
#: They may grow to this many bytes, or by this factor: text of numbers packs to a third, of zeros to a hundredth.
FREE, FACTOR = 64 << 20, 200
_CHUNK = 1 << 20


def unpack(path: Path, target: BinaryIO) -> None:
    """Write what a packed file holds.

    Raises
    ------
    FileError
        If it is cut off or no packed file, or grows as only a file made to fill a disk does.
    """
    most = min(MOST_UNPACKED, max(FREE, FACTOR * path.stat().st_size))
    grown = 0
    try:
        with gzip.open(path, "rb") as packed:
            while chunk := packed.read(_CHUNK):
                grown += len(chunk)
                if grown > most:
                    raise FileError(f"{path}: expected at most {most >> 20} MB in this packed file; unpack it first")
                target.write(chunk)
    except (OSError, EOFError, zlib.error) as error:
        raise FileError(f"{path}: expected a whole packed file, gz ({error})") from error


def _bytes_of(path: Path) -> bytes:
    if path.suffix != ".gz":
        return path.read_bytes()
    whole = io.BytesIO()
    unpack(path, whole)
    return whole.getvalue()


def text_of(path: Path, what: str, encoding: str = "ascii") -> str:
    """The text of a file.

    Raises
    ------
    FileError
        If it is cut off where it is packed, or no text; says that ``what`` was expected.
    """
    try:
        return _bytes_of(path).decode(encoding)
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"{path}: expected {what} ({error})") from error
