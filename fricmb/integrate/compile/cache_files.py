"""Files that can be made again: machine code and derived templates, in the user's cache folder.

What was made when the package was installed stands in the package itself and is read from there.

Every file is checked before it is used; one that is damaged is said, removed and made again.  A folder that others can
write to is not used (:mod:`fricmb.integrate.compile.cache_trust`).  One that cannot be written is read all the same (a
warm cache in an image); what is new goes to a temporary folder, removed when this process ends, and where that fails,
too, stays in memory.  Nothing here ever stops a run.
"""

from __future__ import annotations

import contextlib
import logging
import os
import re
import secrets
import sys
import tempfile
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

from fricmb.integrate.compile.cache_trust import ADVICE, fault_of, fault_of_folder

#: Files that no run has used for so long are removed.
_DAYS = 60
_DAY = 86_400.0
#: Names of files that are made here, whole: only such are ever removed.
_PART = re.compile(r"fricmb-[0-9a-f]{16}\.part")
#: The file that marks a folder as a cache of this program, in the form that backup programs know.
_TAG = "CACHEDIR.TAG"
_MARK = (
    b"Signature: 8a477f597d28d172789f06886806bc55\n"
    b"# fricmb keeps files here that it can make again. It removes those that it made and has not used for 60 days.\n"
    b"# See https://bford.info/cachedir/ for this kind of file.\n"
)
#: What is installed with the package.
_SHIPPED = Path(__file__).parents[2] / "_made"
#: Where processes that this one starts find its temporary folder.
_TEMPORARY = "FRICMB_TEMPORARY_CACHE"
#: Where notices go beside the terminal; nowhere, unless a program asks for them.
_log = logging.getLogger("fricmb")
_log.addHandler(logging.NullHandler())
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


def missing_at_install() -> str:
    """Why a kernel that is to be compiled was not made when the package was installed."""
    with contextlib.suppress(OSError, ValueError):
        why = (_SHIPPED / "why_none.txt").read_text(encoding="utf-8").strip()
        return f"none were made when fricmb was installed, because {why}" if why else "none were made at install"
    if any(_SHIPPED.glob("kernels/*")):
        return "those made when fricmb was installed are for another processor, Python or numba"
    return "an editable install has none; `fricmb compile` makes all"


def can_be_kept(folder: Path) -> bool:
    """Whether files can be kept in a folder, which is made if need be, and read from there again."""
    try:
        if _refusal(folder) is not None:
            return False
        _make(folder)
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
def _refusal(folder: Path) -> str | None:
    """Why files in a folder are not to be believed, or None."""
    return fault_of_folder(folder)


@cache
def _temporary(kind: str, why: str) -> Path:
    """A folder for this process and those that it starts, which goes when this one ends."""
    root = _temporary_root()
    (root / kind).mkdir(exist_ok=True)
    say(f"{why}; this process keeps them in {root}")
    return root / kind


def _temporary_root() -> Path:
    given = os.environ.get(_TEMPORARY)
    if given is None:
        import shutil
        from multiprocessing.util import Finalize

        given = os.environ[_TEMPORARY] = tempfile.mkdtemp(prefix="fricmb-")
        # unlike atexit: also in a process of a pool, and not in one that is forked from this one
        Finalize(None, shutil.rmtree, (given, True), exitpriority=0)
    return Path(given)


def share_temporary() -> None:
    """Where a cache cannot be written, make one temporary folder for all processes that are started from now on.

    Each would make its own, and those that are killed would leave theirs behind.
    """
    with contextlib.suppress(OSError):
        for kind in ("kernels", "templates"):
            folder = cache_folder(kind)
            there = next(place for place in (folder, *folder.absolute().parents) if place.exists())
            if _refusal(folder) is not None or not (there.is_dir() and os.access(there, os.W_OK)):
                _temporary_root()


def say(text: str) -> None:
    """A notice: one line on stderr; none with ``FRICMB_QUIET`` in the environment (``--quiet``).

    It goes to the logger "fricmb" either way.
    """
    _log.info(text)
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
    names : str
        Regular expression of the names of its files, whole.
    seal : callable
        From what is kept to the bytes of a file.
    unseal : callable
        The way back; None where the bytes are not what was written.
    again : str
        What is done about a damaged file ("compiled again").
    """

    def __init__(
        self, kind: str, names: str, seal: Callable[[bytes], bytes], unseal: Callable[[bytes], bytes | None], again: str
    ) -> None:
        self._kind, self._seal, self._unseal, self._again = kind, seal, unseal, again
        self._names = re.compile(names)
        self._other: Path | None = None
        self._begun: set[Path] = set()
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
            if folder is not None and (held := self._read(folder, name)) is not None:
                return held
        return None

    def _read(self, folder: Path, name: str) -> bytes | None:
        path = folder / name
        try:
            with path.open("rb") as file:
                status = os.fstat(file.fileno())
                data = file.read()
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as error:
            _say_once(f"{self._kind} in {folder} cannot be read ({error.strerror}) and are {self._again}")
            return None
        if folder == self.folder:
            refusal = _refusal(folder)
            if refusal is not None:
                _say_once(f"{self._kind} in {folder} are not used, since {refusal}: {ADVICE}")
                return None
            fault = fault_of(status)
            if fault is not None:
                say(f"a kept file of the {self._kind} {fault}, so it is not used and is {self._again}: {path}")
                remove(path)
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
                refusal = _refusal(self.folder)
                if refusal is not None:
                    raise OSError(refusal)
                self._begin(self.folder)
                _write(self.folder / name, data)
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

    def _begin(self, folder: Path) -> None:
        """Before this process's first file: make and mark the folder, and remove what nothing has used for long."""
        if folder in self._begun:
            return
        _make(folder)
        names = [entry.name for entry in os.scandir(folder)]
        if _TAG not in names and all(map(self._is_own, names)):
            _write(folder / _TAG, _MARK)
            names = []
        if _TAG in names and (folder / _TAG).read_bytes() == _MARK:
            for name in filter(self._is_own, names):
                _remove_old(folder / name)
        self._begun.add(folder)

    def _is_own(self, name: str) -> bool:
        return bool(self._names.fullmatch(name) or _PART.fullmatch(name))

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


def _make(folder: Path) -> None:
    """Make a folder, and those above it, in which no others can write: such a one would not be used again."""
    for place in reversed([folder, *folder.parents]):
        if not place.is_dir():
            with contextlib.suppress(FileExistsError):  # another process was faster; a file is told by the next
                place.mkdir(0o755)


def _write(path: Path, data: bytes) -> None:
    """Write a file at once or not at all, whoever else writes it; others may read it if the umask lets them."""
    _make(path.parent)
    part = path.with_name(f"fricmb-{secrets.token_hex(8)}.part")
    try:
        with open(part, "xb", opener=lambda name, flags: os.open(name, flags, 0o644)) as file:
            file.write(data)
        os.replace(part, path)
    except BaseException:
        remove(part)
        raise


def _remove_old(path: Path) -> None:
    """Remove a file that nothing has used for long, or that a killed process left half written."""
    with contextlib.suppress(OSError):
        days = (time.time() - path.stat().st_mtime) / _DAY
        if days > (1.0 if path.suffix == ".part" else _DAYS):
            path.unlink()


@cache
def _say_once(text: str) -> None:
    say(text)
