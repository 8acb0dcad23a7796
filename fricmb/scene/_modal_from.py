"""Modal bodies from matrices and meshes, and their complex modes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fricmb.errors import SceneError, shown
from fricmb.values import value_of

if TYPE_CHECKING:
    from fricmb.reduction import Reduced
    from fricmb.scene._modal import ModalBody


def from_matrices(
    cls: type[ModalBody], name: str, M: Any, K: Any, C: Any, points: Any, n_modes: int | None, axes: str, ratios: Any,
    residual: bool, fields: dict[str, Any],
) -> ModalBody:  # fmt: skip
    """See :meth:`ModalBody.from_matrices`."""
    from fricmb.reduction import reduce_matrices

    label = f"ModalBody {name!r}"
    if not isinstance(axes, str) or not axes:
        raise SceneError(f"{label}: axes must be any of 'x', 'y', 'z' in a string, got {shown(axes)}")
    if C is not None and ratios is not None:
        raise SceneError(f"{label}: give C or damping_ratios, not both")
    _check_points(label, points, residual)
    found = reduce_matrices(label, M, K, C, points, len(axes), n_modes, residual)
    return _body(cls, name, found, axes, ratios, fields)


def from_mesh(
    cls: type[ModalBody], name: str, mesh: Any, solid: dict[str, float], plane: str, fixed: Any, points: Any,
    n_modes: int, ratios: Any, residual: bool, fields: dict[str, Any],
) -> ModalBody:  # fmt: skip
    """See :meth:`ModalBody.from_mesh`."""
    from fricmb.reduction import mesh_matrices, reduce_matrices

    label = f"ModalBody {name!r}"
    _check_points(label, points, residual)
    _check_solid(label, solid, plane)
    M, K, rows = mesh_matrices(label, mesh, **solid, plane=plane, fixed=fixed, points=points)
    axes = "xyz"[: mesh.dim()]
    found = reduce_matrices(label, M, K, None, rows, len(axes), n_modes, residual)
    return _body(cls, name, found, axes, ratios, fields)


def _check_points(label: str, points: Any, residual: Any) -> None:
    if not isinstance(residual, bool):
        raise SceneError(f"{label}: residual must be True or False, got {shown(residual)}")
    if not isinstance(points, Mapping) or not points:
        raise SceneError(
            f"{label}: points must be a dict of point name to place, with at least one;"
            f" got {shown(points)}"
        )


def _check_solid(label: str, solid: dict[str, float], plane: str) -> None:
    for argument, value in solid.items():
        low, high = (-1.0, 0.5) if argument == "poisson" else (0.0, np.inf)
        if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not low < value < high:
            accepted = "a number between -1 and 0.5" if argument == "poisson" else "a number > 0"
            raise SceneError(f"{label}: {argument} must be {accepted}, got {shown(value)}")
    if plane not in ("stress", "strain"):
        raise SceneError(f"{label}: plane must be 'stress' or 'strain', got {shown(plane)}")


def _body(cls: type[ModalBody], name: str, found: Reduced, axes: str, ratios: Any, fields: dict[str, Any]) -> ModalBody:
    if ratios is not None and np.ndim(ratios) == 1 and len(ratios) == found.frequencies.size - found.residual:
        # residual modes are damped like the highest of the others
        ratios = [*ratios, *[ratios[-1]] * found.residual]
    return cls(
        name,
        frequencies=found.frequencies,
        damping_ratios=ratios if ratios is not None else (0.0 if found.damping is not None else found.damping_ratios),
        shapes=found.shapes,
        axes=axes,
        damping=found.damping,
        residual=found.residual,
        neglected=found.neglected,
        **fields,
    )


def modal_matrices(body: ModalBody) -> tuple[Any, Any, Any]:
    """Masses (n,), stiffness (n,) and damping (n,) or (n, n) of the modes."""
    omega = np.asarray(value_of(body.frequencies), dtype=float)
    m = np.ones_like(omega) if body.masses is None else np.asarray(value_of(body.masses), dtype=float)
    if body.damping is not None:
        return m, m * omega**2, np.asarray(value_of(body.damping), dtype=float)
    ratios = np.broadcast_to(np.asarray(value_of(body.damping_ratios), dtype=float), omega.shape)
    return m, m * omega**2, 2.0 * ratios * omega * m


def complex_modes(body: ModalBody) -> tuple[NDArray[np.complex128], dict[str, NDArray[np.complex128]]]:
    """See :meth:`ModalBody.complex_modes`."""
    m, k, c = modal_matrices(body)
    n = m.size
    C = np.diag(c) if c.ndim == 1 else c
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(k / m), -C / m[:, None]]])
    poles, vectors = np.linalg.eig(A)
    kept = np.flatnonzero(poles.imag >= 0.0)
    kept = kept[np.argsort(np.abs(poles[kept]), kind="stable")]
    modes = vectors[:n, kept]
    shapes = {name: np.asarray(value_of(shape), dtype=float) @ modes for name, shape in body.shapes.items()}
    every = np.vstack(list(shapes.values()))
    largest = every[np.abs(every).argmax(axis=0), np.arange(kept.size)]
    scale = np.where(np.abs(largest) > 0.0, largest, 1.0)
    return poles[kept].astype(complex), {name: shape / scale for name, shape in shapes.items()}
