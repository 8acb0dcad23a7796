"""A name for a computation by its content, the same in every process and on every day.

Functions and classes count by their code and by all that it refers to (:mod:`fricmb.integrate.compile.code_reader`).
Those of Python itself, of fricmb and of installed packages count by name and version.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import pickle
import sys
import types
from collections.abc import Mapping
from typing import Any

import numpy as np

from fricmb.integrate.compile.code_reader import CodeReader
from fricmb.scene import Scene
from fricmb.solution import Solution
from fricmb.values import DIMENSIONS, parameters_in

#: Methods with these names count; others with two underscores are made by Python or by dataclasses.
_SPECIAL = ("__init__", "__post_init__", "__call__", "__new__")


def fingerprint(*values: Any) -> str:
    """Hexadecimal digest of values: numbers, arrays, declarations, expressions, functions and what holds them."""
    return Fingerprint().of(*values)


class Fingerprint(CodeReader):
    """Makes digests.

    Attributes
    ----------
    unseen : list of str
        What was met and cannot be followed: a change of it leaves the digest as it is.
    """

    def __init__(self) -> None:
        super().__init__()
        self.unseen: list[str] = []

    def of(self, *values: Any) -> str:
        """Digest of values."""
        self.lines.clear()
        self.read(values)
        return hashlib.sha256("\n".join(self.lines).encode()).hexdigest()

    def _follows(self, module: str) -> bool:
        return not _is_library(module)

    def _named(self, module: str, name: str) -> str:
        """Of a library with the version; that of fricmb is said once, by who asks."""
        top = sys.modules.get(module.partition(".")[0])
        version = "" if module.startswith("fricmb") else getattr(top, "__version__", "")
        return f"{module}.{name} {version if isinstance(version, str) else ''}"

    def _value(self, thing: Any) -> str:
        if isinstance(thing, Mapping):  # in whatever order
            held = sorted(thing.items(), key=lambda item: repr(item[0]))
            return f"mapping {super()._value([entry for item in held for entry in item])}"
        if isinstance(thing, set | frozenset):
            return f"set {sorted(fingerprint(item) for item in thing)}"
        if isinstance(thing, np.ndarray) and thing.dtype == object:
            return f"array {thing.shape} {self._value(thing.ravel().tolist())}"
        return super()._value(thing)

    def _inside(self, thing: Any) -> str:
        if isinstance(thing, functools.partial):
            return f"partial {self._value((thing.func, thing.args, thing.keywords))}"
        if isinstance(thing, types.MethodType):
            return f"method {self._value((thing.__self__, thing.__func__))}"
        inner = getattr(thing, "py_func", getattr(thing, "__wrapped__", None))
        if isinstance(inner, types.FunctionType) and not isinstance(thing, type | types.FunctionType):
            return f"{type(thing).__qualname__} of {self._value(inner)}"
        return super()._inside(thing)

    def _function(self, function: types.FunctionType) -> str:
        return f"{function.__module__}.{function.__qualname__} {super()._function(function)}"

    def _other(self, thing: Any) -> str:
        if isinstance(thing, Solution):
            return f"solution {self._value((thing.end, thing.scene))}"
        if isinstance(thing, Scene):
            named = () if thing.units == DIMENSIONS else (thing.units,)
            return f"scene {self._value((thing.name, thing.parts, *named))}"
        module = type(thing).__module__.partition(".")[0]
        if module == "sympy" or _is_expression(thing):
            import sympy

            values = sorted((p.name, p.value) for p in parameters_in(thing))
            return f"expression {sympy.srepr(thing)} {self._value(values)}"
        if module == "scipy" and hasattr(thing, "tocoo"):
            matrix = thing.tocoo()
            return f"matrix {self._value((matrix.shape, matrix.row, matrix.col, matrix.data))}"
        if dataclasses.is_dataclass(thing):
            held = [(field.name, getattr(thing, field.name)) for field in dataclasses.fields(thing)]
            return f"{self._value(type(thing))} {self._value(held)}"
        return f"{self._value(type(thing))} {self._pickled(thing)}"

    def _pickled(self, thing: Any) -> str:
        try:
            return hashlib.sha256(pickle.dumps(thing, protocol=4)).hexdigest()
        except Exception:  # whatever an object has against being pickled
            self.unseen.append(f"a {type(thing).__module__}.{type(thing).__qualname__}")
            return ""

    def _class(self, kind: type) -> str:
        name = super()._class(kind)
        if _is_library(kind.__module__):
            return name
        held = []
        for base in kind.__mro__:
            if _is_library(base.__module__):
                held.append(self._named(base.__module__, base.__qualname__))
            else:
                members = ((key, _inner(member)) for key, member in sorted(vars(base).items()) if _counts(key, member))
                held += [f"{key}: {self._value(member)}" for key, member in members]
        return f"{name} {held}"


def _counts(name: str, member: Any) -> bool:
    """Whether something in a class is a method, a property or a constant that its author wrote."""
    made = isinstance(member, types.MemberDescriptorType | types.GetSetDescriptorType) or name.startswith("_abc_")
    return not made and (not name.startswith("__") or name in _SPECIAL)


def _inner(member: Any) -> Any:
    """The function of a method or property."""
    if isinstance(member, staticmethod | classmethod):
        member = member.__func__
    if isinstance(member, property):
        member = member.fget
    return member.func if isinstance(member, functools.cached_property) else member


def _is_expression(value: Any) -> bool:
    return any(base.__module__.partition(".")[0] == "sympy" for base in type(value).__mro__)


@functools.cache
def _is_library(module: str) -> bool:
    top = module.partition(".")[0]
    if top in ("builtins", "fricmb") or top in sys.stdlib_module_names:
        return True
    path = str(getattr(sys.modules.get(top), "__file__", None) or "").replace("\\", "/")
    return "/site-packages/" in path or "/dist-packages/" in path
