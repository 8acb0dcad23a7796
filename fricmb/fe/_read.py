"""Reading matrices of finite element programs: which reader a path goes to."""

from __future__ import annotations

import gzip
import shutil
import tempfile
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from fricmb.errors import FileError, FricmbError, SceneError, shown
from fricmb.fe import _abaqus, _ansys, _calculix, _mesh, _named, _nastran
from fricmb.fe._model import FEModel

#: Reader of each format: a path, and names of matrices in the file by those of the model, to fields of FEModel.
FORMATS: dict[str, Callable[[Path, Mapping[str, str] | None], dict[str, Any]]] = {
    "npz": _named.read_npz,
    "mat": _named.read_mat,
    "hdf5": _named.read_hdf5,
    "nastran": _nastran.read,
    "ansys": _ansys.read,
    "abaqus": _abaqus.read,
    "calculix": _calculix.read,
}
SUFFIXES = {
    ".npz": "npz", ".mat": "mat", ".h5": "hdf5", ".hdf5": "hdf5", ".op4": "nastran", ".op2": "nastran",
    ".pch": "nastran", ".dmig": "nastran", ".full": "ansys", ".mtx": "abaqus", ".sim": "abaqus",
    ".sti": "calculix", ".mas": "calculix", ".dof": "calculix",
}  # fmt: skip


def read(
    path: str | PathLike[str] | Mapping[str, Any],
    *,
    format: str | None = None,
    names: Mapping[str, str] | None = None,
    triangles: Mapping[str, str] | None = None,
    fixed: Any = None,
    mesh: str | PathLike[str] | None = None,
    units: str | None = None,
    name: str | None = None,
) -> FEModel:
    """Matrices as a finite element program wrote them.

    Parameters
    ----------
    path : path, or dict of str to path
        A file, or a folder that holds one model.  A dict gives a file with one matrix for each of "M", "K", "C", "H"
        and parts: Matrix Market, npy, or npz of scipy.
    format : str, optional
        "npz", "mat", "hdf5", "nastran" (op4, op2, DMIG), "ansys" (full), "abaqus" (``*SUBSTRUCTURE MATRIX OUTPUT``,
        ``*MATRIX GENERATE``), "calculix" (sti, mas, dof); by default according to the ending.
    names : dict of str to str, optional
        Which matrix in the file is M, K, C, H or a part: ``{"M": "BMLL", "KR": "BKQLL"}``; by default they are found by
        the names that programs give them.
    triangles, fixed, units, name
        As in :class:`FEModel`.
    mesh : path, optional
        Nodes' coordinates and sets: an input file of Abaqus or CalculiX (inp), an archive of Ansys (cdb), bulk data of
        Nastran (bdf, dat).

    Returns
    -------
    FEModel

    Raises
    ------
    FileError
        If a file cannot be read: names it, the record and what was expected.
    MissingExtraError
        If the library that reads it is not installed: names the extra.
    """
    if names is not None and not isinstance(names, Mapping):
        raise SceneError(f"fe.read: names must be a dict of name in the model to name in the file, got {shown(names)}")
    if isinstance(path, Mapping):
        found, first = _named.read_each(path), Path(next(iter(path.values()), ""))
    else:
        first, reader = _reader(path, format)
        found = _tried(first, reader, names)
    if mesh is not None:
        found |= _tried(Path(mesh), lambda file, _: _mesh.read(file), None)
    if fixed is not None:
        found["fixed"] = fixed
    kinds = {**found.pop("triangles", {}), **(triangles or {})}
    try:
        return FEModel(**found, triangles=kinds, units=units, name=name or first.stem or "model")
    except SceneError as error:
        raise FileError(f"{first}: {error}") from error


def _tried(path: Path, reader: Callable[[Path, Any], dict[str, Any]], names: Any) -> dict[str, Any]:
    """What a reader finds; whatever else goes wrong in a library is told as one sentence."""
    if not path.exists():
        raise FileError(f"{path}: there is no such file")
    try:
        # files of several parts unpack what is beside them, too
        if path.suffix == ".gz" and reader not in (_abaqus.read, _calculix.read):
            return _unpacked(path, reader, names)
        return reader(path, names)
    except FricmbError:
        raise
    except MemoryError:
        raise FileError(f"{path}: what it announces does not fit into memory") from None
    except Exception as error:
        raise FileError(f"{path}: cannot be read ({type(error).__name__}: {shown(str(error))[1:-1]})") from error


def _unpacked(path: Path, reader: Callable[[Path, Any], dict[str, Any]], names: Any) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / path.stem
        with gzip.open(path, "rb") as packed, plain.open("wb") as file:
            shutil.copyfileobj(packed, file)
        return reader(plain, names)


def _reader(path: Any, format: str | None) -> tuple[Path, Callable[[Path, Any], dict[str, Any]]]:
    if not isinstance(path, str | PathLike):
        raise SceneError(f"fe.read: path must be a path, or a dict of paths, got {shown(path)}")
    if format is not None and format not in FORMATS:
        raise SceneError(f"fe.read: format must be one of {', '.join(FORMATS)}, got {shown(format)}")
    file = Path(path)
    if file.is_dir():
        file = _inside(file, format)
    if format is None:
        format = SUFFIXES.get(_ending(file))
    if format is None:
        raise FileError(f"{file}: its ending is of no format that is read; say format=, one of {', '.join(FORMATS)}")
    return file, FORMATS[format]


def _ending(file: Path) -> str:
    """Of a packed file (gz) that of what is in it."""
    return (Path(file.stem) if file.suffix == ".gz" else file).suffix.lower()


def _inside(folder: Path, format: str | None) -> Path:
    """The one model in a folder."""
    files = sorted(p for p in folder.iterdir() if SUFFIXES.get(_ending(p)) in ({format} if format else FORMATS))
    models = _one_of_each(files)
    if len(models) != 1:
        there = ", ".join(p.name for p in models) or "none"
        raise FileError(f"{folder}: expected files of one model, found {there}; name one of them")
    return models[0]


def _one_of_each(files: Sequence[Path]) -> list[Path]:
    """Files that belong to different models."""
    models: dict[Any, Path] = {}
    for file in files:
        key = _calculix.stem(file) if SUFFIXES[_ending(file)] == "calculix" else _abaqus.stem(file)
        models.setdefault(key, file)
    return list(models.values())
