"""The squeal study of a scene: one object that is asked, and that writes down what it was asked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from fricmb._calls import answers
from fricmb._simulate import simulate
from fricmb._simulate._arguments import check_options
from fricmb.analysis import AnalysisError, SteadySliding
from fricmb.analysis._errors import checked_integer, checked_scene, positive
from fricmb.analysis._steady import checked_speeds
from fricmb.analysis._track import checked_values
from fricmb.analysis.cycles._flow import initial_slots
from fricmb.errors import FricmbError, shown, unknown_name
from fricmb.integrate.run.one_thread import one_thread
from fricmb.squeal import _uncertain
from fricmb.squeal._derivatives import Derivatives, derivatives
from fricmb.squeal._feed import Feed, feed
from fricmb.squeal._grid import WHO, Grid
from fricmb.squeal._growth import Growth, growth
from fricmb.squeal._place import Complexes, Floats, Place, Places, check_friction, true_modes
from fricmb.squeal._saturation import Amplitudes, Saturation, saturation
from fricmb.squeal._screening import Screening, screening
from fricmb.squeal._thresholds import Threshold
from fricmb.squeal._uncertain import Uncertainty

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fricmb.scene import Scene

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
    """Study the stability of steady sliding over one or two parameters.

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
        If there is no steady sliding at any place, nothing that could slide, or an argument that is not accepted.
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
    checked_scene(WHO, scene)
    check_friction(WHO, scene)
    held = dict(checked_speeds(speeds))
    if not isinstance(over, Mapping) or not 1 <= len(over) <= 2:
        accepted = "a dict of one or two names of parameters, each with its values"
        raise AnalysisError(f"{WHO}: over must be {accepted}; got {shown(over)}")
    for name in over:
        if name not in scene.parameters and name not in held:
            raise unknown_name("parameter in over", name, [*scene.parameters, *held])
    values = tuple(checked_values(WHO, given) for given in over.values())
    top = true_modes(scene) if highest is None else positive(WHO, "highest", highest)
    places = Places(scene=scene, speeds=held, highest=top)
    made = Study(places=places, over=tuple(over), values=values, workers=workers, store=store, progress=progress)
    made._make()
    return made


@dataclass(kw_only=True, eq=False, repr=False)
class Study(Grid):
    """Stability of steady sliding over one or two parameters; made by :func:`study`.

    An argument ``at`` is a dict of parameter values, which need not be places of the map; default: the place where a
    mode grows most.  Every answer stands in the report.

    Attributes
    ----------
    over : tuple of str
        The parameters.
    values : tuple of (n_a,), (n_b,)
        Their values; one alone where there is one parameter.
    answered : list
        Answers that were given, in their order.
    """

    answered: list[Any] = field(default_factory=list)

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
            raise AnalysisError(f"{WHO}: no mode oscillates at {dict(at)}")
        values = place.eigenvalues[oscillates]
        chosen = np.argmax(values.real) if frequency is None else np.argmin(np.abs(values.imag - frequency))
        k = int(oscillates[int(chosen)])
        return complex(place.eigenvalues[k]), place.shapes[k]

    @answers
    def feed(self, at: Mapping[str, float] | None = None, *, frequency: float | None = None) -> Feed:
        """Contribution of each contact, other part, and pair of modes to the growth rate of a mode.

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
        check_options(WHO, options, simulate, *_OWN)
        if self.scene.is_mechanism:
            raise AnalysisError(f"{WHO}: runs along a mode take no scenes with joints")
        here = self._checked_at(at)
        return self.places.steady(here), here, self._mode(here, frequency)[0]

    @answers
    def amplitudes(self, name: str, *, workers: Any = None, **options: Any) -> Floats:
        """Amplitude (n_a, n_b) of a motion at each place: half its range in the vibration that growth ends in.

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
        check_options(WHO, options, simulate, *_OWN)
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
        """Probability that steady sliding is unstable when parameters are uncertain.

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
        drawn = self._distributions("uncertainty", distributions, here)

        def worst(points: Floats) -> tuple[Floats, Floats]:
            return self._worst_of(here, tuple(distributions), points, workers)

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

    @answers
    def screening(
        self,
        distributions: Mapping[str, Any],
        at: Mapping[str, float] | None = None,
        *,
        trajectories: int = 10,
        seed: int = 0,
        workers: Any = None,
    ) -> Screening:
        """Rank parameters by their influence: elementary effects after Morris, by SALib (extra ``salib``).

        It costs ``trajectories * (n + 1)`` places, where Sobol' indices cost hundreds for each parameter.

        Parameters
        ----------
        distributions, at, seed, workers
            As in :meth:`uncertainty`.
        trajectories : int
            Walks through the distributions, each of which changes every parameter once.

        Raises
        ------
        UnknownNameError
        MissingExtraError
            Without SALib.
        """
        here = self._checked_at(at)
        walks = checked_integer("screening", "trajectories", trajectories, 2, 1 << 16)
        start = checked_integer("screening", "seed", seed, 0, 1 << 31)
        drawn = dict(zip(distributions, self._distributions("screening", distributions, here), strict=True))
        found = screening(drawn, here, walks, start, lambda p: self._worst_of(here, tuple(drawn), p, workers)[0])
        return self._kept(found)

    def _distributions(self, who: str, given: Mapping[str, Any], here: Mapping[str, float]) -> list[Any]:
        """A distribution of scipy for each parameter."""
        if not isinstance(given, Mapping) or not given:
            raise AnalysisError(f"{who}: distributions must be a dict by parameter; got {shown(given)}")
        known = self.scene.parameters
        for name in given:
            if name not in known and name not in self.places.speeds:
                raise unknown_name("parameter in distributions", name, [*known, *self.places.speeds])
        now: dict[str, Any] = {**self.places.speeds, **known, **here}
        return [_uncertain.distribution(who, name, held, float(now[name])) for name, held in given.items()]

    def _worst_of(
        self, here: Mapping[str, float], names: tuple[str, ...], points: Floats, workers: Any
    ) -> tuple[Floats, Floats]:
        """Largest growth rate at each point (n, n_names), and the angular frequency of that mode."""
        asked = [{**here, **dict(zip(names, point, strict=True))} for point in points.tolist()]
        found = [Place(**result) for result in self._filled(self.places, asked, workers)]
        values = np.array([p.eigenvalues[p.worst] if p.eigenvalues.size else complex(np.nan, np.nan) for p in found])
        grows = [bool(p.grows.any()) for p in found]
        # what is round-off of no growth is none
        return np.where(grows, values.real, np.minimum(values.real, 0.0)), values.imag

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
        """Write a page that a browser opens without a network: the map, the thresholds, and every answer so far."""
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
