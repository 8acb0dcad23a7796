"""Where within a step a function first falls below 0, from its values at the start and the stages of the step."""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.tableau import Tableau
from fricmb.integrate.problem import Floats


@kernel
def polynomial(tab: Tableau, first: float, values: Floats, series: Floats) -> None:
    """Monomial coefficients of the polynomial through ``first`` at 0 and ``values`` at the stages, into ``series``."""
    for k in range(tab.basis.shape[0]):
        value = tab.basis[k, 0] * first
        for j in range(tab.c.shape[0]):
            value += tab.basis[k, j + 1] * values[j]
        series[k] = value


@kernel
def value_at(c: Floats, x: float) -> float:
    """Value of a polynomial."""
    value = 0.0
    for k in range(c.shape[0] - 1, -1, -1):
        value = value * x + c[k]
    return value


@kernel
def evaluate(c: Floats, x: float) -> tuple[float, float, float]:
    """Value, slope and half the curvature of a polynomial."""
    value = 0.0
    slope = 0.0
    curve = 0.0
    for k in range(c.shape[0] - 1, -1, -1):
        curve = curve * x + slope
        slope = slope * x + value
        value = value * x + c[k]
    return value, slope, curve


@kernel
def lowest_between(c: Floats, low: float, high: float, within: float) -> float:
    """Where the polynomial is found negative on the way to its minimum between two points; -1 where it is not.

    The search ends where a step is at most ``within``.
    """
    x = 0.5 * (low + high)
    for _ in range(30):
        value, slope, curve = evaluate(c, x)
        if value < 0.0:
            return x
        if slope < 0.0:
            low = x
        else:
            high = x
        new = x - 0.5 * slope / curve if curve > 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - x) <= within:
            return -1.0
        x = new
    return -1.0


@kernel
def root_between(c: Floats, low: float, high: float, within: float) -> float:
    """Root of the polynomial between a point where it is not negative and one where it is, to a step ``within``."""
    x = 0.5 * (low + high)
    for _ in range(60):
        value, slope, _ = evaluate(c, x)
        if value >= 0.0:
            low = x
        else:
            high = x
        new = x - value / slope if slope != 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - x) <= within:
            return new
        x = new
    return x


@kernel
def first_below(tab: Tableau, first: float, values: Floats, series: Floats) -> tuple[float, float]:
    """Two points of (0, 1] between which the polynomial through ``first`` and ``values`` first goes below 0; (2, 2).

    It is below 0 at the second point, and was not at the first one.  The stages, the points half-way between and the
    minima between these are looked at.
    """
    n_s = tab.c.shape[0]
    low = first
    high = first
    for j in range(n_s):
        low = min(low, values[j])
        high = max(high, values[j])
    if low > 0.5 * high:
        return 2.0, 2.0
    polynomial(tab, first, values, series)
    before = 0.0
    falls = series[1] < 0.0 and first > 0.0
    for i in range(2 * n_s):
        x = tab.c[i // 2]
        if i % 2 == 0:
            x = 0.5 * (x + (tab.c[i // 2 - 1] if i > 0 else 0.0))
        value, slope, _ = evaluate(series, x)
        if i % 2 == 1:
            value = values[i // 2]
        if value >= 0.0 and falls and slope > 0.0:
            bottom = lowest_between(series, before, x, 1e-6 * x)
            if bottom > 0.0:
                return before, bottom
        if value < 0.0:
            return before, x
        falls = slope < 0.0
        before = x
    return 2.0, 2.0


@kernel
def first_crossing(tab: Tableau, first: float, values: Floats, series: Floats) -> float:
    """Where the polynomial through ``first`` at 0 and ``values`` at the stages first goes below 0; 2 if it does not."""
    above, below = first_below(tab, first, values, series)
    if below > 1.0:
        return 2.0
    return root_between(series, above, below, 1e-13 * below) if above > 0.0 or first > 0.0 else 0.0


@kernel
def narrowed(
    low: float, first: float, high: float, last: float, moved: int, x: float, here: float, beyond: bool
) -> tuple[float, float, float, float, int]:
    """Two places between which a function passes 0, its values there, and which moved, after a look at x.

    ``beyond``: x becomes the upper one.  ``moved``: 1 where that was the last to move, -1 the lower one, 0 neither.  An
    end that stays twice counts half (Illinois); the next look is where the straight line between the values is 0.
    """
    if beyond:
        return low, first * (0.5 if moved > 0 else 1.0), x, here, 1
    return x, here, high, last * (0.5 if moved < 0 else 1.0), -1
