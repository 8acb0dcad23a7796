"""Where a run starts: as declared, from given values, or from the end of another run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from fricmb._simulate._arguments import number
from fricmb._simulate._mechanics import SceneMechanics, mechanics_of
from fricmb.errors import SceneError, shown, unknown_name
from fricmb.integrate import SLIP, Start
from fricmb.integrate.problem import Floats
from fricmb.solution import Names, Solution

KEYS = ("position", "velocity", "state")


def find_start(mechanics: SceneMechanics, initial: Any, t_start: float) -> tuple[Start, SceneMechanics]:
    """The start of a run, and the mechanics with driven bodies where they then are."""
    if isinstance(initial, Solution):
        return _continued(mechanics, initial, t_start)
    if initial is None:
        start = mechanics.start
    elif isinstance(initial, Mapping):
        start = _given(mechanics, initial)
    else:
        keys = ", ".join(KEYS)
        raise SceneError(f"initial: got {shown(initial)}; expected a Solution or a dict with any of the keys {keys}")
    if t_start == 0.0:
        return start, mechanics
    return replace(start, t=t_start), _with_driven_at(mechanics, {}, t_start)


def _with_driven_at(mechanics: SceneMechanics, wanted: Mapping[str, float], t: float) -> SceneMechanics:
    shift = mechanics.driven.shift_to(wanted, t)
    total = {name: mechanics.shift.get(name, 0.0) + by for name, by in shift.items()}
    if not shift:
        return mechanics
    return mechanics_of(mechanics.scene, observe=mechanics.observe, shift=total, together=mechanics.together)


# ---- given by the user


def _given(mechanics: SceneMechanics, initial: Mapping[str, Any]) -> Start:
    for key in initial:
        if key not in KEYS:
            raise unknown_name("key of initial", key, KEYS)
    names, start = mechanics.names, mechanics.start
    return replace(
        start,
        q=_values("position", initial.get("position", {}), names, start.q),
        v=_values("velocity", initial.get("velocity", {}), names, start.v),
        z=_states(initial.get("state", {}), names, start.z),
    )


def _values(key: str, given: Any, names: Names, declared: Floats) -> Floats:
    values = declared.copy()
    for name, value in _mapping(key, given).items():
        if name not in names.dof_index:
            raise unknown_name(f"degree of freedom in initial[{key!r}]", name, names.dofs)
        values[names.dof_index[name]] = number(f"initial[{key!r}][{name!r}]", value, "a finite number")
    return values


def _states(given: Any, names: Names, declared: Floats) -> Floats:
    values = declared.copy()
    for contact, value in _mapping("state", given).items():
        k = names.contact(contact)
        count = len(names.states[k])
        what = f"initial['state'][{contact!r}]"
        if not count:
            raise SceneError(f"{what}: got {shown(value)}, but the law of this contact has no states")
        try:
            state = np.atleast_1d(np.asarray(value, dtype=float))
        except (TypeError, ValueError, OverflowError):
            state = np.empty(0)
        if state.shape != (count,) or not np.isfinite(state).all():
            raise SceneError(f"{what}: got {shown(value)}; expected {count} finite number(s), for {names.states[k]!r}")
        values[names.z_start[k] : names.z_start[k + 1]] = state
    return values


def _mapping(key: str, given: Any) -> Mapping[str, Any]:
    if not isinstance(given, Mapping):
        raise SceneError(f"initial[{key!r}]: got {shown(given)}; expected a dict of names and values")
    return given


# ---- from another run


def _continued(mechanics: SceneMechanics, before: Solution, t_start: float) -> tuple[Start, SceneMechanics]:
    end, old, new = before.end, before.names, mechanics.names
    if t_start not in (0.0, end.t):
        raise SceneError(
            f"t_start: got {shown(t_start)}, but the run goes on from a solution that ends at {end.t:.17g};"
            " leave it out"
        )
    for name in new.dofs:
        if name not in old.dof_index:
            raise SceneError(f"initial: the solution has no degree of freedom {name!r}; it has {', '.join(old.dofs)}")
    order = [old.dof_index[name] for name in new.dofs]
    mode, direction = _modes(mechanics, before)
    start = Start(
        t=end.t, q=end.q[order], v=end.v[order], z=_kept_states(mechanics, before), mode=mode, direction=direction
    )
    if new.signals:
        there = np.array([end.t])
        wanted = {name: float(before.run.signal(i, there)[0][0]) for name, i in old.signals.items()}
        mechanics = _with_driven_at(mechanics, wanted, end.t)
    return start, mechanics


def _kept_states(mechanics: SceneMechanics, before: Solution) -> Floats:
    """Law states of contacts that have the same ones; the declared start for others."""
    old, new = before.names, mechanics.names
    z = mechanics.start.z.copy()
    for k, name in enumerate(new.contacts):
        j = old.contact_index.get(name)
        if j is not None and old.states[j] == new.states[k]:
            z[new.z_start[k] : new.z_start[k + 1]] = before.end.z[old.z_start[j] : old.z_start[j + 1]]
    return z


def _modes(mechanics: SceneMechanics, before: Solution) -> tuple[Any, Any]:
    """Modes and slip directions, if every contact has one that fits; else None: found from the accelerations."""
    old, new, end = before.names, mechanics.names, before.end
    is_smooth = mechanics.smooth()
    if end.mode is None or end.direction is None:
        return None, None
    mode = np.empty(len(new.contacts), dtype=np.int8)
    direction = np.zeros(int(new.row[-1]))
    was_smooth = before.run.pieces[-1].mechanics.smooth()
    for k, name in enumerate(new.contacts):
        j = old.contact_index.get(name)
        smooth = bool(is_smooth[k])
        rescaled = j is not None and old.scale[j : j + 1] != new.scale[k : k + 1]
        if j is None or rescaled or old.directions[j] != new.directions[k] or (was_smooth[j] and not smooth):
            return None, None
        mode[k] = SLIP if smooth and end.mode[j] != 2 else end.mode[j]
        direction[new.row[k] : new.row[k + 1]] = end.direction[old.row[j] : old.row[j + 1]]
    return mode, direction
