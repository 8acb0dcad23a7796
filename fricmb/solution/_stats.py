"""How a run was made, and what it cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any


@dataclass(frozen=True, kw_only=True)
class IslandStats:
    """Work on one island: its degrees of freedom, who ran it, accepted and rejected steps, factorisations."""

    dofs: tuple[str, ...]
    method: str
    n_steps: int
    n_rejected: int
    n_lu: int


@dataclass(frozen=True, kw_only=True)
class Stats:
    """Counters of a run.

    Attributes
    ----------
    method, why : str
        Name of the integrator, and why it was taken.
    n_steps, n_rejected, n_rhs, n_jac, n_lu : int
        Accepted and rejected steps, right-hand sides, Jacobians, factorisations.
    compile_s, wall_s : float
        Seconds spent compiling kernels or loading compiled ones from the disk, and seconds altogether (which include
        the former).
    notes : tuple of str
        What a careful reader of the result should know.  Looked for when they are first read; until then the counters
        of a solution hold on to it.
    islands : tuple of IslandStats
        Where islands were run on their own: each of those that were.
    rtol : float or None
        The tolerance that the run was asked for; None: fixed steps.
    atol : tuple of float or None
        Errors that never matter, if any were given: of positions, then of velocities (one of each where all are alike).
    """

    method: str
    why: str = ""
    n_steps: int = 0
    n_rejected: int = 0
    n_rhs: int = 0
    n_jac: int = 0
    n_lu: int = 0
    compile_s: float = 0.0
    wall_s: float = 0.0
    # (of no default, so that __getattr__ is asked for those that have not been looked for)
    notes: tuple[str, ...] = field(default_factory=tuple)
    islands: tuple[IslandStats, ...] = ()
    rtol: float | None = None
    atol: tuple[float, ...] | None = None

    def until_read(self, find: Callable[[], tuple[str, ...]]) -> Stats:
        """The same, whose notes are what ``find()`` returns when they are first read."""
        known = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "notes"}
        later = Stats(**known)
        del later.__dict__["notes"]
        later.__dict__["_find"] = find
        return later

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            find = self.__dict__.get("_find") if name == "notes" else None
            if find is None:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            self.__dict__["notes"] = notes = find()
            del self.__dict__["_find"]
            return notes

        def __getstate__(self) -> dict[str, Any]:
            return {f.name: getattr(self, f.name) for f in fields(self)}

    @classmethod
    def total(cls, parts: list[Stats]) -> Stats:
        """Sum over runs that follow each other."""
        counts = ("n_steps", "n_rejected", "n_rhs", "n_jac", "n_lu", "compile_s", "wall_s")
        tolerances: list[Any] = [part.rtol for part in parts]
        return cls(
            method=", ".join(dict.fromkeys(part.method for part in parts)),
            why="; ".join(dict.fromkeys(part.why for part in parts if part.why)),
            islands=parts[-1].islands,
            rtol=max(tolerances) if None not in tolerances else None,
            atol=parts[-1].atol,
            notes=tuple(dict.fromkeys(note for part in parts for note in part.notes)),
            **{name: sum(getattr(part, name) for part in parts) for name in counts},
        )
