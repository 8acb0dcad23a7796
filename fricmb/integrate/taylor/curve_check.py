"""Over which part of a step a friction curve is what its law says: by its range, its last terms, and the law itself."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.crossing import value_at
from fricmb.integrate.problem import Floats, Floats2
from fricmb.integrate.taylor.friction_curve import coefficient_at
from fricmb.integrate.taylor.network import Net

#: How often the law is asked on ever shorter parts.
ASKED = 20


@kernel
def look_along(net: Net, x: Floats, last: int, length: float) -> None:
    """The argument x(s) at points of ``length``, all at once, into ``along[1]``; these into ``along[0]``."""
    at, value = net.groups.along[0], net.groups.along[1]
    for i in range(at.shape[0]):
        at[i] = length * (i + 1) / at.shape[0]
        value[i] = 0.0
    for k in range(last, -1, -1):
        for i in range(at.shape[0]):
            value[i] = value[i] * at[i] + x[k]


@kernel
def holds(argument: float, closed: bool) -> bool:
    """Whether a curve holds at an argument; one that begins at speed 0 holds below it, too."""
    return bool(argument <= 1.02 and (argument >= -1.02 or not closed))


@kernel
def within(net: Net, at: int, x: Floats, last: int, length: float) -> float:
    """Part of ``length`` in which the argument x(s) stays where the curve holds, 1.0 if in all of it.

    Leaves the argument along ``length`` in ``along``.
    """
    closed = net.groups.middle[at] > 1.001 * net.groups.half[at]
    look_along(net, x, last, length)
    along = net.groups.along[1]
    for i in range(along.shape[0]):
        if holds(along[i], closed):
            continue
        if i > 0:
            return i / float(along.shape[0])
        part = 1.0 / 24.0
        for _ in range(60):
            if holds(value_at(x[: last + 1], length * part), closed):
                break
            part *= 0.5
        return part
    return 1.0


@kernel
def law_defect(net: Net, c: int, b: Floats2, last: int, s: float) -> float:
    """What the friction of contact c at s is off its law, as an error of velocity in units of the tolerance.

    ``b``: the sums of its coefficient's series up to order ``last``, in the last row its argument.  Series with gaps
    have last coefficients that tell nothing; the law tells.
    """
    groups, at = net.groups, net.groups.lawful[c]
    x = b[b.shape[0] - 1]
    argument = value_at(x[: last + 1], s)
    mu = groups.curve[at, 0] if groups.terms[at] == 1 else value_at(b[0, : last + 1], s)
    off = abs(mu - coefficient_at(net, c, groups.middle[at] + argument * groups.half[at]))
    speed = net.compliance[c] * groups.N[c] * off * net.step * s / (last + 2)
    return float(speed / (net.tol * (net.top[net.first_dof[c]] + 0.01 * net.fastest)))


@kernel
def slips_until(net: Net, at: int, start: float) -> float:
    """Part of the length last looked along at whose end slip has not ended; it begins at the argument ``start``."""
    along, rest = net.groups.along[1], -net.groups.middle[at] / net.groups.half[at]
    before = max(start - rest, 0.0)
    for i in range(along.shape[0]):
        here = along[i] - rest
        if here < 0.0:
            return float((i + 0.9 * before / (before - here)) / along.shape[0])
        before = here
    return 1.0


@kernel
def curve_part(net: Net, c: int, b: Floats2, length: float) -> float:
    """Part of ``length`` over which the friction of contact c follows its law, 1.0 if over all of it."""
    groups, at = net.groups, net.groups.lawful[c]
    last = groups.F.shape[0] - 1
    x = b[b.shape[0] - 1]
    part = within(net, at, x, last, length)
    if groups.rough[at] > 1.0:
        part = min(part, 0.7 * groups.rough[at] ** (-1.0 / (groups.nodes.shape[0] - 1.0)))
    asked = min(part, slips_until(net, at, x[0]))
    for _ in range(ASKED):
        off = law_defect(net, c, b, last, asked * length)
        if off <= 1.0:
            break
        asked *= max(0.1, 0.9 * off ** (-1.0 / (last + 1.0)))
        part = asked
    return float(part)
