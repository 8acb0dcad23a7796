"""A scene with smoothed friction as an ordinary differential equation: what one solves without set-valued friction.

Friction along g, the relative velocity, of a law with constant mu_s and mu_k has a peak of height mu_s at r = 10 e (the
form of Simscape's translational friction block), and none where mu_s = mu_k:

    F = -N ( mu_k tanh(r/e) + (mu_s - mu_k) sqrt(2 exp 1) exp(-(r/s)^2) r/s ) g/r,   s = 10 sqrt(2) e

and of a coefficient mu(r): F = -N mu(r) tanh(r/e) g/r.  A law with states is smooth already.  The right-hand side and
its Jacobian are compiled; arguments come in two flat arrays, which is the cheapest call from Python.  State order:
q_1, v_1, q_2, v_2, ..., then law states: a chain has a narrow band.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, hstack

import fricmb as fm
from fricmb.bench._kernels import N_FIXED, jacobian, relative, right_hand_side
from fricmb.bench._reference import Floats, Ints
from fricmb.integrate import Problem
from fricmb.system import build

#: Slip speeds below this many eps count as stick where a smoothed run is asked for its transitions.
STUCK = 10.0


@dataclass(frozen=True, kw_only=True, eq=False)
class SmoothScene:
    """The compiled equations of a smoothed scene: ``rhs(t, y)``, ``jac(t, y)``, and what goes in and comes out.

    Attributes
    ----------
    n, m, n_z : int
        Numbers of dofs, contact rows, law states.
    floats, ints : arrays
        Arguments of the kernels.
    band : int
        Half-width of the Jacobian's band.
    rows : (n_c+1,)
        Contact k owns the rows ``rows[k]:rows[k+1]``.
    start : (2 n + n_z,)
    eps : float
        Slip speed of the smoothing.
    keep : Scene
        Holds what the addresses of compiled laws point to.
    """

    n: int
    m: int
    n_z: int
    floats: Floats
    ints: Ints
    band: int
    rows: Ints
    start: Floats
    eps: float
    keep: fm.Scene

    def rhs(self, t: float, y: Floats) -> Floats:
        """The derivative of y."""
        out = np.empty(len(y))
        right_hand_side(t, y, out, self.floats, self.ints)
        return out

    def jac(self, t: float, y: Floats) -> Floats:
        """Its Jacobian (dense)."""
        out = np.zeros((len(y), len(y)))
        jacobian(t, y, out, self.floats, self.ints)
        return out

    def split(self, y: Floats) -> tuple[Floats, Floats]:
        """Positions and velocities out of states (N, n_t)."""
        return y[0 : 2 * self.n : 2], y[1 : 2 * self.n : 2]

    def contacts(self, t: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Relative velocities and forces (m, n_t)."""
        g, F = np.empty((self.m, len(t))), np.empty((self.m, len(t)))
        for i in range(len(t)):
            relative(t[i], np.ascontiguousarray(y[:, i]), g[:, i], F[:, i], self.floats, self.ints)
        return g, F


def refuses(problem: Problem) -> str | None:
    """Why a scene cannot be smoothed here, or None."""
    if len(problem.elements.table.address):
        return "the smoothed scene has no nonlinear elements"
    if (problem.contacts.normal != 0).any():
        return "the smoothed scene has constant normal forces alone"
    if len(problem.signals.breakpoints):
        return "the smoothed scene has no jumps in its inputs"
    return None


def smooth(scene: fm.Scene, eps: float, t_end: float) -> SmoothScene:
    """The smoothed equations of a scene; ``eps``: slip speed of the smoothing."""
    system = build(scene)
    problem = system.problem_for(0.0, t_end)
    n, m, n_z, n_u = problem.n, problem.m, problem.n_z, problem.n_u
    linear, contacts = problem.linear, problem.contacts
    inverse = np.linalg.inv(linear.M) if n else np.zeros((0, 0))
    blocks = [-linear.Kx[:n, :n], -linear.Cx[:n, :n], linear.B - linear.Kx[:n, n:], -linear.Cx[:n, n:]]
    operator = csr_array(hstack([csr_array(inverse @ block) for block in blocks]))
    operator.eliminate_zeros()
    ports = csr_array(inverse @ contacts.W)
    rows = csr_array(contacts.W.T)
    driven = csr_array(contacts.Wu)
    law, signal = contacts.law_table, problem.signals.table
    ints, floats = _Packer(), _Packer()
    for table in (operator, ports, rows, driven):
        ints.add(table.indptr)
        ints.add(table.indices)
        floats.add(table.data)
    laws = (contacts.law, contacts.z_start, law.address, law.p_start)
    for numbers in (contacts.row, *laws, signal.address, signal.p_start):
        ints.add(numbers)
    for values in (inverse @ linear.fx[:n], contacts.w, contacts.mu_s, contacts.mu_0, contacts.N, law.p, signal.p):
        floats.add(values)
    header = np.array([n, m, n_z, n_u, problem.n_c, 0], dtype=np.int64)
    packed_ints, packed_floats = ints.packed(header, floats), floats.flat(np.array([eps]))
    y0 = np.empty(2 * n + n_z)
    y0[0 : 2 * n : 2], y0[1 : 2 * n : 2], y0[2 * n :] = system.start.q, system.start.v, system.start.z
    return SmoothScene(
        n=n, m=m, n_z=n_z, floats=packed_floats, ints=packed_ints, band=_band(operator, problem, ports),
        rows=contacts.row, start=y0, eps=eps, keep=scene,
    )  # fmt: skip


class _Packer:
    """Arrays one behind the other, and where each starts."""

    def __init__(self) -> None:
        self._arrays: list[np.ndarray] = []

    def add(self, array: np.ndarray) -> None:
        self._arrays.append(np.asarray(array).ravel())

    def starts(self, first: int) -> list[int]:
        """Places of the arrays where the first stands at ``first``."""
        sizes = [len(array) for array in self._arrays]
        return [first + sum(sizes[:i]) for i in range(len(sizes))]

    def flat(self, header: np.ndarray) -> Floats:
        """The header, then the arrays, as floats."""
        return np.concatenate([header, *self._arrays]).astype(np.float64)

    def packed(self, header: Ints, floats: _Packer) -> Ints:
        """Sizes, places in the ints, places in the floats (which have a header of 1), then the arrays."""
        first = N_FIXED
        places = [*self.starts(first), *floats.starts(1)]
        head = np.concatenate([header, np.array(places, dtype=np.int64)])
        if len(head) != N_FIXED:
            raise AssertionError(f"the header has {len(head)} places, not {N_FIXED}")
        return np.concatenate([head, *self._arrays]).astype(np.int64)


def _band(operator: csr_array, problem: Problem, ports: csr_array) -> int:
    """Half-width of the Jacobian's band; the rows of one contact depend on each other."""
    n, contacts = problem.n, problem.contacts
    if problem.n_z:
        return 2 * n + problem.n_z - 1
    owner = contacts.of_row
    together = csr_array((owner[:, None] == owner).astype(float))
    pattern = abs(operator[:, :n]) + abs(operator[:, n : 2 * n]) + abs(ports) @ together @ abs(csr_array(contacts.W.T))
    i, j = pattern.nonzero()
    return int(2 * np.abs(i - j).max(initial=0) + 1)
