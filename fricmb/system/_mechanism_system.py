"""A mechanism as arrays, with names, energies and reactions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from fricmb.errors import unknown_name
from fricmb.integrate.mechanism import RIGID, Mechanism
from fricmb.integrate.model.table_values import _each
from fricmb.integrate.problem import OPEN, Codes, Floats, Start
from fricmb.integrate.trajectory import MotionSamples
from fricmb.system._system import System


@dataclass(frozen=True, kw_only=True)
class MechanismSystem(System):
    """See :class:`System`."""

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism of the problem."""
        if self.problem.mechanism is None:
            raise TypeError("this system has no mechanism")
        return self.problem.mechanism

    @property
    def _n_coordinates(self) -> int:
        """Degrees of freedom, and the points fixed in bodies behind them."""
        return self.problem.n + self.mechanism.n_places

    def kinetic(self, samples: MotionSamples) -> Floats:
        """Kinetic energy (n_t,)."""
        M, v = self.mechanism.M, samples.v
        energy: Floats = 0.5 * (M.value @ (v[M.row] * v[M.column]))
        return energy

    def potential(self, samples: MotionSamples) -> Floats:
        """Stored energy (n_t,), weight included."""
        return super().potential(self._extended(samples))

    def delivered(self, samples: MotionSamples) -> Floats:
        """Work (n_t,) of loads."""
        return super().delivered(self._extended(samples))

    def rubbed(self, samples: MotionSamples) -> Floats:
        """Loss of contacts by the centres of their cones."""
        return super().rubbed(self._extended(samples))

    def potentials(self, samples: MotionSamples) -> dict[str, Floats]:
        """Stored energy by part."""
        return super().potentials(self._extended(samples))

    def _extended(self, samples: MotionSamples) -> MotionSamples:
        p, rate = place_motions(self.mechanism, samples.q, samples.v)
        return replace(samples, q=np.concatenate([samples.q, p]), v=np.concatenate([samples.v, rate]))

    def freedom(self, samples: MotionSamples) -> int:
        """Degrees of freedom as mechanics counts them: coordinates less independent constraints, at the first time.

        What only pushes and may let go takes none away.
        """
        from fricmb.integrate.implicit.equations.least_change import constraints_at, dense
        from fricmb.integrate.implicit.equations.redundancy import RANK

        joints = self.mechanism.joints
        stays = np.repeat(joints.hands_over == 0, np.diff(joints.row))
        G = dense(constraints_at(self.problem, float(samples.t[0]), samples.q[:, 0], samples.v[:, 0]).G)[stays]
        length = np.linalg.norm(G, axis=1, keepdims=True)
        rank = int(np.linalg.matrix_rank(G / np.where(length > 0.0, length, 1.0), tol=RANK)) if G.size else 0
        return len(samples.q) - rank

    def reaction(self, joint: str, samples: MotionSamples) -> Floats:
        """Multipliers of a joint (m, n_t) at states with their friction modes."""
        joints = self.mechanism.joints
        holds = np.diff(joints.row) > 0
        both = [f"{joint}.{side}" for side in ("lower", "upper")]
        if both[0] in joints.names:  # of two ends what both together push with along the axis
            found = self.reactions(samples)
            return found[both[0]] - found[both[1]]
        known = [name for name, inner, has in zip(joints.names, joints.inner, holds, strict=True) if has and not inner]
        if joint not in known:
            raise unknown_name("joint", joint, known)
        return self.reactions(samples)[joint]

    def reactions(self, samples: MotionSamples) -> dict[str, Floats]:
        """The same of every joint by name, and of the inner constraints of bodies by theirs."""
        from fricmb.integrate.implicit.equations.consistent_start import away
        from fricmb.integrate.implicit.output.step_trajectory import complete_open

        joints, rows = self.mechanism.joints, self.problem.m
        count, m = samples.t.size, self.mechanism.n_rows
        force = np.zeros((count, m + 2 * rows))
        force[:, m : m + rows] = samples.F.T
        force[:, m + rows :] = self._directions(samples).T
        q, v, z = (np.ascontiguousarray(x.T) for x in (samples.q, samples.v, samples.z))
        opened = np.zeros((count, len(joints.port)), np.int8)
        rigid = self.mechanism.has_impacts
        for k in range(count if joints.hands_over.any() else 0):
            now = v[k] if rigid else np.zeros_like(v[k])
            opened[k] = away(self.problem, Start(t=float(samples.t[k]), q=q[k], v=now, z=z[k]))
        # just after a contact has opened it is no distance away yet, and where bounces end it is held while there is
        # still the height of the last of them: its friction knows
        rubs = np.flatnonzero((joints.hands_over != 0) & (joints.port >= 0))
        opened[:, rubs] = (samples.mode[joints.port[rubs]] == OPEN).T
        # friction tells the direction of slip also where velocities are round-off
        mode = samples.mode.T
        lam = complete_open(self.problem, opened, samples.t, q, v, z, mode, force, still=np.inf)[3]
        while self._open_what_pulls(opened, lam):
            lam = complete_open(self.problem, opened, samples.t, q, v, z, mode, force, still=np.inf)[3]
        lam = self._least_norm(samples, lam)
        return {name: lam[a:b] for name, (a, b) in zip(joints.names, pairwise(joints.row), strict=True)}

    def _open_what_pulls(self, opened: Codes, lam: Floats) -> bool:
        """Mark as open (n_t, n_j) the rigid joint that would pull most at each time; whether there was any.

        What leaves at once behind an impact without restitution is neither away yet nor leaves with a speed.
        """
        joints = self.mechanism.joints
        rigid = np.flatnonzero((joints.hands_over == RIGID) & (joints.port < 0))
        if not rigid.size:
            return False
        force = np.where(opened[:, rigid] == 0, lam[joints.row[rigid]].T, 0.0)
        worst = force.argmin(axis=1)
        pulls = np.flatnonzero(force.min(axis=1) < 0.0)
        opened[pulls, rigid[worst[pulls]]] = 1
        return bool(pulls.size)

    def _directions(self, samples: MotionSamples) -> Floats:
        """Unit vectors of slip (m_p, n_t): against friction, or along the slip velocity where there is none."""
        row = self.problem.contacts.row
        n = np.zeros_like(samples.F)
        for first, last in pairwise(row):
            F, g = samples.F[first:last], samples.g[first:last]
            against = np.where((F != 0.0).any(axis=0), -F, g)
            size = np.sqrt((against**2).sum(axis=0))
            n[first:last] = against / np.where(size > 0.0, size, 1.0)
        return n

    def _least_norm(self, samples: MotionSamples, lam: Floats) -> Floats:
        """Without what redundant constraints may push against one another."""
        if not (self.mechanism.joints.dropped == 1).any():
            return lam
        from fricmb.integrate.implicit.equations.least_change import constraints_at, dense
        from fricmb.integrate.implicit.equations.redundancy import RANK

        found = np.empty_like(lam)
        for i, t in enumerate(samples.t.tolist()):
            G = dense(constraints_at(self.problem, t, samples.q[:, i], samples.v[:, i]).G)
            # what is open bears nothing; a redundant row may
            held = (lam[:, i] != 0.0) | (self.mechanism.joints.dropped == 1)
            found[:, i] = 0.0
            found[held, i] = np.linalg.lstsq(G[held].T, G.T @ lam[:, i], rcond=RANK)[0]
        return found


def place_motions(mechanism: Mechanism, q: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Positions and velocities (n_places, n_t) of the points fixed in bodies."""
    places, count = mechanism.places, q.shape[1]
    p, rate = np.zeros((2, mechanism.n_places, count))
    for k in range(len(places.address)):
        dofs = places.dof[places.dof_start[k] : places.dof_start[k + 1]]
        rows = slice(int(places.first[k]), int(places.first[k + 1]))
        c, b = rows.stop - rows.start, len(dofs)
        n_out = c * (1 + b + b * b)
        out = np.zeros(count * n_out + 1)
        offset = np.append(places.p[places.p_start[k] : places.p_start[k + 1]], 0.0)
        _each(int(places.address[k]), np.append(q[dofs].T.ravel(), 0.0), b, offset, out, n_out, count)
        values = out[:-1].reshape(count, n_out)
        p[rows] = values[:, :c].T
        rate[rows] = np.einsum("tcb,bt->ct", values[:, c : c + c * b].reshape(count, c, b), v[dofs])
    return p, rate
