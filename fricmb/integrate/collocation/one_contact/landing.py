"""The end of a slip: where r falls to 0, the step that ends there, the short rest crossed to second order."""

from __future__ import annotations

import math

from fricmb.integrate.collocation.block_motion import two_sum
from fricmb.integrate.collocation.one_contact.phase import accelerations, project, settle, to_dofs
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.collocation.one_contact.step import (
    commit,
    end_state,
    keep_slip,
    solve_slip,
    step_error,
    transfer_weights,
    weigh,
)  # fmt: skip
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.event_kinds import EVENT_REVERSAL, EVENT_STICK
from fricmb.integrate.formulas.crossing import evaluate, lowest_between, polynomial, root_between

#: Part of its rate by which that of r changes on the way to 0, above which r is no straight line there.
BENT = 0.1


@kernel
def tail_of_r(run: Run, r0: float) -> float:
    """Size of the last Legendre coefficient of r through its values at 0 and, in ``rhs``, the nodes."""
    last = run.tab.top[0, 0] * r0
    for l in range(run.basis.shape[0]):
        last += run.tab.top[0, l + 1] * run.rhs[l]
    return float(abs(last))


@kernel
def grain_of_r(run: Run, h: float) -> float:
    """Round-off of r over a step: of what friction alone changes it by, many forces being about as large."""
    last = run.belt.shape[0] - 1
    return float(1e-14 * h * run.mu_0_N * max(run.D[0, 0], run.D[last, last]))


@kernel
def first_stop(run: Run, r0: float, h: float, tol: float) -> float:
    """Part of the step after which r first is 0, or 2 + e if it stays positive.

    Nodes, the points half-way and minima between them are looked at; e is the error of this polynomial, which friction
    loss follows too, in units of the tolerance.
    """
    s = run.basis.shape[0]
    for i in range(s):
        r = 0.0
        for a in range(run.belt.shape[0]):
            r += run.direction[a, i] * run.relative[a, i]
        run.rhs[i] = r
    low = r0
    high = r0
    for i in range(s):
        low = min(low, run.rhs[i])
        high = max(high, run.rhs[i])
    # slip that dies out ends in round-off, which has no smooth part to resolve
    unresolved = max(0.0, tail_of_r(run, r0) - grain_of_r(run, h)) / (high + 1e-300)
    resolved = 2.0 + unresolved / min(0.03, max(tol, 1e-10))
    if unresolved < 1e-3 and low > 0.5 * (high - low):
        return float(resolved)
    series = run.coefficients
    polynomial(run.tab, r0, run.rhs, series)
    before = 0.0
    falls = False
    for i in range(2 * s):
        # nodes and the points half-way between; a minimum between two of them is looked up
        at = run.tab.c[i // 2]
        if i % 2 == 0:
            at = 0.5 * (at + (run.tab.c[i // 2 - 1] if i > 0 else 0.0))
        value, slope, _ = evaluate(series, at)
        if value > 0.0 and falls and slope > 0.0:
            low = lowest_between(series, before, at, 1e-6 * at)
            if low > 0.0:
                at = low
                value = 0.0
        if value <= 0.0 and (before > 0.0 or r0 > 0.0 or i > 0):
            return root_between(series, before, at, 1e-15 * at)
        falls = slope < 0.0
        before = at
    return float(resolved)


@kernel
def resample(run: Run, m: int, ratio: float) -> None:
    """Directions at the nodes of a step ``ratio`` times as long as the present one."""
    s = run.basis.shape[0]
    for a in range(m):
        for k in range(s):
            value = 0.0
            for l in range(s):
                value += run.monomial[k, l] * run.direction[a, l]
            run.coefficients[k] = value
        for i in range(s):
            t = run.tab.c[i] * ratio
            value = 0.0
            for k in range(s - 1, -1, -1):
                value = value * t + run.coefficients[k]
            run.direction[a, i] = value
    for i in range(s):
        size = 0.0
        for a in range(m):
            size += run.direction[a, i] * run.direction[a, i]
        size = math.sqrt(size)
        for a in range(m):
            run.direction[a, i] /= size


@kernel
def closing_rate(run: Run, since: float) -> float:
    """Rate of r at the end of the step just solved, with the directions of its last node.

    Accelerations and their rates go into ``a``, ``k``, the relative acceleration without friction into ``out[2]``.
    """
    m = run.belt.shape[0]
    end = run.basis.shape[0] - 1
    rate = 0.0
    for j in range(run.w2.shape[1]):
        u = run.u_end[j] + run.low_end[j]
        run.a[j] = run.load[j] + run.slope[j] * since - run.w2[0, j] * u - run.damp[0, j] * run.v_end[j]
        run.k[j] = run.slope[j] - run.w2[0, j] * run.v_end[j]
    for a in range(m):
        value = 0.0
        for j in range(run.w2.shape[1]):
            value += run.c1[a, j] * (run.a[j] - run.e1[j]) + run.c0[a, j] * run.v_end[j]
        run.out[2, a] = value
        for b in range(m):
            value -= run.D[a, b] * run.mu_0_N * run.direction[b, end]
        rate += run.direction[a, end] * value
    return float(rate)


@kernel
def rise_of_rate(run: Run) -> float:
    """Rate of the rate of r, after :func:`closing_rate` and with its directions."""
    end = run.basis.shape[0] - 1
    rise = 0.0
    for a in range(run.belt.shape[0]):
        for j in range(run.w2.shape[1]):
            jerk = run.k[j] - run.damp[0, j] * run.a[j]
            rise += run.direction[a, end] * (run.c1[a, j] * jerk + run.c0[a, j] * (run.a[j] - run.e1[j]))
    return float(rise)


@kernel
def turns(run: Run) -> bool:
    """Whether slip in two dimensions turns round near g = 0 instead of ending there, as friction cannot hold it.

    A path that hits g = 0 all the same is followed until what is left does not matter (:func:`nearly_stopped`).
    """
    if run.belt.shape[0] == 1:
        return False
    hold = 0.0
    for a in range(2):
        force = 0.0
        for b in range(2):
            force += run.D_inv[a, b] * run.out[2, b]
        hold += force * force
    return bool(math.sqrt(hold) > run.mu_0_N * (1.0 + 1e-9))


@kernel
def snap(run: Run, r: float, tau: float) -> None:
    """Go on by a short tau with the end's force, to second order, after :func:`closing_rate`."""
    for j in range(run.w2.shape[1]):
        push = 0.0
        lift = 0.0
        for a in range(run.belt.shape[0]):
            push -= run.b1[a, j] * run.mu_0_N * run.n[a]
            lift -= run.b0[a, j] * run.mu_0_N * run.n[a]
        acceleration = run.a[j] + push
        velocity = run.v[j] + lift
        run.u[j], run.u_low[j] = two_sum(run.u[j], run.u_low[j], velocity * tau + 0.5 * acceleration * tau * tau)
        jerk = run.k[j] - run.w2[0, j] * lift - run.damp[0, j] * acceleration
        run.v[j] += acceleration * tau + 0.5 * jerk * tau * tau
    run.time, run.time_low = two_sum(run.time, run.time_low, tau)
    run.loss += 0.5 * run.mu_0_N * r * tau


@block
def arrive(run: Run, since: float) -> None:
    """The contact has come to g = 0: project, settle what follows, note the transition."""
    before = run.n[0]
    to_dofs(run, 0, run.w2.shape[1], since)
    project(run)
    sticks = settle(run)
    if sticks or (run.belt.shape[0] == 1 and run.n[0] * before < 0.0):
        run.events[run.used[2], 0] = run.time + run.time_low
        run.events[run.used[2], 1] = EVENT_STICK if sticks else EVENT_REVERSAL
        run.used[2] += 1
    run.next_step = run.first_step


@block
def land(run: Run, h: float, root: float, since: float, tol: float, stiff: float) -> float:
    """Try to end the slip with a step of ``root * h``; returns the time gone, or -(its error, at least 1) if it cannot.

    The step's length is corrected by r/r' until what is left is small enough to be crossed to second order.
    """
    m = run.belt.shape[0]
    s = run.basis.shape[0]
    end = s - 1
    length = root * h
    ratio = root
    for _ in range(8):
        resample(run, m, ratio)
        accelerations(run, 0, run.w2.shape[1], since)
        transfer_weights(run, length, 0, stiff)
        weigh(run, length)
        if not solve_slip(run, 0, length, tol):
            return -1e6
        error = step_error(run, length, tol)
        if error > 1.0:
            return -error
        r = 0.0
        turn = 0.0
        for a in range(m):
            r += run.direction[a, end] * run.relative[a, end]
            turn += (run.direction[a, end] - run.direction[a, end - 1]) ** 2
        turn = math.sqrt(turn) / (length * (1.0 - run.tab.c[end - 1]))
        end_state(run, 0, length)
        rate = closing_rate(run, since + length)
        if rate >= 0.0 or turns(run):
            return -4.0
        rise = rise_of_rate(run)
        if rate * rate < 2.0 * r * rise:
            return -4.0  # it turns before it gets there
        tau = -r / rate
        if abs(rise * tau) > BENT * -rate:
            tau = 2.0 * r / (math.sqrt(rate * rate - 2.0 * r * rise) - rate)
        if abs(tau) > 0.5 * length:
            return -4.0
        reach = max(run.change[0], run.change[m - 1]) * run.mu_0_N * abs(tau)
        swing = abs(tau) * run.fastest
        # where friction is next to nothing it is the structure's own motion that is left out
        own = abs(rise * tau) / (max(run.D[0, 0], run.D[m - 1, m - 1]) * run.mu_0_N + 1e-300) / 6.0
        left = 0.5 * turn * abs(tau) + swing * max(0.2 * swing, own)
        if reach * left <= 5e-3 * tol and swing <= 0.01:
            accelerations(run, 0, run.w2.shape[1], since)
            loss = keep_slip(run, length)
            commit(run, length, loss)
            closing_rate(run, since + length)
            snap(run, r, tau)
            return length + tau
        ratio = 1.0 + tau / length
        length += tau
    return -2.0


@kernel
def nearly_stopped(run: Run, since: float, tol: float, r: float, h: float) -> bool:
    """Whether g is too small to matter and falls: then the rest is crossed at once."""
    m = run.belt.shape[0]
    reach = 0.0
    for a in range(m):
        for b in range(m):
            reach = max(reach, abs(run.D_inv[a, b]))
    if r * reach * max(run.change[0], run.change[m - 1]) > 1e-5 * tol:
        return False
    rate = closing_rate(run, since)
    if rate >= 0.0 or rate * rate < 2.0 * r * rise_of_rate(run):
        return False  # it turns before it gets there
    if -r / rate <= h:
        snap(run, r, -r / rate)
        return True
    # slip that dies out never gets to 0
    return bool(r <= grain_of_r(run, h))
