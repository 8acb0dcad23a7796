"""What a mechanism computes in at one instant: signals, places of bodies and their derivatives, space for templates."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.implicit.scene.pattern import of_pattern
from fricmb.integrate.implicit.scene.problem_structs import mech_of
from fricmb.integrate.implicit.scene.structure import mechanism_of
from fricmb.integrate.model.forces import Scratch, scratch_of
from fricmb.integrate.problem import Codes, Floats, Floats2, Problem


class Moving(Layout):
    """What the present positions and velocities of places are, and space for calls.

    ``s`` the scratch with X; ``grad``, ``hess`` derivatives of the places, ``grad_rate`` the rates of ``grad``; ``ddy``
    (n_y,) second derivatives of the extended coordinates that velocities bring (those of signals: ``s.ddu``); ``x``,
    ``out`` of joints; ``fy``, ``fu`` forces on extended coordinates and signals; ``phi``, ``phi_rate`` constraints and
    their rates; ``form`` (n_c,) 1 where stages find the direction of slip from the force (see ``friction_rows``);
    ``held`` (n_c,) forces by which ports that set out were held, ``part`` the part of the way from there on;
    ``share`` of friction that acts, less than 1 only on the way there (``friction_share``); of a decision that found
    nothing ``furthest``, the largest share reached, and ``unsolved``, how many combinations have no solution; the
    largest force so far, that of the present trial counted in, ``borne``, and of states that were reached,
    ``borne_before``;
    ``slight`` (n_c,) stands in matrices for less slip: where the direction is found from the force a slip velocity that
    is nothing in the step, or its derivative where a port sets out, since slip of 0 leaves forces along directions that
    joints block open; else what slip may change by in the step;
    ``answer`` (m_p,) changes of slip velocities by unit forces there, joints holding, of the instant at which modes are
    being decided; below 0: not known;
    ``rows`` (2, .) what dense rows make of positions and velocities;
    ``way`` (m_p,) the motion in which contacts in loops give way, ``looped`` (n_c,) 1 of those that cannot slip alone.
    """

    s: Scratch
    grad: Floats
    grad_rate: Floats
    hess: Floats
    ddy: Floats
    x: Floats
    out: Floats
    fy: Floats
    fu: Floats
    phi: Floats
    phi_rate: Floats
    form: Codes
    held: Floats
    part: float
    share: float
    furthest: float
    unsolved: int
    borne: float
    borne_before: float
    slight: Floats
    answer: Floats
    way: Floats
    looped: Codes
    rows: Floats2


class Lengths(NamedTuple):
    """Of the space for places and their rates, and for what goes into joints and places and comes out of them."""

    grad: int
    hess: int
    n_x: int
    n_out: int


def lengths(problem: Problem) -> Lengths:
    """How long the arrays for calls have to be."""
    return of_pattern(problem, "lengths", lambda: _lengths(problem))


def _lengths(problem: Problem) -> Lengths:
    m, packed = mechanism_of(problem), mech_of(problem)
    widths = np.asarray(packed.joint.n_x, dtype=int)
    rows = np.diff(m.joints.row)
    directions = int(np.max(np.diff(problem.contacts.row), initial=1))
    slip = directions + 2
    n_x = int(np.max(2 * widths + rows, initial=8))
    n_out = int(np.max(2 * rows + 3 * widths * rows + slip * widths * (widths + 1) + widths + 8, initial=8))
    b = int(np.max(np.diff(m.places.dof_start), initial=1))
    return Lengths(
        grad=int(packed.place.grad_start[-1]),
        hess=int(packed.place.hess_start[-1]),
        n_x=n_x,
        n_out=max(n_out, 2 + 2 * b + 2 * b * b),
    )


def moving_of(problem: Problem) -> Moving:
    """Arrays for evaluating the problem."""
    m, n_u, size = mechanism_of(problem), problem.n_u, lengths(problem)
    return Moving(
        scratch_of(problem), np.zeros(size.grad + 1), np.zeros(size.grad + 1), np.zeros(size.hess + 1), np.zeros(m.n_y),
        np.zeros(size.n_x), np.zeros(size.n_out), np.zeros(m.n_y), np.zeros(n_u + 1),
        np.zeros(m.n_rows), np.zeros(m.n_rows), np.zeros(problem.n_c, np.int8),
        np.zeros(problem.n_c), 1.0, 1.0, 0.0, 0, 0.0, 0.0, np.zeros(problem.n_c),
        np.zeros(problem.m), np.zeros(problem.m), np.zeros(problem.n_c, np.int8),
        np.zeros((2, problem.m + problem.n_c)),
    )  # fmt: skip
