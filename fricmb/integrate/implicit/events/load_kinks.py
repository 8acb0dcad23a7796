"""Where the load of a joint has a kink, or a smooth law goes over to another formula.

A reaction passes through 0 that friction takes by its magnitude: guides and points on surfaces are loaded by sums of
magnitudes, N = sum_i |s_i . lam|, linear in the reactions lam until one of them changes its sign.  Formulas of high
order have their order on either side alone, so a step ends there.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.forces import call_joint, directions, friction_at, load_place, loading
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import State
from fricmb.integrate.implicit.scene.watch import Watch
from fricmb.integrate.implicit.stages.stages import Stages
from fricmb.integrate.model.law_values import smooth_force
from fricmb.integrate.problem import LAW_SMOOTH, SLIP, Floats

#: Directions of the reactions in which slopes of a load are compared.
DIRECTIONS = 8
#: Slopes that are the same to round-off, beside their size.
SAME = 1e-9
#: Reactions that are not 0 only by the round-off of locating where they are, beside the largest force.
LEFT = 1e-11


#: Sides of a smooth law's switch, beside 1 for the kink of a load.
BEFORE, BEHIND = 2, 3


@kernel
def law_side(mech: Mech, k: Moving, c: int, g: Floats, N: Floats) -> float:
    """What tells formulas of the smooth law of port c apart (``FrictionLaw.define_switch``); 1 of one that has none.

    It is behind all else that the law puts out, and laws with states have none.
    """
    port = mech.port
    first, a0 = port.row[c], port.z_start[c]
    d = port.row[c + 1] - first
    if port.z_start[c + 1] > a0:
        return 1.0
    k.s.out[d * (d + 2)] = 1.0
    smooth_force(port.laws, c, k.s, g, first, d, N[c], g, 0, 0)
    return float(k.s.out[d * (d + 2)])


@kernel
def slopes(mech: Mech, j: int) -> int:
    """Where in ``k.out`` the slopes dN/dlam of joint j, just evaluated, begin."""
    n_x = mech.joint.n_x[j]
    at = friction_at(n_x, mech.joint.row[j + 1] - mech.joint.row[j])
    return int(load_place(n_x, at, directions(mech, mech.joint.port[j])) + 1)


@kernel
def mark_bends(mech: Mech, k: Moving, out: Watch) -> None:
    """Mark the joints whose load is linear in the reactions by pieces: slopes stay where reactions change a little."""
    joint = mech.joint
    for j in range(joint.port.shape[0]):
        out.bends[j] = 1 if joint.port[j] >= 0 else 0
        first, last = loading(mech, j)
        for d in range(DIRECTIONS if out.bends[j] != 0 else 0):
            for near in range(2):
                for r in range(first, last):
                    # irrational turns: no direction lies on an edge
                    turn = (d + 1) * (r - first + 1) * 0.6180339887498949
                    out.lam[r] = 2.0 * (turn - int(turn)) - 1.0 + near * 1e-4 * (r - first + 1)
                if near == 0:
                    read_slopes(mech, k, j, out.lam, out.side)
                elif compare_slopes(mech, k, j, out.lam, out):
                    out.bends[j] = 0


@kernel
def find_kinks(mech: Mech, k: Moving, y: State, st: Stages, out: Watch) -> None:
    """Kinks of loads within the step from y whose stages are solved: ``kink . lam`` passes from above to below 0 there.

    It is the slope of the load at the start less that at the first stage where it is another.  Where a step has just
    ended at a kink, that at the start is what round-off makes of it, and the first stage serves instead.  The same of
    what tells the formulas of a smooth law apart: BEFORE is above 0 at the start, BEHIND below.
    """
    for c in range(y.mode.shape[0]):
        out.kinked[c] = 0
        if mech.port.law[c] == LAW_SMOOTH:
            side = law_side(mech, k, c, y.g, y.N)
            for i in range(st.tab.c.shape[0]):
                now = law_side(mech, k, c, st.g[i], st.N[i])
                if abs(side) <= LEFT * out.top_force:
                    side = now
                elif side * now < 0.0 and y.mode[c] == SLIP:
                    out.kinked[c] = BEFORE if side > 0.0 else BEHIND
            continue
        j = mech.port.joint[c]
        if j < 0 or y.mode[c] != SLIP or out.bends[j] == 0:
            continue
        read_slopes(mech, k, j, y.lam, out.side)
        for i in range(st.tab.c.shape[0]):
            if compare_slopes(mech, k, j, st.lam[i], out):
                here = 0.0
                first, last = loading(mech, j)
                for r in range(first, last):
                    here += out.kink[r] * y.lam[r]
                if i > 0 or here > LEFT * out.top_force:
                    out.kinked[c] = 1
                    break
                read_slopes(mech, k, j, st.lam[i], out.side)


@kernel
def read_slopes(mech: Mech, k: Moving, j: int, lam: Floats, out: Floats) -> None:
    """Slopes dN/dlam of joint j into its rows of ``out``."""
    call_joint(mech, k, j, lam)
    at = slopes(mech, j)
    first, last = loading(mech, j)
    for r in range(first, last):
        out[r] = k.out[at + r - first]


@kernel
def compare_slopes(mech: Mech, k: Moving, j: int, lam: Floats, out: Watch) -> bool:
    """Whether the slopes at lam are others than in ``side``; the difference is put into ``kink``."""
    read_slopes(mech, k, j, lam, out.kink)
    differ = False
    first, last = loading(mech, j)
    for r in range(first, last):
        slope = out.kink[r]
        out.kink[r] = out.side[r] - slope
        differ = differ or abs(out.kink[r]) > SAME * max(abs(slope), abs(out.side[r]))
    return differ
