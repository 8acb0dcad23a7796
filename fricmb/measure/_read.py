"""Reading measurements: which reader a path goes to."""

from __future__ import annotations

from os import PathLike

from fricmb._files import Formats
from fricmb.errors import FileError, SceneError, shown
from fricmb.measure import _frd, _results, _tables, _uff
from fricmb.measure._types import Measured

#: Reader of each format; ``over``: first value and step of files without times or
#: frequencies, or the name of their column.
FORMATS = Formats(
    who="measure.read",
    readers={
        "uff": _uff.read,
        "csv": _tables.read_csv,
        "wav": _tables.read_wav,
        "npz": _tables.read_npz,
        "mat": _tables.read_mat,
        "hdf5": _tables.read_hdf5,
        "tdms": _tables.read_tdms,
        "rst": _results.read_rst,
        "op2": _results.read_op2,
        "frd": _frd.read,
    },
    endings={
        ".uff": "uff", ".unv": "uff", ".uf": "uff", ".csv": "csv", ".txt": "csv", ".tsv": "csv", ".dat": "csv",
        ".wav": "wav", ".npz": "npz", ".mat": "mat", ".h5": "hdf5", ".hdf5": "hdf5", ".tdms": "tdms", ".rst": "rst",
        ".op2": "op2", ".frd": "frd",
    },
)  # fmt: skip


def read(
    path: str | PathLike[str], *, format: str | None = None, step: float | None = None, start: float = 0.0,
    time: str | None = None,
) -> Measured:  # fmt: skip
    """Read signals, frequency responses and modes from a file, with their points and units.

    Parameters
    ----------
    path : path
        UFF (15, 2411, 18, 2420, 55, 2414, 58, 82, 164; extra ``uff``), CSV, WAV, MAT, npz, HDF5 (extra ``hdf5``), TDMS
        (extra ``tdms``), results of modal runs of Ansys (rst, extra ``ansys``), Nastran (op2, extra ``nastran``) and
        CalculiX (frd); packed (gz) as well.
    format : str, optional
        "uff", "csv", "wav", "npz", "mat", "hdf5", "tdms", "rst", "op2", "frd"; by default according to the ending.
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
    file = FORMATS.checked(path, format)
    if step is not None and not (isinstance(step, int | float) and step > 0.0):
        raise SceneError(f"measure.read: step must be a number > 0, got {shown(step)}")
    if time is not None and not isinstance(time, str):
        raise SceneError(f"measure.read: time must be the name of a column, got {shown(time)}")
    found: Measured = FORMATS.read(file, format, time if step is None else (float(start), float(step)))
    if not (found.signals or found.frfs or found.modes or found.points):
        raise FileError(f"{file}: expected signals, frequency responses, modes or points, found none")
    return found
