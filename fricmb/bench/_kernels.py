"""Compiled right-hand side and Jacobian of a smoothed scene; arguments are described in ``_smooth``.

Places in ``ints``: n, m, n_z, n_u, n_c, spare; then where each array starts (15 in ints: pointers and indices of the
structure A, ports P, rows R, drivers D, then row, law, z_start, law addresses, law p_start, signal addresses, signal
p_start; 11 in floats: data of A, P, R, D, then constant, w, mu_s, mu_0, N, law p, signal p).
"""

from __future__ import annotations

import math

import numpy as np

from fricmb.bench._reference import Floats, Ints
from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.compile.template import call

_I0 = 6
A_PTR, A_IDX, P_PTR, P_IDX, R_PTR, R_IDX, D_PTR, D_IDX, ROW, LAW, Z_START, L_ADR, L_P, S_ADR, S_P = range(_I0, _I0 + 15)
A_VAL, P_VAL, R_VAL, D_VAL, CONST, W_, MU_S, MU_0, N_, LAW_P, SIG_P = range(_I0 + 15, _I0 + 26)
N_FIXED = _I0 + 26
_PEAK = math.sqrt(2.0 * math.e)
_WIDTH = 10.0 * math.sqrt(2.0)


@kernel
def signals(t: float, u: Floats, up: Floats, f: Floats, k: Ints) -> None:
    """Prescribed signals and their derivatives."""
    x, out = np.empty(1), np.empty(3)
    x[0] = t
    for i in range(k[3]):
        call(k[k[S_ADR] + i], x, 0, f, k[SIG_P] + k[k[S_P] + i], out, 0)
        u[i], up[i] = out[0], out[1]


@kernel
def slip(y: Floats, up: Floats, g: Floats, f: Floats, k: Ints) -> None:
    """Relative velocities of all rows."""
    for a in range(k[1]):
        s = -f[k[W_] + a]
        for j in range(k[k[R_PTR] + a], k[k[R_PTR] + a + 1]):
            s += f[k[R_VAL] + j] * y[2 * k[k[R_IDX] + j] + 1]
        for j in range(k[k[D_PTR] + a], k[k[D_PTR] + a + 1]):
            s -= f[k[D_VAL] + j] * up[k[k[D_IDX] + j]]
        g[a] = s


@kernel
def coefficient(c: int, r: float, f: Floats, k: Ints, out: Floats) -> None:
    """The smoothed coefficient m(r) and its derivative into out[0], out[1]."""
    eps = f[0]
    th = math.tanh(r / eps)
    dth = (1.0 - th * th) / eps
    if k[k[LAW] + c] == 0:
        mu_s, mu_k, s = f[k[MU_S] + c], f[k[MU_0] + c], _WIDTH * eps
        bump = (mu_s - mu_k) * _PEAK * math.exp(-((r / s) ** 2))
        out[0] = mu_k * th + bump * r / s
        out[1] = mu_k * dth + bump * (1.0 - 2.0 * (r / s) ** 2) / s
        return
    x, law = np.empty(2), np.empty(3)
    x[0], x[1] = r, f[k[N_] + c]
    call(k[k[L_ADR] + c], x, 0, f, k[LAW_P] + k[k[L_P] + c], law, 0)
    out[0] = law[0] * th
    out[1] = law[1] * th + law[0] * dth


@kernel
def friction(c: int, y: Floats, g: Floats, F: Floats, dF: Floats, zp: Floats, dz: Floats, f: Floats, k: Ints) -> None:
    """Force of contact c (its rows of F), dF/dg (d, d); for a law with states z' and [dF/dz; dz'/dv; dz'/dz] in dz."""
    a0, a1 = k[k[ROW] + c], k[k[ROW] + c + 1]
    d = a1 - a0
    N = f[k[N_] + c]
    if k[k[LAW] + c] == 2:
        z0 = k[k[Z_START] + c]
        nz = k[k[Z_START] + c + 1] - z0
        x, out = np.empty(d + 1 + nz), np.empty((d + nz) * (d + 2 + nz))
        for i in range(d):
            x[i] = g[a0 + i]
        x[d] = N
        for i in range(nz):
            x[d + 1 + i] = y[2 * k[0] + z0 + i]
        call(k[k[L_ADR] + c], x, 0, f, k[LAW_P] + k[k[L_P] + c], out, 0)
        for i in range(d):
            F[a0 + i] = out[i]
        for i in range(nz):
            zp[z0 + i] = out[d + i]
        width, base = d + 1 + nz, d + nz
        for i in range(d + nz):
            for j in range(d):
                if i < d:
                    dF[i, j] = out[base + i * width + j]
                dz[i, j] = out[base + i * width + j]
            for j in range(nz):
                dz[i, d + j] = out[base + i * width + d + 1 + j]
        return
    r = 0.0
    for a in range(a0, a1):
        r += g[a] * g[a]
    r = math.sqrt(r)
    m = np.empty(2)
    coefficient(c, r, f, k, m)
    ratio = m[0] / r if r > 1e-9 * f[0] else m[1]
    for i in range(d):
        F[a0 + i] = -N * ratio * g[a0 + i]
        for j in range(d):
            dF[i, j] = -N * ratio if i == j else 0.0
            if r > 1e-9 * f[0]:
                dF[i, j] -= N * (m[1] - ratio) * (g[a0 + i] / r) * (g[a0 + j] / r)


@entry
def relative(t: float, y: Floats, g: Floats, F: Floats, f: Floats, k: Ints) -> None:
    """Relative velocities and forces of all rows."""
    u, up = np.empty(k[3]), np.empty(k[3])
    signals(t, u, up, f, k)
    slip(y, up, g, f, k)
    size = k[1] + k[2] + 2
    dF, dz, zp = np.empty((2, 2)), np.empty((size, size)), np.empty(k[2] + 1)
    for c in range(k[4]):
        friction(c, y, g, F, dF, zp, dz, f, k)


@entry
def right_hand_side(t: float, y: Floats, out: Floats, f: Floats, k: Ints) -> None:
    """The derivative of y into out."""
    n, m, n_z, n_u = k[0], k[1], k[2], k[3]
    u, up = np.empty(n_u), np.empty(n_u)
    signals(t, u, up, f, k)
    g, F = np.empty(m), np.empty(m)
    slip(y, up, g, f, k)
    size = 2 + n_z
    dF, dz, zp = np.empty((2, 2)), np.empty((size, size)), np.empty(n_z)
    for c in range(k[4]):
        friction(c, y, g, F, dF, zp, dz, f, k)
    for i in range(n_z):
        out[2 * n + i] = zp[i]
    for i in range(n):
        s = f[k[CONST] + i]
        for j in range(k[k[A_PTR] + i], k[k[A_PTR] + i + 1]):
            l = k[k[A_IDX] + j]
            if l < n:
                x = y[2 * l]
            elif l < 2 * n:
                x = y[2 * (l - n) + 1]
            elif l < 2 * n + n_u:
                x = u[l - 2 * n]
            else:
                x = up[l - 2 * n - n_u]
            s += f[k[A_VAL] + j] * x
        for j in range(k[k[P_PTR] + i], k[k[P_PTR] + i + 1]):
            s += f[k[P_VAL] + j] * F[k[k[P_IDX] + j]]
        out[2 * i] = y[2 * i + 1]
        out[2 * i + 1] = s


@entry
def jacobian(t: float, y: Floats, J: Floats, f: Floats, k: Ints) -> None:
    """The Jacobian of the derivative, into J, which is zero on entry."""
    n, m, n_z, n_u = k[0], k[1], k[2], k[3]
    u, up = np.empty(n_u), np.empty(n_u)
    signals(t, u, up, f, k)
    g, F = np.empty(m), np.empty(m)
    slip(y, up, g, f, k)
    for i in range(n):
        J[2 * i, 2 * i + 1] = 1.0
        for j in range(k[k[A_PTR] + i], k[k[A_PTR] + i + 1]):
            l = k[k[A_IDX] + j]
            if l < n:
                J[2 * i + 1, 2 * l] += f[k[A_VAL] + j]
            elif l < 2 * n:
                J[2 * i + 1, 2 * (l - n) + 1] += f[k[A_VAL] + j]
    size = 2 + n_z
    # rows of D: dF/dg of the two rows of the contact a row belongs to
    D, dF, dz, zp = np.zeros((m, 2)), np.empty((2, 2)), np.zeros((size, size)), np.empty(n_z)
    first = np.empty(m, np.int64)
    Fz = np.zeros((m, n_z))
    for c in range(k[4]):
        a0, a1 = k[k[ROW] + c], k[k[ROW] + c + 1]
        friction(c, y, g, F, dF, zp, dz, f, k)
        for a in range(a0, a1):
            first[a] = a0
            for b in range(a1 - a0):
                D[a, b] = dF[a - a0, b]
        if k[k[LAW] + c] == 2:
            states(c, a0, a1, dz, Fz, J, f, k)
    for i in range(n):
        for j in range(k[k[P_PTR] + i], k[k[P_PTR] + i + 1]):
            a, p = k[k[P_IDX] + j], f[k[P_VAL] + j]
            for z in range(n_z):
                J[2 * i + 1, 2 * n + z] += p * Fz[a, z]
            for b in range(first[a], min(first[a] + 2, m)):
                if first[b] != first[a]:
                    continue
                for l in range(k[k[R_PTR] + b], k[k[R_PTR] + b + 1]):
                    J[2 * i + 1, 2 * k[k[R_IDX] + l] + 1] += p * D[a, b - first[a]] * f[k[R_VAL] + l]


@kernel
def states(c: int, a0: int, a1: int, dz: Floats, Fz: Floats, J: Floats, f: Floats, k: Ints) -> None:
    """What a law's states bring: dF/dz into Fz, rows of z' into J."""
    n, d = k[0], a1 - a0
    z0, z1 = k[k[Z_START] + c], k[k[Z_START] + c + 1]
    for i in range(z1 - z0):
        for a in range(d):
            Fz[a0 + a, z0 + i] = dz[a, d + i]
        for j in range(z1 - z0):
            J[2 * n + z0 + i, 2 * n + z0 + j] += dz[d + i, d + j]
        for a in range(d):
            for l in range(k[k[R_PTR] + a0 + a], k[k[R_PTR] + a0 + a + 1]):
                J[2 * n + z0 + i, 2 * k[k[R_IDX] + l] + 1] += dz[d + i, a] * f[k[R_VAL] + l]
