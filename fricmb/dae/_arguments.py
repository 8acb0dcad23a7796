"""Checks of solve_dae's arguments, and the objects made from them."""

from __future__ import annotations

import operator
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import sparse

from fricmb.dae import _pattern as pattern
from fricmb.dae._engine import Engine, System
from fricmb.dae._function import Residual, is_compiled
from fricmb.dae._jacobian import Differences, Given, pair
from fricmb.dae._matrix import Matrix
from fricmb.errors import ArgumentError, shown
from fricmb.integrate.formulas.backward_differences import MAX_ORDER
from fricmb.integrate.problem import Floats


def _array(value: Any, name: str) -> Floats:
    try:
        raw = np.asarray(value)
    except ValueError:  # rows of different lengths
        raise ArgumentError(f"`{name}` must be numbers, not {shown(value)}.") from None
    if raw.dtype.kind == "c":
        raise ArgumentError(f"`{name}` must be real; split a complex problem into real and imaginary parts.")
    try:
        array = np.array(raw, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"`{name}` must be numbers, not {shown(value)}.") from None
    if not np.all(np.isfinite(array)):
        raise ArgumentError(f"All components of `{name}` must be finite, not {shown(value)}.")
    return array


def span(t_span: Any) -> tuple[float, float]:
    """(t0, t_end)."""
    values = _array(t_span, "t_span")
    if values.shape != (2,):
        raise ArgumentError(f"`t_span` must be the pair (t0, t_end); its shape is {values.shape}.")
    return float(values[0]), float(values[1])


def state(y0: Any, yp0: Any) -> tuple[Floats, Floats | None]:
    """Initial values as (n,) arrays."""
    y = _array(y0, "y0")
    if y.ndim != 1 or y.size == 0:
        raise ArgumentError(f"`y0` must be a 1-D array with at least one component; its shape is {y.shape}.")
    if yp0 is None:
        return y, None
    yp = _array(yp0, "yp0")
    if yp.shape != y.shape:
        raise ArgumentError(f"`yp0` must have the shape of `y0`, {y.shape}; its shape is {yp.shape}.")
    return y, yp


def tolerances(rtol: Any, atol: Any, n: int) -> tuple[Floats, Floats]:
    """Both as (n,) arrays."""
    found = []
    for value, name in ((rtol, "rtol"), (atol, "atol")):
        array = _array(value, name)
        if array.shape not in ((), (n,)):
            raise ArgumentError(f"`{name}` must be a number or of shape ({n},); its shape is {array.shape}.")
        if np.any(array < 0.0):
            raise ArgumentError(f"`{name}` must not be negative: {shown(value)}.")
        found.append(np.array(np.broadcast_to(array, (n,))))
    floor = 100.0 * float(np.finfo(float).eps)
    if np.any((found[0] < floor) & (found[0] != 0.0)) or np.any(found[0] + found[1] == 0.0):
        warnings.warn(f"`rtol` is too small; it is set to {floor:.3g}.", stacklevel=4)
        found[0] = np.maximum(found[0], floor)
    return found[0], np.maximum(found[1], 1e-300)


def extra(args: Any) -> tuple[Any, ...]:
    """Further arguments."""
    if isinstance(args, tuple):
        return args
    try:
        return tuple(args)
    except TypeError:
        raise ArgumentError(f"`args` must be a tuple, as in args=({args!r},).") from None


def times(t_eval: Any, t0: float, t_end: float) -> Floats | None:
    """Times of output, in the order of the run."""
    if t_eval is None:
        return None
    values = _array(t_eval, "t_eval")
    if values.ndim != 1:
        raise ArgumentError("`t_eval` must be 1-dimensional.")
    low, high = min(t0, t_end), max(t0, t_end)
    slack = 4.0 * float(np.spacing(max(abs(low), abs(high))))
    if np.any(values < low - slack) or np.any(values > high + slack):
        raise ArgumentError("Values in `t_eval` are not within `t_span`.")
    steps = np.diff(values) if t_end >= t0 else -np.diff(values)
    if np.any(steps <= 0):
        raise ArgumentError("Values in `t_eval` are not properly sorted.")
    return np.clip(values, low, high)


def order(max_order: Any) -> int:
    """Highest order."""
    whole = isinstance(max_order, int | float | np.integer | np.floating) and max_order in range(1, MAX_ORDER + 1)
    if not whole:
        raise ArgumentError(f"`max_order` must be 1 to {MAX_ORDER}, not {shown(max_order)}.")
    return int(max_order)


def step(value: Any, name: str) -> float:
    """A positive step size."""
    try:
        found = float(value)
    except (TypeError, ValueError, OverflowError):
        found = np.nan
    if not found > 0.0:
        raise ArgumentError(f"`{name}` must be positive, not {shown(value)}.")
    return found


def first(value: Any, length: float) -> float:
    """The first step size."""
    h = step(value, "first_step")
    if h > length:
        raise ArgumentError(f"`first_step` exceeds bounds: {h:g} is more than the {length:g} of `t_span`.")
    return h


def system(
    residual: Residual,
    jac: Callable[..., Any] | None,
    jac_sparsity: Any,
    bandwidth: Any,
    args: tuple[Any, ...],
    tol: tuple[Floats, Floats],
    start: tuple[float, Floats, Floats | None],
) -> System:
    """The problem with its storage: banded if a bandwidth is given, sparse if ``jac`` or a structure is, else dense."""
    n = residual.n
    if jac is not None and not callable(jac):
        raise ArgumentError(f"`jac` must be callable as jac(t, y, yp), not {shown(jac)}.")
    if bandwidth is not None:
        matrix = _banded(bandwidth, n)
    elif jac_sparsity is not None:
        matrix = pattern.sparse_matrix(_structure(jac_sparsity, n))
    elif jac is not None:
        matrix = _of_jac(jac, args, n, start)
    else:
        matrix = pattern.dense(n)
    jacobian: Any = Differences(residual, matrix, *tol) if jac is None else Given(jac, args, matrix)
    return System(residual, jacobian, matrix, *tol)


def _banded(bandwidth: Any, n: int) -> Matrix:
    try:
        lower, upper = (operator.index(b) for b in bandwidth)
    except (TypeError, ValueError):
        raise ArgumentError(f"`bandwidth` must be the pair (lband, uband), not {shown(bandwidth)}.") from None
    if lower < 0 or upper < 0:
        raise ArgumentError(f"`bandwidth` must not be negative: {bandwidth!r}.")
    return pattern.banded(n, min(lower, n - 1), min(upper, n - 1))


def _structure(given: Any, n: int) -> Any:
    parts = given if isinstance(given, (tuple, list)) and len(given) == 2 and np.ndim(given[0]) != 1 else (given,)
    total = sparse.csc_array((n, n))
    for part in parts:
        entries: Any = part if sparse.issparse(part) else _array(part, "jac_sparsity")
        if entries.ndim != 2:
            raise ArgumentError(f"`jac_sparsity` must be of shape ({n}, {n}); its shape is {entries.shape}.")
        one = sparse.csc_array(entries)
        if one.shape != (n, n):
            raise ArgumentError(f"`jac_sparsity` must be of shape ({n}, {n}); its shape is {one.shape}.")
        ones = (np.ones(one.nnz), one.indices, one.indptr)
        total = total + sparse.csc_array(ones, shape=(n, n))
    return total


def _of_jac(
    jac: Callable[..., Any], args: tuple[Any, ...], n: int, start: tuple[float, Floats, Floats | None]
) -> Matrix:
    """Dense or sparse as what ``jac`` returns; its stored entries are the structure."""
    t, y, yp = start
    first_value, second = pair(jac(t, y.copy(), np.zeros(n) if yp is None else yp.copy(), *args))
    if not (sparse.issparse(first_value) and sparse.issparse(second)):
        return pattern.dense(n)
    return pattern.sparse_matrix(_structure((first_value, second), n))


def engine(system: System, limits: tuple[int, float], t_end: float, chunk: int) -> Engine:
    """The stepper and who serves it; a compiled function makes up to ``chunk`` steps at a time."""
    if not system.function.compiled:
        return Engine(system, limits[0], limits[1], t_end)
    from fricmb.dae._loop import CompiledEngine  # only then is there something to compile

    jac = system.jacobian.jac if isinstance(system.jacobian, Given) and is_compiled(system.jacobian.jac) else None
    return CompiledEngine(system, limits[0], limits[1], t_end, jac, chunk)
