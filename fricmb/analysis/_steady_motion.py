"""Steady motion of a mechanism: velocities that stay as they are while its friction slides."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from fricmb.analysis._errors import AnalysisError, Floats
from fricmb.analysis._linearise import Linearised, friction_at
from fricmb.analysis._mechanism import Tangent, tangent
from fricmb.analysis._steady import SteadySliding, check_slides
from fricmb.analysis._track import Pairs, eigenpairs
from fricmb.integrate.mechanism import Entries
from fricmb.integrate.problem import LAW_SMOOTH, Ints
from fricmb.system import MechanismSystem

if TYPE_CHECKING:
    from fricmb.scene import Scene

#: q, v, z, multipliers, friction forces.
State = tuple[Floats, Floats, Floats, Floats, Floats]
_MOST_STEPS = 60
#: Residuals beside what balances, and columns beside the largest, count as 0 below this.
SMALL, NOTHING = 1e-9, 1e-11
#: Residuals are round-off below this part of their terms.
ROUND_OFF = 1e-15


@dataclass(frozen=True, kw_only=True, repr=False)
class SteadyMotion(SteadySliding):
    """Steady motion of a mechanism; attributes as of :class:`SteadySliding`.

    Attributes
    ----------
    moving : (k,) int64
        Degrees of freedom on whose position nothing depends, but a drive: they may move evenly.
    tangent : Tangent
        Derivatives at the state.
    mass : Entries
        Mass matrix.
    """

    moving: Ints
    tangent: Tangent
    mass: Entries

    def bases(self) -> tuple[Floats, Floats]:
        """Displacements (n, k) that joints leave, without those on which nothing depends; and velocities (n, l)."""
        n, free = len(self.q), self.free
        still = np.array([i for i in free if i not in set(self.moving.tolist())], dtype=np.int64)
        Z = np.zeros((n, 0))
        if still.size:
            G = self.tangent.G[:, still]
            _, sizes, rows = np.linalg.svd(G) if G.size else (None, np.zeros(0), np.eye(still.size))
            rank = int((sizes > 1e-10 * sizes.max(initial=0.0)).sum())
            Z = np.zeros((n, still.size - rank))
            Z[still] = rows[rank:].T
        _, sizes, rows = np.linalg.svd(self.tangent.G[:, self.moving])
        driven = int((sizes > 1e-10 * sizes.max(initial=0.0)).sum()) if sizes.max(initial=0.0) > 0.0 else 0
        even = np.zeros((n, self.moving.size - driven))
        even[self.moving] = rows[driven:].T if driven else np.eye(self.moving.size)
        return Z, np.hstack([Z, even])

    def matrix(self) -> Floats:
        """The state matrix of ``y' = A y``: displacements and velocities over :meth:`bases`, then law states."""
        at, free = self.tangent, self.free
        Z, V = self.bases()
        k, width, n_z = Z.shape[1], V.shape[1], self.z.size
        K, C, B, D = self._forces()
        M = np.zeros((len(self.q), len(self.q)))
        np.add.at(M, (self.mass.row, self.mass.column), self.mass.value)
        left = np.hstack([(M @ V)[free], -B[free]])
        right = np.hstack([K @ Z, C @ V, D])[free]
        solved = np.linalg.lstsq(left, right, rcond=1e-13)[0]
        middle, lam = solved[:width], solved[width:]
        top = np.hstack([np.eye(k, k), np.zeros((k, width - k)), np.zeros((k, n_z))])
        top = np.hstack([np.zeros((k, k)), top])
        rates = np.hstack([at.rate_q @ Z, at.rate_v @ V, at.rate_z]) + at.rate_lam @ lam
        return np.vstack([top, middle, rates])

    def _forces(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Derivatives of all forces by q, v, lam and z, friction following its law."""
        at = self.tangent
        own = (at.force_q, at.force_v, at.force_lam, np.zeros((len(self.q), self.z.size)))
        laws = (at.law_q, at.law_v, at.law_lam, at.law_z)
        K, C, B, D = (by + at.force_F @ law for by, law in zip(own, laws, strict=True))
        return K, C, B, D

    def eigenpairs(self) -> Pairs:
        """Eigenvalues and eigenvectors, these over the free degrees of freedom, all velocities and law states."""
        values, vectors = eigenpairs(self.matrix())
        Z, V = self.bases()
        k, width = Z.shape[1], V.shape[1]
        parts = [vectors[:, :k] @ Z[self.free].T, vectors[:, k : k + width] @ V.T, vectors[:, k + width :]]
        full = np.hstack(parts)
        return values, full / np.linalg.norm(full, axis=1)[:, None]


def steady_motion(scene: Scene, system: MechanismSystem, speeds: Mapping[str, float]) -> SteadyMotion:
    """A state whose velocities stay as they are, by damped Gauss-Newton steps of least change from the start.

    Unknown are positions; of degrees of freedom on whose position nothing depends (the spin of a wheel) velocities;
    reactions, friction forces and law states.
    """
    names = system.dof_names
    v = system.start.v.copy()
    for name, value in speeds.items():
        v[names.index(name)] = float(value)
    held = np.array([name in speeds for name in names])
    moving = np.array([i for i in _ignorable(system, v) if not held[i]], dtype=np.int64)
    rests = ~held
    rests[moving] = False
    v[rests] = 0.0
    v[moving] += _rolling(system, v, moving)
    q, v, z, lam, F = _solve(system, v, held, moving)
    at = tangent(system, q, v, z, lam, F)
    _check(system, at, (q, v, z, lam, F), held, moving)
    M = system.mechanism.M
    mass = np.zeros(q.size)
    np.add.at(mass, M.row[M.row == M.column], M.value[M.row == M.column])
    pull = np.divide(at.force, mass, out=np.zeros_like(mass), where=mass > 0.0)
    rows = system.problem.contacts.row
    none = np.zeros((0, 0))
    found = Linearised(
        force=at.force, rate=at.z_rate, force_y=none, rate_y=none, F=F, g=at.g, N=at.N,
        r=np.array([np.linalg.norm(at.g[a:b]) for a, b in pairwise(rows)]),
    )  # fmt: skip
    check_slides(system, found)
    return SteadyMotion(
        scene=scene, system=system, q=q, v=v, z=z, held=tuple(speeds), at=found, moving=moving, tangent=at, mass=M,
        acceleration={name: float(pull[names.index(name)]) for name in speeds},
    )  # fmt: skip


def _ignorable(system: MechanismSystem, v: Floats) -> list[int]:
    """Degrees of freedom on whose position nothing depends at the start, or nothing but what drives them in time."""
    rng, m = np.random.default_rng(0), system.mechanism
    lam, F = rng.standard_normal(m.n_rows), rng.standard_normal(system.problem.m)
    state = (system.start.q, v + 1e-3 * rng.standard_normal(v.size), system.start.z, lam, F)
    at, later = tangent(system, *state), tangent(system, *state, 1.0)
    drives = (later.phi != at.phi) & (np.count_nonzero(at.G, axis=1) == 1)
    columns = np.vstack([at.force_q, np.where(drives[:, None], 0.0, at.G), at.law_q, at.rate_q])
    size = np.abs(columns).max(axis=1, initial=0.0)
    scaled = np.abs(columns / np.where(size > 0.0, size, 1.0)[:, None])
    return np.flatnonzero(scaled.max(axis=0, initial=0.0) <= NOTHING).tolist()


def _rolling(system: MechanismSystem, v: Floats, moving: Ints) -> Floats:
    """Change of the velocities that are free by which contacts with smooth laws slip least: where to begin."""
    start, contacts = system.start, system.problem.contacts
    at = tangent(system, start.q, v, start.z, np.zeros(system.mechanism.n_rows), np.zeros(system.problem.m))
    rows = np.repeat(contacts.law == LAW_SMOOTH, np.diff(contacts.row))
    change: Floats = -np.linalg.lstsq(at.g_v[rows][:, moving], at.g[rows], rcond=1e-10)[0]
    return change


def _solve(system: MechanismSystem, v: Floats, held: np.ndarray, moving: Ints) -> State:
    """Positions, velocities, law states, multipliers and friction forces that balance."""
    q, z = system.start.q.copy(), system.start.z.copy()
    lam, F = np.zeros(system.mechanism.n_rows), np.zeros(system.problem.m)
    still = np.array([i for i in np.flatnonzero(~held) if i not in set(moving.tolist())], dtype=np.int64)
    sizes = np.cumsum([0, still.size, moving.size, z.size, lam.size, F.size])
    state: State = (q, v.copy(), z, lam, F)

    def after_step(step: Floats, share: float) -> State:
        parts: list[Floats] = [share * step[a:b] for a, b in pairwise(sizes)]
        q, v, z, lam, F = (x.copy() for x in state)
        q[still] += parts[0]
        v[moving] += parts[1]
        return q, v, z + parts[2], lam + parts[3], F + parts[4]

    residual, J, weight = _equations(system, state, held, still, moving)
    for _ in range(_MOST_STEPS):
        terms = np.abs(J) @ np.abs(np.concatenate([state[0][still], state[1][moving], *state[2:]]))
        if (np.abs(residual) <= ROUND_OFF * (terms + weight)).all():
            break
        step = np.asarray(-np.linalg.lstsq(J / weight[:, None], residual / weight, rcond=1e-13)[0], dtype=np.float64)
        share = 1.0
        while True:
            there = after_step(step, share)
            following = _equations(system, there, held, still, moving)
            before, after = (float(np.linalg.norm(r / weight)) for r in (residual, following[0]))
            if after <= (1 - 0.1 * share) * before or share < 1e-3:
                break
            share /= 2
        if after >= before:
            break
        state, (residual, J, weight) = there, following
    return state


def _equations(
    system: MechanismSystem, state: State, held: np.ndarray, still: Ints, moving: Ints
) -> tuple[Floats, Floats, Floats]:
    """What has to vanish, its derivatives by the unknowns, and the size of what balances in each row."""
    q, v, z, lam, F = state
    at = tangent(system, q, v, z, lam, F)
    free, n_z, m, m_p = ~held, z.size, lam.size, F.size
    G_v = np.zeros((m, n_z + m + m_p))
    rows = [
        np.hstack([at.force_q[free][:, still], at.force_v[free][:, moving], np.zeros((free.sum(), n_z)),
                   at.force_lam[free], at.force_F[free]]),
        np.hstack([at.G[:, still], np.zeros((m, moving.size)), G_v]),
        np.hstack([np.zeros((m, still.size)), at.G[:, moving], G_v]),
        np.hstack([-at.law_q[:, still], -at.law_v[:, moving], -at.law_z, -at.law_lam, np.eye(m_p)]),
        np.hstack([at.rate_q[:, still], at.rate_v[:, moving], at.rate_z, at.rate_lam, np.zeros((n_z, m_p))]),
    ]  # fmt: skip
    J = np.vstack(rows)
    residual = np.concatenate([at.force[free], at.phi, at.rate, at.excess, at.z_rate])
    size = np.abs(J).max(axis=1, initial=0.0)
    return residual, J, np.where(size > 0.0, size, 1.0)


def _check(system: MechanismSystem, at: Tangent, state: State, held: np.ndarray, moving: Ints) -> None:
    """Refuse what does not move steadily."""
    names, free = system.dof_names, ~held
    lam, F = state[3], state[4]
    terms = np.abs(at.force_lam) @ np.abs(lam) + np.abs(at.force_F) @ np.abs(F)
    scale = max(float(terms.max(initial=0.0)), float(np.abs(system.mechanism.f).max(initial=0.0)), 1e-300)
    off = np.where(free, np.abs(at.force), 0.0)
    if off.max(initial=0.0) > SMALL * scale:
        worst = int(np.argmax(off))
        raise AnalysisError(
            f"steady_sliding: no steady motion; {names[worst]} is left with a force of {at.force[worst]:.4g}; if it"
            f" moves at a speed that counts as constant, give speeds={{{names[worst]!r}: ...}}"
        )
    _check_laws(system, at, state)
    length = max(float(np.abs(state[0]).max(initial=0.0)), 1.0)
    if np.abs(np.concatenate([at.phi, at.rate])).max(initial=0.0) > SMALL * length:
        raise AnalysisError("steady_sliding: no steady motion; joints do not close in it")
    for t in (1.0, 2.718281828):
        there = state[0].copy()
        there[moving] += t * state[1][moving]
        later = tangent(system, there, *state[1:], t)
        change = np.where(free, np.abs(later.force - at.force), 0.0)
        shift = np.abs(np.concatenate([later.phi - at.phi, later.rate - at.rate, later.g - at.g]))
        if change.max(initial=0.0) > SMALL * scale or shift.max(initial=0.0) > SMALL * length:
            raise AnalysisError("steady_sliding: forces or joints depend on time")


def _check_laws(system: MechanismSystem, at: Tangent, state: State) -> None:
    """Refuse smooth laws whose force near rest of slip depends on the direction of slip: they have no derivative."""
    contacts, rows = system.problem.contacts, system.problem.contacts.row
    v, z, driven = state[1], state[2], system.signals(np.zeros(1))[1]
    near = SMALL * max(float(np.abs(v).max(initial=0.0)), float(np.abs(driven).max(initial=0.0)))
    for c in np.flatnonzero(contacts.law == LAW_SMOOTH):
        g, d = at.g[rows[c] : rows[c + 1]], int(rows[c + 1] - rows[c])
        if np.linalg.norm(g) > near:
            continue
        own = z[contacts.z_start[c] : contacts.z_start[c + 1]]
        load, tries = max(float(at.N[c]), 0.0), near * np.vstack([np.eye(d), -np.eye(d), np.ones(d)])
        here = (friction_at(system, int(c), x, float(np.linalg.norm(x)), load, own)[2][:, :d] for x in tries)
        by_slip = np.array(list(here))
        if np.abs(by_slip - by_slip[0]).max() > 1e-3 * np.abs(by_slip).max():
            raise AnalysisError(
                f"steady_sliding: the law of {system.contact_names[c]!r} has no derivative where it does not slip; the"
                " stability of this motion depends on the size of the disturbance"
            )
