"""The contract of whatever solves a case: fricmb's integrators and the solvers of others alike."""

from __future__ import annotations

from abc import ABC, abstractmethod

from fricmb.bench._case import SceneCase
from fricmb.bench._run import Run, Setting

#: Tolerances of the whole suite, and of the quick one.
LADDER = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
QUICK_LADDER = (1e-4, 1e-6, 1e-8)


class Method(ABC):
    """Base of all adapters.

    Attributes
    ----------
    name : str
        As shown in reports.
    peer : bool
        True for the solvers of other packages.
    """

    name: str
    peer: bool = True

    @abstractmethod
    def settings(self, case: SceneCase, quick: bool) -> list[Setting]:
        """What is tried, from loose to tight."""

    @abstractmethod
    def refuses(self, case: SceneCase) -> str | None:
        """Why the method cannot run the case, or None."""

    @abstractmethod
    def run(self, case: SceneCase, setting: Setting, *, detail: bool) -> Run:
        """Solve the case, on the times of its reference.

        ``detail``: with transitions, forces and energy; without, only what every user of the method would compute: this
        is what is timed.  A run that fails raises.
        """
