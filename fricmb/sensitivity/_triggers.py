"""Event functions: what vanishes at a transition, how fast, and by what it is moved."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fricmb.integrate.problem import STICK, Codes, Floats
from fricmb.integrate.run.chunked_run import take
from fricmb.integrate.trajectory import Samples
from fricmb.sensitivity._directions import across
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._equations import Equations, Field
from fricmb.sensitivity._found import Found, at, whole
from fricmb.sensitivity._friction import Friction
from fricmb.sensitivity._happenings import Happening
from fricmb.sensitivity._phases import Phases


@dataclass(frozen=True, kw_only=True)
class Trigger:
    """An event function at its zero: residual, slopes (columns,), rate along the motion, and that rate normalised.

    ``sure``: False where it depends on forces in stick that are not determined.
    """

    event: int
    contact: int
    residual: float
    slopes: Floats
    rate: float
    transversality: float
    sure: bool = True


class Triggers:
    """Event functions of happenings.

    Parameters
    ----------
    before : Field
        At the times of all happenings, before them.
    samples : Samples
        There.
    zero : float
        Residuals up to which a condition is met.
    """

    def __init__(
        self, equations: Equations, phases: Phases, happened: list[Happening], before: Field, samples: Samples,
        zero: float,
    ) -> None:  # fmt: skip
        self.equations, self.phases, self.happened, self.before = equations, phases, happened, before
        self.samples, self.zero = samples, zero

    def of(self, i: int) -> list[Trigger]:
        """Those of one happening."""
        one, along = self.happened[i], self._along(i)
        found = []
        for event, k, kind in zip(one.events.tolist(), one.contacts, one.kinds, strict=True):
            make = {"slip": self._release, "open": self._opening, "close": self._opening}.get(kind, self._rest)
            found.append(make(i, event, k, along))
        if "slip" in one.kinds and self._indeterminate(i):
            return self._together(i, found, along)
        return found

    def _together(self, i: int, found: list[Trigger], along: Floats) -> list[Trigger]:
        """Those of a happening in which contacts let go whose forces in stick are not determined."""
        one = self.happened[i]
        letting = [k for k, kind in zip(one.contacts, one.kinds, strict=True) if kind == "slip"]
        mode, sign = self.phases.mode[:, one.phase], self.phases.sign[:, one.phase]
        begins = about_to_slip(self.equations, take(self.samples, [i]), mode, sign, letting)
        sure = begins is not None and all(abs(value) <= self.zero * size for value, _, size in begins.values())
        changed = []
        for trigger, kind in zip(found, one.kinds, strict=True):
            if kind == "slip" and sure and begins is not None:
                value, slopes, size = begins[trigger.contact]
                rate = float(slopes @ along)
                changed.append(
                    replace(
                        trigger, residual=abs(value) / size, slopes=slopes, rate=rate or 1e-300,
                        transversality=abs(rate) / size * self._lasted(i),
                    )
                )  # fmt: skip
            else:
                changed.append(replace(trigger, sure=kind != "slip"))
        return changed

    def landing(self, i: int, k: int, g: Floats) -> tuple[Floats, Floats, Floats, float]:
        """Slopes (n_t, columns) of the time that slip in two directions still takes, where it has g (d, n_t).

        Also the shares (n_t,) that they may be off by, the slopes (n_t, d, columns) of what is across g, and the
        largest speed of slip.

        That time T is homogeneous in g, and T' = -1 along g' = A(n).  So its gradient w at the direction n* in which
        slip ends, where A = -kappa n*, has w . n* = 1/kappa, and w . dA/de = 0 for every e across n*.  Beside n* it is
        w + s (n - n*), with s for which that is exact where A = a - b n: s = 1/(kappa (2 - kappa/b)); as A is uneven it
        is off by the square of n - n*.
        """
        e, phase = self.equations, self.happened[i].phase - 1
        slopes, rates = self.slipping(i, k)
        kappa = float(np.linalg.norm(rates))
        n, W = -rates / kappa, slopes[:, e.n : 2 * e.n]
        mode, sign = self.phases.mode[:, [phase]], self.phases.sign[:, [phase]]
        sides, falls = across(e, take(self.samples, [i]), mode, sign, k, n)
        w = np.linalg.solve(np.vstack([n, falls]), np.append(1.0 / kappa, np.zeros(len(sides))))
        b = float(np.mean(np.sum(falls * sides, axis=1)))
        s = 1.0 / (kappa * (2.0 - min(kappa / b, 1.0)))  # of more than b directions turn away: slip along a line
        D = np.linalg.eigvalsh(W @ e.free(self.before.found, mode[:, 0], i) @ W.T)
        uneven = 1.0 - float(D[0] / D[-1]) + float(np.linalg.norm(falls @ n)) / b
        length = np.linalg.norm(g, axis=0)
        turned = np.where(length > 0.0, g / np.where(length > 0.0, length, 1.0), n[:, None])
        beside = slopes - np.einsum("at,bt,bj->taj", turned, turned, slopes)
        speed = float(np.abs(W).max(axis=0) @ self.phases.speed)
        off = turned - n[:, None]
        return (w[:, None] + s * off).T @ slopes, uneven * np.sum(off**2, axis=0), s * beside, speed

    def slipping(self, i: int, k: int) -> tuple[Floats, Floats]:
        """Slopes (d, columns) of the slip of a contact before happening i, and its rates (d,)."""
        slopes = np.array([self._row(dual, i)[1] for dual in self.before.found.g[k]])
        return slopes, slopes @ self._along(i)

    def _indeterminate(self, i: int) -> bool:
        """Whether forces in stick before a happening are not determined."""
        e, mode = self.equations, self.phases.mode[:, self.happened[i].phase - 1]
        stuck = [k for k, contact in e.contacts.items() if not contact.smooth and mode[k] == STICK]
        D = e.projector(self.before.found, stuck, i)[2]
        return bool(np.linalg.matrix_rank(D, tol=1e-10 * np.abs(D).max(initial=0.0)) < len(D))

    def _along(self, i: int) -> Floats:
        """Rates of all columns along the motion: what slopes are multiplied with."""
        found = np.zeros(self.equations.columns)
        found[: self.equations.n_y] = self.before.y_dot[i]
        found[-1] = 1.0
        return found

    def _row(self, dual: Dual, i: int) -> tuple[float, Floats]:
        slopes = np.zeros(self.equations.columns)
        for j, slope in dual.slopes.items():
            slopes[j] = at(slope, i)
        return at(dual.value, i), slopes

    def _release(self, i: int, event: int, k: int, along: Floats) -> Trigger:
        """Friction that holds reaches its limit: |F| - mu_s N = 0."""
        F, F_slopes = (part[i] for part in self.before.F[k])
        size = max(float(np.linalg.norm(F)), 1e-300)
        limit, limit_slopes = self._row(self.before.found.limit[k], i)
        slopes = F @ F_slopes / size - limit_slopes
        rate = float(slopes @ along)
        unit = max(limit, 1e-300)
        return Trigger(
            event=event, contact=k, residual=abs(size - limit) / unit, slopes=slopes, rate=rate or 1e-300,
            transversality=abs(rate) / unit * self._lasted(i),
        )  # fmt: skip

    def _lasted(self, i: int) -> float:
        """Time since what happened before."""
        begin = self.happened[i - 1].t if i else float(self.phases.t[0])
        return self.happened[i].t - begin

    def _rest(self, i: int, event: int, k: int, along: Floats) -> Trigger:
        """Slip ends or turns round: g = 0."""
        rows = [self._row(dual, i) for dual in self.before.found.g[k]]
        g, slopes = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
        rates = slopes @ along
        n = np.ones(1) if g.size == 1 else -rates / max(float(np.linalg.norm(rates)), 1e-300)
        limit, _ = self._row(self.before.found.limit[k], i)
        W = (n @ slopes)[self.equations.n : 2 * self.equations.n]
        scale = float(W @ self.equations.inverse @ W) * max(limit, 1e-300)
        W = np.abs(slopes[:, self.equations.n : 2 * self.equations.n])
        speed = float(W.max(axis=0) @ self.phases.speed) + 1e-300
        rate = float(n @ rates)
        return Trigger(
            event=event, contact=k, residual=float(np.linalg.norm(g)) / speed, slopes=n @ slopes, rate=rate or 1e-300,
            transversality=abs(rate) / scale,
        )  # fmt: skip

    def _opening(self, i: int, event: int, k: int, along: Floats) -> Trigger:
        """The normal force vanishes."""
        N, slopes = self._row(self.before.found.N[k], i)
        rate = float(slopes @ along)
        largest = float(np.max(np.abs(np.asarray(self.before.found.N[k].value)))) + 1e-300
        parts = float(np.abs(slopes) @ np.abs(along)) + 1e-300
        return Trigger(
            event=event, contact=k, residual=abs(N) / max(largest, 1e-300), slopes=slopes, rate=rate or 1e-300,
            transversality=abs(rate) / parts,
        )  # fmt: skip


def about_to_slip(
    e: Equations, samples: Samples, mode: Codes, sign: Floats, contacts: list[int]
) -> dict[int, tuple[float, Floats, float]] | None:
    """Relative acceleration of each contact that lets go, along its slip, with its slopes and size, at one time.

    ``mode`` (n_c,), ``sign`` (m,): those of the phase that begins.  The size is what friction at its limit makes of it.
    None in two directions and where rows vary.
    """
    if any(e.contacts[k].d > 1 for k in contacts):
        return None
    field = e.field(samples, mode[:, None], sign[:, None])
    rows = field.found.rows
    if any(isinstance(c, Dual) for k in contacts for _, c in rows[k][0]):
        return None
    W = np.zeros((e.n, len(contacts)))
    for r, k in enumerate(contacts):
        for i, c in rows[k][0]:
            W[i, r] += c
    free = e.free(field.found, mode, 0)
    along = np.array([float(sign[e.rows(k)][0]) for k in contacts])
    more = [_more(e.contacts[k], field.found, k, sign[e.rows(k)]) for k in contacts]
    value, slopes = whole(more, 1, e.columns)
    a = field.a[0] + free @ W @ value[0]
    a_slopes = field.a_slopes[0] + free @ W @ slopes[0]
    drift, drift_slopes = whole([field.found.drift[k][0] for k in contacts], 1, e.columns)
    g, g_slopes = along * (W.T @ a + drift[0]), along[:, None] * (W.T @ a_slopes + drift_slopes[0])
    limits = np.array([at(field.found.limit[k].value, 0) for k in contacts])
    size = np.abs(W.T @ free @ W) @ np.abs(limits)
    return {k: (float(g[r]), g_slopes[r], float(size[r])) for r, k in enumerate(contacts)}


def _more(contact: Friction, found: Found, k: int, sign: Floats) -> Dual:
    """What friction at its limit is more than that of slip, as a force."""
    slipping = contact.beginning(found.N[k], sign[:, None])[0]
    return found.limit[k] * -float(sign[0]) + slipping * -1.0
