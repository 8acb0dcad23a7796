"""What a function is made of, as text: its own code and all that this refers to.

Functions count by their bytecode (so comments and docstrings do not), by what they take from their modules and hold in
closures, defaults included, each thing once.  Who asks says which modules are followed and which count by their name,
and what other things are made of: kernels (:mod:`fricmb.integrate.compile.content`), values of sweeps.
"""

from __future__ import annotations

import hashlib
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from fricmb.integrate.compile.plain import names_taken


class CodeReader:
    """Lines that say what things are made of, each thing once, in the order in which they are met.

    Attributes
    ----------
    lines : list of str
        Equal for equal things, in every process.
    """

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._numbers: dict[int, int] = {}
        self._kept: list[Any] = []  # identities stay valid while what they belong to is alive

    def read(self, thing: Any) -> None:
        """Add the lines of one thing and of all that it refers to."""
        self.lines.append(self._value(thing))

    # -- what subclasses say ------------------------------------------------------------------------------------
    def _follows(self, module: str) -> bool:
        """Whether functions of a module count by their code, not by their name."""
        raise NotImplementedError

    def _opens(self, module: str) -> bool:
        """Whether of a module all counts that a function may take from it."""
        return self._follows(module)

    def _named(self, module: str, name: str) -> str:
        """What counts by its name."""
        return f"{module}.{name}"

    def _class(self, kind: type) -> str:
        """What a class is made of."""
        return f"class {self._named(kind.__module__, kind.__qualname__)}"

    def _other(self, thing: Any) -> str:
        """What anything else is made of."""
        name = getattr(thing, "__qualname__", None) or getattr(thing, "__name__", None)
        return f"{type(thing).__module__}.{type(thing).__qualname__} {name or str(thing)}"

    # -- values -------------------------------------------------------------------------------------------------
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
        if isinstance(thing, FunctionType):
            return self._function(thing)
        if isinstance(thing, CodeType):
            return self._code(thing, {})
        if isinstance(thing, ModuleType):
            return f"module {thing.__name__}"
        if isinstance(thing, type):
            return self._class(thing)
        if isinstance(thing, BuiltinFunctionType | np.ufunc):
            return f"builtin {self._named(getattr(thing, '__module__', None) or '', thing.__name__)}"
        return self._other(thing)

    # -- functions ----------------------------------------------------------------------------------------------
    def _function(self, function: FunctionType) -> str:
        if not self._follows(function.__module__ or ""):
            return f"function {self._named(function.__module__, function.__qualname__)}"
        cells = [_content(cell) for cell in function.__closure__ or ()]
        inside = self._code(function.__code__, function.__globals__, function.__doc__)
        named = f" named defaults {self._value(function.__kwdefaults__)}" if function.__kwdefaults__ else ""
        return f"function {inside} cells {self._value(cells)} defaults {self._value(function.__defaults__)}{named}"

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
        """A global; of a module that is opened, what the function may take from it."""
        if isinstance(thing, ModuleType) and self._opens(thing.__name__):
            taken = [f"{name} = {self._value(getattr(thing, name))}" for name in names if hasattr(thing, name)]
            return f"module {thing.__name__} {taken}"
        return self._value(thing)


def _content(cell: CellType) -> Any:
    try:
        return cell.cell_contents
    except ValueError:  # not filled yet
        return None
