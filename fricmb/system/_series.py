"""Measured series in a scene: where runs stop for them, and how far they are known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.equations import Template, formula
from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.integrate.signals.pieces import Table, table_at
from fricmb.values import is_expression

#: A run may be longer than a series by this part of its times: round-off.
BEYOND = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class SeriesUse:
    """A series at the time ``slope t + shift``; derivatives up to ``order`` act.  ``owner``: where it stands."""

    table: Table
    slope: float
    shift: float
    order: int
    owner: str

    def stops(self, t_start: float, t_end: float) -> tuple[Floats, Floats]:
        """Times in a run at which what acts jumps, and at which it bends."""
        hard, soft = self.table.breaks(self.order)
        return self._between(hard, t_start, t_end), self._between(soft, t_start, t_end)

    def _between(self, edge: Floats, t_start: float, t_end: float) -> Floats:
        t = (edge - self.shift) / self.slope
        return np.sort(t[(t >= t_start) & (t <= t_end)])

    def check(self, t_start: float, t_end: float) -> None:
        """Refuse a run that leaves the series."""
        ends = sorted((end - self.shift) / self.slope for end in self.table.domain)
        margin = BEYOND * max(abs(t_start), abs(t_end), *(abs(end) for end in ends if math.isfinite(end)), 0.0)
        if t_start < ends[0] - margin or t_end > ends[1] + margin:
            raise SceneError(
                f"{self.owner} is known from t = {ends[0]:.10g} to {ends[1]:.10g}, the run goes from {t_start:.10g} to"
                f' {t_end:.10g}; accepted is a run inside, or fm.Signal(..., outside="hold") or "zero"'
            )


def stops_of(series: Sequence[SeriesUse], t_start: float, t_end: float) -> tuple[Floats, Floats]:
    """Breakpoints and kinks of series in a run, rising; SceneError where one does not reach over it."""
    hard, soft = [np.zeros(0)], [np.zeros(0)]
    for one in series:
        one.check(t_start, t_end)
        jumps, kinks = one.stops(t_start, t_end)
        hard.append(jumps)
        soft.append(kinks)
    stops = np.unique(np.concatenate(hard))
    return stops, np.setdiff1d(np.concatenate(soft), stops)


def series_of(timed: Sequence[tuple[Template, tuple[float, ...]]], scene: Any) -> tuple[SeriesUse, ...]:
    """Every series in templates with their parameters."""
    found: list[SeriesUse] = []
    owners: dict[str, str] | None = None
    for template, parameters in timed:
        for fact in template.facts.get("series", ()):
            table = table_at(parameters[fact["table"]])
            owners = _owners(scene) if owners is None else owners
            slope, shift = (float(formula(text)(parameters)) for text in fact["at"])
            owner = owners.get(table.digest, "a series")
            found.append(SeriesUse(table=table, slope=slope, shift=shift, order=fact["order"], owner=owner))
    return tuple(found)


def _owners(scene: Any) -> dict[str, str]:
    """Where each series stands, by the digest of its table."""
    from fricmb.signal._symbols import TableSymbol

    found: dict[str, str] = {}
    for part in scene.parts:
        for path, value in part.slots().items():
            for entry in value if isinstance(value, tuple) else (value,):
                if is_expression(entry):
                    held = (s for s in entry.free_symbols if isinstance(s, TableSymbol))
                    found |= {s.table.digest: f"{part._label()}: {path} = {entry}" for s in held}
    return found
