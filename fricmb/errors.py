"""Errors that users see.  Each carries its data, so that a program can act on it."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable
from typing import Any


class FricmbError(Exception):
    """Base of every error that fricmb raises on purpose."""


class SceneError(FricmbError, ValueError):
    """A declaration that is not accepted; the message names the part, the argument, the value and what is accepted."""


class ArgumentError(FricmbError, ValueError):
    """An argument of a solver that cannot be: names it, its value and what is accepted."""


class FileError(FricmbError, ValueError):
    """A file that cannot be read: names the file, the record and what was expected."""


class MissingExtraError(FricmbError, ImportError):
    """A library that is not installed; the message names the extra that brings it."""

    def __init__(self, what: str, library: str, extra: str) -> None:
        super().__init__(f'{what} needs {library}: pip install "fricmb[{extra}]"')
        self.library, self.extra = library, extra

    def __reduce__(self) -> tuple[Any, ...]:
        what = str(self).partition(" needs ")[0]
        return MissingExtraError, (what, self.library, self.extra)


class LawError(FricmbError, ValueError):
    """A friction or normal-force law that is not accepted."""


class UnknownNameError(SceneError, KeyError):
    """A name that does not exist; the message lists those near."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class CallError(SceneError, TypeError):
    """A call with an argument that is unknown, missing, or without its name; says which was meant."""


class _Stopped(BaseException):
    """A run that has not reached its end: ``later`` assembles ``partial`` when it is first read."""

    def __init__(
        self, message: str, *, t: float, reason: str, partial: Any = None, later: Callable[[], Any] | None = None
    ) -> None:
        super().__init__(message)
        self.t = t
        self.reason = reason
        self._partial = partial
        self._later = later

    @property
    def partial(self) -> Any:
        """The run up to there."""
        if self._later is not None:
            self._partial = self._later()
            self._later = None
        return self._partial

    def passed_on(self, kind: type[_Stopped]) -> _Stopped:
        """The same of another kind."""
        return kind(str(self), t=self.t, reason=self.reason, later=lambda: self.partial)

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (type(self), str(self), self.t, self.reason, self.partial)


class IntegrationError(_Stopped, FricmbError):
    """A run that could not go on.

    Attributes
    ----------
    t : float
        Time at which it stopped.
    reason : str
        The condition that failed.
    partial : Solution or None
        The run up to the failure; assembled when it is first read.
    """


class Interrupted(_Stopped, KeyboardInterrupt):
    """A run that Ctrl-C has ended.

    Attributes
    ----------
    t : float
        Time that was reached.
    reason : str
        "interrupted".
    partial : Solution or None
        The run up to there; assembled when it is first read.
    """


def _again(kind: type[_Stopped], message: str, t: float, reason: str, partial: Any) -> _Stopped:
    return kind(message, t=t, reason=reason, partial=partial)


def shown(value: object) -> str:
    """A value in a message: on one line, and short."""
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # Python writes out no whole number of thousands of digits
        text = f"a value of type {type(value).__name__}"
    return text if len(text) <= 120 else text[:117] + "..."


def near_names(name: str, known: Iterable[str]) -> list[str]:
    """Names that may be meant, the nearest first."""
    return difflib.get_close_matches(name, list(known), n=6, cutoff=0.5)


def unknown_name(kind: str, name: object, known: Iterable[str]) -> UnknownNameError:
    """An error that names what was asked for and lists the names near it (all of them, if they are few)."""
    names = list(known)
    near = near_names(str(name), names)
    if near:
        hint = "did you mean " + ", ".join(repr(n) for n in near) + "?"
    elif names:
        some = ", ".join(repr(n) for n in names[:12])
        hint = f"known: {some}" + (f" and {len(names) - 12} more" if len(names) > 12 else "")
    else:
        hint = "there are none"
    return UnknownNameError(f"unknown {kind} {shown(name)}; {hint}")


def no_attribute(module: str, name: str, known: Iterable[str]) -> AttributeError:
    """The error of a module without a public name, which lists those near; an AttributeError, as Python asks."""
    near = difflib.get_close_matches(name, list(known), n=3, cutoff=0.6)
    hint = f"; did you mean {', '.join(near)}?" if near else ""
    return AttributeError(f"{module} has no {name!r}{hint}", name=name)
