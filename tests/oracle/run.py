"""From transition to transition."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import DOP853, LSODA, Radau
from scipy.optimize import brentq, minimize_scalar

from .instant import decide
from .loads import settled
from .motion import Field
from .problem import OPEN, SLIP, STICK, Motion, NoLoad, OracleError, Problem, Transition
from .slow import leap

#: Slip speeds in two directions, over the scale, at which it is decided whether a contact sticks.
NEAR = 1e-9
LIMIT = 3000
#: Load of a contact, beside the forces that act, that is round-off.
NO_LOAD = 1e-12
#: Part of the run within which what happens happens at one instant.
SAME = 1e-11


class Run:
    """One run of the oracle."""

    def __init__(self, problem: Problem, rtol: float = 1e-11) -> None:
        self.p, self.rtol = problem, rtol
        self.n = problem.q.size
        self.motion = Motion(self.n)
        n_z = sum(c.n_z for c in problem.contacts)
        self.y = np.concatenate([problem.q, problem.v, np.zeros(n_z)]).astype(float)
        self.t = 0.0
        k = len(problem.contacts)
        self.modes, self.signs = [SLIP] * k, [1.0] * k
        self.tiny = 1e-12 * problem.scale
        self.ends = [*sorted(b for b in problem.breaks if 0.0 < b < problem.t_end), problem.t_end]
        self.end = self.ends[0]
        self.smooth = not any(c.force is None for c in problem.contacts)
        self.start: dict[int, np.ndarray] = {}
        self.slow = False

    def run(self) -> Motion:
        """All of it."""
        self.settle(first=True)
        for end in self.ends:
            self.end = end
            if self.t > 0.0:
                self.settle()
            while self.t < end:
                self.segment()
                if len(self.motion.events) > LIMIT:
                    raise OracleError("too many transitions")
        self.motion.last = self.y
        return self.motion

    # -- decisions --------------------------------------------------------------------------------------------------
    def field(self) -> Field:
        """The right-hand side in the present modes."""
        return Field(self.p, self.modes, self.signs, (self.t, self.end))

    def settle(
        self, first: bool = False, released: frozenset[int] = frozenset(), arrived: frozenset[int] = frozenset(),
        flipped: frozenset[int] = frozenset(), one_of: frozenset[int] = frozenset(),
    ) -> None:  # fmt: skip
        """New modes at this instant for all that is at rest."""
        p, field = self.p, self.field()
        t = min(max(self.t, field.low), field.high)
        g = field.speeds(t, self.y[: self.n], self.y[self.n : 2 * self.n])
        loads = field.loads(t, self.y[: self.n], self.y[self.n : 2 * self.n], np.zeros(self.n))
        before, self.start = list(zip(self.modes, self.signs, strict=True)), {}
        guess = self.accelerations(field, t) if field.reactive and not first else np.zeros(self.n)
        resting = []
        for i, (c, s) in enumerate(zip(p.contacts, field.rows, strict=True)):
            if c.force is not None:
                continue
            opened = c.reaction is None and (loads[i] < 0.0 or (loads[i] == 0.0 and not c.constant))
            if i in flipped:
                opened = self.modes[i] != OPEN
            if opened:
                self.modes[i] = OPEN
                continue
            near = self.tiny if c.d == 1 else self.tiny * 1e-1
            if self.modes[i] == STICK:  # at a break of loads it still is, but for the round-off of the way there
                near = 1e-7 * p.scale
            at_rest = np.abs(g[s]).max() <= near
            if i in arrived or at_rest or i in released | one_of:
                resting.append(i)
                self.modes[i] = STICK
            else:
                self.modes[i] = SLIP
                self.signs[i] = 1.0 if g[s.start] > 0.0 else -1.0
        if resting:
            self.choose(resting, released, one_of, t, guess)
        if not first:
            self.record(before)
        if self.start:
            self.begin()

    def accelerations(self, field: Field, t: float) -> np.ndarray:
        """In these modes; 0 where there are none, as behind the end of slip."""
        try:
            return field.evaluate(t, self.y)[0]
        except NoLoad:
            return np.zeros(self.n)

    def choose(
        self, resting: list[int], released: frozenset[int], one_of: frozenset[int], t: float, guess: np.ndarray
    ) -> None:
        """Modes of contacts at rest, and the velocity made exactly consistent; ``guess``: accelerations before."""
        p = self.p
        modes = [OPEN if i in resting else m for i, m in enumerate(self.modes)]
        moving = Field(p, modes, self.signs, (self.t, self.end))
        q, v = self.y[: self.n], self.y[self.n : 2 * self.n]
        Mi, D, _, W = moving.matrices(q)
        columns = np.concatenate([np.arange(moving.rows[i].start, moving.rows[i].stop) for i in resting])
        rows, at = [], 0
        for i in resting:
            rows.append(slice(at, at + p.contacts[i].d))
            at += p.contacts[i].d
        W, D = W[:, columns], D[np.ix_(columns, columns)]
        local = frozenset(resting.index(i) for i in released if i in resting)
        some = frozenset(resting.index(i) for i in one_of if i in resting)

        def under(loads: np.ndarray) -> tuple[Any, ...]:
            a, push, _, _ = moving.under(t, self.y, loads.tolist())
            b = moving.speed_up(t, self.y, a)[columns]
            found = self.consistent(D, b, resting, loads.tolist(), rows, local, some)
            push[columns] = found[0][1]
            return a + Mi @ (W @ found[0][1]), push, b, found

        def answer(loads: np.ndarray) -> np.ndarray:
            return np.array(moving.loads(t, q, v, under(loads)[0]))

        loads = np.array(moving.loads(t, q, v, guess))
        if moving.reactive:
            held = None if released or one_of else self.held(resting, t, answer)
            loads = settled(answer, loads) if held is None else held
        _, push, b, found = under(loads)
        if len({tuple(np.round(D @ f[1] + b, 9)) for f in found}) > 1:
            self.motion.ambiguous = True
        slips, F = found[0]
        # to exactly zero slip
        g = moving.speeds(t, q, v)[columns]
        self.y[self.n : 2 * self.n] -= Mi @ (W @ (np.linalg.pinv(D, rcond=1e-11, hermitian=True) @ g))
        for j, i in enumerate(resting):
            if j in slips:
                self.modes[i] = SLIP
                row = rows[j].start
                self.signs[i] = self.sign(moving, t, F[row], (D @ F + b)[row], columns[row])
                if p.contacts[i].d > 1:
                    self.start[i] = push

    def held(self, resting: list[int], t: float, answer: Callable[[np.ndarray], np.ndarray]) -> np.ndarray | None:
        """Loads with all at rest stuck, where these loads hold them: loads that friction brings have other answers too.

        A gear with losses that turns round may have a load under which it sticks, and a smaller one under which it
        slips; as everywhere the answer with the most contacts stuck is the one that counts.
        """
        modes = [STICK if i in resting else m for i, m in enumerate(self.modes)]
        stuck = Field(self.p, modes, self.signs, (self.t, self.end))
        try:
            a = stuck.evaluate(t, self.y)[0]
            loads = np.array(stuck.loads(t, self.y[: self.n], self.y[self.n : 2 * self.n], a))
            found = answer(loads)
        except OracleError:
            return None
        return loads if np.abs(found - loads).max() <= 1e-11 * max(np.abs(loads).max(), 1e-300) else None

    def sign(self, moving: Field, t: float, F: float, rate: float, column: int) -> float:
        """Which way slip of one direction sets out: against its friction, or where there is none as it is pushed."""
        if F != 0.0:
            return -1.0 if F > 0.0 else 1.0
        if rate == 0.0:  # as it will be pushed
            later = self.y.copy()
            step = 1e-6 * (self.end - t)
            a = moving.evaluate(t, self.y)[0]
            later[: self.n] += step * later[self.n : 2 * self.n]
            later[self.n : 2 * self.n] += step * a
            rate = float(moving.speed_up(t + step, later, moving.evaluate(t + step, later)[0])[column])
        return -1.0 if rate < 0.0 else 1.0

    def consistent(
        self, D: np.ndarray, b: np.ndarray, resting: list[int], loads: list[float], rows: list[slice],
        released: frozenset[int], one_of: frozenset[int],
    ) -> list[Any]:  # fmt: skip
        """Consistent sets under these loads; an error where there are none."""
        static, slip = [], []
        for i in resting:
            contact, N = self.p.contacts[i], max(loads[i], 0.0)
            assert contact.mu is not None
            assert contact.mu_s is not None
            static.append(contact.mu_s(N) * N)
            slip.append(contact.mu(0.0, N) * N)
        cones = np.array(static), np.array(slip)
        found = decide(D, b, *cones, rows, released, one_of)
        if not found and released:  # another one that moves may hold it
            found = [f for f in decide(D, b, *cones, rows) if f[0]]
        if not found:
            raise OracleError(f"no consistent set of modes at t = {self.t}")
        return found

    def begin(self) -> None:
        """Leap over the singular first moment of slip in several directions."""
        if len(self.start) > 1:
            raise OracleError("two contacts begin to slip in several directions at once")
        ((i, push),) = self.start.items()
        field, t0 = self.field(), self.t
        tau = min(1e-4, 0.1 * (self.end - self.t))
        after = leap(field, t0, self.y, i, push, tau)
        y0 = self.y.copy()

        def line(t: np.ndarray) -> np.ndarray:
            x = (np.atleast_1d(t) - t0) / tau
            return y0[:, None] + (after - y0)[:, None] * x

        self.motion.pieces.append((t0, t0 + tau, line))
        self.t, self.y, self.start = t0 + tau, after, {}
        self.slow = True

    def record(self, before: list[tuple[int, float]]) -> None:
        """Transitions between the modes before and those now."""
        now = zip(self.p.contacts, before, self.modes, self.signs, strict=True)
        for i, (c, (m0, s0), m1, s1) in enumerate(now):
            if c.force is not None:
                continue
            kind = None
            if m0 == OPEN != m1:
                kind = "close"
            elif m1 == OPEN != m0:
                kind = "open"
            elif m0 == SLIP and m1 == STICK:
                kind = "stick"
            elif m0 == STICK and m1 == SLIP:
                kind = "slip"
            elif m0 == m1 == SLIP and c.d == 1 and s0 != s1 and self.bears(i):
                kind = "reversal"
            if kind:
                self.motion.events.append(Transition(self.t, c.name, kind))

    def bears(self, i: int) -> bool:
        """Whether contact i has a load beyond the round-off of the forces that act; without one nothing turns round."""
        field, q, v = self.field(), self.y[: self.n], self.y[self.n : 2 * self.n]
        field.evaluate(self.t, self.y)
        return bool(field.load[i] > NO_LOAD * np.abs(field.given(self.t, q, v)).max())

    # -- between decisions ------------------------------------------------------------------------------------------
    def segment(self) -> None:
        """To the next transition or break."""
        field = self.field()
        kind = LSODA if self.smooth else Radau if self.slow else DOP853
        longest = self.p.max_step or (self.p.t_end / 100.0)
        atol = np.full(self.y.size, (1e-16 if self.slow else 1e-13) * self.p.scale)
        if self.smooth and self.y.size > 2 * self.n:
            atol[2 * self.n :] = 1e-16
        options: dict[str, Any] = {"rtol": self.rtol, "atol": atol, "max_step": longest}
        solver: Any = self.solver(kind, field, options)
        last = None if self.smooth else field.margins(self.t, self.y)
        start = self.t
        while True:
            try:
                solver.step()
            except NoLoad:  # perhaps only beyond the next transition, where a stage of a long step has looked
                solver = self.solver(kind, field, options, shorter=0.1)
                continue
            if solver.status == "failed":
                raise OracleError(f"step fails at t = {solver.t}")
            dense = solver.dense_output()
            hit = None if last is None else self.first_crossing(field, dense, solver.t_old, solver.t, last)
            if hit is not None:
                t, crossed = hit
                self.keep(solver.t_old, t, dense)
                self.t, self.y = t, dense(t)
                self.slow = False
                self.cross(field, crossed)
                return
            self.keep(solver.t_old, solver.t, dense)
            self.t, self.y = solver.t, solver.y.copy()
            if last is not None:
                if self.catch(field):
                    return
                field.check_loads(self.t, self.y)
                last = field.margins(self.t, self.y)
            if solver.status == "finished":
                self.slow = False
                return
            if self.slow and self.t - start > 0.02 * min(1.0, self.p.t_end):
                self.slow = False  # explicit steps from here
                return

    def solver(self, kind: Any, field: Field, options: dict[str, Any], *, shorter: float = 1.0) -> Any:
        """Steps of scipy from here on; ``shorter``: than the last, where that failed."""
        options["max_step"] *= shorter
        if options["max_step"] < 1e-13 * self.p.t_end:
            raise NoLoad(f"loads and friction do not settle each other at t = {self.t}")
        return kind(field, self.t, self.y, self.end, **options)

    def keep(self, a: float, b: float, dense: Any) -> None:
        """Remember this piece of dense output."""
        if b > a:
            self.motion.pieces.append((a, b, dense))

    def cross(self, field: Field, crossed: list[tuple[int, int]]) -> None:
        """What crossed at one instant: margins of modes (0) or a normal force (1), with the contact."""
        which, i = crossed[0]
        if which == 1:
            if self.p.contacts[i].reaction is not None:
                raise OracleError(f"{self.p.contacts[i].name!r} has no load any more at t = {self.t}")
            if self.p.contacts[i].force is None:
                self.settle(flipped=frozenset([i]))
            return
        gone = frozenset(j for kind, j in crossed if kind == 0 and self.modes[j] == STICK)
        arrived = frozenset(j for kind, j in crossed if kind == 0 and self.modes[j] != STICK)
        if gone and field.active:
            self.settle(one_of=frozenset(field.active), arrived=arrived)
        else:
            self.settle(released=gone, arrived=arrived)

    def catch(self, field: Field) -> bool:
        """In several directions: whether a contact comes to rest here; if it does, to first order exactly."""
        for i, (c, s) in enumerate(zip(self.p.contacts, field.rows, strict=True)):
            if c.force is not None or c.d == 1 or self.modes[i] != SLIP or self.slow:
                continue
            a, _, g, _ = field.evaluate(self.t, self.y)
            r = float(np.linalg.norm(g[s]))
            if r > NEAR * self.p.scale:
                continue
            rate = field.speed_up(min(max(self.t, field.low), field.high), self.y, a)[s]
            closing = -float(rate @ g[s]) / r
            if closing <= 0.0:
                self.motion.closest = min(self.motion.closest, r / self.p.scale)
                continue
            if not self.would_hold(i):
                self.motion.closest = min(self.motion.closest, r / self.p.scale)
                continue
            tau = r / closing
            self.keep_line(tau, a)
            self.settle(arrived=frozenset([i]))
            return True
        return False

    def keep_line(self, tau: float, a: np.ndarray) -> None:
        """On by tau with constant accelerations."""
        tau = min(tau, self.end - self.t)
        y0, t0 = self.y.copy(), self.t
        self.y[: self.n] += tau * y0[self.n : 2 * self.n]
        self.y[self.n : 2 * self.n] += tau * a
        after = self.y.copy()


        def line(t: np.ndarray) -> np.ndarray:
            return y0[:, None] + (after - y0)[:, None] * (np.atleast_1d(t) - t0) / tau

        self.motion.pieces.append((t0, t0 + tau, line))
        self.t = t0 + tau

    def would_hold(self, i: int) -> bool:
        """Whether contact ``i`` would stick if it were at rest now."""
        modes = list(self.modes)
        modes[i] = STICK
        trial = Field(self.p, modes, self.signs, (self.t, self.end))
        t = min(max(self.t, trial.low), trial.high)
        return bool(trial.margins(t, self.y)[0, i] >= 0.0)

    def first_crossing(
        self, field: Field, dense: Any, a: float, b: float, last: np.ndarray
    ) -> tuple[float, list[tuple[int, int]]] | None:
        """The first time in (a, b] at which a margin passes 0, and all that do then: kind and contact."""
        times = np.linspace(a, b, 6)
        values = [last, *(field.margins(t, dense(t)) for t in times[1:])]
        table = np.array(values)  # (6, 2, contacts)
        size = (self.tiny * 1e-1, 1e-14)  # what counts as nothing of a margin and of a load
        found: list[tuple[float, int, int]] = []
        for which in (0, 1):
            for i in range(table.shape[2]):
                column = table[:, which, i]
                if not np.isfinite(column).all():
                    continue
                if self.p.contacts[i].force is not None:
                    continue
                t = self.root(field, dense, times, column, which, i, size[which])
                if t is not None:
                    found.append((t, which, i))
        if not found:
            return None
        found.sort()
        first = found[0][0]
        return first, [(which, i) for t, which, i in found if t - first <= SAME * self.p.t_end]

    def root(
        self, field: Field, dense: Any, times: np.ndarray, column: np.ndarray, which: int, i: int, tiny: float
    ) -> float | None:
        """Where this margin passes 0 downwards, or None."""

        def value(t: float) -> float:
            return float(field.margins(t, dense(t))[which, i])

        for k in range(len(times) - 1):
            left, right = column[k], column[k + 1]
            if right < -tiny:
                if left > 0.0:
                    return float(brentq(value, times[k], times[k + 1], xtol=1e-15, rtol=8.9e-16))
                # just begun: it rose and fell within, or it never rose
                top = minimize_scalar(lambda t: -value(t), bounds=(times[k], times[k + 1]), method="bounded")
                if -top.fun > tiny:
                    return float(brentq(value, top.x, times[k + 1], xtol=1e-15, rtol=8.9e-16))
                return float(times[k])
            low = self.lowest(value, times, column, k)
            if low is not None and value(low) < -tiny:
                return float(brentq(value, times[max(k - 1, 0)], low, xtol=1e-15, rtol=8.9e-16))
        return None

    def lowest(self, value: Any, times: np.ndarray, column: np.ndarray, k: int) -> float | None:
        """Where the margin is lowest about sample k, where it may be lower than at all samples.

        At the ends of a step it may be lowest between the last sample of one and the first of the next.
        """
        a, b, here = max(k - 1, 0), k + 1, column[k]
        if k == len(times) - 2 and column[b] < here:
            a, here = k, column[b]
        # a crest half-way between two samples is as low at both, and at the ends nothing is known of a third
        far = column[max(k - 1, 0) : k + 3].max()
        if here > min(column[a], column[b]) or here >= 0.3 * far:
            return None
        found = minimize_scalar(value, bounds=(times[a], times[b]), method="bounded", options={"xatol": 1e-12})
        return float(found.x)


def solve(problem: Problem, rtol: float = 1e-11) -> Motion:
    """The motion of the problem."""
    return Run(problem, rtol).run()
