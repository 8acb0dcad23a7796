"""Triggers: functions of the state at whose zero a step has to end; above it they are greater than 0.

| kind | of each | what falls below 0 | what then happens |
|---|---|---|---|
| FRICTION | port | what stick could still bear; slip | ``modes/transition`` |
| LOAD | port | its load, with the other sign where it is open | ``modes/transition`` |
| JOINT | joint | the reaction of one that only presses; the distance of one that is open | as above; ``impacts`` |
| KINK | port | see ``load_kinks`` | nothing: polynomials end there |

To add a trigger: its kind behind the others in ``scene/watch`` (the number of triggers follows), with space for what it
remembers, set by ``begin`` in ``time_loop``, last of all, as loads change until then; and its value for each port in
``triggers``, n_c places behind that of the kind before it: ``out.trigger[behind + n_c + c]`` of the first one added. It
is measured as a force, unless ``grain`` says otherwise, and is seen at the ends and stages of steps, not between these.
What happens at it is said in ``attempt_step`` beside KINK, where ``y`` is the state at it; an event is put down there
by ``record_event(rec, y.t, owner(mech, trigger), EVENT_...)``, and no polynomial through the step is kept (``c.last_h =
c.made = 0``), which may be tiny. A function that has passed 0 would end every step from there on: what goes on looks to
the other side, by a sign that it remembers and turns at each passage; ``y`` itself may be on either side, within
round-off. Forces jump where modes change, at breakpoints and at impacts: a trigger that may be below 0 when a step
begins is looked for at the head of ``attempt_step``, since no shorter step would find where it has passed.

No other file needs to know a new kind: ``event_functions`` and ``event_location`` find any trigger, and ``bdf`` leaves
the step around one to ``attempt_step``. A port, c in kernels of triggers, is a contact or a joint with friction; events
call it contact, by the same number.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.forces import is_open
from fricmb.integrate.implicit.equations.slip_rows import lack, may_open, plane, slip_speed, spare
from fricmb.integrate.implicit.events.load_kinks import BEFORE, BEHIND, law_side
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import State
from fricmb.integrate.implicit.scene.watch import FRICTION, JOINT, KINK, LOAD, Watch
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Codes, Floats


@kernel
def first_joint(mech: Mech) -> int:
    """The trigger of the first joint, behind those of ports."""
    return int(2 * mech.port.joint.shape[0])


@kernel
def first_behind_joints(mech: Mech) -> int:
    """The first trigger behind those of joints: from it on there is one of each kind a port, and none ends a mode."""
    return int(first_joint(mech) + mech.joint.port.shape[0])


@kernel
def kind_of(mech: Mech, j: int) -> int:
    """Kind of trigger j, -1 where j is none."""
    if j < first_joint(mech):
        return -1 if j < 0 else (LOAD if j % 2 == 1 else FRICTION)
    if j < first_behind_joints(mech):
        return JOINT
    return int(KINK + (j - first_behind_joints(mech)) // mech.port.joint.shape[0])


@kernel
def owner(mech: Mech, j: int) -> int:
    """The port of trigger j, of a JOINT its joint."""
    if j < first_joint(mech):
        return j // 2
    if j < first_behind_joints(mech):
        return int(j - first_joint(mech))
    return int((j - first_behind_joints(mech)) % mech.port.joint.shape[0])


@kernel
def is_gap(mech: Mech, j: int) -> bool:
    """Whether trigger j is the distance of a joint that is open."""
    return is_open(mech, j - first_joint(mech))


@kernel
def triggers(
    mech: Mech, k: Moving, out: Watch, mode: Codes, direction: Floats, F: Floats, N: Floats, g: Floats, lam: Floats,
    at_end: bool,
) -> None:  # fmt: skip
    """All triggers, into ``out.trigger``; ``at_end`` of a step, where distances of open joints are known."""
    joints, behind = first_joint(mech), first_behind_joints(mech)
    for c in range(mode.shape[0]):
        out.trigger[2 * c] = friction(mech, k, out, mode, direction, F, N, g, c)
        out.trigger[2 * c + 1] = load(mech, mode, N, c)
        out.trigger[behind + c] = kink(mech, k, out, N, g, lam, c)
    for j in range(out.gap.shape[0]):
        out.trigger[joints + j] = lam[mech.joint.row[j]] if mech.joint.one_sided[j] else 1.0
        if is_open(mech, j):
            out.trigger[joints + j] = out.gap[j] if at_end else 1.0


@kernel
def friction(
    mech: Mech, k: Moving, out: Watch, mode: Codes, direction: Floats, F: Floats, N: Floats, g: Floats, c: int
) -> float:
    """What port c could still bear where it sticks; its slip, which almost without load may turn as it likes."""
    port = mech.port
    if port.law[c] == LAW_SMOOTH or mode[c] == OPEN:
        return 1.0
    if mode[c] == STICK:
        return spare(mech, k, c, F, N)
    # away from rest slip has a direction of its own, and a force that passes through 0 none but round-off's
    away = plane(mech, c) and k.form[c] == 0
    speed = magnitude(port.row, c, g) if away else slip_speed(port.row, c, direction, F, g)
    return float(speed + out.top_slip * lack(mech, k, c, N[c]))


@kernel
def load(mech: Mech, mode: Codes, N: Floats, c: int) -> float:
    """The load of port c; of one that is open that with the other sign."""
    if not may_open(mech, c):
        return 1.0
    return float(-N[c] if mode[c] == OPEN else N[c])


@kernel
def kink(mech: Mech, k: Moving, out: Watch, N: Floats, g: Floats, lam: Floats, c: int) -> float:
    """The kink of port c that a step has been found to have (``load_kinks``); 1 where it has none."""
    if out.kinked[c] == 0:
        return 1.0
    if out.kinked[c] == BEFORE or out.kinked[c] == BEHIND:
        side = law_side(mech, k, c, g, N)
        return float(side if out.kinked[c] == BEFORE else -side)
    joint, value = mech.joint, 0.0
    j = mech.port.joint[c]
    for r in range(joint.row[j], joint.row[j + 1]):
        value += out.kink[r] * lam[r]
    return float(value)


@kernel
def is_slip(mech: Mech, j: int, y: State) -> bool:
    """Whether trigger j is a slip velocity (else a force)."""
    return kind_of(mech, j) == FRICTION and y.mode[owner(mech, j)] == SLIP


@kernel
def grain(mech: Mech, out: Watch, j: int, y: State) -> float:
    """Below this trigger j counts as 0, and its location ends: round-off of a distance, of a slip or of a force.

    Of the last two it is that of the largest of the run so far.
    """
    if is_slip(mech, j, y):
        return float(1e-13 * out.top_slip)
    if is_gap(mech, j):
        return float(max(out.grain[owner(mech, j)], 1e-290))
    return float(1e-13 * out.top_force)
