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
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from fricmb.integrate.compile.plain import is_plain, names_taken

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
    reader = _Reader()
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
            reader = _Reader()
            reader.read(kind.dispatcher)
            return "\n".join(reader.lines)
        return str(kind)

    if isinstance(signature, tuple):
        return f"({', '.join(map(describe, signature))})"
    return f"({', '.join(map(describe, signature.args))}) -> {describe(signature.return_type)}"


class _Reader:
    """Lines that say what a function is made of, each thing once, in the order in which they are met."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._numbers: dict[int, int] = {}
        self._kept: list[Any] = []  # identities stay valid while what they belong to is alive

    def read(self, thing: Any) -> None:
        """Add the lines of one thing and of all that it refers to."""
        self.lines.append(self._value(thing))

    def _value(self, thing: Any) -> str:
        if thing is None or isinstance(thing, bool | int | float | complex | str | bytes):
            return f"{type(thing).__name__} {thing!r}"
        if isinstance(thing, np.ndarray):
            values = hashlib.sha256(np.ascontiguousarray(thing).tobytes()).hexdigest()
            return f"array {thing.dtype} {thing.shape} {values}"
        if isinstance(thing, np.generic):
            return f"{thing.dtype} {thing!r}"
        if isinstance(thing, frozenset | set):
            return f"set {sorted(map(self._value, thing))}"
        if isinstance(thing, tuple | list):
            fields = getattr(thing, "_fields", "")
            return f"{type(thing).__qualname__} {fields} [{', '.join(map(self._value, thing))}]"
        if isinstance(thing, dict):
            inside = (f"{self._value(name)}: {self._value(value)}" for name, value in thing.items())
            return f"dict {{{', '.join(inside)}}}"
        return self._once(thing)

    def _once(self, thing: Any) -> str:
        number = self._numbers.get(id(thing))
        if number is None:
            number = self._numbers[id(thing)] = len(self._numbers)
            self._kept.append(thing)
            self.lines.append(f"{number}: {self._inside(thing)}")
        return f"see {number}"

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
        if isinstance(thing, FunctionType):
            return self._function(thing)
        if isinstance(thing, CodeType):
            return self._code(thing, {})
        module = getattr(thing, "__module__", None) or ""
        if isinstance(thing, ModuleType):
            return f"module {thing.__name__}"
        if isinstance(thing, type):
            return self._class(thing)
        if isinstance(thing, BuiltinFunctionType | np.ufunc):
            return f"builtin {module}.{thing.__name__}"
        name = getattr(thing, "__qualname__", None) or getattr(thing, "__name__", None)
        return f"{type(thing).__module__}.{type(thing).__qualname__} {name or str(thing)}"

    def _class(self, kind: type) -> str:
        """A class of this package by its fields or source, any other by name."""
        fields = getattr(kind, "_fields", None)
        if fields is not None:
            return f"named tuple {kind.__qualname__} {fields}"
        if kind.__module__.partition(".")[0] == __name__.partition(".")[0]:
            return f"class {kind.__qualname__} {inspect.getsource(kind)}"
        return f"class {kind.__module__}.{kind.__qualname__}"

    def _function(self, function: FunctionType) -> str:
        if not _is_followed(function):
            return f"function {function.__module__}.{function.__qualname__}"
        cells = [cell.cell_contents for cell in function.__closure__ or ()]
        inside = self._code(function.__code__, function.__globals__, function.__doc__)
        return f"function {inside} cells {self._value(cells)} defaults {self._value(function.__defaults__)}"

    def _code(self, code: CodeType, around: dict[str, Any], doc: str | None = None) -> str:
        constants = []
        for constant in code.co_consts:
            if isinstance(constant, str) and constant == doc:
                continue
            is_code = isinstance(constant, CodeType)
            constants.append(self._code(constant, around) if is_code else self._value(constant))
        names, taken = [], names_taken(code)
        for name in code.co_names:
            if name in around and name in taken:
                names.append(f"{name} = {self._global(around[name], code.co_names)}")
            else:
                names.append(name)
        return f"{code.co_code.hex()} {code.co_varnames} {code.co_freevars} {constants} {names}"

    def _global(self, thing: Any, names: tuple[str, ...]) -> str:
        """A global; of a module of this package, what the function may take from it."""
        if isinstance(thing, ModuleType) and _own(thing.__name__):
            taken = [f"{name} = {self._value(getattr(thing, name))}" for name in names if hasattr(thing, name)]
            return f"module {thing.__name__} {taken}"
        return self._value(thing)


def _own(module: str) -> bool:
    return module.partition(".")[0] == __name__.partition(".")[0]


def _is_followed(function: FunctionType) -> bool:
    """Whether a function's code can change without a version that the stamp names: not that of numba and numpy."""
    return function.__module__.partition(".")[0] not in ("numba", "llvmlite", "numpy", "math", "scipy", "typing")
