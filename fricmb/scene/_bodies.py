"""Bodies that forces move and bodies whose motion is prescribed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field
from functools import cache, lru_cache
from types import MappingProxyType
from typing import Any, ClassVar

from fricmb.errors import SceneError
from fricmb.scene._expressions import check_expression, expression_uses
from fricmb.scene._forms import LinearForm
from fricmb.scene._part import LETTERS, Part, PartEnd
from fricmb.values import value_of
from fricmb.values._same import is_same


def check_letters(owner: Part, argument: str, axes: Any) -> str:
    """Axes of a body: some of the letters x, y, z, none twice."""
    letters = axes if isinstance(axes, str) else ""
    if not letters or any(c not in LETTERS for c in letters) or len(set(letters)) < len(letters):
        owner._refuse(argument, axes, "a string of one to three different letters of 'x', 'y', 'z'")
    return letters


def check_keys(owner: Part, argument: str, values: Any, known: tuple[str, ...]) -> dict[str, Any]:
    """A mapping whose keys are known."""
    if not isinstance(values, Mapping):
        owner._refuse(argument, values, "a dict of axis to value, such as {'x': 1.0}")
    for key in values:
        if key not in known:
            shown = ", ".join(repr(k) for k in known[:6]) + (", ..." if len(known) > 6 else "")
            raise SceneError(f"{owner._label()}: {argument} has the key {key!r}; accepted are {shown}")
    return dict(values)


def _start(axes: str, values: tuple[Any, ...]) -> Mapping[str, Any]:
    return MappingProxyType(dict(zip(axes, values, strict=True)))


#: Bodies that start alike hold one mapping: of 100 000 blocks each its own would take 50 megabytes.
_shared = lru_cache(maxsize=1024)(_start)


def _is_start(values: Any, axes: str) -> bool:
    """Whether values are a mapping that bodies share, checked before, as those of a body of which this is a copy."""
    if type(values) is not MappingProxyType or len(values) != len(axes):
        return False
    held = tuple(values.values())
    return all(type(value) is float for value in held) and _shared(axes, held) is values


#: The letters of a string; one tuple for all that have the same.
letters_in = cache(tuple[str, ...])


@dataclass(frozen=True, eq=False)
class Body(PartEnd):
    """A rigid body that moves along axes without turning.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    mass : float
        > 0.  Runs also accept 0, for a slider between one spring and one contact under Coulomb's law (a Jenkins
        element), and for a body on springs whose velocity follows from dampers or viscous laws (quasi-dynamic blocks).
    axes : str
        Any of "x", "y", "z"; each is a degree of freedom, named ``"name.x"``.
    position, velocity : dict of str to float
        Initial values along the axes; default 0.

    Raises
    ------
    SceneError
        If a value is not accepted.
    """

    _fixed: ClassVar[tuple[str, ...]] = ("name", "axes")

    _: KW_ONLY
    mass: Any
    axes: str = "x"
    position: Mapping[str, Any] = field(default_factory=dict)
    velocity: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        self._set("mass", self._number("mass", self.mass, minimum=0.0))
        check_letters(self, "axes", self.axes)
        for argument in ("position", "velocity"):
            if _is_start(getattr(self, argument), self.axes):
                continue
            given = check_keys(self, argument, getattr(self, argument), tuple(self.axes))
            values = {c: self._number(f"{argument}[{c!r}]", given[c]) for c in given}
            start = tuple([values.get(c, 0.0) for c in self.axes])
            plain = all(type(value) is float for value in start)
            self._set(argument, (_shared if plain else _start)(self.axes, start))

    @property
    def dof_names(self) -> tuple[str, ...]:
        """``"name.x"``, ... in the order of ``axes``."""
        return tuple(f"{self.name}.{c}" for c in self.axes)

    def start_values(self, argument: str) -> Mapping[str, Any]:
        """Declared start of the degrees of freedom; ``argument``: "position" or "velocity"."""
        values: Mapping[str, Any] = getattr(self, argument)
        return values

    @property
    def letters(self) -> tuple[str, ...]:
        """Letters of its axes."""
        return letters_in(self.axes)

    def has_axis(self, letter: str) -> bool:
        """Whether it has a degree of freedom along an axis."""
        return letter in self.axes

    @property
    def movable(self) -> bool:
        """True: forces move it."""
        return True

    def moves_like(self, other: object) -> bool:
        """Whether the other has the same name and axes, whatever its numbers."""
        return (
            isinstance(other, Body) and type(self) is type(other) is Body
            and (self.name, self.axes) == (other.name, other.axes)
        )  # fmt: skip

    def motion(self, letter: str) -> LinearForm:
        """A degree of freedom."""
        return LinearForm.of({f"{self.name}.{letter}": 1.0})


@dataclass(frozen=True, eq=False)
class Driven(PartEnd):
    """A body whose motion is prescribed.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    velocity : dict of str to float or expression in ``fm.t``
        Along axes; the position is its integral from the start of the run, from ``position`` (a number) on.
    position : dict of str to float or expression in ``fm.t``
        Along axes.  Without a velocity beside it: the motion itself.
    axes : str, optional
        Restricts the axes; default: every axis its partner has, at rest along those not named.

    Raises
    ------
    SceneError
        If a value is not accepted.
    """

    _fixed: ClassVar[tuple[str, ...]] = ("name", "axes")

    _: KW_ONLY
    velocity: Mapping[str, Any] = field(default_factory=dict)
    position: Mapping[str, Any] = field(default_factory=dict)
    axes: str | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.axes is not None:
            self._set("axes", check_letters(self, "axes", self.axes))
        known = LETTERS if self.axes is None else tuple(self.axes)
        for argument in ("velocity", "position"):
            given = check_keys(self, argument, getattr(self, argument), known)
            values = {
                c: check_expression(self, f"{argument}[{c!r}]", given[c], motions=False) for c in LETTERS if c in given
            }
            self._set(argument, MappingProxyType(values))
        for letter in self.velocity:
            if not expression_uses(self.position.get(letter, 0.0)).constant:
                self._refuse(f"position[{letter!r}]", self.position[letter], "a number where the velocity is given too")

    @property
    def letters(self) -> tuple[str, ...] | None:
        """Its axes, if restricted."""
        return None if self.axes is None else tuple(self.axes)

    @property
    def moving(self) -> tuple[str, ...]:
        """Letters along which a motion is prescribed; at rest along all others."""
        return tuple(c for c in LETTERS if c in self.velocity or c in self.position)

    def rests_along(self, letter: str) -> bool:
        """Whether it never moves along an axis: where none is prescribed, or a number, for a velocity that is 0."""
        if letter in self.velocity:
            speed = self.velocity[letter]
            return expression_uses(speed).constant and float(value_of(speed)) == 0.0
        return expression_uses(self.position.get(letter, 0.0)).constant

    @property
    def movable(self) -> bool:
        """False: forces do not move it."""
        return False

    def moves_like(self, other: object) -> bool:
        """Whether the other has the same name and the same motion in the same numbers."""
        fields = ("name", "velocity", "position", "axes")
        return type(other) is type(self) is Driven and all(
            is_same(getattr(self, name), getattr(other, name)) for name in fields
        )

    def motion(self, letter: str) -> LinearForm:
        """The prescribed motion; 0 along an axis that is not named."""
        return LinearForm.of({f"{self.name}.{letter}": 1.0} if letter in self.moving else {})
