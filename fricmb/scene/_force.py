"""A force on a body."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.errors import SceneError, shown
from fricmb.scene._axes import check_axis, direction, is_end
from fricmb.scene._element import Element
from fricmb.scene._expressions import check_expression, expression_uses
from fricmb.scene._forms import LinearForm
from fricmb.scene._part import GROUND, End


@dataclass(frozen=True, eq=False)
class Force(Element):
    """A force on a body along an axis.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    body : Body or point of a ModalBody
    axis : str or tuple of float
        Letter, or direction over the first axes of the body.
    value : float or SymPy expression
        In ``fm.t``, ``fm.coordinate("pad.x")``, ``fm.speed("pad.x")`` and parameters.

    Notes
    -----
    In ``sol.energy`` its work is input, also that of a constant one; what is linear in a speed counts as damping.
    """

    is_load: ClassVar[bool] = True

    body: End
    _: KW_ONLY
    axis: Any
    value: Any

    def __post_init__(self) -> None:
        super().__post_init__()
        body = is_end(self, "body", self.body)
        if not body.movable:
            raise SceneError(f"{self._label()}: body must have degrees of freedom, got {shown(body.end_name)}")
        self._set("axis", check_axis(self, "axis", self.axis))
        self._set("value", check_expression(self, "value", self.value, motions=True))
        self.local_coordinates()

    @property
    def signal_name(self) -> str:
        """What its function of time is known by."""
        return self.name

    def _takes_expression(self, field: str) -> bool:
        return field == "value"

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The body along the axis, then the motions in ``value`` in the order of ``expression_uses(value).motions``."""
        own = direction(self, "axis", self.axis, self.body, GROUND).form
        return (own, *(LinearForm.of({name: 1.0}) for name in expression_uses(self.value).motions))

    def define_force(self, x: tuple[Any, ...], x_dot: tuple[Any, ...], t: Any) -> tuple[Any, ...]:
        """``value`` on the body; nothing on the motions it depends on."""
        return (self.value, *(0 for _ in x[1:]))
