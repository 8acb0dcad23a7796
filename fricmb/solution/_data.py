"""Declarations and runs as plain data: JSON and flat arrays, and back without anything being executed.

Objects stand in a table, each as ``[number of its class, value of each field]``, after those that it refers to, so
that what is shared stays shared.  Values are numbers, text, true, false, null, or a list that begins with a word:
``["tuple", ...]``, ``["list", ...]``, ``["dict", [key, value], ...]``, ``["object", number]``, ``["ground"]``,
``["array", type, offset, shape, order]`` (a part of the flat array of that type), ``["objects", shape, ...]`` (an array
of parameters), ``["sparse", kind, shape, data, indices, pointers]``, ``["float", "nan"]``, ``["formula", node]``.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from fricmb._facade import WORDS, find
from fricmb.integrate import Trajectory
from fricmb.solution._formulas import NotStored, read_formula, write_formula
from fricmb.solution._kinds import Kinds, is_data, is_own, path_of, source_of
from fricmb.values import Declaration, is_sparse

#: Types of the flat arrays.
TYPES = ("float64", "int64", "int32", "int16", "int8", "uint8", "bool", "float32", "complex128")


class Writer:
    """Turns values into plain data; what they share is written once.

    Attributes
    ----------
    kinds : list of [name, fields]
    objects : list of [number of the kind, values]
    sources : dict of str to str
        Source of every class that is not of this package.
    """

    def __init__(self) -> None:
        self.kinds: list[Any] = []
        self.objects: list[Any] = []
        self.sources: dict[str, str] = {}
        self._kind: dict[type, tuple[int, tuple[str, ...]]] = {}
        self._done: dict[int, int] = {}
        self._alive: list[Any] = []
        self._parts: dict[str, list[Any]] = {}
        self._length: dict[str, int] = {}

    def arrays(self) -> dict[str, Any]:
        """The flat arrays by type."""
        return {name: np.concatenate(parts) for name, parts in self._parts.items()}

    def write(self, value: Any) -> Any:
        """One value."""
        kind = type(value)
        if value is None or kind is str or kind is bool or kind is int:
            return value
        if isinstance(value, float):
            return float(value) if math.isfinite(value) else ["float", repr(float(value))]
        if isinstance(value, str | np.bool_ | np.integer):
            return str(value) if isinstance(value, str) else value.item()
        if isinstance(value, np.ndarray):
            return self._array(value)
        if isinstance(value, Mapping):
            return ["dict", *([self.write(key), self.write(held)] for key, held in value.items())]
        if kind is tuple or kind is list:
            return [kind.__name__, *map(self.write, value)]
        if is_sparse(value):
            rows = value.tocsr()
            kept = type(rows).__name__
            return ["sparse", kept, list(rows.shape), *map(self.write, (rows.data, rows.indices, rows.indptr))]
        if getattr(kind, "_is_ground", False):
            return ["ground"]
        if hasattr(value, "free_symbols"):
            return ["formula", write_formula(value, self.write)]
        if is_data(kind):
            return self._object(value)
        raise NotStored(f"a {kind.__module__}.{kind.__qualname__} is no data")

    def _array(self, value: Any) -> list[Any]:
        if value.dtype == object:
            return ["objects", list(value.shape), *map(self.write, value.ravel().tolist())]
        name = value.dtype.name
        if name not in TYPES:
            raise NotStored(f"an array of {value.dtype} is no array of numbers")
        order = "F" if value.flags.f_contiguous and not value.flags.c_contiguous else "C"
        offset = self._length.get(name, 0)
        self._length[name] = offset + value.size
        self._parts.setdefault(name, []).append(value.ravel(order=order).astype(name, copy=False))
        return ["array", name, offset, list(value.shape), order]

    def _object(self, value: Any) -> list[Any]:
        number = self._done.get(id(value))
        if number is None:
            index, names = self._known(type(value))
            state = value.__getstate__() if isinstance(value, Trajectory) else None
            if state is None:
                row = [index, *[self.write(getattr(value, name)) for name in names]]
            else:
                row = [index, self.write(state)]
            number = self._done[id(value)] = len(self.objects)
            self._alive.append(value)
            self.objects.append(row)
        return ["object", number]

    def _known(self, kind: type) -> tuple[int, tuple[str, ...]]:
        found = self._kind.get(kind)
        if found is None:
            names = _names(kind)
            if not is_own(kind):
                if not issubclass(kind, Declaration | Trajectory):
                    raise NotStored(f"{path_of(kind)} is no declaration, law or run")
                self.sources[path_of(kind)] = source_of(kind)
            found = self._kind[kind] = len(self.kinds), names
            self.kinds.append([path_of(kind), list(names)])
        return found


class Reader:
    """Turns plain data into values; raises ValueError, TypeError, KeyError or FricmbError for what is not accepted."""

    def __init__(self, kinds: list[Any], objects: list[Any], arrays: Mapping[str, Any], known: Kinds) -> None:
        self._arrays = arrays
        self._kinds = [(known.find(path), tuple(names)) for path, names in kinds]
        self._objects: list[Any] = []
        for index, *values in objects:
            self._objects.append(self._object(index, values))

    def read(self, value: Any) -> Any:
        """One value."""
        if not isinstance(value, list):
            if isinstance(value, dict):
                raise ValueError("a dict where a list was expected")
            return value
        word, *rest = value
        if word == "tuple":
            return tuple([self.read(held) for held in rest])
        if word == "list":
            return [self.read(held) for held in rest]
        if word == "dict":
            return {self.read(key): self.read(held) for key, held in rest}
        if word == "object":
            return self._objects[_index(rest[0], len(self._objects))]
        if word == "array":
            return self._array(*rest)
        if word == "float":
            return float({"nan": "nan", "inf": "inf", "-inf": "-inf"}[rest[0]])
        if word == "formula":
            return read_formula(rest[0], self.read)
        if word == "ground":
            return find(WORDS[word])
        if word == "objects":
            return self._array_of_objects(*rest)
        if word == "sparse":
            return self._sparse(*rest)
        raise ValueError(f"the word {word!r} is not known")

    def _array(self, name: Any, offset: Any, shape: Any, order: Any) -> Any:
        if name not in TYPES or order not in ("C", "F"):
            raise ValueError(f"an array of {name} in order {order} is not known")
        flat = self._arrays[name]
        size = math.prod(_index(length, 2**40) for length in shape)
        if not 0 <= _index(offset, 2**40) <= offset + size <= flat.size:
            raise ValueError(f"an array of {size} numbers lies outside the {flat.size} that are there")
        return flat[offset : offset + size].copy().reshape(shape, order=order)

    def _array_of_objects(self, shape: Any, *values: Any) -> Any:
        array = np.empty(shape, dtype=object)
        array.ravel()[:] = [self.read(held) for held in values]
        return array

    def _sparse(self, kept: Any, shape: Any, *parts: Any) -> Any:
        import scipy.sparse

        data, indices, pointers = (self.read(part) for part in parts)
        kind = {"csr_matrix": scipy.sparse.csr_matrix, "csr_array": scipy.sparse.csr_array}[kept]
        matrix = kind((data, indices, pointers), shape=tuple(shape))
        matrix.check_format(full_check=True)
        return matrix

    def _object(self, index: Any, values: list[Any]) -> Any:
        kind, names = self._kinds[_index(index, len(self._kinds))]
        if issubclass(kind, Trajectory):
            (state,) = values
            made = object.__new__(kind)
            made.__dict__.update(_attributes(self.read(state)))
            return made
        later = getattr(kind, "_stored_later", ())
        if names != _names(kind) and names != tuple([name for name in _names(kind) if name not in later]):
            raise ValueError(f"{kind.__qualname__} has the fields {_names(kind)}; the file has {names}")
        return kind(**dict(zip(names, map(self.read, values), strict=True)))


def _names(kind: type) -> tuple[str, ...]:
    """Arguments from which an object of that class is made again."""
    if dataclasses.is_dataclass(kind):
        return tuple([f.name for f in dataclasses.fields(kind) if f.init])
    return tuple(getattr(kind, "_stored", ())) or tuple(getattr(kind, "_fields", ()))


def _attributes(state: Any) -> dict[str, Any]:
    if not isinstance(state, dict) or not all(isinstance(name, str) and name.isidentifier() for name in state):
        raise ValueError("a run is a dict of named values")
    return state


def _index(value: Any, end: int) -> int:
    if type(value) is not int or not 0 <= value < end:
        raise ValueError(f"the number {value!r} is not in [0, {end})")
    return value
