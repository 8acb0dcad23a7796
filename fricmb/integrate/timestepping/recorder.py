"""Rows and transitions that a run leaves, and copies of its state."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.timestepping.layout import HERE
from fricmb.integrate.timestepping.room import Run


@kernel
def copy_state(run: Run, source: int, target: int) -> None:
    """One slot of the state into another."""
    run.q[target] = run.q[source]
    run.v[target] = run.v[source]
    run.u[target] = run.u[source]
    run.du[target] = run.du[source]
    run.g[target] = run.g[source]
    run.w[target] = run.w[source]
    run.F[target] = run.F[source]
    run.ends[target] = run.ends[source]
    run.hold[target] = run.hold[source]
    run.grip[target] = run.grip[source]
    run.when[target] = run.when[source]
    run.known[target] = run.known[source]
    run.jolted[target] = run.jolted[source]
    run.mode[target] = run.mode[source]
    run.push[target] = run.push[source]


@kernel
def keep_row(run: Run, slot: int, normal: int, t: float) -> None:
    """A row of the state, with the normal forces of slot ``normal``."""
    k = run.n_rows
    run.row_t[k] = t
    run.row_q[k] = run.q[slot]
    run.row_v[k] = run.v[slot]
    run.row_F[k] = run.ends[slot]
    run.row_g[k] = run.g[slot]
    run.row_N[k] = run.push[normal]
    run.row_mode[k] = run.mode[slot]
    run.row_loss[k] = run.total
    run.row_x[k, 0] = run.spent[HERE, 0]
    run.row_x[k, 1] = run.spent[HERE, 1]
    run.n_rows = k + 1


@kernel
def keep_event(run: Run, t: float, c: int, kind: int) -> None:
    """Add a transition."""
    e = run.n_events
    run.event[e, 0] = t
    run.event[e, 1] = c
    run.event[e, 2] = kind
    run.n_events = e + 1
