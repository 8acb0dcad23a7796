"""Nodes of a model: labels, coordinates, frames, sets, and the rows that give their displacement."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fricmb.errors import SceneError, shown, unknown_name
from fricmb.fe._whole import Floats
from fricmb.values import as_float, value_of

if TYPE_CHECKING:
    from fricmb.fe._model import FEModel

Ints = NDArray[np.int64]


def checked_labels(label: str, given: Any, n: int) -> Ints | None:
    """Labels (n, 2), different from each other; None where there are none."""
    if given is None:
        return None
    labels = np.asarray(given)
    if labels.dtype.kind not in "iu" or labels.shape != (n, 2):
        raise SceneError(f"{label}: labels must be ({n}, 2) integers, (node, dof) of each row; got {shown(given)}")
    labels = labels.astype(np.int64)
    if ((labels[:, 1] < 0) | (labels[:, 1] > 6)).any():
        raise SceneError(f"{label}: labels must have degrees of freedom from 0 to 6; got {labels[:, 1].max()}")
    different, count = np.unique(labels, axis=0, return_counts=True)
    if count.max() > 1:
        node, dof = different[np.argmax(count)].tolist()
        raise SceneError(f"{label}: labels must be different; dof {dof} of node {node} stands {count.max()} times")
    return labels


def checked_frames(label: str, coordinates: Any, frames: Any) -> tuple[dict[int, Floats], dict[int, Floats]]:
    """Coordinates and axes by number of node."""
    if not isinstance(coordinates, Mapping) or not isinstance(frames, Mapping):
        raise SceneError(f"{label}: coordinates and frames must be dicts by number of node")
    places = {int(node): np.asarray(at, dtype=float) for node, at in coordinates.items()}
    for node, at in places.items():
        if at.shape != (3,) or not np.isfinite(at).all():
            raise SceneError(f"{label}: coordinates of node {node} must be 3 numbers, got {shown(at)}")
    axes = {int(node): np.asarray(turn, dtype=float) for node, turn in frames.items()}
    for node, turn in axes.items():
        if turn.shape != (3, 3) or not np.allclose(turn @ turn.T, np.eye(3), atol=1e-6):
            raise SceneError(f"{label}: frames of node {node} must be three axes at right angles, rows of (3, 3)")
    return places, axes


def checked_sets(label: str, sets: Any) -> dict[str, Ints]:
    """Numbers of nodes by name."""
    if not isinstance(sets, Mapping):
        raise SceneError(f"{label}: sets must be a dict of name to numbers of nodes, got {shown(sets)}")
    found = {}
    for name, nodes in sets.items():
        numbers = np.atleast_1d(np.asarray(nodes))
        if numbers.dtype.kind not in "iu" or numbers.ndim != 1:
            raise SceneError(f"{label}: sets[{name!r}] must be numbers of nodes, got {shown(nodes)}")
        found[str(name)] = numbers.astype(np.int64)
    return found


def checked_scales(label: str, scales: Any, parts: Mapping[str, Any]) -> dict[str, Any]:
    """Numbers, parameters or expressions by name of part."""
    if not isinstance(scales, Mapping):
        raise SceneError(f"{label}: scales must be a dict of part to number, parameter or expression")
    for part, value in scales.items():
        if part not in parts:
            raise unknown_name(f"part in scales of {label}", part, parts)
        if not np.isfinite(as_float(value_of(value))):
            raise SceneError(f"{label}: scales[{part!r}] must be a finite number or an expression, got {shown(value)}")
    return dict(scales)


def point_rows(fe: FEModel, node: int, axes: str, turn: Floats | None) -> Floats:
    """See :meth:`FEModel.rows`."""
    if fe.labels is None:
        raise SceneError(f"{fe._label()}: node {node} cannot be found without labels")
    here = np.flatnonzero(fe.labels[:, 0] == node)
    if not here.size:
        raise SceneError(f"{fe._label()}: there is no node {node} with degrees of freedom")
    whole = np.zeros((3, fe.n))
    frame = fe.frames.get(node, np.eye(3))
    for i in here:
        dof = int(fe.labels[i, 1])
        if 1 <= dof <= 3:
            whole[:, i] = frame[dof - 1]
    rows = whole if turn is None else turn @ whole
    rows = rows[["xyz".index(letter) for letter in axes]]
    empty = np.flatnonzero(~rows.any(axis=1))
    if empty.size:
        raise SceneError(f"{fe._label()}: node {node} has no displacement along {axes[empty[0]]!r} (it may be fixed)")
    return rows


def surface_frame(fe: FEModel, nodes: Ints, label: str) -> Floats:
    """Axes (3, 3) of a face: two along the plane that fits its nodes best, the first as near to global x as it can be.

    The third is the normal; it points to the side that has fewer of the model's nodes, out of the body.

    Raises
    ------
    SceneError
        If the nodes have no coordinates or lie on one line.
    """
    missing = [int(node) for node in nodes if int(node) not in fe.coordinates]
    if missing:
        raise SceneError(f"{label}: normals='surface' needs coordinates; node {missing[0]} has none")
    face = np.array([fe.coordinates[int(node)] for node in nodes])
    centre = face.mean(axis=0)
    sizes, directions = np.linalg.svd(face - centre)[1:]
    if len(nodes) < 3 or sizes[1] < 1e-6 * sizes[0]:
        raise SceneError(f"{label}: normals='surface' needs at least three nodes that are not on one line")
    normal = directions[2]
    every = np.array(list(fe.coordinates.values()))
    if np.sum((every - centre) @ normal) > 0.0:
        normal = -normal
    first = np.eye(3)[int(np.argmin(np.abs(normal) > 0.9))]
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(normal, first), normal])
