"""What all parts of a scene share."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar, Self

from fricmb.errors import SceneError, shown
from fricmb.scene._expressions import Uses, expression_uses
from fricmb.scene._forms import LinearForm
from fricmb.values import Declaration, is_expression
from fricmb.values._declaration import field_names, values_of
from fricmb.values._same import is_same

LETTERS = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class Part(Declaration):
    """A named part of a scene.

    Attributes
    ----------
    name : str
        Unique in a scene; without dots.
    """

    _fixed: ClassVar[tuple[str, ...]] = ("name",)
    _referred: ClassVar[bool] = True

    name: str

    def __post_init__(self) -> None:
        name = self.name
        if type(name) is str and name.isascii() and name.isidentifier():
            return
        if not isinstance(name, str) or not name or "." in name or name != name.strip() or not name.isprintable():
            raise SceneError(f"{type(self).__name__}: name must be a non-empty string without dots, got {shown(name)}")

    def _label(self) -> str:
        return f"{type(self).__name__} {self.name!r}"

    def ends(self) -> tuple[End, ...]:
        """Ends that this part acts on, in the order of its fields."""
        kind: Any = type(self)
        return tuple([value for value in _field_values(kind)(self) if isinstance(value, End)])

    def parts_within(self) -> tuple[Any, ...]:
        """What is built with this part, and bears its name."""
        return ()

    def companions(self) -> tuple[Any, ...]:
        """Further parts that a scene has beside this one."""
        return ()

    def expressions(self) -> dict[str, Any]:
        """Slots that hold SymPy expressions of time or motions: path -> expression."""
        if self.only_numbers():
            return {}
        return {
            path: value
            for path, value in self._entries()
            if is_expression(value) and not expression_uses(value).constant
        }

    def uses(self) -> dict[str, Uses]:
        """What each slot depends on, for slots that are no plain numbers."""
        if self.only_numbers():
            return {}
        found = {path: expression_uses(value) for path, value in self._entries() if not isinstance(value, float)}
        return {path: uses for path, uses in found.items() if uses != Uses()}

    def _entries(self) -> list[tuple[str, Any]]:
        entries: list[tuple[str, Any]] = []
        for path, value in self.slots().items():
            if isinstance(value, tuple):
                entries.extend((f"{path}.{i}", entry) for i, entry in enumerate(value))
            else:
                entries.append((path, value))
        return entries

    def with_ends(self, changed: dict[str, Part]) -> Self:
        """A copy that refers to the changed parts (by name); itself, if it refers to none of them."""
        new: dict[str, Any] = {}
        kind: Any = type(self)
        for name, value in zip(field_names(kind), _field_values(kind)(self), strict=True):
            if not isinstance(value, End) or value is GROUND:
                continue
            other = changed.get(value.owner.name)
            if other is not None and (end := value.moved_to(other)) is not value:
                new[name] = end
        if not new:
            return self
        if not all(_alike(self, end, getattr(self, name)) for name, end in new.items()):
            return dataclasses.replace(self, **new)
        # nothing that was checked can be wrong now
        copy = object.__new__(type(self))
        vars(copy).update(vars(self), **new, _original=original_of(self))
        return copy

    def differs_in(self, other: Part) -> set[str] | None:
        """Fields that hold something else, ends that move alike left out; None for a part of another type."""
        if original_of(self) is original_of(other):
            return set()
        if type(self) is not type(other):
            return None
        kind: Any = type(self)
        read = _field_values(kind)
        values = zip(field_names(kind), read(self), read(other), strict=True)
        return {name for name, a, b in values if not (is_same(a, b) or _alike(self, a, b))}


def original_of(part: Part) -> Part:
    """What a part equals in all but the numbers of the bodies that it refers to; itself, where it is no such copy."""
    found: Part = vars(part).get("_original", part)
    return found


def _alike(part: Part, one: Any, other: Any) -> bool:
    """Whether two values of a field are ends that are the same to a part.

    Parts of ours know their ends by names and axes; what those of other packages read of a body (where it starts, say)
    nobody knows.
    """
    ours = type(part).__module__.startswith("fricmb.")
    return ours and isinstance(one, End) and one.moves_like(other)


@cache
def _field_values(kind: type) -> Callable[[Any], tuple[Any, ...]]:
    return values_of(kind, field_names(kind))


class End:
    """Something an element or contact can act on: a body, a driven body, a point of a modal body, the ground."""

    @property
    def end_name(self) -> str:
        """Name in messages and motions: "pad", "plate.tip"."""
        raise NotImplementedError

    @property
    def owner(self) -> Part:
        """The part that must be in the scene."""
        raise NotImplementedError

    @property
    def letters(self) -> tuple[str, ...] | None:
        """Axes along which the end has a motion; None: every axis that its partner has."""
        raise NotImplementedError

    @property
    def movable(self) -> bool:
        """Whether forces move it."""
        raise NotImplementedError

    def has_axis(self, letter: str) -> bool:
        """Whether it has a motion along an axis, be it rest."""
        return self.letters is None or letter in self.letters

    def motion(self, letter: str) -> LinearForm:
        """The coordinate along an axis."""
        raise NotImplementedError

    def moves_like(self, other: object) -> bool:
        """Whether it has the same motions by the same names, so that what refers to the one may refer to the other."""
        return self is other

    def moved_to(self, part: Part) -> End:
        """The same end of another version of its part."""
        raise NotImplementedError


class PartEnd(Part, End):
    """A part that is an end itself."""

    @property
    def end_name(self) -> str:
        """The part's name."""
        return self.name

    @property
    def owner(self) -> Part:
        """The part itself."""
        return self

    def moved_to(self, part: Part) -> End:
        """The other version of the part."""
        return part if isinstance(part, End) else self


class PointEnd(End):
    """A named point of a body, whose fields are ``body`` and ``point``; forces move it."""

    body: Part
    point: str

    @property
    def end_name(self) -> str:
        """``"plate.tip"``."""
        return f"{self.body.name}.{self.point}"

    @property
    def owner(self) -> Part:
        """The body."""
        return self.body

    @property
    def movable(self) -> bool:
        """True: forces move it."""
        return True

    def motion(self, letter: str) -> LinearForm:
        """``"plate.tip.x"``: what it is in terms of the body's coordinates is known to the scene."""
        return LinearForm.of({f"{self.end_name}.{letter}": 1.0})


@dataclass(frozen=True, eq=False)
class Ground(PartEnd):
    """What never moves; there is one, :data:`GROUND`."""

    #: Files hold a word for it.
    _is_ground: ClassVar[bool] = True

    name: str = "ground"

    @property
    def letters(self) -> None:
        """Every axis its partner has."""
        return None

    @property
    def movable(self) -> bool:
        """False: the ground rests."""
        return False

    def motion(self, letter: str) -> LinearForm:
        """At rest."""
        return LinearForm()

    def moved_to(self, part: Part) -> End:
        """There is one ground."""
        return self

    def __repr__(self) -> str:
        return "GROUND"

    def __reduce__(self) -> str:
        return "GROUND"


#: The default second end of every element and contact.
GROUND = Ground()
