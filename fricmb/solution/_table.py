"""A solution as a pandas table."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas

    from fricmb.integrate.problem import Codes, Floats
    from fricmb.solution._solution import Solution


def columns(sol: Solution) -> dict[str, Floats | Codes]:
    """Every signal (n_t,) by the name of its column.

    ``"pad.x"``, ``"pad.x.velocity"`` (points of modal bodies too), ``"lining.force.x"``,
    ``"lining.relative_velocity.x"``, ``"lining.normal_force"``, ``"lining.mode"``, ``"lining.state.z"``.
    """
    table: dict[str, Floats | Codes] = {}
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


def table(sol: Solution) -> pandas.DataFrame:
    """All signals over time, the index being ``t``."""
    try:
        import pandas
    except ImportError as error:
        raise ImportError('to_pandas needs pandas: pip install "fricmb[pandas]"') from error
    return pandas.DataFrame(columns(sol), index=pandas.Index(sol.t, name="t"))
