"""How a run was made, and what it cost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


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
        What a careful reader of the result should know.
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
    notes: tuple[str, ...] = ()
    islands: tuple[IslandStats, ...] = ()
    rtol: float | None = None
    atol: tuple[float, ...] | None = None

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
