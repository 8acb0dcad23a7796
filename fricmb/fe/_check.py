"""What matrices of a model are, and whether modes belong to them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.errors import SceneError
from fricmb.fe._whole import ROUND_OFF, Floats, asymmetry, symmetric_part

if TYPE_CHECKING:
    from fricmb.fe._model import FEModel


#: Most rows of which the rank is computed.
COUNTED = 2000


@dataclass(frozen=True, kw_only=True)
class Check:
    """Result of :meth:`FEModel.check`.

    Attributes
    ----------
    n, massless : int
        Degrees of freedom; independent motions without mass (of more than 2000, rows without mass).
    rigid : int
        Modes of frequency 0.
    lowest : (k,)
        The lowest angular frequencies above 0.
    asymmetry : dict of str to float
        Of each matrix, relative; a skew matrix has 2.
    precision : str
        "single" or "double".
    mass : (3,) or None
        Of a translation along each global axis; None without labels.
    defect : float or None
        Largest ``|K phi - omega^2 M phi| / |K phi|`` of the given modes.
    notes : tuple of str
    """

    name: str
    n: int
    massless: int
    rigid: int
    lowest: Floats
    asymmetry: Mapping[str, float]
    precision: str
    mass: Floats | None
    defect: float | None
    units: str | None
    notes: tuple[str, ...]

    @property
    def symmetric(self) -> bool:
        """Whether M and K are, to the digits of the file."""
        return all(self.asymmetry[key] <= ROUND_OFF[self.precision] for key in ("M", "K"))

    def __str__(self) -> str:
        hertz = ", ".join(f"{w / (2 * np.pi):.7g}" for w in self.lowest[:4])
        uneven = ", ".join(f"{key} {value:.2g}" for key, value in self.asymmetry.items())
        rows = [
            ("degrees of freedom", f"{self.n}, {self.massless} motions without mass"),
            ("rigid modes", f"{self.rigid}; then {hertz} Hz" if self.lowest.size else str(self.rigid)),
            ("asymmetry", uneven),
            ("precision", self.precision),
        ]
        if self.mass is not None:
            rows.append(("mass along x, y, z", ", ".join(f"{m:.6g}" for m in self.mass)))
        if self.units is not None:
            rows.append(("units", self.units))
        if self.defect is not None:
            rows.append(("modes given", f"|K phi - w^2 M phi| is at most {self.defect:.2g} of |K phi|"))
        rows += [("note", note) for note in self.notes]
        return "\n".join([f"FEModel {self.name!r}", *(f"  {left:20} {right}" for left, right in rows)])


def check(fe: FEModel, modes: Any, tolerance: float) -> Check:
    """See :meth:`FEModel.check`."""
    from fricmb.reduction import lowest_modes

    M, K = symmetric_part(fe.M), symmetric_part(fe.K)
    omega2 = lowest_modes(fe._label(), M, K, count=min(12, fe.n)).omega2
    while not omega2.any() and omega2.size < fe.n:  # all of those found are rigid: look further
        more = lowest_modes(fe._label(), M, K, count=min(2 * omega2.size, fe.n)).omega2
        if more.size == omega2.size:
            break
        omega2 = more
    matrices = {key: getattr(fe, key) for key in ("M", "K", "C", "H")} | dict(fe.parts)
    return Check(
        name=fe.name,
        n=fe.n,
        massless=_massless(M),
        rigid=int(np.count_nonzero(omega2 == 0.0)),
        lowest=np.sqrt(omega2[omega2 > 0.0]),
        asymmetry={key: asymmetry(value) for key, value in matrices.items() if value is not None},
        precision=fe.precision,
        mass=_mass(fe),
        defect=None if modes is None else _defect(fe, modes, tolerance),
        units=fe.units,
        notes=fe.notes,
    )


def _massless(M: Any) -> int:
    """Motions without mass: the rank that M lacks; of a large one its empty rows alone."""
    size = M.diagonal()
    moving = np.flatnonzero(size > 0.0)
    empty = M.shape[0] - moving.size
    if moving.size > COUNTED:
        return int(empty)
    scale = 1.0 / np.sqrt(size[moving])
    values = np.linalg.eigvalsh(M[moving][:, moving].toarray() * scale[:, None] * scale)
    return int(empty + np.count_nonzero(values <= 1e-12 * values.max(initial=0.0)))


def _mass(fe: FEModel) -> Floats | None:
    """What a unit translation along each global axis moves."""
    if fe.labels is None or (fe.labels[:, 1] == 0).any():
        return None
    shift = np.zeros((fe.n, 3))
    moving = (fe.labels[:, 1] >= 1) & (fe.labels[:, 1] <= 3)
    for i in np.flatnonzero(moving):
        node, dof = fe.labels[i].tolist()
        shift[i] = fe.frames.get(node, np.eye(3))[dof - 1]
    found: Floats = np.einsum("ij,ij->j", shift, fe.M @ shift)
    return found


def _defect(fe: FEModel, modes: Any, tolerance: float) -> float:
    """Largest relative residual of modes; refused where it is too large."""
    omega, shapes, source, round_off = _given(fe, modes)
    forces = fe.K @ shapes
    residual = forces - (fe.M @ shapes) * omega**2
    # a rigid mode has no forces: what the lowest elastic one has stands for it
    size = np.linalg.norm(forces, axis=0)
    size = np.maximum(size, size[omega > 0.0].min(initial=np.inf) if (omega > 0.0).any() else 1e-300)
    defects = np.linalg.norm(residual, axis=0) / size
    if round_off > 0.0 and not defects.max() <= tolerance:
        defects = np.minimum(defects, _smoothed(fe, omega, shapes, residual))
    worst = int(np.argmax(defects))
    if not defects[worst] <= tolerance:
        raise SceneError(
            f"{fe._label()}: {source} do not belong to these matrices: |K phi - omega^2 M phi| is"
            f" {defects[worst]:.3g} of |K phi| for mode {worst + 1} at {omega[worst] / (2 * np.pi):.6g} Hz, at most"
            f" {tolerance:g} is accepted (other boundary conditions, units, or another run)"
        )
    return float(defects[worst])


def _smoothed(fe: FEModel, omega: Floats, shapes: Floats, residual: Floats) -> Floats:
    """How far displacements under the residuals are from none, relative (k,).

    Stiff motions turn the last digit of a shape into large forces; the displacements that these forces make are of the
    size of that digit again, while a wrong frequency or shape stays as wrong as it is.
    """
    from fricmb.reduction._factor import factor

    elastic = omega[omega > 0.0]
    shift = 1e-6 * float(elastic.min() ** 2) if elastic.size else 1.0
    moved = factor((fe.K + shift * fe.M).tocsc())(residual)
    found: Floats = np.linalg.norm(moved, axis=0) / np.linalg.norm(shapes, axis=0)
    return found


def _with_inner(fe: FEModel, shapes: Any, omega: Floats, source: str, nodes: Any) -> Any:
    """Shapes with those degrees of freedom, inside elements, whose nodes the file does not have: by equilibrium.

    Whether modes belong to the matrices is then decided by the others.
    """
    unknown = np.isnan(shapes).any(axis=1)
    if np.isin(fe.labels[unknown, 0], nodes).any() or unknown.all():
        raise SceneError(
            f"{fe._label()}: {source} say nothing of {unknown.sum()} of the {fe.n} degrees of freedom, and so cannot be"
            " checked"
        )
    from fricmb.reduction._factor import factor

    found = shapes.copy()
    for k, w2 in enumerate(omega**2):
        rows = (fe.K - w2 * fe.M)[unknown]
        found[unknown, k] = -factor(rows[:, unknown].tocsc())(rows[:, ~unknown] @ shapes[~unknown, k])
    return found


def _given(fe: FEModel, modes: Any) -> tuple[Floats, Floats, str, float]:
    """Angular frequencies (k,), shapes (n, k) in the order of the model, what to call them, and their round-off."""
    if isinstance(modes, tuple) and len(modes) == 2:
        omega, shapes = np.asarray(modes[0], dtype=float), np.asarray(modes[1])
        if omega.ndim != 1 or shapes.shape != (fe.n, omega.size):
            raise SceneError(
                f"{fe._label()}: modes must be frequencies (k,) and shapes ({fe.n}, k), got {omega.shape} and"
                f" {shapes.shape}"
            )
        return omega, shapes, "the modes", 0.0
    source = "the modes"
    if isinstance(modes, str | PathLike):
        from fricmb.measure import read

        source, modes = f"modes of {modes}", read(modes).modes
    if fe.labels is None:
        raise SceneError(f"{fe._label()}: {source} cannot be matched without labels")
    if modes is None or not hasattr(modes, "at_labels"):
        raise SceneError(f"{fe._label()}: modes must be a path, Modes, or (frequencies, shapes)")
    if np.iscomplexobj(modes.shapes):
        raise SceneError(f"{fe._label()}: {source} are complex; give real ones (SOL 103, say)")
    shapes, missing = modes.at_labels(fe.labels)
    if missing:
        shapes = _with_inner(fe, shapes, np.asarray(modes.frequencies), source, modes.nodes)
    return np.asarray(modes.frequencies), shapes, source, float(modes.round_off)
