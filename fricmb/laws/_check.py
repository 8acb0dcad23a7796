"""Checks of the fields and of the cone of a friction law."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields
from functools import cache
from typing import Any

import numpy as np

from fricmb.errors import LawError, shown, unknown_name
from fricmb.values import Declaration, depth_of


def required_numbers(kind: Any) -> dict[str, float]:
    """0.5 for every field without a default."""
    return {f.name: 0.5 for f in fields(kind) if f.default is MISSING and f.default_factory is MISSING}


@cache
def no_fields(kind: Any) -> tuple[str, ...]:
    """Annotated names of a type that are no fields: its author forgot the decorator."""
    annotated = [name for name, a in vars(kind).get("__annotations__", {}).items() if "ClassVar" not in str(a)]
    return tuple(sorted(set(annotated) - {f.name for f in fields(kind)}))


@cache
def _annotations(kind: Any) -> dict[str, Any]:
    return {f.name: f.type for f in fields(kind)}


@cache
def _defaults(kind: Any) -> dict[str, Any]:
    return {f.name: f.default for f in fields(kind)}


def field_value(law: Any, name: str) -> Any:
    """A field in its form: a number, a tuple of numbers, an inner law, an option."""
    kind: Any = type(law)
    value, annotation = getattr(law, name), _annotations(kind)[name]
    text = annotation if isinstance(annotation, str) else getattr(annotation, "__name__", str(annotation))
    if isinstance(value, list | tuple | np.ndarray) and depth_of(value) == 1:
        return tuple(law._number(f"{name}[{i}]", entry) for i, entry in enumerate(value))
    if isinstance(value, Declaration):
        return value
    if value is None or isinstance(value, bool):
        default = _defaults(kind)[name]
        meant = default is None or "None" in text if value is None else isinstance(default, bool) or "bool" in text
        if not meant:
            law._refuse(name, value, "a finite number")
        return value
    if (isinstance(value, str) or callable(value)) and "float" not in text:
        return value  # an option: it selects a formula
    return law._number(name, value)


def no_numbers(law: Any) -> list[str]:
    """Fields that hold several numbers, none, a word or a function, where one number may be meant."""
    held = {f.name: getattr(law, f.name) for f in fields(law)}
    optional = {f.name for f in fields(law) if f.default is None}
    return [
        name
        for name, value in held.items()
        if isinstance(value, tuple | str | bool) or callable(value) or (value is None and name not in optional)
    ]


def check_said(law: Any) -> None:
    """What a law says of its states, directions and positive fields are names and numbers that there are."""
    who, states = law._label(), law.states
    if not isinstance(states, tuple) or not all(isinstance(s, str) and s.isidentifier() for s in states):
        raise LawError(f'{who}: states must be a tuple of names, such as ("z",); got {shown(states)}')
    if len(set(states)) < len(states):
        raise LawError(f"{who}: states must be different names; got {shown(states)}")
    kind: Any = type(law)
    own = _annotations(kind)
    for what, names, known in (("scalars", law.scalars, states), ("positive", law.positive, own)):
        if not isinstance(names, tuple):
            raise LawError(f'{who}: {what} must be a tuple of names, such as ("z",); got {shown(names)}')
        for name in names:
            if name not in known:
                raise LawError(f"{who}: {what}: {unknown_name('name', name, known)}")
    found = law.dimensions
    if not isinstance(found, tuple) or not found or not all(type(d) is int and d in (1, 2, 3) for d in found):
        raise LawError(f"{who}: dimensions must be a tuple of 1, 2, 3 or some of them; got {shown(found)}")


def check_copies(law: Any) -> None:
    """How often a state occurs is a whole number, of a state that there is."""
    found = law.copies()
    if not isinstance(found, Mapping):
        raise LawError(f"{law._label()}: copies must return a dict of names and whole numbers; got {shown(found)}")
    for name, count in found.items():
        if name not in law.states:
            wrong = unknown_name("name", name, law.states)
            raise LawError(f"{law._label()}: copies names an undeclared state: {wrong}")
        if isinstance(count, bool) or not isinstance(count, int | np.integer) or count < 1:
            raise LawError(f"{law._label()}: copies of {name} must be a whole number of at least 1; got {shown(count)}")


def check_cone(law: Any) -> None:
    """The break-away coefficient is not below the limit of slip, and both are finite and >= 0."""
    limit, mu_s = law.slip_limit(), law.break_away()
    if not np.isfinite(limit):
        raise LawError(f"{law._label()}: the coefficient must be finite at r = 0, got {shown(limit)}")
    if limit < 0.0:
        raise LawError(f"{law._label()}: the coefficient must be >= 0 at r = 0, got {shown(limit)}")
    if mu_s < limit * (1.0 - 1e-12):
        raise LawError(
            f"{law._label()}: mu_s must be at least the coefficient of slip for r -> 0 ({limit:g}), got {shown(mu_s)}"
        )
