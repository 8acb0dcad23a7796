"""The linear structure as blocks of two states, free or with given contacts stuck.

With contacts Z stuck, ``q = q_ref + G zeta + N eta``, ``v = G w + N eta'``: W_Z^T G = I, W_Z^T N = 0, N^T M N = I, so
that the stuck motion zeta (``zeta' = w``) brings no inertia coupling.  (eta, eta') falls into companion blocks

    u' = v + e0,   v' = -w2 u - d v + e1,

modes where damping is proportional (then forces enter v alone), else one block to a complex pair or two real poles.
Where the free structure has modes and many of them, those with one or two rows stuck follow from them (``held_modes``).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.array_cache import cached_by_content
from fricmb.integrate.collocation.held_modes import held_modes
from fricmb.integrate.csr import is_diagonal
from fricmb.integrate.problem import Floats

#: Degrees of freedom from which on poles with rows stuck are sought from the free modes.
MANY = 64

#: Velocity that may be made up of a unit of another one by turning it into block states and back.
WHOLE = 1e-10

#: A pole of the state matrix with its eigenvector.
Pole = tuple[complex, NDArray[np.complex128]]


class NoBlocks(ValueError):
    """The state matrix has no well-conditioned eigenvectors."""


@dataclass(frozen=True, kw_only=True)
class Blocks:
    """One structure: n dofs, b blocks, m rows of relative velocity of which some are stuck.

    Attributes
    ----------
    w2, d : (b,)
        Coefficients of the blocks.
    q_u, q_v, v_u, v_v : (n, b)
        Displacement from q_ref and velocity by block states.
    force_0, force_1 : (b, n)
        Block inputs e0, e1 per force on the dofs; applied to ``M v`` they give the block states u, v.
    stuck_motion : (n, m)
        G on the columns of stuck rows, 0 elsewhere.
    modal : bool
        Whether q_v, v_u and force_0 vanish.
    """

    w2: Floats
    d: Floats
    q_u: Floats
    q_v: Floats
    v_u: Floats
    v_v: Floats
    force_0: Floats
    force_1: Floats
    stuck_motion: Floats
    modal: bool


def _inverse_factor(M: Floats) -> Floats:
    """Inverse of the lower factor of the mass matrix."""
    if is_diagonal(M):
        return np.diag(1.0 / np.sqrt(np.diagonal(M)))
    from scipy.linalg import solve_triangular

    return np.asarray(solve_triangular(np.linalg.cholesky(M), np.eye(len(M)), lower=True))


@cached_by_content
def _held(M: Floats, W: Floats, stuck: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Motions (n, b) that the rows ``stuck`` of W leave, orthonormal in M, and :func:`_moved` by these rows."""
    Linv = _inverse_factor(M)
    if not stuck:
        return np.asarray(Linv.T), np.zeros(W.shape)
    full, _ = np.linalg.qr(Linv @ W[:, list(stuck)], mode="complete")
    return np.asarray(Linv.T @ full[:, len(stuck) :]), _moved(Linv, W, stuck)


def _moved(Linv: Floats, W: Floats, stuck: tuple[int, ...]) -> Floats:
    """Motions (n, m) that move one of the rows ``stuck`` alone, 0 for other rows."""
    Wz, G = W[:, list(stuck)], np.zeros(W.shape)
    MW = Linv.T @ (Linv @ Wz)
    G[:, list(stuck)] = MW @ np.linalg.inv(Wz.T @ MW)
    return G


def _in_basis(matrix: Floats, N: Floats) -> Floats:
    """``N^T matrix N``."""
    if is_diagonal(N):
        scale = np.diagonal(N)
        return np.asarray(scale[:, None] * matrix * scale)
    return np.asarray(N.T @ matrix @ N)


def _size(matrix: Floats) -> float:
    """Largest magnitude of an entry."""
    return float(np.maximum.reduce(np.abs(matrix), axis=None)) if matrix.size else 0.0


@lru_cache(maxsize=64)
def _off_diagonal(n: int) -> Floats:
    """A factor for each entry of a matrix: 0 on the diagonal."""
    return 1.0 - np.eye(n)


def _proportional(K: Floats, C: Floats) -> tuple[Floats, Floats, Floats] | None:
    """Modes that diagonalise K and C together: (w2, d, vectors), or None."""
    if is_diagonal(K) and is_diagonal(C):  # uncoupled as it is
        return _not_round_off(K.diagonal(), _size(K)), C.diagonal().copy(), np.eye(len(K))
    off = _off_diagonal(len(K))
    size_k, size_c = _size(K), _size(C)
    if not (_is_symmetric(K, size_k) and _is_symmetric(C, size_c)):
        return None
    mixed = K if size_c == 0.0 else K + C * (0.6180339887 * size_k / size_c if size_k else 1.0)
    E = np.linalg.eigh(0.5 * (mixed + mixed.T))[1] if np.count_nonzero(off * mixed) else np.eye(len(K))
    Km = E.T @ K @ E
    Cm = E.T @ C @ E if size_c else C
    for matrix, size in ((Km, size_k), (Cm, size_c)):
        if size and _size(off * matrix) > 1e-13 * max(size, 1e-300) * len(K):
            return None
    return _not_round_off(Km.diagonal(), size_k), Cm.diagonal().copy(), E


def _not_round_off(w2: Floats, size: float) -> Floats:
    """Squares of frequencies, those that are nothing beside ``size`` as 0."""
    return np.where(np.abs(w2) < 1e-14 * size, 0.0, w2)


def _is_symmetric(matrix: Floats, size: float) -> bool:
    """Whether a matrix with entries of that size is symmetric but for round-off."""
    return size == 0.0 or not (np.count_nonzero(matrix != matrix.T) and _size(matrix - matrix.T) > 1e-14 * size)


def _pair_basis(A: Floats, first: Pole, second: Pole) -> tuple[float, float, Floats]:
    """w2, d and the basis (e1, e2) in which A acts as a companion block."""
    (l1, p1), (l2, p2) = first, second
    half = len(A) // 2
    if abs(l1.imag) > 0:
        shape = p1[:half] if np.abs(p1[:half]).max() > 1e-8 * np.abs(p1).max() else p1[half:]
        turn = np.exp(-0.5j * np.angle(np.sum(shape * shape)))
        e2 = np.imag(p1 * turn) / l1.imag
    else:
        r1, r2 = np.real(p1), np.real(p2)
        if r1 @ r2 < 0:
            r2 = -r2
        size = np.linalg.norm(r1[:half]), np.linalg.norm(r2[:half])
        scale = size[0] / size[1] if min(size) > 1e-8 else 1.0
        e2 = (r1 - scale * r2) / (l1.real - l2.real)
    w2, d = float((l1 * l2).real), float(-(l1 + l2).real)
    e1 = A @ e2 + d * e2
    return w2, d, np.stack([e1, e2])


def _general(K: Floats, C: Floats) -> tuple[Floats, Floats, Floats]:
    """w2, d (b,) and the transformation T (2b, 2b) of (eta, eta') by (u, v), from poles of the state matrix."""
    from scipy.linalg import block_diag, eig, null_space

    n = len(K)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-K, -C]])
    # motions without stiffness and damping are defective double zeros: taken out exactly
    null = null_space(np.vstack([K, C]), rcond=1e-13) if n else np.zeros((0, 0))
    size = np.abs(K).max(initial=0.0) + np.abs(C).max(initial=0.0)
    if np.abs(null.T @ K).max(initial=0.0) + np.abs(null.T @ C).max(initial=0.0) > 1e-12 * size:
        raise NoBlocks("a free motion is driven by non-symmetric forces")
    rest = null_space(null.T) if null.shape[1] else np.eye(n)
    k = rest.shape[1]
    small = np.block([[np.zeros((k, k)), np.eye(k)], [-rest.T @ K @ rest, -rest.T @ C @ rest]])
    poles, vectors = eig(small)
    complex_ones = [i for i in range(2 * k) if poles[i].imag > 1e-12 * abs(poles[i])]
    real_ones = [i for i in range(2 * k) if abs(poles[i].imag) <= 1e-12 * abs(poles[i])]
    real_ones.sort(key=lambda i: poles[i].real)
    pairs = [(i, i) for i in complex_ones] + list(
        zip(real_ones[: len(real_ones) // 2], real_ones[len(real_ones) // 2 :], strict=True)
    )
    w2, d = np.zeros(n), np.zeros(n)
    T = np.zeros((2 * n, 2 * n))
    lift = block_diag(rest, rest)
    for j, (a, b) in enumerate(pairs):
        one = poles[a] if a == b else complex(poles[a].real)
        other = (poles[a].conjugate(), vectors[:, a].conj()) if a == b else (complex(poles[b].real), vectors[:, b])
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):  # two equal poles are refused below
            w2[j], d[j], basis = _pair_basis(small, (one, vectors[:, a]), other)
            T[:, j], T[:, n + j] = lift @ basis[0], lift @ basis[1]
    for i in range(null.shape[1]):
        T[:n, k + i], T[n:, n + k + i] = null[:, i], null[:, i]
    J = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(w2), -np.diag(d)]])
    off = np.abs(A @ T - T @ J).max(initial=0.0) / max(np.abs(A).max(initial=0.0) * np.abs(T).max(initial=0.0), 1e-300)
    if n and (not np.isfinite(T).all() or off > 1e-9 or np.linalg.cond(T / np.linalg.norm(T, axis=0)) > 1e7):
        raise NoBlocks("its state matrix has (nearly) multiple poles")
    return w2, d, T


def _from_free(M: Floats, K: Floats, C: Floats, W: Floats, stuck: tuple[int, ...]) -> Blocks | None:
    """Blocks with one or two rows stuck from the modes of the free structure; None where it has none."""
    free = blocks(M, K, C, W[:, :0], ())
    found = held_modes(free.w2, free.d, free.q_u.T @ W[:, list(stuck)]) if free.modal else None
    if found is None:
        return None
    by_state = {name: _by_dofs(free.q_u, getattr(found, name)) for name in ("q_u", "q_v", "v_u", "v_v")}
    by_force = {name: _by_dofs(free.q_u, getattr(found, name).T).T for name in ("force_0", "force_1")}
    return Blocks(
        w2=found.w2, d=found.d, **by_state, **{name: np.ascontiguousarray(x) for name, x in by_force.items()},
        stuck_motion=_moved(_inverse_factor(M), W, stuck),
        modal=not (np.any(found.q_v) or np.any(found.v_u)),
    )  # fmt: skip


def _by_dofs(shapes: Floats, by_mode: Floats) -> Floats:
    """What is given by free modes, by degrees of freedom."""
    return np.diagonal(shapes)[:, None] * by_mode if is_diagonal(shapes) else np.asarray(shapes @ by_mode)


@cached_by_content
def blocks(M: Floats, K: Floats, C: Floats, W: Floats, stuck: tuple[int, ...]) -> Blocks:
    """The structure M q'' + C q' + K q with the rows ``stuck`` of W held; raises NoBlocks where it has no such form."""
    if len(M) >= MANY and 1 <= len(stuck) <= 2:
        made = _from_free(M, K, C, W, stuck)
        if made is not None:
            return made
    N, G = _held(M, W, stuck)
    n, b = N.shape
    Kz = _in_basis(K, N)
    Cz = _in_basis(C, N) if np.count_nonzero(C) else np.zeros((b, b))
    proportional = _proportional(Kz, Cz)
    solid = np.ascontiguousarray
    if proportional is not None:
        w2, d, E = proportional
        shapes, nothing = N * np.diagonal(E) if is_diagonal(E) else N @ E, np.zeros((n, b))
        return Blocks(
            w2=w2, d=d, q_u=shapes, q_v=nothing, v_u=nothing, v_v=shapes, force_0=np.zeros((b, n)),
            force_1=solid(shapes.T), stuck_motion=G, modal=True,
        )  # fmt: skip
    w2, d, T = _general(Kz, Cz)
    Tinv = np.linalg.inv(T)
    made = Blocks(
        w2=w2, d=d,
        q_u=solid(N @ T[:b, :b]), q_v=solid(N @ T[:b, b:]), v_u=solid(N @ T[b:, :b]), v_v=solid(N @ T[b:, b:]),
        force_0=solid(Tinv[:b, b:] @ N.T), force_1=solid(Tinv[b:, b:] @ N.T), stuck_motion=G,
        modal=False,
    )  # fmt: skip
    if not stuck and not _is_whole(made, M):
        raise NoBlocks("light bodies beside heavy ones move by less than its poles are known")
    return made


def _is_whole(made: Blocks, M: Floats) -> bool:
    """Whether block states made of any velocity give that back, by degrees of freedom (in units as they are)."""
    back = made.v_u @ (made.force_0 @ M) + made.v_v @ (made.force_1 @ M)
    return bool(np.abs(back - np.eye(len(M))).max(initial=0.0) <= WHOLE)
