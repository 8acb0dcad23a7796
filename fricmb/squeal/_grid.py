"""Stability of steady sliding at the places of a study: computed, followed, and its thresholds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb._sweep._store import Store
from fricmb._sweep._sweep import fill
from fricmb._version import installed_version
from fricmb.analysis import AnalysisError, StabilityMap, complex_eigenvalues
from fricmb.analysis._eigenvalues import Eigenvalues
from fricmb.errors import FricmbError, shown, unknown_name
from fricmb.integrate.run.ending_signals import as_interrupts
from fricmb.integrate.run.one_thread import one_thread
from fricmb.scene import Scene, parameter_unit
from fricmb.squeal._place import Complexes, Floats, Place, Places
from fricmb.squeal._thresholds import Threshold, thresholds
from fricmb.squeal._tracking import Tracking

WHO = "squeal.study"


@dataclass(kw_only=True, eq=False, repr=False)
class Grid:
    """Places over one or two parameters, with the eigenvalues of steady sliding at each."""

    places: Places
    over: tuple[str, ...]
    values: tuple[Floats, ...]
    workers: Any = 1
    store: str | PathLike[str] | None = None
    progress: bool = True
    _grid: list[list[Place]] = field(default_factory=list)

    def _make(self) -> None:
        asked = [self._at(i, j) for i in range(self.shape[0]) for j in range(self.shape[1])]
        found = [Place(**result) for result in self._filled(self.places, asked)]
        if not any(place.eigenvalues.size or not place.why for place in found):
            raise AnalysisError(found[0].why)
        n = self.shape[1]
        self._grid = [found[i * n : (i + 1) * n] for i in range(self.shape[0])]

    def _filled(self, job: Any, asked: list[dict[str, float]], workers: Any = None) -> list[Any]:
        """What a job gives at many places; an error of any of them is raised."""
        kept = None if self.store is None else Store(self.store, (installed_version(), "squeal", job))
        results: list[Any] = [None] * len(asked)
        try:
            with as_interrupts():
                fill(job, asked, results, kept, self.progress, self.workers if workers is None else workers, None)
        finally:
            if kept is not None:
                kept.close()
        for result in results:
            if isinstance(result, FricmbError):
                raise result
        return results

    @property
    def scene(self) -> Scene:
        """The scene of the study."""
        return self.places.scene

    @property
    def shape(self) -> tuple[int, int]:
        """Number of values of each parameter, 1 in place of a second one."""
        return len(self.values[0]), len(self.values[1]) if len(self.values) > 1 else 1

    def _at(self, i: int, j: int) -> dict[str, float]:
        found = {self.over[0]: float(self.values[0][i])}
        return found | ({self.over[1]: float(self.values[1][j])} if len(self.over) > 1 else {})

    def _each(self, of: Any, dtype: type = float) -> NDArray[Any]:
        """A number of each place (n_a, n_b)."""
        return np.array([[of(place) for place in row] for row in self._grid], dtype=dtype)

    @property
    def map(self) -> StabilityMap:
        """Largest growth rate at each place, nan where there is no steady sliding.

        Over one parameter the second has the one value 0.
        """
        growth = self._each(lambda p: p.eigenvalues[p.worst].real if p.eigenvalues.size else np.nan)
        frequency = self._each(lambda p: p.eigenvalues[p.worst].imag if p.eigenvalues.size else np.nan)
        second = (self.over[1], self.values[1]) if len(self.over) > 1 else ("", np.zeros(1))
        units = tuple(parameter_unit(self.scene, name) for name in self.over)
        return StabilityMap(
            over=(self.over[0], second[0]), values=(self.values[0], second[1]), growth=growth, frequency=frequency,
            unstable=self._each(lambda p: int(p.grows.sum()), int), units=self.scene.units,
            over_units=(units[0], units[1] if len(units) > 1 else ""),
        )  # fmt: skip

    @property
    def failed(self) -> dict[tuple[float, ...], str]:
        """Places without steady sliding, by the values of the parameters, and why there is none."""
        return {
            tuple(self._at(i, j).values()): place.why
            for i, row in enumerate(self._grid)
            for j, place in enumerate(row)
            if place.why
        }

    @cached_property
    def _tracking(self) -> Tracking:
        def between(a: tuple[int, int], b: tuple[int, int], share: float) -> Place:
            low, high = self._at(*a), self._at(*b)
            result = self.places.run({name: (1.0 - share) * low[name] + share * high[name] for name in low})
            if isinstance(result, FricmbError):
                raise result
            return Place(**result)

        return Tracking(self._grid, between)

    @cached_property
    def eigenvalues(self) -> Complexes:
        """Eigenvalues of each mode (n_a, n_b, n_modes), nan where a mode is not there.

        Modes are followed along the first parameter and from there along the second; round a place where two modes are
        one, they may have changed names.
        """
        return np.asarray(self._tracking.table(lambda place: place.eigenvalues, complex))

    @cached_property
    def shapes(self) -> Complexes:
        """Their shapes (n_a, n_b, n_modes, n_dof), unit length; order of ``dofs``."""
        return np.asarray(self._tracking.table(lambda place: place.shapes, complex))

    @property
    def dofs(self) -> tuple[str, ...]:
        """Free degrees of freedom."""
        return tuple(next(place.dofs for row in self._grid for place in row if not place.why))

    def steady(self, contact: str) -> dict[str, Floats]:
        """Normal force, speed of slip and friction of a contact at each place: "normal", "slip", "friction" (n_a, n_b).

        Raises
        ------
        UnknownNameError
        """
        names = self._contacts()
        if contact not in names:
            raise unknown_name("contact", contact, names)
        k = names.index(contact)
        parts = ("normal", "slip", "friction")
        return {part: self._each(lambda p, part=part: np.nan if p.why else getattr(p, part)[k]) for part in parts}

    def _contacts(self) -> tuple[str, ...]:
        i, j = np.argwhere(~self._each(lambda p: bool(p.why), bool))[0]
        return tuple(self.places.steady(self._at(int(i), int(j))).system.contact_names)

    @cached_property
    def thresholds(self) -> tuple[Threshold, ...]:
        """Critical values of the first parameter for each value of the second, to round-off.

        Growing modes are counted at the values of the study: an island between two of them is not seen.
        """
        found: list[Threshold] = []
        for j in range(self.shape[1]):
            others = {name: value for name, value in self._at(0, j).items() if name != self.over[0]}
            column = [row[j] for row in self._grid]
            with one_thread():
                found += thresholds(self.places, self.over[0], self.values[0], others, column, len(self.dofs) == 1)
        return tuple(found)

    @property
    def worst(self) -> dict[str, float]:
        """The place where a mode grows most."""
        i, j = np.unravel_index(int(np.nanargmax(self.map.growth)), self.shape)
        return self._at(int(i), int(j))

    def line(self, over: str | None = None, at: Mapping[str, float] | None = None) -> Eigenvalues:
        """Eigenvalues along one of the parameters, those between its values as well: for curves.

        Parameters
        ----------
        over : str, optional
            Default: the first parameter.
        at : dict of str to float, optional
            Value of the other one.
        """
        name = self.over[0] if over is None else over
        if name not in self.over:
            raise unknown_name("parameter of the study", name, self.over)
        fixed = {key: value for key, value in self._checked_at(at).items() if key != name}
        scene = self.scene.with_parameters({k: v for k, v in fixed.items() if k not in self.places.speeds})
        found: Eigenvalues = complex_eigenvalues(
            scene, over=name, values=self.values[self.over.index(name)],
            speeds={**self.places.speeds, **{k: v for k, v in fixed.items() if k in self.places.speeds}} or None,
            highest=None if np.isinf(self.places.highest) else self.places.highest,
        )  # fmt: skip
        return found

    def _checked_at(self, at: Mapping[str, float] | None) -> dict[str, float]:
        if at is None:
            return self.worst
        if isinstance(at, Threshold):
            return dict(at.at)
        if not isinstance(at, Mapping):
            raise AnalysisError(f"{WHO}: at must be a dict of names and values, or a threshold; got {shown(at)}")
        for name in at:
            if name not in self.scene.parameters and name not in self.places.speeds:
                raise unknown_name("parameter in at", name, [*self.scene.parameters, *self.places.speeds])
        return {**self.worst, **{name: float(value) for name, value in at.items()}}
