"""Damping loss and input over long stretches of stick, by doubling.

In stick the motion is that of a linear structure under loads linear in time.  With s = u' of its blocks and a = s',
it is linear in y = (s, a, 1) at any instant before: over a stretch of given length both integrals are quadratic in y.
Two such stretches make one of twice the length: how long a run rests costs as many doublings, not as many periods of
its fastest mode.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.collocation.block_motion import fundamental
from fricmb.integrate.collocation.one_contact.constants import linear_part, loads, structure
from fricmb.integrate.collocation.one_contact.ledger import States, gauss
from fricmb.integrate.compile.kernel import entry
from fricmb.integrate.problem import Floats, Floats3, Ints, Problem

#: Length of the shortest stretch times the fastest rate, and points of Gauss's formula over it: round-off of the whole.
#: What is left of a piece is shorter, and takes as few points.
LENGTH, NODES = 0.5, 8
#: With fewer of the shortest stretches, and fewer a degree of freedom, Gauss's formula over all of them is as fast.
FEW, FEW_BY_DOF = 16_000, 40


@entry
def answers(w2: Floats, d: Floats, t: Floats, out: Floats3) -> None:
    """S, IS, IIS of blocks (see :func:`fundamental`) at some times: out is (n_t, 3, b)."""
    for i in range(t.shape[0]):
        for j in range(w2.shape[0]):
            out[i, 0, j], out[i, 1, j], out[i, 2, j] = fundamental(w2[j], d[j], t[i])


class Motion(NamedTuple):
    """By y at the start of a stretch: y at its end, velocities there, and how far the dofs have moved (n, 2b+1)."""

    y: Floats
    v: Floats
    moved: Floats


@dataclass
class Stretch:
    """The integrals over a stretch, forms in y (2b+1, 2b+1); to ``supply`` comes what forces at its start do."""

    length: float
    motion: Motion
    damping: Floats
    supply: Floats


class HeldLedger:
    """The integrals of a problem with one contact over stretches of stick.

    Parameters
    ----------
    problem : Problem
    stuck : (n_rows,) bool
        Rows of the run in which the contact sticks.
    fastest : float
        Fastest rate of the structure.
    at_once : int
        Times at which states may be asked for together.
    """

    def __init__(self, problem: Problem, stuck: NDArray[np.bool_], fastest: float, at_once: int) -> None:
        self._problem, self._stuck, self._at_once = problem, stuck, at_once
        self._u, self._rate = linear_part(problem)
        self._length = LENGTH / fastest if fastest > 0.0 else np.inf
        shape = self._shape = structure(problem).piece.arrays
        self._loads = loads(problem).piece.arrays
        b = self._b = int(structure(problem).numbers["stuck_blocks"])
        self._w2, self._d = (np.ascontiguousarray(shape[name][1, :b]) for name in ("w2", "damp"))
        self._q_u, self._q_v = shape["q_u"][1, :, :b], shape["q_v"][1, :, :b]
        slope = self._loads["load_1"] - shape["stiff"] @ self._loads["stuck_v"]
        self._e1 = shape["force_0"][1, :b] @ slope
        self._slope = shape["force_1"][1, :b] @ slope + self._d * self._e1
        # power of the contact's force on what it slides on, by forces on the dofs
        self._lift = -((problem.contacts.w + problem.contacts.Wu @ self._rate) @ shape["D_inv"]) @ shape["mw"]

    def advance(self, states: States, row: Ints, begin: Floats, end: Floats, found: Floats) -> Floats:
        """Add the integrals over as much of each piece as whole stretches cover to ``found`` (2, n).

        Returns where the rest begins.
        """
        count = np.where(self._stuck[row], np.floor(np.maximum(end - begin, 0.0) / self._length), 0.0)
        # what grows in stick soon ends it, and may grow beyond what numbers hold in a doubled stretch
        grows = bool((self._w2 < 0.0).any() or (self._d < 0.0).any())
        if grows or count.sum() <= max(FEW, FEW_BY_DOF * self._problem.n):
            return begin
        begin, left = begin.copy(), count.astype(np.int64)
        stretch = self._shortest()
        while True:
            chosen = np.flatnonzero(left & 1)
            for first in range(0, len(chosen), self._at_once):
                part = chosen[first : first + self._at_once]
                found[:, part] += self._over(stretch, *states(row[part], begin[part])[:3])
            begin[chosen] += stretch.length
            left >>= 1
            if not left.any():
                return begin
            stretch = self._doubled(stretch)

    def _over(self, stretch: Stretch, t: Floats, q: Floats, v: Floats) -> Floats:
        """Both integrals (2, n_t) over stretches from the states at ``t`` on."""
        linear, n, rate = self._problem.linear, self._problem.n, self._rate
        u = self._u[:, None] + rate[:, None] * t
        f = self._loads["load_0"][:, None] + self._loads["load_1"][:, None] * t - self._shape["stiff"] @ q
        y = self._begin(v, f)
        K = linear.Kx[:n, :n]
        steady = rate @ (linear.Kx[n:] @ np.vstack([q, u]) - linear.fx[n:, None]) + self._lift @ f
        supply = np.sum(y * (stretch.supply @ y), axis=0) + stretch.length * steady
        supply += np.sum((stretch.motion.moved @ y) * (linear.B @ u - 0.5 * (K - K.T) @ q), axis=0)
        return np.stack([np.sum(y * (stretch.damping @ y), axis=0), supply])

    def _begin(self, v: Floats, f: Floats) -> Floats:
        """Y (2b+1, n_t) of velocities and forces, as at the begin of a phase."""
        shape, b, d = self._shape, self._b, self._d[:, None]
        f = f - (shape["visc"] @ self._loads["stuck_v"])[:, None]
        e0 = shape["force_0"][1, :b] @ f
        s = shape["start_1"][1, :b] @ v + e0
        u = shape["start_0"][1, :b] @ v
        a = shape["force_1"][1, :b] @ f + d * (e0 - s) + self._e1[:, None] - self._w2[:, None] * u
        return np.vstack([s, a, np.ones((1, v.shape[1]))])

    def _motions(self, times: Floats) -> list[Motion]:
        """The motion from the start of a stretch to some times after it."""
        b, w2, d = self._b, self._w2[:, None], self._d[:, None]
        s, a, one = np.split(np.eye(2 * b + 1), [b, 2 * b])
        k = self._slope[:, None] * one - w2 * s
        e1, carried = self._e1[:, None] * one, self._loads["stuck_v"][:, None] * one
        found = np.empty((len(times), 3, b))
        answers(self._w2, self._d, times, found)
        motions = []
        for tau, each in zip(times.tolist(), found, strict=True):
            S, IS, IIS = each[:, :, None]
            speed, rate = s + a * S + k * IS, a - (d * S + w2 * IS) * a + k * S
            v = carried + self._q_u @ speed + self._q_v @ (rate - e1)
            gone, gained = s * tau + a * IS + k * IIS, a * S + k * IS - e1 * tau
            moved = carried * tau + self._q_u @ gone + self._q_v @ gained
            motions.append(Motion(np.vstack([speed, rate, one]), v, moved))
        return motions

    def _shortest(self) -> Stretch:
        """The shortest stretch, by Gauss's formula."""
        linear, n, rate, size = self._problem.linear, self._problem.n, self._rate, 2 * self._b + 1
        x, w = gauss(NODES)
        *inner, whole = self._motions(0.5 * self._length * np.append(x + 1.0, 2.0))
        found = Stretch(self._length, whole, np.zeros((size, size)), np.zeros((size, size)))
        lift = self._lift @ self._shape["visc"]
        for at, share, (_, v, moved) in zip(x.tolist(), w.tolist(), inner, strict=True):
            tau, weight = 0.5 * self._length * (at + 1.0), 0.5 * self._length * share
            speeds = np.vstack([v, np.zeros((len(rate), size))])
            speeds[n:, -1] = rate
            dashpots = linear.Cx @ speeds
            found.damping += weight * (speeds.T @ dashpots)
            found.supply += weight * (v.T @ self._pull(tau, moved))
            found.supply[-1] += weight * (self._push(tau, moved) + rate @ dashpots[n:] - lift @ v)
        return found

    def _pull(self, tau: float, moved: Floats) -> Floats:
        """Forces on the dofs (n, 2b+1) that do work, less those at the start of the stretch."""
        n, linear = self._problem.n, self._problem.linear
        K = linear.Kx[:n, :n]
        pull: Floats = -0.5 * (K - K.T) @ moved
        pull[:, -1] += linear.B @ self._rate * tau
        return pull

    def _push(self, tau: float, moved: Floats) -> Floats:
        """Power (2b+1,) of what is driven against springs and the contact, less that at the start of the stretch."""
        n, linear, rate = self._problem.n, self._problem.linear, self._rate
        push: Floats = (rate @ linear.Kx[n:, :n] - self._lift @ self._shape["stiff"]) @ moved
        push[-1] += (rate @ linear.Kx[n:, n:] @ rate + self._lift @ self._loads["load_1"]) * tau
        return push

    def _doubled(self, half: Stretch) -> Stretch:
        """The stretch of twice the length: the second half begins where the first ends."""
        h, (y, _, moved) = half.length, half.motion
        supply = half.supply + y.T @ half.supply @ y + (moved @ y).T @ self._pull(h, moved)
        supply[-1] += h * self._push(h, moved)
        (motion,) = self._motions(np.array([2.0 * h]))
        return Stretch(2.0 * h, motion, half.damping + y.T @ half.damping @ y, supply)
