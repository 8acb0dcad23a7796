"""A problem of the suite as a small declaration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import fricmb as fm
from fricmb.bench._reference import Reference


@dataclass(frozen=True, kw_only=True)
class SceneCase:
    """A scene with a solution known to round-off.

    Attributes
    ----------
    name, title : str
    build : callable
        Makes the scene (a function of a module: cases go to other processes).
    reference : callable
        Gives the :class:`Reference`; the run ends at its last time.
    steps : tuple of float
        Ladder of steps for integrators with a fixed one; empty: they are left out.
    peers : bool
        Whether solvers of other packages run it, with smoothed friction.
    quick : bool
        Part of ``--quick``.
    source : str
        Where the reference comes from.
    """

    name: str
    title: str
    build: Callable[[], fm.Scene]
    reference: Callable[[], Reference]
    steps: tuple[float, ...] = ()
    peers: bool = True
    quick: bool = False
    source: str = ""

    @property
    def t_end(self) -> float:
        """End of the run."""
        return float(self.reference().t[-1])
