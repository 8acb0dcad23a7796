"""Step control of a run: tolerance, running scales, lengths of steps, and what they wait for."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.problem import Floats, Floats2, Ints, Problem


class Control(Layout):
    """Step control.

    ``rtol``, and where it cannot be had ``blur``, what can (see ``singular_position``); running maxima ``q``,
    ``v``, ``z`` with floors ``floor_v``; ``h`` next step, ``last_h`` the step before; ``old`` (s+1, n + m + n_c +
    nz) its values at 0, c for prediction, by ``weight`` (s, s+1) at ``ahead`` (s,); ``counts``
    work done; ``longest`` step at present, and anywhere, ``bound``; ``span`` (2,) and ``stops`` times to step to;
    ``mass`` (n,) diagonal of M;
    ``made`` step of the factors; ``power`` (s, n_c+2) powers at the stages; ``inertia`` (n,) space
    of ``between_stages``; ``noise_z`` (n_z,) sizes of states that do not matter, ``push_z`` the largest
    force that a unit of each has made; ``growth``: see
    ``step_control.next_step``; ``wanted`` what the error of the last step alone would let the next one be, or what it
    was to be where it was cut; ``knot`` when the next step has to end, since a law or an element bends then (not
    ahead: whenever it likes); ``setting_out`` step that was right where something last let go, to be known anew
    from a step that ``sets_out``; ``halts`` at which no step got any further, the first at ``first_halt``.
    """

    rtol: float
    blur: float
    q: Floats
    v: Floats
    z: Floats
    floor_v: Floats
    h: float
    last_h: float
    old: Floats2
    counts: Ints
    span: Floats
    longest: float
    bound: float
    stops: Floats
    mass: Floats
    made: float
    power: Floats2
    ahead: Floats
    weight: Floats2
    inertia: Floats
    noise_z: Floats
    push_z: Floats
    growth: float
    wanted: float
    knot: float
    setting_out: float
    sets_out: int
    halts: int
    first_halt: float


def control_of(problem: Problem, s: int, size: int) -> Control:
    """Arrays for steps of s stages of ``size`` unknowns each."""
    n, stops = problem.n, problem.signals.breakpoints.size
    return Control(
        0.0, 0.0, np.zeros(n), np.zeros(n), np.zeros(problem.n_z), np.zeros(n), 1.0, 0.0,
        np.zeros((s + 1, size)), np.zeros(8, np.int64), np.zeros(2), 0.0, 0.0, np.zeros(stops), np.zeros(n),
        0.0, np.zeros((s, problem.n_c + 2)), np.zeros(s), np.zeros((s, s + 1)),
        np.zeros(n), np.zeros(problem.n_z), np.zeros(problem.n_z), np.inf, 0.0, -np.inf, np.inf, 0, 0, 0.0,
    )  # fmt: skip


@kernel
def asked(c: Control) -> float:
    """Part of what counts as 1 that a step may err by."""
    return max(c.rtol, c.blur)
