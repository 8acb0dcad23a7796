"""Growth of slip in scenes with joints where friction falls with speed: see ``step.slip_growth``."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.slip_rows import carried, lightness
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.state import State
from fricmb.integrate.model.law_values import coefficient, magnitude
from fricmb.integrate.problem import LAW_CONSTANT, LAW_SMOOTH, SLIP, Floats
from fricmb.integrate.step.slip_growth import LONGEST, drive, fall_between


@kernel
def fall_at(mech: Mech, k: Moving, p: int, g: Floats, N: float, z: Floats, h: float) -> float:
    """Slope by which friction of port p falls with slip speed."""
    port = mech.port
    load = carried(mech, p, N)
    if port.law[p] == LAW_SMOOTH:
        return drive(port.laws, port.row, port.z_start, k.s, p, g, load, z, h)
    return float(-coefficient(port, port.laws, p, k.s, magnitude(port.row, p, g), load)[1] * abs(load))


@kernel
def growth(mech: Mech, k: Moving, y: State, st: Stages, h: float) -> float:
    """Length of the step from y, whose stages are solved, in units of the longest that sees slip grow.

    Bodies count as if they had no joints: they are heavier with them, and slip grows slower.
    """
    port = mech.port
    worst = 0.0
    for p in range(y.mode.shape[0]):
        if y.mode[p] != SLIP or port.law[p] == LAW_CONSTANT:
            continue
        fall = fall_at(mech, k, p, y.g, y.N[p], y.z, h)
        low = high = magnitude(port.row, p, y.g)
        load = abs(y.N[p])
        for j in range(st.g.shape[0]):
            fall = max(fall, fall_at(mech, k, p, st.g[j], st.N[j, p], st.Z[j], h))
            speed = magnitude(port.row, p, st.g[j])
            low, high, load = min(low, speed), max(high, speed), max(load, abs(st.N[j, p]))
        if port.law[p] != LAW_SMOOTH:
            fall = max(fall, fall_between(port, port.laws, p, k.s, low, high, load))
        if fall <= 0.0:
            continue
        light = 0.0
        for a in range(port.row[p + 1] - port.row[p]):
            light = max(light, lightness(mech, k, p, a, y.lam, mech.mass))
        worst = max(worst, h * fall * light / LONGEST)
    return float(worst)
