"""Refusal of numbers that are not accepted, by the name of their field."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fricmb.values import Declaration, is_expression


def refuses(declaration: Declaration, *rest: Any) -> Iterator[str]:
    """Numbers that are not accepted, by field; arrays and expressions have checks of their own."""
    for path, value in declaration.slots().items():
        if not isinstance(value, tuple | float | int) and not hasattr(value, "value") and not is_expression(value):
            continue
        wrong = [float("nan"), float("inf")]
        if path in declaration.positive:
            wrong += [0.0, -1.0]
        for number in wrong:
            bad = (number, *value[1:]) if isinstance(value, tuple) else number
            try:
                declaration.with_slots({path: bad})
            except Exception as error:
                if not isinstance(error, ValueError) or path.rsplit(".", 1)[-1] not in str(error):
                    yield f"{path} = {number!r} is refused by {type(error).__name__} without its name: {error}"
            else:
                yield f"{path} = {number!r} is accepted"
