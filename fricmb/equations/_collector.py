"""Symbols of motions and parameters while the equations of a scene are put together."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import sympy

from fricmb.equations._names import coordinate_symbols, parameter_symbol, slot_symbol
from fricmb.values import is_expression, symbolic, value_of
from fricmb.values._symbols import TIME, CoordinateSymbol, ParameterSymbol, SpeedSymbol


@dataclass(kw_only=True)
class Collector:
    """Symbols of motions and parameters while the equations are put together."""

    scene: Any
    t: Any = field(default_factory=lambda: sympy.Symbol("t", real=True))
    values: dict[Any, float] = field(default_factory=dict)
    prescribed: dict[Any, Any] = field(default_factory=dict)

    def motion(self, form: Any) -> tuple[Any, Any]:
        """Value and rate of a linear form."""
        value, rate = sympy.sympify(exact(form.constant)), sympy.S.Zero
        for name, coefficient in self.scene.expand(form).terms:
            position, velocity = self._named(name)
            value += exact(coefficient) * position
            rate += exact(coefficient) * velocity
        return value, rate

    def _named(self, name: str) -> tuple[Any, Any]:
        """Value and rate of a named motion; of a point of a rigid body as a function of the body's coordinates."""
        turned = self._turned(name)
        if turned is None:
            position, velocity, _ = coordinate_symbols(name)
            return position, velocity
        position, gradient = turned
        return position, sum(slope * coordinate_symbols(dof)[1] for dof, slope in gradient.items())

    def _turned(self, name: str) -> tuple[Any, dict[str, Any]] | None:
        """Position and gradient of a coordinate of a point of a rigid body; None for another motion."""
        owner, _, letter = name.rpartition(".")
        point = self.scene.rigid_points.get(owner)
        if point is None:
            return None
        dofs = point.body.dof_names
        q = [coordinate_symbols(dof)[0] for dof in dofs]
        position = point.body.define_point(q, [exact(x) for x in point.offset])["xy".index(letter)]
        slopes = {dof: sympy.diff(position, symbol) for dof, symbol in zip(dofs, q, strict=True)}
        return position, {dof: slope for dof, slope in slopes.items() if slope != 0}

    def row(self, form: Any) -> list[Any]:
        """Coefficients of a linear form on the degrees of freedom."""
        terms: dict[str, Any] = {}
        for name, coefficient in self.scene.expand(form).terms:
            turned = self._turned(name)
            for dof, slope in ({name: 1} if turned is None else turned[1]).items():
                terms[dof] = terms.get(dof, sympy.S.Zero) + exact(coefficient) * slope
        return [terms.get(name, sympy.S.Zero) for name in self.scene.dof_names]

    def number(self, part: Any, path: str, value: Any) -> Any:
        """Symbol of a slot, 0 where its number is 0."""
        number = float(value_of(value))
        if number == 0.0:
            return sympy.S.Zero
        symbol = slot_symbol(part, path, value)
        self.remember(symbol, value, number)
        return symbol

    def remember(self, symbol: Any, value: Any, number: float) -> None:
        """Keep the numbers behind the symbols of a slot."""
        if is_expression(value):
            self.values |= {s: held.value for s, held in zip(*_parameters(value, symbol), strict=True)}
        else:
            self.values[symbol] = number

    def parameters(self, part: Any, owner: Any, prefix: str = "") -> dict[Any, Any]:
        """Stand-in symbols of a declaration -> symbols of the scene."""
        stand = symbolic(owner)
        slots = owner.slots()
        found = {}
        for path, symbols in stand.symbols.items():
            held = slots[path]
            entries = held if isinstance(held, tuple) else (held,)
            for i, (symbol, entry) in enumerate(zip(symbols, entries, strict=True)):
                full = f"{prefix}{path}" + (f".{i + 1}" if isinstance(held, tuple) else "")
                found[symbol] = self.number(part, full, entry)
        return found

    def expression(self, value: Any) -> Any:
        """A user's expression in the scene's symbols."""
        replacement: dict[Any, Any] = {TIME: self.t}
        for symbol in value.free_symbols:
            if isinstance(symbol, CoordinateSymbol | SpeedSymbol):
                replacement[symbol] = self.motion(self.scene.motion(symbol.motion))[isinstance(symbol, SpeedSymbol)]
            elif isinstance(symbol, ParameterSymbol) and symbol.named:
                replacement[symbol] = parameter_symbol(symbol.name)
                self.values[replacement[symbol]] = symbol.value
        return value.xreplace(replacement)


def _parameters(value: Any, renamed: Any) -> tuple[list[Any], list[Any]]:
    held = sorted(value.free_symbols, key=str)
    return [parameter_symbol(s.name) for s in held], held


def exact(number: float) -> Any:
    """An integer where a coefficient is one."""
    return sympy.Integer(int(number)) if number == int(number) else sympy.Float(number)
