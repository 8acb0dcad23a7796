"""Mass and stiffness of a linear-elastic finite element mesh, through scikit-fem (extra ``fem``)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fricmb.errors import MissingExtraError, SceneError, shown
from fricmb.reduction._modes import Floats

#: Vector element of second order for each kind of mesh that is taken.
ELEMENTS = {
    "MeshTri1": "ElementTriP2",
    "MeshQuad1": "ElementQuad2",
    "MeshTet1": "ElementTetP2",
    "MeshHex1": "ElementHex2",
}


def mesh_matrices(
    label: str,
    mesh: Any,
    *,
    young: float,
    poisson: float,
    density: float,
    thickness: float,
    plane: str,
    fixed: Any,
    points: Mapping[str, Any],
) -> tuple[Any, Any, dict[str, Floats]]:
    """Sparse M and K over the free degrees of freedom, and the rows of the points.

    Parameters
    ----------
    label : str
        Who asks, for messages.
    mesh : skfem.Mesh
        Triangles, quadrilaterals, tetrahedra or hexahedra; elements are of second order.
    young, poisson, density : float
    thickness : float
        Of a plane mesh.
    plane : {"stress", "strain"}
    fixed : str, callable or None
        Boundary that is held: its name in the mesh, or a function of coordinates (d, n) that says where; None: free.
    points : dict of str to (d,)
        Coordinates inside the mesh.

    Raises
    ------
    SceneError
    ImportError
        Without scikit-fem.
    """
    fem = _library()
    basis = _basis(label, fem, mesh)
    K, M = _assembled(fem, basis, young, poisson, density, plane)
    if mesh.dim() == 2:
        K, M = thickness * K, thickness * M
    free = np.arange(basis.N)
    if fixed is not None:
        held = _held(label, mesh, basis, fixed)
        free = np.setdiff1d(free, held)
    rows = {name: _point_rows(label, mesh, basis, name, at)[:, free] for name, at in points.items()}
    return M[free][:, free].tocsr(), K[free][:, free].tocsr(), rows


def _library() -> Any:
    try:
        import skfem
        import skfem.models.elasticity
    except ImportError as error:
        raise MissingExtraError("ModalBody.from_mesh", "scikit-fem", "fem") from error
    return skfem


def _basis(label: str, fem: Any, mesh: Any) -> Any:
    kind = type(mesh).__name__
    if kind not in ELEMENTS:
        raise SceneError(f"{label}: mesh must be one of {', '.join(ELEMENTS)} of scikit-fem, got {kind}")
    return fem.Basis(mesh, fem.ElementVector(getattr(fem, ELEMENTS[kind])()))


def _assembled(fem: Any, basis: Any, young: float, poisson: float, density: float, plane: str) -> tuple[Any, Any]:
    elasticity = fem.models.elasticity
    if basis.mesh.dim() == 2 and plane == "stress":
        lame = young * poisson / (1.0 - poisson**2), young / (2.0 * (1.0 + poisson))
    else:
        lame = elasticity.lame_parameters(young, poisson)
    K = elasticity.linear_elasticity(*lame).assemble(basis)
    mass = fem.BilinearForm(lambda u, v, _: density * sum(u[i] * v[i] for i in range(basis.mesh.dim())))
    M = mass.assemble(basis)
    return 0.5 * (K + K.T), 0.5 * (M + M.T)


def _held(label: str, mesh: Any, basis: Any, fixed: Any) -> Any:
    if isinstance(fixed, str):
        known = sorted(mesh.boundaries or {})
        if fixed not in known:
            raise SceneError(f"{label}: fixed must be a boundary of the mesh; got {shown(fixed)}, it has {known}")
        return basis.get_dofs(fixed).flatten()
    if not callable(fixed):
        raise SceneError(f"{label}: fixed must be the name of a boundary, a function of coordinates, or None")
    held = basis.get_dofs(fixed).flatten()
    if not held.size:
        raise SceneError(f"{label}: fixed holds no part of the boundary")
    return held


def _point_rows(label: str, mesh: Any, basis: Any, name: str, at: Any) -> Floats:
    """Rows (d, n) that give the displacement at coordinates."""
    try:
        place = np.asarray(at, dtype=float)
    except (TypeError, ValueError):
        place = np.zeros(0)
    if place.shape != (mesh.dim(),):
        raise SceneError(f"{label}: points[{name!r}] must be {mesh.dim()} coordinates, got {shown(at)}")
    try:
        rows = basis.probes(place[:, None])
    except ValueError:
        raise SceneError(f"{label}: points[{name!r}] = {at!r} is outside the mesh") from None
    found: Floats = rows.toarray()
    return found
