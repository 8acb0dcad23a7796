"""Modal data of the built-in pad and rotor: ``python tools/pad_rotor_modes.py`` writes models/data/pad_rotor.npz.

Both are plane-stress plates in elements of second order (scikit-fem).  The rotor is an annulus of cast iron whose
inner edge is held by a rigid hub that turns about its axis with an inertia of its own (the bench behind it).  The pad
is an annular sector of friction material on a steel back plate, held at its two radial edges by springs along both
directions.  Displacements are stored on a grid of radii and angles under the pad, as tangential and radial components.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import scipy.sparse as sp
import skfem
from scipy.sparse.linalg import eigsh
from scipy.spatial import KDTree
from skfem.models.elasticity import linear_elasticity

OUT = Path(__file__).parents[1] / "models" / "data" / "pad_rotor.npz"

#: SI units.  Solid rotor of cast iron, friction material, steel back plate.
ROTOR = {"inner": 0.075, "outer": 0.140, "thickness": 0.020, "young": 110e9, "poisson": 0.27, "density": 7200.0}
PAD = {"inner": 0.095, "outer": 0.137, "angle": np.deg2rad(50.0)}
LINING = {"thickness": 0.011, "young": 8e9, "poisson": 0.25, "density": 2600.0}
PLATE = {"thickness": 0.005, "young": 210e9, "poisson": 0.29, "density": 7850.0}
#: Stiffness of the mounting along the tangent and along the radius, both edges together (N/m).
MOUNTING = {"tangential": 6.0e7, "radial": 3.0e7}
#: Inertia of the bench that the hub carries (kg m^2).
HUB_INERTIA = 0.30
MODES = 40
RADII, ANGLES = 7, 15


def sector(radii: np.ndarray, angles: np.ndarray) -> skfem.MeshQuad2:
    """Quadrilaterals with curved edges between given radii and angles."""
    flat = skfem.MeshQuad.init_tensor(radii, angles)
    mesh = skfem.MeshQuad2.from_mesh(flat)
    r, phi = mesh.doflocs
    return skfem.MeshQuad2(np.array([r * np.cos(phi), r * np.sin(phi)]), mesh.t)


def assemble(basis: skfem.Basis, layers: list[dict[str, float]]) -> tuple[sp.csr_matrix, sp.csr_matrix]:
    """Mass and stiffness of layers bonded together, in plane stress."""

    @skfem.BilinearForm
    def inertia(u, v, _):
        return u[0] * v[0] + u[1] * v[1]

    M = K = 0
    mass = inertia.assemble(basis)
    for layer in layers:
        E, nu, h = layer["young"], layer["poisson"], layer["thickness"]
        form = linear_elasticity(E * nu / (1 - nu**2), E / (2 * (1 + nu)))
        K = K + h * form.assemble(basis)
        M = M + h * layer["density"] * mass
    return sp.csr_matrix(M), sp.csr_matrix(K)


def lowest(M, K, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and modes of unit modal mass."""
    shift = -1e-6 * K.diagonal().sum() / M.diagonal().sum()
    w2, modes = eigsh(sp.csc_matrix(K), k=count, M=sp.csc_matrix(M), sigma=shift, which="LM")
    order = np.argsort(w2)
    w2 = np.where(np.abs(w2[order]) < 1e-6 * w2.max(), 0.0, w2[order])
    return np.sqrt(w2), modes[:, order]


def polar(basis: skfem.Basis, modes: np.ndarray, r: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Tangential and radial displacement at points that are nodes (2, n_points, n_modes)."""
    here = basis.doflocs
    parts = []
    for component in basis.split_indices():
        tree = KDTree(here[:, component].T)
        away, nearest = tree.query(np.array([r * np.cos(phi), r * np.sin(phi)]).T)
        assert away.max() < 1e-9
        parts.append(modes[component[nearest]])
    c, s = np.cos(phi)[:, None], np.sin(phi)[:, None]
    return np.array([-s * parts[0] + c * parts[1], c * parts[0] + s * parts[1]])


def rotor_modes(radii: np.ndarray, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (first 0: rotation) and shapes (2, n_points, n_modes) at the grid."""
    around = np.linspace(angles[-1], angles[0] + 2 * np.pi, 80)
    mesh = sector(np.concatenate([[ROTOR["inner"], 0.085], radii, [ROTOR["outer"]]]), np.r_[angles[:-1], around])
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2()))
    M, K = assemble(basis, [ROTOR])
    x, y = basis.doflocs
    # the cut is closed, and the inner edge turns with the hub: q = T (free dofs, hub angle)
    radius = np.hypot(x, y)
    inner = radius < ROTOR["inner"] + 1e-9
    component = _component(basis)
    tangent = np.where(component == 0, -y, x)
    key = np.round(np.array([x, y, component]), 9).T
    _, first, same = np.unique(key, axis=0, return_index=True, return_inverse=True)
    same = np.ravel(same)
    free = ~inner[first]
    column = np.cumsum(free) - 1
    rows = np.arange(basis.N)
    outside = free[same]
    T = sp.coo_matrix(
        (
            np.concatenate([np.ones(outside.sum()), tangent[~outside]]),
            (
                np.concatenate([rows[outside], rows[~outside]]),
                np.concatenate([column[same[outside]], np.full((~outside).sum(), free.sum())]),
            ),
        )
    ).tocsr()
    hub = sp.coo_matrix(([HUB_INERTIA], ([free.sum()], [free.sum()])), shape=(T.shape[1],) * 2)
    omega, modes = lowest(T.T @ M @ T + hub, T.T @ K @ T, MODES + 1)
    return omega, polar(basis, T @ modes, *grid(radii, angles))


def _component(basis: skfem.Basis) -> np.ndarray:
    """0 or 1: the direction of each degree of freedom."""
    found = np.empty(basis.N, dtype=int)
    found[basis.split_indices()[0]] = 0
    found[basis.split_indices()[1]] = 1
    return found


def grid(radii: np.ndarray, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points of the grid, angle by angle within each radius."""
    r, phi = np.meshgrid(radii, angles, indexing="ij")
    return r.ravel(), phi.ravel()


def pad_modes(radii: np.ndarray, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and shapes (2, n_points, n_modes) at the grid."""
    mesh = sector(radii, angles)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2()))
    M, K = assemble(basis, [LINING, PLATE])

    def at_edge(x):
        angle = np.arctan2(x[1], x[0])
        return (np.abs(angle - angles[0]) < 1e-9) | (np.abs(angle - angles[-1]) < 1e-9)

    edges = skfem.FacetBasis(
        mesh, skfem.ElementVector(skfem.ElementQuad2()), facets=mesh.facets_satisfying(at_edge, boundaries_only=True)
    )
    length = 2 * (PAD["outer"] - PAD["inner"])

    @skfem.BilinearForm
    def springs(u, v, w):
        r = np.hypot(w.x[0], w.x[1])
        c, s = w.x[0] / r, w.x[1] / r
        along = (-s * u[0] + c * u[1]) * (-s * v[0] + c * v[1]) * MOUNTING["tangential"]
        return (along + (c * u[0] + s * u[1]) * (c * v[0] + s * v[1]) * MOUNTING["radial"]) / length

    omega, modes = lowest(M, K + sp.csr_matrix(springs.assemble(edges)), MODES)
    return omega, polar(basis, modes, *grid(radii, angles))


def main() -> None:
    """Compute and write."""
    radii = np.linspace(PAD["inner"], PAD["outer"], RADII)
    angles = np.linspace(-0.5, 0.5, ANGLES) * PAD["angle"]
    pad, pad_shapes = pad_modes(radii, angles + np.pi / 2)
    rotor, rotor_shapes = rotor_modes(radii, angles + np.pi / 2)
    centred(rotor, rotor_shapes, (RADII // 2) * ANGLES + ANGLES // 2)
    shape = (2, RADII, ANGLES, -1)
    np.savez_compressed(
        OUT,
        radii=radii,
        angles=angles,
        pad_frequencies=pad,
        pad_shapes=_signed(pad_shapes).reshape(shape).astype(np.float32),
        rotor_frequencies=rotor,
        rotor_shapes=_signed(rotor_shapes).reshape(shape).astype(np.float32),
    )
    print(f"{OUT.stat().st_size / 1e3:.0f} kB; pad {pad[:6] / 2 / np.pi} Hz; rotor {rotor[:8] / 2 / np.pi} Hz")


def centred(omega: np.ndarray, shapes: np.ndarray, middle: int) -> None:
    """Turn doublets so that the first of two is even in the radial motion about the middle of the pad."""
    for j in np.flatnonzero(np.diff(omega) < 1e-5 * omega[1:]):
        a, b = shapes[1, middle, j], shapes[1, middle, j + 1]
        first, second = shapes[..., j].copy(), shapes[..., j + 1].copy()
        size = np.hypot(a, b)
        shapes[..., j], shapes[..., j + 1] = (a * first + b * second) / size, (a * second - b * first) / size


def _signed(shapes: np.ndarray) -> np.ndarray:
    """Modes with the largest component positive: the file is the same on every machine but for doublets."""
    flat = shapes.reshape(-1, shapes.shape[-1])
    sign = np.sign(flat[np.abs(flat).argmax(axis=0), np.arange(flat.shape[1])])
    return shapes * sign


if __name__ == "__main__":
    main()
