"""A block's own motion in closed form, its motion under polynomials, and sums that keep what rounding drops."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel


@kernel
def two_sum(high: float, low: float, x: float) -> tuple[float, float]:
    """``high + low + x`` with the rounding error of the first sum added to ``low``."""
    total = high + x
    part = total - high
    return total, low + ((high - (total - part)) + (x - part))


@kernel
def _phi2(x: float) -> float:
    """(exp(x) - 1 - x) / x^2."""
    if abs(x) > 0.5:
        return (math.expm1(x) - x) / (x * x)
    value = 0.0
    for m in range(14, 1, -1):
        value = (1.0 + x * value) / m
    return value


@kernel
def fundamental(w2: float, d: float, t: float) -> tuple[float, float, float]:
    """S, IS, IIS at t: answer of v to a unit acceleration in ``v' = -w2 u - d v``, and its integrals."""
    z2 = w2 * t * t
    delta = d * t
    disc = z2 - 0.25 * delta * delta
    size = max(math.sqrt(abs(z2)), abs(delta))
    if size < 1.0 or (abs(disc) < 1e-2 and size < 25.0):
        k0 = 1.0
        k1 = -delta
        S = 1.0 - 0.5 * delta
        IS = 0.5 - delta / 6.0
        IIS = 1.0 / 6.0 - delta / 24.0
        weight = 0.5
        m = 2
        bound = size
        while bound > 1e-19:
            k2 = -delta * k1 - z2 * k0
            k0 = k1
            k1 = k2
            weight /= m + 1.0
            S += k2 * weight
            IS += k2 * weight / (m + 2.0)
            IIS += k2 * weight / ((m + 2.0) * (m + 3.0))
            bound *= size / m
            m += 1
        return t * S, t * t * IS, t * t * t * IIS
    if d == 0.0 and w2 > 0.0:
        w = math.sqrt(w2)
        half = math.sin(0.5 * w * t)
        S = math.sin(w * t) / w
        return S, 2.0 * half * half / w2, (t - S) / w2
    if disc > 0.0:
        beta = math.sqrt(disc) / t
        decay = math.exp(-0.5 * delta)
        S = decay * math.sin(beta * t) / beta
        dS = decay * math.cos(beta * t) - 0.5 * d * S
        IS = (1.0 - dS - d * S) / w2
        return S, IS, (t - S - d * IS) / w2
    root = math.sqrt(max(-disc, 1e-24))
    far = -0.5 * delta - math.copysign(root, delta)
    near = z2 / far
    x1 = near
    x2 = far
    gap = x1 - x2
    S = math.exp(x2) * math.expm1(gap) / gap if gap < 30.0 else (math.exp(x1) - math.exp(x2)) / gap
    IS = ((math.expm1(x1) / x1 if x1 != 0.0 else 1.0) - math.expm1(x2) / x2) / gap
    return t * S, t * t * IS, t * t * t * (_phi2(x1) - _phi2(x2)) / gap


#: Most terms of a series.
MOST = 200
