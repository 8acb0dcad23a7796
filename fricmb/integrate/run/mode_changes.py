"""Events put down in the kernels' recorder, and the kinds of those by which modes change.

How many may come between two looks at the space that is left: ``implicit/output/recorder`` (``crowded``).
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.event_kinds import EVENT_CLOSE, EVENT_OPEN, EVENT_REVERSAL, EVENT_SLIP, EVENT_STICK, IS_TRANSITION
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Floats
from fricmb.integrate.run.room_protocols import Events, Laws, Modes

#: Part of the time within which transitions are one instant (how near they are located: ``locate_trigger``).
SAME_INSTANT = 1e-14


def kind_of_change(ports: Laws, c: int, old: int, now: int, was: Floats, n: Floats) -> int:
    """Kind of the event by which contact c goes from one mode, and direction of slip, over to another; -1 for none."""
    if now != old:
        if now == OPEN:
            return EVENT_OPEN
        if old == OPEN:
            return EVENT_CLOSE
        return EVENT_STICK if now == STICK else EVENT_SLIP
    row = ports.row[c]
    one = now == SLIP and ports.law[c] != LAW_SMOOTH and ports.row[c + 1] - row == 1
    return EVENT_REVERSAL if one and n[row] * was[row] < 0.0 else -1


_kind_of_change = kernel(kind_of_change)


@kernel
def record_event(out: Events, t: float, contact: int, kind: int) -> None:
    """Add an event.

    Slip that ends at the instant at which it begins has not been one, and is taken back; and what comes to rest
    together with others may turn round first, by their round-off.
    """
    k = out.used[1]
    last = k - 1
    while kind == EVENT_STICK and last >= 0 and t - out.event[last, 0] <= SAME_INSTANT * abs(t):
        before = int(out.event[last, 2])
        if out.event[last, 1] == contact and IS_TRANSITION[before]:
            if before != EVENT_SLIP and not (before == EVENT_REVERSAL and out.event[last, 0] == t):
                break
            k -= 1
            for i in range(last, k):
                out.event[i] = out.event[i + 1]
            if before == EVENT_SLIP:
                out.used[1] = k
                return
            break
        last -= 1
    out.event[k, 0] = t
    out.event[k, 1] = contact
    out.event[k, 2] = kind
    out.used[1] = k + 1


@kernel
def record_changes(ports: Laws, t: float, y: Modes, old: Modes, out: Events) -> None:
    """Record an event at t for every contact whose mode, or sense of one-dimensional slip, is not that of ``old``."""
    for c in range(y.mode.shape[0]):
        kind = _kind_of_change(ports, c, old.mode[c], y.mode[c], old.n, y.n)
        if kind >= 0:
            record_event(out, t, c, kind)
