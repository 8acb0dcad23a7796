"""Which way contacts slip between rows: in one direction as the steps decided it, in several as the motion goes."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.accelerations import kinematics
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.law_values import magnitude, point_along
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import SLIP


@kernel
def relative_velocity(packed: Packed, s: Scratch, y: State) -> None:
    """G at a row, whose forces are known: normal forces and modes stay."""
    kept = y.N.copy()
    kinematics(packed, s, y)
    for k in range(kept.shape[0]):
        y.N[k] = kept[k]


@kernel
def point_slip(packed: Packed, s: Scratch, y: State) -> None:
    """Directions of slip against the forces in y, which are those of a row or a stage.

    Slip in one direction keeps it until a transition.  That of several turns, and is taken from the interpolated
    velocities, where these say anything.  So is one that no force tells, as loads begin and end with the slip.
    """
    relative_velocity(packed, s, y)
    row = packed.ports.row
    for c in range(y.mode.shape[0]):
        y.n[row[c] : row[c + 1]] = 0.0
        point_along(row, c, y.F, -1.0, y.n)
        if y.mode[c] != SLIP:
            continue
        size = 0.0
        for a in range(row[c], row[c + 1]):
            size += y.size[a]
        turns = row[c + 1] - row[c] > 1 and magnitude(row, c, y.g) > 1e-12 * size
        if turns or magnitude(row, c, y.F) == 0.0:
            point_along(row, c, y.g, 1.0, y.n)
