"""The start of a run: what velocities and positions are noise beside the forces, and which contacts stick."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import entry, run_entry
from fricmb.integrate.contact.mode_decision import find_open, mark_rest, settle
from fricmb.integrate.contact.rest_problem import Rest
from fricmb.integrate.contact.transition import Before, keep_modes, record_changes
from fricmb.integrate.csr import Csr
from fricmb.integrate.model.forces import Scratch, set_time
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.model.structure import Structure
from fricmb.integrate.output.recorder import AFTER, Rows, record
from fricmb.integrate.problem import SLIP, Floats, Floats2, Problem


@run_entry
def begin(packed: Packed, s: Scratch, y: State, r: Rest, old: Before, given: bool, out: Rows) -> int:
    """Modes at the start of a run: from D^-1 a against the cone where g = 0, not from the velocity; see ``settle``.

    ``given``: modes and directions come from an earlier run and are kept where they can be; where they cannot (a
    lighter load), that is a transition.
    """
    if not given:
        find_open(packed, s, y)
    mark_rest(packed, s, y, r, True)
    if given:
        for k in range(y.mode.shape[0]):
            if r.part[k] == 1 and y.mode[k] == SLIP:
                r.part[k] = 2
        keep_modes(y, old)
    code = settle(packed, s, y, r)
    if given and code == 0:
        record_changes(packed.ports, y.t, y, old, out)
    record(out, y, AFTER)
    return code


@entry
def sample_signals(packed: Packed, s: Scratch, times: Floats, n: int, out: Floats2) -> None:
    """Prescribed signals at the times: row j holds u, then u'."""
    nu = s.ddu.shape[0]
    for j in range(times.shape[0]):
        set_time(packed.signals, s, times[j], n)
        for i in range(2 * nu):
            out[j, i] = s.X[1 + 2 * n + i]


#: Times of a run at which prescribed signals are looked at for their size.
SAMPLES = 65


def signal_scales(problem: Problem, packed: Packed, s: Scratch, t: float, span: float) -> tuple[Floats, float, float]:
    """Largest forces on the dofs (n,), speed and distance of drivers that the prescribed signals bring in the run."""
    n, nu = problem.n, problem.n_u
    if nu == 0:
        return np.zeros(n), 0.0, 0.0
    values = np.zeros((SAMPLES, 2 * nu))
    sample_signals(packed, s, np.linspace(t, t + span, SAMPLES), n, values)
    values = np.where(np.isfinite(values), values, 0.0)
    u, rate = np.abs(values[:, :nu]).max(axis=0), np.abs(values[:, nu:]).max(axis=0)
    structure = packed.structure
    moves = ~np.any(structure.B != 0.0, axis=0)
    load = np.abs(structure.B) @ u + np.abs(structure.Ku) @ u + np.abs(structure.Cu) @ rate
    way = np.ptp(values[:, :nu], axis=0)
    return load, float(np.max(rate[moves], initial=0.0)), float(np.max(way[moves], initial=0.0))


def magnitudes(structure: Structure) -> Csr:
    """Of the entries of M^-1."""
    n = len(structure.f)
    return Csr((n, n), structure.Minv_start, structure.Minv_index, np.abs(structure.Minv))


def natural_scales(
    problem: Problem, packed: Packed, s: Scratch, t: float, span: float, q: Floats
) -> tuple[Floats, Floats]:
    """Velocities and positions (n,) that the scene's own forces bring about in its own time, from positions q.

    Friction mu_s N, constant and prescribed forces, those of springs at the start (friction whose normal force varies
    may hold them for ever, with nothing else to tell a size by) and the speed of drivers, over the time 1/omega of the
    fastest oscillation (the span where there is none).  Signals far below them are noise, also where a run starts with
    nothing moving.
    """
    contacts, structure = problem.contacts, packed.structure
    if problem.n == 0:
        return np.zeros(0), np.zeros(0)
    per_row = np.repeat(np.abs(contacts.mu_s) * np.maximum(contacts.N, np.abs(contacts.N0)), np.diff(contacts.row))
    load, driven_speed, driven_way = signal_scales(problem, packed, s, t, span)
    springs = Csr((problem.n, problem.n), structure.first, structure.column, structure.K) @ np.asarray(q, dtype=float)
    forces = np.abs(contacts.W) @ per_row + np.abs(structure.f) + load + np.abs(springs)
    acceleration = magnitudes(structure) @ forces
    omega = float(np.max(problem.omega, initial=0.0))
    time = min(1.0 / omega, span) if omega > 0.0 else span
    speed = max(float(np.max(np.abs(contacts.w), initial=0.0)), driven_speed)
    top = max(float(np.max(acceleration)) * time, speed)
    return np.full(problem.n, top), np.full(problem.n, max(top * time, driven_way))
