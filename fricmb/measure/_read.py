"""Reading measurements: which reader a path goes to."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path

from fricmb.errors import FileError, FricmbError, SceneError, shown
from fricmb.measure import _results, _tables, _uff
from fricmb.measure._types import Measured

#: Reader of each format; ``over``: first value and step of files without times or
#: frequencies, or the name of their column.
FORMATS: dict[str, Callable[[Path, _tables.Over], Measured]] = {
    "uff": _uff.read,
    "csv": _tables.read_csv,
    "wav": _tables.read_wav,
    "npz": _tables.read_npz,
    "mat": _tables.read_mat,
    "hdf5": _tables.read_hdf5,
    "tdms": _tables.read_tdms,
    "rst": _results.read_rst,
}
SUFFIXES = {
    ".uff": "uff", ".unv": "uff", ".uf": "uff", ".csv": "csv", ".txt": "csv", ".tsv": "csv", ".dat": "csv",
    ".wav": "wav", ".npz": "npz", ".mat": "mat", ".h5": "hdf5", ".hdf5": "hdf5", ".tdms": "tdms", ".rst": "rst",
}  # fmt: skip


def read(
    path: str | PathLike[str], *, format: str | None = None, step: float | None = None, start: float = 0.0,
    time: str | None = None,
) -> Measured:  # fmt: skip
    """Signals, frequency responses and modes, with their points and units.

    Parameters
    ----------
    path : path
        UFF (15, 2411, 18, 2420, 55, 2414, 58, 82, 164; extra ``uff``), CSV, WAV, MAT, npz, HDF5 (extra ``hdf5``), TDMS
        (extra ``tdms``), results of modal runs of Ansys (rst, extra ``ansys``).
    format : str, optional
        "uff", "csv", "wav", "npz", "mat", "hdf5", "tdms", "rst"; by default according to the ending.
    step, start : float
        Spacing and first value of times, or of frequencies where values are complex, in a table without such a column.
    time : str, optional
        Name of the column of times in a table; by default what is called t or time.

    Returns
    -------
    Measured

    Raises
    ------
    FileError
        If the file cannot be read: names it, the record and what was expected.
    MissingExtraError
        If the library that reads it is not installed: names the extra.
    """
    if not isinstance(path, str | PathLike):
        raise SceneError(f"measure.read: path must be a path, got {shown(path)}")
    if format is not None and format not in FORMATS:
        raise SceneError(f"measure.read: format must be one of {', '.join(FORMATS)}, got {shown(format)}")
    file = Path(path)
    if not file.is_file():
        raise FileError(f"{file}: there is no such file")
    kind = format or SUFFIXES.get(file.suffix.lower())
    if kind is None:
        raise FileError(f"{file}: its ending is of no format that is read; say format=, one of {', '.join(FORMATS)}")
    if step is not None and not (isinstance(step, int | float) and step > 0.0):
        raise SceneError(f"measure.read: step must be a number > 0, got {shown(step)}")
    if time is not None and not isinstance(time, str):
        raise SceneError(f"measure.read: time must be the name of a column, got {shown(time)}")
    try:
        found = FORMATS[kind](file, time if step is None else (float(start), float(step)))
    except FricmbError:
        raise
    except MemoryError:
        raise FileError(f"{file}: what it announces does not fit into memory") from None
    except Exception as error:
        raise FileError(f"{file}: cannot be read ({type(error).__name__}: {shown(str(error))[1:-1]})") from error
    if not (found.signals or found.frfs or found.modes or found.points):
        raise FileError(f"{file}: expected signals, frequency responses, modes or points, found none")
    return found
