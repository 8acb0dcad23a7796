"""Axes and directions: letters, direction tuples, and the relative motion of two ends along them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.errors import SceneError, shown
from fricmb.scene._forms import LinearForm
from fricmb.scene._part import LETTERS, End, Part
from fricmb.values import Parameter, is_expression, is_list, value_of


@dataclass(frozen=True)
class Direction:
    """A unit direction and what it measures.

    Attributes
    ----------
    label : str
        The letter, or "t1", "t2" for direction tuples.
    vector : tuple of (str, float)
        Components along letters, none 0; of unit length.
    form : LinearForm
        Motion of a less that of b along the direction.
    """

    label: str
    vector: tuple[tuple[str, float], ...]
    form: LinearForm

    def dot(self, other: Direction) -> float:
        """Cosine of the angle between two directions."""
        components = dict(other.vector)
        return sum(c * components.get(letter, 0.0) for letter, c in self.vector)


def is_end(owner: Part, argument: str, value: Any) -> End:
    """An end, or a SceneError that says what is one."""
    if isinstance(value, End):
        return value
    hint = ""
    if isinstance(value, Part):
        hint = "; of a modal body take a point: body.point('tip')"
    raise SceneError(
        f"{owner._label()}: {argument} must be a Body, a Driven, a point of a ModalBody or GROUND,"
        f" got {shown(value)}{hint}"
    )


def check_ends(owner: Part, a: Any, b: Any) -> tuple[End, End]:
    """Two different ends of which at least one can move."""
    a, b = is_end(owner, "a", a), is_end(owner, "b", b)
    if (a.movable or b.movable) and a.end_name != b.end_name:
        return a, b
    names = f"{a.end_name!r} and {b.end_name!r}"
    if not (a.movable or b.movable):
        raise SceneError(f"{owner._label()}: one end must have degrees of freedom; of a, b = {names} none has")
    if a.end_name == b.end_name:
        raise SceneError(f"{owner._label()}: b must be another end than a, got {names}")
    return a, b


def check_axis(owner: Part, argument: str, axis: Any) -> Any:
    """A letter, or a tuple of numbers; :func:`direction` relates it to ends."""
    if isinstance(axis, str):
        if axis not in LETTERS:
            owner._refuse(argument, axis, "'x', 'y', 'z' or a direction tuple")
        return axis
    if is_list(axis) and 1 <= len(axis) <= 3:
        return tuple(owner._number(argument, entry) for entry in axis)
    owner._refuse(argument, axis, "'x', 'y', 'z' or a direction tuple")


def is_direction_tuple(value: Any) -> bool:
    """Whether ``value`` is one direction (a sequence of numbers), not a sequence of directions."""
    return is_list(value) and len(value) > 0 and all(_is_scalar(v) for v in value)


def _is_scalar(value: Any) -> bool:
    return isinstance(value, Parameter) or is_expression(value) or (np.ndim(value) == 0 and not isinstance(value, str))


def components(owner: Part, argument: str, axis: Any, a: End, b: End) -> tuple[tuple[str, float], ...]:
    """Unit components along letters of an axis that both ends have."""
    if isinstance(axis, str):
        if a.has_axis(axis) and b.has_axis(axis):
            return ((axis, 1.0),)
        vector = {axis: 1.0}
    else:
        letters = reference_letters(a, b)
        numbers = value_of(axis)
        if len(numbers) > len(letters):
            raise SceneError(
                f"{owner._label()}: {argument} has {len(numbers)} components, {a.end_name!r} and {b.end_name!r}"
                f" have the axes {''.join(letters)!r}"
            )
        length = math.hypot(*numbers)
        if length == 0.0 or not math.isfinite(length):
            owner._refuse(argument, axis, "a direction of non-zero length")
        vector = {letter: float(c / length) for letter, c in zip(letters, numbers, strict=False) if c != 0.0}
    for letter in vector:
        for end in (a, b):
            if end.letters is not None and letter not in end.letters:
                raise SceneError(
                    f"{owner._label()}: {argument} {axis!r} needs the axis {letter!r}, which {end.end_name!r} does not"
                    f" have (it has {''.join(end.letters)!r})"
                )
    return tuple(vector.items())


def reference_letters(a: End, b: End) -> tuple[str, ...]:
    """The axes that a direction tuple is over: those of a, or of b where a cannot move."""
    first, second = (a, b) if a.movable else (b, a)
    return first.letters or second.letters or ()


def direction(owner: Part, argument: str, axis: Any, a: End, b: End, label: str | None = None) -> Direction:
    """A direction and the motion of ``a`` less that of ``b`` along it."""
    vector = components(owner, argument, axis, a, b)
    return from_vector(vector, a, b, label if label is not None else (axis if isinstance(axis, str) else "t1"))


def from_vector(vector: tuple[tuple[str, float], ...], a: End, b: End, label: str) -> Direction:
    """A direction from its components; an end rests along an axis that it does not have."""
    terms: dict[str, float] = {}
    constant = 0.0
    for letter, c in vector:
        for end, factor in ((a, c), (b, -c)):
            if not end.has_axis(letter):
                continue
            form = end.motion(letter)
            constant += factor * form.constant
            for name, coefficient in form.terms:
                terms[name] = terms.get(name, 0.0) + factor * coefficient
    return Direction(label, vector, LinearForm.of(terms, constant))
