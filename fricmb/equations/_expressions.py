"""Templates of expressions in time, coordinates, speeds and parameters; a plain number needs none and no SymPy."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass
from typing import Any

from fricmb.equations._templates import Template, get
from fricmb.errors import SceneError
from fricmb.values import is_expression, parameters_in, value_of


@dataclass(frozen=True, kw_only=True)
class Expression:
    """A template of an expression, and what its arguments stand for.

    ``coordinates``, ``speeds``: names of motions; the arguments are these in order, then time if ``timed``.
    ``parameters``: numbers of the kernel's parameters.
    """

    template: Template
    coordinates: tuple[str, ...]
    speeds: tuple[str, ...]
    timed: bool
    parameters: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class _Canonical:
    """An expression with its symbols renamed by place, so that equal formulas share one template."""

    value: Any
    arguments: tuple[Any, ...]
    parameters: tuple[Any, ...]
    numbers: tuple[float, ...]
    coordinates: tuple[str, ...]
    speeds: tuple[str, ...]
    timed: bool


def _canonical(value: Any, what: str) -> _Canonical:
    import sympy

    from fricmb.values._symbols import TIME, CoordinateSymbol, ParameterSymbol, SpeedSymbol

    value = sympy.sympify(value)
    free = sorted(value.free_symbols, key=lambda s: (str(s.name), str(getattr(s, "value", ""))))
    coordinates = [s for s in free if isinstance(s, CoordinateSymbol)]
    speeds = [s for s in free if isinstance(s, SpeedSymbol)]
    parameters = [s for s in free if isinstance(s, ParameterSymbol)]
    times = [s for s in free if s == TIME]
    unknown = [s for s in free if s not in {*coordinates, *speeds, *parameters, *times}]
    if unknown:
        raise SceneError(
            f"{what}: the symbol {unknown[0]} means nothing here; expressions hold fm.t, fm.coordinate(...), "
            f"fm.speed(...) and parameters"
        )
    for series in parameters:
        if not series.named:
            series.table.open()  # before its number is one that a kernel may get
    rename = {TIME: sympy.Symbol("t", real=True)}
    rename |= {s: sympy.Symbol(f"y{i}", real=True) for i, s in enumerate([*coordinates, *speeds])}
    rename |= {s: sympy.Symbol(f"a{i}", real=True) for i, s in enumerate(parameters)}
    return _Canonical(
        value=value.xreplace(rename),
        arguments=tuple(rename[s] for s in [*coordinates, *speeds, *times]),
        parameters=tuple(rename[s] for s in parameters),
        numbers=tuple(s.value for s in parameters),
        coordinates=tuple(s.motion for s in coordinates),
        speeds=tuple(s.motion for s in speeds),
        timed=bool(times),
    )


def value_expression(value: Any, what: str) -> Expression:
    """Template of one expression: out = [value, gradient]."""
    import sympy

    from fricmb.equations._expression import derive_value

    given = _canonical(value, what)
    template = get(
        "value",
        [sympy.srepr(given.value), given.arguments, given.parameters],
        lambda: derive_value(given.value, given.arguments, given.parameters, what),
    )
    return _expression(given, template)


def force_expression(value: Any, what: str) -> Expression:
    """Template of a force on one motion: out = [f, gradient, 0, 0, f v]; the last argument is that motion's rate v."""
    import sympy

    from fricmb.equations._expression import derive_force

    given = _canonical(value, what)
    template = get(
        "force",
        [sympy.srepr(given.value), given.arguments, given.parameters],
        lambda: derive_force(given.value, given.arguments, given.parameters, what),
    )
    return _expression(given, template)


def bend_expression(value: Any, what: str) -> Expression:
    """Template of the functions of the motion at which an expression bends: out = all of them."""
    import sympy

    from fricmb.equations._expression import derive_bends

    given = _canonical(value, what)
    motions = given.arguments[: len(given.coordinates) + len(given.speeds)]
    template = get(
        "bends",
        [sympy.srepr(given.value), given.arguments, given.parameters],
        lambda: derive_bends(given.value, given.arguments, motions, given.parameters, what),
    )
    return _expression(given, template)


def _expression(given: _Canonical, template: Template) -> Expression:
    return Expression(
        template=template,
        coordinates=given.coordinates,
        speeds=given.speeds,
        timed=given.timed,
        parameters=given.numbers,
    )


@dataclass(frozen=True, kw_only=True)
class Signal:
    """A prescribed function of time as a template with its parameters (the offset, which is last, included)."""

    template: Template
    parameters: tuple[float, ...]


def uniform_signal(rate: float, offset: float) -> Signal:
    """Uniform motion: u = offset + rate t."""
    return Signal(template=get("uniform", [], _derive_uniform), parameters=(rate, offset))


def _derive_uniform() -> tuple[dict[str, Any], str | None]:
    import sympy

    from fricmb.equations._expression import derive_signal

    t, rate = sympy.symbols("t rate", real=True)
    return derive_signal(rate, "rate", t, [rate], "uniform motion")


def signal_expression(value: Any, given: str, offset: float, what: str) -> Signal:
    """A signal from an expression of time; ``given``: "value", "force" or "rate"."""
    import sympy

    from fricmb.equations._expression import derive_signal

    held = _canonical(value, what)
    if held.coordinates or held.speeds:
        name = (*held.coordinates, *held.speeds)[0]
        raise SceneError(f"{what}: must depend on time alone, got an expression of the motion {name!r}")
    template = get(
        "signal",
        [sympy.srepr(held.value), given, held.parameters],
        lambda: derive_signal(held.value, given, sympy.Symbol("t", real=True), held.parameters, what),
    )
    return Signal(template=template, parameters=(*held.numbers, offset))


@dataclass(frozen=True, kw_only=True)
class ForceTerms:
    """A force expression term by term.

    ``slopes``: ("coordinate" or "speed", motion, coefficient) of its affine part, ``constant`` its constant;
    ``signal`` and ``rest``: expressions in the user's symbols, or None.
    """

    slopes: tuple[tuple[str, str, float], ...]
    constant: float
    signal: Any | None
    rest: Any | None


def force_terms(value: Any, what: str, prescribed: Container[str] = ()) -> ForceTerms:
    """Sort the terms of a force: a number, or an expression of time, motions and parameters.

    Terms in ``prescribed`` motions are never linear: their power is input.
    """
    if not is_expression(value):
        return ForceTerms(slopes=(), constant=float(value_of(value)), signal=None, rest=None)
    from fricmb.equations._expression import split_force
    from fricmb.equations._split import affine
    from fricmb.values._symbols import TIME, CoordinateSymbol, SpeedSymbol

    _canonical(value, what)
    motions = sorted((s for s in value.free_symbols if isinstance(s, CoordinateSymbol | SpeedSymbol)), key=str)
    outside = [s for s in motions if s.motion in prescribed]
    parts = split_force(value, [s for s in motions if s.motion not in prescribed], outside, TIME)
    motions = [s for s in motions if s.motion not in prescribed]
    slopes, constant = affine(parts.affine, motions)
    entries = [
        ("coordinate" if isinstance(s, CoordinateSymbol) else "speed", s.motion, float(value_of(slope)))
        for s, slope in zip(motions, slopes, strict=True)
    ]
    return ForceTerms(
        slopes=tuple(entry for entry in entries if entry[2] != 0.0),
        constant=float(value_of(constant)),
        signal=_alive(parts.signal),
        rest=_alive(parts.rest),
    )


def _alive(expression: Any) -> Any | None:
    """None for what is 0 once the parameters have their numbers (a term whose factor is 0)."""
    symbols = {symbol: parameter.value for symbol, parameter in _parameter_symbols(expression)}
    terms = [t for t in expression.as_ordered_terms() if t.subs({s: v for s, v in symbols.items() if v == 0.0}) != 0]
    return sum(terms) if terms and expression != 0 else None


def _parameter_symbols(expression: Any) -> list[tuple[Any, Any]]:
    from fricmb.values._symbols import ParameterSymbol

    held = {p.name: p for p in parameters_in(expression)}
    return [(s, held[s.name]) for s in expression.free_symbols if isinstance(s, ParameterSymbol) and s.named]
