"""Columns of numbers: text, sound, and the containers of MATLAB, numpy, HDF5 and LabVIEW."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io

from fricmb._files import Clipped, hdf5_arrays, mat_arrays, npz_arrays, text_of, wav_fits
from fricmb.errors import FileError, MissingExtraError, unknown_name
from fricmb.measure._types import Frf, Measured, TimeSeries

#: Names of columns that hold times and frequencies.
TIMES = re.compile(r"^(t|time|zeit|x_time)\b", re.IGNORECASE)
FREQUENCIES = re.compile(r"^(f|freq|frequency|frequenz|hz)\b", re.IGNORECASE)
#: First value and step of times or frequencies, or the name of their column.
Over = tuple[float, float] | str | None
_UNIT = re.compile(r"^(.*?)\s*[\[(]\s*([^\])]*)\s*[\])]\s*$")


def read_csv(path: Path, over: Over) -> Measured:
    """Text in columns, with or without a line of names; complex numbers as ``(1+2j)``."""
    text = text_of(path, "a text file of numbers in columns", "utf-8-sig")
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith(("#", "%"))]
    if not lines:
        raise FileError(f"{path}: expected numbers in columns, found nothing")
    mark = _delimiter(lines)
    decimal_comma = mark != "," and any("," in line for line in lines[:50])
    rows = [line.split() for line in lines]
    if mark != " ":
        rows = list(csv.reader(lines, delimiter=mark, skipinitialspace=True))
    names, first = _names(rows, decimal_comma)
    width = len(rows[first]) - (not rows[first][-1].strip()) if first < len(rows) else 0
    values = np.empty((len(rows) - first, width), dtype=complex)
    for i, row in enumerate(rows[first:]):
        cells = row[:-1] if len(row) == width + 1 and not row[-1].strip() else row
        if len(cells) != width:
            raise FileError(f"{path}: line {first + i + 1}: expected {width} columns, got {len(cells)}")
        for j, cell in enumerate(cells):
            number = _number(cell, decimal_comma)
            if number is None:
                raise FileError(f"{path}: line {first + i + 1}: expected a number in column {j + 1}, got {cell[:40]!r}")
            values[i, j] = number
    if len(values) < 2:
        raise FileError(f"{path}: expected at least two lines of numbers")
    for j, name in enumerate(names[:width]):
        if name in names[:j]:
            both = f"{names.index(name) + 1} and {j + 1}"
            raise FileError(f"{path}: expected another name for each column, found {name!r} over columns {both}")
    columns = {
        name: values[:, j] if values[:, j].imag.any() else values[:, j].real for j, name in enumerate(names[:width])
    }
    return _measured(path, columns, over)


def _delimiter(lines: list[str]) -> str:
    for mark in (";", "\t", ","):
        if all(mark in line for line in lines[:20]):
            return mark
    return " "


def _number(cell: str, decimal_comma: bool) -> complex | None:
    plain = cell.strip().strip('"')
    plain = plain.replace(",", ".") if decimal_comma else plain
    try:
        return complex(plain.replace(" ", "").replace("i", "j") if "nan" not in plain.lower() else plain)
    except ValueError:
        return None


def _names(rows: list[list[str]], decimal_comma: bool) -> tuple[list[str], int]:
    """Names of columns, and the first row of numbers."""
    for first, row in enumerate(rows[:20]):
        if all(_number(cell, decimal_comma) is not None for cell in row if cell.strip()):
            # of several lines above the numbers the first has the names, those below units and the like
            heads = [head for head in rows[:first] if len(head) >= len(row) - (not row[-1].strip())]
            cells = [cell.strip().strip('"') for cell in heads[0]] if heads else []
            names = [*cells, *[""] * (len(row) - len(cells))]
            return [name or f"column {j + 1}" for j, name in enumerate(names)], first
    return [], len(rows)


def read_wav(path: Path, over: Over) -> Measured:
    """Sound, integers over their full scale."""
    wav_fits(path)
    try:
        rate, data = scipy.io.wavfile.read(path)
    except Exception as error:
        raise FileError(f"{path}: expected a sound file, WAV ({error})") from error
    size = float(np.iinfo(data.dtype).max) + 1.0 if data.dtype.kind in "iu" else 1.0
    values = np.atleast_2d(data.T).astype(float)
    values = (values - 128.0) / 128.0 if data.dtype == np.uint8 else values / size
    t = np.arange(values.shape[1]) / rate
    return Measured(signals=tuple(TimeSeries(t=t, y=y, name=f"channel {i + 1}") for i, y in enumerate(values)))


def read_npz(path: Path, over: Over) -> Measured:
    """Vectors of numpy."""
    return _measured(path, npz_arrays(path), over)


def read_mat(path: Path, over: Over) -> Measured:
    """Vectors of MATLAB."""
    return _measured(path, mat_arrays(path), over)


def read_hdf5(path: Path, over: Over) -> Measured:
    """Datasets of one dimension."""
    return _measured(path, hdf5_arrays(path), over)


def read_tdms(path: Path, over: Over) -> Measured:
    """Channels of LabVIEW, each with its own times."""
    try:
        from nptdms import TdmsFile
    except ImportError:
        raise MissingExtraError(f"measure.read of {path.name}", "npTDMS", "tdms") from None
    try:
        with Clipped(path) as file:
            _check_sizes(path, TdmsFile.read_metadata(file))
        whole = TdmsFile.read(str(path))
        channels = [channel for group in whole.groups() for channel in group.channels()]
    except FileError:
        raise
    except Exception as error:
        raise FileError(f"{path}: expected a TDMS file ({type(error).__name__}: {error})") from error
    signals = []
    for channel in channels:
        y = np.asarray(channel[:])
        if y.dtype.kind not in "iuf" or y.size < 2:
            continue
        if "wf_increment" in channel.properties:
            t = channel.time_track()
        elif isinstance(over, tuple):
            t = over[0] + over[1] * np.arange(y.size)
        else:
            raise FileError(f"{path}: channel {channel.name!r} has no times; give step=")
        unit = str(channel.properties.get("unit_string", ""))
        signals.append(TimeSeries(t=np.asarray(t, dtype=float), y=y.astype(float), name=channel.name, unit=unit))
    cut = whole.file_status.incomplete_final_segment
    return Measured(signals=tuple(signals), notes=("the last piece of the recording is cut off",) if cut else ())


def _check_sizes(path: Path, file: Any) -> None:
    """What all channels announce lies within the file."""
    announced = 0
    for channel in (channel for group in file.groups() for channel in group.channels()):
        announced += len(channel) * (getattr(channel.data_type, "size", None) or 0)
    if announced > path.stat().st_size:
        there = path.stat().st_size
        raise FileError(f"{path}: its heads announce {announced} bytes of values, the file has {there}; it is cut off")


def _measured(path: Path, columns: Mapping[str, Any], over: Over) -> Measured:
    """Signals, and frequency responses of complex columns, over a column of times or frequencies."""
    numbers = {key: np.squeeze(v) for key, v in columns.items() if isinstance(v, np.ndarray) and v.dtype.kind in "iufc"}
    vectors = {key: v for key, v in numbers.items() if v.ndim == 1 and v.size > 1}
    if not vectors:
        raise FileError(f"{path}: expected columns of numbers, found none")
    times = over if isinstance(over, str) else None
    if times is not None and times not in vectors:
        raise unknown_name(f"column of {path}", times, vectors)
    if over is None:
        times = next((key for key in vectors if TIMES.match(key)), None)
        times = times or next((key for key in vectors if FREQUENCIES.match(key)), None)
        if times is None and len(vectors) > 1 and next(iter(vectors)).startswith("column"):
            times = next(iter(vectors))  # of a table without names the first
        if times is None:
            there = ", ".join(list(vectors)[:8])
            raise FileError(f"{path}: expected a column of times or frequencies among {there}; or give step=")
    signals, frfs = [], []
    for key, values in vectors.items():
        if key == times:
            continue
        x = over[0] + over[1] * np.arange(values.size) if isinstance(over, tuple) else vectors[times].real  # type: ignore[index]
        if x.shape != values.shape:
            raise FileError(f"{path}: {key}: expected {x.size} values, as many as of {times}, got {values.size}")
        if not (np.diff(x) > 0.0).all():
            raise FileError(f"{path}: {times}: expected rising values; they do not rise at place {_falls(x)}")
        match = _UNIT.match(key)
        name, unit = (match[1], match[2]) if match else (key, "")
        if np.iscomplexobj(values):
            frfs.append(Frf(f=x.astype(float), values=values, name=name, unit=unit))
        else:
            signals.append(TimeSeries(t=x.astype(float), y=values.astype(float), name=name, unit=unit))
    return Measured(signals=tuple(signals), frfs=tuple(frfs))


def _falls(x: Any) -> int:
    return int(np.argmin(np.diff(x) > 0.0)) + 2
