"""Energy by mode of the structure, and the power that flows into each: which mode squeals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import eigh

from fricmb._calls import answers
from fricmb.analysis._errors import AnalysisError, Floats, checked_kind
from fricmb.analysis._linearise import stiffness_without_friction
from fricmb.analysis._losses import motion_of, one_scene, whole_system
from fricmb.analysis._quadrature import cumulated, grid, nodes, refined
from fricmb.analysis._steady import SteadySliding
from fricmb.system import System

if TYPE_CHECKING:
    from fricmb.solution import Solution


@dataclass(frozen=True, kw_only=True)
class ModalEnergy:
    """Energy in each mode of the structure without friction, and where it came from.

    Attributes
    ----------
    t : (n_t,)
    omega : (n_modes,)
        Angular frequencies, rising.
    shapes : (n_dof, n_modes)
        Of unit modal mass, order of ``dofs``.
    dofs : tuple of str
    energy : (n_modes, n_t)
        ``(eta'^2 + omega^2 eta^2)/2`` of each mode.
    friction : (n_modes, n_t)
        Energy that friction brought into each mode since the start (negative: took).
    damping : (n_modes, n_t)
        Energy that linear damping took from each mode.
    other : (n_modes, n_t)
        The rest: what driven bodies, loads, nonlinear and non-symmetric elements and load changes brought.
    """

    t: Floats
    omega: Floats
    shapes: Floats
    dofs: tuple[str, ...]
    energy: Floats
    friction: Floats
    damping: Floats
    other: Floats

    @property
    def squealing(self) -> int:
        """Index of the vibrating mode to which friction brought most energy."""
        fed = np.where(self.omega > 0.0, self.friction[:, -1], -np.inf)
        if not np.isfinite(fed).any():
            raise AnalysisError("modal_energy: no mode vibrates")
        return int(np.argmax(fed))

    def power(self, k: int) -> Floats:
        """Mean power of friction into mode k on the stretches between the times (n_t - 1,)."""
        return np.asarray(np.diff(self.friction[k]) / np.diff(self.t))

    def name(self, k: int) -> str:
        """Degree of freedom that moves most in mode k."""
        return self.dofs[int(np.argmax(np.abs(self.shapes[:, k])))]

    def __str__(self) -> str:
        lines = [f"{'mode':>4} {'omega':>10} {'friction':>12} {'damping':>12} {'other':>12}  moves most"]
        lines += [
            f"{k:4d} {self.omega[k]:10.4g} {self.friction[k, -1]:+12.4g} {-self.damping[k, -1]:+12.4g}"
            f" {self.other[k, -1]:+12.4g}  {self.name(k)}"
            for k in range(len(self.omega))
        ]
        return "\n".join(lines)


@answers
def modal_energy(sol: Solution, *, around: SteadySliding | None = None) -> ModalEnergy:
    """Energy of each mode of the structure, and the energy that friction brings to it.

    Parameters
    ----------
    sol : Solution
    around : SteadySliding, optional
        Count displacements and friction from this equilibrium: then the vibration alone is seen, and what friction
        brings is what feeds it.  Default: from q = 0, static deflection included.

    Returns
    -------
    ModalEnergy

    Raises
    ------
    AnalysisError
        For a run that was joined from different scenes, or an equilibrium of another.

    Notes
    -----
    Modes are those of the mass matrix and the symmetric stiffness at the equilibrium, contact stiffness included,
    without friction.  Frequencies that are round-off or belong to negative stiffness count as 0.
    """
    one_scene(sol, "modal_energy")
    system = whole_system(sol, "modal_energy")
    if around is not None:
        checked_kind("modal_energy", "around", around, SteadySliding, "what steady_sliding returns")
    if around is not None and around.system.dof_names != system.dof_names:
        raise AnalysisError("modal_energy: around is the equilibrium of another scene")
    n = system.problem.n
    q0 = np.zeros(n) if around is None else around.q
    F0 = np.zeros(system.problem.m) if around is None else around.at.F
    K = stiffness_without_friction(system, q0, np.zeros(n))
    values, shapes = eigh(K, system.problem.linear.M)
    omega = np.sqrt(np.where(values > 1e-13 * np.abs(values).max(initial=0.0), values, 0.0))
    return _flows(system, sol, omega, shapes, q0, F0)


def _flows(system: System, sol: Solution, omega: Floats, shapes: Floats, q0: Floats, F0: Floats) -> ModalEnergy:
    """Modal energies at times between which powers are smooth, and the integrals of powers between them."""
    problem, n = system.problem, system.problem.n
    to_modes = shapes.T @ problem.linear.M

    def powers(seen: Solution) -> Floats:
        """What friction brings and damping takes (2 n, n_t), by mode."""
        v = motion_of(system, seen)[1]
        F = np.concatenate([seen.force(name) for name in system.contact_names] or [np.zeros((0, seen.t.size))])
        pull = shapes.T @ problem.contacts.W @ (F - F0[:, None])
        drag = shapes.T @ problem.linear.Cx[:n, :n] @ v
        return np.vstack([pull, drag]) * np.tile(to_modes @ v, (2, 1))

    t = refined(sol, grid(sol), powers, "modal_energy")
    q, v = motion_of(system, sol.at(t))
    eta, rate = to_modes @ (q - q0[:, None]), to_modes @ v
    energy = 0.5 * (rate**2 + (omega[:, None] * eta) ** 2)
    friction, damping = np.split(cumulated(t, powers(sol.at(nodes(t)))), 2)
    return ModalEnergy(
        t=t,
        omega=omega,
        shapes=shapes,
        dofs=system.dof_names,
        energy=energy,
        friction=friction,
        damping=damping,
        other=energy - energy[:, :1] - friction + damping,
    )
