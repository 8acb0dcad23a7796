"""Arguments and outputs in SymPy of what parts state, with a key that tells equal ones."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Any

from fricmb.equations._values import structure
from fricmb.laws._numeric import _MODULES

#: Names that compiled statements call, as numpy functions.
MODULES = _MODULES


@dataclass(frozen=True, kw_only=True)
class Statement:
    """Formulas of a part.

    Attributes
    ----------
    key : hashable
        What selects the formulas: what is compiled for one is good for all of the same key.
    make : callable
        Arguments and outputs in SymPy.
    """

    key: Hashable
    make: Callable[[], tuple[Sequence[Any], Sequence[Any]]]


def element(part: Any, n: int) -> Statement:
    """Forces of an element on its n local coordinates: of x, their rates, t and the element's numbers."""

    def make() -> tuple[Sequence[Any], Sequence[Any]]:
        from fricmb.equations._authors import element_math

        math = element_math(part, n)
        return [*math.x, *math.v, math.t, *math.parameters], math.total_force()

    return Statement(key=("element", structure(part), n), make=make)


def joint(part: Any, n: int) -> Statement:
    """A joint's statements, of x, x', multipliers and the joint's numbers.

    Outputs: constraints, their gradient by rows, and with friction the factors of each slip and the load.
    """

    def make() -> tuple[Sequence[Any], Sequence[Any]]:
        import sympy

        from fricmb.equations._joint import joint_math

        math = joint_math(part, n)
        outputs = [*math.phi, *(sympy.diff(phi, a) for phi in math.phi for a in math.x)]
        if math.slip is not None:
            outputs += [*(s for row in math.slip for s in row), math.load]
        return [*math.x, *math.v, *math.lam, *math.parameters], outputs

    return Statement(key=("joint", structure(part.bare()), n, part.friction is None), make=make)


def normal(law: Any) -> Statement:
    """A normal-force law before the cut at 0, of elongation, its rate and the law's numbers."""

    def make() -> tuple[Sequence[Any], Sequence[Any]]:
        from fricmb.equations._normal import normal_expression

        e, rate, N, parameters = normal_expression(law)
        return [e, rate, *parameters], [N]

    return Statement(key=("normal", structure(law)), make=make)


def place(body: Any) -> Statement:
    """A point of a type of body, of the body's coordinates and the point's offset: position, gradient by rows."""

    def make() -> tuple[Sequence[Any], Sequence[Any]]:
        import sympy

        q = sympy.symbols(f"q:{len(body.dof_names)}", real=True)
        offset = sympy.symbols("a b", real=True)
        position = body.define_point(q, offset)
        return [*q, *offset], [*position, *(sympy.diff(x, a) for x in position for a in q)]

    return Statement(key=("place", type(body)), make=make)


def joint_motion(part: Any, n: int) -> Statement:
    """What a joint states of its motion, of x, x', multipliers and the joint's numbers.

    Outputs: constraints, their gradient by rows, their second rates without accelerations; with friction factors of
    each slip, what its rate is without accelerations, and the load.
    """

    def make() -> tuple[Sequence[Any], Sequence[Any]]:
        import sympy

        from fricmb.equations._joint import joint_math

        math = joint_math(part, n)
        gradient = [[sympy.diff(phi, a) for a in math.x] for phi in math.phi]
        outputs = [*math.phi, *(s for row in gradient for s in row)]
        outputs += [_turned(row, math.x, math.v) for row in gradient]
        if math.slip is not None:
            outputs += [*(s for row in math.slip for s in row), *(_turned(row, math.x, math.v) for row in math.slip)]
            outputs.append(math.load)
        return [*math.x, *math.v, *math.lam, *math.parameters], outputs

    return Statement(key=("joint motion", structure(part.bare()), n, part.friction is None), make=make)


def _turned(row: Sequence[Any], x: Sequence[Any], v: Sequence[Any]) -> Any:
    """The rate of ``row . v`` for constant v."""
    return sum(c.diff(a) * w * u for c, w in zip(row, v, strict=True) for a, u in zip(x, v, strict=True))


def place_motion(body: Any) -> Statement:
    """A point of a type of body, of the body's coordinates, their rates and the point's offset.

    Outputs: position, gradient by rows, acceleration without those of the coordinates.
    """

    def make() -> tuple[Sequence[Any], Sequence[Any]]:
        import sympy

        n = len(body.dof_names)
        q, v = (sympy.symbols(f"{letter}:{n}", real=True) for letter in "qv")
        offset = sympy.symbols("a b", real=True)
        position = body.define_point(q, offset)
        rows = [[sympy.diff(x, a) for a in q] for x in position]
        outputs = [*position, *(s for row in rows for s in row), *(_turned(row, q, v) for row in rows)]
        return [*q, *v, *offset], outputs

    return Statement(key=("place motion", type(body)), make=make)


def coefficient(law: Any) -> Statement:
    """A friction coefficient, of slip speed, normal force and the law's numbers."""

    def make() -> tuple[Sequence[Any], Sequence[Any]]:
        from fricmb.laws._numeric import coefficient_expression
        from fricmb.values import symbolic

        stand = symbolic(law)
        r, N, mu = coefficient_expression(law, stand)
        return [r, N, *stand.flat], [mu]

    return Statement(key=("coefficient", structure(law)), make=make)


def scale(law: Any) -> Statement:
    """Factors of the directions of an anisotropic law, of the law's numbers."""

    def make() -> tuple[Sequence[Any], Sequence[Any]]:
        from fricmb.values import symbolic

        stand = symbolic(law)
        return list(stand.flat), list(stand.standin.axis_scale())

    return Statement(key=("scale", structure(law)), make=make)


def smooth(law: Any, d: int) -> Statement:
    """Force, then rate of the states, of a law that is a force: of v, N, z and the law's numbers."""

    def make() -> tuple[Sequence[Any], Sequence[Any]]:
        from fricmb.laws._numeric import force_expression
        from fricmb.values import symbolic

        stand = symbolic(law)
        v, N, z, force, rate = force_expression(law, stand, d)
        return [*v, N, *z, *stand.flat], [*force, *rate]

    return Statement(key=("smooth", structure(law), d), make=make)


@dataclass(frozen=True, kw_only=True)
class Read:
    """What an expression of a declaration reads: ``motions`` by position and by speed, and parameters."""

    coordinates: tuple[str, ...]
    speeds: tuple[str, ...]
    parameters: tuple[Any, ...]
    symbols: tuple[Any, ...]


def reads(value: Any) -> Read:
    """Of an expression; ``symbols``: time, coordinates, speeds, parameters."""
    from fricmb.values._symbols import TIME, CoordinateSymbol, ParameterSymbol, SpeedSymbol

    free = sorted(value.free_symbols, key=str)
    moved = [s for s in free if isinstance(s, CoordinateSymbol)]
    rates = [s for s in free if isinstance(s, SpeedSymbol)]
    held = [s for s in free if isinstance(s, ParameterSymbol)]
    return Read(
        coordinates=tuple(s.motion for s in moved), speeds=tuple(s.motion for s in rates), parameters=tuple(held),
        symbols=(TIME, *moved, *rates, *held),
    )  # fmt: skip


def expression(value: Any, symbols: tuple[Any, ...], order: int = 0) -> Statement:
    """An expression of a declaration, or its derivative of some order by time; ``symbols``: of :func:`reads`.

    A jump has no slope: it is a breakpoint of its own.
    """

    def make() -> tuple[Sequence[Any], Sequence[Any]]:
        import sympy

        from fricmb.equations._expression import slope, without_mod

        plain = without_mod(sympy.sympify(value).rewrite(sympy.Heaviside, sympy.Piecewise))
        for _ in range(order):
            plain = slope(plain, symbols[0]).replace(sympy.DiracDelta, lambda *_: sympy.S.Zero)
        return list(symbols), [plain]

    return Statement(key=("expression", value, symbols, order), make=make)
