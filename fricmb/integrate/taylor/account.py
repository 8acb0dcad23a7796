"""Losses and work of contacts.

What a plain contact loses is its force times how far it slides; other contacts count from time to time what they have
done since, from the polynomials as they are: a law's force and a belt that moves have no shorter way.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import SLIP
from fricmb.integrate.taylor.groups import SECOND
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import hold_force, relative
from fricmb.integrate.taylor.rubbing import is_lost, rubbing_at
from fricmb.integrate.taylor.signals import belt_value


@kernel
def displacement(net: Net, c: int, q: float, s: float) -> float:
    """Relative displacement of plain contact c, up to a constant, where its dof is at q at s."""
    return float(net.row_coef[net.row_start[c]] * q - net.belt[c] * (net.time + s * net.step))


@kernel
def lose_sliding(net: Net, c: int, q: float, s: float) -> None:
    """Count what plain contact c, its dof being at q at s, has lost since it was last asked; remember where it is."""
    here = displacement(net, c, q, s)
    if net.mode[c] == SLIP:
        net.loss[c] += net.slip[c] * abs(here - net.mark[c])
    net.mark[c] = here


@kernel
def pay(net: Net, c: int, s: float) -> None:
    """Count what contact c of a group has done up to s, with the polynomials as they are."""
    before = net.groups.paid[c]
    if s <= before:
        return
    net.groups.paid[c] = s
    steady = net.wu_start[c] == net.wu_start[c + 1]
    slips = net.mode[c] == SLIP
    if steady and not slips and net.belt[c] == 0.0:
        return
    h = net.step
    rule = net.groups.rule
    first = c - 1 if net.groups.planar[c] == SECOND else c
    lost = slips and is_lost(net, first)
    for g in range(rule.shape[1]):
        at = before + (s - before) * rule[0, g]
        time = (s - before) * h * rule[1, g]
        work = time * hold_force(net, c, at)
        net.supply += work * belt_value(net, c, at)
        if not slips:
            continue
        speed = relative(net, c, at, h)
        rubs = rubbing_at(net, first, relative(net, first, at, h), relative(net, first + 1, at, h)) if lost else -1.0
        net.loss[c] += time * rubs * speed * speed if rubs >= 0.0 else -work * speed


@kernel
def pay_touched(net: Net, s: float) -> None:
    """The same for all contacts of groups that a correction touches."""
    for slot in range(net.n_touched):
        pay(net, net.groups.here[slot], s)


@kernel
def pay_groups(net: Net, s: float) -> None:
    """The same for all contacts of groups."""
    for i in range(net.grouped.shape[0]):
        pay(net, net.grouped[i], s)
