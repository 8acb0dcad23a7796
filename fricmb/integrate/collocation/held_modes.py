"""Blocks of a structure whose free modes are known, with some rows held: its poles are zeros of the compliance there.

With free modes ``eta'' + d eta' + w2 eta = c F``, one unit mass each, and rows that must not move, ``c^T eta = 0``,

    G(s) F = 0,    G(s) = sum_j c_j c_j^T / p_j(s),    p_j(s) = s^2 + d_j s + w2_j,

so the poles are the zeros of det G and the shape of a pole is ``x_j = c_j^T F / p_j(s)`` (the secular equation of
Golub, SIAM Review 15, 1973, here with damping).  That costs a few n^2, and undamped frequencies to begin with, where an
eigenproblem of the state matrix costs some 25 (2 n)^3: of 500 modes a third of a second in place of a quarter of a
minute.  Each zero is sought as a distance from a pole nearby (Gu and Eisenstat, SIAM J. Matrix Anal. Appl. 15, 1994),
so that shapes are accurate where a mode hardly takes part.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.problem import Floats

Complex = NDArray[np.complex128]

#: Steps of Newton's method at most; a dozen zeros in a thousand need more than ten.
MOST = 60
#: Zeros that are sought side by side.
SIDE_BY_SIDE = 256
#: What may be missing of a motion that is made of all poles again.
COMPLETE = 1e-9


@dataclass(frozen=True, kw_only=True)
class HeldModes:
    """Blocks ``u' = v + e0, v' = -w2 u - d v + e1`` in coordinates eta of free modes; n of these, b blocks.

    Attributes
    ----------
    w2, d : (b,)
    q_u, q_v, v_u, v_v : (n, b)
        eta and eta' by block states.
    force_0, force_1 : (b, n)
        Inputs e0, e1 by forces on the free modes.
    """

    w2: Floats
    d: Floats
    q_u: Floats
    q_v: Floats
    v_u: Floats
    v_v: Floats
    force_0: Floats
    force_1: Floats


class _Free(NamedTuple):
    """Free modes: ``up``, ``down`` (n,) their two poles, ``c`` (n, m) what the rows feel of them."""

    up: Complex
    down: Complex
    d: Floats
    c: Floats


def held_modes(w2: Floats, d: Floats, c: Floats) -> HeldModes | None:
    """Blocks of free modes (n,) whose rows ``c`` (n, m), m of 1 or 2, are held; None where poles are not found.

    That is so where a held structure has real poles, or poles that are nearly the same.
    """
    turned, c = _apart(w2, d, c)
    takes_part = np.flatnonzero(np.abs(c).max(axis=1) > 1e-100 * np.abs(c).max(initial=0.0))
    others = np.setdiff1d(np.arange(len(w2)), takes_part)
    free = _free(w2[takes_part], d[takes_part], c[takes_part])
    with np.errstate(all="ignore"):  # what is not finite is not complete
        found = _poles(free, _undamped(w2[takes_part], free.c))
    if found is None:
        return None
    s, shapes = found
    made = _with_others(_blocks_of(s, shapes, free.d), takes_part, w2, d, others)
    if not _is_complete(made, d, c):
        return None
    return made if turned is None else _turned_back(made, turned)


def _free(w2: Floats, d: Floats, c: Floats) -> _Free:
    root = np.sqrt((0.25 * d * d - w2).astype(complex))
    return _Free(-0.5 * d + root, -0.5 * d - root, d, c)


def _apart(w2: Floats, d: Floats, c: Floats) -> tuple[Floats | None, Floats]:
    """Modes with the same pole turned within their space until no more of them take part than there are rows."""
    order = np.lexsort((d, w2))
    same = (np.diff(w2[order]) == 0.0) & (np.diff(d[order]) == 0.0)
    if not same.any():
        return None, c
    turned, c = np.eye(len(w2)), c.copy()
    for group in np.split(order, np.flatnonzero(~same) + 1):
        if len(group) > 1:
            Q, R = np.linalg.qr(c[group], mode="complete")
            c[group] = R
            turned[np.ix_(group, group)] = Q
    return turned, c


def _turned_back(made: HeldModes, turned: Floats) -> HeldModes:
    by_state = {name: turned @ getattr(made, name) for name in ("q_u", "q_v", "v_u", "v_v")}
    by_force = {name: getattr(made, name) @ turned.T for name in ("force_0", "force_1")}
    return HeldModes(w2=made.w2, d=made.d, **by_state, **by_force)


def _undamped(w2: Floats, c: Floats) -> Floats:
    """Squares of the frequencies with the rows held and no damping (n - m,): where the search begins."""
    K, c = np.diag(w2), c.copy()
    for _ in range(c.shape[1]):
        v = c[:, 0].copy()
        v[0] += np.copysign(np.linalg.norm(v), v[0])
        v /= np.linalg.norm(v)
        # a reflection that leaves the first row alone to the first coordinate, which is then held
        Kv = K @ v
        K = K - 2.0 * np.outer(v, Kv) - 2.0 * np.outer(Kv, v) + 4.0 * (v @ Kv) * np.outer(v, v)
        c = c - 2.0 * np.outer(v, v @ c)
        K, c = K[1:, 1:], c[1:, 1:]
    return np.asarray(np.linalg.eigvalsh(K))


def _poles(free: _Free, mu: Floats) -> tuple[Complex, Complex] | None:
    """Poles (b,) above the real axis with their shapes (b, n), from the squares ``mu`` of undamped frequencies."""
    if len(mu) and mu[0] <= 1e-12 * max(mu[-1], 1e-300):
        return None
    origin, distance = _begin(free, mu)
    distance = _zeros(free, origin, distance)
    s, shapes = free.up[origin] + distance, _shapes(free, *_factors(free, origin, distance))
    found = np.isfinite(s) & (s.imag > 1e-6 * np.abs(s)) & np.isfinite(shapes).all(axis=1)
    return (s, shapes) if found.all() else None


def _begin(free: _Free, mu: Floats) -> tuple[NDArray[np.intp], Complex]:
    """The free pole nearest to each zero, and about how far it is: damping to first order."""
    w = 1j * np.sqrt(mu)
    undamped = 1j * np.abs(free.up)
    shapes = np.abs(_shapes(free, w[:, None] - undamped, w[:, None] + undamped)) ** 2
    damping = (shapes @ free.d) / shapes.sum(axis=1)
    origin = np.abs(w[:, None] - undamped).argmin(axis=1)
    damping = np.where(np.isfinite(damping), damping, free.d[origin])
    s = -0.5 * damping + 1j * np.sqrt(np.maximum(mu - 0.25 * damping**2, 1e-8 * mu))
    origin = np.abs(s[:, None] - free.up).argmin(axis=1)
    return origin, s - free.up[origin]


def _factors(free: _Free, origin: NDArray[np.intp], distance: Complex) -> tuple[Complex, Complex]:
    """Each zero less the two poles of every mode (b, n each), without cancellation next to the pole of ``origin``."""
    here, away = free.up[origin][:, None], distance[:, None]
    return (here - free.up) + away, (here - free.down) + away


def _compliance(c: Floats, weights: Complex) -> Complex:
    """Sums of c c^T over the modes with weights (b, n): (b, m, m)."""
    m = c.shape[1]
    by_mode = (c[:, :, None] * c[:, None, :]).reshape(-1, m * m)
    return (weights @ by_mode).reshape(-1, m, m)


def _log_slope(c: Floats, up: Complex, down: Complex) -> Complex:
    """Derivative of log(det G) + sum log p_j by s (b,), from the factors of all p_j."""
    weights, both = 1.0 / (up * down), 1.0 / up + 1.0 / down
    G, slope = _compliance(c, weights), _compliance(c, -both * weights)
    if c.shape[1] == 1:
        return np.asarray(slope[:, 0, 0] / G[:, 0, 0] + both.sum(axis=1))
    determinant = G[:, 0, 0] * G[:, 1, 1] - G[:, 0, 1] ** 2
    change = slope[:, 0, 0] * G[:, 1, 1] + slope[:, 1, 1] * G[:, 0, 0] - 2.0 * slope[:, 0, 1] * G[:, 0, 1]
    return np.asarray(change / determinant + both.sum(axis=1))


def _step(free: _Free, origin: NDArray[np.intp], distance: Complex, part: NDArray[np.intp]) -> Complex:
    """Step of the zeros ``part``: that of Newton's method, less what the others take of the slope."""
    s = free.up[origin] + distance
    apart = s[part, None] - s
    apart[np.arange(len(part)), part] = np.inf
    others = (1.0 / apart).sum(axis=1) + (1.0 / (s[part, None] - s.conj())).sum(axis=1)
    slope = _log_slope(free.c, *_factors(free, origin[part], distance[part]))
    step = -1.0 / (slope - others)
    return np.where(np.isfinite(step), step, 0.0)  # on the zero itself


def _zeros(free: _Free, origin: NDArray[np.intp], distance: Complex) -> Complex:
    """Distances at which det G is 0, by Newton's method in which zeros keep each other away.

    That is the method of Ehrlich and Aberth (Mathematics of Computation 27, 1973), on det G times all p_j, which is a
    polynomial; its zeros below the real axis are those above, conjugate.
    """
    seeking, last = np.arange(len(origin)), np.full(len(origin), np.inf)
    for _ in range(MOST):
        many = 1 + len(seeking) // SIDE_BY_SIDE
        step = np.concatenate([_step(free, origin, distance, part) for part in np.array_split(seeking, many)])
        distance = distance.copy()
        distance[seeking] += step
        part_of = np.abs(step) / np.maximum(np.abs(distance[seeking]), 1e-300)
        # below 1e-7 the next step is of round-off; where that is larger, steps no longer fall
        left = (part_of > 1e-7) | ((part_of > 1e-14) & (part_of < 0.1 * last[seeking]))
        last[seeking] = part_of
        seeking = seeking[left]
        if not len(seeking):
            break
    return distance


def _shapes(free: _Free, up: Complex, down: Complex) -> Complex:
    """Shapes (b, n), largest entry 1, from the factors of all p_j."""
    p = up * down
    if free.c.shape[1] == 1:
        x = free.c[:, 0] / p
    else:
        G = _compliance(free.c, 1.0 / p)
        first = np.abs(G[:, 0, 0]) >= np.abs(G[:, 1, 1])
        a = np.where(first, -G[:, 0, 1], G[:, 1, 1])
        b = np.where(first, G[:, 0, 0], -G[:, 1, 0])
        x = (a[:, None] * free.c[:, 0] + b[:, None] * free.c[:, 1]) / p
    return np.asarray(x / np.abs(x).max(axis=1, keepdims=True))


def _blocks_of(s: Complex, x: Complex, d: Floats) -> HeldModes:
    """Companion blocks of poles s with shapes x: eta = u (Re x - sigma/omega Im x) + v Im x / omega."""
    x = x * np.exp(-0.5j * np.angle((x * x).sum(axis=1)))[:, None]
    norm = ((2.0 * s[:, None] + d) * x * x).sum(axis=1)
    amplitude, moving = x / norm[:, None], s[:, None] * x
    omega, ratio = s.imag, (s.real / s.imag)[:, None]
    return HeldModes(
        w2=np.abs(s) ** 2, d=-2.0 * s.real,
        q_u=(x.real - ratio * x.imag).T, q_v=(x.imag / omega[:, None]).T,
        v_u=(moving.real - ratio * moving.imag).T, v_v=(moving.imag / omega[:, None]).T,
        force_0=2.0 * amplitude.real, force_1=2.0 * (s[:, None] * amplitude).real,
    )  # fmt: skip


def _with_others(
    found: HeldModes, takes_part: NDArray[np.intp], w2: Floats, d: Floats, others: NDArray[np.intp]
) -> HeldModes:
    """All blocks: first those that were found, then the free modes that the rows do not feel."""
    b, n = len(found.w2), len(w2)
    at = b + np.arange(len(others))

    def wide(part: Floats, unit: float) -> Floats:
        whole = np.zeros((n, b + len(others)))
        whole[takes_part, :b], whole[others, at] = part, unit
        return whole

    return HeldModes(
        w2=np.concatenate([found.w2, w2[others]]), d=np.concatenate([found.d, d[others]]),
        q_u=wide(found.q_u, 1.0), q_v=wide(found.q_v, 0.0), v_u=wide(found.v_u, 0.0), v_v=wide(found.v_v, 1.0),
        force_0=np.ascontiguousarray(wide(found.force_0.T, 0.0).T),
        force_1=np.ascontiguousarray(wide(found.force_1.T, 1.0).T),
    )  # fmt: skip


def _is_complete(made: HeldModes, d: Floats, c: Floats) -> bool:
    """Whether a motion that the rows allow is what the blocks make of it, and these do not move the rows."""
    motion = np.random.default_rng(0).standard_normal(len(d))
    motion -= c @ np.linalg.lstsq(c, motion, rcond=None)[0]
    u, v = made.force_0 @ motion, made.force_1 @ motion
    w = np.sqrt(np.maximum(made.w2, 1e-300))
    off = np.abs(made.q_u @ u + made.q_v @ v).max(initial=0.0) * w.max(initial=0.0)
    off = max(off, np.abs(made.v_u @ u + made.v_v @ v - motion).max(initial=0.0))
    by_rows = [c.T @ x for x in (made.q_u, made.v_v, made.q_v * w, made.v_u / w)]
    moved = max(np.abs(x).max(initial=0.0) for x in by_rows) / np.abs(c).max(initial=1e-300)
    return bool(off <= COMPLETE * np.abs(motion).max(initial=1.0) and moved <= COMPLETE)
