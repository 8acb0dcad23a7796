"""Locating transitions, and the end of unique friction, with steps of variable length."""

from __future__ import annotations

from fricmb.integrate._kernel import kernel
from fricmb.integrate._problem import SLIP
from fricmb.integrate.constrained._accept import Watch, margins, triggers
from fricmb.integrate.constrained._pack import Mech, Moving
from fricmb.integrate.constrained._project import EPS
from fricmb.integrate.constrained._stages import Stages
from fricmb.integrate.constrained._state import Instant, State
from fricmb.integrate.constrained._step import Control, end_step, try_step


@kernel
def is_slip(j: int, y: State) -> bool:
    """Whether trigger j is a slip velocity (else a force)."""
    return bool(j < 2 * y.F.shape[0] and j % 2 == 0 and y.mode[j // 2] == SLIP)


@kernel
def violated(mech: Mech, out: Watch, end: State, st: Stages) -> int:
    """The trigger that is furthest below 0 at the end of the step or inside it, or -1; values at the end stay."""
    s = st.tab.c.shape[0]
    worst, least = -1, 0.0
    for i in range(s):
        last = i == s - 1
        if last:
            triggers(mech, out, end.mode, end.n, end.F, end.N, end.g, end.lam)
        else:
            triggers(mech, out, end.mode, end.n, st.F[i], st.N[i], st.g[i], st.lam[i])
        for j in range(out.trigger.shape[0]):
            value = out.trigger[j]
            limit = 1e-12 * (out.size[0] if is_slip(j, end) else out.size[1])
            if value < -limit and value / max(limit, 1e-290) < least:
                worst, least = j, value / max(limit, 1e-290)
    return worst


@kernel
def locate_trigger(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, out: Watch, h: float, first: int
) -> tuple[float, int]:
    """Length of the step that ends where the first trigger vanishes, and that trigger; ``end`` is left there.

    Regula falsi (Illinois) on steps of variable length; a step at whose end another trigger is below 0 replaces the
    upper bound.  Length 0 where a step could not be made.
    """
    triggers(mech, out, y.mode, y.n, y.F, y.N, y.g, y.lam)
    j = first
    low, f_low = 0.0, max(out.trigger[j], 0.0)
    triggers(mech, out, end.mode, end.n, end.F, end.N, end.g, end.lam)
    high, f_high = h, min(out.trigger[j], 0.0)
    side = 0
    step = h
    for i in range(80):
        gap = f_low - f_high
        step = low + (high - low) * (f_low / gap if gap > 0.0 and f_high < 0.0 and f_low > 0.0 else 0.5)
        if i % 8 == 7:
            step = 0.5 * (low + high)
        step = min(max(step, low + 1e-3 * (high - low)), high - 1e-3 * (high - low))
        if not (
            try_step(mech, k, y, st, c, step, mech.address) and end_step(mech, k, w, y, end, st, c, step, mech.address)
        ):
            return 0.0, j
        worst = violated(mech, out, end, st)
        value = out.trigger[j]
        limit = 1e-13 * (out.size[0] if is_slip(j, end) else out.size[1])
        if worst >= 0 and worst != j and out.trigger[j] >= -limit:
            j = worst
            high, f_high, f_low = step, min(out.trigger[j], 0.0), 0.0
            continue
        if abs(value) <= limit or high - low <= 8.0 * EPS * max(abs(y.t[0]), abs(h)):
            break
        if value < 0.0 or worst >= 0:
            high, f_high = step, min(value, 0.0)
            f_low *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            low, f_low = step, value
            f_high *= 0.5 if side == 2 else 1.0
            side = 2
    return step, j


@kernel
def last_unique(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, out: Watch, h: float
) -> float:
    """Length of the longest step at whose end friction still has a single solution, by bisection; ``end`` is there."""
    low, high = 0.0, h
    for _ in range(60):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        made = try_step(mech, k, y, st, c, middle, mech.address) and end_step(
            mech, k, w, y, end, st, c, middle, mech.address
        )
        if made and margins(mech, k, w, end, out, mech.address) > 0.0:
            low = middle
        else:
            high = middle
        if high - low <= 1e-13 * h + 4.0 * EPS * abs(y.t[0]):
            break
    if low > 0.0 and try_step(mech, k, y, st, c, low, mech.address):
        end_step(mech, k, w, y, end, st, c, low, mech.address)
        margins(mech, k, w, end, out, mech.address)
    return low
