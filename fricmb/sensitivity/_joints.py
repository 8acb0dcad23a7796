"""Joints at many times with their slopes: constraints, reactions as unknowns, friction with its load."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fricmb import stated
from fricmb.integrate.problem import Codes, Floats
from fricmb.scene import Joint
from fricmb.sensitivity._dual import Dual, summed
from fricmb.sensitivity._found import Found, Held, masked
from fricmb.sensitivity._friction import Friction
from fricmb.sensitivity._functions import Function
from fricmb.sensitivity._motions import Given, Moment, Motion, Row
from fricmb.sensitivity._parts import refuse
from fricmb.sensitivity._seeds import Seeds


class Joins:
    """A joint; ``number``: its place among the contacts of the run, None without friction; ``states``: of its law."""

    def __init__(self, joint: Joint, number: int | None, states: int, seeds: Seeds) -> None:
        self.name, self.number = joint.name, number
        self.pressed = joint.loaded_by or joint.name
        if joint.hands_over:
            refuse(joint, "a joint that lets go")
        self.forms = joint.local_coordinates()
        self.drives = [driven(joint, drive, seeds) for drive in joint.drives()]
        self.count = len(self.forms) + len(self.drives)
        self.function = Function(stated.joint_motion(joint, self.count))
        self.numbers = seeds.numbers(joint.bare(), f"{joint.name}.")
        self.slips = 0 if joint.friction is None else joint.slip_rows
        self.friction = None
        if joint.friction is not None and number is not None:
            prefix = f"{joint.name}.friction."
            self.friction = Friction(joint, joint.friction, number, self.slips, states, prefix, seeds)
        self._check(joint, seeds)

    def _check(self, joint: Joint, seeds: Seeds) -> None:
        """Refuse parameters that are none of what is differentiated here."""
        law = () if self.friction is None else self.friction.numbers
        known = {j for number in (*self.numbers, *law) for j in number.slopes}
        known |= {j for drive in self.drives for given in drive for j in columns_of(given)}
        for name in seeds.touch(joint):
            if seeds.columns[name] not in known:
                refuse(joint, f"the parameter {name!r}")

    def add(
        self, moment: Moment, found: Found, lam: Sequence[Dual], pressing: Sequence[Dual], mode: Any, sign: Floats
    ) -> None:
        """Constraints, reactions ``lam`` and friction; ``mode`` (n_c, n_t), ``sign`` (d, n_t).

        ``pressing``: reactions that its load is of, which may be those of another joint.
        """
        motions = [moment.form(form) for form in self.forms] + [motion_of(drive, moment) for drive in self.drives]
        arguments = [m.position for m in motions] + [m.rate for m in motions] + [*pressing, *self.numbers]
        values = iter(self.function(arguments))
        m, n = len(lam), self.count
        phi = [next(values) for _ in range(m)]
        gradient = [[next(values) for _ in range(n)] for _ in range(m)]
        for value, slopes, push in zip(phi, gradient, lam, strict=True):
            row, rate, drift = combined(motions, slopes, next(values))
            found.held.append(Held(value=value, rate=rate, drift=drift, row=row))
            found.push(row, push)
        if self.friction is not None:
            self._rub(moment, found, motions, list(values), mode, sign)

    def _rub(
        self, moment: Moment, found: Found, motions: list[Motion], values: list[Dual], mode: Any, sign: Floats
    ) -> None:
        n, k = self.count, self.number
        assert self.friction is not None
        assert k is not None
        slips = [values[i * n : (i + 1) * n] for i in range(self.slips)]
        made = [combined(motions, slip, values[self.slips * n + i]) for i, slip in enumerate(slips)]
        found.rows[k] = [row for row, _, _ in made]
        found.g[k], found.drift[k] = moment.slipping(k, [g for _, g, _ in made]), [drift for _, _, drift in made]
        found.N[k] = values[-1]
        codes: Codes = mode[k]
        self.friction.rub(moment, found, masked(values[-1], np.asarray(values[-1].value) > 0.0), codes, sign)


def combined(motions: list[Motion], slopes: Sequence[Dual], turned: Dual) -> tuple[Row, Dual, Dual]:
    """Of ``slopes . x'`` its row, value, and rate without accelerations; ``turned``: of that what slopes bring."""
    pairs = [(m, c) for m, c in zip(motions, slopes, strict=True) if c.slopes or np.any(c.value)]
    row = [(i, c.times(k) if isinstance(k, Dual) else c * k) for m, c in pairs for i, k in m.row]
    rate = summed(m.rate.times(c) for m, c in pairs)
    return row, rate, turned + summed(m.drift.times(c) for m, c in pairs)


def driven(joint: Joint, drive: tuple[Any, ...], seeds: Seeds) -> tuple[Given, Given, Given]:
    """A prescribed function of time of a joint, with its two derivatives."""
    kind, value, start = drive
    # the number that is prescribed is known by the name of its slot, of those that may hold functions of time
    (slot,) = (path for path, held in joint.slots().items() if held is value and joint._takes_expression(path))
    orders: list[Given] = [Given(value, f"{joint.name}.{slot}", seeds, order=k) for k in range(3)]
    if kind != "rate":
        offset = Given(start, "", seeds)
        return _Shifted(orders[0], offset), orders[1], orders[2]
    if orders[0].number is None:
        refuse(joint, "a joint that is driven at a rate which varies")
    return _Ramp(orders[0], start), orders[0], orders[1]


class _Shifted(Given):
    """A given function of time with a constant added."""

    def __init__(self, given: Given, offset: Given) -> None:
        self.given, self.offset = given, offset
        self.number = None
        self.held = given.held

    def over(self, time: Dual) -> Dual:
        """Values with their slopes."""
        return self.given.over(time) + self.offset.over(time)


class _Ramp(Given):
    """The integral of a constant rate."""

    def __init__(self, given: Given, start: float) -> None:
        self.given, self.start = given, start
        self.number = None
        self.held = [given.number] if given.number is not None else []

    def over(self, time: Dual) -> Dual:
        """Values with their slopes."""
        return self.given.over(time).times(time) + Dual(value=self.start)


def motion_of(drive: tuple[Given, Given, Given], moment: Moment) -> Motion:
    position, rate, drift = (given.over(moment.time) for given in drive)
    return Motion(position=position, rate=rate, drift=drift, row=[])


def columns_of(given: Given) -> set[int]:
    held = given.held if given.number is None else [given.number]
    return {j for one in held for j in one.slopes}
