"""Arrays by name in the containers of numpy, MATLAB and HDF5.  Nothing in a file is run: no pickles, no objects."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from fricmb._files._mat import mat_5
from fricmb.errors import FileError, MissingExtraError

Arrays = dict[str, Any]


def npz_arrays(path: Path) -> Arrays:
    """Arrays of numpy."""
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            return {key: file[key] for key in file.files}
    except MemoryError:
        raise
    except Exception as error:
        raise FileError(f"{path}: expected an npz file of numbers ({error})") from error


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
