"""What every declaration shares: checks that name argument, value and what is accepted; slots; equality by value."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from functools import cache
from math import isfinite
from operator import attrgetter
from types import MappingProxyType
from typing import Any, ClassVar, NoReturn, Self

import numpy as np

from fricmb._calls import SignatureOfInit, answering
from fricmb.errors import FricmbError, SceneError, shown, unknown_name
from fricmb.values._numbers import (
    Number,
    finite,
    is_expression,
    is_plain,
    is_sparse,
    substitute,
    symbol_values,
    value_of,
)
from fricmb.values._parameter import Parameter

_answering: set[type] = set()
_fields: dict[type, tuple[str, ...]] = {}
_slot_fields: dict[type, tuple[str, ...]] = {}


def field_names(kind: type) -> tuple[str, ...]:
    """Names of the fields of a dataclass."""
    found = _fields.get(kind)
    if found is None:
        found = _fields[kind] = tuple(f.name for f in dataclasses.fields(kind))
    return found


def slot_fields(kind: type[Declaration]) -> tuple[str, ...]:
    """Names of the fields that may hold slots."""
    found = _slot_fields.get(kind)
    if found is None:
        found = _slot_fields[kind] = tuple(name for name in field_names(kind) if name not in kind._fixed)
    return found


def values_of(kind: type, names: tuple[str, ...]) -> Callable[[Any], tuple[Any, ...]]:
    """A function that reads the named attributes of an object of that type, in one call."""
    if len(names) > 1:
        return attrgetter(*names)
    return (lambda held: (getattr(held, names[0]),)) if names else (lambda held: ())


@cache
def slot_values(kind: Any) -> Callable[[Any], tuple[Any, ...]]:
    """A function that reads the fields that may hold slots."""
    return values_of(kind, slot_fields(kind))


class Declaration:
    """Base of the frozen dataclasses that a scene is made of.

    A *slot* is a place for a number: a field, an entry of a dict field ("velocity.x"), or a slot of a declaration
    inside a field ("law.mu_k").  Its value is a float, a :class:`Parameter`, a SymPy expression, a tuple of such, an
    array or a sparse matrix.
    """

    __signature__: ClassVar[Any] = SignatureOfInit()

    def __new__(cls, *args: Any, **kwargs: Any) -> Self:
        if cls not in _answering:  # a dataclass has its constructor only now
            _answering.add(cls)
            answering(cls)
        return object.__new__(cls)

    #: Error that a wrong value raises.
    _error: ClassVar[type[FricmbError]] = SceneError
    #: Fields that hold no slots (names, ends, axes).
    _fixed: ClassVar[tuple[str, ...]] = ()
    #: Fields whose numbers are > 0: their symbols are declared positive, which SymPy needs to simplify powers.
    positive: ClassVar[tuple[str, ...]] = ()
    #: Whether a field that holds this declaration only refers to it (a part; a law belongs to its contact instead).
    _referred: ClassVar[bool] = False

    # -- checks -------------------------------------------------------------------------------------------------
    def _label(self) -> str:
        """How messages call this declaration."""
        return type(self).__name__

    def _refuse(self, argument: str, value: object, accepted: str) -> NoReturn:
        raise self._error(f"{self._label()}: {argument} must be {accepted}, got {shown(value)}")

    def _set(self, field: str, value: Any) -> None:
        object.__setattr__(self, field, value)

    def _number(self, argument: str, value: Any, *, above: float | None = None, minimum: float | None = None) -> Number:
        """A checked number: float, Parameter, or expression of parameters."""
        if type(value) is float and isfinite(value):
            good = (above is None or value > above) and (minimum is None or value >= minimum)
            if good:
                return value
        accepted = "a finite number"
        if above is not None:
            accepted += f" > {above:g}"
        if minimum is not None:
            accepted += f" >= {minimum:g}"
        plain = self._plain(argument, value, accepted)
        if not finite(plain) or (above is not None and plain <= above) or (minimum is not None and plain < minimum):
            self._refuse(argument, value, accepted)
        if isinstance(value, Parameter) or (is_expression(value) and value.free_symbols):
            return value
        return plain

    def _settle(self, *fields: str) -> None:
        """Fields that hold one finite number each, in their form."""
        for name in fields:
            value = getattr(self, name)
            if type(value) is not float or not isfinite(value):
                self._set(name, self._number(name, value))

    def _check_positive(self) -> None:
        """The fields in :attr:`positive` hold numbers > 0."""
        for name in self.positive:
            value = getattr(self, name)
            if isinstance(value, tuple) and not value:
                self._refuse(name, value, "a finite number > 0")
            for entry in value if isinstance(value, tuple) else (value,):
                if entry is not None:
                    self._number(name, entry, above=0.0)

    def _plain(self, argument: str, value: Any, accepted: str) -> float:
        if isinstance(value, Parameter):
            return value.value
        if is_plain(value):
            try:
                return float(value)
            except OverflowError:
                self._refuse(argument, value, accepted)
        if isinstance(value, np.ndarray) and value.ndim == 0 and is_plain(value[()]):
            return float(value)
        if is_expression(value):
            if len(value.free_symbols) > len(symbol_values(value)):
                self._refuse(argument, value, accepted + " or an expression of parameters alone")
            try:
                return float(value_of(value))
            except TypeError:
                self._refuse(argument, value, accepted)
        self._refuse(argument, value, accepted)

    # -- slots --------------------------------------------------------------------------------------------------
    def slots(self) -> dict[str, Any]:
        """Every slot that holds a value: path -> value, in the order of the fields."""
        found: dict[str, Any] = {}
        for name in slot_fields(type(self)):
            value = getattr(self, name)
            if type(value) is float:
                found[name] = value
            else:
                _collect(name, value, found)
        return found

    def plain_numbers(self) -> tuple[float, ...] | None:
        """The slots' values where every field that may hold slots is a float, else None."""
        kind: Any = type(self)
        values = slot_values(kind)(self)
        for value in values:
            if type(value) is not float:
                return None
        return values

    def only_numbers(self) -> bool:
        """Whether every slot is a float, those inside fields included: no parameter, expression or array."""
        kind: Any = type(self)
        for value in slot_values(kind)(self):
            if type(value) is float or value is None:
                continue
            if isinstance(value, Declaration):
                if not (value._referred or value.only_numbers()):
                    return False
            elif isinstance(value, Mapping):
                for held in value.values():
                    if type(held) is not float and not _is_floats(held):
                        return False
            elif not isinstance(value, str | bool):
                return False
        return True

    def numeric_slots(self) -> dict[str, Any]:
        """:meth:`slots` with numbers in place of parameters; expressions of time or coordinates are left out."""
        found = {}
        for path, value in self.slots().items():
            try:
                found[path] = value_of(value)
            except TypeError:
                continue
        return found

    def options(self) -> dict[str, Any]:
        """Fields that are neither fixed nor slots (None, flags, words): they select formulas, not numbers."""
        taken = {path.split(".")[0] for path in self.slots()}
        return {n: getattr(self, n) for n in slot_fields(type(self)) if n not in taken}

    def _settable(self) -> list[str]:
        return list(slot_fields(type(self)))

    def settable(self) -> list[str]:
        """Paths that :meth:`with_slots` takes: all slots, and fields that hold none yet."""
        inner = {name: getattr(self, name) for name in self._settable()}
        nested = [f"{n}.{p}" for n, held in inner.items() if isinstance(held, Declaration) for p in held.settable()]
        return list(dict.fromkeys([*self.slots(), *inner, *nested]))

    def accepts(self, path: str) -> bool:
        """Whether :meth:`with_slots` takes ``path`` (keys of dict fields are checked when they are set)."""
        head, _, rest = path.partition(".")
        if head not in self._settable():
            return False
        held = getattr(self, head)
        return not rest or isinstance(held, Mapping) or (isinstance(held, Declaration) and held.accepts(rest))

    def with_slots(self, changes: Mapping[str, Any]) -> Self:
        """A copy with new values in some slots, checked like a new declaration.

        Raises
        ------
        UnknownNameError
            For a path that is no slot of this declaration.
        """
        if not isinstance(changes, Mapping):
            self._refuse("changes", changes, "a dict of names and values")
        fields: dict[str, dict[str, Any]] = {}
        for path, value in changes.items():
            if not self.accepts(path):
                raise unknown_name(f"parameter of {self._label()}", path, self.settable())
            head, _, rest = path.partition(".")
            fields.setdefault(head, {})[rest] = value
        new = {head: self._changed_field(head, entries) for head, entries in fields.items()}
        made: Self = dataclasses.replace(self, **new)  # type: ignore[type-var]
        made._take_over(self)
        return made

    def _take_over(self, other: Self) -> None:
        """Take what was found for a declaration with other numbers, and does not depend on them."""

    def _changed_field(self, head: str, entries: dict[str, Any]) -> Any:
        if "" in entries:
            return entries[""]
        old = getattr(self, head)
        return old.with_slots(entries) if isinstance(old, Declaration) else {**old, **entries}

    def with_named(self, changes: dict[str, float]) -> Self:
        """A copy in which the named parameters have new values (itself, if it holds none of them)."""
        new = {}
        for field in dataclasses.fields(self):  # type: ignore[arg-type]
            old = getattr(self, field.name)
            value = _substitute(old, changes)
            if value is not old:
                new[field.name] = value
        return dataclasses.replace(self, **new) if new else self  # type: ignore[type-var]

    def numeric(self) -> Self:
        """A copy whose named parameters are plain numbers; not checked again."""
        copy = object.__new__(type(self))
        for name in field_names(type(self)):
            object.__setattr__(copy, name, _numeric(getattr(self, name)))
        return copy

    # -- equality -----------------------------------------------------------------------------------------------
    def _key(self) -> tuple[Any, ...]:
        return (type(self), *(_frozen(getattr(self, name)) for name in field_names(type(self))))

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        if type(self) is not type(other):
            return NotImplemented
        return self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def __getstate__(self) -> dict[str, Any]:
        return {f.name: _thawed(getattr(self, f.name)) for f in dataclasses.fields(self)}  # type: ignore[arg-type]

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name, value in state.items():
            for held in value.values() if isinstance(value, dict) else (value,):
                if isinstance(held, np.ndarray):
                    held.setflags(write=False)  # pickles do not keep that
            object.__setattr__(self, name, MappingProxyType(value) if isinstance(value, dict) else value)


def _collect(path: str, value: Any, found: dict[str, Any]) -> None:
    if isinstance(value, Declaration):
        if not value._referred:
            found.update({f"{path}.{inner}": held for inner, held in value.slots().items()})
    elif isinstance(value, Mapping):
        for key, held in value.items():
            _collect(f"{path}.{key}", held, found)
    elif _is_slot(value):
        found[path] = value


def _is_floats(value: Any) -> bool:
    return isinstance(value, tuple) and all(type(entry) is float for entry in value)


def _is_slot(value: Any) -> bool:
    if isinstance(value, tuple):
        return len(value) > 0 and all(_is_slot(entry) for entry in value)
    return is_plain(value) or isinstance(value, Parameter | np.ndarray) or is_expression(value) or is_sparse(value)


def _substitute(value: Any, changes: dict[str, float]) -> Any:
    if isinstance(value, Declaration):
        return value if value._referred else value.with_named(changes)
    if isinstance(value, Mapping):
        new = {key: _substitute(held, changes) for key, held in value.items()}
        return value if all(new[key] is value[key] for key in value) else new
    new_value = substitute(value, changes)
    return value if isinstance(value, tuple) and new_value == value else new_value


def _numeric(value: Any) -> Any:
    if type(value) is float:
        return value
    if isinstance(value, Declaration):
        return value if value._referred else value.numeric()
    if isinstance(value, Mapping):
        return MappingProxyType({key: _numeric(held) for key, held in value.items()})
    if isinstance(value, tuple):
        return tuple(_numeric(entry) for entry in value)
    try:
        return value_of(value)
    except TypeError:
        return value


def _frozen(value: Any) -> Any:
    """A hashable that stands for ``value`` in comparisons."""
    if isinstance(value, Mapping):
        return tuple(sorted((key, _frozen(held)) for key, held in value.items()))
    if isinstance(value, np.ndarray):
        return value.shape, tuple(value.flat) if value.dtype == object else value.tobytes()
    if is_sparse(value):
        matrix = value.tocsr().sorted_indices()
        return matrix.shape, matrix.indptr.tobytes(), matrix.indices.tobytes(), matrix.data.tobytes()
    return value


def _thawed(value: Any) -> Any:
    return dict(value) if isinstance(value, Mapping) else value


