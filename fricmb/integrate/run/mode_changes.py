"""Changes of modes, recorded as events."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import (
    EVENT_CLOSE,
    EVENT_OPEN,
    EVENT_REVERSAL,
    EVENT_SLIP,
    EVENT_STICK,
    LAW_SMOOTH,
    OPEN,
    SLIP,
    STICK,
    Floats,
)
from fricmb.integrate.run.room_protocols import Events, Laws, Modes

#: Part of the time within which transitions are one instant (how near they are located: ``locate_trigger``).
SAME_INSTANT = 1e-14


@kernel
def turned(ports: Laws, k: int, mode: int, n: Floats, old: Floats) -> bool:
    """Whether one-dimensional slip of contact k has changed its sense."""
    row0 = ports.row[k]
    one = mode == SLIP and ports.law[k] != LAW_SMOOTH and ports.row[k + 1] - row0 == 1
    return bool(one and n[row0] * old[row0] < 0.0)


@kernel
def record_event(out: Events, t: float, contact: int, kind: int) -> None:
    """Add a transition; a slip that ends at the instant at which it begins has not been one, and is taken back."""
    k = out.used[1]
    last = k - 1
    while kind == EVENT_STICK and last >= 0 and t - out.event[last, 0] <= SAME_INSTANT * abs(t):
        if out.event[last, 1] == contact:
            if out.event[last, 2] != EVENT_SLIP:
                break
            for i in range(last, k - 1):
                out.event[i] = out.event[i + 1]
            out.used[1] = k - 1
            return
        last -= 1
    out.event[k, 0] = t
    out.event[k, 1] = contact
    out.event[k, 2] = kind
    out.used[1] = k + 1


@kernel
def record_changes(ports: Laws, t: float, y: Modes, old: Modes, out: Events) -> bool:
    """Record an event at t for every contact whose mode, or sense of one-dimensional slip, is not that of ``old``.

    Returns whether there are any.
    """
    some = False
    for c in range(y.mode.shape[0]):
        kind = -1
        if y.mode[c] != old.mode[c]:
            kind = EVENT_STICK if y.mode[c] == STICK else EVENT_SLIP
            if y.mode[c] == OPEN:
                kind = EVENT_OPEN
            elif old.mode[c] == OPEN:
                kind = EVENT_CLOSE
        elif turned(ports, c, y.mode[c], y.n, old.n):
            kind = EVENT_REVERSAL
        if kind >= 0:
            record_event(out, t, c, kind)
            some = True
    return some
