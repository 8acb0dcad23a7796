"""Options of pictures are looked at by name, before anything is drawn: they mean the same everywhere."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterator
from math import isfinite
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, NoReturn, ParamSpec, TypeVar

import numpy as np
from matplotlib.axes import Axes

from fricmb._calls import answers
from fricmb.errors import FricmbError, SceneError, shown
from fricmb.laws import FrictionLaw
from fricmb.values import Units, as_float, has_entries, is_flag

if TYPE_CHECKING:
    from fricmb.solution import Solution

_P = ParamSpec("_P")
_R = TypeVar("_R")


def _is_number(value: object) -> bool:
    return isfinite(as_float(value))


def _is_positive(value: object) -> bool:
    return _is_number(value) and as_float(value) > 0.0


def _is_count(value: object) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool) and 1 <= int(value) < 2**53


def _is_stretch(value: object) -> bool:
    return is_flag(value) or (isinstance(value, tuple) and len(value) == 2 and all(map(_is_number, value)))


def _is_path(value: object) -> bool:
    return isinstance(value, str | PathLike) and "\0" not in str(value)


def _holds(kind: type | tuple[type, ...]) -> Callable[[Any], bool]:
    """Whether a value is a collection of such; one that gives its entries but once is taken as it is."""
    return lambda value: isinstance(value, Iterator) or (
        has_entries(value) and not isinstance(value, bytes) and all(isinstance(one, kind) for one in value)
    )


def _is(kind: Any) -> Callable[[object], bool]:
    return lambda value: isinstance(value, kind)


#: Whether an option of that name can be, and what is accepted.
_OPTIONS: dict[str, tuple[Callable[[Any], bool], str]] = {
    "ax": (_is(Axes), "axes of matplotlib"),
    **dict.fromkeys(("t_start", "t_end"), (_is_number, "a finite number")),
    **dict.fromkeys(
        ("highest", "magnify", "seconds", "speed", "fps", "normal_force"), (_is_positive, "a finite number > 0")
    ),
    "frames": (_is_count, "an integer of at least 1"),
    **dict.fromkeys(("hz", "legend", "logarithmic"), (is_flag, "True or False")),
    **dict.fromkeys(("name", "contact", "x", "y", "label"), (_is(str), "a name")),
    "names": (_holds(str), "a name or a list of them"),
    "modes": (_holds((int, np.integer)), "a list of numbers of modes"),
    "zoom": (_is_stretch, "True, False or two times, (1.0, 2.0)"),
    "path": (_is_path, "the path of a file"),
    "law": (_is(FrictionLaw), "a friction law, such as fm.laws.Coulomb(mu_s=0.5)"),
    "units": (_is(Units), 'a Units, such as fm.Units("s", "m", "N")'),
}


def refuse(who: str, argument: str, value: object, accepted: str) -> NoReturn:
    """Raise the error of an argument that is not accepted."""
    from fricmb.analysis import AnalysisError  # all of it is slow to load, and few pictures need it

    raise AnalysisError(f"{who}: {argument} must be {accepted}; got {shown(value)}")


def looked_at(method: Callable[_P, _R]) -> Callable[_P, _R]:
    """A picture whose options are looked at by name; a file that cannot be written is an error that names it.

    What is annotated to be None may be None.
    """
    signature = inspect.signature(method)
    optional = {name for name, held in signature.parameters.items() if "None" in str(held.annotation)}
    who = method.__name__

    @answers
    @functools.wraps(method)
    def draws(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        given = signature.bind(*args, **kwargs).arguments
        for argument, value in given.items():
            if argument not in _OPTIONS or (value is None and argument in optional):
                continue
            fits, accepted = _OPTIONS[argument]
            if not fits(value):
                refuse(who, argument, value, accepted + (" or None" if argument in optional else ""))
        try:
            return method(*args, **kwargs)
        except (FileNotFoundError, NotADirectoryError, IsADirectoryError, PermissionError) as error:
            if "path" not in given or error.filename is None:
                raise
            raise FricmbError(f"path: {fspath(error.filename)!r} cannot be written: {error.strerror}") from error

    return draws


def first_contact(sol: Solution, what: str) -> str:
    """Name of the first contact of a run; a picture of contacts needs one.

    Raises
    ------
    SceneError
        Where there are none.
    """
    if not sol.contact_names:
        raise SceneError(f"{what}: expected a run with contacts; this one has none")
    return sol.contact_names[0]
