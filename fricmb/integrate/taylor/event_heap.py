"""The ends of modes that are due in a step, in order of time: a binary heap; what ``due`` contradicts is void."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.taylor.network import Net


@kernel
def sift_up(net: Net, at: int, c: int, s: float) -> None:
    """Give a contact its place above ``at``, the first free one."""
    while at > 0:
        up = (at - 1) >> 1
        if net.heap_t[up] <= s:
            break
        net.heap_t[at] = net.heap_t[up]
        net.heap_c[at] = net.heap_c[up]
        at = up
    net.heap_t[at] = s
    net.heap_c[at] = c


@kernel
def renew_heap(net: Net) -> None:
    """Fill the heap from ``due`` alone, without what is out of date."""
    count = 0
    for c in range(net.due.shape[0]):
        if not net.due[c] > 1.0:
            sift_up(net, count, c, net.due[c])
            count += 1
    net.n_heap = count


@kernel
def push_due(net: Net, c: int, s: float) -> None:
    """Put a contact with the end of its mode into the heap."""
    net.due[c] = s
    if s > 1.0:
        return
    if net.n_heap >= net.heap_t.shape[0]:
        renew_heap(net)
        return
    sift_up(net, net.n_heap, c, s)
    net.n_heap += 1


@kernel
def pop_due(net: Net) -> None:
    """Remove the first of the heap."""
    last = net.n_heap - 1
    net.n_heap = last
    s = net.heap_t[last]
    c = net.heap_c[last]
    at = 0
    while True:
        below = 2 * at + 1
        if below >= last:
            break
        if below + 1 < last and net.heap_t[below + 1] < net.heap_t[below]:
            below += 1
        if net.heap_t[below] >= s:
            break
        net.heap_t[at] = net.heap_t[below]
        net.heap_c[at] = net.heap_c[below]
        at = below
    net.heap_t[at] = s
    net.heap_c[at] = c
