"""Certified solutions that a benchmark measures against: small data files, or closed forms."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import cast

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Kinds of transition that are compared, by their place in a data file.
KINDS = ("stick", "slip", "reversal")


@dataclass(frozen=True, kw_only=True, eq=False)
class Transitions:
    """Transitions of a run in time order: ``t`` (k,), ``contact`` (k,) its index, ``kind`` (k,) an index of KINDS."""

    t: Floats
    contact: Ints
    kind: Ints

    @classmethod
    def of(cls, rows: list[tuple[float, int, str]]) -> Transitions:
        """From (time, index of the contact, name of the kind)."""
        rows = sorted(rows, key=lambda row: row[0])
        return cls(
            t=np.array([row[0] for row in rows], float),
            contact=np.array([row[1] for row in rows], np.int64),
            kind=np.array([KINDS.index(row[2]) for row in rows], np.int64),
        )

    def __len__(self) -> int:
        return len(self.t)


@dataclass(frozen=True, kw_only=True, eq=False)
class Reference:
    """A solution known to round-off.

    Attributes
    ----------
    t : (n_t,)
        Times at which the state is known.
    q, v : (n, n_t)
        Positions and velocities; NaN where unknown.
    F : (m, n_t) or None
        Contact forces row by row.
    transitions : Transitions or None
    growth : (n_t,)
        How much a relative error in the initial state has grown by then.
    digits : float
        Relative error of the reference itself.
    size : (2, n) or None
        Largest positions and velocities of the whole run, where the grid does not show them.
    """

    t: Floats
    q: Floats
    v: Floats
    F: Floats | None = None
    transitions: Transitions | None = None
    growth: Floats = field(default_factory=lambda: np.ones(1))
    digits: float = 1e-14
    size: Floats | None = None

    @property
    def scales(self) -> tuple[Floats, Floats]:
        """What errors of positions and velocities are divided by (n,), (n,)."""
        if self.size is not None:
            return self.size[0], self.size[1]
        return scale(self.q), scale(self.v)

    def stuck(self, n_contacts: int) -> Bools:
        """Grid points in the middle four fifths of a stick phase, contact by contact (n_contacts, n_t).

        A contact is taken to slip before its first transition unless that is a slip; one without any counts as never
        stuck.
        """
        inside = np.zeros((n_contacts, len(self.t)), dtype=bool)
        if self.transitions is None:
            return inside
        for k in range(n_contacts):
            mine = self.transitions.contact == k
            times, kinds = self.transitions.t[mine], self.transitions.kind[mine]
            since: float | None = float(self.t[0]) if len(kinds) and kinds[0] == 1 else None
            for time, kind in [*zip(times, kinds, strict=True), (float(self.t[-1]), 1)]:
                if since is not None:
                    edge = 0.1 * (time - since)
                    inside[k] |= (self.t > since + edge) & (self.t < time - edge)
                since = float(time) if kind == 0 else None
        return inside


@cache
def shipped(name: str) -> Reference:
    """The reference in the data file of that name; read once, since methods ask for its times in every timed run."""
    path = files("fricmb.bench") / "data" / f"{name}.npz"
    with path.open("rb") as stream, np.load(stream) as data:
        held = dict(data)
    transitions = None
    if "t_event" in held:
        transitions = Transitions(t=held["t_event"], contact=held["contact_event"], kind=held["kind_event"])
    q = held["q"]
    return Reference(
        t=held["t"], q=q, v=held.get("v", np.full_like(q, np.nan)), F=held.get("F"), transitions=transitions,
        growth=np.broadcast_to(held["growth"], held["t"].shape), digits=float(held["digits"]),
    )  # fmt: skip


def scale(signal: Floats) -> Floats:
    """Largest magnitude of each signal (rows), 1 for one that is 0 throughout or unknown."""
    known = np.where(np.isfinite(signal), np.abs(signal), 0.0)
    largest = known.max(axis=1, initial=0.0)
    return cast(Floats, np.where(largest > 0.0, largest, 1.0))
