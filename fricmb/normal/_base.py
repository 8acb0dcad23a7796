"""What every normal-force law states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fricmb.errors import FricmbError, LawError
from fricmb.values import Declaration


@dataclass(frozen=True, kw_only=True)
class NormalLaw(Declaration):
    """A normal force that both bodies feel: N = max(0, define_normal(e, e')).

    ``e`` is the position of the contact's ``a`` less that of ``b`` along ``axis`` (which points from b to a), 0 in the
    pressed equilibrium; both bodies feel ``N - preload``, so that q = 0 is an equilibrium.

    Attributes
    ----------
    axis : str or tuple of float
        Letter, or direction over the first axes of the contact's body.
    preload : Number
        Normal force at e = 0.
    """

    _error: ClassVar[type[FricmbError]] = LawError
    _fixed: ClassVar[tuple[str, ...]] = ("axis",)

    axis: Any
    preload: Any = 0.0

    def __post_init__(self) -> None:
        self._set("axis", _axis(self))
        for path, value in self.slots().items():
            if "." not in path and not isinstance(value, tuple):
                self._set(path, self._number(path, value))
        self._set("preload", self._number("preload", self.preload, minimum=0.0))
        self.numeric().validate()

    def validate(self) -> None:
        """Check the numbers; raises :class:`LawError`."""

    def define_normal(self, e: Any, e_dot: Any) -> Any:
        """The normal force before the cut at 0, in SymPy: ``e``, ``e_dot`` and the fields are symbols.

        It may bend (``Max``, ``Abs``, ``Piecewise``): steps end there.  Beyond its opening it may be negative or 0.
        """
        raise LawError(f"{type(self).__name__}: defines no define_normal(self, e, e_dot)")

    def define_stored(self, e: Any) -> Any:
        """An antiderivative of ``define_normal(e, 0)`` over e up to the opening; None: SymPy finds it."""
        return None


def _axis(law: NormalLaw) -> Any:
    axis = law.axis
    if isinstance(axis, str):
        if axis not in ("x", "y", "z"):
            law._refuse("axis", axis, "'x', 'y', 'z' or a direction tuple")
        return axis
    if isinstance(axis, list | tuple) and 1 <= len(axis) <= 3:
        return tuple(law._number("axis", entry) for entry in axis)
    law._refuse("axis", axis, "'x', 'y', 'z' or a direction tuple")
