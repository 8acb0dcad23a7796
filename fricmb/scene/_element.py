"""The protocol of everything that makes force."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Any, ClassVar

from fricmb.scene._forms import LinearForm
from fricmb.scene._part import Part
from fricmb.values import Parameter, is_expression, is_plain
from fricmb.values._declaration import slot_fields


@dataclass(frozen=True, eq=False)
class Element(Part):
    """Base of force elements.

    An author writes a frozen dataclass with a name, its ends and its parameters, and states

    - :meth:`local_coordinates`: the coordinates x it depends on, as linear forms in named motions;
    - any of :meth:`define_potential`, :meth:`define_dissipation`, :meth:`define_force`, in SymPy, where the fields of
      ``self`` are symbols.

    The force on the coordinates is ``-dV/dx - dR/dx' + define_force``; derivatives are derived, never written.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> import fricmb as fm
    >>> @dataclass(frozen=True, kw_only=True)
    ... class Quintic(fm.Element):
    ...     a: fm.Body
    ...     strength: float
    ...     def local_coordinates(self):
    ...         return (self.a.motion("x"),)
    ...     def define_potential(self, x):
    ...         return self.strength * x[0] ** 6 / 6
    >>> block = fm.Body("block", mass=1.0)
    >>> fm.Scene("demo", [block, Quintic(name="k", a=block, strength=2.0)]).parameters["k.strength"]
    2.0
    """

    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "body", "axis", "axes")
    #: Whether the work of all its forces is brought in from outside, of those that have a potential as well.
    is_load: ClassVar[bool] = False
    #: Whether what its linear part gives up is lost in the contact of its name, and nothing is stored.
    rubs: ClassVar[bool] = False
    #: Whether its force bends with the motion, so that steps have to end there; elements of other packages are asked.
    bends: ClassVar[bool] = False

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in slot_fields(type(self)):
            value = getattr(self, name)
            if (type(value) is float and isfinite(value)) or self._takes_expression(name):
                continue
            if is_plain(value) or isinstance(value, Parameter) or is_expression(value):
                self._set(name, self._number(name, value))
        self._check_positive()

    def _takes_expression(self, field: str) -> bool:
        """Whether a field may hold an expression of time and motions."""
        return False

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The coordinates x that the element depends on; their velocities follow."""
        raise NotImplementedError(f"{type(self).__name__} must define local_coordinates(self)")

    def define_potential(self, x: tuple[Any, ...]) -> Any | None:
        """Stored energy V(x), or None."""
        return None

    def define_dissipation(self, x: tuple[Any, ...], x_dot: tuple[Any, ...]) -> Any | None:
        """Rayleigh's function R(x, x'), with the force -dR/dx', or None."""
        return None

    def define_force(self, x: tuple[Any, ...], x_dot: tuple[Any, ...], t: Any) -> tuple[Any, ...] | None:
        """Generalised forces on the coordinates that have no potential, one for each, or None."""
        return None
