"""Measurements in one form: what was measured, when, and with which error."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.errors import SceneError, shown
from fricmb.integrate.event_kinds import TABLE
from fricmb.integrate.problem import Floats

PERIOD = "period"
#: What is measured of a contact by when it happens.
_KINDS = tuple(kind.name for kind in TABLE if kind.transition)


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One measured quantity.

    Attributes
    ----------
    name : str
        A signal ("mass.x", "sole.force"), transitions ("sole.stick"), or "period".
    kind : str
        "signal", "event" or "period".
    t : (n,)
        Times of a signal; measured times of transitions; 0 for periods.
    x : (n,)
        Values of a signal; times of transitions; periods.
    sigma : (n,)
        Standard errors, or where none are known the extent of the quantity.
    """

    name: str
    kind: str
    t: Floats
    x: Floats
    sigma: Floats

    def until(self, t: float) -> Measured:
        """What was measured until then; periods always."""
        if self.kind == PERIOD:
            return self
        chosen = self.t <= t
        return Measured(name=self.name, kind=self.kind, t=self.t[chosen], x=self.x[chosen], sigma=self.sigma[chosen])


def numbers(name: str, values: Any, accepted: str = "numbers") -> Floats:
    """Numbers as an array."""
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise SceneError(f"{name}: got {shown(values)}; expected {accepted}") from None


def read(data: Any, signals: Iterable[str] | None, sigma: Any) -> tuple[Measured, ...]:
    """Measurements out of an array, a table or a dict."""
    t, columns = _columns(data, signals)
    found = []
    for name, values in columns.items():
        x = np.atleast_1d(numbers(f"data: {name}", values)).ravel()
        kind = PERIOD if name == PERIOD else "event" if name.rpartition(".")[2] in _KINDS else "signal"
        when = x if kind == "event" else np.zeros(x.size) if kind == PERIOD else _times(t, x, name)
        good = np.isfinite(x) & np.isfinite(when)
        if not good.any():
            raise SceneError(f"data: {name} holds no finite value")
        found.append(Measured(
            name=name, kind=kind, t=when[good], x=x[good], sigma=_sigma(sigma, name, x, good, len(columns))
        ))  # fmt: skip
    if not found:
        raise SceneError("data: got nothing measured; expected signals, transitions or a period")
    return tuple(found)


def _columns(data: Any, signals: Iterable[str] | None) -> tuple[Any, dict[str, Any]]:
    if signals is not None and not isinstance(signals, Iterable):
        raise SceneError(f"signals: got {shown(signals)}; expected a name, or several")
    names = None if signals is None else ((signals,) if isinstance(signals, str) else tuple(signals))
    if hasattr(data, "columns") and hasattr(data, "index"):  # a pandas table
        table = {str(name): np.asarray(data[name], dtype=float) for name in data.columns}
        t = table.pop("t") if "t" in table else np.asarray(data.index, dtype=float)
        return t, _chosen(table, names)
    if isinstance(data, Mapping):
        table = dict(data)
        return table.pop("t", None), _chosen(table, names)
    array = numbers("data", data, "a dict, a table, or an array")
    if names is None or array.ndim != 2 or array.shape[1] != 1 + len(names):
        wanted = "signals=(...) and " if names is None else ""
        raise SceneError(
            f"data: got an array of shape {array.shape}; expected {wanted}(n_t, 1 + the number of signals), times first"
        )
    return array[:, 0], dict(zip(names, array[:, 1:].T, strict=True))


def _chosen(table: dict[str, Any], names: tuple[str, ...] | None) -> dict[str, Any]:
    """Those named, and all transitions and periods of a dict; without names all."""
    if names is None:
        return table
    missing = [name for name in names if name not in table]
    if missing:
        raise SceneError(f"signals: data has no column {missing[0]!r}; it has {', '.join(map(repr, table))}")
    others = [name for name in table if name == PERIOD or name.rpartition(".")[2] in _KINDS]
    return {name: table[name] for name in dict.fromkeys([*names, *others])}


def _times(t: Any, x: Floats, name: str) -> Floats:
    if t is None:
        raise SceneError(f'data: {name} needs the times "t" at which it was measured')
    times = numbers('data: "t"', t).ravel()
    if times.shape != x.shape:
        raise SceneError(f"data: {name} has {x.size} values at {times.size} times")
    return times


def _sigma(sigma: Any, name: str, x: Floats, good: Any, n_quantities: int) -> Floats:
    given = sigma.get(name) if isinstance(sigma, Mapping) else sigma
    if given is None:
        if sigma is not None:
            raise SceneError(f"sigma: has no entry for {name!r}; give one for each measured quantity")
        extent = float(np.ptp(x[good])) if n_quantities > 1 else 1.0
        return np.full(int(good.sum()), extent or max(float(np.abs(x[good]).max()), 1e-300))
    known = numbers("sigma", given, "standard errors")
    if known.shape not in ((), x.shape):
        raise SceneError(f"sigma: standard errors of {name} must be one number or {x.size}; got shape {known.shape}")
    errors = np.broadcast_to(known, x.shape)[good]
    if not (np.isfinite(errors).all() and (errors > 0).all()):
        raise SceneError(f"sigma: standard errors of {name} must be positive; got {shown(given)}")
    return np.array(errors)
