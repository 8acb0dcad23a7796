"""Modes that a scene's contacts and loads do not need: replaced by a few that keep the static flexibility."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.reduction import Residual, flexibility, modal_residual, modes_to_keep
from fricmb.scene import Contact, Element, ModalBody, Point, Scene, modal_matrices
from fricmb.values import is_expression, value_of

Floats = NDArray[np.float64]


#: Modes up to this multiple of the highest frequency of the loads are kept: those above follow it, an eighth too large.
ABOVE = 3.0
#: What the estimate is multiplied by where loads vibrate: above the lowest modes they move a body by less than the
#: static displacement that the shares refer to (from experience, not a bound).
VIBRATING = 2.0


@dataclass(frozen=True)
class Truncated:
    """A scene with fewer modes, and what that brings."""

    scene: Scene
    notes: tuple[str, ...]


def truncated(scene: Scene) -> Truncated:
    """The scene with the modal bodies that allow a truncation reduced; kept with the scene."""
    return scene._once("truncated", lambda: _truncate(scene))


def _truncate(scene: Scene) -> Truncated:
    bodies = [part for part in scene.parts if isinstance(part, ModalBody)]
    notes = [_neglected(body) for body in bodies if body.residual]
    changed = {}
    fastest = highest_frequency(scene) if any(body.truncation is not None for body in bodies) else 0.0
    for body in bodies:
        if body.truncation is not None:
            new, note = reduced(body, loaded_points(scene, body), value_of(body.truncation), fastest)
            notes.append(note)
            if new is not body:
                changed[body.name] = new
    return Truncated(scene._with_parts(dict(changed)) if changed else scene, tuple(notes))


def _neglected(body: ModalBody) -> str:
    kept = body.n_modes - body.residual
    return (
        f"{body.name}: {kept} modes and {body.residual} residual ones for those left out, which carry"
        f" {body.neglected:.1e} of the static flexibility at its points; displacement there is wrong by at most about"
        f" {2.0 * body.neglected:.1e} of its elastic part where a force jumps or vibrates below"
        f" {min(value_of(body.frequencies)[kept:]) / ABOVE:.3g} rad per unit of time"
    )


def loaded_points(scene: Scene, body: ModalBody) -> tuple[str, ...]:
    """Points of a body that contacts and elements act on."""
    names = {
        end.point
        for part in scene.parts
        if isinstance(part, Element | Contact)
        for end in _ends(part)
        if isinstance(end, Point) and end.body.name == body.name
    }
    return tuple(name for name in body.shapes if name in names)


def _ends(part: Element | Contact) -> Iterator[object]:
    for field in dataclasses.fields(part):
        yield getattr(part, field.name)


def reduced(body: ModalBody, points: tuple[str, ...], tolerance: float, fastest: float = 0.0) -> tuple[ModalBody, str]:
    """A body with as few modes as keep the error of displacement at the points below ``tolerance`` of its elastic part.

    Modes that a load of angular frequency ``fastest`` might bring near resonance are kept, too.

    Returns
    -------
    ModalBody
        The body itself where nothing is gained.
    str
        What was done, with the estimate.
    """
    omega = np.asarray(value_of(body.frequencies), dtype=float)
    whole = f"{body.name}: all {body.n_modes} modes"
    if body.damping is not None:
        return body, f"{whole}, since damping couples them"
    if (np.diff(omega) < 0.0).any():
        return body, f"{whole}, since their frequencies do not rise"
    mass, _, _ = modal_matrices(body)
    shapes = {name: np.asarray(value_of(shape), dtype=float) / np.sqrt(mass) for name, shape in body.shapes.items()}
    loads = np.vstack([shapes[name] for name in points]) if points else np.zeros((0, omega.size))
    swing = 2.0 * (VIBRATING if fastest > 0.0 else 1.0)
    count, _ = modes_to_keep(omega, loads, 2.0 * tolerance / swing)
    count = max(count, int(np.count_nonzero(omega <= ABOVE * fastest)))
    count = max([count, *(i + 1 for i, name in enumerate(body.dof_names) if _starts(body, name))])
    residual = modal_residual(omega[count:], loads[:, count:])
    if count + residual.frequencies.size >= body.n_modes:
        return body, f"{whole} are needed for {tolerance:.1e} of the elastic displacement"
    share = flexibility(omega, loads)
    lost = float(np.max(share[:, count:].sum(axis=1) / np.maximum(share.sum(axis=1), 1e-300), initial=0.0))
    note = (
        f"{body.name}: {count} of {body.n_modes} modes and {residual.frequencies.size} residual ones; those left out"
        f" carry {lost:.1e} of the static flexibility at {', '.join(points) or 'no load'}; displacement there is wrong"
        f" by at most about {swing * lost:.1e} of its elastic part where a force jumps or vibrates below"
        f" {omega[count] / ABOVE:.3g} rad per unit of time"
    )
    return _with_residual(body, count, residual, {n: s[:, count:] for n, s in shapes.items()}, lost), note


def _with_residual(
    body: ModalBody, count: int, residual: Residual, dropped: dict[str, Floats], lost: float
) -> ModalBody:
    """The first modes as they are, and residual ones of unit modal mass; ``dropped`` shapes are of unit modal mass."""
    mass, stiffness, damping = modal_matrices(body)
    omega = np.sqrt(stiffness / mass)
    extra = residual.frequencies
    # damping of the residual modes: that of the modes they stand for, with their weights
    rate = (residual.modes**2 * (damping / mass)[count:, None]).sum(axis=0)
    ratios = np.divide(damping, 2.0 * mass * omega, out=np.zeros_like(omega), where=omega > 0.0)
    return dataclasses.replace(
        body,
        frequencies=np.concatenate([omega[:count], extra]),
        damping_ratios=np.concatenate([ratios[:count], rate / (2.0 * extra)]),
        masses=np.concatenate([mass[:count], np.ones(extra.size)]),
        shapes={
            name: np.hstack([np.asarray(value_of(shape), dtype=float)[:, :count], dropped[name] @ residual.modes])
            for name, shape in body.shapes.items()
        },
        truncation=None,
        residual=extra.size,
        neglected=lost,
    )


def _starts(body: ModalBody, dof: str) -> bool:
    key = dof.partition(".")[2]
    return any(value_of(values.get(key, 0.0)) != 0.0 for values in (body.position, body.velocity))


def highest_frequency(scene: Scene) -> float:
    """Largest angular frequency of ``sin`` and ``cos`` of time in the scene's expressions; 0 where there is none.

    Of a phase that is not linear in time nothing can be said before the run; it counts nothing.
    """
    return max((omega for value in _expressions(scene) for omega in _frequencies(value)), default=0.0)


def _expressions(scene: Scene) -> Iterator[Any]:
    for part in scene.parts:
        for field in dataclasses.fields(part):
            value = getattr(part, field.name)
            inside = value.values() if isinstance(value, Mapping) else value if isinstance(value, tuple) else (value,)
            yield from (entry for entry in inside if is_expression(entry))


def _frequencies(value: Any) -> Iterator[float]:
    import sympy

    from fricmb.values._symbols import TIME

    for wave in value.atoms(sympy.sin, sympy.cos):
        try:
            omega = abs(float(value_of(sympy.diff(wave.args[0], TIME))))
        except TypeError:
            continue
        if np.isfinite(omega):
            yield omega
