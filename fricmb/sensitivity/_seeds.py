"""Which numbers of which parts a parameter stands for."""

from __future__ import annotations

from typing import Any

from fricmb.equations._values import _symbolic_slots
from fricmb.errors import SceneError
from fricmb.scene import Scene
from fricmb.sensitivity._dual import Dual
from fricmb.values import Declaration, Parameter, is_expression, parameters_in, value_of

#: Part by which a number is changed to find a slope, a power of 2; shares of it, with weights: Richardson's difference
#: about the value, and, where it may be no smaller or no larger (no damping, say), differences of the same order to one
#: side.
_LITTLE = 2.0**-10
_WEIGHTS = ((1.0, -1.0 / 6.0), (0.5, 4.0 / 3.0), (-0.5, -4.0 / 3.0), (-1.0, 1.0 / 6.0))
_AHEAD = ((0.0, -25.0 / 3.0), (0.25, 16.0), (0.5, -12.0), (0.75, 16.0 / 3.0), (1.0, -1.0))
_BEHIND = tuple((-share, -weight) for share, weight in _AHEAD)


class Seeds:
    """Slopes of the numbers of parts with respect to parameters.

    Parameters
    ----------
    columns : dict of str to int
        Column of each parameter.
    scene : Scene
    """

    def __init__(self, columns: dict[str, int], scene: Scene) -> None:
        self.columns, self.scene = columns, scene

    def dual(self, value: Any, name: str) -> Dual:
        """A slot's value, whose own name is ``name`` ("k1x.stiffness")."""
        named = list(parameters_in(value))
        if not named:
            slopes: dict[int, Any] = {self.columns[name]: 1.0} if name in self.columns else {}
            return Dual(value=float(value_of(value)), slopes=slopes)
        slopes = {}
        for p in {p.name: p for p in named}.values():
            if p.name in self.columns:
                slopes[self.columns[p.name]] = _slope(value, p)
        return Dual(value=float(value_of(value)), slopes=slopes)

    def numbers(self, declaration: Declaration, prefix: str) -> list[Dual]:
        """The numbers behind a stand-in's symbols, in their order; ``prefix``: of their names ("lining.law.")."""
        found: list[Dual] = []
        for path, value in _symbolic_slots(declaration):
            if isinstance(value, tuple):
                found += [self.dual(entry, f"{prefix}{path}.{i}") for i, entry in enumerate(value)]
            else:
                found.append(self.dual(value, prefix + path))
        return found

    def touch(self, part: Any) -> list[str]:
        """Names of the parameters that a part's slots hold."""
        found = []
        for path, value in part.slots().items():
            named = [p.name for p in parameters_in(value)] or [f"{part.name}.{path}"]
            found += [name for name in named if name in self.columns]
        return found


    def varied(self, part: Any) -> dict[int, list[tuple[float, Any]]]:
        """By column of the parameters that a part holds: that part at other values, with weights.

        Weighted sums of what they say are differences to 1e-9: exact for what is linear in a parameter.
        """
        return {self.columns[name]: self._others(part, name) for name in dict.fromkeys(self.touch(part))}

    def _others(self, part: Any, name: str) -> list[tuple[float, Any]]:
        """The part at values about that of a parameter, or to one side of it, with weights."""
        p = float(value_of(self.scene.parameters[name]))
        h = _LITTLE * (abs(p) or 1.0)
        refused: list[SceneError] = []
        for weights in (_WEIGHTS, _AHEAD, _BEHIND):
            try:
                return [
                    (weight / h, self.scene.with_parameters({name: p + share * h})[part.name])
                    for share, weight in weights
                ]
            except SceneError as error:
                refused.append(error)
        raise SceneError(f"sensitivities: {name!r} can be neither larger nor smaller than {p:g}: {refused[0]}")


def _slope(value: Any, parameter: Parameter) -> float:
    """Derivative of a slot's value with respect to a named parameter in it."""
    if not is_expression(value):
        return 1.0
    from fricmb.values._symbols import ParameterSymbol

    (symbol,) = {s for s in value.free_symbols if isinstance(s, ParameterSymbol) and s.name == parameter.name}
    return float(value_of(value.diff(symbol)))
