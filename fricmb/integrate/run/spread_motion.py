"""Motion of a few degrees of freedom among many that rest, laid out for all of them when it is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats, Ints
from fricmb.integrate.trajectory import MotionSamples


class SpreadMotion(MotionSamples):
    """Samples whose ``q`` and ``v`` are made when they are first read.

    Of a scene most of which rests, these arrays are larger than all that was computed, and who looks at one motion at
    other times, at events or energies, does not need them.
    """

    _resting: Floats
    _moving: tuple[tuple[Ints, MotionSamples], ...]

    @classmethod
    def of(cls, resting: Floats, moving: Sequence[tuple[Ints, MotionSamples]], **others: Any) -> SpreadMotion:
        """Of positions (n,) of what rests, samples with the degrees of freedom they are of, and the other arrays."""
        made = cls.__new__(cls)
        vars(made).update(others, _resting=resting, _moving=tuple(moving))
        return made

    def __getattr__(self, name: str) -> Floats:
        """Lay out ``q`` or ``v``."""
        if name not in ("q", "v") or "_moving" not in vars(self):
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        found = constant(self._resting if name == "q" else np.zeros_like(self._resting), self.t.size)
        for dofs, part in self._moving:
            found[dofs] = getattr(part, name)
        vars(self)[name] = found
        return found

    def numbers(self, moving: Ints | None) -> list[Any]:
        """Without what rests, and without laying out anything."""
        if "_moving" not in vars(self):  # a part of the times of another, made of plain arrays
            return super().numbers(moving)
        own = [getattr(self, f.name) for f in fields(MotionSamples) if f.name not in ("q", "v", "mode")]
        return [*own, self._resting, *(x for _, part in self._moving for x in (part.q, part.v))]

    def __reduce__(self) -> Any:
        """As plain samples."""
        return _plain, tuple(getattr(self, f.name) for f in fields(MotionSamples))


def _plain(*values: Any) -> MotionSamples:
    return MotionSamples(**{f.name: value for f, value in zip(fields(MotionSamples), values, strict=True)})


def constant(values: Floats, n_t: int) -> Floats:
    """Rows (n, n_t) of constant values; memory of zeros is not touched."""
    rows: Floats = np.zeros((values.size, n_t))
    there = np.flatnonzero(values)
    rows[there] = values[there, None]
    return rows
