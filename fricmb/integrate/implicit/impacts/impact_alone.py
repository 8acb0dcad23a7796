"""An impact of one contact that nothing rigid is held beside, and that does not end its bounces: most impacts are such.

The same as ``impact`` computes for any number of them, in one call of compiled code.  Whatever is not as usual is left
to that: another contact near by, no impulse or several that fit, energy that is gained, a bounce that may be the last.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel, run_entry
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.lu import lu_factor, lu_solve
from fricmb.integrate.compile.room import room
from fricmb.integrate.implicit.impacts.impact_law import GAIN, ROUND_OFF
from fricmb.integrate.implicit.impacts.impact_rest import INSTANT, SEEN, SHORT, Bounces
from fricmb.integrate.implicit.impacts.impact_resume import go_on
from fricmb.integrate.implicit.impacts.impact_rows import accelerations_of_gaps, rows_at
from fricmb.integrate.implicit.impacts.impact_surfaces import SAME, SHORTEST, STILL
from fricmb.integrate.implicit.output.recorder import Record, copy_state
from fricmb.integrate.implicit.scene.control import Control
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.scene.watch import Watch
from fricmb.integrate.mechanism import APART, RIGID, Mechanism
from fricmb.integrate.problem import NORMAL_REACTION, Codes, Floats, Floats2, Ints, Problem
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.run.mode_changes import record_changes
from fricmb.integrate.run.outcomes import DONE

#: Unknowns up to which matrices are solved here.
MOST = 40


class Alone(Layout):
    """What is known of rigid joints in a run, and space.

    Of each joint (n_j,) ``e``, ``e_t``, ``mu`` coefficients; ``t``, ``falls``, ``count`` its last impact (see
    ``Bounces``), ``times`` (n_j, 3) those between the last ones; ``clock`` (4,) time of the last impact of any, time
    since the one before, time of the last and number of impacts at one instant; ``bears`` (n_c,) 1 for dry ports that
    have borne an impulse; ``held``, ``of`` (m,) rows that hold, and their joints; ``found`` (5,) impulses along the
    normal and slip, approach, energy lost, the joint.
    """

    poisson: int
    e: Floats
    e_t: Floats
    mu: Floats
    t: Floats
    falls: Floats
    count: Ints
    times: Floats2
    clock: Floats
    bears: Codes
    fresh: Codes
    held: Ints
    of: Ints
    found: Floats
    v: Floats
    G: Floats2
    G0: Floats
    W: Floats2
    W0: Floats
    gap: Floats
    noise: Floats
    normal: Floats
    slip: Floats
    pressed: Floats
    push: Floats2
    rate: Floats
    after: Floats
    impulse: Floats


@kernel
def first_row(mech: Mech, j: int) -> int:
    """Row of a joint."""
    return int(min(mech.joint.row[j], mech.joint.dropped.shape[0] - 1))


@kernel
def rate_of(G: Floats2, G0: Floats, r: int, v: Floats) -> float:
    """Rate of row r."""
    value = G0[r]
    for i in range(v.shape[0]):
        value += G[r, i] * v[i]
    return float(value)


@kernel
def reach_of(a: Alone, r: int, c: Control) -> float:
    """Rate of row r that velocities so far could bring."""
    value = abs(a.G0[r])
    for i in range(c.v.shape[0]):
        value += abs(a.G[r, i]) * c.v[i]
    return float(value)


@kernel
def lone_joint(mech: Mech, y: State, c: Control, out: Watch, a: Alone) -> int:
    """The joint that is hit, where there is one alone and no rigid one is held; else -1."""
    joint = mech.joint
    same = SAME * abs(y.t) + SHORTEST * (c.span[1] - c.span[0])
    found, count, soonest, left = -1, 0, -1, 1e300
    for j in range(joint.port.shape[0]):
        r = first_row(mech, j)
        opened = joint.hands_over[j] != 0 and joint.dropped[r] == APART
        if joint.hands_over[j] == RIGID and not opened:
            return -1
        if not opened:
            continue
        rate = rate_of(a.G, a.G0, r, y.v)
        if a.gap[j] <= 10.0 * max(a.noise[j], out.least[j]) + same * abs(rate):
            found = j
            count += 1
        elif rate < 0.0 and a.gap[j] < left * -rate:
            soonest, left = j, a.gap[j] / -rate
    if count == 0:
        found = soonest
    elif soonest >= 0:
        rate = rate_of(a.G, a.G0, first_row(mech, found), y.v)
        if not (rate < 0.0 and a.gap[found] / -rate <= left):
            return -1
    return found if count <= 1 and found >= 0 and joint.hands_over[found] == RIGID else -1


@kernel
def find_held(mech: Mech, a: Alone) -> int:
    """Rows of joints without restitution that hold now, into ``a.held``; their number."""
    joint, m = mech.joint, 0
    for i in range(joint.port.shape[0]):
        for r in range(joint.row[i], joint.row[i + 1] if joint.hands_over[i] != RIGID else joint.row[i]):
            if joint.dropped[r] == 0:
                a.held[m], a.of[m] = r, i
                m += 1
    return m


@kernel
def answers_alone(mech: Mech, y: State, a: Alone, j: int, rows: int) -> int:
    """Changes of velocities, and of what holds both ways, by unit impulses of joint j: ``a.push`` (2, n + m).

    Number of rows that hold; -1 where there are too many, or they depend on one another.
    """
    n, m = y.v.shape[0], find_held(mech, a)
    if n + m > MOST:
        return -1
    K, sizes, pivots = np.zeros((n + m, n + m)), np.zeros(4, np.int32), np.zeros(n + m, np.int32)
    for e in range(mech.linear.M.shape[0]):
        K[mech.linear.Mi[e], mech.linear.Mj[e]] += mech.linear.M[e]
    for i in range(m):
        for e in range(n):
            K[n + i, e] = K[e, n + i] = a.G[a.held[i], e]
    if not lu_factor(K, sizes, pivots):
        return -1
    for p in range(rows):
        a.push[p] = 0.0
        for e in range(n):
            a.push[p, e] = a.G[first_row(mech, j), e] if p == 0 else a.W[mech.port.row[mech.joint.port[j]], e]
        lu_solve(K, a.push[p, : n + m], sizes, pivots)
    return m


@kernel
def rate_by_impulse(mech: Mech, a: Alone, j: int, p: int, q: int, n: int) -> float:
    """Rate along row p by a unit impulse along row q."""
    value = 0.0
    for i in range(n):
        value += (a.G[first_row(mech, j), i] if p == 0 else a.W[mech.port.row[mech.joint.port[j]], i]) * a.push[q, i]
    return float(value)


@kernel
def obeys(a: Alone, j: int, doing: int, target: float, size: float) -> bool:
    """Whether impulses and rates contradict nothing: it sticks (0), or slips one way (1) or the other (-1)."""
    force, small = ROUND_OFF * max(abs(a.impulse[0]), abs(a.impulse[1])), ROUND_OFF * size
    if a.impulse[0] < -force:
        return False
    if doing == 0:
        return bool(abs(a.impulse[1]) <= a.mu[j] * max(a.impulse[0], 0.0) + force)
    return bool((a.after[1] - target) * doing >= -small)


@kernel
def rub(a: Alone, j: int, D: Floats2) -> bool:
    """Impulses with friction, by Newton's law in Moreau's form: the first of stick, slip, slip back that obeys it.

    False where none does, or another one as well.
    """
    aims, size = (-a.e[j] * a.rate[0], -a.e_t[j] * a.rate[1]), max(abs(a.rate[0]), abs(a.rate[1]))
    b, c, count = aims[0] - a.rate[0], aims[1] - a.rate[1], 0
    kept_n = kept_t = first_n = first_t = 0.0
    for k in range(3):
        doing = k if k < 2 else -1
        if doing == 0:
            det = D[0, 0] * D[1, 1] - D[0, 1] * D[1, 0]
            if not det > 1e-9 * D[0, 0] * D[1, 1]:
                return False
            a.impulse[0] = (b * D[1, 1] - c * D[0, 1]) / det
            a.impulse[1] = (c * D[0, 0] - b * D[1, 0]) / det
        else:
            along = D[0, 0] - doing * a.mu[j] * D[0, 1]
            if not along > 0.0:
                return False
            a.impulse[0] = b / along
            a.impulse[1] = -doing * a.mu[j] * a.impulse[0]
        for p in range(2):
            a.after[p] = a.rate[p] + D[p, 0] * a.impulse[0] + D[p, 1] * a.impulse[1]
        if not obeys(a, j, doing, aims[1], size):
            continue
        count += 1
        if count == 1:
            kept_n, kept_t, first_n, first_t = a.impulse[0], a.impulse[1], a.after[0], a.after[1]
        elif max(abs(a.after[0] - first_n), abs(a.after[1] - first_t)) > 1e-6 * size:
            return False
    a.impulse[0], a.impulse[1], a.after[0], a.after[1] = kept_n, kept_t, first_n, first_t
    return count > 0


@kernel
def strike(mech: Mech, y: State, c: Control, a: Alone, j: int) -> int:
    """Impulses of joint j and rates behind them; number of its rows, or 0 where that is not as usual."""
    n, port, r = y.v.shape[0], mech.joint.port[j], first_row(mech, j)
    rows = 2 if port >= 0 and a.mu[j] > 0.0 else 1
    a.rate[0] = rate_of(a.G, a.G0, r, y.v)
    a.rate[1] = rate_of(a.W, a.W0, mech.port.row[port], y.v) if rows == 2 else 0.0
    if not a.rate[0] < 0.0 or (rows == 2 and a.poisson != 0):
        return 0
    m = answers_alone(mech, y, a, j, rows)
    if m < 0:
        return 0
    D = np.zeros((2, 2))
    for p in range(rows):
        for q in range(rows):
            D[p, q] = rate_by_impulse(mech, a, j, p, q, n)
    a.impulse[:] = 0.0
    if not D[0, 0] > 0.0:
        return 0
    if rows == 1:
        a.impulse[0] = -(1.0 + a.e[j]) * a.rate[0] / D[0, 0]
        a.after[0], a.after[1] = a.rate[0] + D[0, 0] * a.impulse[0], 0.0
    elif not rub(a, j, D):
        return 0
    if not (a.impulse[0] > 0.0 and a.after[0] > STILL * reach_of(a, r, c)):
        return 0
    return rows if bears_it(mech, a, m, rows, n) else 0


@kernel
def bears_it(mech: Mech, a: Alone, m: int, rows: int, n: int) -> bool:
    """Whether nothing that only pushes would have to pull; dry ports that bear impulses are marked."""
    top = max(abs(a.impulse[0]), abs(a.impulse[1]))
    for i in range(m):
        reaction, port = 0.0, mech.joint.port[a.of[i]]
        for p in range(rows):
            reaction -= a.push[p, n + i] * a.impulse[p]
        if mech.joint.one_sided[a.of[i]] != 0 and reaction < -1e-9 * top:
            return False
        if port >= 0 and mech.port.normal[port] == NORMAL_REACTION and abs(reaction) > 0.0:
            a.bears[port] = 1
    return True


@kernel
def momentum_times(mech: Mech, u: Floats, v: Floats) -> float:
    """``u M v``."""
    value = 0.0
    for e in range(mech.linear.M.shape[0]):
        value += u[mech.linear.Mi[e]] * mech.linear.M[e] * v[mech.linear.Mj[e]]
    return float(value)


@kernel
def bounces_on(a: Alone, j: int, speed: float, rises: float, falls: float, size: float, noise: float, t: float) -> bool:
    """Whether this is surely not the last bounce (see ``Bounces.after``)."""
    if speed <= SHORT * size:
        return False
    if not (rises > 0.0 and falls > 0.0) or not a.e[j] * np.sqrt(falls / rises) < 1.0:
        return True
    up = speed / rises
    T = up * (1.0 + np.sqrt(rises / falls)) / (1.0 - a.e[j] * np.sqrt(falls / rises))
    lost = speed * up / 2.0 < SEEN * noise or 64.0 * EPS * abs(t) >= T
    return bool(not lost and SHORT * size / falls < T)


@kernel
def keep(a: Alone, j: int, t: float, falls: float) -> None:
    """Keep what is asked of the last bounces."""
    since = t - a.t[j]
    a.clock[1] = t - a.clock[0]
    a.clock[0] = a.clock[2] = t
    a.clock[3] = 0.0
    a.t[j], a.falls[j] = t, falls
    a.count[j] += 1
    a.times[j, 0], a.times[j, 1], a.times[j, 2] = a.times[j, 1], a.times[j, 2], since


@run_entry
def hit_alone(
    mech: Mech, k: Moving, w: Instant, y: State, before: State, c: Control, out: Watch, rec: Record, part: Codes,
    a: Alone,
) -> bool:  # fmt: skip
    """The impact at y, into ``a.found``; False where it is not one of these, and nothing has been done."""
    rows_at(mech, k, y, a.v, a.G, a.G0, a.W, a.W0, a.gap, a.noise, a.normal, a.slip)
    j = lone_joint(mech, y, c, out, a)
    if j < 0 or y.t - a.clock[2] <= INSTANT * abs(y.t):
        return False
    rows = strike(mech, y, c, a, j)
    if rows == 0:
        return False
    lost = 0.0
    for p in range(rows):
        lost -= 0.5 * a.impulse[p] * (a.after[p] + a.rate[p])
    if lost < -GAIN * (0.5 * momentum_times(mech, y.v, y.v) + abs(lost)):
        return False
    accelerations_of_gaps(mech, k, y, a.pressed)
    falls, n = -a.pressed[j], y.v.shape[0]
    copy_state(y, before)
    dropped = mech.joint.dropped.copy()
    change, mean = np.zeros(n), np.zeros(n)
    for i in range(n):
        for p in range(rows):
            change[i] += a.push[p, i] * a.impulse[p]
        mean[i] = y.v[i] + 0.5 * change[i]
        y.v[i] += change[i]
    fed = momentum_times(mech, change, mean)
    y.work[y.work.shape[0] - 2] += lost
    y.work[y.work.shape[0] - 1] += fed + lost
    code = go_on(mech, k, w, y, c, out, part, a.fresh)
    accelerations_of_gaps(mech, k, y, a.pressed)
    size = max(reach_of(a, first_row(mech, j), c), -a.rate[0])
    noise = max(a.noise[j], out.least[j])
    if code != DONE or not bounces_on(a, j, a.after[0], -a.pressed[j], falls, size, noise, y.t):
        copy_state(before, y)
        mech.joint.dropped[:] = dropped
        return False
    keep(a, j, y.t, falls)
    push = max(abs(a.impulse[0]), abs(a.impulse[1])) / (c.span[1] - c.span[0])
    out.top_force = max(out.top_force, push)
    record_changes(mech.port, y.t, y, before, rec)
    a.found[0], a.found[1], a.found[2], a.found[3], a.found[4] = a.impulse[0], a.impulse[1], -a.rate[0], lost, j
    return True


def room_alone(problem: Problem, mechanism: Mechanism, bounces: Bounces, mu: Floats) -> Alone:
    """For joints with coefficients of friction ``mu`` (n_j,) in impacts, and what is known of their bounces."""
    joints, n, m_p = mechanism.joints, problem.n, problem.m
    m, n_j, solid = mechanism.n_rows, len(joints.port), np.ascontiguousarray
    return room(Alone(
        int(mechanism.poisson), solid(joints.restitution, float), solid(joints.tangential, float), solid(mu, float),
        bounces.t, bounces.falls, bounces.count, bounces.times, bounces.clock, np.zeros(problem.n_c, np.int8),
        np.zeros(problem.n_c, np.int8), np.zeros(m, np.int64), np.zeros(m, np.int64), np.zeros(5), np.zeros(n),
        np.zeros((m, n)), np.zeros(m), np.zeros((m_p, n)), np.zeros(m_p), np.zeros(n_j), np.zeros(n_j), np.zeros(m),
        np.zeros(m_p), np.zeros(n_j), np.zeros((2, n + m)), np.zeros(2), np.zeros(2), np.zeros(2),
    ))  # fmt: skip
