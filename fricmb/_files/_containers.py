"""Arrays by name in the containers of numpy, MATLAB and HDF5.  Nothing in a file is run: no pickles, no objects."""

from __future__ import annotations

import math
import os
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from fricmb._files._mat import mat_5
from fricmb._files._text import FREE
from fricmb.errors import FileError, MissingExtraError, shown

Arrays = dict[str, Any]
#: Packing makes no more of a byte than this.
DEFLATED = 1032


def npz_arrays(path: Path) -> Arrays:
    """Arrays of numpy."""
    try:
        _check_npz(path)
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            return {key: file[key] for key in file.files}
    except (FileError, MemoryError):
        raise
    except Exception as error:
        raise FileError(f"{path}: expected an npz file of numbers ({shown(str(error))[1:-1]})") from error


def _check_npz(path: Path) -> None:
    """The bytes that the head of each array announces are there."""
    with zipfile.ZipFile(path) as file:
        for part in file.infolist():
            if part.file_size > DEFLATED * part.compress_size + DEFLATED:
                held = f"{part.compress_size} packed bytes hold less"
                raise FileError(f"{path}: {part.filename}: {part.file_size} bytes are announced, {held}")
            with file.open(part) as array:
                version = np.lib.format.read_magic(array)
                read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
                shape, _, kind = read(array)
                left = part.file_size - array.tell()
            if math.prod(shape) * kind.itemsize > left and not kind.hasobject:
                announced = f"{' x '.join(map(str, shape))} numbers of {kind.itemsize} bytes are announced"
                raise FileError(f"{path}: {part.filename}: {announced}, it has {left} bytes")


def mat_arrays(path: Path) -> Arrays:
    """Variables of MATLAB that hold numbers; files of version 7.3 are HDF5."""
    with path.open("rb") as file:
        head = file.read(128)
    if head[:8] == b"\x89HDF\r\n\x1a\n" or b"MATLAB 7.3" in head:
        return hdf5_arrays(path)
    return mat_5(path)


def hdf5_arrays(path: Path) -> Arrays:
    """Datasets of HDF5; groups as MATLAB writes sparse matrices become one."""
    try:
        import h5py
    except ImportError:
        raise MissingExtraError(f"reading {path.name}", "h5py", "hdf5") from None
    found: Arrays = {}

    def take(key: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            if item.nbytes > memory():
                raise FileError(f"{path}: {key}: it announces {item.nbytes:.3g} bytes, more than fit into memory")
            held = item.id.get_storage_size()
            if item.nbytes > DEFLATED * held + FREE:
                raise FileError(f"{path}: {key}: it announces {item.nbytes} bytes, the file holds {held} of them")
            found[key] = item[()]

    try:
        with h5py.File(path, "r") as file:
            file.visititems(take)
            sizes = {
                key: int(item.attrs["MATLAB_sparse"]) for key, item in file.items() if "MATLAB_sparse" in item.attrs
            }
    except (FileError, MemoryError):
        raise
    except Exception as error:
        raise FileError(f"{path}: expected an HDF5 file ({error})") from error
    for key, rows in sizes.items():
        data, places = found.pop(f"{key}/data", np.zeros(0)), found.pop(f"{key}/ir", np.zeros(0))
        starts = found.pop(f"{key}/jc", None)
        if starts is None:
            raise FileError(f"{path}: {key}: expected jc, the starts of columns of a sparse matrix")
        found[key] = scipy.sparse.csc_array((data, places, starts), shape=(rows, len(starts) - 1))
    return found


def memory() -> int:
    """Bytes of memory that the machine has."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # not on every system
        return 1 << 40
