"""Who lost how much, where: friction by contact, direction and phase, damping by element, energy by mode."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb._calls import answers
from fricmb.analysis._errors import AnalysisError, Floats, checked_solution
from fricmb.analysis._quadrature import cumulated, grid, nodes, refined
from fricmb.errors import unknown_name
from fricmb.integrate.model.table_values import arguments, evaluate
from fricmb.integrate.problem import NORMAL_LAW
from fricmb.scene import Contact, Element, MatrixElement, ModalBody, Scene
from fricmb.system import System, build

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: A power (n_t,) at the times at which a run is seen.
Power = Callable[["Solution"], Floats]


@dataclass(frozen=True, kw_only=True)
class Phase:
    """One stretch of a contact between two transitions.

    Attributes
    ----------
    begin, end : float
    mode : int
        0 stick, 1 slip, 2 open.
    loss : (d,)
        Energy lost to friction along each tangential direction.
    """

    begin: float
    end: float
    mode: int
    loss: Floats


class EnergyLedger:
    """The energy ledger of a run in detail; made by :func:`energy_ledger`.

    Attributes
    ----------
    t : (n_t,)
        Ends of the stretches over which powers were integrated; transitions are among them.
    friction : dict of str to (d, n_t)
        Energy lost to friction since the start, by contact and tangential direction.
    damping : dict of str to (n_t,)
        Energy lost to damping since the start, by element, modal body, or contact whose normal force is damped.
    """

    def __init__(self, sol: Solution) -> None:
        self.sol = sol
        damping = dict(_damping_powers(sol))
        self.t = refined(sol, grid(sol), partial(_sums, list(damping.values())), "energy_ledger")
        seen = sol.at(nodes(self.t))
        self.friction = {name: cumulated(self.t, _friction_power(seen, name)) for name in sol.contact_names}
        powers = ((name, power(seen)) for name, power in damping.items())
        self.damping = {name: cumulated(self.t, power[None])[0] for name, power in powers if power.any()}

    def phases(self, contact: str) -> list[Phase]:
        """Stretches of a contact between its transitions, with what each lost."""
        if contact not in self.friction:
            raise unknown_name("contact", contact, self.friction)
        events = self.sol.events.of(contact=contact).t
        bounds = np.unique(np.concatenate([self.t[:1], events, self.t[-1:]]))
        places = np.searchsorted(self.t, bounds)
        loss = self.friction[contact]
        modes = self.sol.at(0.5 * (bounds[:-1] + bounds[1:])).mode(contact)
        return [
            Phase(begin=float(a), end=float(b), mode=int(mode), loss=loss[:, j] - loss[:, i])
            for a, b, i, j, mode in zip(bounds[:-1], bounds[1:], places[:-1], places[1:], modes, strict=True)
        ]

    @cached_property
    def stored(self) -> dict[str, Floats]:
        """Energy stored in each spring, modal body or pressed contact, by name (n_t,)."""
        system, seen = whole_system(self.sol, "energy_ledger"), self.sol.at(self.t)
        q, v = motion_of(system, seen)
        return system.potentials(replace(seen.record.samples, q=q, v=v))

    def __str__(self) -> str:
        lines = ["lost to friction"]
        for name, loss in self.friction.items():
            axes = self.sol.names.axes(name)
            parts = ", ".join(f"{axis} {value:.6g}" for axis, value in zip(axes, loss[:, -1], strict=True))
            lines.append(f"  {name}: {loss[:, -1].sum():.6g} ({parts})")
        lines += ["lost to damping"] if self.damping else []
        lines += [f"  {name}: {loss[-1]:.6g}" for name, loss in self.damping.items()]
        return "\n".join(lines)


@answers
def energy_ledger(sol: Solution) -> EnergyLedger:
    """Energy losses of a run, part by part and phase by phase.

    Parameters
    ----------
    sol : Solution
        With its dense output; a joined run only if its scenes agree.

    Returns
    -------
    EnergyLedger

    Raises
    ------
    AnalysisError
        For a run that was joined from different scenes, or that vibrates too often to be followed.

    Notes
    -----
    Powers are integrated by Gauss's rule of four nodes on the stretches between the accepted steps and transitions, cut
    to at least 4000, and again until cutting them changes nothing: a method may step over many vibrations at once.  The
    sums agree with ``sol.energy`` to the accuracy of the run.
    """
    one_scene(sol, "energy_ledger")
    return EnergyLedger(sol)


def one_scene(sol: Solution, who: str) -> None:
    """Raise AnalysisError for a run that was joined from different scenes."""
    checked_solution(who, sol)
    scenes = [piece.origin.scene for piece in sol.run.pieces]
    if any(scene != scenes[0] for scene in scenes[1:]):
        raise AnalysisError(f"{who}: the run was joined from different scenes; take them one by one")


def whole_system(sol: Solution, who: str) -> System:
    """The system of everything that was run, driven bodies where they were.

    Raises AnalysisError for a run that left something out.
    """
    placed = sol.run.pieces[-1].mechanics.placed  # type: ignore[attr-defined]
    if placed.is_mechanism:
        raise AnalysisError(
            f"{who}: does not take scenes with joints or bodies that turn; sol.energy has the ledger of such a run"
        )
    system = build(placed)
    missing = [name for name in system.dof_names if name not in sol.names.dof_index]
    if missing:
        raise AnalysisError(f"{who}: the run left {missing[0]} out (observe=); run all of it")
    return system


def motion_of(system: System, seen: Solution) -> tuple[Floats, Floats]:
    """Q and v (n, n_t) in the order of a system."""
    places = [seen.names.dof_index[name] for name in system.dof_names]
    return seen.q[places], seen.v[places]


def _sums(damping: list[Power], seen: Solution) -> Floats:
    """What friction and damping take (2, n_t) in all."""
    found = np.zeros((2, seen.t.size))
    for name in seen.contact_names:
        found[0] += _friction_power(seen, name).sum(axis=0)
    for power in damping:
        found[1] += power(seen)
    return found


def _friction_power(seen: Solution, contact: str) -> Floats:
    return -seen.force(contact) * seen.relative_velocity(contact)


def _damping_powers(sol: Solution) -> Iterator[tuple[str, Power]]:
    """What takes energy by damping, by name."""
    scene = sol.run.pieces[-1].mechanics.placed  # type: ignore[attr-defined]
    for part in scene.parts:
        if isinstance(part, Element | ModalBody | MatrixElement):
            power = _element_power(scene, part, sol)
        elif isinstance(part, Contact) and part.normal_kind == "law":
            power = _pressing_power(sol, part.name)
        else:
            continue
        if power is not None:
            yield part.name, power


def _element_power(scene: Any, part: Any, sol: Solution) -> Power | None:
    """Dissipated power (n,) of one element: of a scene that holds it and its ends alone."""
    small = _alone(scene, part)
    if small is None:
        return None
    system = build(small)
    problem = system.problem
    if any(name not in sol.names.dof_index for name in system.dof_names):
        return None  # left out of the run: it does not move

    def power(seen: Solution) -> Floats:
        q, v = motion_of(system, seen)
        u = system.signals(seen.t)
        rates = np.concatenate([v, u[1]])
        found: Floats = np.einsum("it,it->t", rates, problem.linear.Cx @ rates)
        elements = problem.elements
        X = np.concatenate([seen.t[None], q, v, u[0], u[1]])
        for k in range(len(elements.table.address)):
            n_f = int(elements.f_start[k + 1] - elements.f_start[k])
            x = arguments(elements.table, k, X)
            at = n_f * (1 + x.shape[1])
            found = found + evaluate(elements.table, k, x, at + 3)[at + 1]
        return found

    return power


def _alone(scene: Any, part: Any) -> Any:
    """A scene of one part and the bodies it is tied to; None for a part that cannot dissipate."""
    if isinstance(part, ModalBody):
        return Scene("alone", [part])
    if isinstance(part, MatrixElement):
        if part.C is None:
            return None
        owners = {name.partition(".")[0] for name in part.dofs}
        bare = MatrixElement(part.name, part.dofs, C=part.C, scale=part.scale)
        return with_ends(scene, owners, bare)
    forms = part.local_coordinates()
    owners = {motion.partition(".")[0] for form in forms for motion in form.motions}
    return with_ends(scene, owners, part)


def with_ends(scene: Any, owners: set[str], part: Any) -> Any:
    """A scene of a part and bodies by name, modal ones without their own damping."""
    bodies = [body for body in scene.parts if body.name in owners]
    small = Scene("alone", [*bodies, part])
    for body in bodies:
        if isinstance(body, ModalBody):
            small = small.replace(body.name, damping_ratios=0.0, damping=None)
    return small


def _pressing_power(sol: Solution, contact: str) -> Power | None:
    """Dissipated power of a damped normal-force law: -(N - N0 + dV/de) e'."""
    system = whole_system(sol, "energy_ledger")
    contacts = system.problem.contacts
    k = system.contact_names.index(contact)
    if contacts.normal[k] != NORMAL_LAW:
        return None

    def power(seen: Solution) -> Floats:
        u = system.signals(seen.t)
        X = np.concatenate([seen.t[None], *motion_of(system, seen), u[0], u[1]])
        x = arguments(contacts.normal_table, k, X)
        out = evaluate(contacts.normal_table, k, x, 5)
        found: Floats = -(np.maximum(out[0], 0.0) - contacts.N0[k] + out[4]) * x[:, 1]
        return found

    return power
