"""The matrix of a step in a band, its factors, and solving with them.

Without pivoting: the symmetric part is positive definite, so that every pivot is safe (Golub and Van Loan, Matrix
Computations, 4.3).
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import Floats
from fricmb.integrate.timestepping.room import Run


@kernel
def assemble(run: Run, h: float, lu: Floats) -> None:
    """M + h C/2 + h^2 K/4 into a band."""
    for e in range(lu.shape[0]):
        lu[e] = 0.0
    half, quarter = 0.5 * h, 0.25 * h * h
    for e in range(run.at.shape[0]):
        lu[run.at[e]] += run.mass[e] + half * run.visc[e] + quarter * run.stiff[e]


@kernel
def add_contacts(run: Run, h: float, weight: Floats, lu: Floats) -> None:
    """Add h W diag(weight) W^T, weight (3 n_c,): 2 x 2 symmetric blocks [11, 12, 22]."""
    b = run.band
    width = 2 * b + 1
    for c in range(run.mode.shape[1]):
        row0 = run.row[c]
        for a in range(row0, run.row[c + 1]):
            for other in range(row0, run.row[c + 1]):
                factor = h * weight[3 * c + (a - row0) + (other - row0)]
                if factor == 0.0:
                    continue
                for e in range(run.w_start[a], run.w_start[a + 1]):
                    i = run.order[run.w_dof[e]]
                    for f in range(run.w_start[other], run.w_start[other + 1]):
                        j = run.order[run.w_dof[f]]
                        lu[i * width + j - i + b] += factor * run.w_coef[e] * run.w_coef[f]


@kernel
def factorise(run: Run, lu: Floats) -> None:
    """L U in place, L with a unit diagonal."""
    b = run.band
    n = run.load.shape[0]
    width = 2 * b + 1
    run.n_factor += 1
    for k in range(n):
        pivot = 1.0 / lu[k * width + b]
        last = min(n - 1, k + b) - k
        upper = lu[k * width + b + 1 : k * width + b + 1 + last]
        for i in range(1, last + 1):
            at = (k + i) * width + b - i
            factor = lu[at] * pivot
            if factor == 0.0:
                continue
            lu[at] = factor
            target = lu[at + 1 : at + 1 + last]
            for j in range(last):
                target[j] -= factor * upper[j]


@kernel
def solve(run: Run, lu: Floats, x: Floats, work: Floats) -> None:
    """Solve in place for x (n,) in the order of the dofs."""
    b = run.band
    n = x.shape[0]
    width = 2 * b + 1
    for j in range(n):
        work[run.order[j]] = x[j]
    for i in range(n):
        first = max(0, i - b)
        value = work[i]
        at = i * width + b - i
        for j in range(first, i):
            value -= lu[at + j] * work[j]
        work[i] = value
    for i in range(n - 1, -1, -1):
        last = min(n - 1, i + b)
        value = work[i]
        at = i * width + b - i
        for j in range(i + 1, last + 1):
            value -= lu[at + j] * work[j]
        work[i] = value / lu[i * width + b]
    for j in range(n):
        x[j] = work[run.order[j]]


@kernel
def times_matrix(run: Run, h: float, x: Floats, out: Floats) -> None:
    """(M + h C/2 + h^2 K/4) x into out."""
    half, quarter = 0.5 * h, 0.25 * h * h
    for i in range(x.shape[0]):
        value = 0.0
        for e in range(run.start[i], run.start[i + 1]):
            value += (run.mass[e] + half * run.visc[e] + quarter * run.stiff[e]) * x[run.column[e]]
        out[i] = value
