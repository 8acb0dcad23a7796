"""Solutions in npz files: plain arrays, JSON, and the run as data; nothing in a file is ever executed.

Format 2.  Every entry is a numpy array that ``numpy.load(path, allow_pickle=False)`` reads.  ``about`` is JSON: format,
version, names, counters, and the digest of every other entry; ``digest`` is that of ``about``.  ``run`` is JSON of the
scene and of what the dense output needs (:mod:`fricmb.solution._data`), its arrays stand in ``run_float64``, ....
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import secrets
import warnings
import zipfile
import zlib
from dataclasses import asdict, fields
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from fricmb._version import installed_version
from fricmb.errors import FricmbError, shown
from fricmb.integrate import Samples
from fricmb.solution._check_file import check_arrays, check_stats
from fricmb.solution._data import TYPES
from fricmb.solution._derivatives import Derivatives
from fricmb.solution._energy import Reference
from fricmb.solution._events import Event, Events
from fricmb.solution._formulas import NotStored
from fricmb.solution._names import Motion, Names, Vector
from fricmb.solution._run import Record
from fricmb.solution._solution import Solution, restore
from fricmb.solution._stats import IslandStats, Stats
from fricmb.solution._stored import Stored, store
from fricmb.values import Units

FORMAT = 2
#: What the run of a file of format 1 is, and what to do about it.
_OLD = (
    "its format is 1, where the scene was a pickle, which runs code when it is opened; simulate again and save, or "
    "go on with its arrays, which are read"
)
_RUN = "run_"
_SENSITIVITY = "sensitivity_"
_IMPACTS = "event_impacts"
#: Attributes of :class:`Derivatives` and the entries that hold them.
_DERIVED = {"S": "S", "end": "end", "event_times": "moved", "transversality": "transversality"}


def save(sol: Solution, path: str | PathLike[str]) -> None:
    """Write ``sol``; the file appears whole or not at all.  FricmbError, with the path, where no file can be."""
    target = _path(path)
    if not target.name or target.is_dir():
        raise FricmbError(f"path: got {str(path)!r}, which is a folder; expected the path of a file")
    if not target.suffix:
        target = target.with_suffix(".npz")
    entries = _entries(sol)
    part = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
    try:
        with part.open("xb") as file:
            np.savez(file, **entries)
        os.replace(part, target)
    except (FileNotFoundError, NotADirectoryError, IsADirectoryError, PermissionError) as error:
        raise FricmbError(f"path: {str(target)!r} cannot be written: {error.strerror}") from error
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


def load(path: str | PathLike[str], laws: Any = ()) -> Solution:
    """Read a file of :func:`save`; FricmbError, with file and entry, for anything else."""
    source = _path(path)
    if not source.exists() and not source.suffix:
        source = source.with_suffix(".npz")
    held = _read(source)
    about = _about(source, held)
    try:
        names = _names(held, about)
        values = {f.name: held[f.name] for f in fields(Samples)}
        check_arrays(held, values, names, about)
        values["F"] = (values["F"] + names.centres(values["N"])) / names.row_scale
        values["g"] = values["g"] * names.row_scale
        return restore(
            names=names,
            stats=_stats(about["stats"]),
            events=_events(held),
            record=Record(samples=Samples(**values), piece=held.get("piece")),
            span=(float(about["t_start"]), float(about["t_end"])),
            has_rows=bool(about["has_rows"]),
            energies=(held["kinetic"], held["potential"]),
            reference=Reference(**about["energy"]),
            run=_stored(source, held, about, laws),
            units=Units(**about.get("units", {})),
            derivatives=_derivatives(held, about, values["t"].size),
        )
    except FricmbError as error:
        raise FricmbError(f"{source}: {error}") from error
    except KeyError as error:
        raise FricmbError(f"{source} has no entry {error}") from error
    except (ValueError, TypeError, IndexError, AttributeError, OverflowError, RecursionError) as error:
        raise FricmbError(f"{source}, entry 'about' is inconsistent: {error}") from error


def _path(path: object) -> Path:
    if not isinstance(path, str | PathLike) or "\0" in str(path):
        raise FricmbError(f"path: got {shown(path)}; expected the path of a file")
    return Path(path)


# ---- writing


def _entries(sol: Solution) -> dict[str, Any]:
    entries = _arrays(sol)
    if sol._asked:
        entries |= {_SENSITIVITY + entry: getattr(sol.derivatives, name) for name, entry in _DERIVED.items()}
    run, missing = _run_of(sol)
    digests = {name: _digest(value) for name, value in (entries | run).items()}
    about = json.dumps({**_words(sol), "missing": missing, "digests": digests})
    return entries | run | {"about": np.array(about), "digest": np.array(_digest(np.array(about)))}


def _run_of(sol: Solution) -> tuple[dict[str, Any], str]:
    """Entries of the run, and why there are none."""
    stored = sol._run
    try:
        if isinstance(stored, Stored):  # not opened since it was read
            if stored.missing:
                return {}, stored.missing
            text, arrays = stored.text, stored.arrays
        else:
            text, arrays = store(stored)
    except NotStored as error:
        warnings.warn(f"the file will hold neither scene nor dense output: {error}", stacklevel=4)
        return {}, str(error)
    return {"run": np.frombuffer(text.encode(), dtype=np.uint8)} | {
        _RUN + name: value for name, value in arrays.items()
    }, ""


def _arrays(sol: Solution) -> dict[str, Any]:
    names, record, energy = sol.names, sol.record, sol.energy
    arrays = {f.name: getattr(sol.accounts, f.name) for f in fields(Samples)}
    arrays["F"], arrays["g"] = arrays["F"] * names.row_scale - names.centres(arrays["N"]), arrays["g"] / names.row_scale
    if record.piece is not None:
        arrays["piece"] = record.piece
    return arrays | {
        "kinetic": energy.kinetic,
        "potential": energy.potential,
        "residual": energy.residual,
        "dof_names": np.array(names.dofs, dtype=np.str_),
        "contact_names": np.array(names.contacts, dtype=np.str_),
        "event_t": sol.events.t,
        "event_contact": np.array([event.name for event in sol.events], dtype=np.str_),
        "event_kind": np.array([event.kind for event in sol.events], dtype=np.str_),
        **({_IMPACTS: sol.events.impacts} if len(sol.events.impacts) else {}),
    }


def _words(sol: Solution) -> dict[str, Any]:
    names = sol.names
    return {
        "format": FORMAT,
        "fricmb": installed_version(),
        "directions": names.directions,
        "states": names.states,
        "scale": names.scale,
        "offset": names.offset,
        "motions": {
            name: {**asdict(motion), "index": motion.index.tolist(), "coefficient": motion.coefficient.tolist()}
            for name, motion in names.motions.items()
        },
        "vectors": {name: [vector.kind, *vector.index.tolist()] for name, vector in names.vectors.items()},
        "signals": dict(names.signals),
        "stats": asdict(sol.stats),
        "t_start": sol.t_start,
        "t_end": sol.t_end,
        "has_rows": sol.has_rows,
        "energy": asdict(sol.energy.reference),
        "units": asdict(sol.units),
        "sensitivities": _named(sol.derivatives) if sol._asked else None,
    }


def _named(derivatives: Derivatives) -> dict[str, Any]:
    return {name: getattr(derivatives, name) for name in ("asked", "columns", "n_states", "unsafe")}


def _digest(value: Any) -> str:
    array = np.asarray(value)
    digest = hashlib.sha256(f"{array.dtype.str} {array.shape}".encode())
    digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


# ---- reading


def _read(source: Path) -> dict[str, Any]:
    """Every entry of an npz file."""
    if not source.is_file():
        raise FricmbError(f"there is no file {str(source)!r}")
    entry = ""
    try:
        with source.open("rb") as file:
            start = file.read(4)
        if not start:
            raise FricmbError(f"{source} is empty")
        if start[:2] != b"PK":
            raise FricmbError(f"{source} is no solution of fricmb: it is no npz file")
        held = {}
        with np.load(source, allow_pickle=False) as data:
            if len(set(data.zip.namelist())) < len(data.zip.namelist()):
                raise FricmbError(f"{source} is damaged: an entry is there twice")
            for entry in data.files:
                held[entry] = data[entry]
                if not isinstance(held[entry], np.ndarray):
                    raise FricmbError(f"{source}, entry {entry!r} is no array")
        return held
    except FricmbError:
        raise
    except (OSError, ValueError, EOFError, KeyError, TypeError, SyntaxError, zipfile.BadZipFile, zlib.error) as error:
        raise FricmbError(f"{source} is damaged{_at(entry)}: {error}") from error
    except (NotImplementedError, RuntimeError, MemoryError, OverflowError, AttributeError, IndexError) as error:
        raise FricmbError(f"{source} is damaged{_at(entry)}: {type(error).__name__} {error}") from error
    except Exception as error:  # zip files can be wrong in ways that the library does not foresee
        if type(error).__module__ in ("struct", "tokenize", "lzma", "_lzma", "binascii"):
            raise FricmbError(f"{source} is damaged{_at(entry)}: {error}") from error
        raise


def _at(entry: str) -> str:
    return f" at the entry {entry!r}" if entry else ""


def _about(source: Path, held: dict[str, Any]) -> dict[str, Any]:
    """What the file says about itself, once it is seen to be what was written."""
    if "about" not in held:
        raise FricmbError(f"{source} is no solution of fricmb: it has no entry 'about'")
    try:
        about = json.loads(str(held["about"]))
        number, version = about["format"], str(about["fricmb"])
        if type(number) is not int or not isinstance(about, dict):
            raise ValueError(f"the format is {number!r}")
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise FricmbError(f"{source}, entry 'about' is damaged: {error}") from error
    if number > FORMAT:
        raise FricmbError(f"{source} was written by a later fricmb ({version}) in format {number}: read it with that")
    if number < 1:
        raise FricmbError(f"{source}, entry 'about': there is no format {number}")
    if number == FORMAT:
        _check_digests(source, held, about)
    return about


def _check_digests(source: Path, held: dict[str, Any], about: dict[str, Any]) -> None:
    if str(held.get("digest", "")) != _digest(held["about"]):
        raise FricmbError(f"{source}, entry 'about' is not what was written: its digest differs")
    digests = about.get("digests")
    if not isinstance(digests, dict):
        raise FricmbError(f"{source}, entry 'about' holds no digests")
    for name in sorted(digests.keys() | held.keys() - {"about", "digest"}):
        if name not in held:
            raise FricmbError(f"{source} has no entry {name!r}")
        if name not in digests or digests[name] != _digest(held[name]):
            raise FricmbError(f"{source}, entry {name!r} is not what was written: its digest differs")


def _stored(source: Path, held: dict[str, Any], about: dict[str, Any], laws: Any) -> Stored:
    span = float(about["t_start"]), float(about["t_end"])
    if about["format"] < FORMAT:
        return Stored(str(source), "", {}, span, missing=_OLD, laws=())
    missing = str(about["missing"])
    text = "" if missing else held["run"].tobytes().decode()
    arrays = {name: held[_RUN + name] for name in TYPES if _RUN + name in held}
    for name, values in arrays.items():
        if values.dtype.name != name or values.ndim != 1:
            raise FricmbError(f"entry {_RUN + name!r} holds {values.dtype} of shape {values.shape}")
    return Stored(str(source), text, arrays, span, missing=missing, laws=laws)


def _names(data: Any, about: dict[str, Any]) -> Names:
    return Names(
        dofs=tuple(data["dof_names"].tolist()),
        contacts=tuple(data["contact_names"].tolist()),
        directions=tuple(tuple(labels) for labels in about["directions"]),
        states=tuple(tuple(labels) for labels in about["states"]),
        scale=tuple(tuple(factors) for factors in about.get("scale", ())),
        offset=tuple(tuple(centre) for centre in about.get("offset", ())),
        motions={
            name: Motion(
                index=np.array(motion["index"], dtype=np.int64),
                coefficient=np.array(motion["coefficient"], dtype=float),
                offset=motion.get("offset", 0.0),
                angle=motion.get("angle", -1),
                arm=tuple(motion.get("arm", (0.0, 0.0))),
            )
            for name, motion in about["motions"].items()
        },
        vectors={
            name: Vector(kind=kind, index=np.array(index, dtype=np.int64))
            for name, (kind, *index) in about.get("vectors", {}).items()
        },
        signals=about["signals"],
    )


def _derivatives(held: dict[str, Any], about: dict[str, Any], n_t: int) -> Derivatives | None:
    words = about.get("sensitivities")
    if words is None:
        return None
    arrays = {name: held[_SENSITIVITY + entry] for name, entry in _DERIVED.items()}
    for name, array in arrays.items():
        if array.dtype != np.float64 or np.isnan(array).any():
            raise FricmbError(f"entry {_SENSITIVITY + _DERIVED[name]!r} holds what is no number")
    if arrays["S"].shape[:1] != (n_t,) or arrays["transversality"].shape != held["event_t"].shape:
        raise FricmbError("the derivatives in it do not fit its times")
    asked, columns = (tuple(map(str, words[name])) for name in ("asked", "columns"))
    unsafe = tuple(words.get("unsafe", ()))
    return Derivatives(asked=asked, columns=columns, n_states=int(words["n_states"]), unsafe=unsafe, **arrays)


def _stats(held: dict[str, Any]) -> Stats:
    islands = tuple(IslandStats(**{**one, "dofs": tuple(one["dofs"])}) for one in held.get("islands", ()))
    rows: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in held.items()}
    stats = Stats(**{**rows, "islands": islands})
    check_stats(stats)
    return stats


def _events(data: Any) -> Events:
    columns = zip(data["event_t"].tolist(), data["event_contact"].tolist(), data["event_kind"].tolist(), strict=True)
    found = Events(Event(*row) for row in columns)
    return found.with_impacts(data[_IMPACTS]) if _IMPACTS in data else found
