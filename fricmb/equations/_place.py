"""The place of a motion that is given by its velocity: a closed form, or a quadrature in the kernel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mpmath
import numpy as np
import sympy
from sympy.simplify.fu import TR8

from fricmb.equations import _code
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.signals.pieces import LOWEST
from fricmb.signal._symbols import Series

#: Panels are halved so often at most; so many at first for waves, which a bell may hide; what these turn by in one.
ROUNDS, MOST, PHASE = 16, 4096, 5.0
#: Where closed forms are tried, and how near to the truth they must come in doubles.
PLACES, NEAR = (-0.73, 0.41, 1.9, 7.3), 1e-12
#: Integers and fractions beyond it are written as floats.
LARGE = 2**31


def integrate(value: Any, t: Any, switching: Sequence[Any]) -> Any | None:
    """Integral of a velocity from 0 to t by the quick methods, or None.

    ``switching``: functions at whose sign changes it jumps.  Of what switches without end, as ``Abs(sin(t))`` does,
    SymPy knows integrals of the pieces; put together they jump.
    """
    if value.has(Series):
        return _integral_of_series(value, t, switching)
    if not all(function.is_polynomial(t) for function in switching if function.has(t)):
        return None
    bells, rest = _without_bells(_exact(value), t)
    if rest == 0:
        return _in_floats(bells)
    if not switching and not _is_elementary(rest, t):
        return None  # SymPy may look for minutes, and what it finds is seldom of use in doubles
    if rest.has(sympy.sin, sympy.cos):
        rest = TR8(rest)  # sums for products of waves: their integrals are short, and exact in doubles
    plain = sympy.piecewise_fold(rest.rewrite(sympy.Heaviside, sympy.Piecewise).replace(sympy.Heaviside, _step))
    try:
        result = sympy.integrate(plain, t, risch=False, meijerg=False, heurisch=False)
    except (NotImplementedError, ValueError, TypeError, AttributeError, RecursionError):
        return None
    if result.has(sympy.Integral, sympy.nan, sympy.zoo):
        return None
    result = _in_doubles(result)
    start = result.subs(t, 0)
    if start.has(sympy.nan, sympy.zoo, sympy.oo):
        return None
    found = _in_floats(result - start)
    return found + _in_floats(bells) if switching or _is_sound(found, rest, t) else None


def _without_bells(value: Any, t: Any) -> tuple[Any, Any]:
    """The integral of the terms ``c exp(-a t^2 + b t + d)`` of a sum, and the others."""
    found, rest = sympy.S.Zero, sympy.S.Zero
    for term in sympy.Add.make_args(value):
        factor, core = term.as_independent(t, as_Add=False)
        power = core.args[0] if isinstance(core, sympy.exp) else sympy.S.Zero
        if not power.is_polynomial(t) or sympy.degree(power, t) != 2:
            rest += term
            continue
        a, b, d = (sympy.Poly(power, t).coeff_monomial(t**k) for k in (2, 1, 0))
        if not (-a).is_extended_nonnegative:
            rest += term
            continue
        root, centre = sympy.sqrt(-a), sympy.simplify(-b / (2 * a))
        height = sympy.exp(sympy.simplify(d - b**2 / (4 * a))) * sympy.sqrt(sympy.pi) / (2 * root)
        found += factor * height * (sympy.erf(root * (t - centre)) + sympy.erf(root * centre))
    return found, rest


def _is_elementary(value: Any, t: Any) -> bool:
    """Whether all functions of t have arguments linear in it, and no power has it in its exponent."""
    for node in sympy.preorder_traversal(value):
        if isinstance(node, sympy.Function) and node.has(t):
            if not node.args[0].is_polynomial(t) or sympy.degree(node.args[0], t) > 1:
                return False
        elif node.is_Pow and node.exp.has(t):
            return False
    return True


def _exact(value: Any) -> Any:
    """Fractions for floats: of a bell far from 0 the constants of the expanded square cancel, and alike elsewhere."""
    return value.replace(lambda x: x.is_Float, lambda x: sympy.Rational(repr(float(x))))


def _in_floats(value: Any) -> Any:
    return value.replace(lambda x: x.is_Rational and max(abs(x.p), x.q) > LARGE, lambda x: sympy.Float(x, 17))


def _is_sound(integral: Any, value: Any, t: Any) -> bool:
    """Whether a closed form has the right slope and keeps its digits in doubles: its terms may be large and cancel.

    Parameters are given some numbers.  The round-off of a time is in every function of it: of a wave of 100 Hz it is
    seen in the twelfth digit after seconds.
    """
    if integral.is_polynomial(t):
        return True
    symbols = sorted(value.free_symbols - {t}, key=str)
    numbers = {symbol: sympy.Float(0.7 + 0.11 * i) for i, symbol in enumerate(symbols)}
    closed, rate = integral.xreplace(numbers), value.xreplace(numbers)
    in_doubles = sympy.lambdify(t, closed, ["math", "scipy"])
    exact, slope, given = (sympy.lambdify(t, f, "mpmath") for f in (closed, sympy.diff(closed, t), rate))
    quick = [sympy.sympify(centre).xreplace(numbers) for centre, _ in _features(value, t)[0]]
    pairs: list[tuple[Any, Any]] = []
    moved: list[Any] = []
    with mpmath.workdps(60):
        for place in [*PLACES, *(float(centre) for centre in quick if centre.is_real)]:
            try:
                speed = given(mpmath.mpf(place))
                pairs.append((in_doubles(place), exact(mpmath.mpf(place))))
                pairs.append((slope(mpmath.mpf(place)), speed))
                moved.extend((4.0 * EPS * abs(place * speed), 0.0))
            except (NameError, TypeError, ValueError, ZeroDivisionError, OverflowError):
                return False
    if not all(mpmath.isfinite(x) and mpmath.im(x) == 0 for pair in pairs for x in pair):
        return False
    size = [max(1e-300, *(abs(float(b)) for _, b in pairs[i::2])) for i in (0, 1)]
    allowed = [NEAR * size[i % 2] + float(part) for i, part in enumerate(moved)]
    return all(abs(float(a - b)) <= most for (a, b), most in zip(pairs, allowed, strict=True))


def _in_doubles(value: Any) -> Any:
    """``log(cosh(u))`` and ``log(tanh(u) + 1)``, of integrals of what is engaged, as what stays finite for large u."""
    u = sympy.Wild("u")

    def soft(u: Any) -> Any:
        return sympy.log(1 + sympy.exp(-2 * sympy.Abs(u))) - sympy.log(2)

    value = value.replace(sympy.log(sympy.cosh(u)), lambda u: sympy.Abs(u) + soft(u))
    return value.replace(sympy.log(sympy.tanh(u) + 1), lambda u: -soft(u) - sympy.Max(0, -2 * u))


def _integral_of_series(value: Any, t: Any, switching: Sequence[Any]) -> Any | None:
    """Of a sum of series, each with a constant factor, and of what else has an integral."""
    found, rest = sympy.S.Zero, sympy.S.Zero
    for term in sympy.Add.make_args(sympy.expand(value)):
        factor, core = term.as_independent(t, as_Add=False)
        if isinstance(core, Series) and core.args[2] > LOWEST:
            x, table, order = core.args
            whole = Series(x, table, order - 1)
            found += factor / sympy.diff(x, t) * (whole - whole.xreplace({t: sympy.S.Zero}))
        elif core.has(Series):
            return None
        else:
            rest += term
    other = sympy.S.Zero if rest == 0 else integrate(rest, t, switching)
    return None if other is None else found + other


def _step(argument: Any, *_: Any) -> Any:
    return sympy.Piecewise((1, argument >= 0), (0, True))


def quadrature_kernel(value: Any, t: Any, parameters: Sequence[Any], title: str) -> str:
    """The integral by Gauss's formula on panels, which are halved until it no longer changes.

    A panel is short where the velocity may be quick (:func:`_features`): a tenth of a second's bell in an hour of rest
    would fall between the nodes of equal panels.
    """
    rate = [value, sympy.diff(value, t)]
    for expression in rate:
        _code.check(expression, title)
    quick, waves, known = _features(value, t)
    used = [e for pair in (*quick, *waves) for e in pair]
    rename, reads = _code.read_arguments([t], parameters, [*rate, t, *used])
    plain = [expression.xreplace(rename) for expression in rate]
    nodes, weights = np.polynomial.legendre.leggauss(10)
    there = sympy.Symbol("there", real=True)
    names = [f"quick{i}" for i in range(len(used))]
    near = [f"abs(edge - {names[2 * i]}), {names[2 * i + 1]}" for i in range(len(quick))]
    turns = zip(names[2 * len(quick) :: 2], names[2 * len(quick) + 1 :: 2], strict=True)
    swings = [f"abs({b} + {a}*edge) + sqrt(abs({a}))" for b, a in turns]
    lines = [
        *reads,
        *_code.body(plain, ["out[1]", "out[2]"]),
        *_code.body([e.xreplace(rename) for e in used], names),
        f"nodes = {tuple(nodes.tolist())!r}",
        f"weights = {tuple(weights.tolist())!r}",
        "low, high = min(0.0, x0), max(0.0, x0)",
        f"least, longest = (high - low)/{MOST}, 0.5*(high - low)",
        "part_of, total, size, change = 1.0, 0.0, 0.0, 0.0",
        f"for turn in range({ROUNDS}):",
        "    before, last, total, size, edge, panels = total, change, 0.0, 0.0, low, 0",
        "    while edge < high:",
        "        length = longest",
        *(f"        length = min(length, max(least, {PHASE}/({swing} + 1e-300)))" for swing in swings),
        *(f"        length = min(length, max({pair}))" for pair in near),
        "        half = 0.5*min(part_of*length, high - edge)",
        "        if edge + 2.0*half <= edge:",
        "            break",
        "        for node in range(10):",
        "            there = edge + half*(1.0 + nodes[node])",
        *("            " + line for line in _code.body([plain[0].xreplace({rename[t]: there})], ["part"])),
        "            total += weights[node]*half*part",
        "            size += abs(weights[node]*half*part)",
        "        edge += 2.0*half",
        "        panels += 1",
        "    change = abs(total - before)",
        # sums of many have more round-off, and so has a time far from 0
        "    settled = change <= 1e-6*size and change >= 0.5*last",
        f"    if turn > {0 if known else 1} and (settled or change <= 4e-16*sqrt(panels)*size):",
        "        break",
        "    part_of *= 0.5",
        f"out[0] = (total if x0 > 0.0 else -total) + p[{len(parameters) - 1}]",
    ]
    return _code.module(title, lines)


def _features(value: Any, t: Any) -> tuple[list[tuple[Any, Any]], list[tuple[Any, Any]], bool]:
    """Times about which a function is quick, each with the length of that; how fast waves turn: at t = 0, and on.

    The last says whether these are all.  Of functions and powers of what is linear or quadratic in t: the zeros of it
    and of its slope.
    """
    quick: list[tuple[Any, Any]] = []
    waves: list[tuple[Any, Any]] = []
    known = True
    for node in sympy.preorder_traversal(_exact(value)):
        inner = _argument(node, t)
        if inner is None:
            continue
        if not inner.is_polynomial(t) or sympy.degree(inner, t) > 2:
            known = False
            continue
        a, b, c = (sympy.Poly(inner, t).coeff_monomial(t**k) for k in (2, 1, 0))
        if isinstance(node, sympy.sin | sympy.cos):
            waves.append((b, 2 * a))
        elif a == 0:
            quick.append((-c / b, 1 / sympy.Abs(b)))
        else:
            apart = b**2 - 4 * a * c
            top, root = -b / (2 * a), sympy.sqrt(sympy.Abs(apart))
            quick.append((top, root / (2 * sympy.Abs(a)) if node.is_Pow else 1 / sympy.sqrt(sympy.Abs(a))))
            if not isinstance(node, sympy.exp) and apart != 0:
                quick += [((-b + sign * root) / (2 * a), 1 / root) for sign in (1, -1)]
    quick, waves = ([(_in_floats(a), _in_floats(b)) for a, b in dict.fromkeys(pairs)] for pairs in (quick, waves))
    return quick, waves, known


def _argument(node: Any, t: Any) -> Any | None:
    """What a function of t, or a root or quotient, is taken of."""
    is_power = node.is_Pow and not (node.exp.is_Integer and node.exp > 0)
    inner = node.args[0] if (isinstance(node, sympy.Function) and node.args) or is_power else None
    return inner if inner is not None and inner.has(t) else None
