"""What one run of one method gives back, whatever the method."""

from __future__ import annotations

from dataclasses import dataclass, field

from fricmb.bench._reference import Floats, Transitions


@dataclass(frozen=True, kw_only=True)
class Setting:
    """How hard a method is asked to try: ``rtol`` or ``step``, and for smoothed friction its width ``eps``.

    ``eps`` is a slip speed over the largest velocity of the problem.
    """

    rtol: float | None = None
    step: float | None = None
    eps: float | None = None

    def __str__(self) -> str:
        parts = (("rtol", self.rtol), ("step", self.step), ("eps", self.eps))
        return ", ".join(f"{name} {value:g}" for name, value in parts if value is not None)


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """A solution on the times of the reference, and what it cost.

    Attributes
    ----------
    q, v : (n, n_t)
    F, g : (m, n_t) or None
        Contact forces and relative velocities, row by row.
    transitions : Transitions or None
    energy : float or None
        Largest residual of the energy balance relative to its largest term.
    counters : dict
        Of n_steps, n_rejected, n_rhs, n_jac, n_lu what the method counts.
    used : str
        The integrator that ran, where the method left the choice to the package.
    seconds : float or None
        Processor time of the solver, where it runs in another process.
    """

    q: Floats
    v: Floats
    F: Floats | None = None
    g: Floats | None = None
    transitions: Transitions | None = None
    energy: float | None = None
    counters: dict[str, int] = field(default_factory=dict)
    used: str = ""
    seconds: float | None = None
