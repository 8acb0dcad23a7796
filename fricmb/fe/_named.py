"""Matrices by name in the containers of numpy, MATLAB and HDF5, and in files that hold one matrix each."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from fricmb._files import hdf5_arrays, mat_arrays, matrix_market, npz_arrays, one_sentence
from fricmb.errors import FileError, unknown_name
from fricmb.values import is_sparse

#: Endings of the three arrays of a matrix by places and values.
TRIPLES = (("r", "c", "v"), ("row", "col", "data"), ("row", "col", "val"), ("i", "j", "v"))
#: Endings of the arrays of a compressed matrix.
COMPRESSED = ("data", "indices", "indptr")
#: What mass, stiffness, viscous and structural damping are called, the usual word first.
WORDS = {
    "M": ("m", "mass"),
    "K": ("k", "stiff", "stiffness", "stif"),
    "C": ("c", "damp", "damping", "d"),
    "H": ("h", "structural"),
}
#: Endings of files that may hold one matrix each.
SINGLE = (".mtx", ".npy", ".mat", ".npz")
#: More rows than any model has: such a number is none of places.
MOST = 50_000_000


def read_npz(path: Path, names: Mapping[str, str] | None) -> dict[str, Any]:
    """Arrays of numpy: dense matrices, ``X_r, X_c, X_v``, or ``X_data, X_indices, X_indptr``."""
    return _model(path, npz_arrays(path), names)


def read_mat(path: Path, names: Mapping[str, str] | None) -> dict[str, Any]:
    """Matrices of MATLAB."""
    return _model(path, mat_arrays(path), names)


def read_hdf5(path: Path, names: Mapping[str, str] | None) -> dict[str, Any]:
    """Datasets of HDF5: dense matrices, or groups of data, row indices and column starts as MATLAB writes them."""
    return _model(path, hdf5_arrays(path), names)


def read_each(paths: Mapping[str, Any], names: Mapping[str, str] | None = None) -> dict[str, Any]:
    """One file for each matrix."""
    first = Path(str(next(iter(paths.values()), "no file")))
    return _model(first, {str(key): one_sentence(Path(path), _read_one) for key, path in paths.items()}, names)


def _read_one(path: Path) -> Any:
    """The one matrix of a file."""
    try:
        if path.suffix == ".npy":
            return np.load(path, allow_pickle=False)
        if path.suffix == ".npz":
            return scipy.sparse.load_npz(path)
        if path.suffix == ".mat":
            (matrix,) = _matrices(path, mat_arrays(path)).values()
            return matrix
        return matrix_market(path)
    except (FileError, MemoryError):
        raise
    except Exception as error:
        raise FileError(f"{path}: expected one matrix, in Matrix Market, npy, mat or npz of scipy ({error})") from error


def _model(path: Path, arrays: dict[str, Any], names: Mapping[str, str] | None) -> dict[str, Any]:
    """Fields of a model; its matrices by the names given, or by what names usually say."""
    matrices = _matrices(path, arrays)
    for wanted in (names or {}).values():
        if wanted not in matrices:
            raise FileError(f"{path}: {unknown_name('matrix', wanted, matrices)}")
    which = recognised(matrices) if names is None else names
    fields = _fields(path, {key: matrices[there] for key, there in which.items()}, matrices)
    if names is None and any(key != there for key, there in which.items()):
        fields["notes"] = (", ".join(f"{key} is {there}" for key, there in which.items()) + ", by their names",)
    for key in ("labels", "fixed"):
        if key in arrays and key not in matrices:
            fields[key] = arrays[key]
    return fields


def recognised(names: Iterable[str]) -> dict[str, str]:
    """Which name is M, K, C, H: by usual words, or by what is left when names lose what all begin and end with.

    Others stand for themselves, without what all begin and end with where that was lost.  Empty without M and K.
    """
    there = list(names)
    before = _alike(there)
    after = _alike([name[before:][::-1] for name in there])
    for short in ({name: name for name in there}, {name: name[before : len(name) - after] for name in there}):
        found = {}
        for key, words in WORDS.items():
            fit = [name for word in words for name in there if short[name].lower() == word]
            if fit:
                found[key] = fit[0]
        if "M" in found and "K" in found:
            return found | {short[name] or name: name for name in there if name not in found.values()}
    return {}


def _alike(words: list[str]) -> int:
    """How many letters all words begin with."""
    letters = list(zip(*words, strict=False))
    return next((i for i, column in enumerate(letters) if len(set(column)) > 1), len(letters))


def _fields(path: Path, found: dict[str, Any], there: Iterable[str]) -> dict[str, Any]:
    for key in ("M", "K"):
        if key not in found:
            held = ", ".join(sorted(there)) or "no matrix"
            raise FileError(f"{path}: expected M and K, found {held}; say which is which by names={{'{key}': ...}}")
    own: dict[str, Any] = {key: found.pop(key) for key in ("M", "K", "C", "H") if key in found}
    return {**own, "parts": found}


def _matrices(path: Path, arrays: dict[str, Any]) -> dict[str, Any]:
    """Square matrices by name."""
    found: dict[str, Any] = {}
    entries: dict[str, tuple[Any, Any, Any]] = {}
    for key, value in arrays.items():
        if is_sparse(value) or (
            np.ndim(value) == 2 and value.shape[0] == value.shape[1] and value.dtype.kind in "iufc"
        ):
            found[key] = value
            continue
        match = re.fullmatch(r"(.+)[_./](r|row|i|data|indptr)", key)
        if match is None:
            continue
        stem, mark = match[1], key[len(match[1])]
        for ends in TRIPLES:
            held = [f"{stem}{mark}{end}" for end in ends]
            if all(name in arrays for name in held):
                entries[stem] = tuple(arrays[name] for name in held)
        held = [f"{stem}{mark}{end}" for end in COMPRESSED]
        if all(name in arrays for name in held):
            data, indices, starts = (arrays[name] for name in held)
            n = len(starts) - 1
            found[stem] = scipy.sparse.csr_array((data, indices, starts), shape=(n, n))
    return found | _from_entries(path, entries)


def _from_entries(path: Path, entries: dict[str, tuple[Any, Any, Any]]) -> dict[str, Any]:
    """Matrices by places and values, all of one size: that of the largest place."""
    n = 0
    for key, (rows, columns, values) in entries.items():
        shapes = {np.shape(a) for a in (rows, columns, values)}
        places = np.concatenate([np.ravel(rows), np.ravel(columns)])
        if len(shapes) > 1 or places.dtype.kind not in "iu":
            raise FileError(
                f"{path}: {key}: expected whole numbers of rows and columns, as many as values; got {shapes}"
            )
        if places.size and not 0 <= int(places.min()) <= int(places.max()) < MOST:
            raise FileError(f"{path}: {key}: rows and columns must be from 0 to {MOST - 1}, got {int(places.max())}")
        n = max(n, int(places.max(initial=-1)) + 1)
    return {
        key: scipy.sparse.csr_array(
            (np.ravel(v), (np.ravel(r).astype(np.int64), np.ravel(c).astype(np.int64))), shape=(n, n)
        )
        for key, (r, c, v) in entries.items()
    }
