"""What forces of contacts do in a scene without joints, put down for a step that has been solved."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_CONSTANT
from fricmb.integrate.step.one_step_room import Accuracy, OneStep, widest
from fricmb.integrate.step.stages import Stages
from fricmb.integrate.step.tableau import largest_in_step

#: Velocities below so many floors of theirs are creep.
CREEP = 1e3


@kernel
def felt_speed(y: State, st: Stages, acc: Accuracy, top: float, i: int) -> float:
    """What counts as 1 in velocity i where it is asked what a force does; ``top``: the largest of all so far.

    What creeps before anything has moved has no scale of its own yet: a steep law's round-off would be seen there.
    Where nothing has moved at all, what the step itself reaches is the scale.
    """
    return float(max(acc.v[i], largest_in_step(y.v[i], st.V, i), CREEP * acc.floor_v[i], 1e-10 * top, 1e-290))


@kernel
def pushed(packed: Packed, y: State, st: Stages, acc: Accuracy, a: int) -> float:
    """Acceleration of the velocity that is moved most, by its own scale, by a unit of force in row a."""
    top = widest(acc.v)
    most = 0.0
    for i in range(y.v.shape[0]):
        size = packed.structure.mobility[i] * abs(packed.ports.W[i, a])
        if size > 0.0:
            most = max(most, size / felt_speed(y, st, acc, top, i))
    return most


@kernel
def damped(packed: Packed, k: int) -> float:
    """Rate at which dampers alone would take the slip of contact k away (of the diagonal: at most that)."""
    structure, ports = packed.structure, packed.ports
    rate = 0.0
    for a in range(ports.row[k], ports.row[k + 1]):
        value = 0.0
        for i in range(structure.mobility.shape[0]):
            if ports.W[i, a] != 0.0:
                value += (ports.W[i, a] * structure.mobility[i]) ** 2 * structure.C[structure.own[i]]
        value /= max(ports.D[a, a], 1e-290)
        rate = value if a == ports.row[k] else min(rate, value)
    return float(max(rate, 0.0))


@kernel
def weigh_forces(packed: Packed, y: State, one: OneStep, acc: Accuracy) -> None:
    """Fill ``one.felt`` for a step from y, of all contacts whose friction follows slip or states."""
    ports, felt = packed.ports, one.felt
    for k in range(y.mode.shape[0]):
        if ports.law[k] == LAW_CONSTANT:
            continue
        felt.damped[k] = damped(packed, k)
        for a in range(ports.row[k], ports.row[k + 1]):
            felt.push[a], felt.free[a] = pushed(packed, y, one.st, acc, a), ports.D[a, a]
    for a in range(y.z.shape[0]):
        felt.size[a] = max(acc.z[a], abs(y.z[a]), one.noise_z[a], 1e-290)
