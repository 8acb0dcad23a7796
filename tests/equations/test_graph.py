"""Graphs of expressions: derivatives against SymPy's, what is shared, what stays finite, what is refused."""

import mpmath
import numpy as np
import pytest
import sympy
from sympy import Abs, Heaviside, Max, Min, Piecewise, atan2, erf, exp, log, sin, sqrt, tan, tanh

import fricmb as fm
from fricmb.equations import _store
from fricmb.equations._graph import Graph
from fricmb.equations._statements import kernel

x, y, z = sympy.symbols("x y z", real=True)
a = sympy.Symbol("a", positive=True)
EXPRESSIONS = {
    "polynomial": (x - a) ** 4 * y - 3 * x * y**2 / 7 + 2,
    "length": sqrt(x**2 + y**2 + z**2) * x / y,
    "guarded length": (x**2 + y**2 + sympy.Float("1e-200")) ** -2 * x,
    "odd root": (x**2 + 1) ** sympy.Rational(-1, 3),
    "half powers": (x**2 * y**2 + 1) ** sympy.Rational(-5, 2) + a ** sympy.Rational(3, 2) * x,
    "functions": sin(x * y) * exp(-(x**2)) + log(1 + x**2) * tanh(z / a) + erf(x) + tan(y / 3),
    "two arguments": atan2(y * z, x + 5) + atan2(x, 2),
    "power of a power": (1 + x**2) ** (y / a) + (2 + tanh(x)) ** tanh(x),
    "branches": Piecewise((sqrt(x) * y, x > 1), (x**2 * z, (y > 0) & (z < 0)), (sin(x), True)),
    "of branches": exp(Piecewise((x * y, x + y > 0), (z, True))) * Piecewise((x, ~(z > 0) | (x > 5)), (y**2, True)),
    "extremes": Max(x * y, z, 0) * Min(x, y) + Max(0, 1 - x) ** 2,
    "kinks": Abs(x - y) * z + sympy.sign(x) * y + Heaviside(y) * x**2,
    "no branch holds there": Piecewise((x, x < 100)) * y,
}
SYMBOLS = (x, y, z)


def outputs(graph, nodes):
    """Values of a kernel of x, y, z and a."""
    source = kernel(graph, SYMBOLS, (a,), nodes, "of a test")
    name = f"test_{abs(hash(source))}"
    _store._sources[name] = source
    call = _store.function(_store.address(name))

    def evaluate(point, parameter):
        found = np.full(len(nodes), 7.0)
        call(np.array(point, dtype=float), np.array([parameter]), found)
        return found

    return evaluate


@pytest.mark.parametrize("expression", EXPRESSIONS.values(), ids=EXPRESSIONS.keys())
def test_values_and_two_derivatives_are_those_of_sympy(expression):
    graph = Graph("of a test")
    value = graph.of(expression)
    slopes = graph.gradients([value], SYMBOLS)[0]
    second = [slope for row in graph.gradients(slopes, SYMBOLS) for slope in row]
    found = outputs(graph, [value, *slopes, *second])
    wanted = [expression, *(sympy.diff(expression, s) for s in SYMBOLS)]
    wanted += [sympy.diff(slope, s) for slope in wanted[1:] for s in SYMBOLS]
    random = np.random.default_rng(3)
    for point in random.normal(size=(6, 3)) * 1.5:
        values = dict(zip(SYMBOLS, map(mpmath.mpf, point), strict=True)) | {a: mpmath.mpf(0.7)}
        exact = [float(sympy.N(e.xreplace(values), 30)) if e != 0 else 0.0 for e in wanted]
        np.testing.assert_allclose(found(point, 0.7), exact, rtol=1e-12, atol=1e-12 * max(map(abs, exact)))


def test_nothing_stands_twice():
    graph = Graph("of a test")
    assert graph.of(x * y + z) == graph.of(z + y * x)
    square = graph.of((x + y) ** 2)
    assert graph.gradients([square], SYMBOLS)[0][0] == graph.gradients([square], SYMBOLS)[0][1]
    slopes = graph.gradients([graph.of(sin(x * y * z))], SYMBOLS)[0]
    second = graph.gradients(slopes, SYMBOLS)
    assert all(second[i][k] == second[k][i] for i in range(3) for k in range(3))


def test_what_cancels_is_not_there():
    graph = Graph("of a test")
    assert graph.product([(graph.of(x * y), 1.0), (graph.of(x), -1.0)]) == graph.of(y)
    assert graph.sum([(graph.of(x + y), 1.0), (graph.of(x), -1.0)]) == graph.of(y)
    assert graph.product([(graph.of(0), 1.0), (graph.of(x), 1.0)]) == graph.of(0)


def test_products_share_their_factors():
    """Twenty products of x y z, a power of a and another factor: x y z is multiplied once."""
    graph = Graph("of a test")
    nodes = [graph.of(x * y * z * (a + k)) for k in range(20)]
    statements = kernel(graph, SYMBOLS, (a,), nodes, "of a test")
    assert statements.count("*") <= 2 + 20


def test_lengths_are_finite_at_rest_and_far_away():
    length = fm.laws.norm((x, y))
    graph = Graph("of a test")
    value = graph.of(z**2 / length**2 * x)
    found = outputs(graph, [value, *graph.gradients([graph.of(length), value], SYMBOLS)[0]])
    for scale in (0.0, 1e-250, 1e-30, 1e150):
        assert np.all(np.isfinite(found((scale, scale, 0.0), 1.0)))
    np.testing.assert_allclose(found((3e200, 4e200, 0.0), 1.0)[1:3], [0.6, 0.8], rtol=1e-15)


def test_the_side_that_is_not_taken_does_not_matter():
    graph = Graph("of a test")
    value = graph.of(Piecewise((sqrt(x) * log(x), x > 0), (y, True)))
    found = outputs(graph, [value, *graph.gradients([value], SYMBOLS)[0]])
    assert found((-1.0, 2.0, 0.0), 1.0).tolist() == [2.0, 0.0, 1.0, 0.0]


def test_long_chains_of_branches_are_no_matter():
    pieces = [(k * x, x < k) for k in range(1, 900)]
    graph = Graph("of a test")
    value = graph.of(Piecewise(*pieces, (y, True)))
    found = outputs(graph, [value, *graph.gradients([value], SYMBOLS)[0]])
    assert found((7.5, 2.0, 0.0), 1.0).tolist() == [8 * 7.5, 8.0, 0.0, 0.0]


def test_jumps_without_a_derivative_are_refused():
    graph = Graph("Staircase")
    value = graph.of(sympy.floor(x) * y)
    with pytest.raises(fm.SceneError, match=r"Staircase: .* has no closed form"):
        graph.gradients([value], SYMBOLS)
    assert graph.gradients([value], (y,))[0] == [graph.of(sympy.floor(x))]


def test_symbols_that_nobody_defined_are_named():
    graph = Graph("of a test")
    with pytest.raises(fm.SceneError, match="undefined symbols in a derived expression: left_over"):
        kernel(graph, SYMBOLS, (a,), [graph.of(x * sympy.Symbol("left_over"))], "of a test")
