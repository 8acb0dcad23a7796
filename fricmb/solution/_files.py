"""Solutions in npz files: plain arrays, and beside them a pickle of the run for the dense output."""

from __future__ import annotations

import json
import os
import pickle
import secrets
from dataclasses import asdict, fields
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

import fricmb
from fricmb.errors import FricmbError
from fricmb.integrate import Samples
from fricmb.solution._energy import Reference
from fricmb.solution._events import Event, Events
from fricmb.solution._names import Motion, Names
from fricmb.solution._run import Record, Run
from fricmb.solution._solution import Solution, restore
from fricmb.solution._stats import IslandStats, Stats

FORMAT = 1


def save(sol: Solution, path: str | PathLike[str]) -> None:
    """Write ``sol``; the file appears whole or not at all."""
    target = Path(path)
    if not target.suffix:
        target = target.with_suffix(".npz")
    part = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
    try:
        with part.open("xb") as file:
            np.savez(file, **_arrays(sol))
        os.replace(part, target)
    finally:
        part.unlink(missing_ok=True)


def load(path: str | PathLike[str]) -> Solution:
    """Read a file of :func:`save`."""
    source = Path(path)
    if not source.exists() and not source.suffix:
        source = source.with_suffix(".npz")
    with np.load(source, allow_pickle=False) as data:
        if "about" not in data:
            raise FricmbError(f"{source} is no solution of fricmb: it has no entry 'about'")
        about = json.loads(str(data["about"]))
        if about["format"] > FORMAT:
            raise FricmbError(f"{source} was written by a later fricmb ({about['fricmb']})")
        names = _names(data, about)
        values = {f.name: data[f.name] for f in fields(Samples)}
        values["F"], values["g"] = values["F"] / names.row_scale, values["g"] * names.row_scale
        return restore(
            names=names,
            stats=_stats(about["stats"]),
            events=_events(data),
            record=Record(samples=Samples(**values), piece=data.get("piece")),
            span=(about["t_start"], about["t_end"]),
            has_rows=about["has_rows"],
            energies=(data["kinetic"], data["potential"]),
            reference=Reference(**about["energy"]),
            run=data["run"].tobytes(),
        )


def open_run(data: bytes) -> Run:
    """Unpickle the run of a file."""
    if not data:
        raise FricmbError("this file holds no scene and no dense output: its scene could not be pickled")
    run = pickle.loads(data)
    if not isinstance(run, Run):
        raise FricmbError(f"this file holds no run but a {type(run).__name__}")
    return run


def _arrays(sol: Solution) -> dict[str, Any]:
    names, record, energy = sol.names, sol.record, sol.energy
    arrays = {f.name: getattr(record.samples, f.name) for f in fields(Samples)}
    arrays["F"], arrays["g"] = arrays["F"] * names.row_scale, arrays["g"] / names.row_scale
    if record.piece is not None:
        arrays["piece"] = record.piece
    about = {
        "format": FORMAT,
        "fricmb": fricmb.__version__,
        "directions": names.directions,
        "states": names.states,
        "scale": names.scale,
        "motions": {
            name: {**asdict(motion), "index": motion.index.tolist(), "coefficient": motion.coefficient.tolist()}
            for name, motion in names.motions.items()
        },
        "signals": dict(names.signals),
        "stats": asdict(sol.stats),
        "t_start": sol.t_start,
        "t_end": sol.t_end,
        "has_rows": sol.has_rows,
        "energy": asdict(energy.reference),
    }
    return arrays | {
        "kinetic": energy.kinetic,
        "potential": energy.potential,
        "residual": energy.residual,
        "dof_names": np.array(names.dofs, dtype=np.str_),
        "contact_names": np.array(names.contacts, dtype=np.str_),
        "event_t": sol.events.t,
        "event_contact": np.array([event.contact for event in sol.events], dtype=np.str_),
        "event_kind": np.array([event.kind for event in sol.events], dtype=np.str_),
        "about": np.array(json.dumps(about)),
        "run": np.frombuffer(_pickled(sol), dtype=np.uint8),
    }


def _pickled(sol: Solution) -> bytes:
    try:
        return pickle.dumps(sol.run, protocol=pickle.HIGHEST_PROTOCOL)
    except (pickle.PicklingError, AttributeError, TypeError):
        return b""  # a law defined inside a function: the arrays are worth saving all the same


def _names(data: Any, about: dict[str, Any]) -> Names:
    return Names(
        dofs=tuple(data["dof_names"].tolist()),
        contacts=tuple(data["contact_names"].tolist()),
        directions=tuple(tuple(labels) for labels in about["directions"]),
        states=tuple(tuple(labels) for labels in about["states"]),
        scale=tuple(tuple(factors) for factors in about.get("scale", ())),
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
        signals=about["signals"],
    )


def _stats(held: dict[str, Any]) -> Stats:
    islands = tuple(IslandStats(**{**one, "dofs": tuple(one["dofs"])}) for one in held.get("islands", ()))
    return Stats(**{**held, "notes": tuple(held["notes"]), "islands": islands})


def _events(data: Any) -> Events:
    columns = zip(data["event_t"].tolist(), data["event_contact"].tolist(), data["event_kind"].tolist(), strict=True)
    return Events(Event(*row) for row in columns)
