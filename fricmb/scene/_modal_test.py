"""Modal bodies from test data, their frequency responses, and how they compare with measured ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fricmb.errors import SceneError, shown, unknown_name
from fricmb.scene._modal_from import modal_matrices
from fricmb.values import value_of

if TYPE_CHECKING:
    from fricmb.measure import Comparison, Modes
    from fricmb.scene._modal import ModalBody

Complexes = NDArray[np.complex128]
#: Residue of the other sign, over the largest, that a driving point cannot have.
AGAINST = 0.02
#: Imaginary part of a shape over its real one, at best, beyond which it is no normal mode.
COMPLEX = 0.3


def from_test(
    cls: type[ModalBody], name: str, modes: Any, points: Any, scale: Any, axes: str, fields: dict[str, Any]
) -> ModalBody:
    """See :meth:`ModalBody.from_test`."""
    label = f"ModalBody {name!r}"
    found = modes_of(label, modes)
    if not isinstance(points, Mapping) or not points:
        raise SceneError(f"{label}: points must be a dict of name to node, with at least one; got {shown(points)}")
    if not isinstance(axes, str) or not axes or not set(axes) <= set("xyz"):
        raise SceneError(f"{label}: axes must be any of 'x', 'y', 'z' in a string, got {shown(axes)}")
    turn = _phases(label, found)
    shapes = {}
    for point, node in points.items():
        rows = (found.at(node, axes) * turn).real
        lacking = np.flatnonzero(~np.isfinite(rows).all(axis=1))
        if lacking.size:
            raise SceneError(f"{label}: node {node} was not measured along {axes[lacking[0]]!r}; leave it out of axes")
        shapes[point] = rows
    ratios = fields.pop("damping_ratios", found.damping_ratios)
    return cls(
        name,
        frequencies=found.frequencies,
        damping_ratios=ratios,
        shapes=shapes,
        masses=_masses(label, found, turn, scale),
        axes=axes,
        **fields,
    )


def modes_of(label: str, given: Any) -> Modes:
    """The modes in what was given.

    Raises
    ------
    SceneError
    """
    from fricmb.measure import Measured, Modes

    found = given.modes if isinstance(given, Measured) else given
    if not isinstance(found, Modes):
        raise SceneError(f"{label}: modes must be Modes, or what fm.measure.read found, with modes; got {shown(given)}")
    return found


def _phases(label: str, modes: Modes) -> Any:
    """Factors (k,) of magnitude 1 that make shapes as real as they can be."""
    if not np.iscomplexobj(modes.shapes):
        return np.ones(modes.frequencies.size)
    flat = np.nan_to_num(modes.shapes.reshape(modes.frequencies.size, -1))
    turn = np.exp(-0.5j * np.angle(np.sum(flat**2, axis=1)))
    turned = flat * turn[:, None]
    rest = np.linalg.norm(turned.imag, axis=1) / np.maximum(np.linalg.norm(turned.real, axis=1), 1e-300)
    worst = int(np.argmax(rest))
    if rest[worst] > COMPLEX:
        raise SceneError(
            f"{label}: mode {worst + 1} at {modes.hertz[worst]:.6g} Hz is complex: its imaginary part is"
            f" {rest[worst]:.2g} of its real one, at most {COMPLEX} can be taken for a normal mode"
        )
    # a sign of its own has none: the first residues keep theirs
    return turn * np.where(np.sum((flat * turn[:, None]).real * flat.real, axis=1) < 0.0, -1.0, 1.0)


def _masses(label: str, modes: Modes, turn: Any, scale: Any) -> Any:
    """Modal masses: those of the file, or by a driving point.

    The residue of a driving point is ``phi^2/m``: above 0 for every mode.
    """
    from fricmb.measure import Frf
    from fricmb.measure._identify import residues

    if scale is None:
        lacking = np.flatnonzero(~np.isfinite(modes.masses))
        if lacking.size:
            raise SceneError(
                f"{label}: mode {lacking[0] + 1} at {modes.hertz[lacking[0]]:.6g} Hz has no modal mass; give scale=,"
                " the frequency response of a driving point"
            )
        return modes.masses
    if not isinstance(scale, Frf):
        raise SceneError(f"{label}: scale must be a Frf, of a driving point, got {shown(scale)}")
    where = f"node {scale.node} {scale.axis}"
    if not scale.is_driving_point:
        raise SceneError(
            f"{label}: scale must be of a driving point; it is motion of {where} over a force on node"
            f" {scale.reference} {scale.reference_axis}"
        )
    found = residues(scale, modes)
    against = np.flatnonzero(found < -AGAINST * np.abs(found).max())
    if against.size:
        which = ", ".join(f"{modes.hertz[i]:.6g}" for i in against[:6])
        raise SceneError(
            f"{label}: scale is labelled as of a driving point, {where}, but residues at {which} Hz have the"
            " sign of motion against the force"
        )
    own = (modes.at(scale.node, scale.axis.lstrip("-"))[0] * turn).real
    still = np.flatnonzero((found <= 1e-4 * found.max()) | (np.abs(own) <= 1e-6 * np.nanmax(np.abs(own))))
    if still.size or not np.isfinite(own).all():
        which = f"mode {still[0] + 1} at {modes.hertz[still[0]]:.6g} Hz" if still.size else "a mode"
        raise SceneError(f"{label}: {which} hardly moves at the driving point, {where}, and cannot be scaled by it")
    return own**2 / found


def frf(body: ModalBody, a: Any, b: Any, f: Any, kind: str, residual: bool) -> Complexes:
    """See :meth:`ModalBody.frf`."""
    from fricmb.measure._types import KINDS

    label = body._label()
    if kind not in KINDS:
        raise SceneError(f"{label}: kind must be one of {', '.join(KINDS)}, got {shown(kind)}")
    try:
        cycles = np.atleast_1d(np.asarray(f, dtype=float))
    except (TypeError, ValueError):
        cycles = np.zeros((0, 0))
    if cycles.ndim != 1 or not np.isfinite(cycles).all() or not (cycles >= 0.0).all():
        raise SceneError(f"{label}: f must be frequencies >= 0, in cycles for each unit of time, got {shown(f)}")
    count = body.n_modes if residual else body.n_modes - body.residual
    m, k, c = (x[:count] for x in modal_matrices(body))
    out, on = _row(body, a)[:count], _row(body, b)[:count]
    s = 2j * np.pi * cycles
    if c.ndim == 1:
        stiff = k + s[:, None] * c + s[:, None] ** 2 * m
        if (stiff == 0.0).any():
            raise SceneError(f"{label}: a rigid body has no response at frequency 0")
        found = np.sum(out * on / stiff, axis=1)
    else:
        c = c[:, :count]
        found = np.array([out @ np.linalg.solve(np.diag(k + z**2 * m) + z * c, on) for z in s])
    return np.asarray(found * s ** KINDS[kind], dtype=complex)


def _row(body: ModalBody, where: Any) -> Any:
    """Modal displacements of "point.axis"."""
    point, _, axis = where.rpartition(".") if isinstance(where, str) else ("", "", "")
    if point not in body.shapes:
        raise unknown_name(f"point of {body._label()}", where, [f"{p}.{x}" for p in body.shapes for x in body.axes])
    letter = axis.lstrip("-")
    if letter not in body.axes or len(letter) != 1:
        raise unknown_name(f"axis of {body._label()}", axis, body.axes)
    row = np.asarray(value_of(body.shapes[point]), dtype=float)[body.axes.index(letter)]
    return -row if axis.startswith("-") else row


def compare(body: ModalBody, test: Any, points: Any) -> Comparison:
    """See :meth:`ModalBody.compare`."""
    from fricmb.measure import Comparison, Frf, Measured, Modes
    from fricmb.measure._compare import assurance, likeness, paired

    label = body._label()
    modes = test.modes if isinstance(test, Measured) else test if isinstance(test, Modes) else None
    frfs = test.frfs if isinstance(test, Measured) else (test,) if isinstance(test, Frf) else ()
    if isinstance(test, list | tuple) and all(isinstance(x, Frf) for x in test):
        frfs = tuple(test)
    if modes is None and not frfs:
        raise SceneError(
            f"{label}: test must be Modes, Frf, a list of Frf, or what fm.measure.read found; got {shown(test)}"
        )
    nodes = _nodes(body, points)
    count = body.n_modes - body.residual
    omega = np.asarray(value_of(body.frequencies), dtype=float)[:count]
    mac, test_omega = np.zeros((0, 0)), np.zeros(0)
    pairs: tuple[tuple[int, int], ...] = ()
    ratios = np.zeros((2, 0))
    if modes is not None:
        own, other = _shapes(body, modes, nodes, count)
        mac, test_omega = assurance(own, other), modes.frequencies
        pairs = paired(mac, omega, test_omega)
        ratios = np.array([(_ratio(body, i), modes.damping_ratios[j]) for i, j in pairs]).reshape(-1, 2).T
    by_node = {node: point for point, node in nodes.items()}
    responses = []
    for one in frfs:
        if one.node in by_node and one.reference in by_node and one.kind:
            here, there = f"{by_node[one.node]}.{one.axis}", f"{by_node[one.reference]}.{one.reference_axis}"
            responses.append((one, frf(body, here, there, one.f, one.kind, True)))
    if modes is None and not responses:
        raise SceneError(
            f"{label}: no response of the test lies between two of its points, with axes and a kind; see points="
        )
    return Comparison(
        mac=mac,
        pairs=pairs,
        frequencies=(omega, test_omega),
        frequency_differences=np.array([omega[i] / test_omega[j] - 1.0 for i, j in pairs]),
        damping_differences=ratios[0] - ratios[1],
        responses=tuple(responses),
        r2=tuple(likeness(one.values, computed) for one, computed in responses),
    )


def _nodes(body: ModalBody, points: Any) -> dict[str, int]:
    """Node of each point: as given, or the number that its name ends with."""
    if points is None:
        found = {}
        for name in body.shapes:
            number = name.rpartition("_")[2]
            if number.isdecimal():
                found[name] = int(number)
        if not found:
            raise SceneError(f"{body._label()}: points must say which node of the test each point is")
        return found
    if not isinstance(points, Mapping) or not points:
        raise SceneError(f"{body._label()}: points must be a dict of point to node of the test, got {shown(points)}")
    for name in points:
        body.point(name)
    return {str(name): int(node) for name, node in points.items()}


def _shapes(body: ModalBody, modes: Modes, nodes: Mapping[str, int], count: int) -> tuple[Any, Any]:
    """Shapes of body and test by columns, at points and axes where both have them."""
    own, other = [], []
    for point, node in nodes.items():
        rows = np.asarray(value_of(body.shapes[point]), dtype=float)[:, :count]
        measured = modes.at(node, body.axes)
        kept = np.isfinite(measured).all(axis=1)
        own.append(rows[kept])
        other.append(measured[kept])
    if not sum(len(x) for x in own):
        raise SceneError(f"{body._label()}: nothing was measured along {body.axes} at its points")
    return np.vstack(own), np.vstack(other)


def _ratio(body: ModalBody, i: int) -> float:
    """Damping ratio of a mode, of the diagonal where damping is a matrix."""
    m, k, c = modal_matrices(body)
    own = c[i] if c.ndim == 1 else c[i, i]
    return float(own / (2.0 * np.sqrt(k[i] * m[i]))) if k[i] > 0.0 else 0.0
