"""Forces, constraints and friction of a mechanism at one state, and their derivatives, from its analytic templates."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fricmb.analysis._errors import Floats
from fricmb.analysis._linearise import add_elements, friction_at, normal_at, slopes_of
from fricmb.integrate.mechanism import Mechanism, loads_of
from fricmb.integrate.model.table_values import arguments, evaluate
from fricmb.integrate.problem import NORMAL_LAW, NORMAL_REACTION, Templates
from fricmb.system import MechanismSystem


@dataclass(frozen=True, kw_only=True)
class Tangent:
    """A mechanism at a state q, v, z with multipliers lam (m,) and friction forces F (m_p,).

    ``force`` (n,) on the degrees of freedom, ``phi`` (m,) the constraints and ``rate`` (m,) their rates, ``excess``
    (m_p,) the forces F less those of the laws, ``z_rate`` (n_z,); each with derivatives by q, v, lam, F and z where it
    has them.  ``G`` (m, n) are those of the constraints.  ``g`` (m_p,) with ``g_v``, ``N`` (n_c,).
    """

    force: Floats
    force_q: Floats
    force_v: Floats
    force_lam: Floats
    force_F: Floats
    phi: Floats
    rate: Floats
    G: Floats
    excess: Floats
    law_q: Floats
    law_v: Floats
    law_lam: Floats
    law_z: Floats
    z_rate: Floats
    rate_q: Floats
    rate_v: Floats
    rate_lam: Floats
    rate_z: Floats
    g: Floats
    g_v: Floats
    N: Floats


class _Extended:
    """Sums over parts in the extended coordinates y, with the derivatives by X = [t, y, y', u, u'], lam and F."""

    def __init__(self, system: MechanismSystem, X: Floats, lam: Floats, F: Floats) -> None:
        self.system, self.X, self.lam, self.F = system, X, lam, F
        problem, m = system.problem, system.mechanism
        n_y, n_p, n_c = m.n_y, problem.m, problem.n_c
        self.force, self.force_X = np.zeros(n_y), np.zeros((n_y, X.size))
        self.force_lam, self.force_F = np.zeros((n_y, lam.size)), np.zeros((n_y, n_p))
        self.phi, self.phi_X = np.zeros(lam.size), np.zeros((lam.size, X.size))
        self.rate = np.zeros(lam.size)
        self.g, self.g_X = np.zeros(n_p), np.zeros((n_p, X.size))
        self.N, self.N_X, self.N_lam = np.zeros(n_c), np.zeros((n_c, X.size)), np.zeros((n_c, lam.size))
        self._structure()
        add_elements(problem.elements, X, self.force, self.force_X)
        for j in range(len(m.joints.port)):
            self._joint(j)
        for c in range(n_c):
            if problem.contacts.normal[c] != NORMAL_REACTION:
                self._contact(c)

    def _structure(self) -> None:
        m, n_y = self.system.mechanism, self.system.mechanism.n_y
        u = np.arange(1 + 2 * n_y, self.X.size).reshape(2, -1)
        y = np.arange(1, 1 + 2 * n_y).reshape(2, -1)
        self.force += m.f[:n_y]
        for entries, kind in ((m.K, 0), (m.C, 1)):
            columns = np.concatenate([y[kind], u[kind]])
            for i, j, value in zip(entries.row, entries.column, entries.value, strict=True):
                if i < n_y:
                    self.force[i] -= value * self.X[columns[j]]
                    self.force_X[i, columns[j]] -= value
        for i, j, value in zip(m.B.row, m.B.column, m.B.value, strict=True):
            self.force[i] += value * self.X[u[0, j]]

    def _scatter(self, table: Templates, a: int) -> Floats:
        """What a unit force on form a is on y (n_y,)."""
        n_y, share = self.system.mechanism.n_y, np.zeros(self.system.mechanism.n_y)
        form = slice(int(table.form_start[a]), int(table.form_start[a + 1]))
        for i, c in zip(table.form_index[form], table.form_coefficient[form], strict=True):
            if 1 <= i <= n_y:
                share[i - 1] += c
        return share

    def _joint(self, j: int) -> None:
        """Constraints, reactions and friction of a joint; its template is laid out as in ``Joints``."""
        joints, contacts = self.system.mechanism.joints, self.system.problem.contacts
        table, own = joints.table, slice(int(joints.row[j]), int(joints.row[j + 1]))
        m, c, first = own.stop - own.start, int(joints.port[j]), int(table.x_start[j])
        of = int(loads_of(joints)[j])
        pressing = slice(int(joints.row[of]), int(joints.row[of + 1]))
        size = pressing.stop - pressing.start
        n_x = (int(table.x_start[j + 1]) - first) // 2
        rows = slice(int(contacts.row[c]), int(contacts.row[c + 1])) if c >= 0 else slice(0, 0)
        d = rows.stop - rows.start
        slopes = slopes_of(table, j, self.X.size)
        x = np.concatenate([arguments(table, j, self.X[:, None])[0], self.lam[pressing]])
        at = m + 2 * m * n_x + n_x * n_x
        n_out = at + (d * n_x * (1 + n_x) + 1 + size + 2 * n_x if c >= 0 else 0)
        out = evaluate(table, j, x[None], n_out)[:, 0]
        kept = joints.dropped[own] == 0
        G, bend = out[m : m + m * n_x].reshape(m, n_x), out[m + m * n_x : m + m * n_x + n_x * n_x].reshape(n_x, n_x)
        place, speed = slopes[:n_x], slopes[n_x:]
        spread = np.array([self._scatter(table, first + a) for a in range(n_x)]).reshape(n_x, -1).T
        self.phi[own] = np.where(kept, out[:m], 0.0)
        self.phi_X[own] = np.where(kept[:, None], G @ place, 0.0)
        self.rate[own] = np.where(kept, G @ x[n_x : 2 * n_x], 0.0)
        self.force += spread @ (G.T @ self.lam[own])
        self.force_X += spread @ bend @ place
        self.force_lam[:, own] += spread @ np.where(kept[:, None], G, 0.0).T
        if c < 0:
            return
        s = out[at : at + d * n_x].reshape(d, n_x)
        turn = out[at + d * n_x : at + d * n_x * (1 + n_x)].reshape(d, n_x, n_x)
        load = at + d * n_x * (1 + n_x)
        self.g[rows] = s @ x[n_x : 2 * n_x]
        self.g_X[rows] = s @ speed + np.einsum("dab,a->db", turn, x[n_x : 2 * n_x]) @ place
        self.force += spread @ (s.T @ self.F[rows])
        self.force_X += spread @ np.einsum("dab,d->ab", turn, self.F[rows]) @ place
        self.force_F[:, rows] += spread @ s.T
        self.N[c], self.N_lam[c, pressing] = out[load], out[load + 1 : load + 1 + size]
        self.N_X[c] = out[load + 1 + size : load + 1 + size + 2 * n_x] @ slopes

    def _contact(self, c: int) -> None:
        """Friction and normal force of a contact that is no joint."""
        contacts, slip = self.system.problem.contacts, self.system.mechanism.slip
        slopes = slopes_of(slip, c, self.X.size)
        values = arguments(slip, c, self.X[:, None])[0]
        for i, a in enumerate(range(int(contacts.row[c]), int(contacts.row[c + 1]))):
            self.g[a], self.g_X[a] = values[2 * i + 1] - contacts.w[a], slopes[2 * i + 1]
            share = self._scatter(slip, int(slip.x_start[c]) + 2 * i)
            self.force += share * self.F[a]
            self.force_F[:, a] += share
        self.N[c], self.N_X[c] = normal_at(contacts, c, self.X)
        if contacts.normal[c] == NORMAL_LAW:
            share = self._scatter(contacts.normal_table, int(contacts.normal_table.x_start[c]))
            self.force += share * (self.N[c] - contacts.N0[c])
            self.force_X += np.outer(share, self.N_X[c])


def tangent(
    system: MechanismSystem, q: Floats, v: Floats, z: Floats, lam: Floats, F: Floats, t: float = 0.0
) -> Tangent:
    """Everything at a state, all friction being that of slip."""
    m, n, n_y = system.mechanism, system.problem.n, system.mechanism.n_y
    p, T, bend = _places(m, q)
    u = system.signals(np.array([t]))[:, :, 0]
    X = np.concatenate([[t], q, p, T @ v, u[0], u[1]])
    at = _Extended(system, X, lam, F)
    turned = np.vstack([np.zeros((n, n)), np.einsum("eab,a->eb", bend, v)])  # derivative of y' by q

    def pulled(by_X: Floats) -> tuple[Floats, Floats]:
        """Derivatives by q and v from those by X."""
        return by_X[:, 1 : 1 + n_y] @ T + by_X[:, 1 + n_y : 1 + 2 * n_y] @ turned, by_X[:, 1 + n_y : 1 + 2 * n_y] @ T

    force_q, force_v = pulled(at.force_X)
    force_q = T.T @ force_q + np.einsum("e,eab->ab", at.force[n:], bend)
    g_q, g_v = pulled(at.g_X)
    N_q, N_v = pulled(at.N_X)
    laws = _laws(system, at.g, at.N, z, (g_q, g_v, np.zeros((at.g.size, lam.size))), (N_q, N_v, at.N_lam))
    excess, z_rate, law, rate, law_z, rate_z = laws
    return Tangent(
        force=T.T @ at.force, force_q=force_q, force_v=T.T @ force_v, force_lam=T.T @ at.force_lam,
        force_F=T.T @ at.force_F, phi=at.phi, rate=at.rate, G=pulled(at.phi_X)[0], excess=F - excess,
        law_q=law[0], law_v=law[1], law_lam=law[2], law_z=law_z, z_rate=z_rate, rate_q=rate[0], rate_v=rate[1],
        rate_lam=rate[2], rate_z=rate_z, g=at.g, g_v=g_v, N=at.N,
    )  # fmt: skip


def _laws(
    system: MechanismSystem, g: Floats, N: Floats, z: Floats, g_by: tuple[Floats, ...], N_by: tuple[Floats, ...]
) -> tuple[Floats, Floats, list[Floats], list[Floats], Floats, Floats]:
    """Forces of all laws and rates of their states; derivatives by q, v and lam, then by z."""
    contacts = system.problem.contacts
    force, z_rate = np.zeros(g.size), np.zeros(z.size)
    law, rate = [np.zeros_like(by) for by in g_by], [np.zeros((z.size, by.shape[1])) for by in g_by]
    law_z, rate_z = np.zeros((g.size, z.size)), np.zeros((z.size, z.size))
    for c, (first, last) in enumerate(pairwise(contacts.row)):
        rows, own = slice(int(first), int(last)), slice(int(contacts.z_start[c]), int(contacts.z_start[c + 1]))
        d, size = rows.stop - rows.start, float(np.linalg.norm(g[rows]))
        force[rows], z_rate[own], J = friction_at(system, c, g[rows], size, max(float(N[c]), 0.0), z[own])
        for i, (by_g, by_N) in enumerate(zip(g_by, N_by, strict=True)):
            both = J[:, :d] @ by_g[rows] + np.outer(J[:, d], by_N[c])
            law[i][rows], rate[i][own] = both[:d], both[d:]
        law_z[rows, own], rate_z[own, own] = J[:d, d + 1 :], J[d:, d + 1 :]
    return force, z_rate, law, rate, law_z, rate_z


def _places(m: Mechanism, q: Floats) -> tuple[Floats, Floats, Floats]:
    """Points fixed in bodies p (n_p,), dy/dq (n_y, n) and d2p/dq2 (n_p, n, n)."""
    places, n = m.places, m.n
    p, grad, bend = np.zeros(m.n_places), np.zeros((m.n_places, n)), np.zeros((m.n_places, n, n))
    for k in range(len(places.address)):
        dofs = places.dof[places.dof_start[k] : places.dof_start[k + 1]]
        rows = np.arange(int(places.first[k]), int(places.first[k + 1]))
        c, b = len(rows), len(dofs)
        offset = places.p[places.p_start[k] : places.p_start[k + 1]]
        table = Templates(
            address=places.address[k : k + 1], p_start=np.array([0, offset.size]), p=offset, x_start=np.array([0, b])
        )
        out = evaluate(table, 0, q[dofs][None], c * (1 + b + b * b))[:, 0]
        p[rows] = out[:c]
        grad[np.ix_(rows, dofs)] = out[c : c + c * b].reshape(c, b)
        bend[np.ix_(rows, dofs, dofs)] = out[c + c * b :].reshape(c, b, b)
    return p, np.vstack([np.eye(n), grad]), bend
