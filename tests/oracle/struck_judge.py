"""The error of a run with impacts: motion between them, which there are and when, and when bounces are over."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .bounces import Program, bounced
from .judge import BAR, DELTA, UNRULY, Case, Outcome, Truth, Verdict, scale_of
from .problem import OracleError
from .struck import Bouncing, Impact, Struck

#: Impacts slower than some speed between these are not compared one by one.
SLOW = (1e-3, 3e-2)
#: Impacts so shortly before the end of a series, in parts of the run, are not compared either.
LATE = 1e-5
#: Rests that are over sooner, in parts of the run, are not looked at; of those that last distances and rates are less.
LASTS, NEAR = 1e-3, 2e-9


@dataclass(frozen=True, kw_only=True)
class Hard(Case):
    """One scene, twice: as fricmb has it and as numbers."""

    problem: Struck  # type: ignore[assignment]

    def truth(self) -> Truth:
        """What the oracle says of it."""
        return known(self)


@dataclass
class Known(Truth):
    """The oracle's motion and how fast errors grow; impacts below ``slow`` are not compared."""

    motion: Bouncing = field(default_factory=lambda: Bouncing(0))
    slow: float = 0.0

    def compared(self, found: Outcome, rtol: float) -> Verdict:
        """Errors of motion and of times, over rtol and growth; impacts and rests too many or missing."""
        off, wrong = self.off(found, BAR * rtol * self.growth), 0
        span, why = self.case.problem.t_end, []
        rests = self.motion.ends
        mine = hits(self.motion.impacts, self.slow, rests, LATE * span)
        heard = [Impact(t, name, v) for (name, t), v in zip(found.impacts, found.approach, strict=True)]
        theirs = hits(heard, self.slow, rests, LATE * span)
        for name in mine.keys() | theirs.keys():
            a, b = mine.get(name, []), theirs.get(name, [])
            if len(a) != len(b):
                wrong += abs(len(a) - len(b))
                why.append(f"{len(b)} impacts of {name}, {len(a)} are right")
                continue
            worst = float(np.abs(np.subtract(a, b)).max()) / span
            off = max(off, worst)
            why.append(f"impacts of {name} off by {worst:.1e}")
        missed = self.rests(found, BAR * rtol * self.growth * span)
        wrong += len(missed)
        ratio = float(off / (rtol * self.growth))
        if ratio <= BAR and wrong == 0:
            return Verdict("right", ratio, method=found.method)
        text = "; ".join([f"{found.method}: error {off:.1e}, growth {self.growth:.1e}", *why, *missed, found.why])
        return Verdict("noted" if found.why else "wrong", ratio, wrong, text, found.method)

    def off(self, found: Outcome, part: float) -> float:
        """Error of positions, and of velocities but near impacts, where a shift of the time changes all."""
        assert found.q is not None
        assert found.v is not None
        off = float(np.abs((found.q - self.q) / self.scales[0]).max())
        apart = away(self.t, [hit.t for hit in self.motion.impacts], max(part, 1e-6) * self.case.problem.t_end)
        return max(off, float(np.abs((found.v - self.v) / self.scales[1])[:, apart].max(initial=0.0)))

    def rests(self, found: Outcome, near: float) -> list[str]:
        """Rests that last and that the other one does not have."""
        program, span = Program(self.case.problem), self.case.problem.t_end  # type: ignore[arg-type]
        names = [s.name for s in program.p.surfaces]

        def touches(name: str, t: float) -> bool:
            gap, rate, _ = program.speeds(t, self.motion(np.array([t]))[:, 0], names.index(name))
            return abs(gap) < NEAR and abs(rate) < 1e3 * NEAR

        missed = []
        for t, name in self.motion.rests:
            lasts = t + LASTS * span < span and all(touches(name, t + x * LASTS * span) for x in (0.1, 0.5, 1.0))
            if lasts and not any(other == name and abs(s - t) <= near for other, s in found.rests):
                missed.append(f"no rest of {name} at {t:.9g}")
        for name, t in found.rests:
            later = [t + x * near + 1e-9 for x in (0.0, 1e-4, 1e-3, 1e-2, 0.1, 1.0)]
            if later[-1] < span and not any(touches(name, x) for x in later):
                missed.append(f"{name} does not rest at {t:.9g}")
        return missed


def away(t: np.ndarray, events: list[float], distance: float) -> Any:
    """Times that are not so near to any event."""
    return np.array([all(abs(s - e) > distance for e in events) for s in t])


def hits(impacts: list[Impact], slow: float, rests: Iterable[float] = (), late: float = 0.0) -> dict[str, list[float]]:
    """Times of impacts faster than that, and not so shortly before the end of a series."""
    out: dict[str, list[float]] = {}
    for hit in impacts:
        if hit.approach > slow and not any(0.0 <= t - hit.t < late for t in rests):
            out.setdefault(hit.surface, []).append(hit.t)
    return out


def between(approaches: list[float]) -> float:
    """A speed between ``SLOW`` as far as can be from those of impacts."""
    inside = sorted(a for a in approaches if SLOW[0] < a < SLOW[1])
    logs = np.log([SLOW[0], *inside, SLOW[1]])
    widest = int(np.argmax(np.diff(logs)))
    return float(np.exp(0.5 * (logs[widest] + logs[widest + 1])))


def perturbed(p: Struck, delta: float) -> Struck:
    """The same from a start and under loads changed in the sixth digit."""
    signs = np.where(np.arange(p.q.size) % 3 == 1, -1.0, 1.0)
    force = p.force
    return replace(
        p, q=p.q + delta * signs * np.clip(np.abs(p.q), 1e-2, 1.0), v=p.v * (1.0 + delta * signs),
        force=lambda t, q, v: force(t, q, v) * (1.0 + delta),
    )  # fmt: skip


def known(case: Hard, n: int = 97) -> Known:
    """The oracle's motion, and the growth of errors from a second one that starts and is loaded a little otherwise."""
    p = case.problem
    t = p.t_end * (np.arange(n) + 0.618) / n
    found = bounced(p)
    d = p.q.size
    y = found(t)
    scales = (scale_of(y[:d], p.scale), scale_of(y[d:], p.scale))
    slow = between([hit.approach for hit in found.impacts])
    growth, marginal = 1.0, ""
    for delta in (DELTA, -DELTA):
        try:
            other = bounced(perturbed(p, delta))
        except OracleError as error:
            marginal = str(error)
            break
        a, b = hits(found.impacts, slow), hits(other.impacts, slow)
        if {k: len(v) for k, v in a.items()} != {k: len(v) for k, v in b.items()}:
            marginal = "impacts hang on the sixth digit"
            break
        near, shift = other(t), max((float(np.abs(np.subtract(a[k], b[k])).max()) for k in a), default=0.0)
        apart = away(t, [hit.t for m in (found, other) for hit in m.impacts], 2.0 * shift + 1e-6 * p.t_end)
        off = max(
            float(np.abs((near[:d] - y[:d]) / scales[0]).max()), shift / p.t_end,
            float(np.abs((near[d:] - y[d:]) / scales[1])[:, apart].max(initial=0.0)),
        )  # fmt: skip
        growth = max(growth, off / DELTA)
    if not marginal and growth > UNRULY:
        marginal = f"errors grow {growth:.0e} times"
    return Known(
        case=case, t=t, q=y[:d], v=y[d:], growth=growth, events=[], marginal=marginal, scales=scales, motion=found,
        slow=slow,
    )  # fmt: skip
