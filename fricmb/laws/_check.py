"""Checks of the fields and of the cone of a friction law."""

from __future__ import annotations

from dataclasses import MISSING, fields
from functools import cache
from typing import Any

import numpy as np

from fricmb.errors import LawError
from fricmb.values import Declaration


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


def field_value(law: Any, name: str) -> Any:
    """A field in its form: a number, a tuple of numbers, an inner law, an option."""
    kind: Any = type(law)
    value, annotation = getattr(law, name), _annotations(kind)[name]
    text = annotation if isinstance(annotation, str) else getattr(annotation, "__name__", str(annotation))
    if isinstance(value, list | tuple | np.ndarray) and np.ndim(value) == 1:
        return tuple(law._number(f"{name}[{i}]", entry) for i, entry in enumerate(value))
    if isinstance(value, Declaration):
        return value
    if value is None or isinstance(value, bool):
        if text in ("float", "int"):
            law._refuse(name, value, "a finite number")
        return value
    if (isinstance(value, str) or callable(value)) and "float" not in text:
        return value  # an option: it selects a formula
    return law._number(name, value)


def check_cone(law: Any) -> None:
    """The break-away coefficient is not below the limit of slip, and both are finite and >= 0."""
    limit, mu_s = law.slip_limit(), law.break_away()
    if not np.isfinite(limit):
        raise LawError(f"{law._label()}: the coefficient must be finite at r = 0, got {limit!r}")
    if limit < 0.0:
        raise LawError(f"{law._label()}: the coefficient must be >= 0 at r = 0, got {limit!r}")
    if mu_s < limit * (1.0 - 1e-12):
        raise LawError(
            f"{law._label()}: mu_s must be at least the coefficient of slip for r -> 0 ({limit:g}), got {mu_s!r}"
        )
