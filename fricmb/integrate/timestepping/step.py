"""One step from one slot of the state to another."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.kernel_library import long_loops
from fricmb.integrate.model.friction_cone import friction_size
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import (
    EVENT_CLOSE,
    EVENT_OPEN,
    EVENT_REVERSAL,
    EVENT_SLIP,
    EVENT_STICK,
    OPEN,
    SLIP,
    STICK,
)
from fricmb.integrate.run.stopped import stopped
from fricmb.integrate.timestepping.free_motion import (
    add_normals,
    add_responses,
    compliances,
    find_normals,
    free_motion,
    responses,
    set_signals,
    structure_forces,
)
from fricmb.integrate.timestepping.friction_discs import mark_stuck, slide_radius
from fricmb.integrate.timestepping.layout import CAUGHT, DRIVES, HELD, HERE, PASSED, SOUND
from fricmb.integrate.timestepping.proximal_newton import solve_contacts
from fricmb.integrate.timestepping.review import first_balls, review_balls
from fricmb.integrate.timestepping.room import Run

#: Most rounds of balls and normal forces in a step.
ROUNDS = 16


@block
@long_loops
def take_step(run: Run, one: int, two: int, t: float, h: float) -> bool:
    """Step from slot one at t to slot two at t + h; whether all that is lagged has settled."""
    n = run.load.shape[0]
    condensed = run.condensed == 1
    set_signals(run, two, t + h)
    structure_forces(run, one, two, h)
    slot = responses(run, h) if condensed else 0
    compliances(run, h, slot)
    for i in range(n):
        run.dv[i] = 0.0
    for c in range(run.N.shape[0]):
        run.push[two, c] = run.N[c]
    if run.varying == 1:
        find_normals(run, one, two, t, h)
        add_normals(run, two, 1.0)
    for a in range(run.belt.shape[0]):
        run.F[two, a] = run.F[one, a]
    first_balls(run, one, two)
    settled = False
    for turn in range(ROUNDS):
        if stopped():
            break
        run.n_rounds += 1
        free_motion(run, one, two, h, slot)
        if not solve_contacts(run, slot, h, run.F[two], run.g[two]):
            break
        mark_stuck(run, run.F[two], run.g[two])
        if condensed:
            add_responses(run, h, slot, run.F[two])
        change = 0.0
        if run.varying == 1:
            add_normals(run, two, -1.0)
            change = find_normals(run, one, two, t, h)
            add_normals(run, two, 1.0)
        change = max(change, review_balls(run, one, two, t, h, turn))
        if change <= run.settled:
            settled = True
            break
    if run.fault == DRIVES:
        run.fault = SOUND  # what counts is where the step ends
    keep_end(run, one, two, t, h)
    return settled


@kernel
def keep_end(run: Run, one: int, two: int, t: float, h: float) -> None:
    """State and modes at the end of the step, energies over it."""
    for i in range(run.load.shape[0]):
        run.v[two, i] = run.v[one, i] + run.dv[i]
        run.q[two, i] = run.q[one, i] + h * (run.v[one, i] + 0.5 * run.dv[i])
    for c in range(run.status.shape[0]):
        row0 = run.row[c]
        still = True
        loss = 0.0
        for a in range(row0, run.row[c + 1]):
            still = still and run.g[two, a] == 0.0
            loss -= 0.5 * h * run.F[two, a] * (run.g[one, a] + run.g[two, a])
        run.loss[two, c] = loss
        run.mode[two, c] = STICK if still and run.push[two, c] > 0.0 else SLIP
        if run.var[c] == 1 and run.push[two, c] == 0.0:
            run.mode[two, c] = OPEN
        forces_at_end(run, one, two, c, t + 0.5 * h, h)
        run.known[two, c] = 0
        run.jolted[two, c] = 1 if run.last[c] >= 0.0 else 0
        if still and (run.status[c] == HELD or run.status[c] == CAUGHT):
            caught = run.status[c] == CAUGHT
            run.known[two, c] = 1 - run.jolted[two, c]
            run.grip[two, c] = run.brake[c]
            run.when[two, c] = t + 0.5 * h * (1.0 + run.share[c] if caught else 1.0)
            for a in range(row0, run.row[c + 1]):
                run.hold[two, a] = run.away[a] if caught else run.F[two, a]
        what_happened(run, one, two, c, t, h)
        if run.what[two, c] >= 0:
            run.strain[two, c] = friction_size(run.row, c, run.away) / run.brake[c] if run.brake[c] > 0.0 else 0.0
    add_powers(run, one, two, h)


@kernel
def forces_at_end(run: Run, one: int, two: int, c: int, middle: float, h: float) -> None:
    """Force of a contact at the end of the step, from the law or from the mean forces of two steps."""
    row0 = run.row[c]
    d = run.row[c + 1] - row0
    speed = magnitude(run.row, c, run.g[two])
    if speed > 0.0:
        radius = slide_radius(run, c, speed, run.push[two, c])
        for a in range(row0, row0 + d):
            run.ends[two, a] = -radius * run.g[two, a] / speed
        return
    gap = middle - run.when[one, c]
    line = run.status[c] == HELD and run.known[one, c] == 1 and run.jolted[two, c] == 0
    share = 0.5 * h / gap if line and gap > 0.25 * h else 0.0
    for a in range(row0, row0 + d):
        force = run.away[a] if run.status[c] == CAUGHT else run.F[two, a]
        run.ends[two, a] = force + share * (force - run.hold[one, a])


@kernel
def forces_at_start(run: Run, two: int) -> None:
    """Forces at the start of the first step, which ended in slot two."""
    for c in range(run.status.shape[0]):
        row0 = run.row[c]
        d = run.row[c + 1] - row0
        speed = magnitude(run.row, c, run.g[HERE])
        radius = slide_radius(run, c, speed, run.push[two, c])
        for a in range(row0, row0 + d):
            run.ends[HERE, a] = run.F[two, a] if speed == 0.0 else -radius * run.g[HERE, a] / speed


@kernel
def what_happened(run: Run, one: int, two: int, c: int, t: float, h: float) -> None:
    """The transition of a contact in the step and where in it, into ``what`` (-1: none) and ``moment``."""
    before, after = run.mode[one, c], run.mode[two, c]
    share = min(max(run.share[c], 0.0), 1.0)
    kind = -1
    if after == OPEN and before != OPEN:
        kind, share = EVENT_OPEN, 0.5
    elif before == OPEN and after != OPEN:
        kind, share = EVENT_CLOSE, 0.5
    elif before == STICK and after == SLIP:
        kind = EVENT_SLIP
    elif before == SLIP and after == STICK:
        kind = EVENT_STICK
    elif before == SLIP and after == SLIP and run.row[c + 1] - run.row[c] == 1 and run.status[c] == PASSED:
        kind = EVENT_REVERSAL if run.g[one, run.row[c]] * run.g[two, run.row[c]] < 0.0 else -1
    run.what[two, c] = kind
    run.moment[two, c] = t + share * h


@kernel
def add_powers(run: Run, one: int, two: int, h: float) -> None:
    """Losses in dampers and work brought in over the step: the change of what is stored, to round-off."""
    n_u = run.u.shape[1]
    lost, brought = 0.0, 0.0
    for i in range(run.load.shape[0]):
        vi = run.v[one, i] + 0.5 * run.dv[i]
        force = 0.0
        for e in range(run.start[i], run.start[i + 1]):
            force += run.visc[e] * (run.v[one, run.column[e]] + 0.5 * run.dv[run.column[e]])
        if run.skew.shape[0] > 0:
            for e in range(run.start[i], run.start[i + 1]):
                j = run.column[e]
                brought -= vi * run.skew[e] * (run.q[one, j] + h * (0.5 * run.v[one, j] + 0.25 * run.dv[j]))
        for e in range(run.in_start[i], run.in_start[i + 1]):
            k = run.in_signal[e]
            force -= run.in_du[e] * (run.u[two, k] - run.u[one, k]) / h
            brought += vi * run.in_b[e] * 0.5 * (run.u[one, k] + run.u[two, k])
        lost += vi * force
    for k in range(n_u):
        rate = (run.u[two, k] - run.u[one, k]) / h
        dashpot = 0.0
        force = -run.drivers[2, k, 0]
        for e in range(run.back_start[k], run.back_start[k + 1]):
            j = run.back_dof[e]
            dashpot += run.back_c[e] * (run.v[one, j] + 0.5 * run.dv[j])
            force += run.back_k[e] * (run.q[one, j] + h * (0.5 * run.v[one, j] + 0.25 * run.dv[j]))
        for j in range(n_u):
            dashpot += run.drivers[1, k, j] * (run.u[two, j] - run.u[one, j]) / h
            force += run.drivers[0, k, j] * 0.5 * (run.u[one, j] + run.u[two, j])
        lost += rate * dashpot
        brought += rate * (force + dashpot)
    for a in range(run.belt.shape[0]):
        brought += run.F[two, a] * 0.5 * (run.w[one, a] + run.w[two, a])
    for c in range(run.acts.shape[0]):
        if run.acts[c] == 1:
            felt = 0.0
            for e in range(run.n_start[c], run.n_start[c + 1]):
                felt += run.n_coef[e] * (run.v[one, run.n_dof[e]] + 0.5 * run.dv[run.n_dof[e]])
            extra = run.push[two, c] - run.N0[c]
            lost -= (extra + run.instant[c, 1]) * run.instant[c, 0]
            brought += extra * (felt - run.instant[c, 0])
    run.spent[two, 0] = h * lost
    run.spent[two, 1] = h * brought
