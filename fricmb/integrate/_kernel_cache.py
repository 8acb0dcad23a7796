"""Machine code on disk, by content: one file a kernel and signature, checked before it is used.

A file is named by the digest of what the kernel is made of (:mod:`fricmb.integrate._content`) and begins with the
digest of its own bytes.  One that is damaged, cut off or from elsewhere is made again; a folder that cannot be written
is read, and what is new goes to a temporary one.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import sys
import tempfile
import time
from functools import cache
from pathlib import Path
from typing import Any

from numba.core.caching import Cache, CompileResultCacheImpl

from fricmb.integrate._content import content_digest

_DIGEST = 32
#: Files that no run has used for so long are removed.
_DAYS = 60
_DAY = 86_400.0


def kernel_folder() -> Path:
    """Where machine code is kept: in ``NUMBA_CACHE_DIR``, else ``FRICMB_CACHE_DIR``, else the user's cache folder."""
    return _folder(os.environ.get("NUMBA_CACHE_DIR"), os.environ.get("FRICMB_CACHE_DIR"))


@cache
def _folder(numba: str | None, ours: str | None) -> Path:
    if numba is None and ours is None:
        from platformdirs import user_cache_dir

        ours = user_cache_dir("fricmb")
    return Path(numba) / "fricmb" if numba is not None else Path(str(ours)) / "kernels"


@cache
def _temporary() -> Path:
    path = Path(tempfile.mkdtemp(prefix="fricmb-kernels-"))
    _say(f"compiled kernels cannot be kept in {kernel_folder()}; this process keeps them in {path}")
    return path


def _say(text: str) -> None:
    print(f"fricmb: {text}", file=sys.stderr)


class KernelCache(Cache):  # type: ignore[misc]
    """Numba's cache of one function, with files by content."""

    def __init__(self, function: Any, name: str, options: str) -> None:
        self._name = name
        self._py_func = function
        self._options = options
        self._impl = CompileResultCacheImpl.__new__(CompileResultCacheImpl)
        self._enabled = True

    @property
    def cache_path(self) -> str:
        """The folder of the files."""
        return str(kernel_folder())

    def flush(self) -> None:
        """Remove the files of this function."""
        for path in kernel_folder().glob(f"{self._name}-*.nbc"):
            path.unlink(missing_ok=True)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The kernel for one signature, or None where there is no sound file of it."""
        target_context.refresh()
        name = self._file(sig, target_context.codegen())
        folders = [kernel_folder()]
        if _temporary.cache_info().currsize:
            folders.append(_temporary())
        for folder in folders:
            payload = _read(folder / name)
            if payload is not None:
                try:
                    return self._impl.rebuild(target_context, pickle.loads(payload))
                except Exception as error:  # whatever an unsound file can bring about: the kernel is made again
                    _say(f"a kept kernel cannot be used ({error!r}) and is compiled again: {folder / name}")
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a compiled kernel; where that cannot be done the run goes on."""
        if any(not lifted.can_cache for lifted in data.lifted) or data.library.has_dynamic_globals:
            return
        payload = pickle.dumps(self._impl.reduce(data), protocol=-1)
        name = self._file(sig, data.codegen)
        try:
            _write(kernel_folder() / name, payload)
            _clean()
        except OSError:
            try:
                _write(_temporary() / name, payload)
            except OSError:
                return

    def _file(self, sig: Any, codegen: Any) -> str:
        return f"{self._name}-{content_digest(self._py_func, self._options, sig, codegen.magic_tuple())}.nbc"


def _read(path: Path) -> bytes | None:
    """What a file holds, or None; a damaged one is said and removed."""
    try:
        data = path.read_bytes()
    except OSError:
        return None
    payload = data[_DIGEST:]
    if hashlib.sha256(payload).digest() == data[:_DIGEST]:
        _touch(path)
        return payload
    _say(f"a kept kernel is damaged and is compiled again: {path}")
    with contextlib.suppress(OSError):
        path.unlink()
    return None


def _touch(path: Path) -> None:
    """Mark a file as used, at most once a day."""
    try:
        if time.time() - path.stat().st_mtime > _DAY:
            os.utime(path)
    except OSError:
        pass


def _write(path: Path, payload: bytes) -> None:
    """Write a file at once or not at all, whoever else writes it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, part = tempfile.mkstemp(dir=path.parent, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(hashlib.sha256(payload).digest())
            file.write(payload)
        os.replace(part, path)
    except BaseException:
        Path(part).unlink(missing_ok=True)
        raise


@cache
def _clean() -> None:
    """Remove files that nothing has used for long; once a process."""
    oldest = time.time() - _DAYS * _DAY
    for path in kernel_folder().glob("*.nbc"):
        try:
            if path.stat().st_mtime < oldest:
                path.unlink()
        except OSError:
            pass


def kept(compiled: Any) -> Any:
    """Let a numba dispatcher or callback keep its machine code by content."""
    function = getattr(compiled, "py_func", None) or compiled._pyfunc
    options = repr(sorted(getattr(compiled, "targetoptions", {}).items()))
    compiled._cache = KernelCache(function, function.__name__, options)
    return compiled
