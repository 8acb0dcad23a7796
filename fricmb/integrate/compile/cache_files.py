"""Files that can be made again: machine code and derived templates, in the user's cache folder.

What was made when the package was installed stands in the package itself and is read from there.

Every file is checked before it is used; one that is damaged is said, removed and made again.  A folder that cannot be
written is read all the same (a warm cache in an image); what is new goes to a temporary folder of this process, and
where that fails, too, stays in memory.  Nothing here ever stops a run.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

#: Files that no run has used for so long are removed.
_DAYS = 60
_DAY = 86_400.0
#: What is installed with the package.
_SHIPPED = Path(__file__).parents[2] / "_made"
#: Names of the files that this process has read or written, kind by kind.
_used: dict[str, set[str]] = {}


def used_files() -> dict[str, list[str]]:
    """Names of the files that this process has read or written since it was last asked, kind by kind."""
    found = {kind: sorted(names) for kind, names in _used.items() if names}
    _used.clear()
    return found


def cache_folder(kind: str) -> Path:
    """Where the files of a kind ("kernels", "templates") are: ``FRICMB_CACHE_DIR/kind``, else the user's cache folder.

    Of kernels ``NUMBA_CACHE_DIR/fricmb``, if that is set.
    """
    numba = os.environ.get("NUMBA_CACHE_DIR") if kind == "kernels" else None
    return _folder(kind, numba, os.environ.get("FRICMB_CACHE_DIR"))


def find_file(kind: str, name: str) -> Path | None:
    """Where a kept file is: in the cache folder, in the package, or (None) nowhere that outlives a process."""
    places = (cache_folder(kind) / name, _SHIPPED / kind / name)
    return next((path for path in places if path.is_file()), None)


def can_be_written(folder: Path) -> bool:
    """Whether a file can be put into a folder, which is made if need be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


@cache
def _folder(kind: str, numba: str | None, ours: str | None) -> Path:
    if numba:
        return Path(numba) / "fricmb"
    if not ours:
        from platformdirs import user_cache_dir

        ours = user_cache_dir("fricmb")
        if not Path(ours).is_absolute():  # nobody knows of a home
            return _temporary(kind, f"there is no home folder to keep {kind} in")
    return Path(ours) / kind


@cache
def _temporary(kind: str, why: str) -> Path:
    path = Path(tempfile.mkdtemp(prefix=f"fricmb-{kind}-"))
    say(f"{why}; this process keeps them in {path}")
    return path


def say(text: str) -> None:
    """A notice: one line on stderr; none with ``FRICMB_QUIET`` in the environment (``--quiet``)."""
    if os.environ.get("FRICMB_QUIET"):
        return
    with contextlib.suppress(OSError, ValueError, AttributeError), _bars_aside():
        print(f"fricmb: {text}", file=sys.stderr, flush=True)


def _bars_aside() -> contextlib.AbstractContextManager[object]:
    """Progress bars on the terminal are taken away and drawn again below: a notice has a line of its own."""
    loaded = sys.modules.get("tqdm")
    if loaded is None or not getattr(loaded.tqdm, "_instances", None):
        return contextlib.nullcontext()
    aside: contextlib.AbstractContextManager[object] = loaded.tqdm.external_write_mode(file=sys.stderr)
    return aside


class CacheFiles:
    """The files of one kind.

    Parameters
    ----------
    kind : str
        "kernels" or "templates".
    seal : callable
        From what is kept to the bytes of a file.
    unseal : callable
        The way back; None where the bytes are not what was written.
    again : str
        What is done about a damaged file ("compiled again").
    """

    def __init__(
        self, kind: str, seal: Callable[[bytes], bytes], unseal: Callable[[bytes], bytes | None], again: str
    ) -> None:
        self._kind, self._seal, self._unseal, self._again = kind, seal, unseal, again
        self._other: Path | None = None
        self._memory: dict[str, bytes] = {}

    @property
    def folder(self) -> Path:
        """The folder that is meant."""
        return cache_folder(self._kind)

    def read(self, name: str) -> bytes | None:
        """What is kept under a name, or None."""
        _used.setdefault(self._kind, set()).add(name)
        if name in self._memory:
            return self._memory[name]
        for folder in (self.folder, self._other, _SHIPPED / self._kind):
            if folder is not None and (held := self._read(folder / name)) is not None:
                return held
        return None

    def _read(self, path: Path) -> bytes | None:
        try:
            data = path.read_bytes()
        except OSError:
            return None
        held = self._unseal(data)
        if held is None:
            say(f"a kept file of the {self._kind} is damaged and is {self._again}: {path}")
            remove(path)
        else:
            _touch(path)
        return held

    def write(self, name: str, held: bytes) -> None:
        """Keep something, on disk if that can be."""
        data = self._seal(held)
        if self._other is None:
            try:
                _write(self.folder / name, data)
                _clean(self.folder)
                return
            except OSError as error:
                why = error.strerror or str(error)
                with contextlib.suppress(OSError):
                    self._other = _temporary(self._kind, f"{self._kind} cannot be kept in {self.folder} ({why})")
        try:
            if self._other is not None:
                _write(self._other / name, data)
                return
        except OSError:
            pass
        self._memory[name] = held

    def discard(self, name: str) -> None:
        """Remove a file that cannot be used."""
        self._memory.pop(name, None)
        for folder in (self.folder, self._other):
            if folder is not None:
                remove(folder / name)


def remove(path: Path) -> None:
    """Remove a file, if that can be."""
    with contextlib.suppress(OSError):
        path.unlink()


def _touch(path: Path) -> None:
    """Mark a file as used, at most once a day."""
    with contextlib.suppress(OSError):
        if time.time() - path.stat().st_mtime > _DAY:
            os.utime(path)


def _write(path: Path, data: bytes) -> None:
    """Write a file at once or not at all, whoever else writes it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, part = tempfile.mkstemp(dir=path.parent, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.replace(part, path)
    except BaseException:
        remove(Path(part))
        raise


@cache
def _clean(folder: Path) -> None:
    """Remove what nothing has used for long, and what older versions and killed processes left; once a process."""
    now = time.time()
    with contextlib.suppress(OSError):
        for path in folder.iterdir():
            with contextlib.suppress(OSError):
                days = (now - path.stat().st_mtime) / _DAY
                if path.name == "__pycache__" and days > _DAYS:
                    shutil.rmtree(path, ignore_errors=True)
                elif path.is_file() and days > (1.0 if path.suffix == ".part" else _DAYS):
                    path.unlink()
