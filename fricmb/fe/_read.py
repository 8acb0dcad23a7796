"""Reading matrices of finite element programs: which reader a path goes to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from fricmb._files import Formats, one_sentence
from fricmb.errors import FileError, SceneError, shown
from fricmb.fe import _abaqus, _ansys, _calculix, _mesh, _named, _nastran
from fricmb.fe._model import FEModel

#: Reader of each format: a path, and names of matrices in the file by those of the model, to fields of FEModel.
FORMATS = Formats(
    who="fe.read",
    readers={
        "npz": _named.read_npz,
        "mat": _named.read_mat,
        "hdf5": _named.read_hdf5,
        "nastran": _nastran.read,
        "ansys": _ansys.read,
        "abaqus": _abaqus.read,
        "calculix": _calculix.read,
    },
    endings={
        ".npz": "npz", ".mat": "mat", ".h5": "hdf5", ".hdf5": "hdf5", ".op4": "nastran", ".op2": "nastran",
        ".pch": "nastran", ".dmig": "nastran", ".full": "ansys", ".mtx": "abaqus", ".sim": "abaqus",
        ".sti": "calculix", ".mas": "calculix", ".dof": "calculix",
    },
    packed=("abaqus", "calculix"),
)  # fmt: skip


def read(
    path: str | PathLike[str] | Mapping[str, Any],
    *,
    format: str | None = None,
    names: Mapping[str, str] | None = None,
    triangles: Mapping[str, str] | None = None,
    fixed: Any = None,
    mesh: str | PathLike[str] | None = None,
    scales: Mapping[str, Any] | None = None,
    units: str | None = None,
    name: str | None = None,
) -> FEModel:
    """Read matrices that a finite element program wrote.

    Parameters
    ----------
    path : path, or dict of str to path
        A file, or a folder that holds one model: files of one job, or of one matrix each.  The one mesh in a folder is
        read as well.  A dict gives a file with one matrix for each of "M", "K", "C", "H" and parts: Matrix Market, npy,
        mat, or npz of scipy.
    format : str, optional
        "npz", "mat", "hdf5", "nastran" (op4, op2, DMIG), "ansys" (full), "abaqus" (``*SUBSTRUCTURE MATRIX OUTPUT``,
        ``*MATRIX GENERATE``), "calculix" (sti, mas, dof); by default according to the ending.
    names : dict of str to str, optional
        Which matrix in the file is M, K, C, H or a part: ``{"M": "BMLL", "KR": "BKQLL"}``; by default they are found by
        the names that programs give them, or by what tells names apart (``BMLL``, ``BKLL``); others become parts.
    triangles, fixed, scales, units, name
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
        first, found = Path(next(iter(path.values()), "no file")), _named.read_each(path, names)
    else:
        first = FORMATS.checked(path, format)
        if first.is_dir():
            mesh = mesh if mesh is not None else _mesh_in(first)
            found = _read_folder(first, format, names)
        else:
            found = FORMATS.read(first, format, names)
    if mesh is not None:
        found |= one_sentence(Path(mesh), _mesh.read)
    if fixed is not None:
        found["fixed"] = fixed
    kinds = {**found.pop("triangles", {}), **(triangles or {})}
    try:
        return FEModel(**found, triangles=kinds, scales=scales or {}, units=units, name=name or _stem(first))
    except SceneError as error:
        raise FileError(f"{first}: {error}") from error


def _stem(path: Path) -> str:
    """What a model is called after a file, packed or not."""
    return Path(path.name.removesuffix(".gz")).stem or "model"


def _read_folder(folder: Path, format: str | None, names: Mapping[str, str] | None) -> dict[str, Any]:
    """The one model in a folder: files of one job, or of one matrix each."""
    there = sorted(file for file in folder.iterdir() if file.is_file())
    if format is None:
        files = [file for file in there if FORMATS.by_ending(file) or file.suffix in _named.SINGLE]
    else:
        files = [file for file in there if FORMATS.by_ending(file) == format]
    models = _one_of_each(files)
    if len(models) == 1:
        found: dict[str, Any] = FORMATS.read(models[0], format, names)
        return found
    if format is None and models and all(file.suffix in _named.SINGLE for file in models):
        try:
            return _named.read_each({file.stem: file for file in models}, names)
        except FileError:  # files of several matrices, or of several models
            pass
    found_there = ", ".join(p.name for p in models) or "none"
    raise FileError(f"{folder}: expected files of one model, found {found_there}; name one of them")


def _mesh_in(folder: Path) -> Path | None:
    """The mesh in a folder; of several none, for which belongs to the matrices is not known."""
    found = [file for file in folder.iterdir() if file.suffix.lower() in (".inp", ".cdb", ".bdf")]
    return found[0] if len(found) == 1 else None


def _one_of_each(files: Sequence[Path]) -> list[Path]:
    """Files that belong to different models."""
    models: dict[Any, Path] = {}
    for file in files:
        key = _calculix.stem(file) if FORMATS.by_ending(file) == "calculix" else _abaqus.stem(file)
        models.setdefault(key, file)
    return list(models.values())
