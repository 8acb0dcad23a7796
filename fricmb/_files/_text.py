"""Text, packed or not."""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path

from fricmb.errors import FileError


def text_of(path: Path, what: str, encoding: str = "ascii") -> str:
    """The text of a file.

    Raises
    ------
    FileError
        If it is cut off where it is packed, or no text; says that ``what`` was expected.
    """
    try:
        data = path.read_bytes()
        return (gzip.decompress(data) if path.suffix == ".gz" else data).decode(encoding)
    except (OSError, EOFError, UnicodeDecodeError, zlib.error) as error:
        raise FileError(f"{path}: expected {what} ({error})") from error
