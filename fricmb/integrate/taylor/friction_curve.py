"""Friction as a polynomial of slip speed, and that of a polynomial slip speed as a power series.

A law is a compiled function that gives values.  On the range of speeds of a step it is replaced by its interpolant in
Chebyshev points, whose coefficients tell how good it is (L. N. Trefethen, Approximation theory and approximation
practice, 2nd ed., SIAM 2019, chapters 3, 4, 8).  Clenshaw's recursion with power series for numbers gives the
coefficients of mu(r(s)) order by order.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.template import call
from fricmb.integrate.problem import SLIP, Floats, Floats2
from fricmb.integrate.taylor.network import Net

#: Parts of the tolerance that may be missing in a coefficient of friction.
SHARE = 0.1
#: Less than that is round-off of an interpolant, relative to the coefficient.
SEEN = 2e-14
#: Speeds below this part of what friction may bring in the step are those of slip that begins.
UNMOVED = 1e-3
#: Place in ``groups.work`` of the least coefficient that any law had in a run, 0 if none was negative.
LEAST = 7


@kernel
def slip_law(net: Net, c: int) -> int:
    """Number of contact c among those under laws of slip speed, if it slips; else -1."""
    return int(net.groups.lawful[c]) if net.mode[c] == SLIP else -1


@kernel
def coefficient_at(net: Net, c: int, r: float) -> float:
    """mu(r) of contact c, for r < 0 that of 0."""
    work, laws = net.groups.work, net.groups.laws
    work[0] = max(r, 0.0)
    work[1] = net.groups.N[c]
    call(laws.address[c], work, 0, laws.p, laws.p_start[c], work, 2)
    work[LEAST] = min(work[LEAST], work[2])
    return float(work[2])


@kernel
def friction_at(net: Net, c: int, speed: float) -> float:
    """Friction mu N at a slip speed."""
    if net.groups.lawful[c] < 0:
        return float(net.slip[c])
    return float(net.groups.N[c] * coefficient_at(net, c, speed))


@kernel
def fit_curve(net: Net, c: int, low: float, high: float) -> None:
    """The coefficient of contact c between two slip speeds."""
    at = net.groups.lawful[c]
    nodes, values, fit = net.groups.nodes, net.groups.values, net.groups.fit
    low = max(low, 0.0)
    middle = 0.5 * (low + high)
    half = max(0.5 * (high - low), 1e-12 * high + 1e-300)
    net.groups.middle[at] = middle
    net.groups.half[at] = half
    count = nodes.shape[0]
    for a in range(count):
        values[a] = coefficient_at(net, c, middle + half * nodes[a])
    row = net.groups.curve[at]
    size = 0.0
    for j in range(count):
        value = 0.0
        for a in range(count):
            value += fit[j, a] * values[a]
        row[j] = value
        size = max(size, abs(value))
    allowed = max(SHARE * net.tol, 2e-15) * size + 1e-300
    net.groups.rough[at] = (abs(row[count - 1]) + abs(row[count - 2])) / allowed
    terms = count
    left = 0.0
    while terms > 1:
        left += abs(row[terms - 1])
        if left > allowed:
            break
        terms -= 1
    net.groups.terms[at] = terms


@kernel
def curve_value(curve: Floats, terms: int, x: float) -> float:
    """``sum_j curve[j] T_j(x)``."""
    one, two = 0.0, 0.0
    for j in range(terms - 1, 0, -1):
        one, two = curve[j] + 2.0 * x * one - two, one
    return float(curve[0] + x * one - two)


@kernel
def fit_around(net: Net, c: int, r: float, below: float, above: float) -> None:
    """The same around slip speed r, on as much of the range ``below`` and ``above`` it as the interpolant is good on.

    A law that falls between two nodes leaves no trace in the coefficients: it is asked again at r and at the lowest
    speed.  Exact at r: where slip begins without a jump of the force, a trace of one would end it at once.
    """
    groups, at = net.groups, net.groups.lawful[c]
    row = groups.curve[at]
    mu, off = coefficient_at(net, c, r), 0.0
    for _ in range(30):
        fit_curve(net, c, r - below, r + above)
        x = (max(r, 0.0) - groups.middle[at]) / groups.half[at]
        off = mu - curve_value(row, groups.terms[at], x)
        missed = abs(off)
        if x > -1.0:
            least = coefficient_at(net, c, groups.middle[at] - groups.half[at])
            missed = max(missed, abs(least - curve_value(row, groups.terms[at], -1.0)))
        allowed = max(net.tol, SEEN) * abs(mu) + 1e-300
        groups.rough[at] = max(groups.rough[at], missed / allowed)
        if groups.rough[at] <= 1.0:
            break
        below *= 0.5
        above *= 0.5
    row[0] += off


@kernel
def compose(curve: Floats, terms: int, x: Floats, b: Floats2, k: int) -> float:
    """Coefficient k of ``sum_j curve[j] T_j(x(s))``; b (., .) holds the sums of the orders before."""
    top = terms - 1
    if top == 0:
        return float(curve[0] if k == 0 else 0.0)
    b[top + 1, k] = 0.0
    b[top, k] = curve[top] if k == 0 else 0.0
    for j in range(top - 1, -1, -1):
        above = b[j + 1]
        value = 0.0
        for i in range(k + 1):
            value += x[i] * above[k - i]
        if j > 0:
            value *= 2.0
        value -= b[j + 2, k]
        b[j, k] = value + curve[j] if k == 0 else value
    return float(b[0, k])


@kernel
def friction_row(net: Net, c: int, k: int, speed: float, h: float) -> float:
    """Coefficient k of mu N of contact c, which slips, from that of its slip speed; orders before it are known."""
    at = net.groups.lawful[c]
    if at < 0:
        return float(net.slip[c]) if k == 0 else 0.0
    b = net.groups.b[at]
    x = b[b.shape[0] - 1]
    x[k] = speed
    if k == 0:
        return float(net.groups.N[c] * coefficient_at(net, c, x[0]))
    if k == 1:
        pad = 0.3 * abs(x[1]) + 0.05 * abs(x[0]) + 0.01 * net.fastest
        reach = net.compliance[c] * net.groups.N[c] * coefficient_at(net, c, x[0]) * h
        if pad < UNMOVED * reach:
            # slip that begins does not tell yet where it goes: as far as friction may bring it
            pad = reach
        fit_around(net, c, x[0], pad - min(0.0, x[1]), pad + max(0.0, x[1]))
        x[0] = (x[0] - net.groups.middle[at]) / net.groups.half[at]
        compose(net.groups.curve[at], net.groups.terms[at], x, b, 0)
    x[k] /= net.groups.half[at]
    return float(net.groups.N[c] * compose(net.groups.curve[at], net.groups.terms[at], x, b, k))
