"""What a compiled kernel is made of: a text of its own code and of all that is compiled into it.

Numba's own stamp is the time and size of the caller's file, so an edit of a kernel that is *called*, or an upgrade that
keeps a file, would go on running old machine code.  Here the stamp follows the code: functions by their bytecode (so
comments and docstrings do not count), kernels that they call, constants, named tuples, and for a block
that is called by name the layouts it takes, but not its inside: that is compiled on its own.
"""

from __future__ import annotations

import hashlib
import inspect
import sys
from functools import lru_cache
from pathlib import Path
from typing import Any

from fricmb.integrate.compile.code_reader import CodeReader
from fricmb.integrate.compile.plain import is_plain

#: Sources whose content goes into every stamp: how rooms and calls are put into machine code.
_COMPILER = ("layout", "room", "lanes", "block", "template", "kernel", "compilers")
#: Those of the quick passes, which go into the stamps of what is compiled by them.
_QUICK = ("passes", "kernel_library", "quick_typing", "short_lowering", "array_view")


@lru_cache(maxsize=2)
def _toolchain(plain: bool) -> str:
    import llvmlite
    import numba

    digest = hashlib.sha256()
    for name in (*_COMPILER, *(() if plain else (f"fast/{name}" for name in _QUICK))):
        digest.update((Path(__file__).parent / f"{name}.py").read_bytes())
    versions = f"{sys.implementation.cache_tag} numba {numba.__version__} llvmlite {llvmlite.__version__}"
    return f"{versions} {'plain' if plain else 'quick'} {digest.hexdigest()}"


def content_digest(function: Any, options: str, signature: Any, machine: Any) -> str:
    """Digest of a kernel for one signature on one processor; equal exactly where the machine code may be shared."""
    reader = KernelReader()
    reader.read(function)
    text = "\n".join([_toolchain(is_plain()), options, describe_signature(signature), repr(machine), *reader.lines])
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def describe_signature(signature: Any) -> str:
    """Numba's signature as text; named tuples with the names of their fields, kernels with their content."""
    from numba.core import types as numba_types

    types: Any = numba_types

    def describe(kind: Any) -> str:
        if isinstance(kind, types.BaseNamedTuple):
            named = zip(kind.fields, kind.types, strict=True)
            return f"{kind.instance_class.__qualname__}({', '.join(f'{name}: {describe(x)}' for name, x in named)})"
        if isinstance(kind, types.BaseTuple):
            return f"({', '.join(describe(inside) for inside in kind)})"
        if isinstance(kind, types.Dispatcher):
            reader = KernelReader()
            reader.read(kind.dispatcher)
            return "\n".join(reader.lines)
        return str(kind)

    if isinstance(signature, tuple):
        return f"({', '.join(map(describe, signature))})"
    return f"({', '.join(map(describe, signature.args))}) -> {describe(signature.return_type)}"


class KernelReader(CodeReader):
    """Reads kernels, and what is compiled into them."""

    def _follows(self, module: str) -> bool:
        """Not those of which the stamp names the version."""
        return module.partition(".")[0] not in ("numba", "llvmlite", "numpy", "math", "scipy", "typing")

    def _opens(self, module: str) -> bool:
        return _own(module)

    def _inside(self, thing: Any) -> str:
        called = getattr(thing, "called_by_address", None)
        if called is not None and not isinstance(thing, type):
            return f"block {called()}"
        compiled = getattr(thing, "py_func", None)
        if compiled is not None:
            # what is kept names the module: of two versions with other modules each finds its own
            options = sorted(thing.targetoptions.items())
            return f"kernel of {compiled.__module__} {options!r} {self._value(compiled)}"
        defined = getattr(thing, "_defn", None)
        if defined is not None:
            return f"intrinsic {self._value(defined)}"
        return super()._inside(thing)

    def _class(self, kind: type) -> str:
        """A class of this package by its fields or source, any other by name."""
        fields = getattr(kind, "_fields", None)
        if fields is not None:
            return f"named tuple {kind.__qualname__} {fields}"
        if _own(kind.__module__):
            return f"class {kind.__qualname__} {inspect.getsource(kind)}"
        return super()._class(kind)


def _own(module: str) -> bool:
    return module.partition(".")[0] == __name__.partition(".")[0]
