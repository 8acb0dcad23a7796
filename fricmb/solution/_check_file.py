"""Whether the arrays of a file fit one another: shapes, types, times in order, nothing that is no number."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from fricmb.errors import FricmbError
from fricmb.integrate.event_kinds import EVENT_KINDS, TABLE
from fricmb.integrate.trajectory import IMPACT_COLUMNS
from fricmb.solution._events import ASKED
from fricmb.solution._names import VECTORS, Names
from fricmb.solution._run import ROUND_OFF
from fricmb.solution._stats import IslandStats, Stats


def check_arrays(held: Mapping[str, Any], values: Mapping[str, Any], names: Names, about: Mapping[str, Any]) -> None:
    """FricmbError that names the entry for anything that does not fit; ``values`` are the samples among them."""
    _check_numbers(about)
    _check_names(names, held)
    n, n_c, t = len(names.dofs), len(names.contacts), held["t"]
    _expect("t", t, (t.size,), "f")
    rows = {"q": n, "v": n, "z": int(names.z_start[-1]), "F": int(names.row[-1]), "g": int(names.row[-1])}
    rows |= {"N": n_c, "friction_loss": n_c}
    for name, count in rows.items():
        _expect(name, values[name], (count, t.size), "f")
    for name in ("damping_loss", "input", "kinetic", "potential", "residual"):
        _expect(name, held[name], t.shape, "f")
    _expect("mode", held["mode"], (n_c, t.size), "i")
    if held["mode"].dtype != np.int8 or not np.isin(held["mode"], (0, 1, 2)).all():
        raise FricmbError("entry 'mode' holds a mode that is not 0, 1 or 2")
    if "piece" in held:
        _expect("piece", held["piece"], t.shape, "i")
    _check_times(t, about)
    _check_events(held, names, about)


def check_stats(stats: Stats) -> None:
    """FricmbError for counters that are none."""
    every: tuple[Stats | IslandStats, ...] = (stats, *stats.islands)
    for one in every:
        for f in fields(one):
            value = getattr(one, f.name)
            good = any(_is(value, wanted.strip()) for wanted in str(f.type).split("|"))
            if not good:
                raise FricmbError(f"entry 'about': {f.name} of the stats is {value!r}")


def _is(value: Any, wanted: str) -> bool:
    """Whether a value is of a type that is given by its name."""
    if wanted.startswith("tuple["):
        inner = wanted[6:].partition(",")[0].rstrip("]")
        return isinstance(value, tuple) and all(_is(held, inner) for held in value)
    if wanted == "None":
        return value is None
    if wanted == "float":
        return type(value) in (int, float)
    return type(value).__name__ == wanted


def _check_numbers(about: Mapping[str, Any]) -> None:
    numbers = {name: about[name] for name in ("t_start", "t_end")}
    numbers |= {f"energy {name}": value for name, value in about["energy"].items()}
    for name, motion in about["motions"].items():
        for key in ("offset", "arm"):
            held = motion.get(key, 0.0)
            numbers |= {f"{key} {i} of {name}": x for i, x in enumerate(held if isinstance(held, list) else [held])}
    for name, value in numbers.items():
        if type(value) not in (int, float) or not np.isfinite(value):
            raise FricmbError(f"entry 'about': {name} is {value!r}; expected a finite number")


def _check_names(names: Names, held: Mapping[str, Any]) -> None:
    for entry, words in (("dof_names", names.dofs), ("contact_names", names.contacts)):
        if held[entry].ndim != 1 or not all(isinstance(word, str) for word in words) or len(set(words)) < len(words):
            raise FricmbError(f"entry {entry!r} is no list of different names")
    for what in ("directions", "states"):
        labels = getattr(names, what)
        if len(labels) != len(names.contacts) or not all(isinstance(word, str) for one in labels for word in one):
            raise FricmbError(f"entry 'about': {what} do not fit {len(names.contacts)} contacts")
    if names.row_scale.shape != (int(names.row[-1]), 1):
        raise FricmbError("entry 'about': scale does not fit the directions of the contacts")
    for name, motion in names.motions.items():
        index, n = motion.index, len(names.dofs)
        fits = index.ndim == 1 and index.shape == motion.coefficient.shape and -1 <= motion.angle < n
        if not fits or (index.size and not 0 <= index.min() <= index.max() < n) or len(motion.arm) != 2:
            raise FricmbError(f"entry 'about': the motion {name!r} does not fit {n} degrees of freedom")
    for name, vector in names.vectors.items():
        index, n = vector.index, len(names.dofs)
        if index.shape != (VECTORS.get(vector.kind, -1),) or not 0 <= index.min() <= index.max() < n:
            raise FricmbError(f"entry 'about': the vector {name!r} does not fit {n} degrees of freedom")
    if not all(type(index) is int for index in names.signals.values()):
        raise FricmbError("entry 'about': signals are no numbers of driven bodies")


def _expect(name: str, array: Any, shape: tuple[int, ...], kind: str) -> None:
    if array.shape != shape:
        raise FricmbError(f"entry {name!r} has the shape {array.shape}; expected {shape}")
    if array.dtype.kind != kind or (kind == "f" and array.dtype != np.float64):
        raise FricmbError(f"entry {name!r} holds {array.dtype}; expected {'float64' if kind == 'f' else 'integers'}")
    if kind == "f" and not np.isfinite(array).all():
        raise FricmbError(f"entry {name!r} holds a value that is not finite")


def _check_times(t: Any, about: Mapping[str, Any]) -> None:
    first, last = float(about["t_start"]), float(about["t_end"])
    if not (np.isfinite(first) and np.isfinite(last) and first <= last):
        raise FricmbError(f"entry 'about': a run from {first:g} to {last:g}")
    margin = ROUND_OFF * max(abs(first), abs(last))
    if t.size and not (first - margin <= t.min() and t.max() <= last + margin):
        raise FricmbError(f"entry 't' has times outside the run, which goes from {first:g} to {last:g}")
    if about["has_rows"] and np.any(np.diff(t) < 0.0):
        raise FricmbError("entry 't' has accepted steps that go back in time")


def _check_events(held: Mapping[str, Any], names: Names, about: Mapping[str, Any]) -> None:
    times, contacts, kinds = held["event_t"], held["event_contact"], held["event_kind"]
    _expect("event_t", times, (times.size,), "f")
    for name, array in (("event_contact", contacts), ("event_kind", kinds)):
        if array.shape != times.shape:
            raise FricmbError(f"entry {name!r} has the shape {array.shape}; expected {times.shape}")
    margin = ROUND_OFF * max(abs(float(about["t_start"])), abs(float(about["t_end"])))
    inside = (times >= about["t_start"] - margin) & (times <= about["t_end"] + margin)
    if not inside.all() or np.any(np.diff(times) < 0.0):
        raise FricmbError("entry 'event_t' has times out of order or outside the run")
    impacts = np.isin(kinds, [kind.name for kind in TABLE if kind.impact])
    if "event_impacts" in held:
        _expect("event_impacts", held["event_impacts"], (int(impacts.sum()), len(IMPACT_COLUMNS)), "f")
    # what is rigid needs no friction
    others = ~impacts & (kinds != "open") & (kinds != ASKED)
    if contacts.dtype.kind != "U" or not set(contacts[others].tolist()) <= set(names.contacts):
        raise FricmbError("entry 'event_contact' names a contact that is not there")
    if not set(kinds.tolist()) <= set(EVENT_KINDS):
        raise FricmbError("entry 'event_kind' names a kind of event that is not known")
