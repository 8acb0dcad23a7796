"""Going on behind an impact: modes and reactions of what is held, of what lets go, of what slips."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import entry, kernel, run_entry
from fricmb.integrate.implicit.attempt_step import grow
from fricmb.integrate.implicit.equations.projection import project_velocities
from fricmb.integrate.implicit.equations.singular_position import start_watch
from fricmb.integrate.implicit.equations.slip_rows import plane
from fricmb.integrate.implicit.modes.load_share import join_rest
from fricmb.integrate.implicit.modes.mode_decision import decide
from fricmb.integrate.implicit.modes.mode_enumeration import FOUND, SEVERAL
from fricmb.integrate.implicit.modes.mode_trial import ARRIVES, RESTED, SLIPS_ON
from fricmb.integrate.implicit.modes.transition import bears, least_held, open_joint, set_out_anew, turn_with_slip
from fricmb.integrate.implicit.modes.uniqueness import margins
from fricmb.integrate.implicit.output.recorder import Record, copy_state
from fricmb.integrate.implicit.scene.control import Control
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.scene.watch import Watch
from fricmb.integrate.model.law_values import magnitude, point_along
from fricmb.integrate.problem import SLIP, STICK, Codes
from fricmb.integrate.run.breakpoints import set_window
from fricmb.integrate.run.mode_changes import record_changes
from fricmb.integrate.run.outcomes import DONE, FAIL_MODES, FAIL_SEVERAL, FAIL_SINGULAR

#: Slip velocity that is round-off, beside the largest.
STILL = 1e-11


@kernel
def parts_behind(mech: Mech, k: Moving, y: State, size: float, fresh: Codes, part: Codes) -> None:
    """What each port does behind an impact: velocities have jumped, and ``fresh`` ports (n_c,) are held anew."""
    row = mech.port.row
    for i in range(y.mode.shape[0]):
        speed = magnitude(row, i, y.g)
        if (y.mode[i] == STICK and speed > STILL * size) or fresh[i] != 0:
            y.mode[i] = SLIP
            point_along(row, i, y.g, 1.0, y.n)
        part[i] = RESTED if y.mode[i] == STICK else SLIPS_ON
        if y.mode[i] == SLIP and speed <= STILL * size and (fresh[i] != 0 or bears(mech, k, y, i)):
            part[i] = ARRIVES


@kernel
def go_on(
    mech: Mech, k: Moving, w: Instant, y: State, c: Control, out: Watch, part: Codes, fresh: Codes
) -> int:
    """Modes, reactions and accelerations behind an impact; what is open is marked among the joints.

    ``fresh`` (n_c,): 1 for ports of joints that are held anew.
    """
    set_window(c, k.s.window, y.t)
    if not project_velocities(mech, k, w, y, False, False):
        return FAIL_SINGULAR
    start_watch(mech, w, out, out.sigma_top)
    grow(mech, c, out, k, y)
    for i in range(y.mode.shape[0]):
        if y.mode[i] == SLIP and plane(mech, i) and magnitude(mech.port.row, i, y.g) > STILL * out.top_slip:
            point_along(mech.port.row, i, y.g, 1.0, y.n)
    turn_with_slip(mech, k, y, out.top_slip, -1)
    parts_behind(mech, k, y, out.top_slip, fresh, part)
    join_rest(mech, k, w, y, part, STILL * out.top_slip, ARRIVES)
    for _ in range(mech.joint.port.shape[0] + 1):
        code = decide(mech, k, w, y, part, -1)
        if code != FOUND:
            margins(mech, k, w, y, out, True)
            return FAIL_SEVERAL if code == SEVERAL else FAIL_MODES
        worst = least_held(mech, y, True)
        if worst < 0:
            break
        code = open_joint(mech, k, w, y, out, worst)
        if code != DONE:
            return code
    c.growth = 1e300
    return set_out_anew(mech, k, w, y, c, out, part)


@run_entry
def resume(
    mech: Mech, k: Moving, w: Instant, y: State, c: Control, out: Watch, part: Codes, fresh: Codes
) -> int:
    """As ``go_on``."""
    return int(go_on(mech, k, w, y, c, out, part, fresh))


@entry
def put_state(source: State, target: State) -> None:
    """Put one state into another."""
    copy_state(source, target)


@entry
def tell_changes(mech: Mech, y: State, before: State, rec: Record) -> None:
    """Events of modes that are not those of the state before the impact."""
    record_changes(mech.port, y.t, y, before, rec)
