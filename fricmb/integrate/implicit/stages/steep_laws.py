"""Smooth laws whose slopes differ from stage to stage, as those of friction that is a logarithm of the slip speed.

Newton's method with the one Jacobian of all stages does not converge there.  Its changes are corrected by what the
slopes of each law, by slip velocities and states, differ by at every stage (Woodbury), as ``turning`` does for
directions of slip.  That costs a solution a row of a law for each factorization: only runs whose steps have not been
solved without it pay that.

A law is asked at a slip velocity of its own, ``tried``, and continued along its slope there: where a change would turn
slip round, far to the other side of rest, ``tried`` goes there slowly while all else changes as it has to.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.lu import lu_factor, lu_solve
from fricmb.integrate.formulas.tableau import Tableau
from fricmb.integrate.implicit.equations.slip_rows import carried, slip_gradient
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.model.law_values import smooth_force
from fricmb.integrate.problem import (
    LAW_SMOOTH,
    OPEN,
    Codes,
    Complexes,
    Complexes2,
    Complexes3,
    Floats,
    Floats2,
    Floats3,
    Ints,
    Pivots,
    Problem,
)

#: Rows of laws, in all stages, up to which changes are corrected: the correction is a full system of so many unknowns.
TOGETHER = 128


class Steep(Layout):
    """Rows of smooth laws: a law of d directions and n_z states has d + n_z, of its forces and of its rates.

    ``on`` 1 where changes are corrected; ``port`` (k,) and ``start`` (k + 1,) rows of each of the k laws, ``row`` (B,)
    their places among the unknowns of a stage.  What a law is a function of changes by its slip velocities, ``slip``
    (B, n) by the velocities, and by its states.  ``base`` (B, w) its slopes in the Jacobian, ``spread`` (s, B, w) what
    those at the stages differ by, ``tried`` (s, m) slip velocities at which laws are asked.

    ``answer`` (B, l, size): changes of the unknowns by a unit residual in a row, in each of the systems into which the
    stages fall apart; ``gain`` (B s, B s) changes of what the laws are functions of by such residuals at stages.
    """

    on: int
    port: Ints
    start: Ints
    row: Ints
    slip: Floats2
    base: Floats2
    spread: Floats3
    tried: Floats2
    answer: Complexes3
    gain: Floats2
    work: Floats
    change: Floats
    sizes: Pivots
    pivots: Pivots


def steep_laws_of(problem: Problem, tab: Tableau, n: int, size: int) -> Steep:
    """Arrays for smooth laws, of n velocities among ``size`` unknowns of a stage; none if they have too many rows."""
    contacts, s = problem.contacts, len(tab.c)
    port = np.flatnonzero(contacts.law == LAW_SMOOTH)
    forces, states = np.diff(contacts.row)[port], np.diff(contacts.z_start)[port]
    if s * int((forces + states).sum()) > TOGETHER or s == 1:
        port, forces, states = port[:0], forces[:0], states[:0]
    state0 = size - problem.n_z
    row = [
        place
        for c, d, nz in zip(port, forces, states, strict=True)
        for place in (
            *range(state0 - problem.m + contacts.row[c], state0 - problem.m + contacts.row[c] + d),
            *range(state0 + contacts.z_start[c], state0 + contacts.z_start[c] + nz),
        )
    ]
    rows, widest = len(row), int((forces + states).max(initial=0))
    start = np.concatenate([[0], np.cumsum(forces + states)])
    return Steep(
        0, port.astype(np.int64), start.astype(np.int64), np.array(row, np.int64), np.zeros((rows, n)),
        np.zeros((rows, widest)), np.zeros((s, rows, widest)), np.zeros((s, problem.m if rows else 0)),
        np.zeros((rows, len(tab.lam), size), complex),
        np.zeros((rows * s, rows * s)), np.zeros((rows * s) ** 2), np.zeros(rows * s), np.zeros(4, np.int32),
        np.zeros(rows * s, np.int32),
    )  # fmt: skip


@kernel
def slopes_of_law(
    mech: Mech, k: Moving, c: int, opened: bool, g: Floats, z: Floats, N: float, out: Floats2, first: int
) -> None:
    """Slopes of the forces and rates of law c by slip velocities and states, into out[first:]."""
    port = mech.port
    d, a0 = port.row[c + 1] - port.row[c], port.z_start[c]
    nz = port.z_start[c + 1] - a0
    smooth_force(port.laws, c, k.s, g, port.row[c], d, carried(mech, c, N), z, a0, nz)
    for i in range(d + nz):
        share = (0.0 if opened else k.share) if i < d else 1.0
        for j in range(d + nz):
            place = d + nz + i * (d + 1 + nz) + (j if j < d else j + 1)
            out[first + i, j] = share * k.s.out[place]


@kernel
def set_base(mech: Mech, k: Moving, steep: Steep, mode: Codes, g: Floats, z: Floats, N: Floats, lam: Floats) -> None:
    """The slopes of the Jacobian that has just been made, and of slip by velocities there."""
    port = mech.port
    for p in range(steep.port.shape[0] if steep.on == 1 else 0):
        c, first = steep.port[p], steep.start[p]
        slopes_of_law(mech, k, c, mode[c] == OPEN, g, z, N[c], steep.base, first)
        for a in range(port.row[c + 1] - port.row[c]):
            slip_gradient(mech, k, c, a, lam, steep.slip[first + a])


@kernel
def changed(mech: Mech, steep: Steep, p: int, i: int, x: Floats | Complexes) -> Any:
    """By how much what law p is a function of, its i-th slip velocity or state, changes with the unknowns by x."""
    c, at = steep.port[p], steep.start[p] + i
    if i >= mech.port.row[c + 1] - mech.port.row[c]:
        return x[steep.row[at]]
    line, total = steep.slip[at], 0.0 * x[0]
    for a in range(line.shape[0]):
        total += line[a] * x[a]
    return total


@kernel
def set_gain(mech: Mech, steep: Steep, tab: Tableau, a: int, i: int, w: Complexes) -> None:
    """Keep the answer w (size,) of system i to a unit residual in row a."""
    s, rows = tab.c.shape[0], steep.row.shape[0]
    steep.answer[a, i] = w
    for p in range(steep.port.shape[0]):
        for e in range(steep.start[p + 1] - steep.start[p]):
            b, value = steep.start[p] + e, changed(mech, steep, p, e, w)
            for j in range(s):
                for l in range(s):
                    old = 0.0 if i == 0 else steep.gain[j * rows + b, l * rows + a]
                    steep.gain[j * rows + b, l * rows + a] = old + (tab.T[j, i] * tab.Tinv[i, l] * value).real


@kernel
def slopes_at_stages(mech: Mech, k: Moving, steep: Steep, mode: Codes, z: Floats2, N: Floats2) -> None:
    """What the slopes at the stages differ by from those of the Jacobian."""
    for j in range(z.shape[0]):
        for p in range(steep.port.shape[0]):
            c = steep.port[p]
            slopes_of_law(mech, k, c, mode[c] == OPEN, steep.tried[j], z[j], N[j, c], steep.spread[j], steep.start[p])
        steep.spread[j] -= steep.base


@kernel
def correct_slopes(mech: Mech, steep: Steep, tab: Tableau, R: Floats2, w: Complexes2) -> None:
    """From the changes R (s, size) by the Jacobian to those by the slopes of every stage; ``w`` is space.

    Rows of residuals have slopes with the sign turned round: x = x_0 + J^-1 E (1 - S U J^-1 E)^-1 S U x_0, where J^-1 E
    are answers, U what laws are functions of, S the spread.
    """
    s, rows = R.shape[0], steep.row.shape[0]
    full = rows * s
    work = steep.work.reshape(full, full)
    for p in range(steep.port.shape[0]):
        first, last = steep.start[p], steep.start[p + 1]
        for j in range(s):
            for e in range(last - first):
                q = j * rows + first + e
                steep.change[q] = changed(mech, steep, p, e, R[j])
                for x in range(full):
                    total = 1.0 if x == q else 0.0
                    for a in range(first, last):
                        total -= steep.gain[x, j * rows + a] * steep.spread[j, a, e]
                    work[x, q] = total
    if not lu_factor(work, steep.sizes, steep.pivots):
        return
    lu_solve(work, steep.change, steep.sizes, steep.pivots)
    for i in range(tab.lam.shape[0]):
        w[i, :] = 0.0
        for p in range(steep.port.shape[0]):
            first, last = steep.start[p], steep.start[p + 1]
            for a in range(first, last):
                part = 0.0j
                for j in range(s):
                    for e in range(last - first):
                        part += tab.Tinv[i, j] * steep.spread[j, a, e] * steep.change[j * rows + first + e]
                for x in range(R.shape[1]):
                    w[i, x] += part * steep.answer[a, i, x]
        for j in range(s):
            for x in range(R.shape[1]):
                R[j, x] += (tab.T[j, i] * w[i, x]).real


#: Part of the slip velocity at the start of a step that a predicted one has to have.
NEAR = 0.1


@kernel
def begin_tries(mech: Mech, steep: Steep, start: Floats, g: Floats2) -> None:
    """Let laws be asked at the predicted slip velocities g first, where these are not far from those at the start."""
    for p in range(steep.port.shape[0]):
        first, last = mech.port.row[steep.port[p]], mech.port.row[steep.port[p] + 1]
        for j in range(g.shape[0]):
            along, begun, size = compare(start[first:last], g[j, first:last])
            near = along > 0.0 and NEAR * begun < size < begun / NEAR
            for a in range(first, last):
                steep.tried[j, a] = g[j, a] if near else start[a]


@kernel
def compare(a: Floats, b: Floats) -> tuple[float, float, float]:
    """The product of two slip velocities, and their sizes."""
    along = one = other = 0.0
    for i in range(a.shape[0]):
        along += a[i] * b[i]
        one += a[i] * a[i]
        other += b[i] * b[i]
    return along, np.sqrt(one), np.sqrt(other)


@kernel
def ask_at_tried(
    mech: Mech, k: Moving, steep: Steep, mode: Codes, i: int, F: Floats, z: Floats, N: Floats, g: Floats, zd: Floats,
    r: Floats, r0: int,
) -> None:  # fmt: skip
    """Residuals r[r0:] of the forces of laws at stage i, and rates of their states, by their values at ``tried``."""
    port = mech.port
    for p in range(steep.port.shape[0]):
        c = steep.port[p]
        first, a0 = port.row[c], port.z_start[c]
        d, nz = port.row[c + 1] - first, port.z_start[c + 1] - a0
        smooth_force(port.laws, c, k.s, steep.tried[i], first, d, carried(mech, c, N[c]), z, a0, nz)
        for e in range(d + nz):
            value = k.s.out[e]
            for b in range(d):
                value += k.s.out[d + nz + e * (d + 1 + nz) + b] * (g[first + b] - steep.tried[i, first + b])
            if e < d:
                r[r0 + first + e] = F[first + e] - (0.0 if mode[c] == OPEN else k.share * value)
            else:
                zd[a0 + e - d] = value


#: Iterations after which slip does not turn round at once; part of its speed at which it then may.
FREE, TURNED = 3, 0.1


@kernel
def try_next(mech: Mech, steep: Steep, g: Floats2, iteration: int) -> bool:
    """Let laws be asked at slip velocities g next, but what turns round there slowly; whether none does.

    Under friction that goes with the logarithm of slip speed Newton overshoots from above the solution to far on the
    other side, and back, without end; from below it comes near from one side.
    """
    free = True
    for p in range(steep.port.shape[0]):
        first, last = mech.port.row[steep.port[p]], mech.port.row[steep.port[p] + 1]
        for j in range(g.shape[0]):
            along, here, to = compare(steep.tried[j, first:last], g[j, first:last])
            turns = iteration >= FREE and along < 0.0 and to > TURNED * here
            for a in range(first, last):
                steep.tried[j, a] = g[j, a] * (TURNED * here / to if turns else 1.0)
            free = free and not turns
    return free


#: Part of the largest force of a contact that its law may miss where Newton's changes are taken for an end.
FAR_OFF = 0.1


@kernel
def is_far_off(mech: Mech, steep: Steep, F: Floats2, r: Floats2, r0: int) -> bool:
    """Whether a law misses its force by far: ``r[:, r0:]`` are residuals of forces at the stages.

    Where slopes have been taken at rest, of a law that is steep there alone, changes of velocities are small wherever
    Newton stands.
    """
    row = mech.port.row
    for p in range(steep.port.shape[0]):
        off, size = 0.0, 1e-290
        for j in range(F.shape[0]):
            for a in range(row[steep.port[p]], row[steep.port[p] + 1]):
                off, size = max(off, abs(r[j, r0 + a])), max(size, abs(F[j, a]))
        if off > FAR_OFF * size:
            return True
    return False


#: Relative round-off of a slip velocity beside the velocities that it is the difference of.
ROUND_OFF = 4e-16


@kernel
def grain_of_slip(steep: Steep, at: int, V: Floats, g: float) -> float:
    """Round-off of the slip velocity g of row ``at``: of velocities, and of what is prescribed."""
    size, moved = 0.0, 0.0
    for i in range(V.shape[0]):
        part = steep.slip[at, i] * V[i]
        size += abs(part)
        moved += part
    return ROUND_OFF * (size + abs(g - moved))


@kernel
def force_that_moves(mech: Mech, steep: Steep, at: int, scale: Floats, h: float) -> float:
    """Force in row ``at`` that within a step h brings a velocity, which nothing else holds, by what counts as 1."""
    least = np.inf
    for i in range(scale.shape[0]):
        lever = abs(steep.slip[at, i])
        if lever > 0.0:
            least = min(least, scale[i] * mech.mass[i] / (lever * h))
    return float(least) if least < np.inf else 0.0


@kernel
def missed_by_laws(
    mech: Mech, k: Moving, steep: Steep, mode: Codes, V: Floats2, F: Floats2, z: Floats2, N: Floats2, scale: Floats,
    h: float, part: float,
) -> float:  # fmt: skip
    """Largest miss of a force from what its law says at ``tried``, over what is allowed.

    That is a ``part`` of the largest force of that row in the step, or of one that is felt: at rest forces are
    round-off.  And what the round-off of slip makes of a force.
    """
    port, worst = mech.port, 0.0
    for p in range(steep.port.shape[0]):
        c = steep.port[p]
        first, a0 = port.row[c], port.z_start[c]
        d, nz = port.row[c + 1] - first, port.z_start[c + 1] - a0
        for j in range(F.shape[0] if mode[c] != OPEN else 0):
            smooth_force(port.laws, c, k.s, steep.tried[j], first, d, carried(mech, c, N[j, c]), z[j], a0, nz)
            for a in range(d):
                size = 1e-290
                for i in range(F.shape[0]):
                    size = max(size, abs(F[i, first + a]))
                allowed = part * max(size, force_that_moves(mech, steep, steep.start[p] + a, scale, h))
                for b in range(d):
                    slope = abs(k.s.out[d + nz + a * (d + 1 + nz) + b])
                    allowed += slope * grain_of_slip(steep, steep.start[p] + b, V[j], steep.tried[j, first + b])
                worst = max(worst, abs(F[j, first + a] - k.share * k.s.out[a]) / allowed)
    return float(worst)
