"""The equations of mechanisms and their derivatives: accelerations, reactions, friction that holds, solved together.

With u = (a, lam, F) the equations M a = f(y, p, t, lam) + W F, G a + gamma = 0, W_s^T a + gamma_s = 0 are linear in a
and F; loads of friction in joints are not linear in lam, so that they are solved by Newton's method from what the run
has.  Their slopes follow by the implicit function theorem.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.errors import IntegrationError, SceneError
from fricmb.integrate.problem import STICK, Codes, Floats
from fricmb.integrate.trajectory import Samples
from fricmb.scene import Joint, RigidBody, SpaceBody
from fricmb.scene._space_body import with_inner
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._equations import Equations, Field, Slip
from fricmb.sensitivity._found import Found, total, whole
from fricmb.sensitivity._joints import Joins
from fricmb.sensitivity._motions import Moment, Row
from fricmb.sensitivity._parts import refuse
from fricmb.sensitivity._struck import Meeting, Struck

#: Newton's method on the reactions: most steps, and the change at which it ends.
_MOST, _SMALL = 25, 1e-9
#: Reactions below this share of the other forces are measured by these.
_ROUND = 1e-4


@dataclass(kw_only=True)
class Unknowns:
    """Reactions by joint (rows, n_t), and friction (m, n_t) that counts where contacts stick."""

    lam: dict[str, Floats]
    F: Floats


class Constrained(Equations):
    """One piece of a run of a mechanism; as :class:`Equations`."""

    def _prepare(self, piece: Any) -> None:
        self.piece = piece
        self.joints: list[Joins] = []
        self.struck: dict[str, Struck] = {}

    def _parts(self, scene: Any) -> Sequence[Any]:
        return with_inner(scene.parts)

    def joining(self) -> Sequence[Any]:
        """What joints state."""
        return self.joints

    def _check_body(self, body: Any) -> None:
        if isinstance(body, SpaceBody):
            fits = ("velocity.", "mass", "inertia")
            held = [name for name in self.seeds.touch(body) if not name.partition(".")[2].startswith(fits)]
            if held:
                refuse(body, f"the parameter {held[0]!r} of a body in space")
        elif not isinstance(body, RigidBody):
            super()._check_body(body)

    def _take(self, part: Any, held: bool) -> None:
        if not isinstance(part, Joint):
            super()._take(part, held)
            return
        if part.loaded_by and self.scene[part.loaded_by].impact is not None:
            refuse(part, "resistance beside impacts")
        if part.impact is not None:  # it does nothing between its impacts
            self.struck[part.name] = Struck(part, self.seeds)
            return
        k = self.names.contact_index.get(part.name)
        self.joints.append(Joins(part, k, 0 if k is None else int(self.names.z_start[k]), self.seeds))
        friction = self.joints[-1].friction
        if friction is not None and k is not None:
            self.contacts[k] = friction

    def field(self, samples: Samples, mode: Codes, sign: Floats, slip: Slip | None = None) -> Field:
        """Right-hand side and its slopes; as :meth:`Equations.field`."""
        moment, count, unknowns = self.moment(samples, slip), samples.t.size, self._of_run(samples)
        last = np.inf
        for _ in range(_MOST):
            found = self._found(moment, unknowns, mode, sign)
            u, rows = self._solved(found, mode, count)
            off = self._step(unknowns, u)
            if off <= _SMALL or (off < 1e-6 and off > 0.5 * last):
                return self._sloped(found, samples, mode, u, rows)
            last = off
        t = float(samples.t[0])
        raise IntegrationError(
            f"sensitivities: reactions are not found at t = {t:.10g}", t=t, reason="Newton's method does not converge"
        )

    def said(self, samples: Samples, mode: Codes, sign: Floats, slip: Slip | None = None) -> Found:
        """What parts say under the reactions of the run."""
        return self._found(self.moment(samples, slip), self._of_run(samples), mode, sign)

    def meetings(self, samples: Samples) -> dict[str, Meeting]:
        """Surfaces that bodies bounce on, at the times of samples."""
        moment = self.moment(samples)
        return {name: struck.at(moment) for name, struck in self.struck.items()}

    def _of_run(self, samples: Samples) -> Unknowns:
        """Reactions and friction of the run."""
        lam = self.piece.mechanics.reactions(samples)
        return Unknowns(lam={joint.name: np.array(lam[joint.name]) for joint in self.joints}, F=samples.F.copy())

    # ---- unknowns: first the accelerations, then reactions of joints, then friction of hard contacts

    def _hard(self) -> list[int]:
        return [k for k, contact in self.contacts.items() if not contact.smooth]

    def _found(self, moment: Moment, unknowns: Unknowns, mode: Codes, sign: Floats) -> Found:
        """What parts say, reactions and friction that holds being forces with columns of their own behind time."""
        lam = [row for joint in self.joints for row in unknowns.lam[joint.name]]
        hard = self._hard()
        extra = len(lam) + sum(self.contacts[k].d for k in hard)
        found = Found(self.n, self.n_z, self.columns + extra, moment.t.size)
        for part in (self.linear, *self.linear.rest):
            part.add(moment, found)
        duals = iter([Dual(value=x, slopes={self.columns + i: 1.0}) for i, x in enumerate(lam)])
        reactions = {joint.name: [next(duals) for _ in unknowns.lam[joint.name]] for joint in self.joints}
        for joint in self.joints:
            rows = slice(0, 0) if joint.number is None else self.rows(joint.number)
            joint.add(moment, found, reactions[joint.name], reactions[joint.pressed], mode, sign[rows])
        for k, contact in self.touching.items():
            contact.add(moment, found, mode[k], sign[self.rows(k)])
        column = self.columns + len(lam)
        for k in hard:
            stuck = mode[k] == STICK
            for row, F in zip(found.rows[k], unknowns.F[self.rows(k)], strict=True):
                found.push(row, Dual(value=np.where(stuck, F, 0.0), slopes={column: np.where(stuck, 1.0, 0.0)}))
                column += 1
        return found

    def _solved(self, found: Found, mode: Codes, count: int) -> tuple[Floats, Floats]:
        """Accelerations and changes of reactions and friction (n_t, n_u), and the inverse matrices (n_t, n_u, n_u)."""
        n, extra = self.n, found.columns - self.columns
        slopes = found.dense(found.slopes, n)
        if found.constant is not None:
            slopes[:, : self.columns] += found.constant[:, : self.columns, None]
        self._slopes = slopes
        A, b = np.zeros((count, n + extra, n + extra)), np.zeros((count, n + extra))
        A[:, :n, :n] = self.M
        A[:, :n, n:] = -slopes[:, self.columns :].transpose(2, 0, 1)
        b[:, :n] = found.force.T
        r = n
        for held in found.held:
            _fill(A[:, r], held.row)
            b[:, r] = -np.asarray(held.drift.value)
            r += 1
        for k in self._hard():
            stuck = mode[k] == STICK
            for row, drift in zip(found.rows[k], found.drift[k], strict=True):
                _fill(A[:, r], row)
                A[:, r] *= stuck[:, None]
                A[~stuck, r, r] = 1.0
                b[:, r] = np.where(stuck, -np.asarray(drift.value), 0.0)
                r += 1
        inverse = _inverted(A)
        return (inverse @ b[..., None])[..., 0], inverse

    def _step(self, unknowns: Unknowns, u: Floats) -> float:
        """Newton's step; how large it is relative to the reactions."""
        # of reactions that all pass 0 nothing is asked beyond the round-off of the other forces
        size = max(1e-300, _ROUND * float(np.abs(u[:, : self.n] @ self.M.T).max(initial=0.0)))
        r, off = self.n, 0.0
        for joint in self.joints:
            lam = unknowns.lam[joint.name]
            step = u[:, r : r + len(lam)].T
            lam += step
            off, size = max(off, float(np.abs(step).max(initial=0.0))), max(size, float(np.abs(lam).max(initial=0.0)))
            r += len(lam)
        for k in self._hard():
            own = unknowns.F[self.rows(k)]
            step = u[:, r : r + len(own)].T
            own += step
            off, size = max(off, float(np.abs(step).max(initial=0.0))), max(size, float(np.abs(own).max(initial=0.0)))
            r += len(own)
        self._forces = unknowns.F
        return off / size

    def _sloped(self, found: Found, samples: Samples, mode: Codes, u: Floats, inverse: Floats) -> Field:
        """Slopes of all unknowns."""
        n, columns, count = self.n, self.columns, samples.t.size
        a = u[:, :n]
        X = np.zeros((count, u.shape[1], columns))
        X[:, :n] = self._slopes[:, :columns].transpose(2, 0, 1)
        for i, k, j, slope in self.seeded_masses:
            X[:, i, j] -= slope * a[:, k]
        r = n
        for held in found.held:
            _subtract(X[:, r], held.drift, held.row, a)
            r += 1
        F = {}
        for k in self._hard():
            stuck = mode[k] == STICK
            first = r
            for row, drift in zip(found.rows[k], found.drift[k], strict=True):
                _subtract(X[:, r], drift, row, a)
                X[:, r] *= stuck[:, None]
                r += 1
            F[k] = slice(first, r)
        by = inverse @ X
        rates = found.dense(found.rate_slopes, self.n_z).transpose(2, 0, 1)
        rates = rates[..., :columns] + rates[..., columns:] @ by[:, n:]
        for known in (found.N, found.limit):
            known.update({k: _resolved(dual, by[:, n:], columns) for k, dual in known.items()})
        held_by = {k: np.where(mode[k] == STICK, self._forces[self.rows(k)], 0.0).T for k in F}
        friction = {k: (held_by[k], by[:, own]) for k, own in F.items()}
        return Field(
            found=found, v=samples.v.T, a=a, a_slopes=by[:, :n], rate=found.rate.T, rate_slopes=rates, F=friction
        )

    # ---- what is free to move

    def projector(self, found: Found, stuck: list[int], i: int = 0) -> tuple[Floats, Floats, Floats]:
        """Inverse mass of what is free to move, and for rows that stick B and D^-1 of :class:`Equations`."""
        rows = [held.row for held in found.held] + [row for k in stuck for row in found.rows[k]]
        K = self._matrix(rows, found.force.shape[1], i, self.M)
        first = self.n + len(found.held)
        return K[: self.n, : self.n], K[: self.n, first:], -K[first:, first:]

    def _matrix(self, rows: list[Row], count: int, i: int, M: Floats) -> Floats:
        """Inverse of [[M, W], [W^T, 0]] at time number i."""
        n = self.n
        K = np.zeros((n + len(rows), n + len(rows)))
        K[:n, :n] = M
        for r, row in enumerate(rows):
            line = np.zeros((count, n))
            _fill(line, row)
            K[n + r, :n] = K[:n, n + r] = line[i]
        return np.asarray(np.linalg.pinv(K, rcond=1e-12, hermitian=True))

    def settled(self, found: Found, S: Floats) -> Floats:
        """Derivatives of a start that is moved the least onto the constraints, as the run's is."""
        K = self._matrix([held.row for held in found.held], 1, 0, self.weights)
        B, n = K[: self.n, self.n :], self.n
        moved = S.copy()
        for first, duals in ((0, [held.value for held in found.held]), (n, [held.rate for held in found.held])):
            slopes = whole(duals, 1, self.columns)[1][0]
            moved[first : first + n] -= B @ total(slopes, moved, self.n_y)
        if self._starts_elsewhere() and moved[:n].any():
            raise SceneError(
                "sensitivities: the start was moved to satisfy the joints, and a parameter changes positions there:"
                " only parameters that leave positions alone have derivatives then; declare a start that fits"
            )
        return moved

    def _starts_elsewhere(self) -> bool:
        """Whether the declared start does not satisfy the joints."""
        start, held = self.piece.mechanics.start, self.piece.rows()
        pairs = ((start.q, held.q[:, 0]), (start.v, held.v[:, 0]))
        begins = self.piece.t_start == start.t
        return begins and any(np.abs(a - b).max(initial=0.0) > 1e-9 * np.abs(b).max(initial=1e-300) for a, b in pairs)


def _fill(line: Floats, row: Row) -> None:
    """A row of coefficients into (n_t, n)."""
    for i, c in row:
        line[:, i] += c.value if isinstance(c, Dual) else c


def _subtract(line: Floats, drift: Dual, row: Row, a: Floats) -> None:
    """Less the slopes (n_t, columns) of drift + row . a at fixed a."""
    for j, slope in drift.slopes.items():
        line[:, j] -= slope
    for i, c in row:
        for j, slope in c.slopes.items() if isinstance(c, Dual) else ():
            line[:, j] -= slope * a[:, i]


def _resolved(dual: Dual, by: Floats, columns: int) -> Dual:
    """A value that depends on reactions, with its slopes by what these depend on; ``by`` (n_t, n_u, columns)."""
    slopes = {j: slope for j, slope in dual.slopes.items() if j < columns}
    for j, slope in dual.slopes.items():
        if j >= columns:
            for i in range(columns):
                slopes[i] = slopes.get(i, 0.0) + slope * by[:, j - columns, i]
    return Dual(value=dual.value, slopes=slopes)


def _inverted(A: Floats) -> Floats:
    """Inverse matrices; of least norm where constraints depend on one another."""
    if A.shape[0] and A.shape[1] and np.linalg.matrix_rank(A[0], tol=1e-11 * np.abs(A[0]).max()) == A.shape[1]:
        try:
            return np.asarray(np.linalg.inv(A))
        except np.linalg.LinAlgError:
            pass
    return np.asarray(np.linalg.pinv(A, rcond=1e-12))
