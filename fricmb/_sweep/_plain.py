"""Results as data: numbers, words, lists, dicts and arrays of numbers as bytes that hold nothing to run, and back.

A line of JSON, behind it the bytes of all arrays.  What JSON does not know is an object with the key "", which says
what it is.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np

#: Kinds of numpy's types that are numbers or words.
_KINDS = "biufcSU"
_IS = ""


class _NotPlain(Exception):
    """Something that is not data."""


def pack(value: Any) -> bytes | None:
    """A result as bytes; None where it is not made of plain data alone."""
    arrays: list[bytes] = []
    try:
        text = json.dumps(_tree(value, arrays), separators=(",", ":"))
    except (_NotPlain, RecursionError, ValueError):
        return None
    return b"\n".join([text.encode(), b"".join(arrays)])


def _tree(value: Any, arrays: list[bytes]) -> Any:
    kind = type(value)
    if value is None or kind in (bool, int, float, str):
        return value
    if kind is list:
        return [_tree(one, arrays) for one in value]
    if kind is dict and _IS not in value and all(type(key) is str for key in value):
        return {key: _tree(one, arrays) for key, one in value.items()}
    if kind is tuple:
        return {_IS: "tuple", "of": [_tree(one, arrays) for one in value]}
    if kind is complex:
        return {_IS: "complex", "of": [value.real, value.imag]}
    if (kind is np.ndarray or isinstance(value, np.generic)) and value.dtype.kind in _KINDS:
        arrays.append(np.ascontiguousarray(value).tobytes())
        of = "array" if kind is np.ndarray else "scalar"
        return {_IS: of, "dtype": value.dtype.str, "shape": value.shape, "bytes": len(arrays[-1])}
    raise _NotPlain


def unpack(data: bytes) -> Any:
    """The way back."""
    text, _, arrays = data.partition(b"\n")
    return _value(json.loads(text), memoryview(arrays), [0])


def _value(tree: Any, arrays: memoryview, at: list[int]) -> Any:
    if isinstance(tree, list):
        return [_value(one, arrays, at) for one in tree]
    if not isinstance(tree, dict):
        return tree
    if _IS not in tree:
        return {key: _value(one, arrays, at) for key, one in tree.items()}
    if tree[_IS] == "tuple":
        return tuple([_value(one, arrays, at) for one in tree["of"]])
    if tree[_IS] == "complex":
        return complex(*tree["of"])
    begin = at[0]
    at[0] += tree["bytes"]
    array = np.frombuffer(arrays[begin : at[0]], dtype=tree["dtype"]).reshape(tree["shape"])
    return array.copy() if tree[_IS] == "array" else array[()]
