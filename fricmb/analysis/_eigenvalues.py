"""Stability of steady sliding over parameters: complex eigenvalues, critical values, maps."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricmb._calls import answers
from fricmb.analysis._crossings import Crossing, crossings
from fricmb.analysis._errors import AnalysisError, Floats, checked_kind, checked_scene, positive
from fricmb.analysis._steady import SteadySliding, checked_speeds, steady_sliding
from fricmb.analysis._track import NEUTRAL, Complexes, Pairs, checked_values, follow, refine
from fricmb.errors import shown
from fricmb.integrate.run.one_thread import one_thread
from fricmb.scene import parameter_unit
from fricmb.values import DIMENSIONS, Units

if TYPE_CHECKING:
    from fricmb.scene import Scene

#: Growth beside an oscillation's own frequency, and beside the highest, that is round-off.
_NEITHER, _LAST_DIGITS = 1e-9, 1e-13


def growing(found: Complexes) -> NDArray[np.bool_]:
    """Which eigenvalues grow by more than round-off of what does neither.

    That of an oscillation is some digits of its own frequency and of the highest; where two eigenvalues are 0, as those
    of a free motion, it is the root of that.
    """
    size = np.nan_to_num(np.abs(found))
    most = size.max(initial=0.0)
    limit: Floats = np.where(found.imag != 0.0, np.maximum(_NEITHER * size, _LAST_DIGITS * most), NEUTRAL * most)
    return np.asarray(found.real > limit)


@dataclass(frozen=True, kw_only=True)
class Eigenvalues:
    """Eigenvalues of steady sliding over one parameter, each mode followed by continuity.

    Attributes
    ----------
    over : str
    values : (n_values,)
    eigenvalues : (n_values, n_modes) complex
        Growth rates and angular frequencies.  Oscillations stand once, with the positive frequency they have at the
        first value; motions without oscillation one by one.
    shapes : (n_values, n_modes, n_dof) complex
        Displacements, largest component 1; order of ``dofs``.
    dofs : tuple of str
        Free degrees of freedom.
    critical : tuple of Crossing
        Where modes become unstable or stable again, in rising order of the parameter.
    fine_values : (n_fine,)
        ``values`` with the intermediate ones at which modes were computed, in the same direction: for curves.
    fine_eigenvalues : (n_fine, n_modes) complex
        The same modes there.
    units : Units
        Of the scene.
    over_unit : str
        Unit of the parameter, "" where it has none or it is not known.
    """

    over: str
    values: Floats
    eigenvalues: Complexes
    shapes: Complexes
    dofs: tuple[str, ...]
    critical: tuple[Crossing, ...]
    fine_values: Floats
    fine_eigenvalues: Complexes
    units: Units = DIMENSIONS
    over_unit: str = ""

    @property
    def growth(self) -> Floats:
        """Growth rates (n_values, n_modes)."""
        return self.eigenvalues.real

    @property
    def frequency(self) -> Floats:
        """Angular frequencies (n_values, n_modes)."""
        return np.abs(self.eigenvalues.imag)

    def _grows(self) -> NDArray[np.bool_]:
        """Whether a mode grows at each value (n_values,)."""
        return np.asarray(growing(self.eigenvalues).any(axis=1))

    def _table(self) -> str:
        """Modes at one value."""
        lines = [f"{'mode':>4} {'angular frequency':>18} {'growth rate':>14}  moves most"]
        for i, value in enumerate(self.eigenvalues[0]):
            most = self.dofs[int(np.argmax(np.abs(self.shapes[0, i])))]
            lines.append(f"{i:4d} {abs(value.imag):18.8g} {value.real:14.6g}  {most}")
        return "\n".join(lines)

    def __str__(self) -> str:
        if self.values.size == 1:
            return self._table()
        lines = [f"{self.eigenvalues.shape[1]} modes over {self.over} = {self.values[0]:g} to {self.values[-1]:g}"]
        for c in self.critical:
            side = "above" if c.unstable_above else "below"
            lines.append(f"  {c.kind} {side} {self.over} = {c.value:.12g}, angular frequency {c.frequency:.6g}")
        if not self.critical:
            lines.append("  unstable throughout" if self._grows().all() else "  no change of stability")
        return "\n".join(lines)


def _as_it_is(scene: Scene, values: Any) -> tuple[str, list[float]]:
    """A parameter and the value that the scene has for it."""
    if values is not None:
        raise AnalysisError("complex_eigenvalues: values need over=, the name of a parameter")
    for name, value in scene.parameters.items():
        if isinstance(value, float):
            return name, [value]
    raise AnalysisError("complex_eigenvalues: over is needed for a scene without a parameter that is one number")


@answers
def complex_eigenvalues(
    scene: Scene,
    *,
    over: str | None = None,
    values: ArrayLike | None = None,
    speeds: Mapping[str, float] | None = None,
    highest: float | None = None,
) -> Eigenvalues:
    """Eigenvalues of steady sliding over one parameter.

    At each value the equilibrium is found (:func:`steady_sliding`), the scene linearised there with its analytic
    Jacobians (the coupling of the normal force into friction, the slope of the coefficient, the turning of the force in
    two dimensions, law states), and modes are followed by the similarity of their shapes, with intermediate values
    where these change much.  Critical values between those given are found to round-off: as a root of the growth rate,
    or of the squared distance of two eigenvalues where two undamped modes meet.

    Parameters
    ----------
    scene : Scene
    over : str, optional
        Name in ``scene.parameters``, or of a degree of freedom in ``speeds``.  Default: the scene as it is.
    values : (n_values,) array_like, optional
        Rising or falling; goes with ``over``.
    speeds : dict of str to float, optional
        As in :func:`steady_sliding`.
    highest : float, optional
        Angular frequency above which modes and critical values are left out: a reduced body has no true modes above
        those that were kept.

    Returns
    -------
    Eigenvalues

    Raises
    ------
    AnalysisError
        If there is no steady sliding at a value; names it.
    UnknownNameError
        For a parameter that is not there.

    Notes
    -----
    Critical values do not depend on the following of modes: growing eigenvalues are counted at the given values and
    between them, at 48 values or more, and spans are halved until their ends differ by one eigenvalue or one pair.  A
    window of instability narrower than that is not seen.
    """
    who = "complex_eigenvalues"
    checked_scene(who, scene)
    if over is None:
        over, values = _as_it_is(scene, values)
    checked_kind(who, "over", over, str, "a name out of scene.parameters or speeds")
    grid = checked_values(who, values)
    top = np.inf if highest is None else positive(who, "highest", highest)
    dofs: list[str] = []

    @functools.cache
    def solve(value: float) -> Pairs:
        steady = steady_at(scene, {over: value}, speeds)
        dofs[:] = [steady.system.dof_names[i] for i in steady.free]
        return steady.eigenpairs()

    with one_thread():
        found = follow(solve, grid)
        critical = crossings(solve, grid, found)
        fine, between = refine(solve, grid, found, [c.value for c in critical])
    eigenvalues = np.array([pairs[0] for pairs in found])
    vectors = np.array([pairs[1] for pairs in found])[:, :, : len(dofs)]
    limit = 1e-12 * max(float(np.abs(eigenvalues).max(initial=0.0)), 1e-300)
    kept = np.flatnonzero((eigenvalues[0].imag >= -limit) & (np.abs(eigenvalues.imag).min(axis=0) <= top))
    # of a crossing by the mode that stands for it: itself, or its conjugate at the first value
    start = eigenvalues[0]
    upper = start.real + 1j * np.abs(start.imag)
    stands = [
        int(np.argmin(np.abs(start[kept] - upper[j]))) if j not in kept else int(np.searchsorted(kept, j))
        for j in range(start.size)
    ]
    return Eigenvalues(
        over=over,
        values=grid,
        eigenvalues=eigenvalues[:, kept],
        shapes=_scaled(vectors[:, kept]),
        dofs=tuple(dofs),
        critical=tuple(
            replace(c, mode=stands[c.mode], kind=_kind(c, len(dofs))) for c in critical if c.frequency <= top
        ),
        fine_values=fine,
        fine_eigenvalues=between[:, kept],
        units=scene.units,
        over_unit=parameter_unit(scene, over),
    )


def _kind(crossing: Crossing, n: int) -> str:
    """One degree of freedom does not flutter: its oscillation grows where friction falls with speed."""
    return "self-excitation" if crossing.kind == "flutter" and n == 1 else crossing.kind


@dataclass(frozen=True, kw_only=True)
class StabilityMap:
    """Stability of steady sliding over two parameters.

    Attributes
    ----------
    over : (str, str)
    values : ((n_a,), (n_b,))
    growth : (n_a, n_b)
        Largest growth rate.
    frequency : (n_a, n_b)
        Angular frequency of the mode that has it.
    unstable : (n_a, n_b) int
        Number of growing modes, an oscillation counting once.
    units : Units
        Of the scene.
    over_units : (str, str)
        Units of the parameters, "" where they have none or it is not known.
    """

    over: tuple[str, str]
    values: tuple[Floats, Floats]
    growth: Floats
    frequency: Floats
    unstable: NDArray[np.int64]
    units: Units = DIMENSIONS
    over_units: tuple[str, str] = ("", "")


@answers
def stability_map(
    scene: Scene,
    *,
    over: tuple[str, str],
    values: Sequence[ArrayLike],
    speeds: Mapping[str, float] | None = None,
    highest: float | None = None,
) -> StabilityMap:
    """Largest growth rate of steady sliding over two parameters.

    Parameters
    ----------
    scene : Scene
    over : (str, str)
        Names as in :func:`complex_eigenvalues`.
    values : two array_like
        Of the first and the second, rising or falling.
    speeds : dict of str to float, optional
        As in :func:`steady_sliding`.
    highest : float, optional
        Angular frequency above which modes and critical values are left out: a reduced body has no true modes above
        those that were kept.

    Returns
    -------
    StabilityMap

    Raises
    ------
    AnalysisError
        If there is no steady sliding somewhere; names the values.
    """
    checked_scene("stability_map", scene)
    lists = isinstance(over, tuple | list) and isinstance(values, tuple | list | np.ndarray)
    if not lists or len(over) != 2 or len(values) != 2 or not all(isinstance(name, str) for name in over):
        raise AnalysisError(
            f"stability_map: over and values must be two each, names and lists of numbers; got {shown(over)} and"
            f" {shown(values)}"
        )
    first, second = (checked_values("stability_map", v) for v in values)
    top = np.inf if highest is None else positive("stability_map", "highest", highest)
    growth, frequency = np.zeros((2, first.size, second.size))
    unstable = np.zeros((first.size, second.size), dtype=np.int64)
    with one_thread():
        for (i, a), (j, b) in itertools.product(enumerate(first.tolist()), enumerate(second.tolist())):
            found = steady_at(scene, {over[0]: a, over[1]: b}, speeds).eigenpairs()[0]
            found = found[np.abs(found.imag) <= top]
            if not found.size:
                continue
            scale = float(np.abs(found).max())
            most = int(np.argmax(found.real))
            growth[i, j], frequency[i, j] = found[most].real, abs(found[most].imag)
            unstable[i, j] = int(((found.real > 1e-7 * scale) & (found.imag >= -1e-12 * scale)).sum())
    return StabilityMap(
        over=(over[0], over[1]),
        values=(first, second),
        growth=growth,
        frequency=frequency,
        unstable=unstable,
        units=scene.units,
        over_units=(parameter_unit(scene, over[0]), parameter_unit(scene, over[1])),
    )


def steady_at(scene: Scene, values: Mapping[str, float], speeds: Mapping[str, float] | None) -> SteadySliding:
    """Steady sliding with some parameters or speeds at given values."""
    held = dict(checked_speeds(speeds))
    here = {name: value for name, value in values.items() if name not in held}
    held |= {name: value for name, value in values.items() if name in held}
    try:
        return steady_sliding(scene.with_parameters(here) if here else scene, speeds=held or None)
    except AnalysisError as error:
        raise AnalysisError(f"{error} (at {', '.join(f'{k} = {v:g}' for k, v in values.items())})") from None


def _scaled(shapes: Complexes) -> Complexes:
    """With the largest component of each shape 1."""
    if not shapes.size:
        return shapes
    largest = np.take_along_axis(shapes, np.argmax(np.abs(shapes), axis=-1)[..., None], axis=-1)
    return np.divide(shapes, largest, out=np.zeros_like(shapes), where=largest != 0)
