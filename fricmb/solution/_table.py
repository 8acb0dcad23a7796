"""Signals of a solution as a table."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from fricmb.errors import SceneError, shown

if TYPE_CHECKING:
    import pandas

    from fricmb.integrate.problem import Codes, Floats
    from fricmb.solution._signals import Signals


def columns(sol: Signals, names: Iterable[str] | None = None) -> dict[str, Floats | Codes]:
    """Signals (n_t,) by name, those named or all that the run holds.

    ``"pad.x"``, ``"pad.x.velocity"`` (points of modal bodies too), ``"lining.force.x"``,
    ``"lining.relative_velocity.x"``, ``"lining.normal_force"``, ``"lining.mode"``, ``"lining.state.z"``.
    """
    if names is None:
        return _all_columns(sol)
    if isinstance(names, str) or not isinstance(names, Iterable):
        raise SceneError(f"names: got {shown(names)}; expected a list of names of signals")
    return {name: sol.scalar(name, "names") for name in names}


def _all_columns(sol: Signals) -> dict[str, Floats | Codes]:
    table: dict[str, Any] = {}
    for name in (*sol.names.dofs, *sol.names.motions):
        table[name] = sol[name]
        table[f"{name}.velocity"] = sol.velocity(name)
    for k, contact in enumerate(sol.names.contacts):
        force, relative = sol.force(contact), sol.relative_velocity(contact)
        for i, axis in enumerate(sol.names.directions[k]):
            table[f"{contact}.force.{axis}"] = force[i]
            table[f"{contact}.relative_velocity.{axis}"] = relative[i]
        table[f"{contact}.normal_force"] = sol.normal_force(contact)
        table[f"{contact}.mode"] = sol.mode(contact)
        for label, values in zip(sol.names.states[k], sol.state(contact), strict=True):
            table[f"{contact}.state.{label}"] = values
    return table


def table(sol: Signals, names: Iterable[str] | None = None) -> pandas.DataFrame:
    """Signals over time, the index being ``t``."""
    try:
        import pandas
    except ImportError as error:
        raise ImportError('to_pandas needs pandas: pip install "fricmb[pandas]"') from error
    return pandas.DataFrame(columns(sol, names), index=pandas.Index(sol.t, name="t"))
