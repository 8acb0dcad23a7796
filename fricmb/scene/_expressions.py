"""Expressions in declarations: what they may hold and what they use."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

from fricmb.errors import SceneError
from fricmb.signal import is_series, signal_of, slope_told
from fricmb.values import Declaration, Parameter, is_expression, is_plain, parameters_in

#: Arguments that state where something is: the speed of a series follows from them.
_POSITIONS = ("position", "angle", "distance")


@dataclass(frozen=True)
class Uses:
    """What a slot's value depends on, besides numbers."""

    time: bool = False
    coordinates: tuple[str, ...] = ()
    speeds: tuple[str, ...] = ()
    parameters: tuple[Parameter, ...] = ()

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of all motions, coordinates first."""
        return tuple(dict.fromkeys(self.coordinates + self.speeds))

    @property
    def constant(self) -> bool:
        """Whether the value is a number once the parameters have theirs."""
        return not (self.time or self.coordinates or self.speeds)


def expression_uses(value: Any) -> Uses:
    """What ``value`` (number, parameter or expression) depends on."""
    parameters = tuple(parameters_in(value))
    if not is_expression(value):
        return Uses(parameters=parameters)
    from fricmb.values._symbols import TIME, CoordinateSymbol, SpeedSymbol

    symbols = value.free_symbols
    coordinates = sorted(s.motion for s in symbols if isinstance(s, CoordinateSymbol))
    speeds = sorted(s.motion for s in symbols if isinstance(s, SpeedSymbol))
    return Uses(TIME in symbols, tuple(coordinates), tuple(speeds), parameters)


def check_expression(
    owner: Declaration, argument: str, value: Any, *, motions: bool, minimum: float | None = None
) -> Any:
    """A number, or an expression in time (and in motions, if allowed) that can be evaluated.

    Raises
    ------
    SceneError
        Naming the symbols that are not known, or what else is wrong.
    """
    value = _of_series(owner, argument, value)
    accepted = "fm.t, fm.coordinate(...), fm.speed(...) and parameters" if motions else "fm.t and parameters"
    if isinstance(value, Parameter) or is_plain(value) or (is_expression(value) and expression_is_number(value)):
        return owner._number(argument, value, minimum=minimum)
    if not is_expression(value):
        owner._refuse(argument, value, f"a finite number or a SymPy expression in {accepted}")
    import sympy
    from sympy.core.function import AppliedUndef

    from fricmb.values._symbols import TIME, CoordinateSymbol, ParameterSymbol, SpeedSymbol

    known: tuple[type, ...] = (ParameterSymbol, CoordinateSymbol, SpeedSymbol) if motions else (ParameterSymbol,)
    strange = sorted(str(s) for s in value.free_symbols if s != TIME and not isinstance(s, known))
    if strange:
        raise SceneError(
            f"{owner._label()}: {argument} = {value} holds {', '.join(strange)}; accepted are {accepted}"
            + (" (sympy.Symbol('t') is not fm.t)" if "t" in strange else "")
        )
    if (
        value.atoms(AppliedUndef)
        or value.has(sympy.nan, sympy.oo, -sympy.oo, sympy.zoo, sympy.I)
        or value.is_real is False
    ):
        owner._refuse(argument, value, f"a real and finite expression in {accepted}")
    return _with_tables(owner, argument, value)


def _of_series(owner: Declaration, argument: str, value: Any) -> Any:
    """The expression of a measured series; anything else as it is."""
    if not is_series(value):
        return value
    try:
        signal = signal_of(value)
    except SceneError as error:
        raise SceneError(f"{owner._label()}: {argument}: {error}") from None
    if argument.startswith(_POSITIONS):
        told = slope_told(signal)
        if told:
            warnings.warn(f"{owner._label()}: {argument}: {told}", stacklevel=6)
    return signal._sympy_()


def _with_tables(owner: Declaration, argument: str, value: Any) -> Any:
    """An expression with long rows of pieces as tables; series in it are of time alone."""
    from fricmb.signal._symbols import Series, with_tables
    from fricmb.values._symbols import TIME

    value = with_tables(value)
    for node in value.atoms(Series) if value.has(Series) else ():
        x = node.args[0]
        if x.free_symbols != {TIME} or not x.is_polynomial(TIME) or x.diff(TIME).free_symbols:
            owner._refuse(argument, value, f"a series at fm.t, or at a line in it with numbers, not at {x}")
    return value


def expression_is_number(value: Any) -> bool:
    """Whether an expression holds parameters alone, or nothing."""
    from fricmb.values._symbols import ParameterSymbol

    return all(isinstance(s, ParameterSymbol) for s in value.free_symbols)
