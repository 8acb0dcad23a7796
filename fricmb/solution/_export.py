"""Signals of a solution as files of other programs: MATLAB, HDF5, tables of text."""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fricmb.errors import FricmbError, unknown_name

if TYPE_CHECKING:
    from fricmb.solution._signals import Signals

KINDS = (".mat", ".h5", ".hdf5", ".csv")
#: Names of MATLAB are no longer than this.
_LONGEST = 63


def export(sol: Signals, path: str | PathLike[str], names: Iterable[str] | None = None) -> Path:
    """See :meth:`fricmb.Solution.export`."""
    from fricmb.solution._table import columns

    file = Path(path)
    if file.suffix.lower() not in KINDS:
        raise unknown_name("ending of a file", file.suffix, KINDS)
    signals: dict[str, Any] = {"t": sol.t, **columns(sol, names)}
    kind = file.suffix.lower()
    write = _write_mat if kind == ".mat" else _write_csv if kind == ".csv" else _write_hdf5
    write(file, signals, sol)
    return file


def _events(sol: Signals) -> dict[str, Any]:
    """Transitions as columns."""
    events = list(sol.events)
    return {"t": [e.t for e in events], "contact": [e.name for e in events], "kind": [e.kind for e in events]}


def _write_mat(file: Path, signals: dict[str, Any], sol: Signals) -> None:
    """Each signal as a column, dots in its name as underscores; ``names`` has the names as they are."""
    import numpy as np
    from scipy.io import savemat

    events = _events(sol)
    plain = {name: name.replace(".", "_").replace(" ", "_")[:_LONGEST] for name in signals}
    if len(set(plain.values())) < len(plain):
        raise FricmbError("export: names of signals are the same without dots; choose some of them with names=")
    table: dict[str, Any] = {plain[name]: np.asarray(values, dtype=float)[:, None] for name, values in signals.items()}
    texts = {key: np.array(events[key], dtype=object)[:, None] for key in ("contact", "kind")}
    table["events"] = {"t": np.array(events["t"])[:, None], **texts}
    table["names"] = np.array(list(signals), dtype=object)[:, None]
    savemat(file, table, appendmat=False)


def _write_hdf5(file: Path, signals: dict[str, Any], sol: Signals) -> None:
    """A data set for each signal by its name, transitions below "events", units as attributes of the file."""
    try:
        import h5py
    except ImportError as error:
        raise ImportError('export to HDF5 needs h5py: pip install "fricmb[hdf5]"') from error
    events, units = _events(sol), sol.units
    with h5py.File(file, "w") as held:
        held.attrs.update({"time": units.time, "length": units.length, "force": units.force})
        for name, values in signals.items():
            held.create_dataset(name, data=values)
        for name, column in events.items():
            kind = None if name == "t" else h5py.string_dtype()
            held.create_dataset(f"events/{name}", data=column, dtype=kind or "f8")


def _write_csv(file: Path, signals: dict[str, Any], sol: Signals) -> None:
    """Comma-separated values with a header; every digit that a float has."""
    rows = zip(*(map(repr, values.tolist()) for values in signals.values()), strict=True)
    with file.open("w", encoding="utf-8") as out:
        out.write(",".join(signals) + "\n")
        out.writelines(",".join(row) + "\n" for row in rows)
