"""The squeal study of a scene: one object that is asked, and that writes down what it was asked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricmb._calls import answers
from fricmb._simulate import simulate
from fricmb._simulate._arguments import check_options
from fricmb._sweep._store import Store
from fricmb._sweep._sweep import fill
from fricmb._version import installed_version
from fricmb.analysis import AnalysisError, StabilityMap, SteadySliding, complex_eigenvalues
from fricmb.analysis._eigenvalues import Eigenvalues
from fricmb.analysis._errors import checked_integer, checked_scene, positive
from fricmb.analysis._steady import checked_speeds
from fricmb.analysis._track import checked_values
from fricmb.analysis.cycles._flow import initial_slots
from fricmb.errors import FricmbError, shown, unknown_name
from fricmb.integrate.run.ending_signals import as_interrupts
from fricmb.integrate.run.one_thread import one_thread
from fricmb.scene import Element, ModalBody, parameter_unit
from fricmb.squeal import _uncertain
from fricmb.squeal._derivatives import Derivatives, derivatives
from fricmb.squeal._feed import Feed, feed
from fricmb.squeal._growth import Growth, growth
from fricmb.squeal._place import Complexes, Floats, Place, Places
from fricmb.squeal._saturation import Amplitudes, Saturation, saturation
from fricmb.squeal._thresholds import Threshold, thresholds
from fricmb.squeal._tracking import Tracking
from fricmb.squeal._uncertain import Uncertainty
from fricmb.values import value_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fricmb.scene import Scene

_WHO = "squeal.study"
_Answer = TypeVar("_Answer")
#: Options of simulate that a study sets itself.
_OWN = ("t_end", "t_start", "initial", "parameters", "t_eval", "observe", "sensitivities")


@answers
def study(
    scene: Scene,
    *,
    over: Mapping[str, ArrayLike],
    speeds: Mapping[str, float] | None = None,
    highest: float | None = None,
    workers: Any = 1,
    store: str | PathLike[str] | None = None,
    progress: bool = True,
) -> Study:
    """Stability of steady sliding over one or two parameters, and what there is to ask about it.

    Parameters
    ----------
    scene : Scene
    over : dict of str to array_like
        One or two names out of ``scene.parameters`` or ``speeds``, each with its values, rising or falling.
    speeds : dict of str to float, optional
        As in :func:`fricmb.analysis.steady_sliding`.
    highest : float, optional
        Angular frequency above which modes are left out.  Default: that of the highest mode of a body that has
        residual coordinates beside its modes, which stand for flexibility and have no eigenvalues of their own.
    workers : int, "threads", Executor or dask.distributed.Client, optional
        As in :func:`fricmb.sweep`; default: this process.
    store : path, optional
        A folder that keeps what was computed, as in :func:`fricmb.sweep`: the same study goes on where it stopped.
    progress : bool
        Show a bar on the terminal.

    Returns
    -------
    Study

    Raises
    ------
    AnalysisError
        If there is no steady sliding at any place, nothing that could slide, or an argument cannot be.
    UnknownNameError
        For a parameter that is not there.

    Examples
    --------
    >>> import fricmb as fm
    >>> study = fm.squeal.study(
    ...     fm.models.minimal_flutter(), over={"sole.law.mu_s": [0.0, 0.4, 0.8]}, progress=False
    ... )
    >>> round(study.thresholds[0].value, 12)
    0.75
    """
    checked_scene(_WHO, scene)
    _check_friction(scene)
    held = dict(checked_speeds(speeds))
    if not isinstance(over, Mapping) or not 1 <= len(over) <= 2:
        accepted = "a dict of one or two names of parameters, each with its values"
        raise AnalysisError(f"{_WHO}: over must be {accepted}; got {shown(over)}")
    for name in over:
        if name not in scene.parameters and name not in held:
            raise unknown_name("parameter in over", name, [*scene.parameters, *held])
    values = tuple(checked_values(_WHO, given) for given in over.values())
    top = _true_modes(scene) if highest is None else positive(_WHO, "highest", highest)
    places = Places(scene=scene, speeds=held, highest=top)
    made = Study(places=places, over=tuple(over), values=values, workers=workers, store=store, progress=progress)
    made._make()
    return made


def _check_friction(scene: Scene) -> None:
    """Refuse a scene without friction: parts, or matrices and forces that may stand for it (of FE, of a user)."""
    forces = (part for part in scene.parts if isinstance(part, Element))
    if scene.frictional or scene.matrices or any(type(f).define_force is not Element.define_force for f in forces):
        return
    raise AnalysisError(
        f"{_WHO}: nothing slides in scene {scene.name!r}: it has no contact, no joint with friction, and no matrix or"
        " force that may stand for one"
    )


def _true_modes(scene: Scene) -> float:
    """Angular frequency up to which modes of reduced bodies are modes."""
    found = [
        float(np.max(value_of(body.frequencies)[: body.n_modes - body.residual]))
        for body in scene.parts
        if isinstance(body, ModalBody) and 0 < body.residual < body.n_modes
    ]
    return min(found, default=np.inf)


@dataclass(kw_only=True, eq=False, repr=False)
class Study:
    """Stability of steady sliding over one or two parameters; made by :func:`study`.

    Where ``at`` is asked for, it is a dict of values of parameters, which need not be places of the map; default: the
    place where a mode grows most.  What was asked stands in the report.

    Attributes
    ----------
    over : tuple of str
        The parameters.
    values : tuple of (n_a,), (n_b,)
        Their values; one alone where there is one parameter.
    answered : list
        Answers that were given, in their order.
    """

    places: Places
    over: tuple[str, ...]
    values: tuple[Floats, ...]
    workers: Any = 1
    store: str | PathLike[str] | None = None
    progress: bool = True
    answered: list[Any] = field(default_factory=list)
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
        """Number of values of each parameter, 1 for one that there is not."""
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
            raise AnalysisError(f"{_WHO}: at must be a dict of names and values, or a threshold; got {shown(at)}")
        for name in at:
            if name not in self.scene.parameters and name not in self.places.speeds:
                raise unknown_name("parameter in at", name, [*self.scene.parameters, *self.places.speeds])
        return {**self.worst, **{name: float(value) for name, value in at.items()}}

    def _mode(self, at: Mapping[str, float], frequency: float | None) -> tuple[complex, Complexes]:
        """The eigenvalue and shape of the mode that grows most, or of the one next to an angular frequency."""
        result = self.places.run(at)
        if isinstance(result, FricmbError):
            raise result
        place = Place(**result)
        if place.why:
            raise AnalysisError(place.why)
        oscillates = np.flatnonzero(place.eigenvalues.imag > 0.0)
        if not oscillates.size:
            raise AnalysisError(f"{_WHO}: no mode oscillates at {dict(at)}")
        values = place.eigenvalues[oscillates]
        chosen = np.argmax(values.real) if frequency is None else np.argmin(np.abs(values.imag - frequency))
        k = int(oscillates[int(chosen)])
        return complex(place.eigenvalues[k]), place.shapes[k]

    @answers
    def feed(self, at: Mapping[str, float] | None = None, *, frequency: float | None = None) -> Feed:
        """What each contact and other part, and each pair of modes, adds to the growth rate of a mode.

        Parameters
        ----------
        at : dict of str to float, optional
        frequency : float, optional
            Angular frequency next to which the mode lies; default: the mode that grows most.

        Raises
        ------
        AnalysisError
            For a scene with joints, whose masses move.
        """
        if self.scene.is_mechanism:
            raise AnalysisError("feed: the scene has joints; it takes scenes of springs, modes and contacts")
        here = self._checked_at(at)
        value, shape = self._mode(here, frequency)
        with one_thread():
            return self._kept(feed(self.places.steady(here), here, value, shape))

    @answers
    def derivatives(
        self,
        at: Mapping[str, float] | Threshold | None = None,
        *,
        names: Sequence[str] | None = None,
        frequency: float | None = None,
    ) -> Derivatives:
        """Derivatives of a mode's eigenvalue, of the distance of a pair, and of a threshold, by parameters.

        Parameters
        ----------
        at : dict of str to float or Threshold, optional
        names : sequence of str, optional
            Out of ``scene.parameters``; default: all that are one number other than 0 and no initial value.
        frequency : float, optional
            As in :meth:`feed`; of a threshold its own.

        Raises
        ------
        UnknownNameError
        """
        if self.scene.is_mechanism:
            raise AnalysisError("derivatives: the scene has joints; it takes scenes of springs, modes and contacts")
        here = self._checked_at(at)  # type: ignore[arg-type]
        known = self.scene.parameters
        if names is None:
            initial = initial_slots(self.scene)
            names = [n for n, v in known.items() if isinstance(v, float) and v != 0.0 and n not in initial]
        for name in names:
            if name not in known and name not in self.places.speeds:
                raise unknown_name("parameter in names", name, [*known, *self.places.speeds])
        critical = isinstance(at, Threshold)
        near = at.frequency if isinstance(at, Threshold) else frequency
        value, _ = self._mode(here, near)
        over = self.over[0] if critical else None
        with one_thread():
            return self._kept(derivatives(self.places, here, list(names), value, over))

    @answers
    def growth(
        self, at: Mapping[str, float] | None = None, *, frequency: float | None = None, **options: Any
    ) -> Growth:
        """Rate of growth in a run from steady sliding with a small push along a mode, beside the eigenvalue.

        Parameters
        ----------
        at, frequency
            As in :meth:`feed`.
        **options
            As :func:`fricmb.simulate`.
        """
        return self._kept(growth(*self._to_run(at, frequency, options), options))

    @answers
    def saturation(
        self, at: Mapping[str, float] | None = None, *, frequency: float | None = None, **options: Any
    ) -> Saturation:
        """The vibration that a growing mode ends in: its amplitude, and its limit cycle.

        Parameters
        ----------
        at, frequency
            As in :meth:`feed`.
        **options
            As :func:`fricmb.simulate`.
        """
        return self._kept(saturation(*self._to_run(at, frequency, options), True, options))

    def _to_run(
        self, at: Mapping[str, float] | None, frequency: float | None, options: dict[str, Any]
    ) -> tuple[SteadySliding, dict[str, float], complex]:
        """Steady sliding, its place and the mode that a run sets out along."""
        check_options(_WHO, options, simulate, *_OWN)
        if self.scene.is_mechanism:
            raise AnalysisError(f"{_WHO}: runs along a mode take no scenes with joints")
        here = self._checked_at(at)
        return self.places.steady(here), here, self._mode(here, frequency)[0]

    @answers
    def amplitudes(self, name: str, *, workers: Any = None, **options: Any) -> Floats:
        """Half the range (n_a, n_b) of a motion in the vibration that growth ends in, at each place.

        Parameters
        ----------
        name : str
            A degree of freedom.
        workers : optional
            As of the study.
        **options
            As :func:`fricmb.simulate`.

        Returns
        -------
        (n_a, n_b)
            0 where nothing grows (a vibration may be there all the same, if it is pushed enough), nan where there is
            no steady sliding.
        """
        check_options(_WHO, options, simulate, *_OWN)
        if name not in self.scene.dof_names:
            raise unknown_name("degree of freedom", name, self.scene.dof_names)
        asked = [self._at(i, j) for i in range(self.shape[0]) for j in range(self.shape[1])]
        job = Amplitudes(places=self.places, name=name, options=options)
        found = np.array(self._filled(job, asked, workers), dtype=float).reshape(self.shape)
        self.answered.append(("amplitudes", name, found))
        return found

    @answers
    def uncertainty(
        self,
        distributions: Mapping[str, Any],
        at: Mapping[str, float] | None = None,
        *,
        samples: int = 32,
        indices: bool = False,
        seed: int = 0,
        workers: Any = None,
    ) -> Uncertainty:
        """Probability of growth where parameters are not known for sure.

        Parameters
        ----------
        distributions : dict of str to distribution
            By parameter: ``(low, high)`` for an even one, a number for a normal one about the present value with that
            relative standard deviation, or a distribution of ``scipy.stats`` with its numbers.
        at : dict of str to float, optional
        samples : int
            Points of one scrambling of Sobol's sequence, a power of 2; there are eight scramblings.
        indices : bool
            Whether Sobol' indices are wanted: ``samples * (n + 2)`` further places.
        seed : int
            Of the scramblings.
        workers : optional
            As of the study.

        Raises
        ------
        UnknownNameError
        AnalysisError
        """
        here = self._checked_at(at)
        n = checked_integer("uncertainty", "samples", samples, 2, 1 << 20)
        start = checked_integer("uncertainty", "seed", seed, 0, 1 << 31)
        if n & (n - 1):
            raise AnalysisError(f"uncertainty: samples must be a power of 2; got {samples}")
        if not isinstance(distributions, Mapping) or not distributions:
            raise AnalysisError(f"uncertainty: distributions must be a dict by parameter; got {shown(distributions)}")
        known = self.scene.parameters
        for name in distributions:
            if name not in known and name not in self.places.speeds:
                raise unknown_name("parameter in distributions", name, [*known, *self.places.speeds])
        now: dict[str, Any] = {**self.places.speeds, **known, **here}
        drawn = [_uncertain.distribution(name, given, float(now[name])) for name, given in distributions.items()]

        def worst(points: Floats) -> tuple[Floats, Floats]:
            asked = [here | dict(zip(distributions, point, strict=True)) for point in points.tolist()]
            found = [Place(**result) for result in self._filled(self.places, asked, workers)]
            chosen = [p.eigenvalues[p.worst] if p.eigenvalues.size else complex(np.nan, np.nan) for p in found]
            grows = [bool(p.grows.any()) for p in found]
            values = np.array(chosen)
            # what is round-off of no growth is none
            return np.where(grows, values.real, np.minimum(values.real, 0.0)), values.imag

        points = _uncertain.draw(drawn, n, start)
        rates, frequency = worst(points)
        first = total = None
        if indices:
            first, total = _uncertain.sobol_indices(drawn, n, start, lambda p: worst(p)[0])
        return self._kept(
            Uncertainty(
                at=here, names=tuple(distributions), values=points, growth=rates, frequency=frequency, first=first,
                total=total,
            )
        )  # fmt: skip

    def _kept(self, answer: _Answer) -> _Answer:
        self.answered.append(answer)
        return answer

    def tables(self) -> dict[str, tuple[tuple[str, ...], list[tuple[Any, ...]]]]:
        """Names of columns, and rows, of each table by its name."""
        from fricmb.squeal._tables import tables

        return tables(self)

    def plot(self, *, ax: Any = None) -> Figure:
        """The map of stability over two parameters, or eigenvalues over one."""
        from fricmb.squeal._pictures import overview

        return overview(self, ax)

    def report(self, path: str | PathLike[str]) -> Path:
        """Write a page that a browser opens without a network: the map, thresholds, and all that was asked."""
        from fricmb.squeal._report import write_report

        return write_report(self, Path(path))

    def write(self, folder: str | PathLike[str]) -> tuple[Path, ...]:
        """Write ``report.html`` and a CSV of each table into a folder."""
        from fricmb.squeal._tables import write_tables

        where = Path(folder)
        where.mkdir(parents=True, exist_ok=True)
        return (self.report(where / "report.html"), *write_tables(self, where))

    def __repr__(self) -> str:
        over = " and ".join(f"{name} ({len(values)})" for name, values in zip(self.over, self.values, strict=True))
        return f"<squeal study of {self.scene.name!r} over {over}>"

    def __str__(self) -> str:
        found = self.map
        count = int((found.unstable > 0).sum())
        lines = [f"{self.scene.name}: {count} of {found.growth.size} places unstable"]
        if self.failed:
            lines.append(f"  no steady sliding at {len(self.failed)} places: {next(iter(self.failed.values()))}")
        worst = np.nanmax(found.growth)
        here = ", ".join(f"{name} = {value:g}" for name, value in self.worst.items())
        lines.append(f"  largest growth rate {worst:.6g} at {here}")
        for t in self.thresholds:
            side = "above" if t.unstable_above else "below"
            rest = "".join(f", {name} = {value:g}" for name, value in t.at.items() if name != t.over)
            lines.append(f"  {t.kind} {side} {t.over} = {t.value:.10g}{rest}, angular frequency {t.frequency:.6g}")
        return "\n".join(lines)
