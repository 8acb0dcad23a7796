"""Frictional contact between two ends: a relation (directions, normal force) and a law."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from itertools import combinations
from math import inf
from typing import Any, ClassVar, Literal, Self

from fricmb.errors import SceneError
from fricmb.laws import FrictionLaw
from fricmb.normal import Constant, NormalLaw, Prescribed
from fricmb.scene._axes import Direction, check_axis, check_ends, direction, from_vector, is_direction_tuple
from fricmb.scene._bodies import Driven
from fricmb.scene._expressions import check_expression, expression_uses
from fricmb.scene._part import GROUND, LETTERS, End, Part
from fricmb.signal import is_series
from fricmb.values import is_list


@dataclass(frozen=True, eq=False)
class Contact(Part):
    """Friction between two ends; the force acts on ``a`` and opposes its velocity relative to ``b``.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    a, b : Body, Driven, point of a ModalBody or GROUND
        Ends; b defaults to GROUND.
    law : FrictionLaw
    normal_force : float, SymPy expression or law of ``fm.normal``
        A number, an expression (as in :class:`Force`; only friction feels it, and below 0 it counts as 0), or a law.
    axes : str or sequence, optional
        Tangential directions: one or two letters or direction tuples, at right angles (a law of sliding and spinning
        takes three, the third the speed of the rim).  Default: the axes along which the ends move, less the axis of a
        normal-force law.  An end that lacks one of them is guided there: slip across the guide is part of the cone, and
        the guide bears the force.  Two ends that can both be moved must share an axis.
    slide : float, expression in ``fm.t``, or a sequence of one or two, optional
        Added to a's velocity relative to b, one for each direction.

    Raises
    ------
    SceneError
        If ends, directions or values are not accepted.
    """

    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "axes")

    a: End
    b: End = GROUND
    _: KW_ONLY
    law: FrictionLaw
    normal_force: Any
    axes: Any = None
    slide: Any = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_ends(self, self.a, self.b)
        if not isinstance(self.law, FrictionLaw):
            self._refuse("law", self.law, "a friction law, such as fm.laws.Coulomb(mu_s=0.5)")
        if type(self.law).__post_init__ is not FrictionLaw.__post_init__:
            self.law.check()  # an author's own __post_init__ need not have done so
        self._check_normal()
        if self.law.offsets() and self.normal_kind == "law":
            self._refuse("normal_force", self.normal_force, "a number or an expression beside a law with an offset")
        if self.axes is not None:
            self._set("axes", self._checked_axes())
        letters = self.letters_along()
        if letters is None or self.normal_kind != "constant" or len(letters) not in self.law.dimensions:
            self._check_directions(self.directions())
        if self.slide is not None and self.law.offsets():
            self._refuse("slide", self.slide, "left out beside a law with an offset; a fm.Driven moves the surface")
        if self.slide is not None:
            self._set("slide", self._checked_slide(len(self.labels())))

    def parts_within(self) -> tuple[Any, ...]:
        """What a law with an offset pushes with beside the friction about its centre."""
        if not self.law.offsets():
            return ()
        from fricmb.scene._offset import centres_of

        return centres_of(self)

    # -- normal force -------------------------------------------------------------------------------------------
    def _check_normal(self) -> None:
        if isinstance(self.normal_force, Constant | Prescribed):
            self._set("normal_force", self.normal_force.force)
        if isinstance(self.normal_force, NormalLaw):
            self.normal_direction()
            return
        if isinstance(self.normal_force, type | FrictionLaw):
            self._refuse("normal_force", self.normal_force, "a number, an expression or a law of fm.normal")
        if type(self.normal_force) is float and 0.0 <= self.normal_force < inf:
            return
        value = check_expression(self, "normal_force", self.normal_force, motions=True, minimum=0.0)
        self._set("normal_force", value)

    @property
    def normal_kind(self) -> Literal["constant", "expression", "law"]:
        """What the normal force is."""
        if type(self.normal_force) is float:
            return "constant"
        if isinstance(self.normal_force, NormalLaw):
            return "law"
        return "constant" if expression_uses(self.normal_force).constant else "expression"

    def normal_direction(self) -> Direction | None:
        """Axis of a normal-force law with the approach e = a - b along it; None for other normal forces."""
        law = self.normal_force
        if not isinstance(law, NormalLaw):
            return None
        return direction(self, "normal_force.axis", law.axis, self.a, self.b, "n")

    # -- directions ---------------------------------------------------------------------------------------------
    def _checked_axes(self) -> tuple[Any, ...]:
        axes = self.axes
        if isinstance(axes, str):
            entries: tuple[Any, ...] = tuple(axes)
        elif is_direction_tuple(axes):
            entries = (axes,)
        elif is_list(axes):
            entries = tuple(axes)
        else:
            self._refuse("axes", axes, "letters such as 'xy', or one or two direction tuples")
        if len(entries) not in self.law.dimensions:
            self._refuse("axes", axes, self._accepted_directions())
        return tuple(check_axis(self, "axes", entry) for entry in entries)

    def shared_letters(self) -> tuple[str, ...]:
        """Axes along which the ends slip: those that both have, and those along which one moves and the other cannot.

        What cannot move along an axis is guided: it rests along it, and the guide bears the force.  A driven end that
        is restricted to axes does not rub along others.
        """
        first, second = (self.a, self.b) if self.a.movable else (self.b, self.a)
        letters = first.letters or ()
        if second.movable:
            if not any(second.has_axis(c) for c in letters):
                return ()
            return (*letters, *(c for c in second.letters or () if c not in letters))
        if second.letters is not None:
            letters = tuple([c for c in letters if second.has_axis(c)])
        if not isinstance(second, Driven):
            return letters
        return (*letters, *(c for c in second.moving if not first.has_axis(c) and not second.rests_along(c)))

    def letters_along(self) -> tuple[str, ...] | None:
        """The letters of the tangential directions; None where these are no letters, or a normal-force law's matter."""
        if isinstance(self.normal_force, NormalLaw):
            return None
        if self.axes is None:
            return self.shared_letters()
        if not all(isinstance(axis, str) and self._slips_along(axis) for axis in self.axes):
            return None
        return self.axes if len(set(self.axes)) == len(self.axes) else None

    def _slips_along(self, letter: str) -> bool:
        """Whether a letter may be a direction: both ends have it, or one is guided across what moves along it."""
        if self.a.has_axis(letter) and self.b.has_axis(letter):
            return True
        return self.slide is not None or any(
            letter in end.moving and not end.rests_along(letter)
            if isinstance(end, Driven)
            else end.letters is not None and letter in end.letters
            for end in (self.a, self.b)
        )

    def _direction(self, axis: Any, label: str) -> Direction:
        """A tangential direction; along a letter an end may be guided."""
        if isinstance(axis, str) and self._slips_along(axis):
            return from_vector(((axis, 1.0),), self.a, self.b, label)
        return direction(self, "axes", axis, self.a, self.b, label)

    def labels(self) -> tuple[str, ...]:
        """Labels of the tangential directions."""
        return self.letters_along() or tuple(direction.label for direction in self.directions())

    def directions(self) -> tuple[Direction, ...]:
        """Tangential directions, one or two, each with the motion of a less that of b along it (without slide)."""
        return self._directions

    def _take_over(self, other: Self) -> None:
        plain = self.normal_kind == "constant" == other.normal_kind
        if plain and self.a is other.a and self.b is other.b and self.axes is other.axes:
            vars(self)["_directions"] = other._directions

    @cached_property
    def _directions(self) -> tuple[Direction, ...]:
        if self.axes is not None:
            labels = ("t",) if len(self.axes) == 1 else ("t1", "t2", "t3")
            return tuple(
                self._direction(axis, axis if isinstance(axis, str) else label)
                for axis, label in zip(self.axes, labels, strict=False)
            )
        letters = self.shared_letters()
        if not letters:
            raise SceneError(
                f"{self._label()}: the ends share no axis; {self.a.end_name!r} has {_letters(self.a)},"
                f" {self.b.end_name!r} has {_letters(self.b)}"
            )
        normal = self.normal_direction()
        if normal is None:
            return tuple(self._direction(c, c) for c in letters)
        if len(normal.vector) == 1:
            return tuple(self._direction(c, c) for c in letters if c != normal.vector[0][0])
        if len(letters) > 2:
            raise SceneError(f"{self._label()}: axes must be given beside an oblique normal force in three dimensions")
        # across an oblique normal in the plane
        held = dict(normal.vector)
        first, second = letters
        return (from_vector(((first, held[second]), (second, -held[first])), self.a, self.b, "t"),)

    def _check_directions(self, directions: tuple[Direction, ...]) -> None:
        shown = "".join(d.label for d in directions)
        if len(directions) not in self.law.dimensions:
            raise SceneError(
                f"{self._label()}: axes must be given: {self._accepted_directions()} of {shown!r}"
                if directions
                else f"{self._label()}: no tangential direction is left beside the normal-force law's axis"
            )
        if any(abs(first.dot(second)) > 1e-9 for first, second in combinations(directions, 2)):
            self._refuse("axes", self.axes, "two directions at right angles")
        normal = self.normal_direction()
        for tangent in directions:
            if normal is not None and abs(tangent.dot(normal)) > 1.0 - 1e-9:
                self._refuse("axes", self.axes, "other directions than that of the normal-force law")
        if self.axes is None and self.normal_kind == "expression":
            self._check_default_axes(directions)

    def _accepted_directions(self) -> str:
        words = {1: "one", 2: "two", 3: "three"}
        return " or ".join(words[d] for d in self.law.dimensions) + " tangential directions"

    def _check_default_axes(self, directions: tuple[Direction, ...]) -> None:
        """A normal force that depends on a coordinate along a default direction: which one is meant is not clear."""
        owners = {end.owner.name for end in (self.a, self.b)}
        letters = {letter for tangent in directions for letter, _ in tangent.vector}
        for name in expression_uses(self.normal_force).coordinates:
            if name.split(".")[0] in owners and name.rsplit(".", 1)[1] in letters:
                raise SceneError(
                    f"{self._label()}: axes must be given, because normal_force uses the coordinate {name!r} along a"
                    f" tangential direction (default directions {''.join(d.label for d in directions)!r})"
                )

    # -- slide --------------------------------------------------------------------------------------------------
    def _checked_slide(self, d: int) -> tuple[Any, ...]:
        given = tuple(self.slide) if is_list(self.slide) and not is_series(self.slide) else (self.slide,)
        if len(given) != d:
            held = "".join(self.labels())
            self._refuse(
                "slide", self.slide, f"{d} value(s), one for each tangential direction ({held}; axes= states others)"
            )
        return tuple(check_expression(self, "slide", value, motions=False) for value in given)

    def slides(self) -> tuple[Any, ...]:
        """Slide velocity along each direction (0.0 where there is none)."""
        return (0.0,) * len(self.directions()) if self.slide is None else self.slide


def _letters(end: End) -> str:
    return repr("".join(end.letters)) if end.letters is not None else repr("".join(LETTERS))
