"""An exact integrator of linear scenes without friction, to test what simulate does around an integrator."""

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np
import pytest
from scipy.linalg import expm

import fricmb as fm
from fricmb.integrate.integrator import Integrator
from fricmb.integrate.problem import Start
from fricmb.integrate.trajectory import Counters, Samples, Trajectory, Transitions


class ExactTrajectory(Trajectory):
    """Matrix exponentials; friction is left out, whatever the contacts."""

    def __init__(self, problem, start, t_end, options):
        self.problem = problem
        self.start = start
        self.options = options
        self.failure = options.failure
        stop = t_end if options.failure is None else 0.5 * (start.t + t_end)
        self._t = np.linspace(start.t, stop, 11)
        none = np.zeros(0, dtype=np.int64)
        self.transitions = Transitions(t=np.zeros(0), contact=none, kind=none)
        self.counters = Counters(n_steps=10, n_rejected=1, n_rhs=20, n_jac=2, n_lu=3, notes=("exact",))
        last = self.sample(np.array([stop]))
        self.end = Start(t=stop, q=last.q[:, 0], v=last.v[:, 0], z=start.z)

    @property
    def t(self):
        return self._t

    def rows(self):
        return self.sample(self._t)

    def sample(self, t):
        p = self.problem
        n, n_t = p.n, t.size
        inverse = np.linalg.inv(p.linear.M)
        A = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ p.linear.Kx[:n, :n], -inverse @ p.linear.Cx[:n, :n]]])
        x0 = np.concatenate((self.start.q, self.start.v))
        x = np.array([expm(A * (time - self.start.t)) @ x0 for time in t]).reshape(n_t, 2 * n).T.copy()
        x[:, t > self.options.not_finite_after] = np.nan
        return Samples(
            t=t, q=x[:n], v=x[n:], z=np.tile(self.start.z[:, None], n_t),
            F=np.zeros((p.m, n_t)), g=np.zeros((p.m, n_t)),
            N=np.zeros((p.n_c, n_t)), mode=np.ones((p.n_c, n_t), dtype=np.int8), friction_loss=np.zeros((p.n_c, n_t)),
            damping_loss=np.zeros(n_t), input=np.zeros(n_t),
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Exact(Integrator):
    """Keeps what it was called with."""

    name: ClassVar[str] = "exact"
    order: ClassVar[str] = "all"
    takes: ClassVar[frozenset[str]] = frozenset({"linear"})

    failure: str | None = None
    not_finite_after: float = np.inf
    calls: list = field(default_factory=list)

    def integrate(self, problem, start, t_end, **given):
        self.calls.append((problem, start, t_end, given))
        if given["progress"] is not None:
            for t in np.linspace(start.t, t_end, 5):
                given["progress"](t)
        return ExactTrajectory(problem, start, t_end, replace(self, calls=[]))


class ExactSteps(Exact):
    """The same with a fixed step."""

    name = "exact-steps"
    adaptive = False


@pytest.fixture
def exact():
    """The integrator class."""
    return Exact


@pytest.fixture
def exact_steps():
    """The class with fixed steps."""
    return ExactSteps


@pytest.fixture
def scene():
    """Two masses and three springs, started with the second one moving."""
    a = fm.Body("a", mass=1.0)
    b = fm.Body("b", mass=2.0, velocity={"x": 1.0})
    return fm.Scene(
        "two masses",
        [
            a,
            b,
            fm.Spring("left", a, axis="x", stiffness=3.0),
            fm.Spring("middle", a, b, axis="x", stiffness=fm.parameter("k", 2.0)),
            fm.Spring("right", b, axis="x", stiffness=1.0),
        ],
    )
