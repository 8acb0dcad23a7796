"""Derivatives of stability: which parameter calms a mode, moves a pair apart, or moves the threshold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg

from fricmb.analysis import AnalysisError, SteadySliding
from fricmb.errors import FricmbError
from fricmb.squeal._place import Complexes, Floats, Places

#: Step of differences, in parts of a parameter's value.
_STEP = 1e-5
#: Cosine of right and left vector below which two modes have met, and derivatives of one of them alone mean nothing.
_MET = 1e-4
#: Real parts below this share of an eigenvalue are round-off.
_ROUND_OFF = 1e-12


@dataclass(frozen=True, kw_only=True)
class Derivatives:
    """Derivatives of one eigenvalue by parameters, relative to the parameters' values (``p d/dp``).

    Attributes
    ----------
    at : dict of str to float
        Values of the parameters of the study.
    eigenvalue, partner : complex
        The mode, and the one that it shares its shape with: the other one of a flutter pair.
    names : tuple of str
    values : (n,)
        Of the parameters.
    slopes : (n,) complex
        ``p d lambda/dp``; the real part is that of the growth rate.  nan where the two modes have met.
    apart : (n,)
        ``-p d Re(((lambda - partner)/2)^2)/dp``: above 0 the parameter moves the pair apart as it grows.  This is
        smooth where the two meet.
    threshold : (n,) or None
        At a threshold: ``p`` times the derivative of the critical value.
    over : str
        The critical parameter.
    """

    at: Mapping[str, float]
    eigenvalue: complex
    partner: complex
    names: tuple[str, ...]
    values: Floats
    slopes: Complexes
    apart: Floats
    threshold: Floats | None = None
    over: str = ""

    def rows(self) -> list[tuple[str, float, float, float, float, float]]:
        """Name, value, growth, frequency, apart and threshold of each parameter, the most influential first."""
        threshold = np.full(len(self.names), np.nan) if self.threshold is None else self.threshold
        measure = self.apart if self.threshold is None else threshold
        order = np.argsort(-np.abs(measure), kind="stable")
        columns = self.values, self.slopes.real, self.slopes.imag, self.apart, threshold
        return [(self.names[i], *(float(column[i]) for column in columns)) for i in order.tolist()]

    def __str__(self) -> str:
        both = (self.eigenvalue, self.partner)
        pair = [x if abs(x.real) > _ROUND_OFF * abs(x) else complex(0.0, x.imag) for x in both]
        met = f"eigenvalue {pair[0]:.6g}, partner {pair[1]:.6g}; relative to the values of the parameters"
        wide = max(28, *(len(name) for name, *_ in self.rows()))
        more = f" {'of ' + self.over:>14}" if self.threshold is not None else ""
        lines = [met, f"{'parameter':{wide}} {'value':>12} {'of growth':>12} {'of frequency':>12} {'apart':>12}{more}"]
        for name, *numbers in self.rows():
            shown = numbers if self.threshold is not None else numbers[:-1]
            widths = [12, 12, 12, 12, 14]
            cells = (f"{'-':>{w}}" if np.isnan(x) else f"{x + 0.0:{w}.4g}" for x, w in zip(shown, widths, strict=False))
            lines.append(f"{name:{wide}} " + " ".join(cells))
        if np.isnan(self.slopes).any():
            lines.append("-: where the two modes have met, eigenvalues have no derivative; apart has one")
        return "\n".join(lines)


def derivatives(
    places: Places, at: Mapping[str, float], names: Sequence[str], near: complex, over: str | None
) -> Derivatives:
    """Derivatives of the eigenvalue that is next to ``near``; ``over``: the parameter that is critical here."""
    steady = places.steady(at)
    A = steady.matrix()
    found: Any = scipy.linalg.eig(A, left=True, right=True)
    values, left, right = found
    k = int(np.argmin(np.abs(values - near)))
    other = _partner(steady, values, right, k)
    scale = steady.scene.parameters
    asked = list(dict.fromkeys([*names, *([over] if over else [])]))
    at_value = {name: float(at.get(name, scale.get(name, places.speeds.get(name, 0.0)))) for name in asked}
    x, y = right[:, k], left[:, k]
    met = abs(np.vdot(y, x)) < _MET
    X, Y = _both(A, values[k], values[other])
    slopes = np.full(len(asked), np.nan, complex)
    split = np.zeros(len(asked))
    B = Y.conj().T @ A @ X
    for i, name in enumerate(asked):
        dA = _difference(places, at, name, at_value[name])
        if not met:
            slopes[i] = (y.conj() @ dA @ x) / np.vdot(y, x)
        dB = Y.conj().T @ dA @ X
        # squared half-distance: (tr B)^2/4 - det B
        turn = dB[0, 0] * B[1, 1] + B[0, 0] * dB[1, 1] - dB[0, 1] * B[1, 0] - B[0, 1] * dB[1, 0]
        split[i] = float((0.5 * np.trace(B) * np.trace(dB) - turn).real)
    p = np.array([at_value[name] for name in asked])
    threshold = None
    if over:
        measure = split if met else slopes.real
        threshold = (-measure / measure[asked.index(over)] * p)[: len(names)]
    n = len(names)
    return Derivatives(
        at=dict(at), eigenvalue=complex(values[k]), partner=complex(values[other]), names=tuple(names), values=p[:n],
        slopes=(slopes * p)[:n], apart=(-split * p)[:n], threshold=threshold, over=over or "",
    )  # fmt: skip


def _partner(steady: SteadySliding, values: Complexes, right: Complexes, k: int) -> int:
    """The mode whose motion lies most in that of mode k and whose frequency is near: the other one of a pair."""
    free = steady.free
    M = steady.system.problem.linear.M[np.ix_(free, free)] if free.size else np.zeros((0, 0))
    n, root = free.size, scipy.linalg.cholesky(M, lower=False)

    def plane(j: int) -> Floats:
        """Motion of a mode, (n, 2), orthonormal in the mass."""
        x = right[:n, j]
        both = np.column_stack([x.real, x.imag])
        made: Floats = np.linalg.qr(root @ (both / np.linalg.norm(both)))[0]
        return made

    mine = plane(k)
    near = np.flatnonzero(values.imag > 0.0) if values[k].imag > 0.0 else np.arange(values.size)
    near = near[near != k]
    if not near.size:
        return k
    close = near[np.argsort(np.abs(values[near].imag - values[k].imag))][:12]
    likeness = [
        float(np.linalg.norm(mine.T @ plane(int(j))) ** 2) / (1.0 + (abs(values[j] - values[k]) / abs(values[k])) ** 2)
        for j in close
    ]
    return int(close[int(np.argmax(likeness))])


def _both(A: Floats, one: complex, other: complex) -> tuple[Complexes, Complexes]:
    """Right and left invariant subspace (m, 2) of two eigenvalues, ``Y^H X = 1``; smooth where they meet."""
    if one == other:
        raise AnalysisError("derivatives: there is one mode alone, which has no partner")
    gap = 1e-6 * max(abs(one), abs(other))

    def chosen(a: complex, b: complex) -> Any:
        return lambda value: min(abs(value - a), abs(value - b)) <= gap

    first = scipy.linalg.schur(A, output="complex", sort=chosen(one, other))
    second = scipy.linalg.schur(A.conj().T, output="complex", sort=chosen(one.conjugate(), other.conjugate()))
    if first[2] != 2 or second[2] != 2:
        raise AnalysisError("derivatives: more than two eigenvalues lie at the same place")
    X, Y = first[1][:, :2], second[1][:, :2]
    return X, Y @ np.linalg.inv(Y.conj().T @ X).conj().T


def _difference(places: Places, at: Mapping[str, float], name: str, value: float) -> Floats:
    """Derivative of the state matrix by a parameter, the equilibrium following."""
    step = _STEP * abs(value) if value else _STEP

    def matrix(by: int) -> Floats:
        return places.steady({**at, name: value + by * step}).matrix()

    try:
        return (matrix(1) - matrix(-1)) / (2.0 * step)
    except FricmbError:  # a value that lies at an end of what is accepted
        pass
    try:
        return (4.0 * matrix(1) - matrix(2) - 3.0 * matrix(0)) / (2.0 * step)
    except FricmbError:
        return (3.0 * matrix(0) - 4.0 * matrix(-1) + matrix(-2)) / (2.0 * step)
