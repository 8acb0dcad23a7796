"""Surfaces that bodies bounce on, at the instants of their impacts, with slopes: distances, rates, laws of impact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb import stated
from fricmb.equations._values import _symbolic_slots
from fricmb.scene import Joint
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._functions import Function
from fricmb.sensitivity._joints import columns_of, combined, driven, motion_of
from fricmb.sensitivity._motions import Moment, Row
from fricmb.sensitivity._parts import refuse
from fricmb.sensitivity._seeds import Seeds


@dataclass(frozen=True, kw_only=True)
class Meeting:
    """A surface at many times: ``gap``, its ``rate`` and row; ``slip`` and its row, None without friction."""

    gap: Dual
    rate: Dual
    row: Row
    slip: Dual | None = None
    slip_row: Row | None = None


class Struck:
    """A one-sided joint whose impacts are computed.

    ``restitution``, ``along``, ``mu``: numbers of its law of impact with their slopes.
    """

    def __init__(self, joint: Joint, seeds: Seeds) -> None:
        assert joint.impact is not None
        self.name = joint.name
        self.forms = joint.local_coordinates()
        self.drives = [driven(joint, drive, seeds) for drive in joint.drives()]
        self.function = Function(stated.joint_motion(joint, len(self.forms) + len(self.drives)))
        self.rubs = joint.friction is not None
        of: Any = getattr(joint, "of", joint)  # an end of a stop or of play, or a surface by itself
        if of is joint:
            self.numbers = seeds.numbers(joint.bare(), f"{joint.name}.")
        else:
            self.numbers = _numbers_of_side(joint, of, seeds)
        self.restitution = seeds.dual(of.restitution, f"{of.name}.restitution")
        self.along, self.mu = _along(joint, seeds), _friction(joint, seeds)
        known = {j for number in (*self.numbers, self.restitution, self.along, self.mu) for j in number.slopes}
        known |= {j for drive in self.drives for given in drive for j in columns_of(given)}
        for name in seeds.touch(of):
            if seeds.columns[name] not in known:
                refuse(of, f"the parameter {name!r}")

    def at(self, moment: Moment) -> Meeting:
        """Distance and slip."""
        motions = [moment.form(form) for form in self.forms] + [motion_of(drive, moment) for drive in self.drives]
        nothing = Dual(value=np.zeros_like(moment.t))
        values = self.function([*(m.position for m in motions), *(m.rate for m in motions), nothing, *self.numbers])
        n = len(motions)
        row, rate, _ = combined(motions, values[1 : 1 + n], values[1 + n])
        if not self.rubs:
            return Meeting(gap=values[0], rate=rate, row=row)
        slip_row, slip, _ = combined(motions, values[2 + n : 2 + 2 * n], values[2 + 2 * n])
        return Meeting(gap=values[0], rate=rate, row=row, slip=slip, slip_row=slip_row)


def _numbers_of_side(side: Joint, of: Any, seeds: Seeds) -> list[Dual]:
    """Numbers of one end of a part; it follows from the part's by sums, so differences tell its slopes."""
    slopes: list[dict[int, Any]] = [{} for _ in _symbolic_slots(side.bare())]
    for column, others in seeds.varied(of).items():
        for weight, other in others:
            (own,) = (one for one in other.sides() if one.side == side.side)
            for held, (_, value) in zip(slopes, _symbolic_slots(own.bare()), strict=True):
                held[column] = held.get(column, 0.0) + weight * float(value)
    held_now = [float(value) for _, value in _symbolic_slots(side.bare())]
    return [Dual(value=value, slopes=own) for value, own in zip(held_now, slopes, strict=True)]


def _along(joint: Any, seeds: Seeds) -> Dual:
    """Restitution of slip."""
    given = getattr(joint, "tangential_restitution", None)
    return Dual(value=0.0) if given is None else seeds.dual(given, f"{joint.name}.tangential_restitution")


def _friction(joint: Any, seeds: Seeds) -> Dual:
    """Friction coefficient in impacts: its own, or that of slip under Coulomb's law."""
    if joint.friction is None:
        return Dual(value=0.0)
    if joint.mu_impact is not None:
        return seeds.dual(joint.mu_impact, f"{joint.name}.mu_impact")
    law = joint.friction
    which = "mu_s" if law.mu_k is None else "mu_k"
    return seeds.dual(getattr(law, which), f"{joint.name}.friction.{which}")
