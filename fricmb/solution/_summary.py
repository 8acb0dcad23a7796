"""Solutions in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fricmb.integrate import OPEN, STICK
from fricmb.integrate.event_kinds import OF_CONTACTS
from fricmb.solution._run import Run
from fricmb.values import DIMENSIONS, counted

if TYPE_CHECKING:
    from fricmb.solution._solution import Solution


def describe(sol: Solution) -> str:
    """One line."""
    return (
        f"<Solution: {_freedom(sol)}, {counted(len(sol.names.contacts), 'contact')}, t = {sol.t_start:g} to "
        f"{sol.t_end:g}, {counted(sol.t.size, 'time')}, {counted(len(sol.events), 'event')}, method {sol.stats.method}>"
    )


def summarise(sol: Solution) -> str:
    """A few lines: transitions, stick share, energy and where it went, cost, notes."""
    stats, energy = sol.stats, sol.energy
    lines = [
        f"t = {sol.t_start:g} to {sol.t_end:g}, {_freedom(sol)}",
        f"method       {stats.method}" + (f" ({stats.why})" if stats.why else ""),
    ]
    lines += _contacts(sol)

    def number(value: float) -> str:
        return f"{value:.6g}" if abs(value) > 1e-13 * energy.reference.largest else "0"

    if sol.t.size:
        lines.append(
            f"energy       {number(energy.reference.start)} at the start, {number(energy.total[-1])} at the end; "
            f"friction {number(energy.friction_loss[-1])}, damping {number(energy.damping_loss[-1])}, "
            f"{f'impacts {number(energy.impact_loss[-1])}, ' if energy.impact_loss[-1] else ''}"
            f"input {number(energy.input[-1])}{_unit(sol)}; ledger residual {np.abs(energy.residual).max():.1e}"
        )
    lines.append(
        f"cost         {stats.n_steps} steps, {stats.n_rejected} rejected, {stats.n_rhs} right-hand sides, "
        f"{stats.n_lu} factorisations; {stats.wall_s:.3g} s"
        + (f", of which {stats.compile_s:.3g} s compiling or loading" if stats.compile_s > 0.001 else "")
    )
    lines += [f"note         {note}" for note in stats.notes]
    return "\n".join(lines)


def _unit(sol: Solution) -> str:
    """Unit of energies, where the scene names one."""
    return "" if sol.units.dimensionless or sol.units == DIMENSIONS else f" {sol.units.energy}"


def _freedom(sol: Solution) -> str:
    """Degrees of freedom; of a mechanism those that constraints leave, beside its coordinates."""
    n = len(sol.names.dofs)
    opened = sol._run if isinstance(sol._run, Run) else None
    free = None if opened is None else opened.pieces[0].mechanics.freedom(sol.record.samples)
    if free is None:
        return counted(n, "degree of freedom", "degrees of freedom")
    return f"{counted(free, 'degree of freedom', 'degrees of freedom')} ({counted(n, 'coordinate')})"


def _contacts(sol: Solution) -> list[str]:
    """A line for each contact, or one for all where they are many."""
    names = sol.names.contacts
    groups = [(name,) for name in names] if len(names) <= MANY else [names]
    lines = []
    for group in groups:
        only = group[0] if len(group) == 1 else None
        numbers = {kind: len(sol.events.of(kind=kind, contact=only)) for kind in OF_CONTACTS}
        counts = [f"{number} {kind}" for kind, number in numbers.items() if number]
        places = [names.index(name) for name in group]
        lost = f"{_lost(sol, places):.6g}{_unit(sol)}" if sol.t.size else "nothing"
        lines.append(
            (f"contact      {group[0]}: " if len(group) == 1 else f"contacts     {len(group)}: ")
            + (", ".join(counts) or "no transitions")
            + f"; stick {_share(sol, group, STICK)} of the time"
            + (f", open {opened}" if (opened := _share(sol, group, OPEN)) != "0.0%" else "")
            + (f", at rest without sticking {rest:.1%}" if only and (rest := sol.rest_share(only)) >= 5e-4 else "")
            + f"; {lost} lost to friction"
        )
    return lines


def _lost(sol: Solution, places: list[int]) -> float:
    """Energy that contacts have lost to friction at the end."""
    return float(sol.energy.friction_loss_by_contact[places, -1].sum())


def _share(sol: Solution, group: tuple[str, ...], mode: int) -> str:
    shares = sol.time_shares(mode)[[sol.names.contact(name) for name in group]]
    low, high = f"{shares.min():.1%}", f"{shares.max():.1%}"
    return low if low == high else f"{low} to {high}"


#: More contacts than this are summed up in one line.
MANY = 8
