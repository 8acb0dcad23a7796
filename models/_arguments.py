"""Arguments of a model are looked at before it computes with them."""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Mapping
from typing import Any, ParamSpec, TypeAlias

import numpy as np

import fricmb as fm
from fricmb._calls import answers
from fricmb.errors import shown
from fricmb.values import Parameter, as_float, is_expression, is_plain

P = ParamSpec("P")
#: A number that the model itself looks at.
Own: TypeAlias = float


def checked(build: Callable[P, fm.Scene]) -> Callable[P, fm.Scene]:
    """A model that names the argument, the value and what is accepted, where a value is not what its annotation says.

    Numbers may be named parameters and SymPy expressions, as everywhere in a scene; a model that computes with one of
    which only a number will do says so.  Ranges stay with the model, and with the parts that it declares.
    """
    signature = inspect.signature(build)
    kinds = {name: str(held.annotation).split(" | ") for name, held in signature.parameters.items()}

    @answers
    @functools.wraps(build)
    def model(*args: P.args, **kwargs: P.kwargs) -> fm.Scene:
        given = signature.bind(*args, **kwargs)
        for name, value in given.arguments.items():
            given.arguments[name] = _looked_at(f"{build.__name__}: {name}", value, kinds[name])
        try:
            return build(*given.args, **given.kwargs)
        except TypeError as error:
            symbols = [(name, value) for name, value in given.arguments.items() if _is_symbolic(value)]
            if not symbols:
                raise
            name, value = symbols[0]
            raise fm.SceneError(
                f"{build.__name__}: {name} must be a plain number, which this model computes with; got {shown(value)}"
            ) from error

    return model


def _looked_at(what: str, value: Any, kinds: list[str]) -> Any:
    """The value, a plain number as a float, where one of the annotation's kinds takes it."""
    takes = [_KINDS[kind] for kind in kinds if kind in _KINDS]
    if len(takes) < len(kinds):
        return value  # the model itself knows what it takes
    for take, _ in takes:
        found = take(value)
        if found is not _NO:
            return found
    accepted = " or ".join(said for _, said in takes)
    raise fm.SceneError(f"{what} must be {accepted}; got {shown(value)}")


def check_positive(model: str, **numbers: Any) -> None:
    """Numbers that a model divides by, or takes as lengths."""
    for name, value in numbers.items():
        if not value > 0.0:
            raise fm.SceneError(f"{model}: {name} must be a finite number > 0; got {shown(value)}")


_NO: Any = object()


def _is_symbolic(value: Any) -> bool:
    return isinstance(value, Parameter) or is_expression(value)


def _number(value: Any) -> Any:
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if is_plain(value):
        return float(value) if math.isfinite(as_float(value)) else _NO
    return value if _is_symbolic(value) else _NO


def _integer(value: Any) -> Any:
    if not isinstance(value, int | np.integer) or isinstance(value, bool):
        return _NO
    return int(value) if -(2**53) <= int(value) <= 2**53 else _NO  # no more than a float holds exactly


def _numbers(count: int | None = None) -> Callable[[Any], Any]:
    def take(value: Any) -> Any:
        if not isinstance(value, list | tuple | np.ndarray) or np.ndim(_as_array(value)) != 1:
            return _NO
        entries = tuple(_number(entry) for entry in value)
        return entries if count in (None, len(entries)) and _NO not in entries else _NO

    return take


def _as_array(value: Any) -> Any:
    """An array of the same nesting, whatever it holds; None where rows are of different lengths."""
    try:
        return np.asarray(value, dtype=object)
    except ValueError:
        return None


def _instance(kind: Any) -> Callable[[Any], Any]:
    return lambda value: value if isinstance(value, kind) else _NO


def _laws(value: Any) -> Any:
    right = isinstance(value, list | tuple) and all(isinstance(law, fm.FrictionLaw) for law in value)
    return value if right else _NO


#: What an annotation takes, and how a message says it.
_KINDS: Mapping[str, tuple[Callable[[Any], Any], str]] = {
    "None": (_instance(type(None)), "None"),
    "float": (_number, "a finite number"),
    "int": (_integer, "an integer"),
    "tuple[float, float]": (_numbers(2), "two finite numbers"),
    "tuple[float, float, float]": (_numbers(3), "three finite numbers"),
    "Sequence[float]": (_numbers(), "a list of finite numbers"),
    "dict[str, float]": (_instance(Mapping), "a dict of names and numbers"),
    "Callable[[float, float], float]": (_instance(Callable), "a function of two numbers"),
    "fm.FrictionLaw": (_instance(fm.FrictionLaw), "a friction law, such as fm.laws.Coulomb(mu_s=0.5)"),
    "Sequence[fm.FrictionLaw]": (_laws, "a list of friction laws"),
}
