"""A body given by its modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fricmb.errors import SceneError, unknown_name
from fricmb.scene._arrays import check_array, check_vector
from fricmb.scene._bodies import check_keys, check_letters
from fricmb.scene._forms import LinearForm
from fricmb.scene._matrix import MatrixElement
from fricmb.scene._part import End, Part, PointEnd
from fricmb.values import depth_of, value_of


@dataclass(frozen=True, eq=False)
class ModalBody(Part):
    """A body whose motion is a sum of modes: ``m (eta'' + 2 zeta omega eta' + omega^2 eta) = force along the mode``.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    frequencies : array_like, (n,)
        Angular frequencies, >= 0; 0: a rigid mode.  Of frequencies in hertz: ``[120.0, 345.0] * fm.Hz``.
    damping_ratios : float or array_like, (n,)
        Parts of critical damping, >= 0.
    shapes : dict of str to array_like, (len(axes), n)
        Modal displacements of named points along the axes; (n,) will do for one axis.
    masses : array_like, (n,), optional
        Modal masses, > 0; default 1.
    axes : str
        Any of "x", "y", "z".
    position, velocity : dict of str to float
        Initial modal coordinates, ``{"mode1": 1.0}``; default 0.
    damping : array_like, (n, n), optional
        Modal damping matrix, where damping couples modes (as a C that is not proportional does): the force
        ``-damping eta'``; then ``damping_ratios`` must be 0.
    truncation : float, optional
        Largest error accepted in the elastic displacement at contacts and loads, as a share of it: higher modes are
        replaced by a few residual ones that keep the static flexibility; the plan prints how many, and the estimate.
    residual : int
        Number of the last modes that are such residual ones already.
    neglected : float
        Share of the static flexibility that the residual modes carry: set by :meth:`from_matrices` and
        :meth:`from_mesh`.
    parts : dict of str to (n, n)
        Matrices in the coordinates of the body, such as friction and gyroscopic terms, which :meth:`matrix` puts into a
        scene: from :meth:`from_fe`.
    scales : dict of str to number, parameter or expression
        Factor of each of these parts, unless :meth:`matrix` is given another: set by :meth:`from_fe`.
    errors : sequence of float
        Estimated relative errors of the eigenvalues at the samples of :meth:`from_fe`.

    Raises
    ------
    SceneError
        If a value or a shape is not accepted.

    See Also
    --------
    from_fe, from_matrices, from_mesh
    """

    _fixed: ClassVar[tuple[str, ...]] = (
        "name", "axes", "truncation", "residual", "neglected", "parts", "scales", "errors",
    )  # fmt: skip

    _: KW_ONLY
    frequencies: Any
    damping_ratios: Any
    shapes: Mapping[str, Any]
    masses: Any = None
    axes: str = "x"
    position: Mapping[str, Any] = field(default_factory=dict)
    velocity: Mapping[str, Any] = field(default_factory=dict)
    damping: Any = None
    truncation: float | None = None
    residual: int = 0
    neglected: float = 0.0
    parts: Mapping[str, Any] = field(default_factory=dict)
    scales: Mapping[str, Any] = field(default_factory=dict)
    errors: Sequence[float] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        self._set("axes", check_letters(self, "axes", self.axes))
        self._set("frequencies", check_vector(self, "frequencies", self.frequencies, minimum=0.0))
        n = len(self.frequencies)
        if depth_of(self.damping_ratios) == 0:
            self._set("damping_ratios", self._number("damping_ratios", self.damping_ratios, minimum=0.0))
        else:
            self._set("damping_ratios", check_vector(self, "damping_ratios", self.damping_ratios, n, minimum=0.0))
        if self.masses is not None:
            self._set("masses", check_vector(self, "masses", self.masses, n, above=0.0))
        self._set("shapes", MappingProxyType(self._checked_shapes(n)))
        self._check_damping(n)
        self._check_reduction(n)
        modes = tuple(name.partition(".")[2] for name in self.dof_names)
        for argument in ("position", "velocity"):
            given = check_keys(self, argument, getattr(self, argument), modes)
            values = {key: self._number(f"{argument}[{key!r}]", value) for key, value in given.items()}
            self._set(argument, MappingProxyType(values))

    def _checked_shapes(self, n: int) -> dict[str, Any]:
        if not isinstance(self.shapes, Mapping) or not self.shapes:
            self._refuse("shapes", self.shapes, "a dict of point name to array, with at least one point")
        checked = {}
        for point, shape in self.shapes.items():
            if not isinstance(point, str) or not point or "." in point or point.startswith("mode"):
                self._refuse("shapes", point, "keyed by point names without dots that do not begin with 'mode'")
            array = check_array(self, f"shapes[{point!r}]", shape)
            if array.ndim == 1 and len(self.axes) == 1:
                array = array.reshape(1, -1)
            if array.shape != (len(self.axes), n):
                accepted = f"an array of shape ({len(self.axes)}, {n}) (axes, modes)"
                self._refuse(f"shapes[{point!r}]", array.shape, accepted)
            checked[point] = array
        return checked

    def _check_damping(self, n: int) -> None:
        if self.damping is None:
            return
        matrix = check_array(self, "damping", self.damping)
        if matrix.shape != (n, n):
            self._refuse("damping", matrix.shape, f"a matrix of shape ({n}, {n}), or None")
        if np.any(value_of(self.damping_ratios)):
            self._refuse("damping_ratios", self.damping_ratios, "0 with a damping matrix, which takes their place")
        self._set("damping", matrix)

    def _check_reduction(self, n: int) -> None:
        if self.truncation is not None:
            self._set("truncation", self._number("truncation", self.truncation, above=0.0))
        if isinstance(self.residual, bool) or not isinstance(self.residual, int) or not 0 <= self.residual <= n:
            self._refuse("residual", self.residual, f"an integer from 0 to {n}, the number of modes")
        self._set("neglected", self._number("neglected", self.neglected, minimum=0.0))
        self._set("errors", tuple(self._number("errors", value, minimum=0.0) for value in self.errors))
        if not isinstance(self.parts, Mapping):
            self._refuse("parts", self.parts, "a dict of name to matrix")
        parts = {str(key): check_array(self, f"parts[{key!r}]", value) for key, value in self.parts.items()}
        for key, value in parts.items():
            if value.shape != (n, n):
                self._refuse(f"parts[{key!r}]", value.shape, f"a matrix of shape ({n}, {n})")
        self._set("parts", MappingProxyType(parts))
        if not isinstance(self.scales, Mapping) or not set(self.scales) <= set(parts):
            self._refuse("scales", self.scales, "a dict of name of a part to number, parameter or expression")
        self._set("scales", MappingProxyType(dict(self.scales)))

    @classmethod
    def from_matrices(
        cls,
        name: str,
        *,
        M: Any,
        K: Any,
        C: Any = None,
        points: Mapping[str, Any],
        n_modes: int | None = None,
        axes: str = "x",
        damping_ratios: Any = None,
        residual: bool = True,
        **fields: Any,
    ) -> ModalBody:
        """Modes of ``M q'' + C q' + K q = f``, from an eigenproblem.

        Parameters
        ----------
        name : str
        M, K : (n, n) array or scipy sparse
            Symmetric; M positive definite, K positive semidefinite (rigid modes get the frequency 0 exactly).
        C : (n, n) array or scipy sparse, optional
            Damping; not proportional, it couples the modes and is kept as their matrix ``damping``.
        points : dict of str to (len(axes),) int or (len(axes), n)
            Degree of freedom along each axis, or the rows that give the displacement.
        n_modes : int, optional
            How many, lowest first; default all.
        axes : str
        damping_ratios : float or array_like, optional
            In place of C.
        residual : bool
            Whether residual modes keep the static flexibility at the points where modes are left out: as many more
            modes as there are independent directions at the points.
        **fields
            Of :class:`ModalBody`: position, velocity, truncation.

        Returns
        -------
        ModalBody

        Raises
        ------
        SceneError
            For matrices of the wrong shape, not symmetric, singular or indefinite.
        """
        from fricmb.scene._modal_from import from_matrices

        return from_matrices(cls, name, M, K, C, points, n_modes, axes, damping_ratios, residual, fields)

    @classmethod
    def from_mesh(
        cls,
        name: str,
        mesh: Any,
        *,
        young: float,
        poisson: float,
        density: float,
        points: Mapping[str, Any],
        n_modes: int,
        fixed: Any = None,
        thickness: float = 1.0,
        plane: str = "stress",
        damping_ratios: Any = 0.0,
        residual: bool = True,
        **fields: Any,
    ) -> ModalBody:
        """Modes of a linear-elastic finite element mesh of scikit-fem (extra ``fem``), in elements of second order.

        Parameters
        ----------
        name : str
        mesh : skfem.MeshTri, MeshQuad, MeshTet or MeshHex
            Axes x, y (and z) of the body are those of the mesh.
        young, poisson, density : float
            Young's modulus, Poisson's ratio, mass per volume.
        points : dict of str to coordinates
            Within the mesh.
        n_modes : int
        fixed : str or callable, optional
            Boundary that is held: a name in the mesh, or a function of coordinates (d, n); default: free.
        thickness : float
            Of a plane mesh.
        plane : {"stress", "strain"}
        damping_ratios : float or array_like
        residual : bool
            As in :meth:`from_matrices`.
        **fields
            Of :class:`ModalBody`: position, velocity, truncation.

        Returns
        -------
        ModalBody

        Raises
        ------
        SceneError
        ImportError
            Without scikit-fem.
        """
        from fricmb.scene._modal_from import from_mesh

        solid = {"young": young, "poisson": poisson, "density": density, "thickness": thickness}
        return from_mesh(cls, name, mesh, solid, plane, fixed, points, n_modes, damping_ratios, residual, fields)

    @classmethod
    def from_fe(
        cls,
        name: str,
        fe: Any,
        *,
        points: Mapping[str, Any],
        axes: str = "xyz",
        normals: Any = None,
        up_to: float | None = None,
        n_modes: int | None = None,
        residual: bool = True,
        enrich: Sequence[Mapping[str, float]] = (),
        scales: Mapping[str, Any] | None = None,
        structural_at: float | None = None,
        tolerance: float = 1e-6,
        damping_ratios: Any = None,
        **fields: Any,
    ) -> ModalBody:
        """A body from matrices of a finite element program.

        Parameters
        ----------
        name : str
        fe : FEModel
            From ``fm.fe.read``, ``fm.fe.join`` or ``fm.fe.FEModel``.
        points : dict of str to int, ints, or (len(axes), n)
            The number of a node; numbers of nodes, which give one point each, ``"pad_1012"``; or rows that give the
            displacement.  Of a model without labels a degree of freedom along each axis, or rows.
        axes : str
        normals : "surface" or dict of str to (3,), optional
            Turns the axes of points: z along the normal, out of the body, of the plane that fits the point's nodes
            best, or as given; x as near to global x as it can be.
        up_to : float, optional
            Frequency, in cycles for each unit of time, up to which modes are kept.
        n_modes : int, optional
            How many at most.
        residual : bool
            Whether residual vectors keep the static flexibility at the points.
        enrich : sequence of dict of str to float
            Samples of parameters, or of factors of the model's parts, at which complex modes are added to the basis:
            growth rates need them.  Eigenvalues up to ``up_to`` are accurate to about ``tolerance`` there; ``errors``
            holds the estimates.
        scales : dict of str to expression, optional
            Of parts: the number in front as an expression of the parameters in ``enrich``; default: those of the model.
            Names of parts begin with K (stiffness), C, D or G (damping), or M.
        structural_at : float, optional
            Frequency, in cycles, at which structural damping becomes viscous; by default that of each mode.
        tolerance : float
            Of eigenvalues at the samples, relative.
        damping_ratios : float or array_like, optional
            For a model without damping of its own.
        **fields
            Of :class:`ModalBody`: position, velocity.

        Returns
        -------
        ModalBody

        Raises
        ------
        SceneError
        """
        from fricmb.scene._modal_from_fe import from_fe

        return from_fe(
            cls, name, fe, points, axes, normals, up_to, n_modes, residual, enrich, scales, structural_at, tolerance,
            damping_ratios, fields,
        )  # fmt: skip

    @classmethod
    def from_test(
        cls, name: str, modes: Any, *, points: Mapping[str, int], scale: Any = None, axes: str = "xyz", **fields: Any
    ) -> ModalBody:
        """A body from modes of a test.

        Parameters
        ----------
        name : str
        modes : Modes or Measured
            From ``fm.measure.read`` or ``fm.measure.identify``.
        points : dict of str to int
            Node of each point.
        scale : Frf, optional
            The frequency response of a driving point: gives modal masses where the file has none.
        axes : str
        **fields
            Of :class:`ModalBody`: position, velocity, damping_ratios.

        Returns
        -------
        ModalBody

        Raises
        ------
        SceneError
            If modal masses are missing, a shape is complex, or ``scale`` is not of a driving point (whose residues are
            > 0 for every mode).
        """
        from fricmb.scene._modal_test import from_test

        return from_test(cls, name, modes, points, scale, axes, fields)

    def frf(
        self, a: str, b: str, f: Any, kind: str = "accelerance", *, residual: bool = True
    ) -> NDArray[np.complex128]:
        """Frequency response of the body alone, motion of ``a`` over a force at ``b``.

        Parameters
        ----------
        a, b : str
            Point and axis, ``"tip.x"``.
        f : (n,) array_like
            Frequencies in cycles for each unit of time.
        kind : {"accelerance", "mobility", "receptance"}
        residual : bool
            Whether the residual modes, which stand for those left out, are counted.

        Returns
        -------
        (n,) complex

        Raises
        ------
        UnknownNameError
            For a point or an axis that is not there.
        SceneError
        """
        from fricmb.scene._modal_test import frf

        return frf(self, a, b, f, kind, residual)

    def compare(self, test: Any, *, points: Mapping[str, int] | None = None) -> Any:
        """Compare the body with a test: modes by frequency, damping and shape, and frequency responses.

        Parameters
        ----------
        test : Measured, Modes, Frf or list of Frf
        points : dict of str to int, optional
            Node of the test for each point of the body; by default the number that the point's name ends with,
            ``"pad_1012"``.

        Returns
        -------
        Comparison
            Modal assurance criterion, differences of frequencies and damping, R^2 of responses; ``.plot``.

        Raises
        ------
        SceneError
        """
        from fricmb.scene._modal_test import compare

        return compare(self, test, points)

    def matrix(self, name: str, *, M: Any = None, C: Any = None, K: Any = None, scale: Any = None) -> MatrixElement:
        """Make an element of a scene from one of the body's ``parts``.

        Parameters
        ----------
        name : str
            Of the element.
        M, C, K : str or (n, n) array, optional
            Name of a part, or a matrix in the coordinates of the body.
        scale : float, parameter or expression of parameters, optional
            Default: that of the part in ``scales``, else 1.

        Returns
        -------
        MatrixElement

        Raises
        ------
        UnknownNameError
            If there is no such part.
        """

        def held(value: Any) -> Any:
            if not isinstance(value, str):
                return value
            if value not in self.parts:
                raise unknown_name(f"part of {self._label()}", value, self.parts)
            return self.parts[value]

        if scale is None:
            own = {self.scales.get(part, 1.0) for part in (M, C, K) if isinstance(part, str)}
            if len(own) > 1:
                raise SceneError(f"{self._label()}: matrix {name!r} has parts with different scales; give scale=")
            scale = own.pop() if own else 1.0
        return MatrixElement(name, self.dof_names, M=held(M), C=held(C), K=held(K), scale=scale)

    @property
    def n_modes(self) -> int:
        """Number of modes."""
        return len(self.frequencies)

    @property
    def dof_names(self) -> tuple[str, ...]:
        """``"name.mode1"``, ... and ``"name.residual1"``, ..."""
        plain = self.n_modes - self.residual
        modes = [f"{self.name}.mode{i + 1}" for i in range(plain)]
        return (*modes, *(f"{self.name}.residual{i + 1}" for i in range(self.residual)))

    def complex_modes(self) -> tuple[NDArray[np.complex128], dict[str, NDArray[np.complex128]]]:
        """Poles (n_poles,) with Im >= 0, by rising magnitude, and shapes {point: (len(axes), n_poles)} of the body.

        Of the body alone.  With damping that couples modes these are the modes that vibrate freely, ``exp(pole t)``;
        shapes have their largest entry 1 over all points.
        """
        from fricmb.scene._modal_from import complex_modes

        return complex_modes(self)

    def start_values(self, argument: str) -> Mapping[str, Any]:
        """Declared start of the modal coordinates; ``argument``: "position" or "velocity"."""
        values: Mapping[str, Any] = getattr(self, argument)
        return values

    def point(self, name: str) -> Point:
        """A named point: an end for elements and contacts.

        Raises
        ------
        UnknownNameError
            If ``shapes`` has no such point.
        """
        if not isinstance(name, str) or name not in self.shapes:
            raise unknown_name(f"point of {self._label()}", name, self.shapes)
        return Point(self, name)

    def modal_form(self, point: str, letter: str) -> LinearForm:
        """Motion of a point along an axis as a sum of modes."""
        row = value_of(self.shapes[point])[self.axes.index(letter)]
        return LinearForm.of(dict(zip(self.dof_names, row.tolist(), strict=True)))


@dataclass(frozen=True)
class Point(PointEnd):
    """A named point of a modal body; made by :meth:`ModalBody.point`."""

    body: ModalBody
    point: str

    @property
    def letters(self) -> tuple[str, ...]:
        """Axes of the body."""
        return tuple(self.body.axes)

    def moved_to(self, part: Part) -> End:
        """The point of the same name."""
        return self if part is self.body or not isinstance(part, ModalBody) else part.point(self.point)
