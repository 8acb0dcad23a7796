"""Friction of a sliding and spinning disc, for compiled code and for numpy.

P(v, u) is the power of friction per mu N at a speed v of sliding and u of the rim; it is homogeneous of degree 1 and
friction is its gradient, f = dP/dv and t = dP/du.  With x = min(v, u)/max(v, u) <= 1 and m = x^2,

    v < u:  f = (4/(3 pi)) A/x,    t = (4/(9 pi)) ((4 - 2 m) E - (1 - m) K),     A = (1 + m) E - (1 - m) K,
    v > u:  f = (4/(3 pi)) A/m,    t = (4/(9 pi)) ((4 - 2/m) E + (2/m - 5 + 3 m) K)/x,

and dA/dx = 3 x E.  Where these cancel (small x) hypergeometric series take over: f = x F(-1/2, 1/2; 2; m) and
t = (x/4) F(1/2, 1/2; 3; m), with F(-1/2, -1/2; 2; m) the power of fast sliding.
"""

from __future__ import annotations

import math
from typing import Any


def disc_force(x: Any, p: Any, out: Any) -> None:
    """Compiled force: ``x = [vx, vy, R omega, N]``, ``p = [mu, v_reg]``, ``out = [F (3), dF/dx (3 x 4 by rows)]``."""
    vx, vy, w, N = min(max(x[0], -1e20), 1e20), min(max(x[1], -1e20), 1e20), min(max(x[2], -1e20), 1e20), x[3]
    v, u = max(math.hypot(vx, vy), 1e-60), max(abs(w), 1e-60)
    sliding = v > u
    ratio = u / v if sliding else v / u
    m = ratio * ratio
    if ratio < 0.3:
        # term of F(a, b; c; m), summed with the weights of the derivative
        a, c = (0.5, 3.0) if sliding else (-0.5, 2.0)
        term, first, slope = 1.0, 0.0, 0.0
        for k in range(24):
            first += term
            slope += (2 * k + 1) * term
            term *= (a + k) * (0.5 + k) / ((c + k) * (1.0 + k)) * m
        # the small force and its derivative by the ratio
        small, small_slope = (0.25 * ratio * first, 0.25 * slope) if sliding else (ratio * first, slope)
        # P - x dP/dx of the other: P = F(-1/2, -1/2; 2; m) in sliding, 2/3 + integral of f in spinning
        term, power = 1.0, 0.0
        if sliding:
            for k in range(24):
                power += term
                term *= (k - 0.5) * (k - 0.5) / ((2.0 + k) * (1.0 + k)) * m
        else:
            power = 2.0 / 3.0
            for k in range(24):
                power += term * m / (2 * k + 2)
                term *= (k - 0.5) * (0.5 + k) / ((2.0 + k) * (1.0 + k)) * m
        large = power - ratio * small
    else:
        rest = max(1.0 - m, 1e-30)
        mean, geometric, total, weight = 1.0, math.sqrt(rest), 0.5 * m, 0.5
        for _ in range(8):
            half = 0.5 * (mean - geometric)
            mean, geometric = 0.5 * (mean + geometric), math.sqrt(mean * geometric)
            weight *= 2.0
            total += weight * half * half
        K = 0.5 * math.pi / mean
        E = K * (1.0 - total) if rest > 1e-13 else 1.0
        A = (1.0 + m) * E - rest * K
        if sliding:
            large = 4.0 / (3.0 * math.pi) * A / m
            small = 4.0 / (9.0 * math.pi) * ((4.0 - 2.0 / m) * E + (2.0 / m - 5.0 + 3.0 * m) * K) / ratio
            small_slope = 4.0 / (3.0 * math.pi) * (2.0 * A / m - 3.0 * E) / m
        else:
            small = 4.0 / (3.0 * math.pi) * A / ratio
            large = 4.0 / (9.0 * math.pi) * ((4.0 - 2.0 * m) * E - rest * K)
            small_slope = 4.0 / (3.0 * math.pi) * (3.0 * E - A / m)
    f, t = (large, small) if sliding else (small, large)
    # second derivatives of P: degree 0 makes them one number
    bend = small_slope / (v if sliding else u)
    p_vv, p_uu = (ratio * ratio * bend, bend) if sliding else (bend, ratio * ratio * bend)
    p_vu = -ratio * bend
    size = math.hypot(v, u)
    h = math.tanh(size / p[1])
    dh = (1.0 - h * h) / p[1]
    nx, ny, s = vx / v, vy / v, w / u
    gx, gy, gw = f * nx, f * ny, t * s
    load = p[0] * N
    out[0], out[1], out[2] = -load * h * gx, -load * h * gy, -load * h * gw
    across = f / v
    by = dh / size
    out[3] = -load * (h * (p_vv * nx * nx + across * ny * ny) + by * vx * gx)
    out[4] = -load * (h * (p_vv - across) * nx * ny + by * vy * gx)
    out[5] = -load * (h * p_vu * s * nx + by * w * gx)
    out[6] = -p[0] * h * gx
    out[7] = -load * (h * (p_vv - across) * nx * ny + by * vx * gy)
    out[8] = -load * (h * (p_vv * ny * ny + across * nx * nx) + by * vy * gy)
    out[9] = -load * (h * p_vu * s * ny + by * w * gy)
    out[10] = -p[0] * h * gy
    out[11] = -load * (h * p_vu * s * nx + by * vx * gw)
    out[12] = -load * (h * p_vu * s * ny + by * vy * gw)
    out[13] = -load * (h * p_uu + by * w * gw)
    out[14] = -p[0] * h * gw
