"""What parts state with its derivatives: by the chain rule over common subexpressions, against SymPy's own."""

import mpmath
import numpy as np
import sympy

from fricmb.laws import norm
from fricmb.sensitivity._functions import _with_slopes


def tried(arguments, outputs, values):
    """Largest difference of values and slopes from those of SymPy in 30 digits."""
    function, places = _with_slopes(arguments, outputs, tuple(range(len(arguments))))
    found = function(*[np.array([value]) for value in values])
    slopes = dict(zip(places, found[len(outputs) :], strict=True))

    def exact(expression):
        with mpmath.workdps(30):
            return float(sympy.lambdify(arguments, expression, "mpmath", cse=True)(*map(mpmath.mpf, values)))

    off = [abs(float(np.ravel(f)[0]) - exact(e)) for f, e in zip(found, outputs, strict=False)]
    for i, output in enumerate(outputs):
        for j, argument in enumerate(arguments):
            true = exact(sympy.diff(output, argument))
            off.append(abs(float(np.ravel(slopes.get((i, j), 0.0))[0]) - true))
    return max(off)


def test_slopes_of_nested_expressions():
    x, y, p = sympy.symbols("x y p", real=True)
    deep = sympy.sqrt(x**2 + p) * sympy.exp(-y)
    for _ in range(4):
        deep = sympy.sin(deep) + deep * x / (1 + deep**2)
    assert tried([x, y, p], [deep, deep**2 * y, p], [0.4, -0.3, 1.7]) < 1e-13


def test_an_argument_may_be_called_what_a_part_is():
    """Authors name their parameters as they like: part2_0 is what a derivative might be called."""
    part0, part1, slope = sympy.symbols("part0 part1 part2_0", real=True)
    common = sympy.exp(part0 * part1)
    assert tried([part0, part1, slope], [common * slope + common**2, common / slope], [0.3, 0.9, 2.1]) < 1e-13


def test_lengths_that_would_underflow():
    """At the bottom of what a number holds a unit vector is one still."""
    a, b = sympy.symbols("a b", real=True)
    function, places = _with_slopes([a, b], [norm([a, b])], (0, 1))
    value, *slopes = function(np.array([3e-90]), np.array([4e-90]))
    assert places == [(0, 0), (0, 1)]
    np.testing.assert_allclose([value[0], slopes[0][0], slopes[1][0]], [5e-90, 0.6, 0.8], rtol=1e-14)
