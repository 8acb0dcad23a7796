"""Derived templates on disk: one file of facts and of the source of the compiled kernel, keyed by content.

Several processes may start together on an empty cache: a file appears whole, and its content is given by its key.  It
begins with a line that holds the digest of the rest (:mod:`fricmb.integrate.compile.cache_files` says what becomes of
files that are damaged and of folders that cannot be written).
"""

from __future__ import annotations

import ast
import ctypes
import hashlib
import json
import linecache
import sys
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

from fricmb.integrate.compile.cache_files import CacheFiles

#: Raised by one whenever the shape of the stored facts or of the kernels changes.
FORMAT = 2




def _seal(text: bytes) -> bytes:
    return hashlib.sha256(text).hexdigest().encode() + b"\n" + text


def _unseal(data: bytes) -> bytes | None:
    digest, _, text = data.partition(b"\n")
    return text if hashlib.sha256(text).hexdigest().encode() == digest else None


_files = CacheFiles("templates", r"\w+_[0-9a-f]{24}\.json", _seal, _unseal, "derived again")


def folder() -> Path:
    """Where derived templates are kept."""
    return _files.folder


@cache
def _generator() -> str:
    """Fingerprint of the code that derives and prints, so that an upgrade never serves an old template."""
    from importlib.metadata import version

    digest = hashlib.sha256(version("sympy").encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def key(kind: str, *content: object) -> str:
    """Key of a template: what it is derived from, the generator and the version of SymPy."""
    text = json.dumps([FORMAT, kind, _generator(), [str(part) for part in content]])
    return f"{kind}_{hashlib.sha256(text.encode()).hexdigest()[:24]}"


def _held(name: str) -> dict[str, Any] | None:
    text = _files.read(f"{name}.json")
    return None if text is None else dict(json.loads(text))


def read(name: str) -> dict[str, Any] | None:
    """Facts stored under a key, or None."""
    held = _held(name)
    return None if held is None else {**held["facts"], "compiled": held["source"] is not None}


def write(name: str, facts: dict[str, Any], source: str | None) -> None:
    """Store facts and the source of the kernel."""
    facts["compiled"] = source is not None
    _files.write(f"{name}.json", json.dumps({"facts": facts, "source": source}, indent=1).encode())
    if source is not None:
        _sources[name] = source


#: Sources that this process derived or read.
_sources: dict[str, str] = {}


def source_of(name: str) -> str:
    """The source of the kernel stored under a key."""
    return str(_sources.get(name) or (_held(name) or {})["source"])


@cache
def _module(name: str) -> Any:
    """The module of a kernel, known by name, its source to be found by tracebacks."""
    source = source_of(name)
    path = f"<template {name}>"
    linecache.cache[path] = len(source), None, source.splitlines(keepends=True), path
    # machine code is kept by content and knows its module by name: the same content has the same one
    module = ModuleType(f"fricmb_template_{hashlib.sha256(_without_title(source).encode()).hexdigest()[:24]}")
    module.__file__ = path
    sys.modules[module.__name__] = module
    exec(compile(source, path, "exec"), vars(module))
    return module


def _without_title(source: str) -> str:
    first = ast.parse(source).body[0]
    return "\n".join(source.splitlines()[first.end_lineno if isinstance(first, ast.Expr) else 0 :])


def address(name: str) -> int:
    """Address of the compiled kernel stored under a key; compiled, or read from the cache, on first use."""
    return int(_module(name).kernel.address)


_POINTER = ctypes.POINTER(ctypes.c_double)
_PROTOTYPE = ctypes.CFUNCTYPE(None, _POINTER, _POINTER, _POINTER)


@cache
def function(template_address: int) -> Any:
    """Call a template from Python: ``call(x, p, out)`` on contiguous float64 arrays."""
    call = _PROTOTYPE(template_address)

    def evaluate(x: Any, p: Any, out: Any) -> None:
        call(x.ctypes.data_as(_POINTER), p.ctypes.data_as(_POINTER), out.ctypes.data_as(_POINTER))

    return evaluate
