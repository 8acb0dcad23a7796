"""Matrices over degrees of freedom."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np

from fricmb.errors import SceneError
from fricmb.scene._arrays import check_array
from fricmb.scene._part import Part
from fricmb.values import is_sparse, value_of


@dataclass(frozen=True, eq=False)
class MatrixElement(Part):
    """Force ``-scale (K q + C v)`` and inertia ``scale M`` over a list of degrees of freedom.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    dofs : sequence of str
        Names of degrees of freedom, "pad.x".
    M, C, K : array_like or scipy sparse, (n, n), optional
        ``M`` symmetric; ``K`` may be non-symmetric (follower forces).
    scale : float, parameter or expression of parameters
        Number by which all of them are multiplied; default 1.  Entries stay numbers, so that a large matrix with one
        parameter in front costs no more than one without.

    Raises
    ------
    SceneError
        If a matrix does not fit the list, is not finite, or none is given.
    """

    _fixed: ClassVar[tuple[str, ...]] = ("name", "dofs")

    dofs: Sequence[str]
    _: KW_ONLY
    M: Any = None
    C: Any = None
    K: Any = None
    scale: Any = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        dofs = () if isinstance(self.dofs, str) or not isinstance(self.dofs, Sequence) else tuple(self.dofs)
        if not dofs or not all(isinstance(name, str) for name in dofs) or len(set(dofs)) < len(dofs):
            self._refuse("dofs", self.dofs, "a list of different names of dofs, such as ['pad.x', 'pad.y']")
        self._set("dofs", dofs)
        self._set("scale", self._number("scale", self.scale))
        given = [name for name in ("M", "C", "K") if getattr(self, name) is not None]
        if not given:
            raise SceneError(f"{self._label()}: give at least one of M, C, K")
        for name in given:
            self._set(name, self._matrix(name, getattr(self, name)))
        if self.M is not None:
            mass = value_of(self.M)
            scale = abs(mass).max()
            if abs(mass - mass.T).max() > 1e-10 * scale:
                self._refuse("M", self.M, "symmetric")

    def scaled(self, target: str) -> Any:
        """The numbers of ``M``, ``C`` or ``K`` (n, n) times ``scale``; None where it is not given."""
        matrix, scale = getattr(self, target), float(value_of(self.scale))
        if matrix is None:
            return None
        return value_of(matrix) if scale == 1.0 else scale * value_of(matrix)

    def _matrix(self, name: str, value: Any) -> Any:
        n = len(self.dofs)
        if is_sparse(value):
            matrix = value.tocsr(copy=True).astype(float)
            matrix.sum_duplicates()
            if not np.all(np.isfinite(matrix.data)):
                self._refuse(name, value, "a matrix of finite numbers")
        else:
            matrix = check_array(self, name, value)
        if matrix.shape != (n, n):
            self._refuse(name, matrix.shape, f"a matrix of shape ({n}, {n}), one row for each of dofs")
        return matrix
