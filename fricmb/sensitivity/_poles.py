"""Poles of friction and of directions of slip: which steps of the variational equations they are near to."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.problem import OPEN, SLIP, Floats, Ints
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._found import whole
from fricmb.sensitivity._landings import Rests
from fricmb.sensitivity._phases import Phases

#: Slip speeds that change by more in a step may be near a pole of friction.
_DOUBLES = 2.0
#: Pieces of a step in each of which slip is taken to change evenly.
_PIECES = 4


class Poles:
    """Where slip in several directions is near rest, its direction g/|g| has a pole near in complex time.

    Under a law with states a contact that holds creeps: its slip oscillates about rest and misses it by little, again
    and again, each time within a step of the run.  Laws without states that are smooth are regular at rest.

    Parameters
    ----------
    equations : Equations
    phases : Phases
    sample : callable
        Dense output of the run.
    rests : list
        Where slip under rigid friction begins and ends: steps are graded there (:func:`._mesh.graded`).
    """

    def __init__(self, equations: Equations, phases: Phases, sample: Any, rests: Rests) -> None:
        self.equations, self.phases, self.sample = equations, phases, sample
        self.graded = {k: begins | ends for k, begins, ends in rests}
        several = [(k, one) for k, one in equations.contacts.items() if one.d > 1]
        self.wide = [k for k, one in several if not one.smooth or one.law.n_states(one.d) > 0]
        self.speed = self._speeds() if self.wide else {}
        #: Of normal forces that are roots: stretches in which they act, and when they set in and end.
        self.pressed: list[tuple[Any, Floats]] = []
        for shut in (phases.mode[k] != OPEN for k, one in equations.contacts.items() if one.branches):
            self.pressed.append((shut, phases.t[np.diff(np.concatenate([[False], shut, [False]]).astype(int)) != 0]))

    def _speeds(self) -> dict[int, float]:
        """What slip is the difference of, by contact: errors of the run count by that, where a ball rolls as well."""
        e, phases, t = self.equations, self.phases, self.phases.t[:-1]
        found = e.said(self.sample(t), phases.mode, phases.sign)
        rows = {k: whole(found.g[k], t.size, e.columns)[1][..., e.n : 2 * e.n] for k in self.wide}
        return {k: float((np.abs(row) @ phases.speed).max()) for k, row in rows.items()}

    def doubling(self, t: Floats, h: Floats, phase: Ints, contacts: list[int]) -> Any:
        """Steps (n_t,) in which a slip speed of contacts more than doubles or halves.

        Friction that depends on it may have a pole at a slip speed of little less than 0.
        """
        found = np.zeros(t.size, dtype=bool)
        if contacts:
            g = self.sample(np.concatenate([t, t + h])).g
            for k in contacts:
                r = np.linalg.norm(g[self.equations.rows(k)], axis=0).reshape(2, -1)
                found |= (self.phases.mode[k, phase] == SLIP) & (r.max(axis=0) > _DOUBLES * r.min(axis=0))
        return found

    def ellipses(self, t: Floats, h: Floats, phase: Ints, share: float) -> Floats:
        """Sums (n_t,) of half axes of Bernstein's ellipse of a step through the nearest pole, inf where there is none.

        ``share``: of the speeds that slip is the difference of, what is as good as rest: directions of less are errors.
        """
        found, e = np.full(t.size, np.inf), self.equations
        for own, edges in self.pressed:
            if edges.size:
                found = np.where(own[phase], np.minimum(found, _through_edges(t, h, edges)), found)
        if not self.wide:
            return found
        shares = np.linspace(0.0, 1.0, _PIECES + 1)
        g = self.sample((t + h * shares[:, None]).ravel()).g.reshape(-1, shares.size, t.size)
        for k in self.wide:
            own = g[e.rows(k)]
            slides = np.linalg.norm(own, axis=0).max(axis=0) > share * self.speed[k]
            if k in self.graded:
                slides &= (self.phases.mode[k, phase] == SLIP) & ~self.graded[k][phase]
            found = np.where(slides, np.minimum(found, _through_zeros(own)), found)
        return found


def _through_edges(t: Floats, h: Floats, edges: Floats) -> Floats:
    """Sums of half axes (n_t,) of ellipses with foci at the ends of a step, through the nearest of times outside it."""
    near = np.searchsorted(edges, t + 0.5 * h)
    before, behind = (np.append(np.append(-np.inf, edges), np.inf)[near + i] for i in (0, 1))
    x = 1.0 + 2.0 * np.maximum(np.minimum(t - before, behind - t - h), 0.0) / h
    return np.asarray(x + np.sqrt(x * x - 1.0))


def _through_zeros(g: Floats) -> Floats:
    """Sums of half axes (n_t,) of ellipses with foci at the ends of a step, through zeros of |g|^2, g even in pieces.

    ``g`` (d, pieces + 1, n_t): with g = g_0 + s g' the zeros are those of a + 2 b s + c s^2.
    """
    first, change = g[:, :-1], np.diff(g, axis=1)
    a, b, c = (np.einsum("i...,i...->...", *two) for two in ((first, first), (first, change), (change, change)))
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (-b + 1j * np.sqrt(np.maximum(a * c - b * b, 0.0))) / c
        pieces = np.arange(s.shape[0])[:, None]
        x = 2.0 * (pieces + s) / s.shape[0] - 1.0
        root = np.sqrt(x * x - 1.0)
        rho = np.maximum(np.abs(x + root), np.abs(x - root))
    return np.asarray(np.nan_to_num(rho, nan=np.inf, posinf=np.inf).min(axis=0))
