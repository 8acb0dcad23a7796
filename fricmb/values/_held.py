"""What fields hold that is no number: functions, arrays, objects of others; they select formulas as types do."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fricmb.values._declaration import Declaration
from fricmb.values._numbers import is_sparse


class Held:
    """A value in a key: equal to one that holds the same object or an equal one, and without a name of its own.

    It keeps its object alive, so that no other takes its place in memory, and prints as nothing particular, so that
    keys that outlive the process never hold an address.
    """

    __slots__ = ("_stands", "_value")

    def __init__(self, value: Any) -> None:
        self._value = value
        self._stands = _stands(value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Held) and (self._value is other._value or self._stands == other._stands)

    def __hash__(self) -> int:
        return hash(self._stands)

    def __repr__(self) -> str:
        return f"held {type(self._value).__name__}"


def _stands(value: Any) -> Any:
    """A hashable that stands for the value."""
    if isinstance(value, np.ndarray):
        return ("array", value.shape, str(value.dtype), value.tobytes() if value.dtype != object else id(value))
    if is_sparse(value):
        matrix = value.tocsr().sorted_indices()
        return ("sparse", matrix.shape, matrix.indptr.tobytes(), matrix.indices.tobytes(), matrix.data.tobytes())
    try:
        hash(value)
    except TypeError:
        return ("object", id(value))
    return ("value", type(value), value)


def is_foreign(value: Any) -> bool:
    """Whether a field's value is neither plain nor a part of this package, so that a formula may be made of it."""
    if value is None or isinstance(value, str | bool | int | float | complex | np.generic | Declaration):
        return False
    if isinstance(value, tuple | list):
        return any(is_foreign(entry) for entry in value)
    if isinstance(value, Mapping):
        return any(is_foreign(entry) for entry in value.values())
    return callable(value) or type(value).__module__.split(".")[0] != "fricmb"


def held(value: Any) -> Any:
    """Of a foreign value a key of its own; containers become tuples of them."""
    if isinstance(value, Mapping):
        return tuple((str(name), held(entry)) for name, entry in sorted(value.items(), key=lambda item: str(item[0])))
    if isinstance(value, tuple | list):
        return tuple(held(entry) for entry in value)
    return Held(value) if is_foreign(value) else repr(value)
