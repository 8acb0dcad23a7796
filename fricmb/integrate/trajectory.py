"""What an integrator returns: rows of accepted steps, transitions, dense output, counters."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from fricmb.integrate.problem import Codes, Floats, Ints, Problem, Start


@dataclass(frozen=True, kw_only=True)
class MotionSamples:
    """Motion and forces at given times; time is the last axis.

    ``q``, ``v`` (n, n_t), ``z`` (n_z, n_t), ``F`` and ``g`` (m, n_t) force on the contact's first end and relative
    velocity, ``N`` (n_c, n_t), ``mode`` (n_c, n_t) int8.
    """

    t: Floats
    q: Floats
    v: Floats
    z: Floats
    F: Floats
    g: Floats
    N: Floats
    mode: Codes

    def numbers(self, moving: Ints | None) -> list[Any]:
        """All arrays of numbers; of degrees of freedom those that move (None: all)."""
        found = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "mode"}
        if moving is not None:
            found |= {name: found[name][moving] for name in ("q", "v")}
        return list(found.values())

    def with_energies(self, *, friction_loss: Floats, damping_loss: Floats, input: Floats) -> Samples:
        """The same motion, kept once, with energies."""
        motion = {f.name: getattr(self, f.name) for f in fields(MotionSamples)}
        return Samples(**motion, friction_loss=friction_loss, damping_loss=damping_loss, input=input)


@dataclass(frozen=True, kw_only=True)
class Samples(MotionSamples):
    """Everything a run knows at given times: motion, forces, and energies cumulated from the start of the run.

    ``friction_loss`` (n_c, n_t), ``damping_loss`` and ``input`` (n_t,).
    """

    friction_loss: Floats
    damping_loss: Floats
    input: Floats


#: What is kept of an impact: time; number among contacts and joints; kind; impulses along the normal and along slip;
#: speed of approach; energy lost; of "rest" the time that further bounces would have taken and the bound of its error;
#: how many others were hit at the same instant; side of a part with two ends.
IMPACT_COLUMNS = (
    "t", "contact", "kind", "normal", "tangential", "approach", "loss", "left", "bound", "others", "side",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Transitions:
    """Transitions in time order: ``t`` (n_e,), ``contact`` (n_e,) index, ``kind`` (n_e,) index into EVENT_KINDS.

    ``contact`` counts on behind the contacts with the joints of a mechanism.  ``impacts`` (n_i, 11): of every event of
    kind "impact" or "rest", in order, the columns :data:`IMPACT_COLUMNS`.
    """

    t: Floats
    contact: Ints
    kind: Ints
    impacts: Floats = field(default_factory=lambda: np.zeros((0, len(IMPACT_COLUMNS))))


@dataclass(frozen=True, kw_only=True)
class Counters:
    """Work done: accepted and rejected steps, right-hand sides, Jacobians, factorisations; compile and wall seconds.

    ``notes`` are sentences for the user (an outcome that hangs on round-off, an order that was held back).
    """

    n_steps: int = 0
    n_rejected: int = 0
    n_rhs: int = 0
    n_jac: int = 0
    n_lu: int = 0
    notes: tuple[str, ...] = field(default=())


class Trajectory(ABC):
    """A run: rows of accepted steps (a transition's time twice, before and after) and everything in between.

    Attributes
    ----------
    problem : Problem
    transitions : Transitions
    counters : Counters
    end : Start
        From which a further run goes on.
    failure : str or None
        Why the run stopped before its end, with the condition that failed.
    instead : (name, why) or None
        Who did the run in place of the integrator that was asked, which could not finish it.
    of_scene : bool
        Whether the failure is one of the scene, at which every method stops.
    """

    problem: Problem
    transitions: Transitions
    counters: Counters
    end: Start
    failure: str | None
    #: Degrees of freedom that move; None: all may.  The others keep their position, which is finite.
    moving: Ints | None = None
    instead: tuple[str, str] | None = None
    of_scene: bool = False

    def __init__(
        self, problem: Problem, transitions: Transitions, counters: Counters, end: Start, failure: str | None
    ) -> None:  # fmt: skip
        self.problem = problem
        self.transitions = transitions
        self.counters = counters
        self.end = end
        self.failure = failure

    @property
    @abstractmethod
    def t(self) -> Floats:
        """Times of the rows (n_t,): non-decreasing, the first and last the ends of the run."""

    @property
    def ends(self) -> tuple[float, float]:
        """Ends of the run."""
        return float(self.t[0]), float(self.t[-1])

    @property
    def breakpoints(self) -> Floats:
        """Times at which inputs jump or bend."""
        return self.problem.signals.breakpoints

    @abstractmethod
    def rows(self) -> Samples:
        """Values at the rows; at a transition first the left, then the right-hand values."""

    @abstractmethod
    def sample(self, t: Floats) -> Samples:
        """Values at times within the run, in any order; the right-hand value at a transition."""

    def motion(self, t: Floats) -> MotionSamples:
        """As :meth:`sample`; a run whose energies cost something leaves them out."""
        return self.sample(t)

    def row_motion(self) -> MotionSamples:
        """As :meth:`rows`; a run whose energies cost something leaves them out."""
        return self.rows()

    def attach(self, problem: Problem) -> None:
        """Take the problem again after unpickling.

        A problem holds addresses that are valid in one process alone, so a trajectory pickles without it (a subclass
        that keeps something else of the kind extends both methods).  Until it is attached, :meth:`rows` and
        :meth:`sample` may not be called.
        """
        object.__setattr__(self, "problem", problem)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name != "problem"}


class SampledTrajectory(Trajectory):
    """A run that is kept as samples; what lies between them is for subclasses to say."""

    def __init__(
        self, problem: Problem, samples: Samples, transitions: Transitions, counters: Counters, end: Start,
        failure: str | None,
    ) -> None:  # fmt: skip
        super().__init__(problem, transitions, counters, end, failure)
        self._samples = samples

    @property
    def t(self) -> Floats:
        """Times of the samples."""
        return self._samples.t

    def rows(self) -> Samples:
        """The samples."""
        return self._samples
