"""A measured series as a function of time."""

from __future__ import annotations

import sys
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from os import PathLike
from typing import Any, Literal

import numpy as np

from fricmb._calls import answers
from fricmb.errors import SceneError, shown
from fricmb.integrate.problem import Floats
from fricmb.integrate.signals.pieces import SLOPE, Table, table_of
from fricmb.values import Arithmetic

KINDS = ("linear", "hold", "cubic")
OUTSIDE = ("refuse", "hold", "zero")
#: Standard deviation of the third differences of white noise of size 1, and of the slope of a line through two of its
#: values, or of a cubic spline through all, times their spacing.
_THIRD = 20.0**0.5
_SLOPES = {"linear": 2.0**0.5, "hold": 0.0, "cubic": 3.0 * (2.0 / 3.0**0.5 - 1.0) ** 0.5}
#: A spacing of so many usual ones is a gap; that part of a slope that is noise is much.
_GAP, _MUCH = 3.0, 0.3
#: A time may lie outside by this part of the ends: round-off, as for runs.
_BEYOND = 1e-9


@dataclass(frozen=True, eq=False)
class Signal(Arithmetic):
    """A measured series as a function of time: it stands wherever an expression in ``fm.t`` may.

    It combines with numbers, parameters and expressions: ``2.0 * signal + sympy.sin(fm.t)``.  Runs step to every value
    at which it bends or jumps, and compile nothing for it.

    Parameters
    ----------
    t : (n,) array
        Times, rising, in the scene's unit of time.
    y : (n,) array
        Values, finite.
    kind : {"linear", "hold", "cubic"}
        Interpolation between two values: the line through both, the first of them, or the cubic spline through all
        (not-a-knot), whose second derivative is continuous.
    outside : {"refuse", "hold", "zero"}
        Values before the first and after the last: none (a run that goes there is refused); that of the end; 0.
    name : str
        Name in printed expressions, "signal" by default.

    Raises
    ------
    SceneError
        For a value that is not finite, or a time that repeats or falls; names its place.

    Examples
    --------
    >>> import fricmb as fm, numpy as np
    >>> t = np.linspace(0.0, 2.0, 201)
    >>> push = fm.Signal(t, np.sin(5 * t), kind="cubic", name="push")
    >>> push
    Signal 'push': 201 values, t from 0 to 2 each 0.01, cubic, outside refused
    >>> print(2 * push + fm.t)
    t + 2*push(t)
    >>> push([0.0, 0.305])
    array([0.        , 0.99891...])
    """

    t: Any
    y: Any
    kind: Literal["linear", "hold", "cubic"] = "linear"
    outside: Literal["refuse", "hold", "zero"] = "refuse"
    _: KW_ONLY
    name: str = "signal"

    def __post_init__(self) -> None:
        for field, words in (("kind", KINDS), ("outside", OUTSIDE)):
            value = getattr(self, field)
            if not isinstance(value, str) or value not in words:
                raise SceneError(f"Signal: {field} must be one of {', '.join(words)}, got {shown(value)}")
        if not isinstance(self.name, str) or not self.name.strip():
            raise SceneError(f"Signal: name must be a non-empty string, got {shown(self.name)}")
        t, y = _vector("t", self.t), _vector("y", self.y)
        if t.size != y.size:
            raise SceneError(f"Signal {self.name!r}: y must hold as many values as t, {t.size}, got {y.size}")
        least = {"linear": 2, "hold": 1, "cubic": 4}[self.kind]
        if t.size < least:
            raise SceneError(f"Signal {self.name!r}: {self.kind} takes at least {least} values, got {t.size}")
        _check_finite(self.name, "t", t, t)
        _check_finite(self.name, "y", y, t)
        _check_rising(self.name, t)
        for field, value in (("t", t), ("y", y)):
            value.setflags(write=False)
            object.__setattr__(self, field, value)

    @classmethod
    @answers
    def read(
        cls, path: str | PathLike[str], *, time: Any = None, value: Any = None, units: Any = 1.0,
        kind: Literal["linear", "hold", "cubic"] = "linear", outside: Literal["refuse", "hold", "zero"] = "refuse",
        step: float | None = None,
    ) -> Signal:  # fmt: skip
        """Read a series from a file.

        Parameters
        ----------
        path : path
            CSV (also with ``;``, tabs, decimal commas, several lines of names, a byte order mark), npz, WAV, MAT, HDF5
            (extra ``hdf5``), UFF (extra ``uff``), TDMS (extra ``tdms``).
        time, value : str, optional
            Names of the columns; by default the one called t or time, and the only other one.
        units : float or (float, float)
            Factor of values, or of times and of values: ``(1e-3, 9.81)`` for milliseconds and multiples of g.
        kind, outside
            As of :class:`Signal`.
        step : float, optional
            Spacing of times, before ``units``, where the file has none.

        Raises
        ------
        FileError
            Names the file, the line or column and what was expected.
        SceneError
            For a time that repeats or falls, or a value that is not finite.
        """
        from fricmb.signal._read import read_columns

        t, y, name = read_columns(path, time, value, units, step)
        return cls(t, y, kind, outside, name=name)

    # -- what it is ---------------------------------------------------------------------------------------------
    def __repr__(self) -> str:
        n, spacing = self.t.size, np.diff(self.t)
        even = n > 1 and np.ptp(spacing) < 1e-6 * np.median(spacing)
        each = f" each {np.median(spacing):.6g}" if even else ""
        outside = {"refuse": "outside refused", "hold": "held outside", "zero": "0 outside"}[self.outside]
        span = f"t from {self.t[0]:.6g} to {self.t[-1]:.6g}{each}"
        return f"Signal {self.name!r}: {n} values, {span}, {self.kind}, {outside}"

    def __call__(self, x: Any) -> Any:
        """Values at times, as numbers; of an expression in ``fm.t``, linear in it, the expression.

        Raises
        ------
        SceneError
            For a time outside the values, where these are not to be had (``outside="refuse"``).
        """
        if hasattr(x, "free_symbols"):
            from fricmb.signal._symbols import series_of

            return series_of(self._table, self.name, x)
        times = np.asarray(x, dtype=float)
        self._check_inside(times)
        return self._table.value(times)

    def _check_inside(self, times: Floats) -> None:
        """Refuse times outside, but for the round-off of a time at an end."""
        first, last = float(self.t[0]), float(self.t[-1])
        margin = _BEYOND * max(abs(first), abs(last))
        beyond = times[(times < first - margin) | (times > last + margin)]
        if self.outside == "refuse" and beyond.size:
            raise SceneError(
                f"Signal {self.name!r}: known from t = {first:.10g} to {last:.10g}, not at"
                f' {float(beyond[0]):.10g}; accepted is a time inside, or fm.Signal(..., outside="hold") or "zero"'
            )

    @cached_property
    def _table(self) -> Table:
        t, y = self.t, self.y
        domain = (float(t[0]), float(t[-1])) if self.outside == "refuse" else (-np.inf, np.inf)
        before, after = (0.0, 0.0) if self.outside == "zero" else (y[0], y[-1])
        return table_of(t, _pieces(t, y, self.kind), before=before, after=after, domain=domain)

    @property
    def gaps(self) -> list[tuple[float, float]]:
        """Where values lie more than three times as far apart as usual: from when to when."""
        spacing = np.diff(self.t)
        if not spacing.size:
            return []
        return [(float(self.t[i]), float(self.t[i + 1])) for i in np.flatnonzero(spacing > _GAP * np.median(spacing))]

    @property
    def noise(self) -> float:
        """Standard deviation of the noise of single values, estimated from third differences."""
        if self.y.size < 8:
            return 0.0
        third = np.diff(self.y, 3)
        return float(1.4826 * np.median(np.abs(third)) / _THIRD)

    @property
    def slope_noise(self) -> float:
        """Standard deviation of the slope that follows from :attr:`noise`."""
        spacing = np.diff(self.t)
        return float(self.noise * _SLOPES[self.kind] / np.median(spacing)) if spacing.size else 0.0

    @property
    def slope(self) -> Any:
        """The derivative by time, as an expression."""
        from fricmb.signal._symbols import series_of

        return series_of(self._table, self.name, order=1)

    @property
    def integral(self) -> Any:
        """The integral over time from the first value on, as an expression."""
        from fricmb.signal._symbols import series_of

        return series_of(self._table, self.name, order=-1)

    # -- other series -------------------------------------------------------------------------------------------
    @answers
    def lowpass(self, frequency: float, *, order: int = 4) -> Signal:
        """A copy without faster swings, and without delay: Butterworth's filter, run forward and back.

        Parameters
        ----------
        frequency : float
            Cut-off frequency, at which half of the power of each pass is left; cycles per unit of time.
        order : int
            Of each pass.

        Raises
        ------
        SceneError
            For uneven times (:meth:`resampled` makes them even), or a frequency above half of that of the values.
        """
        from fricmb.signal._filters import filtered

        return replace(self, y=filtered(self, "lowpass", frequency, order))

    @answers
    def highpass(self, frequency: float, *, order: int = 4) -> Signal:
        """A copy without slower swings, such as the drift of an accelerometer; see :meth:`lowpass`."""
        from fricmb.signal._filters import filtered

        return replace(self, y=filtered(self, "highpass", frequency, order))

    @answers
    def detrended(self) -> Signal:
        """A copy without its mean and its linear trend (by least squares)."""
        from scipy.signal import detrend

        if np.ptp(np.diff(self.t)) > 1e-6 * np.median(np.diff(self.t)):
            line = np.polynomial.Polynomial.fit(self.t, self.y, 1)
            return replace(self, y=self.y - line(self.t))
        return replace(self, y=detrend(self.y))

    @answers
    def resampled(self, step: float) -> Signal:
        """The series at evenly spaced times, after a filter against aliasing (``scipy.signal.resample_poly``)."""
        from fricmb.signal._filters import resampled

        t, y = resampled(self, step)
        return replace(self, t=t, y=y)

    @answers
    def shifted(self, by: float) -> Signal:
        """A copy shifted to later times."""
        if not _is_number(by):
            raise SceneError(f"Signal {self.name!r}: by must be a finite number, got {shown(by)}")
        return replace(self, t=self.t + float(by))

    @answers
    def aligned(self, other: Signal, *, within: float | None = None) -> Signal:
        """A copy shifted in time to fit another series best, by the largest correlation.

        Parameters
        ----------
        other : Signal
        within : float, optional
            The largest shift; by default any at which half of the shorter one lies on the other.

        Raises
        ------
        SceneError
            Where the two have nothing in common.
        """
        from fricmb.signal._filters import lag

        if not isinstance(other, Signal):
            raise SceneError(f"Signal {self.name!r}: other must be a Signal, got {shown(other)}")
        return self.shifted(lag(self, other, within))

    # -- in expressions -----------------------------------------------------------------------------------------
    def _sympy_(self) -> Any:
        from fricmb.signal._symbols import series_of

        return series_of(self._table, self.name)

    def __getstate__(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in ("t", "y", "kind", "outside", "name")}


def is_series(value: Any) -> bool:
    """Whether a value is a series: a Signal, a pandas Series, or a pair of vectors of one length."""
    if isinstance(value, Signal) or _is_pandas(value):
        return True
    if not isinstance(value, tuple | list) or len(value) != 2:
        return False
    return all(isinstance(v, np.ndarray | list | tuple) and np.ndim(v) == 1 and len(v) > 1 for v in value)


def signal_of(value: Any) -> Signal:
    """The Signal of a series: see :func:`is_series`."""
    if isinstance(value, Signal):
        return value
    if _is_pandas(value):
        return _from_pandas(value)
    return Signal(*value)


def _is_pandas(value: Any) -> bool:
    pandas = sys.modules.get("pandas")
    return pandas is not None and isinstance(value, pandas.Series | pandas.DataFrame)


def _from_pandas(value: Any) -> Signal:
    """Times are the index; durations and dates in seconds, dates from the first on."""
    import pandas

    if isinstance(value, pandas.DataFrame):
        if value.shape[1] != 1:
            columns = ", ".join(map(str, value.columns[:8]))
            raise SceneError(f"Signal: a DataFrame with {value.shape[1]} columns, {columns}; give one of them")
        value = value.iloc[:, 0]
    index = value.index
    if isinstance(index, pandas.DatetimeIndex):
        index = index - index[0]
    t = index.total_seconds() if isinstance(index, pandas.TimedeltaIndex) else index
    name = str(value.name).strip() if value.name is not None else ""
    return Signal(np.asarray(t), value.to_numpy(), name=name or "signal")


def _vector(field: str, value: Any) -> Floats:
    try:
        found = np.array(value, dtype=float)
        if isinstance(value, np.ma.MaskedArray):  # what is masked is missing: _check_finite names its place
            found[np.ma.getmaskarray(value)] = np.nan
    except (TypeError, ValueError):
        found = None
    if found is None or found.ndim != 1 or np.iscomplexobj(value):
        raise SceneError(f"Signal: {field} must be a vector of real numbers, got {shown(value)}")
    return found


def _check_finite(name: str, field: str, values: Floats, t: Floats) -> None:
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        at = f" (t = {t[bad[0]]:.6g})" if field == "y" else ""
        raise SceneError(
            f"Signal {name!r}: {field} holds {values[bad[0]]} at place {bad[0]}{at}, {bad.size} such value(s) in all;"
            " accepted are finite numbers: leave these times out, or fill them"
        )


def _check_rising(name: str, t: Floats) -> None:
    bad = np.flatnonzero(np.diff(t) <= 0.0)
    if not bad.size:
        return
    i = int(bad[0])
    what = f"t = {t[i]:.10g} occurs twice" if t[i + 1] == t[i] else f"t falls from {t[i]:.10g} to {t[i + 1]:.10g}"
    raise SceneError(
        f"Signal {name!r}: {what} (places {i} and {i + 1}; {bad.size} such place(s) in all); accepted are rising times:"
        " sort them (numpy.argsort), or leave repeated ones out (numpy.unique)"
    )


def _is_number(value: Any) -> bool:
    number = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
    return number and bool(np.isfinite(value))


def _pieces(t: Floats, y: Floats, kind: str) -> Floats:
    """Coefficients (n - 1, d + 1) between values, from the lowest power on."""
    if kind == "hold":
        return y[:-1, None]
    if kind == "linear":
        return np.stack([y[:-1], np.diff(y) / np.diff(t)], axis=1)
    from scipy.interpolate import CubicSpline

    found: Floats = CubicSpline(t, y).c[::-1].T
    return found


def slope_told(signal: Signal) -> str:
    """What to say of a position whose slope is for the most part noise; "" of any other."""
    spread, noise = float(np.std(signal._table.value(signal.t, SLOPE))), signal.slope_noise
    if noise <= _MUCH * spread:
        return ""
    return (
        f"the speed that follows from {signal.name!r} has noise of {noise:.3g}, and varies by {spread:.3g} in all;"
        " smooth the series first, by signal.lowpass(...)"
    )
