"""A finite element model as its matrices say it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import InitVar, dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fricmb.errors import SceneError, shown, unknown_name
from fricmb.fe._places import checked_frames, checked_labels, checked_scales, checked_sets, point_rows
from fricmb.fe._units import factors
from fricmb.fe._whole import Floats, Sparse, checked, precision, symmetric_part

if TYPE_CHECKING:
    from fricmb.fe._check import Check

Ints = NDArray[np.int64]
#: Matrices that have a place of their own in a model.
OWN = ("M", "K", "C", "H")


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class FEModel:
    """Matrices of a finite element model over its free degrees of freedom.

    Parameters
    ----------
    M, K : (n, n) array or scipy sparse
        Mass and stiffness as a program writes them: triangles are completed, the mass may be semidefinite (massless
        degrees of freedom), a complex stiffness is taken apart into K and H.
    C : (n, n), optional
        Viscous damping, with gyroscopic parts if there are any.
    H : (n, n), optional
        Structural damping: the imaginary part of the stiffness.
    parts : dict of str to (n, n), optional
        Matrices beside these that a number multiplies later, such as friction ``KR`` and gyroscopic terms ``DG``.
    labels : (n, 2) int, optional
        Number of the node and degree of freedom, 1 to 6 (displacements, rotations), or 0: a coordinate that belongs to
        no node.
    coordinates : dict of int to (3,), optional
        Of nodes.
    frames : dict of int to (3, 3), optional
        Axes of nodes whose degrees of freedom are not along the global ones: rows are axes in global coordinates.
    sets : dict of str to ints, optional
        Named groups of nodes.
    fixed : sequence of (node, dof), or of places in the matrices, optional
        Degrees of freedom that are held: taken out.  So are those that no matrix knows.
    triangles : dict of str to {"symmetric", "skew", "full"}, optional
        What a triangle stands for, by name of the matrix; by default skew where its diagonal is empty, else symmetric.
    scales : dict of str to float, parameter or expression, optional
        Of parts: the number that multiplies each, such as ``{"KR": mu / 0.4}``; :meth:`ModalBody.from_fe` and
        ``body.matrix`` take them from here.
    boundary : int, optional
        How many of the first degrees of freedom are those by which a superelement hangs on others.
    units : str, optional
        "t-mm-s" and the like, or "SI".
    name : str

    Attributes
    ----------
    n : int
        Free degrees of freedom.
    notes : tuple of str
        Entries that were completed, taken apart, or taken out.

    Raises
    ------
    SceneError
        If a matrix or a label is not accepted.
    """

    M: Any
    K: Any
    C: Any = None
    H: Any = None
    parts: Mapping[str, Any] = field(default_factory=dict)
    labels: Any = None
    coordinates: Mapping[int, Any] = field(default_factory=dict)
    frames: Mapping[int, Any] = field(default_factory=dict)
    sets: Mapping[str, Any] = field(default_factory=dict)
    fixed: InitVar[Any] = None
    triangles: InitVar[Mapping[str, str] | None] = None
    scales: Mapping[str, Any] = field(default_factory=dict)
    boundary: int | None = None
    units: str | None = None
    name: str = "model"
    notes: tuple[str, ...] = ()

    def __post_init__(self, fixed: Any, triangles: Mapping[str, str] | None) -> None:
        if not isinstance(self.name, str) or not self.name:
            raise SceneError(f"FEModel: name must be a non-empty string, got {shown(self.name)}")
        if self.units is not None:
            factors(self._label(), self.units)
        matrices, notes = self._matrices(dict(triangles or {}))
        n = matrices["M"].shape[0]
        labels = checked_labels(self._label(), self.labels, n)
        held = self._held(fixed, labels, n)
        known = np.zeros(n, dtype=bool)
        for matrix in matrices.values():
            known |= (abs(matrix).sum(axis=0) > 0.0) | (abs(matrix).sum(axis=1) > 0.0)
        if held.any():
            notes.append(f"{held.sum()} fixed degrees of freedom taken out")
        if (~known & ~held).any():
            notes.append(f"{(~known & ~held).sum()} degrees of freedom without mass and stiffness taken out")
        kept = np.flatnonzero(known & ~held)
        if not kept.size:
            raise SceneError(f"{self._label()}: no degree of freedom is left")
        if kept.size < n:
            matrices = {key: value[kept][:, kept] for key, value in matrices.items()}
        set_ = object.__setattr__
        for key in OWN:
            set_(self, key, matrices.get(key))
        set_(self, "parts", {k: v for k, v in matrices.items() if k not in OWN})
        set_(self, "scales", checked_scales(self._label(), self.scales, self.parts))
        set_(self, "labels", None if labels is None else labels[kept])
        if self.boundary is not None:
            set_(self, "boundary", int(np.count_nonzero(kept < self.boundary)))
        places, axes = checked_frames(self._label(), self.coordinates, self.frames)
        set_(self, "coordinates", places)
        set_(self, "frames", axes)
        set_(self, "sets", checked_sets(self._label(), self.sets))
        set_(self, "notes", (*self.notes, *notes))

    def _matrices(self, kinds: dict[str, str]) -> tuple[dict[str, Sparse], list[str]]:
        """The matrices made whole, by name, and what was done."""
        given = {key: getattr(self, key) for key in OWN if getattr(self, key) is not None}
        if not isinstance(self.parts, Mapping):
            raise SceneError(f"{self._label()}: parts must be a dict of name to matrix, got {shown(self.parts)}")
        for key in self.parts:
            if not isinstance(key, str) or not key or key in OWN:
                raise SceneError(f"{self._label()}: parts must have names other than M, K, C, H; got {shown(key)}")
        given |= self.parts
        for key in kinds:
            if key not in given:
                raise unknown_name(f"matrix in triangles of {self._label()}", key, given)
        found: dict[str, Sparse] = {}
        notes: list[str] = []
        for key, value in given.items():
            matrix, what = checked(self._label(), key, value, kinds.get(key))
            if what:
                notes.append(f"{key}: {what}")
            if found and matrix.shape != found["M"].shape:
                raise SceneError(
                    f"{self._label()}: {key} must have the shape of M, {found['M'].shape}; got {matrix.shape}"
                )
            if np.iscomplexobj(matrix.data):
                if key != "K":
                    raise SceneError(f"{self._label()}: {key} must be real; a complex stiffness goes into K")
                if "H" in given and matrix.imag.nnz:
                    raise SceneError(f"{self._label()}: give H or a complex K, not both")
                imaginary = matrix.imag
                imaginary.eliminate_zeros()
                if imaginary.nnz:
                    found["H"] = imaginary
                    notes.append("K: its imaginary part is the structural damping H")
                matrix = matrix.real
                matrix.eliminate_zeros()
            found[key] = matrix
        return found, notes

    def _held(self, fixed: Any, labels: Ints | None, n: int) -> NDArray[np.bool_]:
        held = np.zeros(n, dtype=bool)
        if fixed is None or len(fixed) == 0:
            return held
        given = np.asarray(fixed)
        if given.dtype.kind in "iu" and given.ndim == 1 and (given >= 0).all() and (given < n).all():
            held[given] = True
            return held
        if given.dtype.kind not in "iu" or given.ndim != 2 or given.shape[1] != 2 or labels is None:
            accepted = "pairs (node, dof) of labels" if labels is not None else f"places from 0 to {n - 1}"
            raise SceneError(f"{self._label()}: fixed must be {accepted}, got {shown(fixed)}")
        index = {(int(a), int(b)): i for i, (a, b) in enumerate(labels)}
        for a, b in given.tolist():
            if (a, b) not in index:
                raise SceneError(f"{self._label()}: fixed holds dof {b} of node {a}, which no label names")
            held[index[a, b]] = True
        return held

    def _label(self) -> str:
        return f"FEModel {self.name!r}"

    def __repr__(self) -> str:
        return f"<{self._label()}: {self.n} degrees of freedom>"

    def __str__(self) -> str:
        names = [key for key in OWN if getattr(self, key) is not None] + list(self.parts)
        lines = [f"{self._label()}: {self.n} degrees of freedom, {', '.join(names)}"]
        lines += [f"  {note}" for note in self.notes]
        return "\n".join(lines)

    @property
    def n(self) -> int:
        """Number of free degrees of freedom."""
        return int(self.M.shape[0])

    @property
    def precision(self) -> str:
        """Digits that the numbers have: "single" or "double"."""
        return "single" if "single" in (precision(self.M), precision(self.K)) else "double"

    def matrix(self, name: str) -> Sparse:
        """M, K, C, H or a part (n, n), sparse by rows.

        Raises
        ------
        UnknownNameError
        """
        found = getattr(self, name) if name in OWN else self.parts.get(name)
        if found is None:
            there = [key for key in OWN if getattr(self, key) is not None] + list(self.parts)
            raise unknown_name(f"matrix of {self._label()}", name, there)
        return found

    def nodes(self, name: str | None = None, *, where: Callable[[Floats], Any] | None = None, near: Any = None) -> Ints:
        """Find nodes by the name of a set, by their coordinates, or all of them.

        Parameters
        ----------
        name : str, optional
            Of a set; without any argument all nodes with degrees of freedom.
        where : callable, optional
            Of coordinates (3, n): which of them to take, (n,) of bool.
        near : (3,), optional
            Coordinates: the one node next to them.

        Raises
        ------
        UnknownNameError
            If there is no such set.
        SceneError
            Without coordinates.

        Examples
        --------
        >>> import numpy as np
        >>> import fricmb as fm
        >>> fe = fm.fe.FEModel(
        ...     M=np.eye(2), K=np.eye(2), labels=[(7, 1), (9, 1)], coordinates={7: (0, 0, 0), 9: (1, 0, 0)},
        ...     sets={"FACE": [9]},
        ... )
        >>> fe.nodes("FACE"), fe.nodes(where=lambda x: x[0] < 0.5), fe.nodes(near=(0.9, 0, 0))
        (array([9]), array([7]), array([9]))
        """
        if name is not None:
            if name not in self.sets:
                raise unknown_name(f"set of nodes of {self._label()}", name, self.sets)
            found: Ints = self.sets[name]
            return found
        if where is None and near is None:
            if self.labels is None:
                raise SceneError(f"{self._label()}: no labels are known")
            return np.unique(self.labels[self.labels[:, 1] > 0, 0])
        if not self.coordinates:
            raise SceneError(f"{self._label()}: no coordinates of nodes are known")
        numbers = np.array(list(self.coordinates), dtype=np.int64)
        places = np.array(list(self.coordinates.values()))
        if near is not None:
            return numbers[[int(np.argmin(np.linalg.norm(places - np.asarray(near, dtype=float), axis=1)))]]
        inside: Any = where(places.T) if where is not None else None
        chosen: Ints = numbers[np.asarray(inside) != 0]
        return chosen

    def rows(self, node: int, axes: str = "xyz", turn: Floats | None = None) -> Floats:
        """Rows (len(axes), n) that give a node's displacement along global axes, or along the rows of ``turn`` (3, 3).

        Raises
        ------
        SceneError
            If the node has no such degree of freedom.
        """
        return point_rows(self, int(node), axes, turn)

    def frequencies(self, n_modes: int = 12) -> Floats:
        """The lowest angular frequencies (n_modes,), rising; those of rigid modes 0.

        Of M and the symmetric part of K.

        Raises
        ------
        SceneError
        """
        from fricmb.reduction import lowest_modes

        found = lowest_modes(self._label(), symmetric_part(self.M), symmetric_part(self.K), count=int(n_modes))
        return np.sqrt(found.omega2)

    def check(self, modes: Any = None, *, tolerance: float = 1e-3) -> Check:
        """Examine the matrices: rigid modes, massless degrees of freedom, asymmetry, precision, mass.

        Parameters
        ----------
        modes : path, Modes or (frequencies, shapes), optional
            Modes of the same model, angular frequencies (k,) and shapes (n, k), or a file that has them.
        tolerance : float
            Largest ``|K phi - omega^2 M phi|`` accepted, as a share of ``|K phi|``.

        Returns
        -------
        Check

        Raises
        ------
        SceneError
            If the modes do not belong to these matrices; says by how much.
        """
        from fricmb.fe._check import check

        return check(self, modes, tolerance)

    def symmetrised(self, name: str = "K_skew") -> FEModel:
        """A copy with the symmetric part of K; the skew rest, such as friction leaves, becomes the part ``name``."""
        rest = self.K - symmetric_part(self.K)
        return replace(self, K=symmetric_part(self.K), parts={**self.parts, name: rest}, triangles={name: "full"})

    def in_units(self, units: str = "SI") -> FEModel:
        """Convert to other units.

        Raises
        ------
        SceneError
            If those of the model or those asked for are not known.
        """
        from fricmb.fe._convert import convert

        return convert(self, units)
