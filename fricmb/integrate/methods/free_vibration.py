"""Free vibration in closed form: a linear structure without contacts, under constant forces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricmb.integrate.csr import is_diagonal
from fricmb.integrate.integrator import Integrator, Tolerance
from fricmb.integrate.problem import Floats, Problem, Start
from fricmb.integrate.trajectory import Counters, Samples, Trajectory, Transitions

#: Most rows that a run without ``t_eval`` is given; they are for pictures: the formula holds at any time.
ROWS = 2000
#: Below this part of the decay or the frequency, formulas that divide by their difference lose digits.
NEAR_CRITICAL = 1e-3


@dataclass(frozen=True, kw_only=True)
class Modes:
    """A structure in the coordinates that separate it: ``u'' + d u' + w2 u = e``, ``q = shapes u``.

    ``shapes`` is (n, n), M-orthonormal, or (n,) where the degrees of freedom separate as they stand.
    """

    w2: Floats
    d: Floats
    e: Floats
    shapes: Floats

    def split(self, M: Floats, q: Floats) -> Floats:
        """Modal values of q (n,) or v."""
        if self.shapes.ndim == 1:
            return q / self.shapes
        return np.asarray(self.shapes.T @ (M @ q))

    def merge(self, u: Floats) -> Floats:
        """Values (n, n_t) on the degrees of freedom."""
        return self.shapes[:, None] * u if self.shapes.ndim == 1 else np.asarray(self.shapes @ u)


def modes_of(problem: Problem) -> Modes | None:
    """The separated structure; None where K is not symmetric or damping not proportional."""
    n, linear = problem.n, problem.linear
    M, K, C, f = linear.M, linear.Kx[:n, :n], linear.Cx[:n, :n], linear.fx[:n]
    if all(is_diagonal(A) for A in (M, K, C)):
        m = np.diagonal(M)
        scale = 1.0 / np.sqrt(m)
        return Modes(w2=np.diagonal(K) / m, d=np.diagonal(C) / m, e=f * scale, shapes=scale)
    size_k, size_c = float(np.abs(K).max(initial=0.0)), float(np.abs(C).max(initial=0.0))
    if np.abs(K - K.T).max() > 1e-14 * size_k or np.abs(C - C.T).max() > 1e-14 * size_c:
        return None
    mixed = K if size_c == 0.0 else K + C * (0.6180339887 * size_k / size_c if size_k else 1.0)
    from scipy.linalg import eigh

    shapes = np.asarray(eigh(0.5 * (mixed + mixed.T), M)[1])
    inertia = 1.0 / np.sum(shapes * shapes, axis=0).max()
    for A, size in ((K, size_k), (C, size_c)):
        reduced = shapes.T @ A @ shapes
        off = reduced - np.diag(np.diagonal(reduced))
        if np.abs(off).max() > 1e-13 * max(size, 1e-300) * n / inertia:
            return None
    w2, d = (np.einsum("ij,ij->j", shapes, A @ shapes) for A in (K, C))
    w2[np.abs(w2) < 1e-14 * np.abs(w2).max(initial=0.0)] = 0.0
    return Modes(w2=w2, d=d, e=shapes.T @ f, shapes=shapes)


def unit_responses(w2: Floats, d: Floats, t: Floats) -> tuple[Floats, Floats, Floats]:
    """S, S' and the integral of S, (b, n_t): S'' + d S' + w2 S = 0, S(0) = 0, S'(0) = 1.

    With the poles -r1, -r2: S is the divided difference of -exp(-r t) over them, and so on.
    """
    S, rate, area = (np.empty((w2.size, t.size)) for _ in range(3))
    a = 0.5 * d
    root = np.sqrt((a * a - w2).astype(complex))
    far = a + root
    near = np.where(np.abs(far) > 0.0, w2 / np.where(far == 0.0, 1.0, far), 0.0)
    free = (w2 == 0.0) & (d == 0.0)
    critical = ~free & (np.abs(root) < NEAR_CRITICAL * np.abs(far))
    S[free], rate[free], area[free] = t, 1.0, 0.5 * t * t
    plain = ~free & ~critical
    r1, r2 = near[plain, None], far[plain, None]
    e1, e2 = np.exp(-r1 * t), np.exp(-r2 * t)
    split = 2.0 * root[plain, None]
    S[plain] = ((e1 - e2) / split).real
    rate[plain] = ((r2 * e2 - r1 * e1) / split).real
    area[plain] = ((_decayed(r1, t) - _decayed(r2, t)) / split).real
    for j in np.flatnonzero(critical):
        A = np.array([[0.0, 1.0, 0.0], [-w2[j], -d[j], 1.0], [0.0, 0.0, 0.0]])
        from scipy.linalg import expm

        found = expm(A * t[:, None, None])
        S[j], rate[j], area[j] = found[:, 0, 1], found[:, 1, 1], found[:, 0, 2]
    return S, rate, area


def _decayed(r: Floats, t: Floats) -> Floats:
    """(1 - exp(-r t))/r, t where r = 0."""
    return np.where(r == 0.0, t, -np.expm1(-r * t) / np.where(r == 0.0, 1.0, r))


class FreeMotion(Trajectory):
    """Closed form of a run; ``lost`` to damping follows from the energy of each mode."""

    def __init__(self, problem: Problem, modes: Modes, start: Start, t_end: float) -> None:
        self.problem = problem
        self._modes = modes
        self._start = start
        M = problem.linear.M
        self._u, self._v = modes.split(M, start.q), modes.split(M, start.v)
        fastest = float(np.sqrt(np.abs(modes.w2)).max(initial=0.0))
        length = t_end - start.t
        self._t = np.linspace(start.t, t_end, int(np.clip(np.ceil(length * fastest), 1, ROWS)) + 1)
        none = np.zeros(0, dtype=np.int64)
        self.transitions = Transitions(t=np.zeros(0), contact=none, kind=none)
        self.counters = Counters(n_steps=1)
        self.failure = None
        last = self.sample(np.array([t_end]))
        self.end = Start(t=t_end, q=last.q[:, 0], v=last.v[:, 0], z=np.zeros(0))

    @property
    def t(self) -> Floats:
        """Times of the rows (n_t,)."""
        return self._t

    def rows(self) -> Samples:
        """Values at the rows."""
        return self.sample(self._t)

    def sample(self, t: Floats) -> Samples:
        """Values at times within the run."""
        modes, n_t = self._modes, t.size
        S, rate, area = unit_responses(modes.w2, modes.d, t - self._start.t)
        w2, d, e, u0, v0 = (x[:, None] for x in (modes.w2, modes.d, modes.e, self._u, self._v))
        u = u0 * (rate + d * S) + v0 * S + e * area
        v = -w2 * u0 * S + v0 * rate + e * S
        lost = 0.5 * (v0 * v0 - v * v) + (0.5 * w2 * (u0 + u) - e) * (u0 - u)
        damped = np.where(d == 0.0, 0.0, lost).sum(axis=0)
        zero = np.zeros((0, n_t))
        return Samples(
            t=t, q=modes.merge(u), v=modes.merge(v), z=zero, F=zero, g=zero, N=zero, mode=np.zeros((0, n_t), np.int8),
            friction_loss=zero, damping_loss=damped, input=np.zeros(n_t),
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Exact(Integrator):
    """The closed form of free vibration: no contacts, no prescribed motion, K symmetric, damping proportional."""

    name: ClassVar[str] = "exact"
    order: ClassVar[str] = "exact"
    takes: ClassVar[frozenset[str]] = frozenset({"linear"})

    def refuses(self, problem: Problem) -> str | None:
        """Why this integrator cannot run the problem, or None."""
        if problem.n_c or problem.n_u or len(problem.elements.table.address):
            return "exact takes linear structures without contacts and prescribed motions"
        if modes_of(problem) is None:
            return "exact takes symmetric stiffness and proportional damping"
        return None

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
        """Run from ``start`` to ``t_end`` (see :class:`Integrator`)."""
        modes = modes_of(problem)
        if modes is None:
            raise ValueError(self.refuses(problem))
        return FreeMotion(problem, modes, start, t_end)
