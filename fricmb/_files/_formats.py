"""Which reader a file goes to, and that whatever goes wrong in it is told in one sentence."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from fricmb._files._text import unpack
from fricmb.errors import FileError, FricmbError, SceneError, shown

Reader = Callable[..., Any]


@dataclass(frozen=True, kw_only=True)
class Formats:
    """Readers by format, and the format that an ending stands for.

    Attributes
    ----------
    who : str
        The function that reads, for messages: ``fe.read``.
    readers : dict of str to callable
        By format; the first argument is the path.
    endings : dict of str to str
    packed : tuple of str
        Formats whose readers open packed files (gz) themselves, for what stands beside them is packed, too.
    """

    who: str
    readers: Mapping[str, Reader]
    endings: Mapping[str, str]
    packed: tuple[str, ...] = ()

    def checked(self, path: Any, format: Any) -> Path:
        """The path, and a format that there is."""
        if not isinstance(path, str | PathLike):
            raise SceneError(f"{self.who}: path must be a path, got {shown(path)}")
        if format is not None and format not in self.readers:
            raise SceneError(f"{self.who}: format must be one of {', '.join(self.readers)}, got {shown(format)}")
        return Path(path)

    def by_ending(self, file: Path) -> str | None:
        """Format of a file by its ending, of a packed one by that of what is in it."""
        plain = file.name.removesuffix(".gz") if file.name.endswith(".gz") else file.name
        return self.endings.get(Path(plain).suffix.lower())

    def read(self, file: Path, format: str | None, *arguments: Any) -> Any:
        """What the reader of a format finds; by default the format of the ending.

        Raises
        ------
        FileError
        """
        kind = format or self.by_ending(file)
        if kind is None:
            known = ", ".join(self.readers)
            raise FileError(f"{file}: its ending names no format that can be read; give format=, one of {known}")
        return one_sentence(file, self.readers[kind], *arguments, packed=kind in self.packed)


def one_sentence(file: Path, reader: Reader, *arguments: Any, packed: bool = False) -> Any:
    """What a reader finds in a file; an error of a library becomes a FileError that names the file."""
    if not file.is_file():
        raise FileError(f"{file}: there is no such file")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of libraries: what they doubt is checked, or an error follows
            if not packed and file.suffix == ".gz":
                return _unpacked(file, reader, arguments)
            return reader(file, *arguments)
    except FricmbError as error:
        raise _on_one_line(error) from error.__cause__
    except MemoryError:
        raise FileError(f"{file}: it announces more data than fit into memory") from None
    except Exception as error:
        raise FileError(f"{file}: cannot be read ({type(error).__name__}: {shown(str(error))[1:-1]})") from error


def _on_one_line(error: FricmbError) -> FricmbError:
    """A library's words may have lines of their own."""
    text = str(error)
    return FileError(" ".join(text.split())) if type(error) is FileError and "\n" in text else error


def _unpacked(file: Path, reader: Reader, arguments: tuple[Any, ...]) -> Any:
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / file.stem
        with plain.open("wb") as target:
            unpack(file, target)
        try:
            return reader(plain, *arguments)
        except FileError as error:
            raise FileError(str(error).replace(str(plain), str(file))) from error
