"""The contract of an integrator: a frozen dataclass whose fields are its options."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

from fricmb.integrate.problem import Floats, Problem, Start
from fricmb.integrate.trajectory import Trajectory


@dataclass(frozen=True, kw_only=True)
class Tolerance:
    """How accurate a run has to be.

    ``rtol`` is relative to each signal's running maximum; ``atol_q``, ``atol_v`` (n,) are floors of these scales times
    rtol, or None (chosen from rtol and the scales found in the run).  No step is longer than ``max_step``.
    """

    rtol: float
    atol_q: Floats | None = None
    atol_v: Floats | None = None
    max_step: float = math.inf


class Integrator(ABC):
    """Base of all integrators.  Subclass, give the facts as class attributes, implement :meth:`integrate`.

    Attributes
    ----------
    name : str
        As given to ``simulate(method=...)``.
    adaptive : bool
        False: needs a fixed ``step``.
    order : str
        For people ("1 to 5", "9").
    takes : frozenset of str
        Parts of a problem it can run: of "linear", "ports", "nonlinear", "constraints".
    pauses : bool
        Whether a run returns early where ``memory`` is used up, so that long runs need no more.
    two_limits : bool
        Whether it runs contacts whose limit of friction at rest differs by the sense (``Contacts.lean``).
    """

    name: ClassVar[str]
    adaptive: ClassVar[bool] = True
    order: ClassVar[str]
    takes: ClassVar[frozenset[str]]
    pauses: ClassVar[bool] = False
    two_limits: ClassVar[bool] = False

    def refuses(self, problem: Problem) -> str | None:
        """Why this integrator cannot run the problem, or None."""
        if "constraints" not in self.takes and problem.mechanism is not None:
            return f"{self.name} does not take bodies that turn and joints; 'radau' and 'bdf' do"
        if "nonlinear" not in self.takes and len(problem.elements.table.address):
            return f"{self.name} takes linear structures with contacts; this scene has nonlinear elements"
        if problem.contacts.lean.any() and not self.two_limits:
            name = self.name
            return f"{name} has one limit of friction at rest, and here it differs by the sense; take 'radau' or 'bdf'"
        return None

    @abstractmethod
    def integrate(
        self,
        problem: Problem,
        start: Start,
        t_end: float,
        *,
        tolerance: Tolerance,
        step: float | None = None,
        t_eval: Floats | None = None,
        progress: Callable[[float], None] | None = None,
        memory: float | None = None,
    ) -> Trajectory:
        """Run from ``start`` to ``t_end``.

        ``t_eval``: the times that will be asked for, if known (an integrator may keep these alone).
        ``memory``: bytes of rows after which the run returns before ``t_end``, to go on from its ``end`` (given only to
        an integrator that ``pauses``).
        ``progress(t)`` is called now and then.  A run that cannot go on returns what it has, with ``failure`` set;
        non-finite numbers are never returned.
        """
