"""A run in closed form: a unit mass on a unit spring with dry friction 0.1, from x = 0.95 at rest."""

import numpy as np
import pytest

from fricmb.integrate.problem import Contacts, Elements, Linear, Problem, Signals, Start
from fricmb.integrate.trajectory import Counters, Samples, Trajectory, Transitions
from fricmb.solution import Motion, Names, Origin, Piece, Run, Solution, Stats, builder

X0, FRICTION = 0.95, 0.1
#: Half cycles until it rests at (-1)^k (X0 - 0.2 k) with |x| <= 0.1.
HALVES = 5


def problem():
    none = np.zeros((1, 0))
    linear = Linear(M=np.eye(1), Kx=np.eye(1), Cx=np.zeros((1, 1)), fx=np.zeros(1), B=none)
    contacts = Contacts(W=np.eye(1), w=np.zeros(1), Wu=none, Wn=np.zeros((1, 1)), row=np.array([0, 1]))
    return Problem(linear=linear, signals=Signals(), contacts=contacts, elements=Elements())


class Oscillator(Trajectory):
    """The free friction oscillator between two times of its motion."""

    def __init__(self, t_start=0.0, t_end=20.0, rows=41):
        self.problem = problem()
        self.span = t_start, t_end
        ends = np.pi * np.arange(1, HALVES + 1)
        inside = ends[(ends > t_start) & (ends <= t_end)]
        self._t = np.sort(np.concatenate((np.linspace(t_start, t_end, rows), inside, inside)))
        kinds = np.where(inside == ends[-1], 0, 4)
        self.transitions = Transitions(t=inside, contact=np.zeros(inside.size, dtype=np.int64), kind=kinds)
        self.counters = Counters(n_steps=rows)
        self.failure = None
        last = self.sample(np.array([t_end]))
        self.end = Start(t=t_end, q=last.q[:, 0], v=last.v[:, 0], z=np.zeros(0), mode=last.mode[:, 0])

    @property
    def t(self):
        return self._t

    def rows(self):
        samples = self.sample(self._t)
        twice = np.flatnonzero(np.diff(self._t) == 0)
        samples.mode[0, twice] = 1
        return samples

    def path(self, t):
        half = np.minimum(np.floor(t / np.pi), HALVES)
        return half, np.where(half < HALVES, X0 - 0.2 * half - FRICTION, 0.0)

    def sample(self, t):
        assert self.problem is not None
        half, amplitude = self.path(t)
        sign = (-1.0) ** half
        phase = t - np.pi * half
        slip = half < HALVES
        rest = (-1.0) ** HALVES * (X0 - 0.2 * HALVES)
        x = np.where(slip, sign * (FRICTION + amplitude * np.cos(phase)), rest)
        v = np.where(slip, -sign * amplitude * np.sin(phase), 0.0)
        force = np.where(slip, FRICTION * sign, rest)
        way = sum(2 * (X0 - 0.2 * k - FRICTION) * (half > k) for k in range(HALVES)) + amplitude * (1 - np.cos(phase))
        lost = FRICTION * way
        if t.size and self.span[0] > 0 and not hasattr(self, "_lost"):
            self._lost = 0.0
            self._lost = float(self.sample(np.array([self.span[0]])).friction_loss[0, 0])
        nothing = np.zeros(t.size)
        return Samples(
            t=t, q=x[None], v=v[None], z=np.zeros((0, t.size)), F=force[None], g=v[None], N=np.full((1, t.size), 0.1),
            mode=np.where(slip, 1, 0).astype(np.int8)[None], friction_loss=(lost - getattr(self, "_lost", 0.0))[None],
            damping_loss=nothing, input=nothing,
        )  # fmt: skip


class Mechanics:
    """Energies of the oscillator, and a driven base that moves at 0.1."""

    def __init__(self, stiffness=1.0):
        self.problem = problem()
        self.stiffness = stiffness

    def attach(self, trajectory):
        trajectory.attach(self.problem)

    def freedom(self, samples):
        return None

    def fastest(self):
        return 1.0

    def smooth(self):
        return np.array([False])

    def leaps(self, t_start, t_end):
        return None

    def kinetic(self, samples, moving=None):
        return 0.5 * samples.v[0] ** 2

    def delivered(self, samples):
        return None

    def rubbed(self, samples):
        return None

    def potential(self, samples, moving=None):
        return 0.5 * self.stiffness * samples.q[0] ** 2

    def signals(self, t):
        return 0.1 * t[None], np.full((1, t.size), 0.1)


@builder("test", str)
def build(scene, **options):
    return Mechanics(**options)


NAMES = Names(
    dofs=("mass.x",),
    contacts=("floor",),
    directions=(("x",),),
    states=((),),
    motions={"mass.tip.x": Motion(index=np.array([0]), coefficient=np.array([2.0]))},
    signals={"base.x": 0},
)


def solution(t_start=0.0, t_end=20.0, times=None, stiffness=1.0, trajectory=None):
    origin = Origin(scene="a scene", build=build, options={"stiffness": stiffness})
    run = Run((Piece(trajectory or Oscillator(t_start, t_end), origin),))
    return Solution(names=NAMES, run=run, stats=Stats(method="closed form", n_steps=41, wall_s=0.5), times=times)


@pytest.fixture
def make():
    """Make a solution of the oscillator."""
    return solution


@pytest.fixture
def sol():
    """The oscillator from 0 to 20, at its rows."""
    return solution()


@pytest.fixture
def oscillator():
    """The trajectory class."""
    return Oscillator
