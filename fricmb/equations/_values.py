"""Numbers and structure of a declaration, without SymPy: what the warm path needs."""

from __future__ import annotations

import dataclasses
import hashlib
import sys
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from fricmb import laws
from fricmb.values import Declaration, Parameter, held, is_expression, is_foreign, value_of
from fricmb.values._declaration import slot_values

_LAWS = "fricmb.laws"


def _symbolic_slots(declaration: Declaration) -> list[tuple[str, Any]]:
    """Slots that become symbols in a stand-in, in the order of ``values.symbolic``."""
    found: list[tuple[str, Any]] = []
    for field in dataclasses.fields(declaration):  # type: ignore[arg-type]
        if field.name in declaration._fixed:
            continue
        held = getattr(declaration, field.name)
        if isinstance(held, Declaration):
            found += [] if held._referred else [(f"{field.name}.{p}", v) for p, v in _symbolic_slots(held)]
            continue
        entries = held.items() if isinstance(held, Mapping) else ((None, held),)
        for key, value in entries:
            if _is_number(value):
                found.append((field.name if key is None else f"{field.name}.{key}", value))
    return found


def _is_number(value: Any) -> bool:
    if isinstance(value, tuple):
        return len(value) > 0 and all(_is_number(entry) for entry in value)
    if isinstance(value, bool):
        return False
    return isinstance(value, int | float | np.integer | np.floating | Parameter) or _of_parameters(value)


def _of_parameters(value: Any) -> bool:
    if not is_expression(value):
        return False
    try:
        value_of(value)
    except TypeError:
        return False
    return True


def numbers(declaration: Declaration) -> tuple[float, ...]:
    """The numbers behind a stand-in's symbols, in the order of ``symbolic(declaration).flat``."""
    plain = declaration.plain_numbers()
    if plain is not None:
        return plain
    found: list[float] = []
    kind: Any = type(declaration)
    values = slot_values(kind)(declaration)
    if _PLAIN.issuperset(map(type, values)):
        return tuple([value for value in values if type(value) is float])
    for _, value in _symbolic_slots(declaration):
        if isinstance(value, tuple):
            found.extend(float(value_of(entry)) for entry in value)
        else:
            found.append(float(value_of(value)))
    return tuple(found)


def structure(declaration: Declaration) -> tuple[Any, ...]:
    """What selects the formulas of a declaration beside its type: options, lengths of tuples, fixed fields of its own.

    A ``name`` and the parts that an element acts on never enter a formula.
    """
    kind: Any = type(declaration)
    if not _is_ours(kind):
        return _structure(declaration)
    values = slot_values(kind)(declaration)
    types = tuple(map(type, values))
    key = (kind, types, tuple([value for value in values if type(value) is bool])) if bool in types else (kind, types)
    found = _plain_structures.get(key)
    if found is None:
        found = _structure(declaration)
        if _PLAIN.issuperset(types):
            _plain_structures[key] = found
    return found


#: Of types of this package that hold floats, flags, and None in some fields: by the flags always the same.
_plain_structures: dict[tuple[Any, ...], tuple[Any, ...]] = {}
_PLAIN = frozenset((float, bool, type(None)))


def _structure(declaration: Declaration) -> tuple[Any, ...]:
    shapes = tuple(
        (path, len(value) if isinstance(value, tuple) else 0) for path, value in _symbolic_slots(declaration)
    )
    names = [f.name for f in dataclasses.fields(declaration) if f.name in declaration._fixed]  # type: ignore[arg-type]
    own = () if _is_ours(type(declaration)) else names
    fixed = tuple((n, repr(getattr(declaration, n))) for n in own if _plain(getattr(declaration, n)) and n != "name")
    options = tuple(sorted((n, repr(value)) for n, value in declaration.options().items() if _plain(value)))
    inner = tuple(structure(law) for law in _inner(declaration))
    return (type(declaration), shapes, options, fixed, foreign(declaration), *inner)


def foreign(declaration: Declaration) -> tuple[Any, ...]:
    """Functions, arrays and objects of anybody else's in the fields of a declaration, as keys.

    A type of this package makes no formula of arrays or expressions; of functions it might.
    """
    taken = {path.split(".")[0] for path, _ in _symbolic_slots(declaration)}
    ours = _is_ours(type(declaration))
    found = []
    for field in dataclasses.fields(declaration):  # type: ignore[arg-type]
        value = getattr(declaration, field.name)
        if field.name not in taken and is_foreign(value) and (callable(value) or not ours):
            found.append((field.name, held(value)))
    return tuple(found)


def _inner(declaration: Declaration) -> list[Declaration]:
    """Declarations inside fields: a law made of another."""
    held = [getattr(declaration, f.name) for f in dataclasses.fields(declaration)]  # type: ignore[arg-type]
    return [value for value in held if isinstance(value, Declaration) and not value._referred]


def _plain(value: Any) -> bool:
    if isinstance(value, tuple):
        return all(_plain(entry) for entry in value)
    return value is None or isinstance(value, str | bool | int | float)


_ours: dict[type, bool] = {}


def _is_ours(kind: type) -> bool:
    """Whether a type and all it inherits from belong to this package, so that its source file identifies it."""
    if kind not in _ours:
        _ours[kind] = _belongs(kind)
    return _ours[kind]


def _belongs(kind: type) -> bool:
    return all(base.__module__.split(".")[0] in ("fricmb", "builtins", "abc", "typing") for base in kind.__mro__)


def fingerprint(declaration: Declaration) -> str | None:
    """Fingerprint of the source of a declaration and of those inside it.

    None where one is anybody else's, or holds what is: then its source does not say all.
    """
    kind: Any = type(declaration)
    if foreign(declaration):
        return None
    marks = [source_fingerprint(kind), *(fingerprint(inner) for inner in _inner(declaration))]
    return None if None in marks else "".join(map(str, marks))


@cache
def source_fingerprint(kind: type) -> str | None:
    """Fingerprint of the source of a type of this package; None for a type of anybody else's."""
    if not _is_ours(kind):
        return None
    files = {sys.modules[base.__module__].__file__ for base in kind.__mro__ if base.__module__.startswith("fricmb")}
    # what the laws of this package share
    files |= {str(path) for path in Path(laws.__file__).parent.glob("_*.py") if kind.__module__.startswith(_LAWS)}
    digest = hashlib.sha256(kind.__qualname__.encode())
    for file in sorted(f for f in files if f is not None):
        digest.update(Path(file).read_bytes())
    return digest.hexdigest()
