"""Matrices by name in the containers of numpy, MATLAB and HDF5, and in files that hold one matrix each."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io
import scipy.sparse

from fricmb.errors import FileError, MissingExtraError, unknown_name
from fricmb.values import is_sparse

#: Endings of the three arrays of a matrix by places and values.
TRIPLES = (("r", "c", "v"), ("row", "col", "data"), ("row", "col", "val"), ("i", "j", "v"))
#: Endings of the arrays of a compressed matrix.
COMPRESSED = ("data", "indices", "indptr")
#: More rows than any model has: such a number is none of places.
MOST = 50_000_000


def read_npz(path: Path, names: Mapping[str, str] | None) -> dict[str, Any]:
    """Arrays of numpy: dense matrices, ``X_r, X_c, X_v``, or ``X_data, X_indices, X_indptr``."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {key: file[key] for key in file.files}
    except (ValueError, OSError, EOFError) as error:
        raise FileError(f"{path}: expected an npz file of numbers ({error})") from error
    return _model(path, arrays, names)


def read_mat(path: Path, names: Mapping[str, str] | None) -> dict[str, Any]:
    """Matrices of MATLAB, up to version 7; those of 7.3 are HDF5."""
    with path.open("rb") as file:
        head = file.read(128)
    if head[:8] == b"\x89HDF\r\n\x1a\n" or b"MATLAB 7.3" in head:
        return read_hdf5(path, names)
    try:
        arrays = scipy.io.loadmat(path)
    except Exception as error:
        raise FileError(f"{path}: expected a MAT-file of MATLAB ({error})") from error
    return _model(path, {key: value for key, value in arrays.items() if not key.startswith("__")}, names)


def read_hdf5(path: Path, names: Mapping[str, str] | None) -> dict[str, Any]:
    """Datasets of HDF5: dense matrices, or groups of data, row indices and column starts as MATLAB writes them."""
    try:
        import h5py
    except ImportError:
        raise MissingExtraError(f"fe.read of {path.name}", "h5py", "hdf5") from None
    arrays: dict[str, Any] = {}
    try:
        with h5py.File(path, "r") as file:
            file.visititems(
                lambda key, item: arrays.update({key: item[()]}) if isinstance(item, h5py.Dataset) else None
            )
            sizes = {
                key: int(item.attrs["MATLAB_sparse"]) for key, item in file.items() if "MATLAB_sparse" in item.attrs
            }
    except OSError as error:
        raise FileError(f"{path}: expected an HDF5 file ({error})") from error
    for key, rows in sizes.items():
        parts = (arrays.pop(f"{key}/data", np.zeros(0)), arrays.pop(f"{key}/ir", np.zeros(0)), arrays.pop(f"{key}/jc"))
        arrays[key] = scipy.sparse.csc_array(parts, shape=(rows, len(parts[2]) - 1))
    return _model(path, arrays, names)


def read_each(paths: Mapping[str, Any]) -> dict[str, Any]:
    """One file for each matrix."""
    found = {str(key): read_one(Path(path)) for key, path in paths.items()}
    return _fields(Path(str(next(iter(paths.values()), "no file"))), found)


def read_one(path: Path) -> Any:
    """The one matrix of a file: Matrix Market, npy, or npz of scipy."""
    if not path.exists():
        raise FileError(f"{path}: there is no such file")
    try:
        if path.suffix == ".npy":
            return np.load(path, allow_pickle=False)
        if path.suffix == ".npz":
            return scipy.sparse.load_npz(path)
        return scipy.io.mmread(path)
    except Exception as error:
        raise FileError(f"{path}: expected one matrix, in Matrix Market, npy or npz of scipy ({error})") from error


def _model(path: Path, arrays: dict[str, Any], names: Mapping[str, str] | None) -> dict[str, Any]:
    matrices = _matrices(path, arrays)
    if names is None:
        found = {key.upper() if key.upper() in ("M", "K", "C", "H") else key: value for key, value in matrices.items()}
    else:
        for wanted in names.values():
            if wanted not in matrices:
                raise FileError(f"{path}: {unknown_name('matrix', wanted, matrices)}")
        found = {key: matrices[wanted] for key, wanted in names.items()}
    fields = _fields(path, found)
    for key in ("labels", "fixed"):
        if key in arrays and key not in matrices:
            fields[key] = arrays[key]
    return fields


def _fields(path: Path, found: dict[str, Any]) -> dict[str, Any]:
    for key in ("M", "K"):
        if key not in found:
            there = ", ".join(sorted(found)) or "no matrix"
            raise FileError(f"{path}: expected M and K, found {there}; say which is which by names={{'{key}': ...}}")
    own: dict[str, Any] = {key: found.pop(key) for key in ("M", "K", "C", "H") if key in found}
    fields: dict[str, Any] = {**own, "parts": found}
    return fields


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
