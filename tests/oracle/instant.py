"""Modes and forces at one instant: friction as a convex problem over cones, over all sets of contacts held at mu_s."""

from __future__ import annotations

import itertools

import numpy as np
from scipy.optimize import brentq, linprog


def block(D: np.ndarray, b: np.ndarray, c: float) -> np.ndarray:
    """Least 1/2 F D F + F b in the ball of radius c (D positive definite, one row for each direction)."""
    if c <= 0.0:
        return np.zeros_like(b)
    if b.size == 1:
        return np.clip(-b / D[0, 0], -c, c)
    F = -np.linalg.solve(D, b)
    if np.linalg.norm(F) <= c:
        return F
    w, Q = np.linalg.eigh(D)
    y = Q.T @ b

    def excess(rho: float) -> float:  # with F = -(D + rho) ^ -1 b, as long as the ball is wide at the root
        return float(np.sqrt(((y / (w + rho)) ** 2).sum()) / c - 1.0)

    high = np.sqrt((y**2).sum()) / c
    rho = high
    if excess(0.0) <= 0.0:  # on the edge of the ball, to round-off
        rho = 0.0
    elif excess(high) < 0.0:
        rho = brentq(excess, 0.0, high, xtol=1e-300, rtol=8.9e-16)
    F = -Q @ (y / (w + rho))
    return F * (c / np.linalg.norm(F))


def convex(D: np.ndarray, b: np.ndarray, radii: np.ndarray, rows: list[slice]) -> np.ndarray:
    """Forces of least 1/2 F D F + F b with each block in its ball, by blocks in turn until nothing moves."""
    F = np.zeros(b.size)
    size = np.abs(radii).max(initial=0.0)
    for _ in range(20000):
        moved = 0.0
        for i, s in enumerate(rows):
            rest = b[s] + D[s] @ F - D[s, s] @ F[s]
            new = block(D[s, s], rest, radii[i])
            moved = max(moved, np.abs(new - F[s]).max(initial=0.0))
            F[s] = new
        if moved <= 1e-15 * size:
            break
    return F


def loaded(D: np.ndarray, moved: np.ndarray, limits: np.ndarray) -> tuple[float, np.ndarray]:
    """The least share s with forces abs(F) <= s limits that do the same, D F = moved, and such forces."""
    k = limits.size
    size = max(np.abs(moved).max(), 1e-300)
    w, Q = np.linalg.eigh(D)
    kept = w > 1e-11 * w.max()
    A = np.vstack([np.hstack([np.eye(k), -limits[:, None]]), np.hstack([-np.eye(k), -limits[:, None]])])
    equal = np.hstack([Q[:, kept].T, np.zeros((kept.sum(), 1))])
    found = linprog(
        np.r_[np.zeros(k), 1.0], A_ub=A, b_ub=np.zeros(2 * k), A_eq=equal, b_eq=(Q[:, kept].T @ moved) / w[kept] / size,
        bounds=[(None, None)] * k + [(0.0, None)], method="highs",
    )  # fmt: skip
    return float(found.x[-1]) * size, found.x[:k] * size


def stuck(D: np.ndarray, b: np.ndarray, radii: np.ndarray, rows: list[slice], tiny: float) -> np.ndarray | None:
    """Forces that hold all, of least norm, or where that is beyond a cone any that do; None where there are none."""
    F = -np.linalg.pinv(D, rcond=1e-11, hermitian=True) @ b
    if np.abs(D @ F + b).max(initial=0.0) > tiny:
        return None
    lengths = np.array([np.linalg.norm(F[s]) for s in rows])
    if (lengths <= radii * (1.0 + 1e-12)).all():
        return F
    if np.linalg.matrix_rank(D, tol=1e-11 * np.abs(D).max()) == D.shape[0]:
        return None
    F = convex(D, b, radii, rows)
    return F if np.abs(D @ F + b).max() <= tiny else None


def decide(
    D: np.ndarray,
    b: np.ndarray,
    static: np.ndarray,
    slipping: np.ndarray,
    rows: list[slice],
    released: frozenset[int] = frozenset(),
    one_of: frozenset[int] = frozenset(),
    tiny: float = 1e-11,
) -> list[tuple[frozenset[int], np.ndarray]]:
    """Consistent sets among contacts at rest, those of which no part is one; with the most contacts stuck first.

    ``b``: relative accelerations without their friction; ``static``, ``slipping``: radii of the cones for break-away
    and for r -> 0; ``released``: contacts that may not stick; ``one_of``: at least one of these slips.  Each answer is
    the set that slips and all forces.
    """
    k = len(rows)
    held = np.abs(D).max(initial=0.0) * np.abs(static).max(initial=0.0)
    size = tiny * max(np.abs(b).max(initial=0.0), held, 1e-300)
    found: list[tuple[frozenset[int], np.ndarray]] = []
    for n_slip in range(k + 1):
        for slips in itertools.combinations(range(k), n_slip):
            if not released <= set(slips) or (one_of and not one_of & set(slips)):
                continue
            if any(less <= set(slips) for less, _ in found):
                continue
            F = consistent(D, b, static, slipping, rows, slips, size)
            if F is not None:
                found.append((frozenset(slips), F))
    return found


def consistent(
    D: np.ndarray,
    b: np.ndarray,
    static: np.ndarray,
    slipping: np.ndarray,
    rows: list[slice],
    slips: tuple[int, ...],
    tiny: float,
) -> np.ndarray | None:
    """Forces with exactly these contacts slipping, or None."""
    if not slips:
        return stuck(D, b, static, rows, tiny)
    if not can_move(D, rows, slips):
        return None
    radii = static.copy()
    radii[list(slips)] = slipping[list(slips)]
    F = convex(D, b, radii, rows)
    F = polished(D, b, F, rows, slips)
    speed_up = D @ F + b
    for i, s in enumerate(rows):
        length, rate = np.linalg.norm(F[s]), np.linalg.norm(speed_up[s])
        if i in slips:
            along = float(-F[s] @ speed_up[s])
            at_limit = abs(length - radii[i]) <= 1e-9 * max(radii[i], 1e-300)
            if not at_limit or along < -tiny * max(radii[i], 1e-300):
                return None
        elif rate > tiny * 100 or length > radii[i] * (1.0 + 1e-10):
            return None
    return F


def can_move(D: np.ndarray, rows: list[slice], slips: tuple[int, ...]) -> bool:
    """Whether each of these contacts can slip at all while the others stick (round a loop one alone cannot)."""
    held = [j for i, s in enumerate(rows) if i not in slips for j in range(s.start, s.stop)]
    if not held:
        return True
    P = np.linalg.pinv(D[np.ix_(held, held)], rcond=1e-11, hermitian=True)
    free = D - D[:, held] @ P @ D[held]
    return all(free[j, j] > 1e-9 * D[j, j] for i in slips for j in range(rows[i].start, rows[i].stop))


def polished(D: np.ndarray, b: np.ndarray, F: np.ndarray, rows: list[slice], slips: tuple[int, ...]) -> np.ndarray:
    """The forces of the stuck ones to round-off, those of the slipping ones given."""
    held = [j for i, s in enumerate(rows) if i not in slips for j in range(s.start, s.stop)]
    if not held:
        return F
    rest = [j for j in range(b.size) if j not in held]
    A = D[np.ix_(held, held)]
    wrong = b[held] + A @ F[held] + D[np.ix_(held, rest)] @ F[rest]
    out = F.copy()
    out[held] -= np.linalg.pinv(A, rcond=1e-11, hermitian=True) @ wrong
    return out
