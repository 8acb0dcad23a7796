"""What implicit one-step methods share: the loop over steps, transitions located within them, rows."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from typing import ClassVar

from fricmb.integrate.formulas.tableau import collocated
from fricmb.integrate.integrator import Integrator, Tolerance
from fricmb.integrate.problem import Floats, Problem, Start
from fricmb.integrate.trajectory import Trajectory


class OneStepMethod(Integrator):
    """An implicit one-step method by its nodes: subclass, name it, and say where it collocates.

    The rest is that of ``radau``: Newton for all stages together, step control from the last Legendre coefficient of a
    step, transitions located within it, dense output, the energy ledger.

    Examples
    --------
    Collocation at thirds:

    >>> from dataclasses import dataclass
    >>> import fricmb as fm
    >>> from fricmb.integrate import OneStepMethod
    >>> @dataclass(frozen=True, kw_only=True)
    ... class Thirds(OneStepMethod):
    ...     name = "thirds"
    ...     order = "3"
    ...
    ...     def nodes(self, problem, rtol):
    ...         return (1 / 3, 2 / 3, 1.0)
    >>> sol = fm.simulate(fm.models.puck_on_belt(), t_end=1.0, rtol=1e-6, method=Thirds())
    >>> sol.stats.method, round(float(sol.events[0].t), 6)  # |V|/(mu g)
    ('thirds', 0.735065)
    """

    takes: ClassVar[frozenset[str]] = frozenset({"linear", "ports", "nonlinear", "constraints"})
    pauses: ClassVar[bool] = True

    @abstractmethod
    def nodes(self, problem: Problem, rtol: float) -> Sequence[float]:
        """Where in a step of length 1 the equations hold: rising in (0, 1], the last node 1 (one to nine of them)."""

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
        """See :class:`Integrator`."""
        # slow to load
        from fricmb.integrate.implicit import run_mechanism

        formula = collocated(tuple(float(c) for c in self.nodes(problem, tolerance.rtol)))
        return run_mechanism(problem, start, t_end, tolerance, formula, progress, memory)
