"""Resistance of a ball, a disc or a top against rolling and spinning on a plane, by the reaction of the plane."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np

from fricmb.integrate.problem import Floats
from fricmb.scene._forms import LinearForm
from fricmb.scene._resistance import Resistance
from fricmb.space._joint import SpaceJoint
from fricmb.space._rotor import Rotor
from fricmb.space._turn import triad
from fricmb.space._turning import KINDS, kind_of, turning_forms, turning_rows
from fricmb.values import is_expression, value_of


@dataclass(frozen=True, eq=False)
class TurningResistance(Resistance, SpaceJoint):
    """A torque against the angular velocity along a plane (two directions), or about its normal.

    An :class:`OnPlane` with ``rolling_resistance`` or ``spinning_resistance`` has them beside it in a scene, under its
    name and ``_rolling`` or ``_spinning``.
    """

    only_relative: ClassVar[bool] = False
    directions: ClassVar[tuple[str, ...]] = ("normal",)
    _fixed: ClassVar[tuple[str, ...]] = (*Resistance._fixed, "normal", "turning")
    _: KW_ONLY
    normal: Any
    spins: bool
    turning: Any = 0.0

    @property
    def slip_rows(self) -> int:  # type: ignore[override]
        """Of spin one."""
        return 1 if self.spins else 2

    def _takes_expression(self, field: str) -> bool:
        return field == "turning"

    def frame(self) -> Floats:
        """Directions 1 and 2 of the plane, and its normal, as rows (3, 3)."""
        e = self.direction("normal")
        u, w = triad(e)
        return np.array([u, w, e])

    def labels(self) -> tuple[str, ...]:
        """Angular velocities."""
        return ("spin",) if self.spins else ("about1", "about2")

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """What turns, by the directions of the plane."""
        forms = turning_forms(self.a.owner)
        if isinstance(self.a.owner, Rotor):
            return (*self.seen(forms[:3]), *forms[3:])
        return tuple(form for i in range(0, len(forms), 3) for form in self.seen(forms[i : i + 3]))

    def drives(self) -> tuple[Any, ...]:
        """The angle of a turntable, for spin."""
        still = not is_expression(self.turning) and value_of(self.turning) == 0.0
        return () if still or not self.spins else (("rate", self.turning, 0.0),)

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Angular velocity relative to the plane."""
        kind = kind_of(self, "a")
        rows = turning_rows(kind, x[: KINDS[kind]])
        if not self.spins:
            return rows[0], rows[1]
        return (*rows[2], -1) if len(x) > KINDS[kind] else rows[2]
