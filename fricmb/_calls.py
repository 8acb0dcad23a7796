"""Calls with an argument that is unknown, missing or without its name, answered with the name that was meant.

One mechanism for declarations, laws, models, functions and methods: a call is made as it is, and only where Python
refuses it with a TypeError is it compared with the signature.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from fricmb.errors import CallError, near_names, shown

_P = ParamSpec("_P")
_R = TypeVar("_R")
_KINDS = inspect.Parameter


def answers(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Let a function answer a call that does not fit its signature with a :class:`CallError`."""

    @wraps(function)
    def called(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        try:
            return function(*args, **kwargs)
        except TypeError:
            who = function.__qualname__.rpartition("<locals>.")[2].removesuffix(".__init__")
            misfit = _misfit(who, function, args, kwargs)
            if misfit is None:
                raise
            raise misfit from None

    return called


def answering(kind: type) -> None:
    """Let the constructor of a class answer; once for the class in which it stands."""
    owner = next(base for base in kind.__mro__ if "__init__" in vars(base))
    plain = vars(owner)["__init__"]
    if owner is object or getattr(plain, "_answers", False):
        return

    @wraps(plain)
    def __init__(self: Any, *args: Any, **kwargs: Any) -> None:
        try:
            plain(self, *args, **kwargs)
        except TypeError:
            misfit = _misfit(type(self).__name__, plain, (self, *args), kwargs)
            if misfit is None:
                raise
            raise misfit from None

    __init__._answers = True  # type: ignore[attr-defined]
    owner.__init__ = __init__  # type: ignore[misc]


class SignatureOfInit:
    """The signature of a class that has a ``__new__`` of its own is that of its ``__init__``."""

    def __get__(self, held: Any, kind: type) -> inspect.Signature:
        signature = inspect.signature(kind.__init__)  # type: ignore[misc]
        _, *own = signature.parameters.values()
        return signature.replace(parameters=own)


def _misfit(who: str, function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> CallError | None:
    """What is wrong with a call; None where it fits the signature, and the error came from inside."""
    signature = inspect.signature(function)
    try:
        signature.bind(*args, **kwargs)
    except TypeError:
        parameters = [p for p in signature.parameters.values() if p.name != "self"]
        return CallError(f"{who}(): {_said(parameters, args[len(signature.parameters) - len(parameters) :], kwargs)}")
    return None


def _said(parameters: list[inspect.Parameter], args: tuple[Any, ...], kwargs: dict[str, Any]) -> str:
    places = [p for p in parameters if p.kind in (_KINDS.POSITIONAL_ONLY, _KINDS.POSITIONAL_OR_KEYWORD)]
    known = [p.name for p in parameters if p.kind in (_KINDS.POSITIONAL_OR_KEYWORD, _KINDS.KEYWORD_ONLY)]
    open_ended = any(p.kind is _KINDS.VAR_KEYWORD for p in parameters)
    unknown = [] if open_ended else [name for name in kwargs if name not in known]
    if unknown:
        return _unknown(unknown[0], [name for name in known if name not in kwargs], known)
    if len(args) > len(places) and not any(p.kind is _KINDS.VAR_POSITIONAL for p in parameters):
        return _unnamed(places, [name for name in known if name not in kwargs], args)
    twice = [p.name for p in places[: len(args)] if p.name in kwargs]
    if twice:
        return f"got {twice[0]} twice, as argument {known.index(twice[0]) + 1} and by name"
    given = {p.name for p in places[: len(args)]} | set(kwargs)
    needed = [p for p in parameters if p.kind not in (_KINDS.VAR_POSITIONAL, _KINDS.VAR_KEYWORD)]
    missing = [p.name for p in needed if p.default is _KINDS.empty and p.name not in given]
    optional = [name for name in known if name not in given and name not in missing]
    more = f"; optional are {', '.join(optional)}" if optional else ""
    *others, last = (f"{name}=" for name in missing)
    first = f"{', '.join(others)} and " if others else ""
    return f"needs {first}{last} as well{more}"


def _unknown(name: str, free: list[str], known: list[str]) -> str:
    """An unknown name, with those that may be meant; in hertz, where angular frequencies are meant."""
    in_hertz = name.lower().endswith("_hz")
    near = near_names(name[:-3] if in_hertz else name, free) or near_names(name, known)
    hint = f"did you mean {' or '.join(f'{one}=' for one in near[:3])}?" if near else f"it takes {', '.join(known)}"
    if in_hertz:
        hint += " Frequencies are angular: 50 Hz are 50 * fm.Hz"
    return f"unknown argument {name!r}; {hint}"


def _unnamed(places: list[inspect.Parameter], known: list[str], args: tuple[Any, ...]) -> str:
    """Arguments that need their names."""
    taken = len(places)
    free = [name for name in known if name not in {p.name for p in places}]
    pairs = [f"{name}={shown(value)}" for name, value in zip(free, args[taken:], strict=False)]
    first = f"{taken} argument{'' if taken == 1 else 's'} without a name ({', '.join(p.name for p in places)})"
    first = first if taken else "no argument without a name"
    hint = f"; write {', '.join(pairs)}" if pairs else ""
    return f"takes {first}, got {len(args)}{hint}"
