"""Slip in several directions that sets out from rest: its first stretch is solved anew, with the map of derivatives.

At a break-away under friction that is continuous there (one coefficient, or one that falls with the slip speed) nothing
accelerates yet: r grows like the square of time, and the direction n of slip obeys r n' = A(n, t) - n n^T A with
A(n_0) = 0.  There is one solution, as smooth as loads are, but what is beside it is pulled there at a rate of 1/t^2.  A
dense output that is off by a tolerance knows nothing of n where r is as small; slopes that hang on n/r do not forgive
that.  Radau IIA collocation with accelerations as unknowns has g = h sum a_ij g'_j at its nodes to all digits, however
small that is: Newton's method finds it from a guess, and its matrix makes the map of derivatives as well, which is then
exactly that of what was solved.  The next steps are as long as slip has lasted, up to where the run has the same
direction.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fricmb.errors import IntegrationError
from fricmb.integrate.problem import STICK, Codes, Floats
from fricmb.sensitivity._collocation import Formula, radau, stage_system
from fricmb.sensitivity._equations import Equations, Field
from fricmb.sensitivity._found import whole
from fricmb.sensitivity._landings import Rests
from fricmb.sensitivity._phases import Phases
from fricmb.sensitivity._solved_steps import Solved, State, Step, at_nodes

#: Stages, and those of the formula that tells how exact they are.
_STAGES, _FEWER = 7, 5
#: Most steps of Newton's method; changes of slip, in shares of it, at which it has converged, and below which one that
#: does not fall any more is round-off.
_NEWTON, _SAME, _ROUND = 15, 1e-12, 1e-6
#: Steps of Newton's method behind which slip that still changes by this share of itself is not going to be found.
_LOST, _STRAYS = 4, 0.3
#: Steps of the run whose longest tells the length of the first one, as a multiple; a step that is too long is divided
#: by this, so often at most, a further one so often; most steps.
_NEAR, _LONGER, _SHORTER, _TRIES, _FURTHER, _MOST = 8, 2.0, 4.0, 20, 3, 60
#: Of a stretch in which slip also ends, the part that is followed from its begin at most.
_BEFORE = 0.5
#: Of slip that grows evenly what it has doubled to in twice the time, and of that which grows like a square: between.
_SQUARE = 2.8
#: Tolerances by which the direction of slip may be off in the run, where it is followed from there on.
_RUNS = 10.0


def set_outs(e: Equations, phases: Phases, rests: Rests, stops: Floats) -> Iterator[tuple[int, list[int], float]]:
    """Stretches that begin with slip in several directions out of stick, contacts, and up to when they are followed.

    ``stops``: times at which anything happens.
    """
    begun: dict[int, list[int]] = {}
    for k, begins, _ in rests:
        if e.contacts[k].d > 1:
            for before in np.flatnonzero(begins[1:] & (phases.mode[k, :-1] == STICK)).tolist():
                begun.setdefault(before + 1, []).append(k)
    stops = np.union1d(stops, phases.t[-1:])
    for phase, contacts in sorted(begun.items()):
        t = float(phases.t[phase])
        end = float(stops[np.searchsorted(stops, t, side="right")])
        last = int(np.searchsorted(phases.t, end)) - 1
        lands = any(ends[last] for k, _, ends in rests if e.contacts[k].d > 1)
        yield phase, contacts, t + _BEFORE * (end - t) if lands else end


class SettingOut:
    """Solves the first stretches of slip in several directions that begins from rest.

    Parameters
    ----------
    equations : Equations
    phases : Phases
    sample : callable
        Dense output of the run.
    scale : (n_y,)
        Sizes of states.
    rtol : float
    """

    def __init__(self, equations: Equations, phases: Phases, sample: Any, scale: Floats, rtol: float) -> None:
        self.equations, self.phases, self.sample, self.scale, self.rtol = equations, phases, sample, scale, rtol
        self.limit = max(0.1 * rtol, 1e-13) ** 0.75
        self.notes: list[str] = []

    def steps(self, phase: int, contacts: Sequence[int], end: float) -> list[Step]:
        """Steps from the begin of a stretch in which contacts set out, up to ``end`` at most; none where none is."""
        t = float(self.phases.t[phase])
        start = self.sample(np.array([t]))
        y = np.concatenate([start.q, start.v, start.z])[:, 0]
        state = State(t=t, y=y, g={k: np.zeros(self.equations.contacts[k].d) for k in contacts})
        found: list[Step] = []
        near = np.diff(self.phases.t[phase : phase + _NEAR + 1])
        h, tries = min(end - t, _LONGER * float(near.max())), _TRIES
        while len(found) < _MOST:
            one = None
            while one is None and tries > 0:
                one, h, tries = self._step(state, h, phase), h / _SHORTER, tries - 1
            if one is None:
                break
            step, state = one
            found.append(step)
            rest = end - state.t
            if self._follows(state) or rest <= _SAME * (end - t):
                break
            h, tries = min(state.t - t, rest), _FURTHER
        if not found:
            self._say_lost(t, float(near[0]), contacts)
        return found

    def _say_lost(self, t: float, h: float, contacts: Iterable[int]) -> None:
        """A note of slip that sets out like a square of time and is not found; what grows evenly the run knows."""
        seen = self.sample(np.array([t + 0.5 * h, t + h])).g
        for k in contacts:
            half, whole_step = _lengths(seen[self.equations.rows(k)])
            if whole_step > _SQUARE * half:
                name = self.equations.names.contacts[k]
                self.notes.append(
                    f"at t = {t:.10g} slip of contact {name!r} sets out with no acceleration,"
                    " and the direction in which it does is not found: derivatives of what follows are not sound"
                )

    def _follows(self, state: State) -> bool:
        """Whether the run has the same slip."""
        seen = self.sample(np.array([state.t])).g
        off = [np.linalg.norm(seen[self.equations.rows(k), 0] - g) / np.linalg.norm(g) for k, g in state.g.items()]
        return bool(max(off) <= _RUNS * self.rtol)

    def _step(self, state: State, h: float, phase: int) -> tuple[Step, State] | None:
        """One step, and where it ends; None where Newton's method does not converge or it is too long."""
        e = self.equations
        try:
            with np.errstate(all="ignore"):
                coarse = self._solved(radau(_FEWER), state, h, phase)
                fine = None if coarse is None else self._solved(radau(_STAGES), state, h, phase, coarse)
        except (IntegrationError, np.linalg.LinAlgError):  # a step so long that it strays to where nothing holds
            return None
        if fine is None or coarse is None:
            return None
        found, rough = (Step(t=state.t, h=h, slopes=one.slopes, n=e.n, n_y=e.n_y) for one in (fine, coarse))
        return (found, fine.end) if self._agree(state, fine, coarse, found, rough) else None

    def _agree(self, state: State, fine: Solved, coarse: Solved, found: Step, rough: Step) -> bool:
        """Whether two formulas say the same, of slip from its begin on and of the map of states."""
        others = coarse.slip_at(radau(_STAGES).c, state.g, found.h)
        for k, g in fine.slip.items():
            if not (_lengths(g - others[k]) <= self.limit * _lengths(g)).all():
                return False
        n_y, off = found.n_y, found.map() - rough.map()
        held = off[:, :n_y] @ self._without_slip(fine, state)
        return bool((np.abs(held) * self.scale / self.scale[:, None]).max() <= self.limit)

    def _without_slip(self, fine: Solved, state: State) -> Floats:
        """What takes away the slip of those that set out (n_y, n_y): where it begins, derivatives have none.

        Later what they have across it is lost at once, which no two formulas do in the same way.
        """
        e = self.equations
        found = np.eye(e.n_y)
        first = whole([x for k in state.g for x in fine.field.found.g[k]], _STAGES, e.columns)[1][0]
        found[e.n : 2 * e.n] -= self._pushes(fine.field, list(state.g), fine.mode, 0) @ first[:, : e.n_y]
        return found

    def _solved(
        self, formula: Formula, state: State, h: float, phase: int, near: Solved | None = None
    ) -> Solved | None:
        """The nodes of a step; None if nothing is found.  ``near``: those of another formula."""
        e, s = self.equations, formula.c.size
        base = self.sample(state.t + h * formula.c)
        mode: Codes = np.repeat(self.phases.mode[:, [phase]], s, axis=1)
        sign: Floats = np.repeat(self.phases.sign[:, [phase]], s, axis=1)
        if near is None:
            slip = self._guessed(base.g, formula, state, h)
            K = self._rates_guessed(e.field(base, mode, sign, slip), formula, state, h, slip, mode[:, 0])
        else:
            slip, K = near.slip_at(formula.c, state.g, h), near.rates_at(formula.c)
        last = np.inf
        for number in range(_NEWTON):
            q, v, z = at_nodes(formula, state.y, h, K, e.n)
            field = e.field(replace(base, q=q, v=v, z=z), mode, sign, slip)
            slopes = np.concatenate([field.a_slopes, field.rate_slopes], axis=1)[..., :-1]
            matrix = stage_system(formula, np.array([h]), slopes[None], e.n, e.n_y)[0]
            if not np.isfinite(matrix).all():
                return None
            residual = np.concatenate([field.a, field.rate], axis=1) - K
            K = K + np.linalg.solve(matrix, residual.ravel()).reshape(K.shape)
            rates = {k: self._slip_rates(field, k, K, v) for k in slip}
            made = {k: state.g[k][:, None] + h * (formula.A @ own).T for k, own in rates.items()}
            off = max(float((_lengths(made[k] - g) / (_lengths(made[k]) + 1e-300)).max()) for k, g in slip.items())
            slip = made
            if off <= _SAME or (off < _ROUND and off > 0.5 * last):
                y = np.concatenate([x[:, -1] for x in at_nodes(formula, state.y, h, K, e.n)])
                end = State(t=state.t + h, y=y, g={k: g[:, -1] for k, g in slip.items()})
                return Solved(slopes=slopes, end=end, K=K, slip=slip, rates=rates, field=field, mode=mode[:, 0])
            if number >= _LOST and off > _STRAYS:
                return None
            last = off
        return None

    def _guessed(self, seen: Floats, formula: Formula, state: State, h: float) -> dict[int, Floats]:
        """Slip (d, s) at the nodes of a step by contact: first along that at its end, by a power of time."""
        found = {}
        for k, begin in state.g.items():
            g = seen[self.equations.rows(k)]
            if not begin.any():
                middle = formula.c.size // 2
                powers = np.log(_lengths(g[:, -1]) / (_lengths(g[:, middle]) + 1e-300) + 1e-300)
                power = np.clip(powers / -np.log(formula.c[middle]), 1.0, 2.0)
                g = g[:, -1:] * formula.c ** np.round(power)
            found[k] = g
        return found

    def _slip_rates(self, field: Field, k: int, K: Floats, v: Floats) -> Floats:
        """Relative accelerations (s, d) of a contact under accelerations and rates K (s, n + n_z)."""
        e = self.equations
        along = np.zeros((len(K), e.columns))
        along[:, : e.n], along[:, e.n : e.n_y], along[:, -1] = v.T, K, 1.0
        slopes = whole(field.found.g[k], len(K), e.columns)[1]
        return np.asarray(np.einsum("sdc,sc->sd", slopes, along))

    def _rates_guessed(
        self, field: Field, formula: Formula, state: State, h: float, slip: dict[int, Floats], mode: Codes
    ) -> Floats:
        """Accelerations and rates (s, n + n_z) with those that friction would have to add for slip to be what it is."""
        K = np.concatenate([field.a, field.rate], axis=1)
        lacks = []
        for k, g in slip.items():
            rates = np.linalg.solve(formula.A, (g - state.g[k][:, None]).T) / h
            lacks.append(rates - self._slip_rates(field, k, K, field.v.T))
        for i, lack in enumerate(np.concatenate(lacks, axis=1)):
            K[i, : self.equations.n] += self._pushes(field, list(slip), mode, i) @ lack
        return K

    def _pushes(self, field: Field, contacts: list[int], mode: Codes, i: int) -> Floats:
        """Accelerations (n, d) that make those of slip of contacts 1 each, others held as they are."""
        e = self.equations
        held = [k for k, contact in e.contacts.items() if not contact.smooth and mode[k] == STICK]
        wide = sum(e.contacts[k].d for k in contacts)
        return e.projector(field.found, [*held, *contacts], i)[1][:, -wide:]


def _lengths(g: Floats) -> Any:
    """Of vectors (d, ...)."""
    return np.linalg.norm(g, axis=0)
