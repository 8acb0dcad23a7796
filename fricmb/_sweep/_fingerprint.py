"""A name for a computation by its content, the same in every process and on every day.

Functions and classes count by their code and by all that it refers to: helpers, globals, constants of classes, what
closures hold, each once.  Those of Python itself, of fricmb and of installed packages count by name and version.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import pickle
import sys
import types
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from fricmb.scene import Scene
from fricmb.solution import Solution
from fricmb.values import DIMENSIONS, parameters_in

#: Methods with these names count; others with two underscores are made by Python or by dataclasses.
_SPECIAL = ("__init__", "__post_init__", "__call__", "__new__")


def fingerprint(*values: Any) -> str:
    """Hexadecimal digest of values: numbers, arrays, declarations, expressions, functions and what holds them."""
    return Fingerprint().of(*values)


class Fingerprint:
    """Makes digests.

    Attributes
    ----------
    unseen : list of str
        What was met and cannot be followed: a change of it leaves the digest as it is.
    """

    def __init__(self) -> None:
        self.unseen: list[str] = []
        self._numbers: dict[int, int] = {}
        self._alive: list[Any] = []

    def of(self, *values: Any) -> str:
        """Digest of values."""
        digest = hashlib.sha256()
        for token in self._tokens(values):
            digest.update(len(token).to_bytes(8, "little"))
            digest.update(token)
        return digest.hexdigest()

    def _tokens(self, value: Any) -> Iterator[bytes]:
        if value is None or isinstance(value, bool | int | str | bytes | complex):
            yield repr(value).encode()
        elif isinstance(value, float):
            yield value.hex().encode()
        elif isinstance(value, np.ndarray | np.generic):
            yield from self._array(np.asarray(value))
        elif isinstance(value, Mapping):
            yield b"mapping"
            for key in sorted(value, key=repr):
                yield from self._tokens(key)
                yield from self._tokens(value[key])
        elif isinstance(value, tuple | list):
            yield f"sequence of {len(value)}".encode()
            for item in value:
                yield from self._tokens(item)
        elif isinstance(value, set | frozenset):
            yield f"set {sorted(fingerprint(item) for item in value)}".encode()
        else:
            yield from self._once(value)

    def _once(self, value: Any) -> Iterator[bytes]:
        """Functions, classes, modules and objects; what was met before counts by its place."""
        number = self._numbers.get(id(value))
        if number is not None:
            yield f"see {number}".encode()
            return
        self._numbers[id(value)] = len(self._numbers)
        self._alive.append(value)
        if isinstance(value, type):
            yield from self._class(value)
        elif isinstance(value, types.ModuleType):
            yield from _named(value.__name__)
        elif isinstance(value, types.FunctionType | functools.partial | types.MethodType):
            yield from self._function(value)
        elif isinstance(value, types.BuiltinFunctionType | np.ufunc):
            yield from _named(getattr(value, "__module__", None) or "builtins", value.__name__)
        elif isinstance(inner := getattr(value, "py_func", getattr(value, "__wrapped__", None)), types.FunctionType):
            yield type(value).__qualname__.encode()
            yield from self._tokens(inner)
        else:
            yield from self._object(value)

    def _array(self, array: np.ndarray[Any, Any]) -> Iterator[bytes]:
        yield f"{array.dtype.str} {array.shape}".encode()
        if array.dtype == object:
            yield from self._tokens(array.ravel().tolist())
        else:
            yield np.ascontiguousarray(array).tobytes()

    def _object(self, value: Any) -> Iterator[bytes]:
        module = type(value).__module__.partition(".")[0]
        if isinstance(value, Solution):
            yield from self._tokens((value.end, value.scene))
        elif isinstance(value, Scene):
            named = () if value.units == DIMENSIONS else (value.units,)
            yield from self._tokens(("scene", value.name, value.parts, *named))
        elif module == "sympy" or _is_expression(value):
            yield from self._expression(value)
        elif module == "scipy" and hasattr(value, "tocoo"):
            matrix = value.tocoo()
            yield from self._tokens((matrix.shape, matrix.row, matrix.col, matrix.data))
        elif dataclasses.is_dataclass(value):
            yield from self._tokens(type(value))
            for field in dataclasses.fields(value):
                yield field.name.encode()
                yield from self._tokens(getattr(value, field.name))
        else:
            yield from self._tokens(type(value))
            yield from self._pickled(value)

    def _pickled(self, value: Any) -> Iterator[bytes]:
        try:
            yield pickle.dumps(value, protocol=4)
        except Exception:  # whatever an object has against being pickled
            self.unseen.append(f"a {type(value).__module__}.{type(value).__qualname__}")

    def _expression(self, value: Any) -> Iterator[bytes]:
        import sympy

        yield sympy.srepr(value).encode()
        yield from self._tokens(sorted((p.name, p.value) for p in parameters_in(value)))

    def _class(self, cls: type) -> Iterator[bytes]:
        yield from _named(cls.__module__, cls.__qualname__)
        if _is_library(cls.__module__):
            return
        for base in cls.__mro__:
            if _is_library(base.__module__):
                yield from _named(base.__module__, base.__qualname__)
                continue
            for name, member in sorted(vars(base).items()):
                yield from self._member(name, member)

    def _member(self, name: str, member: Any) -> Iterator[bytes]:
        """A method, a property, or a constant of a class."""
        if name.startswith("__") and name not in _SPECIAL:
            return
        if isinstance(member, staticmethod | classmethod):
            member = member.__func__
        if isinstance(member, property):
            member = member.fget
        if isinstance(member, functools.cached_property):
            member = member.func
        if isinstance(member, types.MemberDescriptorType | types.GetSetDescriptorType) or name.startswith("_abc_"):
            return
        yield name.encode()
        yield from self._tokens(member)

    def _function(self, function: Any) -> Iterator[bytes]:
        if isinstance(function, functools.partial):
            yield from self._tokens(("partial", function.func, function.args, function.keywords))
        elif isinstance(function, types.MethodType):
            yield from self._tokens(("method", function.__self__, function.__func__))
        elif _is_library(function.__module__ or ""):
            yield from _named(function.__module__ or "", function.__qualname__)
        else:
            yield f"{function.__module__}.{function.__qualname__}".encode()
            names: set[str] = set()
            yield from self._code(function.__code__, names)
            yield from self._tokens((function.__defaults__, function.__kwdefaults__))
            yield from self._tokens([_content(cell) for cell in function.__closure__ or ()])
            yield from self._globals(names, function.__globals__)

    def _globals(self, names: set[str], around: Mapping[str, Any]) -> Iterator[bytes]:
        """What the names of a function stand for; of a module of the user's, what may be taken from it."""
        for name in sorted(names & around.keys()):
            value = around[name]
            yield name.encode()
            yield from self._tokens(value)
            if isinstance(value, types.ModuleType) and not _is_library(value.__name__):
                held = vars(value)
                for taken in sorted(names & held.keys()):
                    yield taken.encode()
                    yield from self._tokens(held[taken])

    def _code(self, code: types.CodeType, names: set[str]) -> Iterator[bytes]:
        names.update(code.co_names)
        yield code.co_code
        yield repr((code.co_names, code.co_varnames, code.co_freevars)).encode()
        for constant in code.co_consts:
            if isinstance(constant, types.CodeType):
                yield from self._code(constant, names)
            else:
                yield from self._tokens(constant)


def _content(cell: Any) -> Any:
    try:
        return cell.cell_contents
    except ValueError:  # not filled yet
        return None


def _is_expression(value: Any) -> bool:
    return any(base.__module__.partition(".")[0] == "sympy" for base in type(value).__mro__)


def _named(module: str, name: str = "") -> Iterator[bytes]:
    """A thing by its name; of a library with the version."""
    top = sys.modules.get(module.partition(".")[0])
    # the version of fricmb is said once, by who asks
    version = "" if module.startswith("fricmb") else getattr(top, "__version__", "")
    yield f"{module}.{name} {version if isinstance(version, str) else ''}".encode()


@functools.cache
def _is_library(module: str) -> bool:
    top = module.partition(".")[0]
    if top in ("builtins", "fricmb") or top in sys.stdlib_module_names:
        return True
    path = str(getattr(sys.modules.get(top), "__file__", None) or "").replace("\\", "/")
    return "/site-packages/" in path or "/dist-packages/" in path
