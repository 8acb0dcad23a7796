"""What a sweep made, in the order of its runs, as a table and as pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fricmb._facade import facade
from fricmb.errors import FricmbError, SceneError, shown, unknown_name

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: A number of each run: a function of what the run gave, or the name of a number in a dict that ``reduce`` returned.
Measure = Callable[[Any], Any] | str
#: The name of numbers that ``reduce`` returned themselves.
RESULT = "result"


class SweepResults(list[Any]):
    """Results of :func:`fricmb.sweep`, a list in the order of the runs, that knows the values of each.

    Entries are solutions, or what ``reduce`` returned; an IntegrationError for a run that failed, None for one that was
    not made.  A *measure* is a number of each run: a function of its result, or the name of a number where ``reduce``
    returned a dict; where it returned a number, that is the measure and need not be named.

    Parameters
    ----------
    results : iterable
    values : iterable of dict
        The values of each run by the names of parameters.
    units : dict of str to str
        Units of parameters, for labels.

    Examples
    --------
    >>> import fricmb as fm
    >>> found = fm.sweep(
    ...     fm.models.belt_oscillator(),
    ...     [{"belt.velocity.x": speed} for speed in (0.05, 0.1)],
    ...     t_end=30.0, reduce=lambda sol: {"events": len(sol.events)}, workers=1, progress=False,
    ... )
    >>> found.parameters
    ('belt.velocity.x',)
    >>> found.measure("events").tolist()
    [2.0, 3.0]
    """

    def __init__(
        self, results: Iterable[Any], *, values: Iterable[Mapping[str, Any]], units: Mapping[str, str] | None = None
    ) -> None:
        super().__init__(results)
        self.values = tuple(values)
        self.units = dict(units or {})

    def __reduce__(self) -> tuple[Any, ...]:
        return _made, (list(self), self.values, self.units)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters that the runs give values to."""
        return tuple(dict.fromkeys(name for values in self.values for name in values))

    @property
    def failed(self) -> tuple[int, ...]:
        """Indices of the runs without a result."""
        return tuple(i for i, result in enumerate(self) if _is_missing(result))

    def value(self, name: str) -> NDArray[np.float64]:
        """Values of one parameter (n,), nan where a run leaves the scene's own.

        Raises
        ------
        UnknownNameError
            If no run gives it a value.
        """
        if name not in self.parameters:
            raise unknown_name("parameter of the sweep", name, self.parameters)
        return np.array([_number(values.get(name, np.nan), name) for values in self.values])

    def measure(self, what: Measure | None = None) -> NDArray[np.float64]:
        """A measure of every run (n,), nan for those that failed.

        Parameters
        ----------
        what : callable or str, optional
            Default: the result itself, or the one number of the dict.

        Raises
        ------
        SceneError
            If the measure of a run is not a number.
        UnknownNameError
            For a name that the results do not have.
        """
        chosen = self._only() if what is None else what
        return np.array([np.nan if _is_missing(result) else _measured(result, chosen) for result in self])

    def measures(self) -> tuple[str, ...]:
        """Names of the numbers that ``reduce`` returned: the keys of its dict, or "result"."""
        first = next((result for result in self if not _is_missing(result)), None)
        if isinstance(first, Mapping):
            return tuple(name for name, held in first.items() if np.ndim(held) == 0)
        return () if first is None or np.ndim(first) or not _is_number(first) else (RESULT,)

    def to_pandas(self, **measures: Measure) -> pandas.DataFrame:
        """A table with one row for each run: parameter values, measures, and the error of a run that failed.

        Parameters
        ----------
        **measures : callable or str
            By the name of their column.  Default: all numbers that ``reduce`` returned.
        """
        try:
            import pandas
        except ImportError as error:
            raise ImportError('to_pandas needs pandas: pip install "fricmb[pandas]"') from error
        table: dict[str, Any] = {name: self.value(name) for name in self.parameters}
        table |= {name: self.measure(what) for name, what in self._asked(measures).items()}
        if self.failed:
            table["error"] = [str(result) if isinstance(result, Exception) else "" for result in self]
        return pandas.DataFrame(table)

    def to_xarray(self, **measures: Measure) -> xarray.Dataset:
        """Measures over a grid whose axes are the parameters, nan where no run was made or one failed.

        Parameters
        ----------
        **measures : callable or str
            As :meth:`to_pandas`.
        """
        try:
            import xarray
        except ImportError as error:
            raise ImportError('to_xarray needs xarray: pip install "fricmb[xarray]"') from error
        names = self.parameters
        grids = {name: self.grid(what) for name, what in self._asked(measures).items()}
        axes = next(iter(grids.values()))[0] if grids else tuple(np.unique(self.value(name)) for name in names)
        return xarray.Dataset(
            {name: (names, held) for name, (_, held) in grids.items()}, coords=dict(zip(names, axes, strict=True))
        )

    def grid(
        self, what: Measure | None = None, *, over: tuple[str, ...] | None = None
    ) -> tuple[tuple[NDArray[np.float64], ...], NDArray[np.float64]]:
        """A measure over a grid: the values along each axis, and the measure (len of each axis).

        Parameters
        ----------
        what : callable or str, optional
            As :meth:`measure`.
        over : tuple of str, optional
            Parameters that are the axes; default: all.

        Raises
        ------
        SceneError
            If two runs have the same values.
        """
        names = self.parameters if over is None else tuple(over)
        if not names:
            raise SceneError("over: the sweep gives no parameter a value; expected one or more, which are the axes")
        found = [np.unique(self.value(name), return_inverse=True) for name in names]
        places = tuple(place for _, place in found)
        held = np.full([axis.size for axis, _ in found], np.nan)
        if len({*zip(*(place.tolist() for place in places), strict=True)}) < len(self):
            raise SceneError(f"over: several runs have the same values of {', '.join(names)}; name more parameters")
        held[places] = self.measure(what)
        return tuple(axis for axis, _ in found), held

    @facade
    def plot(
        self, what: Measure | None = None, *, over: str | tuple[str, ...] | None = None, label: str | None = None,
        ax: Axes | None = None,
    ) -> Figure:  # fmt: skip
        """Draw a measure over one parameter as a curve, over two as a map.

        Parameters
        ----------
        what : callable or str, optional
            As :meth:`measure`.
        over : str or pair of str, optional
            Parameters along the axes; default: those that change from run to run.
        label : str, optional
            Of the measure; default: its name.
        ax : matplotlib Axes, optional

        Raises
        ------
        SceneError
            For more than two parameters, or runs with the same values.
        """
    def _asked(self, measures: Mapping[str, Measure]) -> dict[str, Measure]:
        return dict(measures) if measures else {name: name for name in self.measures()}

    def _only(self) -> str:
        names = self.measures()
        if len(names) != 1:
            raise SceneError(
                f"measure: the results hold {', '.join(names) or 'no number'}; give a function of a result"
                + (", or one of these names" if names else "")
            )
        return names[0]


def _made(
    results: list[Any], values: tuple[Mapping[str, Any], ...], units: Mapping[str, str] | None = None
) -> SweepResults:
    return SweepResults(results, values=values, units=units)


def _is_missing(result: Any) -> bool:
    return result is None or isinstance(result, FricmbError)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.number)


def _number(value: Any, what: str) -> float:
    if not _is_number(value):
        raise SceneError(f"{what}: got {shown(value)}; expected a number")
    return float(value)


def _measured(result: Any, what: Measure) -> float:
    if callable(what):
        return _number(what(result), "measure")
    if isinstance(result, Mapping):
        if what not in result:
            raise unknown_name("measure", what, tuple(result))
        return _number(result[what], what)
    if what != RESULT:
        raise unknown_name("measure", what, (RESULT,))
    return _number(result, what)
