"""Rigid surfaces at an instant: which are open, distances and their rates, which are touched."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.compile.direct import Direct
from fricmb.integrate.implicit.impacts.impact_rows import gap_accelerations, impact_rows
from fricmb.integrate.implicit.scene.structure import mechanism_of
from fricmb.integrate.mechanism import APART, RIGID, loads_of
from fricmb.integrate.problem import OPEN, Floats, Ints, Problem
from fricmb.integrate.run.breakpoints import EPS

#: Times to contact that are the same, in roundings of the time and parts of the span.
SAME, SHORTEST = 64.0 * EPS, 1e-13
#: Times of a run at which prescribed motions are looked at for their size.
SEEN = 33
#: Speed that is none, and acceleration, beside what velocities so far and accelerations now could bring.
STILL, SLIGHT = 1e-12, 1e-9

_rows, _accelerations = Direct(impact_rows), Direct(gap_accelerations)


class Surfaces:
    """Rigid joints of a run, looked at at its present state (``look`` anew where positions have changed).

    Attributes
    ----------
    G, G0 : (m, n), (m,)
        Rates of constraints are ``G v + G0``, those of open joints as well.
    W, W0 : (m_p, n), (m_p,)
        Slip velocities are ``W v + W0``.
    gap, noise : (n_j,)
        Distances and their round-off.
    first : (n_j,) int64
        Row of each joint.
    rigid : (n_j,) bool
    """

    def __init__(self, problem: Problem, mech: Any, workspace: Any) -> None:
        self.problem, self.mechanism = problem, mechanism_of(problem)
        self.joints = self.mechanism.joints
        self.rigid = self.joints.hands_over == RIGID
        self.first: Ints = np.minimum(self.joints.row[:-1], max(self.mechanism.n_rows - 1, 0))
        self._mech, self._workspace = mech, workspace

    def look(self) -> None:
        """Rows and distances at the present positions."""
        n, m, m_p, n_j = self.problem.n, self.mechanism.n_rows, self.problem.m, len(self.joints.port)
        self.G, self.G0, self.W, self.W0 = np.zeros((m, n)), np.zeros(m), np.zeros((m_p, n)), np.zeros(m_p)
        self.gap, self.noise = np.zeros(n_j), np.zeros(n_j)
        _rows(
            self._mech, self._workspace.k, self._workspace.y, np.zeros(n), self.G, self.G0, self.W, self.W0, self.gap,
            self.noise, np.zeros(m), np.zeros(m_p),
        )  # fmt: skip
        self.noise = np.maximum(self.noise, self._workspace.out.least)

    def see_signals(self) -> None:
        """Round-off of distances over the whole run, as far as prescribed motions make it: they may start at 0."""
        y, span, least = self._workspace.y, self._workspace.control.span, self._workspace.out.least
        least[:] = 0.0
        start = float(y.t)
        for t in np.linspace(span[0], span[1], SEEN) if self.problem.n_u else ():
            y.t = float(t)
            self.look()
            least[:] = np.maximum(least, self.noise)
        y.t = start

    @property
    def open(self) -> Any:
        """Joints that are open (n_j,)."""
        return (self.joints.hands_over != 0) & (self.joints.dropped[self.first] == APART)

    @property
    def held(self) -> Any:
        """Rigid joints that are held (n_j,)."""
        return self.rigid & ~self.open

    def rates(self, v: Floats) -> Floats:
        """Rates of distances (n_j,)."""
        found: Floats = (self.G @ v + self.G0)[self.first]
        return found

    def reach(self) -> Floats:
        """Rates of distances (n_j,) that velocities so far could bring."""
        found: Floats = np.abs(self.G[self.first]) @ self._workspace.control.v + np.abs(self.G0[self.first])
        return found

    def still(self) -> Floats:
        """Rates of distances (n_j,) that are none."""
        return STILL * self.reach()

    def touched(self, rate: Floats) -> Any:
        """Open joints (n_j,) that are hit now, or touch: at the same time by the time to contact, not the distance.

        What comes soonest is hit as well, if its time is within the step, or nothing touches.
        """
        opened = self.open
        span, h = self._workspace.control.span, float(self._workspace.control.h)
        same = SAME * abs(float(self._workspace.y.t)) + SHORTEST * float(span[1] - span[0])
        near = 10.0 * self.noise + same * np.abs(rate)
        found = opened & (self.gap <= near)
        comes = np.flatnonzero(opened & (rate < 0.0))
        if comes.size:
            left = self.gap[comes] / -rate[comes]
            soonest = int(np.argmin(left))
            if left[soonest] <= h or not found.any():
                found[comes[soonest]] = True
        return found

    def pressed(self) -> Floats:
        """Accelerations (n_j,) towards the surfaces, with those of the present state."""
        found = np.zeros(len(self.first))
        _accelerations(self._mech, self._workspace.k, self._workspace.y, found)
        return -found

    def pace(self) -> Floats:
        """Accelerations (n_j,) that those of the present state could bring about."""
        found: Floats = np.abs(self.G[self.first]) @ np.abs(self._workspace.y.a)
        return found

    def falling(self, members: Ints, rate: Floats) -> Ints:
        """Open members that are at rest on their surface and would fall into it, the worst first."""
        found = self.open & (self.gap <= 10.0 * self.noise)
        found &= np.abs(rate) <= self.still()
        if not found[members].any():  # accelerations need a call of compiled code
            return np.zeros(0, np.int64)
        pressed = self.pressed()
        found &= pressed > SLIGHT * self.pace()
        mine = members[found[members]]
        return np.asarray(mine[np.argsort(-pressed[mine])], dtype=np.int64)

    def pressed_ports(self, joint: int) -> Ints:
        """Ports whose load is the reaction of a joint: its own, and that of resistance against rolling on it."""
        ports = self.joints.port[loads_of(self.joints) == joint]
        return np.asarray(ports[ports >= 0], dtype=np.int64)

    def set_open(self, joint: int, apart: bool) -> None:
        """Mark a joint as open, its reaction and all friction that it loads 0; or as held."""
        y, row = self._workspace.y, self.problem.contacts.row
        self.joints.dropped[self.first[joint]] = APART if apart else 0
        if apart:
            y.lam[self.first[joint]] = 0.0
            for c in self.pressed_ports(joint).tolist():
                y.mode[c] = OPEN
                y.F[row[c] : row[c + 1]] = 0.0
