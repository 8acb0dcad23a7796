"""One place of a study: steady sliding with one set of values, and its eigenvalues."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fricmb.analysis import AnalysisError, SteadySliding
from fricmb.analysis._eigenvalues import growing, steady_at
from fricmb.errors import FricmbError
from fricmb.integrate.run.one_thread import one_thread
from fricmb.scene import Element, ModalBody
from fricmb.values import value_of

if TYPE_CHECKING:
    from fricmb.scene import Scene

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

#: Imaginary part, beside the largest eigenvalue, up to which an eigenvalue counts as real.
_REAL = 1e-12
#: Modes a little above the highest are kept for the following of those below it.
_MARGIN = 1.02


@dataclass(frozen=True, kw_only=True)
class Place:
    """Steady sliding and its modes with one set of values.

    Attributes
    ----------
    eigenvalues : (n_modes,) complex
        Oscillations once, with Im > 0; by rising frequency.
    shapes : (n_modes, n_dof) complex
        Displacements of the free degrees of freedom, unit length.
    dofs : list of str
        Names of these.
    normal, slip, friction : (n_contacts,)
        Normal force, speed of slip and size of the friction force of each contact.
    why : str
        Why there is no steady sliding; "" where there is.
    """

    eigenvalues: Complexes
    shapes: Complexes
    dofs: list[str]
    normal: Floats
    slip: Floats
    friction: Floats
    why: str = ""

    @property
    def grows(self) -> NDArray[np.bool_]:
        """Which modes grow (n_modes,)."""
        return growing(self.eigenvalues)

    @property
    def worst(self) -> int:
        """The mode that grows most, or decays least."""
        return int(np.argmax(self.eigenvalues.real))


@dataclass(frozen=True, kw_only=True)
class Places:
    """What makes the places of a study, here or in a worker.

    Parameters
    ----------
    scene : Scene
    speeds : dict of str to float
    highest : float
        Angular frequency above which modes are left out.
    """

    scene: Scene
    speeds: Mapping[str, float]
    highest: float

    def steady(self, values: Mapping[str, float]) -> SteadySliding:
        """Steady sliding with some values changed.

        Raises
        ------
        AnalysisError
            If there is none.
        """
        return steady_at(self.scene, values, self.speeds)

    def run(self, parameters: Mapping[str, Any]) -> dict[str, Any] | FricmbError:
        """A place as plain data; where the values cannot be, why."""
        with one_thread():
            return self._run(parameters)

    def _run(self, parameters: Mapping[str, Any]) -> dict[str, Any]:
        try:
            steady = self.steady(parameters)
        except AnalysisError as error:
            nothing = np.zeros(0)
            return {
                "eigenvalues": np.zeros(0, complex), "shapes": np.zeros((0, 0), complex), "dofs": [],
                "normal": nothing, "slip": nothing, "friction": nothing, "why": str(error),
            }  # fmt: skip
        values, vectors = steady.eigenpairs()
        kept = self.kept(values)
        dofs = [steady.system.dof_names[i] for i in steady.free]
        shapes = vectors[kept, : len(dofs)]
        sizes = np.linalg.norm(shapes, axis=1)[:, None]
        rows = [steady.force(name) for name in steady.system.contact_names]
        return {
            "eigenvalues": values[kept],
            "shapes": np.divide(shapes, sizes, out=np.zeros_like(shapes), where=sizes > 0.0),
            "dofs": dofs,
            "normal": np.asarray(steady.at.N),
            "slip": np.asarray(steady.at.r),
            "friction": np.array([float(np.linalg.norm(F)) for F in rows]),
            "why": "",
        }

    def kept(self, values: Complexes) -> NDArray[np.int64]:
        """Places of the eigenvalues that a study keeps, by rising frequency."""
        real = _REAL * float(np.abs(values).max(initial=0.0))
        found = np.flatnonzero((values.imag >= -real) & (values.imag <= _MARGIN * self.highest))
        order = np.lexsort((values[found].real, values[found].imag))
        kept: NDArray[np.int64] = found[order]
        return kept


def check_friction(who: str, scene: Scene) -> None:
    """Refuse a scene without friction: parts, or matrices and forces that may stand for it (of FE, of a user)."""
    forces = (part for part in scene.parts if isinstance(part, Element))
    if scene.frictional or scene.matrices or any(type(f).define_force is not Element.define_force for f in forces):
        return
    raise AnalysisError(
        f"{who}: nothing slides in scene {scene.name!r}: it has no contact, no joint with friction, and no matrix or"
        " force that may stand for one"
    )


def true_modes(scene: Scene) -> float:
    """Angular frequency up to which modes of reduced bodies are modes."""
    found = [
        float(np.max(value_of(body.frequencies)[: body.n_modes - body.residual]))
        for body in scene.parts
        if isinstance(body, ModalBody) and 0 < body.residual < body.n_modes
    ]
    return min(found, default=np.inf)
