"""Modes from frequency responses, and residues of known modes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.errors import SceneError, shown
from fricmb.measure._types import KINDS, Complexes, Floats, Frf, Modes

#: Prominence of a peak, in natural logarithms of the mean response, that counts as a mode.
PROMINENCE = 1.5


def identify(frfs: Sequence[Frf], *, band: tuple[float, float] | None = None, n_modes: int | None = None) -> Modes:
    """Modes of a lightly damped structure from frequency responses with one force or one motion in common.

    Peaks of the mean response are taken for modes; about each, frequency and damping are fitted to all responses at
    once, with a background for the other modes.  Shapes are the residues at each node and direction; they are scaled to
    unit modal mass if one of the responses is that of a driving point, else ``masses`` are nan.

    Parameters
    ----------
    frfs : sequence of Frf
        Of one set of frequencies and one kind, each with node and axis.
    band : (float, float), optional
        Frequencies to look at.
    n_modes : int, optional
        How many at most, the most prominent ones.

    Returns
    -------
    Modes

    Raises
    ------
    SceneError
    """
    f, values, places = _arrays(frfs, band)
    s: Complexes = np.asarray(2j * np.pi * f, dtype=np.complex128)
    power = KINDS[frfs[0].kind or "accelerance"]
    found = [_refined(s, values, power, *window) for window in _windows(f, values, n_modes)]
    omega, zeta = np.array([x[0] for x in found]), np.array([x[1] for x in found])
    residues = np.array([x[2] for x in found])  # (k, n_frfs)
    nodes = np.unique([node for node, _ in places])
    shapes = np.full((omega.size, nodes.size, 3), np.nan + 0j)
    for j, (node, axis) in enumerate(places):
        sign = -1.0 if axis.startswith("-") else 1.0
        shapes[:, np.searchsorted(nodes, node), "xyz".index(axis.lstrip("-"))] = sign * residues[:, j]
    masses = np.full(omega.size, np.nan)
    driving = [j for j, frf in enumerate(frfs) if frf.is_driving_point]
    if driving:
        own = residues[:, driving[0]].real
        if (own > 0.0).all():
            shapes = shapes / np.sqrt(own)[:, None, None]
            masses = np.ones(omega.size)
    return Modes(frequencies=omega, damping_ratios=zeta, masses=masses, nodes=nodes, shapes=shapes)


def _arrays(frfs: Any, band: Any) -> tuple[Floats, Complexes, list[tuple[int, str]]]:
    """Frequencies (n,), responses (m, n), and the node and axis of each."""
    if not isinstance(frfs, Sequence) or not frfs or not all(isinstance(x, Frf) for x in frfs):
        raise SceneError(f"measure.identify: frfs must be a list of Frf, got {shown(frfs)}")
    first = frfs[0]
    for frf in frfs:
        if frf.f.shape != first.f.shape or not np.allclose(frf.f, first.f) or frf.kind != first.kind:
            raise SceneError("measure.identify: frfs must have the same frequencies and the same kind")
    moved = [(x.node, x.axis) for x in frfs]
    pushed = [(x.reference, x.reference_axis) for x in frfs]
    places = moved if len(set(moved)) == len(moved) else pushed
    if len(set(places)) < len(places) or not all(axis.lstrip("-") in ("x", "y", "z") for _, axis in places):
        raise SceneError(
            "measure.identify: frfs must be of different nodes or directions, each with node and axis x, y, z"
        )
    low, high = (0.0, np.inf) if band is None else band
    kept = (first.f > 0.0) & (first.f >= low) & (first.f <= high)
    values = np.array([x.values[kept] for x in frfs])
    if kept.sum() < 10 or not np.isfinite(values).all():
        raise SceneError(
            f"measure.identify: there are {kept.sum()} lines in band={band}, or values that are not finite"
        )
    return first.f[kept], values, places


def _windows(f: Floats, values: Complexes, n_modes: int | None) -> list[tuple[int, NDArray[np.int64]]]:
    """Places of peaks, and the lines about each."""
    from scipy.signal import find_peaks

    mean = np.log(np.maximum(np.linalg.norm(values, axis=0), np.finfo(float).tiny))
    peaks, facts = find_peaks(mean, prominence=PROMINENCE)
    if n_modes is not None and peaks.size > n_modes:
        peaks = np.sort(peaks[np.argsort(facts["prominences"])[::-1][:n_modes]])
    if not peaks.size:
        raise SceneError("measure.identify: no peak stands out of the mean response")
    edges: list[int] = [0, *((a + b) // 2 for a, b in pairwise(peaks.tolist())), f.size - 1]
    found = []
    for peak, low, high in zip(peaks.tolist(), edges[:-1], edges[1:], strict=True):
        reach = max(4, min(peak - low, high - peak) // 2)
        found.append((int(peak), np.arange(max(low, peak - reach), min(high, peak + reach) + 1)))
    return found


def _refined(
    s: Complexes, values: Complexes, power: int, peak: int, lines: NDArray[np.int64]
) -> tuple[float, float, Complexes]:
    """Angular frequency, damping ratio and residues (m,) of one mode, by least squares over the lines about its peak.

    For each frequency and damping that are tried, residues and backgrounds follow from a linear problem.
    """
    from scipy.optimize import least_squares

    here, held = s[lines], values[:, lines].T
    centre, step = abs(s[peak]), abs(s[1] - s[0])
    # errors count relative to the response, but where it is small against its peak
    weight = 1.0 / (np.linalg.norm(held, axis=1) + 1e-3 * np.linalg.norm(held, axis=1).max())

    def solved(x: Floats) -> tuple[Any, Complexes]:
        omega, zeta = centre + step * x[0], np.exp(x[1])
        resonance = here**power / (here**2 + 2.0 * zeta * omega * here + omega**2)
        offset = (here.imag - centre) / (step * lines.size)
        A = np.column_stack([resonance, np.ones_like(here), offset]) * weight[:, None]
        size = np.linalg.norm(A, axis=0)
        coefficients = np.linalg.lstsq(A / size, held * weight[:, None], rcond=None)[0]
        return coefficients[0] / size[0], (A / size) @ coefficients - held * weight[:, None]

    def residual(x: Floats) -> Floats:
        rest = solved(x)[1].ravel()
        return np.concatenate([rest.real, rest.imag])

    best = min(
        (
            least_squares(residual, [shift, np.log(zeta)], bounds=([-1.5, np.log(1e-6)], [1.5, np.log(0.2)]))
            for shift in (-0.4, 0.0, 0.4)
            for zeta in (3e-4, 3e-3, 3e-2)
        ),
        key=lambda found: found.cost,
    )
    return centre + step * best.x[0], float(np.exp(best.x[1])), solved(best.x)[0]


def residues(frf: Frf, modes: Modes) -> Floats:
    """Residues (k,) of known modes in a receptance: ``phi_a phi_b / m`` of each, real.

    Least squares over the lines between half the first and one and a half times the last frequency, with what modes
    below and above contribute; errors count relative to the response.
    """
    w = 2.0 * np.pi * frf.f
    power = KINDS[frf.kind or "accelerance"]
    omega, zeta = modes.frequencies, modes.damping_ratios
    kept = (w > 0.0) & np.isfinite(frf.values) & (w <= 1.5 * omega.max(initial=0.0))
    kept &= w >= 0.5 * omega[omega > 0.0].min(initial=np.inf)
    elastic = omega > 0.0
    if kept.sum() < 2 * elastic.sum() + 4:
        raise SceneError(
            f"scale: the frequency response has {kept.sum()} lines about the modes, too few for {elastic.sum()}"
        )
    s = 1j * w[kept][:, None]
    columns = s**power / (s**2 + 2.0 * zeta * omega * s + omega**2)
    A = np.hstack([columns, s**power, s ** (power - 2)])
    values = frf.values[kept]
    weight = 1.0 / (np.abs(values) + 1e-4 * np.abs(values).max())
    size = np.linalg.norm(A * weight[:, None], axis=0)
    A = A * weight[:, None] / size
    b = values * weight
    found = np.linalg.lstsq(np.vstack([A.real, A.imag]), np.concatenate([b.real, b.imag]), rcond=None)[0] / size
    return np.asarray(found[: omega.size])
