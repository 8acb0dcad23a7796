"""Residual flexibility: what truncated modes give statically, as few modes that stand for them.

A load b on a structure with modes ``phi_j`` of frequency ``omega_j`` brings about, far below ``omega_j``, the
displacement ``phi_j (phi_j^T b)/omega_j^2``.  The sum of these over truncated modes is a residual vector; the Ritz
vectors of the residual vectors of all loads keep the static flexibility between loads exactly and have frequencies
above the first truncated one.

R. H. MacNeal, A hybrid method of component mode synthesis, Computers and Structures 1 (1971) 581-601; S. Rubin,
Improved component-mode representation for structural dynamic analysis, AIAA Journal 13 (1975) 995-1006.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmb.reduction._modes import Floats, ritz


@dataclass(frozen=True, kw_only=True)
class Residual:
    """Stand-ins of truncated modes: ``frequencies`` (r,) at unit modal mass, ``modes`` (n, r) in the n truncated."""

    frequencies: Floats
    modes: Floats


def modal_residual(omega: Floats, loads: Floats) -> Residual:
    """Residual vectors of truncated modes of unit modal mass.

    Parameters
    ----------
    omega : (n,)
        Frequencies of the truncated modes, > 0.
    loads : (n_loads, n)
        Their shapes at the loads.
    """
    vectors = (loads / omega**2).T
    strength = np.linalg.norm(vectors, axis=0)
    vectors = vectors[:, strength > 1e-13 * strength.max(initial=0.0)]
    if vectors.shape[1] == 0:
        return Residual(frequencies=np.zeros(0), modes=np.zeros((omega.size, 0)))
    K, M = vectors.T @ (omega[:, None] ** 2 * vectors), vectors.T @ vectors
    frequencies, modes = ritz(vectors, K, M)
    return Residual(frequencies=frequencies, modes=modes)


def flexibility(omega: Floats, loads: Floats) -> Floats:
    """Static flexibility of each elastic mode at the loads (n_loads, n); rigid modes count nothing."""
    elastic = omega > 0.0
    return np.divide(loads**2, omega**2, out=np.zeros_like(loads), where=elastic)


def modes_to_keep(omega: Floats, loads: Floats, tolerance: float) -> tuple[int, float]:
    """How many of the modes (rising frequencies) to keep, and the share of flexibility the others carry.

    A friction force that jumps by its whole amount lets a truncated mode swing through twice its static share: twice
    the neglected share, at the load where it is largest, is at most ``tolerance``.
    """
    share = flexibility(omega, loads)
    total = share.sum(axis=1, keepdims=True)
    share = np.divide(share, total, out=np.zeros_like(share), where=total > 0.0)
    tail = np.concatenate([np.cumsum(share[:, ::-1], axis=1)[:, ::-1], np.zeros((share.shape[0], 1))], axis=1)
    worst = tail.max(axis=0, initial=0.0)
    count = int(np.argmax(2.0 * worst <= tolerance))
    rigid = int(np.count_nonzero(omega == 0.0))
    count = max(count, rigid)
    return count, float(worst[count])
