"""Errors that users see.  Each carries its data, so that a program can act on it."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any


class FricmbError(Exception):
    """Base of every error that fricmb raises on purpose."""


class SceneError(FricmbError, ValueError):
    """A declaration that cannot be: names the part, the argument, the value and what is accepted."""


class LawError(FricmbError, ValueError):
    """A friction or normal-force law that cannot be."""


class UnknownNameError(SceneError, KeyError):
    """A name that does not exist; the message lists those near."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class IntegrationError(FricmbError):
    """A run that could not go on.

    Attributes
    ----------
    t : float
        Time at which it stopped.
    reason : str
        The condition that failed.
    partial : Solution or None
        The run up to the failure.
    """

    def __init__(self, message: str, *, t: float, reason: str, partial: Any = None) -> None:
        super().__init__(message)
        self.t = t
        self.reason = reason
        self.partial = partial

    def __reduce__(self) -> tuple[Any, ...]:
        return _integration_error, (str(self), self.t, self.reason, self.partial)


class Interrupted(KeyboardInterrupt):
    """A run that Ctrl-C has ended.

    Attributes
    ----------
    t : float
        Time that was reached.
    reason : str
        "interrupted".
    partial : Solution or None
        The run up to there.
    """

    def __init__(self, message: str, *, t: float, reason: str = "interrupted", partial: Any = None) -> None:
        super().__init__(message)
        self.t = t
        self.reason = reason
        self.partial = partial

    def __reduce__(self) -> tuple[Any, ...]:
        return _interrupted, (str(self), self.t, self.reason, self.partial)


def _interrupted(message: str, t: float, reason: str, partial: Any) -> Interrupted:
    return Interrupted(message, t=t, reason=reason, partial=partial)


def _integration_error(message: str, t: float, reason: str, partial: Any) -> IntegrationError:
    return IntegrationError(message, t=t, reason=reason, partial=partial)


def unknown_name(kind: str, name: object, known: Iterable[str]) -> UnknownNameError:
    """An error that names what was asked for and lists the names near it (all of them, if they are few)."""
    names = list(known)
    near = difflib.get_close_matches(str(name), names, n=6, cutoff=0.5)
    if near:
        hint = "did you mean " + ", ".join(repr(n) for n in near) + "?"
    elif names:
        shown = ", ".join(repr(n) for n in names[:12])
        hint = f"known: {shown}" + (f" and {len(names) - 12} more" if len(names) > 12 else "")
    else:
        hint = "there are none"
    return UnknownNameError(f"unknown {kind} {name!r}; {hint}")


def no_attribute(module: str, name: str, known: Iterable[str]) -> AttributeError:
    """The error of a module without a public name, which lists those near; an AttributeError, as Python asks."""
    near = difflib.get_close_matches(name, list(known), n=3, cutoff=0.6)
    hint = f"; did you mean {', '.join(near)}?" if near else ""
    return AttributeError(f"{module} has no {name!r}{hint}", name=name)
