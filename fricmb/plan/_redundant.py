"""Contacts whose forces are not determined one by one while they stick: redundant rows of relative velocity."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from fricmb.plan._plan import Island, short_list
from fricmb.scene import Contact, Scene

#: More contacts in one island than this are not looked at: the search costs their cube.
MANY = 200


def redundant(scene: Scene, islands: Iterable[Island]) -> list[str]:
    """A note for each set of contacts in an island whose relative velocities depend on one another."""
    notes = []
    for island in islands:
        contacts = [part for name in island.parts if isinstance(part := scene[name], Contact)]
        names = _dependent(scene, contacts) if 2 <= len(contacts) <= MANY else ()
        if names:
            notes.append(
                f"contacts {short_list(names)} are redundant: stuck together, only some sums of their forces are"
                " determined, and the forces of least norm are given (beyond a limit of sticking: those that load the"
                " contacts alike)"
            )
    return notes


def _dependent(scene: Scene, contacts: Sequence[Contact]) -> tuple[str, ...]:
    """Names of the contacts that take part in a linear dependence of rows."""
    own = set(scene.dof_names)
    rows = [
        (contact.name, [(name, c) for name, c in scene.expand(direction.form).terms if name in own])
        for contact in contacts
        for direction in contact.directions()
    ]
    rows = [row for row in rows if row[1]]  # across a guide nothing answers: that force is borne, not shared
    column: dict[str, int] = {}
    for _, terms in rows:
        for name, _ in terms:
            column.setdefault(name, len(column))
    W = np.zeros((len(rows), len(column)))
    for i, (_, terms) in enumerate(rows):
        for name, c in terms:
            W[i, column[name]] = c
    size = np.linalg.norm(W, axis=1, keepdims=True)
    U, s, _ = np.linalg.svd(W / np.where(size > 0.0, size, 1.0), full_matrices=True)
    rank = int(np.count_nonzero(s > 1e-10 * s.max(initial=0.0)))
    taking_part = np.abs(U[:, rank:]).max(axis=1, initial=0.0) > 1e-8
    return tuple(dict.fromkeys(name for (name, _), takes in zip(rows, taking_part, strict=True) if takes))
