"""The variational equations over the stretches of a run: maps of steps that are fine enough."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.integrate.problem import STICK, Floats, Ints
from fricmb.sensitivity._collocation import Formula, radau, step_maps
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._found import whole
from fricmb.sensitivity._landings import at_rest, left_out
from fricmb.sensitivity._phases import BEFORE, Phases
from fricmb.sensitivity._poles import Poles
from fricmb.sensitivity._solved_steps import Step

#: Stages of the steps, and of the two formulas whose difference tells how fine they have to be.
STAGES, COARSE = 7, (2, 3)
#: Rounds of dividing steps, into so many parts at most; numbers that are held at once.
_ROUNDS, _PARTS, _HELD = 16, 8, 1_000_000
#: A step is divided on while its error falls by this factor each time; one that is this much too long or less is
#: divided without being looked at again.
_FALLS, _NEARLY = 0.5, 2.0
#: Logarithm of the volume of states that a coarse step may lose; where a step, of length 1, is looked at for its begin.
_LOST, _BEGIN = 0.5, 1e-7
#: Parts of a step whose directions of slip tell, by a polynomial, that at the begin; weights for that.
_AFTER = np.array([0.25, 0.5, 0.75, 1.0])
_TO_BEGIN = np.array([4.0, -6.0, 4.0, -1.0])
#: Ellipses of poles that may lie before the first node of the coarse formulas and be seen by none.
_UNSEEN = 2.0
#: Steps shorter than this, relative to 1 or the time, are none beside those that are solved.
_ROUND = 1e-15


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """Steps in time order: begins, lengths, and stretches they lie in.

    ``left_out`` (n_k,): time before the end of a stretch in which slip in two directions ends that is not used, else 0.
    ``solved``: by number those steps that bring their own slopes.
    """

    t: Floats
    h: Floats
    phase: Ints
    left_out: Floats
    solved: dict[int, Step]


class Stepper:
    """Maps of steps of the variational equations.

    Parameters
    ----------
    equations : Equations
    phases : Phases
    sample : callable
        Dense output of the run.
    """

    def __init__(self, equations: Equations, phases: Phases, sample: Any) -> None:
        self.equations, self.phases, self.sample = equations, phases, sample
        self.varying = [k for k, contact in equations.contacts.items() if contact.depends_on_speed()]
        self.sets_out = np.zeros(phases.t.size - 1, dtype=bool)
        self.rests = at_rest(equations, phases, sample)
        self.turning = [(k, begins) for k, begins, _ in self.rests if equations.contacts[k].d > 1]
        self.poles = Poles(equations, phases, sample, self.rests)
        for k, begins, _ in self.rests:
            if k in self.varying and equations.contacts[k].d == 1:
                self.sets_out |= begins

    def maps(self, formula: Formula, t: Floats, h: Floats, phase: Ints) -> Floats:
        """Maps of steps from t (n_t,) on, each within one stretch."""
        e = self.equations
        found = []
        for own in self._parts(formula.c.size, t.size):
            slopes, rates = self._slopes(formula.c, t[own], h[own], phase[own])
            found.append(step_maps(formula, h[own], slopes, rates, e.n, e.n_y))
        return np.concatenate(found) if found else np.zeros((0, e.n_y, e.columns - 1))

    def each(self, mesh: Mesh) -> Iterator[Floats]:
        """Maps (n_y, n_y + n_p) of the steps of a mesh in turn, of which few are held at once."""
        formula = radau(STAGES)
        for own in self._parts(STAGES, mesh.t.size):
            maps = self.maps(formula, mesh.t[own], mesh.h[own], mesh.phase[own])
            for k in range(own.start, own.start + len(maps)):
                yield mesh.solved[k].map() if k in mesh.solved else maps[k - own.start]

    def misses(self, t: Floats, h: Floats, phase: Ints, scale: Floats, near: Any) -> tuple[Floats, Any]:
        """How far the maps of two coarse formulas are apart (n_t,), and where steps are so long that this says nothing.

        What vibrates many times in a step both damp out, and agree: there the volume of states is lost, which changes
        like the exponential of the trace of the slopes (Liouville).  Where slip sets out, friction may fall within a
        slip speed that is passed before the first node, and a pole that is ``near`` (n_t,) may be: see :meth:`_layers`.
        """
        low, high = (radau(s) for s in COARSE)
        e, c = self.equations, np.concatenate([low.c[:-1], high.c])
        found, blind = [], []
        for own in self._parts(c.size, t.size):
            slopes, rates = self._slopes(c, t[own], h[own], phase[own])
            at = [*range(low.c.size - 1), c.size - 1]
            less = step_maps(low, h[own], slopes[:, at], rates[:, at], e.n, e.n_y)
            maps = step_maps(high, h[own], slopes[:, low.c.size - 1 :], rates[:, low.c.size - 1 :], e.n, e.n_y)
            off, square, pulls = less - maps, maps[..., : e.n_y].copy(), slopes[..., e.n : 2 * e.n].copy()
            for j, across in self._across(t[own], h[own], phase[own]):
                off[j] -= off[j][:, e.n : 2 * e.n] @ across
                square[j] -= square[j][:, e.n : 2 * e.n] @ across[:, : e.n_y]
                square[j][e.n : 2 * e.n] += across[:, : e.n_y]
                pulls[j] -= pulls[j] @ across[:, e.n : 2 * e.n]
            found.append(_difference(off, maps, scale, e.n_y))
            kept = np.linalg.slogdet(square)[1]
            traces = np.trace(pulls, axis1=2, axis2=3) + np.trace(rates[..., 2 * e.n : e.n_y], axis1=2, axis2=3)
            blind.append(kept < h[own] * (traces[:, low.c.size - 1 :] @ high.A[-1]) - _LOST)
        off = np.concatenate(found)
        first = np.flatnonzero((self.sets_out[phase] & (t == self.phases.t[phase])) | near)
        if first.size:
            off[first] = np.maximum(off[first], self._layers(t[first], h[first], phase[first], scale))
        return off, np.concatenate(blind)

    def _across(self, t: Floats, h: Floats, phase: Ints) -> Iterator[tuple[int, Floats]]:
        """Steps with which slip in several directions sets out; what is across it of velocities (n, n_y + n_p).

        Its own derivative is along it, because it was 0 before.  What is across would vanish at a rate like 1/r, of
        which no two formulas say the same, and in which steps of any length lose as much volume.
        """
        e = self.equations
        for k, begins in self.turning:
            first = np.flatnonzero(begins[phase] & (t == self.phases.t[phase]))
            if not first.size:
                continue
            after, mode = t[first] + h[first] * _AFTER[:, None], self.phases.mode[:, phase[first]]
            found = e.field(self.sample(after[0]), mode, self.phases.sign[:, phase[first]]).found
            g = self.sample(after.ravel()).g[e.rows(k)].reshape(-1, *after.shape)
            n = np.einsum("a,dat->td", _TO_BEGIN, g / (np.linalg.norm(g, axis=0) + 1e-300))
            n /= np.linalg.norm(n, axis=1)[:, None] + 1e-300
            slopes = whole(found.g[k], first.size, e.columns)[1][..., :-1]
            for i, j in enumerate(first.tolist()):
                held = [c for c, contact in e.contacts.items() if not contact.smooth and mode[c, i] == STICK]
                B = e.projector(found, [*held, k], i)[1][:, -len(n[i]) :]
                yield j, B @ (slopes[i] - np.outer(n[i], n[i] @ slopes[i]))

    def _layers(self, t: Floats, h: Floats, phase: Ints, scale: Floats) -> Floats:
        """How far slopes at the begin of steps (n_t,) are, over the step, from what its nodes tell of them."""
        e, high = self.equations, radau(COARSE[1])
        slopes, rates = self._slopes(np.append(_BEGIN, high.c), t, h, phase)
        told = np.array([np.prod([c / (c - own) for c in high.c if c != own]) for own in high.c])
        off = np.zeros((t.size, e.n_y, e.columns - 1))
        off[:, e.n : 2 * e.n] = slopes[:, 0] - np.einsum("s,ts...->t...", told, slopes[:, 1:])
        off[:, 2 * e.n :] = rates[:, 0] - np.einsum("s,ts...->t...", told, rates[:, 1:])
        off *= h[:, None, None]
        found: Floats = (np.abs(off[..., : e.n_y]) * scale / scale[:, None]).max(axis=(1, 2))
        return found

    def _parts(self, s: int, count: int) -> list[slice]:
        """Steps that are done at once."""
        e = self.equations
        room = max(1, _HELD // (s * e.n_y * (e.columns + s * e.n_y)))
        return [slice(i, i + room) for i in range(0, count, room)]

    def _slopes(self, c: Floats, t: Floats, h: Floats, phase: Ints) -> tuple[Floats, Floats]:
        """Slopes of accelerations and of rates of laws' states at nodes c (s,) of steps: (n_t, s, rows, columns)."""
        e, s = self.equations, c.size
        # the end of a stretch has not seen yet what switches there
        ends = self.phases.t[phase + 1]
        ends = ends - BEFORE * np.maximum(1.0, np.abs(ends))
        times = np.minimum(t[:, None] + h[:, None] * c, np.maximum(ends, t)[:, None]).ravel()
        at = np.repeat(phase, s)
        field = e.field(self.sample(times), self.phases.mode[:, at], self.phases.sign[:, at])
        slopes = field.a_slopes[..., :-1].reshape(t.size, s, e.n, e.columns - 1)
        return slopes, field.rate_slopes[..., :-1].reshape(t.size, s, e.n_z, e.columns - 1)


def mesh_of(stepper: Stepper, scale: Floats, rtol: float, solved: Sequence[Step] = ()) -> Mesh:
    """Steps over all stretches, so fine that the error of each is within the tolerance; ``solved``: some of them.

    How far the coarse formulas are apart tells the size of h over the time scale, from which the error of the fine one
    follows: as h to their orders where slopes are like exponentials, and near a pole, at a distance rho of the step (of
    Bernstein's ellipse), as rho to minus their orders.
    """
    fine, coarse = radau(STAGES), radau(COARSE[0])
    small = 0.1 * max(rtol, 1e-13)
    entire = coarse.error * (small / fine.error) ** ((coarse.order + 1) / (fine.order + 1))
    near_pole = min(entire, small ** (coarse.order / fine.order))
    rest = left_out(stepper.equations, stepper.phases, stepper.rests)
    t, h, phase = beside(solved, *graded(stepper.phases.t, rest))
    kept: list[tuple[Floats, Floats, Ints]] = []
    before = np.full(t.size, np.inf)
    for number in range(_ROUNDS):
        if not t.size:
            break
        rho = stepper.poles.ellipses(t, h, phase, small)
        off, blind = stepper.misses(t, h, phase, scale, rho < _UNSEEN)
        steep = stepper.poles.doubling(t, h, phase, stepper.varying)
        by_pole = small * rho ** (fine.order - coarse.order)
        limit = np.minimum(np.where(steep, near_pole, entire), by_pole)
        steep |= by_pole < entire
        # what does not fall when steps are divided is round-off of the dense output, which no mesh removes
        bad = (((off > limit) & (off < _FALLS * before)) | blind) & (number < _ROUNDS - 1)
        kept.append((t[~bad], h[~bad], phase[~bad]))
        ratio = np.where(blind[bad], _PARTS, (off[bad] / limit[bad]) ** (1.0 / (coarse.order + 1)))
        parts = np.clip(np.ceil(1.1 * ratio), 2, _PARTS).astype(np.int64)
        told = ~blind[bad] & ~steep[bad] & ((number > 0) | (off[bad] < 1.0))
        before = np.repeat(np.where(told, off[bad], np.inf), parts)
        sure = np.repeat((ratio < _NEARLY) & ~steep[bad], parts)
        t, h, phase = _divided(t[bad], h[bad], phase[bad], parts)
        kept.append((t[sure], h[sure], phase[sure]))
        t, h, phase, before = t[~sure], h[~sure], phase[~sure], before[~sure]
    begins = np.array([step.t for step in solved])
    kept.append((begins, np.array([step.h for step in solved]), stepper.phases.of(begins)))
    t, h, phase = (np.concatenate([part[i] for part in kept]) for i in range(3))
    order = np.lexsort((t, phase))
    places = np.argsort(order)[t.size - len(solved) :].tolist()
    t, h, phase = t[order], h[order], phase[order]
    return Mesh(t=t, h=h, phase=phase, left_out=rest, solved=dict(zip(places, solved, strict=True)))


def beside(solved: Sequence[Step], t: Floats, h: Floats, phase: Ints) -> tuple[Floats, Floats, Ints]:
    """What is left of steps beside some that are solved."""
    for step in solved:
        end = step.t + step.h
        begins = np.where((t >= step.t) & (t < end), end, t)
        h = t + h - begins
        left = h > _ROUND * np.maximum(1.0, np.abs(end))
        t, h, phase = begins[left], h[left], phase[left]
    return t, h, phase


def _divided(t: Floats, h: Floats, phase: Ints, parts: Ints) -> tuple[Floats, Floats, Ints]:
    """Steps in equal parts."""
    first = np.repeat(np.cumsum(parts) - parts, parts)
    inside = np.arange(parts.sum()) - first
    h = np.repeat(h / parts, parts)
    return np.repeat(t, parts) + inside * h, h, np.repeat(phase, parts)


def graded(edges: Floats, rest: Floats) -> tuple[Floats, Floats, Ints]:
    """Begins, lengths and stretches of the first steps.

    Where slip in two directions ends its direction turns ever faster towards r = 0: steps fall by halves, to what is
    left out; what sticks is projected (:mod:`._transitions`).
    """
    plain = np.flatnonzero(rest == 0.0)
    t, h, phase = [edges[plain]], [np.diff(edges)[plain]], [plain]
    for k in np.flatnonzero(rest > 0.0):
        length = edges[k + 1] - edges[k]
        count = int(np.ceil(np.log2(max(length / rest[k], 2.0))))
        knots = edges[k + 1] - length * np.append(0.5 ** np.arange(count + 1), 0.0)
        t.append(knots[:-1])
        h.append(np.diff(knots))
        phase.append(np.full(count + 1, k))
    return np.concatenate(t), np.concatenate(h), np.concatenate(phase).astype(np.int64)


def _difference(off: Floats, maps: Floats, scale: Floats, n_y: int) -> Floats:
    """Differences of maps (n_t,) relative to the sizes of states, of parameters to the largest of their column."""
    state = np.abs(off[..., :n_y]) * scale / scale[:, None]
    given, own = np.abs(off[..., n_y:]) / scale[:, None], np.abs(maps[..., n_y:]) / scale[:, None]
    largest = own.max(axis=(0, 1), initial=0.0) + 1e-300
    found: Floats = np.nan_to_num(
        np.maximum(state.max(axis=(1, 2)), (given / largest).max(axis=(1, 2), initial=0.0)), nan=np.inf
    )
    return found
