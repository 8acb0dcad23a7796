"""Natural modes of a scene: its structure alone, with one set of values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.analysis._errors import AnalysisError, Floats
from fricmb.analysis._linearise import stiffness_without_friction
from fricmb.errors import unknown_name
from fricmb.system import build
from fricmb.values import DIMENSIONS, Units

if TYPE_CHECKING:
    from fricmb.scene import Scene


@dataclass(frozen=True, kw_only=True)
class NaturalModes:
    """Modes of the structure without friction, in rising order.

    Attributes
    ----------
    frequencies : (n,)
        Angular frequencies; 0 for a rigid motion, and for one of negative stiffness.
    damping_ratios : (n,)
        Parts of critical damping, from the diagonal of the modal damping matrix; 0 for rigid motions.
    shapes : (n_dof, n)
        Columns of modal mass 1.
    dofs : tuple of str
        Names of the rows of the shapes.
    units : Units
    """

    frequencies: Floats
    damping_ratios: Floats
    shapes: Floats
    dofs: tuple[str, ...]
    units: Units = DIMENSIONS

    def shape(self, name: str) -> Floats:
        """Displacement (n,) of a degree of freedom in each mode."""
        if name not in self.dofs:
            raise unknown_name("degree of freedom", name, self.dofs)
        found: Floats = self.shapes[self.dofs.index(name)]
        return found

    def __str__(self) -> str:
        lines = [f"{'mode':>4} {'angular frequency':>18} {'frequency':>12} {'damping ratio':>14}  moves most"]
        for i, (omega, zeta) in enumerate(zip(self.frequencies, self.damping_ratios, strict=True)):
            most = self.dofs[int(np.argmax(np.abs(self.shapes[:, i])))]
            lines.append(f"{i:4d} {omega:18.8g} {omega / (2 * np.pi):12.6g} {zeta:14.4g}  {most}")
        return "\n".join(lines)


def natural_modes(scene: Scene) -> NaturalModes:
    """See :meth:`fricmb.Scene.modes`."""
    from scipy.linalg import eigh

    if scene.is_mechanism:
        raise AnalysisError("modes: the scene has joints; complex_eigenvalues(scene) takes them into account")
    system: Any = build(scene)
    q, v = np.asarray(system.start.q), np.asarray(system.start.v)
    linear, n = system.problem.linear, len(q)
    M, C = np.asarray(linear.M, dtype=float), np.asarray(linear.Cx, dtype=float)[:n, :n]
    K = stiffness_without_friction(system, q, v)
    squared, shapes = eigh(K, M)
    still = np.abs(squared) <= 1e-12 * max(float(np.abs(squared).max(initial=0.0)), 1e-300)
    omega = np.sqrt(np.where(still | (squared < 0.0), 0.0, squared))
    damping = np.einsum("ij,ik,kj->j", shapes, C, shapes)
    ratio = np.where(omega > 0.0, damping / np.where(omega > 0.0, 2.0 * omega, 1.0), 0.0)
    return NaturalModes(
        frequencies=omega, damping_ratios=ratio, shapes=shapes, dofs=tuple(system.dof_names), units=scene.units
    )
