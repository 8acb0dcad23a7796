"""Whether two values of a field are one and the same to whatever is made of them."""

from __future__ import annotations

from collections.abc import Mapping
from math import copysign
from typing import Any

from fricmb.values._declaration import Declaration, field_names


def is_same(one: Any, other: Any) -> bool:
    """Whether one value may stand for the other: the same object, or plain values that are equal.

    Plain: numbers, words, tuples and mappings of such, laws.  Expressions, functions and arrays, which cost much to
    compare, and parts that a field refers to, are themselves alone.
    """
    if one is other:
        return True
    kind = type(one)
    if kind is not type(other):
        return False
    if kind is float:
        return bool(one == other and copysign(1.0, one) == copysign(1.0, other))
    if kind in (str, int, bool):
        return bool(one == other)
    if kind is tuple:
        return len(one) == len(other) and all(map(is_same, one, other))
    if isinstance(one, Mapping):
        return list(one) == list(other) and all(map(is_same, one.values(), other.values()))
    if isinstance(one, Declaration) and not one._referred:
        return all(is_same(getattr(one, name), getattr(other, name)) for name in field_names(kind))
    return False
