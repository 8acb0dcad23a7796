"""Machine code on disk, by content: one file a kernel and signature, checked before it is used.

A file is named by the digest of what the kernel is made of (:mod:`fricmb.integrate.compile.content`) and begins with
the digest of its own bytes.
"""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Callable
from typing import Any

from numba.core.caching import Cache, CompileResultCacheImpl
from numba.core.runtime import rtsys

from fricmb.integrate.compile.cache_files import CacheFiles, remove, say
from fricmb.integrate.compile.content import content_digest
from fricmb.integrate.compile.long_loops import has_long_loops
from fricmb.integrate.compile.plain import settle

_DIGEST = 32
#: Called with each function that the cache does not hold, before it is compiled.
on_miss: list[Callable[[Any], None]] = []


def _seal(payload: bytes) -> bytes:
    return hashlib.sha256(payload).digest() + payload


def _unseal(data: bytes) -> bytes | None:
    payload = data[_DIGEST:]
    return payload if hashlib.sha256(payload).digest() == data[:_DIGEST] else None


_files = CacheFiles("kernels", r".+-[0-9a-f]{32}\.nbc", _seal, _unseal, "compiled again")


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
        return str(_files.folder)

    def flush(self) -> None:
        """Remove the files of this function."""
        for path in _files.folder.glob(f"{self._name}-*.nbc"):
            remove(path)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The kernel for one signature, or None where there is no sound file of it."""
        found = self._find(sig, target_context)
        # before anything is compiled it is seen by which passes: what these have made is kept apart
        return self._find(sig, target_context) if found is None and settle() else found

    def _find(self, sig: Any, target_context: Any) -> Any:
        # machine code needs numba's run time alone; what compiling needs beside it is loaded when something is compiled
        rtsys.initialize(target_context)
        name = self._file(sig, target_context.codegen())
        payload = _files.read(name)
        if payload is not None:
            try:
                return self._impl.rebuild(target_context, pickle.loads(payload))
            except Exception as error:  # whatever an unsound file can bring about: the kernel is made again
                say(f"a kept kernel cannot be used ({error!r}) and is compiled again: {name}")
                _files.discard(name)
        for told in on_miss:
            told(self._py_func)
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a compiled kernel; where that cannot be done the run goes on."""
        if any(not lifted.can_cache for lifted in data.lifted) or data.library.has_dynamic_globals:
            return
        payload = pickle.dumps(_lean(self._impl.reduce(data)), protocol=-1)
        name = self._file(sig, data.codegen)
        _files.write(name, payload)

    def _file(self, sig: Any, codegen: Any) -> str:
        return f"{self._name}-{content_digest(self._py_func, self._options, sig, codegen.magic_tuple())}.nbc"


def _lean(reduced: tuple[Any, ...]) -> tuple[Any, ...]:
    """What is kept of a kernel, without the environments of functions in it that hold nothing.

    An environment holds objects of Python that machine code hands to the interpreter, as ``print`` does.  To make one,
    loading imports the module of its function: of numba's own functions nothing else asks for these modules.
    """
    *others, environments = reduced
    return *others, tuple(environment for environment in environments if environment.consts)


def cached_on_disk(compiled: Any) -> Any:
    """Let a numba dispatcher or callback keep its machine code by content."""
    function = getattr(compiled, "py_func", None) or compiled._pyfunc
    options = repr(sorted(getattr(compiled, "targetoptions", {}).items()))
    options += f" {function.__module__}"  # a kept kernel imports the module that it was compiled in
    options += " long loops" if has_long_loops(function) else ""
    compiled._cache = KernelCache(function, function.__name__, options)
    return compiled
