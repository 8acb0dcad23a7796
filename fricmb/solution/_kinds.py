"""Which classes a file may name: those of this package that hold data, and those that the reader knows already.

Nothing is imported because a file says so, unless it is one of the packages of fricmb that hold declarations and runs.
"""

from __future__ import annotations

import contextlib
import dataclasses
import importlib
import inspect
import sys
import warnings
from collections.abc import Iterable, Mapping
from typing import Any

from fricmb.errors import FricmbError
from fricmb.integrate import Trajectory
from fricmb.values import Declaration

#: Packages of fricmb whose classes are declarations and runs.
PACKAGES = ("laws", "normal", "scene", "space", "values", "integrate", "models", "_simulate")
#: Word for ``laws=``: import the modules that the file names, which runs their code.
IMPORT = "import"


def path_of(kind: type) -> str:
    """Name of a class in a file."""
    return f"{kind.__module__}:{kind.__qualname__}"


def is_own(kind: type) -> bool:
    """Whether a class belongs to these packages."""
    return _is_ours(kind.__module__)


def _is_ours(module: str) -> bool:
    package, _, rest = module.partition(".")
    return package == "fricmb" and rest.partition(".")[0] in PACKAGES


def source_of(kind: type) -> str:
    """The text of a class, "" where there is none."""
    try:
        return inspect.getsource(kind)
    except (OSError, TypeError):
        return ""


def is_data(kind: Any) -> bool:
    """Whether a class only holds data: a dataclass, a named tuple, a run, a scene."""
    if not isinstance(kind, type):
        return False
    named = issubclass(kind, tuple) and hasattr(kind, "_fields")
    return named or dataclasses.is_dataclass(kind) or issubclass(kind, Trajectory) or hasattr(kind, "_stored")


class Kinds:
    """Classes by their names in a file.

    Parameters
    ----------
    given : class, iterable of classes, dict of name to class, or "import"
        Own laws, elements and runs, as the reader hands them in.
    sources : dict of str to str
        Source of each class that is not of this package, as it was when the file was written.
    """

    def __init__(self, given: Any, sources: Mapping[str, str]) -> None:
        self._sources = dict(sources)
        self._import = given == IMPORT if isinstance(given, str) else False
        self._given: dict[str, type] = {}
        if not self._import:
            for name, kind in _pairs(given):
                self._given[name] = kind
                self._given.setdefault(path_of(kind), kind)

    def find(self, path: Any) -> type:
        """The class of that name; FricmbError where it is not known here."""
        module, _, name = str(path).partition(":")
        kind = _own(module, name) if _is_ours(module) else self._foreign(str(path), module, name)
        if not is_data(kind):
            raise FricmbError(f"{path} is no declaration, law or run")
        return kind

    def _foreign(self, path: str, module: str, name: str) -> type:
        short = name.rpartition(".")[2]
        kind = self._given.get(path) or self._given.get(short)
        if kind is None:
            if self._import:
                try:
                    importlib.import_module(module)
                except Exception as error:  # whatever a module does when it is imported
                    raise FricmbError(f"{module} cannot be imported for {name}: {error}") from error
            kind = _member(sys.modules.get(module), name)
            if kind is not None and not issubclass(kind, Declaration | Trajectory):
                kind = None
        if kind is None:
            text = self._sources.get(path, "")
            shown = f"; it was written with\n\n{text}" if text else ""
            raise FricmbError(
                f"the class {name} of {module} is not known here: import it before, hand it in with laws=[{short}], or "
                f'let its module be imported with laws="import"{shown}'
            )
        written, now = self._sources.get(path, ""), source_of(kind)
        if written and now and written != now:
            warnings.warn(f"{path} has changed since the file was written; forces are those of today", stacklevel=2)
        return kind


def _pairs(given: Any) -> Iterable[tuple[str, type]]:
    if given is None:
        return []
    held = given.values() if isinstance(given, Mapping) else [given] if isinstance(given, type) else list(given)
    for kind in held:
        if not (isinstance(kind, type) and issubclass(kind, Declaration | Trajectory)):
            raise FricmbError(f'laws: got {kind!r}; expected classes of laws and elements, or "import"')
    if isinstance(given, Mapping):
        return [(str(name), kind) for name, kind in given.items()]
    return [(kind.__name__, kind) for kind in held]


def _own(module: str, name: str) -> type:
    kind = None
    if all(word.isidentifier() and not word.startswith("__") for word in module.split(".")):
        with contextlib.suppress(ImportError):
            kind = _member(importlib.import_module(module), name)
    if kind is None or kind.__module__ != module:
        raise FricmbError(f"this version of fricmb has no {name} in {module}")
    return kind


def _member(module: Any, name: str) -> type | None:
    held = module
    for word in name.split("."):
        held = vars(held).get(word) if held is not None and hasattr(held, "__dict__") else None
    return held if isinstance(held, type) else None
