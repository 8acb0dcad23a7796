"""What a file of measurements holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fricmb.errors import SceneError, shown, unknown_name

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

#: Directions of UFF by number; 0: not said.
DIRECTIONS = ("", "x", "y", "z", "rx", "ry", "rz")
#: Powers of i omega by which receptance is multiplied.
KINDS = {"receptance": 0, "mobility": 1, "accelerance": 2}


@dataclass(frozen=True, kw_only=True, eq=False)
class TimeSeries:
    """A signal.

    Attributes
    ----------
    t, y : (n,)
        Times, rising, and values.
    name, unit : str
    node, axis : int, str
        Where it was measured: "x", "-y", ...; 0 and "" where the file does not say.
    quantity : {"displacement", "velocity", "acceleration", "force", ""}
        What it is; "" where the file does not say.
    """

    t: Floats
    y: Floats
    name: str = ""
    unit: str = ""
    node: int = 0
    axis: str = ""
    quantity: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class Frf:
    """A frequency response, motion over force.

    Attributes
    ----------
    f : (n,)
        Frequencies in cycles for each unit of time.
    values : (n,) complex
    node, axis : int, str
        Where the motion was measured: "x", "-y", ...; 0 and "" where the file does not say.
    reference, reference_axis : int, str
        Where the force acted.
    kind : {"accelerance", "mobility", "receptance", ""}
    """

    f: Floats
    values: Complexes
    node: int = 0
    axis: str = ""
    reference: int = 0
    reference_axis: str = ""
    kind: str = ""
    name: str = ""
    unit: str = ""

    def __post_init__(self) -> None:
        f, values = np.asarray(self.f, dtype=float), np.asarray(self.values, dtype=complex)
        if f.ndim != 1 or f.shape != values.shape or f.size < 2:
            raise SceneError(f"Frf: f and values must be two lists of one length, got {f.shape} and {values.shape}")
        if self.kind and self.kind not in KINDS:
            raise SceneError(f"Frf: kind must be one of {', '.join(KINDS)}, got {shown(self.kind)}")
        object.__setattr__(self, "f", f)
        object.__setattr__(self, "values", values)

    @property
    def is_driving_point(self) -> bool:
        """Whether motion and force belong to one node and direction."""
        return self.node == self.reference != 0 and self.axis.lstrip("-") == self.reference_axis.lstrip("-") != ""

    def receptance(self, kind: str | None = None) -> Complexes:
        """Displacement over force (n,); nan at frequency 0 of an accelerance or mobility."""
        power = KINDS[kind or self.kind or "accelerance"]
        s = 2j * np.pi * self.f
        found: Complexes = np.divide(self.values, s**power, out=np.full(self.f.size, np.nan + 0j), where=s != 0)
        return found


@dataclass(frozen=True, kw_only=True, eq=False)
class Modes:
    """Modes of a structure.

    Attributes
    ----------
    frequencies : (k,)
        Angular, rising.
    damping_ratios : (k,)
    nodes : (p,) int
    shapes : (k, p, d)
        Displacements along x, y, z, and rotations where d is 6; complex where the file has them so.  nan: not in the
        file.
    masses : (k,)
        Modal masses; nan where the file has none, or 0.
    round_off : float
        Relative round-off of the shapes in a file: 5e-6 for six digits; 0 where it is that of double precision.
    """

    frequencies: Floats
    damping_ratios: Floats
    nodes: NDArray[np.int64]
    shapes: NDArray[np.inexact]
    masses: Floats
    round_off: float = 0.0

    def __post_init__(self) -> None:
        k, p = np.size(self.frequencies), np.size(self.nodes)
        shapes = np.asarray(self.shapes)
        if (
            np.ndim(self.frequencies) != 1
            or shapes.ndim != 3
            or shapes.shape[:2] != (k, p)
            or shapes.shape[2] not in (3, 6)
        ):
            raise SceneError(
                f"Modes: shapes must be ({k}, {p}, 3) or ({k}, {p}, 6) (modes, nodes, axes); got {shapes.shape}"
            )
        order = np.argsort(self.frequencies, kind="stable")
        set_ = object.__setattr__
        for name in ("frequencies", "damping_ratios", "masses"):
            value = np.asarray(getattr(self, name), dtype=float)
            if value.shape != (k,):
                raise SceneError(f"Modes: {name} must be ({k},), as many as frequencies; got {value.shape}")
            set_(self, name, value[order])
        masses = np.where(self.masses > 0.0, self.masses, np.nan)
        set_(self, "masses", masses)
        set_(self, "nodes", np.asarray(self.nodes, dtype=np.int64))
        set_(self, "shapes", shapes[order])

    @property
    def hertz(self) -> Floats:
        """Frequencies in cycles for each unit of time (k,)."""
        return self.frequencies / (2.0 * np.pi)

    def at(self, node: int, axes: str = "xyz") -> NDArray[np.inexact]:
        """Displacements of a node (len(axes), k).

        Raises
        ------
        UnknownNameError
            If there is no such node.
        """
        found = np.flatnonzero(self.nodes == node)
        if not found.size:
            raise unknown_name("node of the modes", int(node), [str(n) for n in self.nodes.tolist()])
        return self.shapes[:, found[0], ["xyz".index(letter) for letter in axes]].T

    def at_labels(self, labels: NDArray[np.int64]) -> tuple[NDArray[np.inexact], int]:
        """Shapes (n, k) in a given order of (node, dof), and the number of rows of which nothing is known."""
        place = {int(node): i for i, node in enumerate(self.nodes)}
        found = np.full((len(labels), self.frequencies.size), np.nan, dtype=self.shapes.dtype)
        for i, (node, dof) in enumerate(labels.tolist()):
            if node in place and 1 <= dof <= self.shapes.shape[2]:
                found[i] = self.shapes[:, place[node], dof - 1]
        return found, int(np.isnan(found).any(axis=1).sum())


@dataclass(frozen=True, kw_only=True, eq=False)
class Measured:
    """Contents of a file of measurements.

    Attributes
    ----------
    signals : tuple of TimeSeries
    frfs : tuple of Frf
    modes : Modes or None
    points : dict of int to (3,)
        Coordinates of nodes.
    lines : dict of str to tuple of int
        Nodes that are drawn as lines, 0 lifting the pen.
    units : dict of str to float
        One SI unit in the units of the file: ``{"length": 1000.0}`` for mm.
    notes : tuple of str
    """

    signals: tuple[TimeSeries, ...] = ()
    frfs: tuple[Frf, ...] = ()
    modes: Modes | None = None
    points: Mapping[int, Floats] = field(default_factory=dict)
    lines: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    units: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def in_units(self, units: str = "SI") -> Measured:
        """Convert to other units, by the factors that a universal file states (dataset 164).

        Signals and responses are converted where the file says what they are; a note counts others.

        Parameters
        ----------
        units : str
            "SI", or mass-length-time such as "t-mm-s"; times stay seconds.

        Raises
        ------
        SceneError
            If the file does not state its units.
        """
        from fricmb.measure._units import in_units

        return in_units(self, units)

    def __str__(self) -> str:
        rows = [f"{len(self.signals)} signals, {len(self.frfs)} frequency responses, {len(self.points)} points"]
        if self.modes is not None:
            hertz = ", ".join(f"{f:.6g}" for f in self.modes.hertz[:8])
            rows.append(
                f"{self.modes.frequencies.size} modes: {hertz}{', ...' if self.modes.hertz.size > 8 else ''} Hz"
            )
        if self.units:
            rows.append("1 SI is " + ", ".join(f"{value:g} of {name}" for name, value in self.units.items()))
        return "\n".join([*rows, *self.notes])
