"""A branch of cycles over one parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fricmb._facade import facade
from fricmb.analysis._errors import Floats
from fricmb.analysis.cycles._cycle import Cycle
from fricmb.analysis.cycles._specials import Special

if TYPE_CHECKING:
    from fricmb.plot._branches import BranchPlots


@dataclass(frozen=True, kw_only=True)
class Branch:
    """Cycles over one parameter, stable and unstable, in the order in which they were found.

    Attributes
    ----------
    over : str
    to : float
        Value of the parameter at which it was to end.
    cycles : tuple of Cycle
    special : tuple of Special
        In the same order; each also stands in ``places`` with the number of cycles before it.
    places : tuple of int
    ended : str
        Why it ended where it does.
    """

    over: str
    to: float
    cycles: tuple[Cycle, ...]
    special: tuple[Special, ...]
    places: tuple[int, ...]
    ended: str

    @property
    def values(self) -> Floats:
        """Values (n,) of the parameter."""
        return np.array([float(cycle.scene.parameters[self.over]) for cycle in self.cycles])

    @property
    def periods(self) -> Floats:
        """Periods (n,)."""
        return np.array([cycle.period for cycle in self.cycles])

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Which cycles are stable (n,)."""
        return np.array([cycle.stable for cycle in self.cycles])

    def amplitude(self, name: str) -> Floats:
        """Amplitudes (n,) of a degree of freedom or point."""
        return np.array([cycle.amplitude(name) for cycle in self.cycles])

    def switch(self, special: Special, *, to: float | None = None, points: int = 200, progress: bool = True) -> Branch:
        """The branch of cycles of twice the period that begins at a flip.

        Parameters
        ----------
        special : Flip
            Of this branch.
        to : float, optional
            Value of the parameter at which to end; default: that of this branch.
        points : int
            Largest number of cycles.
        progress : bool

        Raises
        ------
        AnalysisError
            For a point at which no other branch of cycles begins.
        """
        from fricmb.analysis.cycles._switch import switched

        return switched(self, special, self.to if to is None else to, points, progress)

    @property
    @facade
    def plot(self) -> BranchPlots:
        """Pictures: ``branch.plot.diagram()``, ``branch.plot.multipliers()``."""
    def __str__(self) -> str:
        values = self.values
        lines = [f"{len(self.cycles)} cycles over {self.over} = {values[0]:g} to {values[-1]:g}, {self.ended}"]
        return "\n".join(lines + [f"  {special}" for special in self.special])
