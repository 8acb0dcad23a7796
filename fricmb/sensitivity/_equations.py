"""The equations of a scene and their derivatives at many times, from what its parts state in SymPy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.problem import STICK, Codes, Floats, Ints
from fricmb.integrate.trajectory import Samples
from fricmb.scene import Body, Contact, ModalBody
from fricmb.scene._space_body import with_inner
from fricmb.sensitivity._breakpoints import Breakpoints, timed_of
from fricmb.sensitivity._contacts import Rubs
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._found import Found, whole
from fricmb.sensitivity._friction import Friction
from fricmb.sensitivity._linear import Linear
from fricmb.sensitivity._motions import Frame, Moment, Row
from fricmb.sensitivity._parts import Acting, acting, masses, refuse
from fricmb.sensitivity._seeds import Seeds
from fricmb.sensitivity._struck import Meeting

#: Slip (d, n_t) by number of contact.
Slip = Mapping[int, Floats]


@dataclass(frozen=True, kw_only=True)
class Field:
    """Right-hand side and slopes at the times of a moment; columns q, v, z, parameters, time.

    ``a`` (n_t, n), ``a_slopes`` (n_t, n, columns); ``rate`` (n_t, n_z), ``rate_slopes``; ``F`` friction of contacts
    that stick by number: (n_t, d) and slopes, 0 at times at which they do not.
    """

    found: Found
    v: Floats
    a: Floats
    a_slopes: Floats
    rate: Floats
    rate_slopes: Floats
    F: dict[int, tuple[Floats, Floats]]

    @property
    def y_dot(self) -> Floats:
        """Rates of q, v and z (n_t, n_y)."""
        return np.concatenate([self.v, self.a, self.rate], axis=1)


class Equations:
    """One piece of a run, with the parameters that derivatives are asked for.

    Parameters
    ----------
    piece, names
        Of the solution.
    parameters : tuple of str
        Names; columns of slopes are q, v, z, these, time.
    """

    def __init__(self, piece: Any, names: Any, parameters: tuple[str, ...]) -> None:
        mechanics = piece.mechanics
        scene = mechanics.placed
        index = dict(names.dof_index)
        self.names, self.scene = names, scene
        self.n, self.n_z = len(index), int(names.z_start[-1])
        self.n_y = 2 * self.n + self.n_z
        self.columns = self.n_y + len(parameters) + 1
        seeds = Seeds({name: self.n_y + i for i, name in enumerate(parameters)}, scene)
        self.seeds = seeds
        self._prepare(piece)
        for body in scene.bodies:
            self._check_body(body)
        self.frame = Frame(
            scene=scene, index=index, seeds=seeds, driven=_driven(mechanics, names), n=self.n,
            time_column=self.columns - 1, start=piece.t_start,
        )  # fmt: skip
        held = set(mechanics.plan.parts)
        self.M, self.seeded_masses, self.weights = masses(scene, held, index, seeds)
        self.contacts: dict[int, Friction] = {}
        self.touching: dict[int, Rubs] = {}
        self.acting: list[Acting] = []
        for part in self._parts(scene):
            self._take(part, part.name in held)
        self.breakpoints = self._breakpoints(piece, parameters)
        self.linear = Linear(self.acting, self.frame, self.columns)
        self.inverse = np.linalg.inv(self.weights)
        self._projectors: dict[bytes, tuple[Floats, Floats, Floats]] = {}

    def _prepare(self, piece: Any) -> None:
        """Before parts are taken."""

    def _parts(self, scene: Any) -> Sequence[Any]:
        """What acts."""
        return with_inner(scene.parts)

    def joining(self) -> Sequence[Any]:
        """What joints state; there are none here."""
        return ()

    def meetings(self, samples: Samples) -> dict[str, Meeting]:
        """Surfaces that bodies bounce on; there are none here."""
        return {}

    def _check_body(self, body: Any) -> None:
        """Refuse bodies that are not covered."""
        if not isinstance(body, Body | ModalBody):
            refuse(body, f"a {type(body).__name__}")

    def settled(self, found: Found, S: Floats) -> Floats:
        """Derivatives of a start that joints hold; there are none here."""
        return S

    def _take(self, part: Any, held: bool) -> None:
        touched = self.seeds.touch(part)
        if not held and not touched:
            return
        if isinstance(part, Contact):
            k = self.names.contact_index.get(part.name)
            if k is None:
                raise SceneError(
                    f"sensitivities: {part._label()} was left out of the run, because it acts on nothing or is nothing;"
                    f" there is no derivative with respect to {touched[0]!r}"
                )
            self.contacts[k] = self.touching[k] = Rubs(part, k, int(self.names.z_start[k]), self.seeds)
            return
        found = acting(self.scene, part, self.frame.index, self.seeds)
        if found is not None:
            self.acting.append(found)

    def _breakpoints(self, piece: Any, parameters: tuple[str, ...]) -> Breakpoints:
        """Breakpoints of the run, told to the motions that are given."""
        systems = [member.system for member in piece.mechanics.members if "system" in vars(member)]
        times = [s.problem_for(piece.t_start, piece.t_end).signals.breakpoints for s in systems]
        t = np.concatenate([np.zeros(0), *times])
        t = t[(t > piece.t_start) & (t < piece.t_end)]
        timed = timed_of(self.scene, self.acting, self.seeds) if t.size else []
        found = Breakpoints(t, timed, parameters, self.n_y)
        for time, dt in zip(found.t.tolist(), found.dt, strict=True):
            self.frame.breaks.append((time, {self.n_y + int(j): float(dt[j]) for j in np.flatnonzero(dt)}))
        return found

    def rows(self, k: int) -> slice:
        """Rows of a contact."""
        return slice(int(self.names.row[k]), int(self.names.row[k + 1]))

    def moment(self, samples: Samples, slip: Slip | None = None) -> Moment:
        """Samples of the run as a moment; ``slip``: where it is known better than from velocities."""
        return Moment(frame=self.frame, t=samples.t, q=samples.q, v=samples.v, z=samples.z, slip=slip or {})

    def said(self, samples: Samples, mode: Codes, sign: Floats, slip: Slip | None = None) -> Found:
        """What parts say."""
        moment, found = self.moment(samples, slip), Found(self.n, self.n_z, self.columns, samples.t.size)
        for part in (self.linear, *self.linear.rest):
            part.add(moment, found)
        for k, contact in self.touching.items():
            contact.add(moment, found, mode[k], sign[self.rows(k)])
        return found

    def field(self, samples: Samples, mode: Codes, sign: Floats, slip: Slip | None = None) -> Field:
        """Right-hand side and its slopes; ``mode`` (n_c, n_t), ``sign`` (m, n_t) are those of the phases.

        ``slip``: of contacts by number (d, n_t), where it is known better than as a difference of velocities.
        """
        found, count = self.said(samples, mode, sign, slip), samples.t.size
        a, slopes, F = self._accelerations(found, mode, count)
        rate_slopes = found.dense(found.rate_slopes, self.n_z).transpose(2, 0, 1)
        return Field(
            found=found, v=samples.v.T, a=a, a_slopes=slopes, rate=found.rate.T, rate_slopes=rate_slopes, F=F
        )

    def _accelerations(self, found: Found, mode: Codes, count: int) -> tuple[Floats, Floats, Any]:
        """Accelerations where stuck contacts hold: M a = f + W F, W^T a + drift = 0."""
        hard = [k for k, contact in self.contacts.items() if not contact.smooth]
        patterns, which = _patterns(mode[hard] == STICK)
        G = found.force_slopes()
        a, slopes = np.empty((self.n, count)), np.empty((self.n, self.columns, count))
        F = {
            k: (np.zeros((count, self.contacts[k].d)), np.zeros((count, self.contacts[k].d, self.columns)))
            for k in hard
        }
        for p, pattern in enumerate(patterns.T):
            stuck = [k for k, s in zip(hard, pattern, strict=True) if s]
            at = np.flatnonzero(which == p)
            own = slice(None) if at.size == count else at
            a[:, own], slopes[..., own] = self._held(found, G, stuck, own, F)
        return a.T, slopes.transpose(2, 0, 1), F

    def _held(self, found: Found, G: Floats, stuck: list[int], at: Any, F: Any) -> tuple[Floats, Floats]:
        """Accelerations (n, n_t) and their slopes (n, columns, n_t) at times at which the same contacts stick."""
        free, B, D = self.projector(found, stuck)
        f, G = found.force[:, at], G[..., at]
        a = free @ f
        drift, drift_slopes = whole([d for k in stuck for d in found.drift[k]], found.force.shape[1], self.columns)
        if stuck:
            drift, drift_slopes = drift[at].T, drift_slopes[at].transpose(1, 2, 0)
            a -= B @ drift
        for i, k, j, slope in self.seeded_masses:
            G[i, j] -= slope * a[k]
        if stuck:
            F_held = -(B.T @ f + D @ drift)
            self._turn([row for k in stuck for row in found.rows[k]], F_held, a, G, drift_slopes)
        slopes = np.tensordot(free, G, 1)
        if stuck:
            slopes -= np.tensordot(B, drift_slopes, 1)
        first = 0
        for k in stuck:
            own = slice(first, first + self.contacts[k].d)
            F[k][0][at] = F_held[own].T
            by = -np.tensordot(B[:, own].T, G, 1) - np.tensordot(D[own], drift_slopes, 1)
            F[k][1][at] = by.transpose(2, 0, 1)
            first = own.stop
        return a, slopes

    @staticmethod
    def _turn(rows: list[Row], F: Floats, a: Floats, G: Floats, drift_slopes: Floats) -> None:
        """What parameters in the rows W of what sticks add to slopes of W F and of W^T a, in place."""
        for r, row in enumerate(rows):
            for i, c in row:
                for j, slope in c.slopes.items() if isinstance(c, Dual) else ():
                    G[i, j] += slope * F[r]
                    drift_slopes[r, j] += slope * a[i]

    def free(self, found: Found, mode: Codes, i: int) -> Floats:
        """Inverse mass (n, n) of what is free to move while contacts stick as ``mode`` (n_c,) says."""
        stuck = [k for k, contact in self.contacts.items() if not contact.smooth and mode[k] == STICK]
        return self.projector(found, stuck, i)[0]

    def projector(self, found: Found, stuck: list[int], i: int = 0) -> tuple[Floats, Floats, Floats]:
        """Inverse mass of what is free to move, B = M^-1 W D^-1, and D^-1, with D = W^T M^-1 W of what sticks.

        ``i``: number of the time, of no account where rows are constant.
        """
        key = np.array(stuck, dtype=np.int64).tobytes()
        held = self._projectors.get(key)
        if held is None:
            rows = [row for k in stuck for row in found.rows[k]]
            W = np.zeros((self.n, len(rows)))
            for r, row in enumerate(rows):
                for i, c in row:
                    W[i, r] += c.value if isinstance(c, Dual) else c
            MW = self.inverse @ W
            D: Floats = np.zeros((0, 0))
            if rows:
                D = np.asarray(np.linalg.pinv(W.T @ MW, rcond=1e-11, hermitian=True), dtype=float)
            B = MW @ D
            held = self._projectors[key] = (self.inverse - B @ MW.T, B, D)
        return held


def _patterns(sticks: Any) -> tuple[Any, Ints]:
    """Different columns (n, n_patterns) of flags (n, n_t), and which of them each one is."""
    which = np.zeros(sticks.shape[1], dtype=np.int64)
    for row in sticks:
        which = 2 * which + row
        if which.max(initial=0) > 2**40:
            which = np.unique(which, return_inverse=True)[1]
    _, first, which = np.unique(which, return_index=True, return_inverse=True)
    return sticks[:, first], which


def _driven(mechanics: Any, names: Any) -> Any:
    def position(name: str, t: Floats) -> Floats:
        found: Floats = mechanics.signals(t)[0][names.signals[name]]
        return found

    return position
