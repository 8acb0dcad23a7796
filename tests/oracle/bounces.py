"""Impacts, bounces, rest and lifting off: steps of DOP853 from event to event, all sets of modes tried at each.

Bounces end when the times between them, of one surface or of several in turn, are a geometric series to the last
digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise, product
from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq, minimize_scalar

from .hits import Instant
from .problem import OPEN, SLIP, STICK, OracleError
from .struck import NONE, Bouncing, Impact, Modes, Struck, Surface

#: Parts of a step at which margins are looked at, beside dips between them.
LOOKS = 8
#: Time between two impacts at which their series is summed.
SHORT = 1e-5
#: Approach below which an impact outside of a series decides nothing.
GRAZE = 1e-6
#: Distance and speed of what touches without being pressed: whether it is hit with the others hangs on the last digits.
NEAR, CALM = 1e-8, 1e-6
#: Events after which a motion is given up.
MOST = 4000


class Program(Modes):
    """A run of it."""

    def __init__(self, problem: Struck, rtol: float = 1e-12) -> None:
        super().__init__(problem)
        self.rtol = rtol
        self.hits: list[list[float]] = [[] for _ in problem.surfaces]
        self.motion = Bouncing(self.n)

    def run(self) -> Bouncing:
        """To the end."""
        self.settle(frozenset(), frozenset())
        for _ in range(MOST):
            if self.t >= self.p.t_end:
                self.motion.last = self.y
                return self.motion
            self.segment()
        raise OracleError(f"more than {MOST} events")

    def segment(self) -> None:
        """To the next event."""
        solver: Any = DOP853(
            self, self.t, self.y, self.p.t_end, rtol=self.rtol, atol=1e-14 * self.p.scale, max_step=self.p.longest
        )
        last = self.margins(self.t, self.y)
        while True:
            a, before = solver.t, solver.y.copy()
            solver.step()
            if solver.status == "failed":
                raise OracleError(f"step fails at t = {solver.t}")
            dense = solver.dense_output()
            hit = self.first(dense, a, solver.t, last)
            if hit is not None:
                t, crossed = hit
                t, y = self.nearer(a, before, t, crossed[0])
                if t > a:
                    self.motion.pieces.append((a, t, dense))
                self.t, self.y = t, y
                self.cross(crossed)
                return
            self.motion.pieces.append((a, solver.t, dense))
            self.t, self.y = solver.t, solver.y.copy()
            if solver.status == "finished":
                return
            last = self.margins(self.t, self.y)

    def first(
        self, dense: Any, a: float, b: float, last: np.ndarray
    ) -> tuple[float, list[tuple[int, int]]] | None:
        """The first time at which margins pass 0, and those that do."""
        times = np.linspace(a, b, LOOKS + 1)
        table = np.array([last, *(self.margins(t, dense(t)) for t in times[1:])])
        found = []
        for which, i in np.ndindex(*last.shape):
            column = table[:, which, i]
            if np.isfinite(column).all():
                t = self.root(lambda s, w=which, i=i: float(self.margins(s, dense(s))[w, i]), times, column)
                if which == 0 and self.modes[i] == OPEN:
                    t = self.dips(lambda s, i=i: self.speeds(s, dense(s), i)[1], i, dense, times, t)
                if t is not None:
                    found.append((t, which, i))
        if not found:
            return None
        found.sort()
        return found[0][0], [(which, i) for t, which, i in found if t - found[0][0] <= 1e-13 * self.p.t_end]

    def root(self, value: Callable[[float], float], times: np.ndarray, column: np.ndarray) -> float | None:
        """Where this margin passes 0 downwards; a root at the start of the step is none."""
        tiny = 1e-15 * self.p.scale
        for k in range(len(times) - 1):
            a, b = float(times[k]), float(times[k + 1])
            if column[k + 1] < -tiny:
                if column[k] > NONE:
                    return float(brentq(value, a, b, xtol=1e-15, rtol=8.9e-16))
                tau = b - a
                while tau > 1e-13 and value(a + tau) <= 0.0:  # it has begun at 0, and may have risen before
                    tau *= 0.5
                return a if tau <= 1e-13 else float(brentq(value, a + tau, b, xtol=1e-15, rtol=8.9e-16))
            if k > 0 and column[k] < min(column[k - 1], column[k + 1]):
                low = minimize_scalar(value, bounds=(times[k - 1], b), method="bounded", options={"xatol": 1e-12})
                if low.fun < -tiny and column[k - 1] > 0.0:
                    return float(brentq(value, times[k - 1], low.x, xtol=1e-15, rtol=8.9e-16))
        return None

    def dips(
        self, rate: Callable[[float], float], i: int, dense: Any, times: np.ndarray, before: float | None
    ) -> float | None:
        """Where a distance passes 0 between two looks and comes back, if that is before what has been found."""
        rates = [rate(float(t)) for t in times]
        for k, (a, b) in enumerate(pairwise(times)):
            if before is not None and before <= a:
                break
            if rates[k] < 0.0 < rates[k + 1]:
                low = brentq(rate, a, b, xtol=1e-15, rtol=8.9e-16)

                def value(t: float) -> float:
                    return self.speeds(t, dense(t), i)[0] - float(self.zero[i])

                if value(low) < -1e-15 * self.p.scale < value(a):
                    return float(brentq(value, a, low, xtol=1e-15, rtol=8.9e-16))
        return before

    def nearer(self, a: float, before: np.ndarray, t: float, crossed: tuple[int, int]) -> tuple[float, np.ndarray]:
        """The root by steps of their own that end there, and the state."""
        h = 1e-7
        for _ in range(3):
            y = self.advanced(a, before, t)
            value = float(self.margins(t, y)[crossed])
            rate = (float(self.margins(t + h, y + h * self(t, y))[crossed]) - value) / h
            if not rate < 0.0 or abs(value / rate) > 1e-6:
                break
            t = max(t - value / rate, a)
        return t, self.advanced(a, before, t)

    def advanced(self, a: float, y: np.ndarray, b: float) -> np.ndarray:
        """On from a to b."""
        if b <= a:
            return y.copy()
        solver: Any = DOP853(self, a, y, b, rtol=self.rtol, atol=1e-14 * self.p.scale, max_step=self.p.longest)
        while solver.status == "running":
            solver.step()
        return np.asarray(solver.y).copy()

    # -- events -------------------------------------------------------------------------------------------------
    def cross(self, crossed: list[tuple[int, int]]) -> None:
        """What these margins mean."""
        hit = [i for which, i in crossed if which == 0 and self.modes[i] == OPEN]
        if hit and all(self.rests(i) for i in hit):  # it lay there, and is pressed from now on
            begun = (j for j, mode in enumerate(self.modes) if mode == SLIP)
            gone = frozenset(j for j in begun if abs(self.speeds(self.t, self.y, j)[2]) <= NONE)
            self.settle(frozenset(), gone, frozenset(hit))
            return
        if hit:
            self.impact(hit)
            return
        free = frozenset(i for which, i in crossed if which == 0)
        gone = frozenset(i for which, i in crossed if which == 1 and self.modes[i] == STICK)
        self.settle(free, gone)

    def impact(self, hit: list[int]) -> None:
        """Velocities behind it, and whether a series of them is over."""
        t, y = self.t, self.y
        rates = [self.speeds(t, y, i)[1] for i in range(self.k)]
        members = [i for i in range(self.k) if i in hit or self.modes[i] != OPEN or self.rests(i)]
        tail = any(self.hits[i] and t - self.hits[i][-1] < 1e3 * SHORT for i in hit)
        if not tail and min(-rates[i] for i in hit) < GRAZE and not all(self.p.surfaces[i].e == 0.0 for i in hit):
            raise OracleError(f"grazes at t = {t}")
        for j in set(range(self.k)).difference(members):
            if abs(self.speeds(t, y, j)[0]) <= NEAR and abs(rates[j]) <= CALM:
                raise OracleError(f"touches, but is not pressed, at t = {t}")
        for i in hit:
            self.motion.impacts.append(Impact(t, self.p.surfaces[i].name, -rates[i]))
            self.hits[i].append(t)
        left, ending = self.ending(hit)
        if ending:
            self.motion.ends.append(t + left)
        members, rested = sorted({*members, *ending}), [self.rests(i) for i in range(self.k)]
        self.y = y.copy()
        self.y[self.n :] = self.behind(members, ending)
        if ending and left == 0.0:  # hops that are none: what they would rise by goes
            rows = np.array([self.p.surfaces[i].row(y[: self.n]) for i in ending])
            rises = np.array([self.speeds(t, self.y, i)[1] for i in ending])
            self.y[self.n :] -= self.inverse @ rows.T @ np.linalg.lstsq(rows @ self.inverse @ rows.T, rises)[0]
        for i in members:
            rests = abs(self.speeds(t, self.y, i)[1]) <= NONE
            rested[i] = rested[i] or not rests
            self.modes[i] = SLIP if rests else OPEN
        self.settle(frozenset(), frozenset())
        N = self.accelerations(t, self.y, self.modes, self.signs)[1]
        for i in members:  # of two that fall side by side nothing presses one on the other
            if not rested[i] and N[i] > NONE:
                self.motion.rests.append((t + left, self.p.surfaces[i].name))
                self.hits[i] = []

    def ending(self, hit: list[int]) -> tuple[float, frozenset[int]]:
        """Time left of a series and the surfaces that come to rest with it; none where none does."""
        for i in hit:
            if len(self.hits[i]) < 4:
                continue
            c, d, e = np.diff(self.hits[i][-4:])
            if e <= 4e-16 * self.t and d < SHORT:  # hops no longer than a rounding of the time
                gaps, rates = zip(*(self.speeds(self.t, self.y, j)[:2] for j in range(self.k)), strict=True)
                return 0.0, frozenset(j for j in range(self.k) if abs(gaps[j]) <= 1e-12 and abs(rates[j]) <= CALM)
            if min(c, d) <= 0.0:
                continue
            ratio, before = float(e / d), float(d / c)
            second = self.hits[i][-2]
            if e < SHORT and ratio < 0.999 and abs(ratio - before) < 0.3 * before:
                lately = [j for j in range(self.k) if self.hits[j] and self.hits[j][-1] >= second]
                return float(e) * ratio / (1.0 - ratio), frozenset(lately)
        return 0.0, frozenset()

    def behind(self, members: list[int], ending: frozenset[int]) -> np.ndarray:
        """Velocities by the law of impact; what comes to rest is not thrown back."""
        t, q, v = self.t, self.y[: self.n], self.y[self.n :]
        normals = np.array([self.p.surfaces[i].row(q) for i in members])
        alongs = np.array([np.zeros(self.n) if s.along is None else s.along(q) for s in self.taken(members)])
        rates = np.array([self.speeds(t, self.y, i)[1:] for i in members])
        e = np.array([0.0 if i in ending else self.p.surfaces[i].e for i in members])
        e_t = np.array([0.0 if i in ending else self.p.surfaces[i].e_t for i in members])
        inside = Instant(
            normals=normals, alongs=alongs, rates=rates, mu=np.array([s.mu_k for s in self.taken(members)]),
            inverse=self.inverse,
        )  # fmt: skip
        after = v + (inside.poisson(e) if self.p.poisson else inside.newton(e, e_t))
        return np.asarray(after)

    def taken(self, members: list[int]) -> list[Surface]:
        """These surfaces."""
        return [self.p.surfaces[i] for i in members]

    def settle(self, free: frozenset[int], gone: frozenset[int], shut: frozenset[int] = frozenset()) -> None:
        """Modes that fit from here on; ``free`` is not held any longer, ``gone`` does not stick, ``shut`` is held."""
        t, y, lies = self.t, self.y, [self.rests(i) for i in range(self.k)]
        found: list[tuple[int, np.ndarray, list[int], list[float]]] = []
        for modes, signs in self.candidates(free, gone):
            if any(modes[i] == OPEN for i in shut):
                continue
            try:
                a, N, T = self.accelerations(t, y, modes, signs)
            except np.linalg.LinAlgError:
                continue
            if self.fits(modes, signs, a, N, T):
                found.append((modes.count(STICK), a, modes, signs))
        if not found:
            raise OracleError(f"no consistent set of modes at t = {t}")
        found.sort(key=lambda item: -item[0])
        best = [item for item in found if item[0] == found[0][0]]
        several = any(np.abs(item[1] - best[0][1]).max() > 1e-6 * (1.0 + np.abs(item[1]).max()) for item in best)
        static = any(s.mu_s > s.mu_k for s in self.p.surfaces) or any(d.static > d.kinetic for d in self.p.dries)
        differ = any(np.abs(item[1] - best[0][1]).max() > 1e-6 * (1.0 + np.abs(item[1]).max()) for item in found)
        if several or (differ and not static):
            raise OracleError(f"several consistent sets of modes at t = {t}")
        _, a, self.modes, self.signs = best[0]
        self.check_shares(a)
        for i in range(self.k):
            self.zero[i] = self.speeds(t, y, i)[0] if self.modes[i] == OPEN and lies[i] else 0.0

    def check_shares(self, a: np.ndarray) -> None:
        """An error where several dry parts at rest hold something together, with more friction at rest than in slip."""
        v = self.y[self.n :]
        calm = [abs(float(d.row @ v)) <= NONE >= abs(float(d.row @ a)) for d in self.p.dries]
        stay = [i for i, rests in enumerate(calm) if rests]
        odd = [i for i in stay if self.modes[self.k + i] == SLIP and self.p.dries[i].static > self.p.dries[i].kinetic]
        if odd and len(stay) > 1:
            raise OracleError(f"shares of dry friction at rest at t = {self.t}")

    def candidates(self, free: frozenset[int], gone: frozenset[int]) -> Iterator[tuple[list[int], list[float]]]:
        """All sets of modes that velocities allow."""
        every = []
        for i in range(len(self.modes)):
            slip = self.speeds(self.t, self.y, i)[2]
            may: list[tuple[int, float]] = []
            surface = self.p.surfaces[i] if i < self.k else None
            if surface is not None:
                may.append((OPEN, 0.0))
                if not self.rests(i) or i in free:
                    every.append(may)
                    continue
                if surface.mu_k == 0.0:
                    every.append([*may, (SLIP, 0.0)])
                    continue
            if abs(slip) > NONE:
                may.append((SLIP, float(np.sign(slip))))
            else:
                may += [(SLIP, 1.0), (SLIP, -1.0)] + ([] if i in gone else [(STICK, 0.0)])
            every.append(may)
        for chosen in product(*every):
            yield [mode for mode, _ in chosen], [sign for _, sign in chosen]

    def fits(self, modes: list[int], signs: list[float], a: np.ndarray, N: np.ndarray, T: np.ndarray) -> bool:
        """Whether nothing contradicts these modes."""
        q, v = self.y[: self.n], self.y[self.n :]
        size = NONE * (1.0 + float(np.abs(a).max()))
        stuck = [i for i in range(self.k) if modes[i] == STICK]
        if stuck and abs(T[stuck].sum()) > sum(self.limit(i, N[i]) for i in stuck) + size:
            return False
        for i, mode in enumerate(modes):
            slip = self.speeds(self.t, self.y, i)[2]
            normal, bend, along, turn = self.rows(q, v, self.t, i)
            if mode == OPEN and self.rests(i) and normal @ a + bend < -size:
                return False
            if i < self.k and mode != OPEN and N[i] < -size:
                return False
            if mode == STICK and i >= self.k and abs(T[i]) > self.limit(i, N[i]) + size:
                return False
            friction = i >= self.k or self.p.surfaces[i].mu_k > 0.0
            if mode == SLIP and friction and abs(slip) <= NONE and signs[i] * (along @ a + turn) < -size:
                return False
        return True


def bounced(problem: Struck, rtol: float = 1e-12) -> Bouncing:
    """The motion of the problem."""
    return Program(problem, rtol).run()
