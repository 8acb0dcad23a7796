"""Models tied at the nodes that they share."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse

from fricmb.errors import SceneError, shown
from fricmb.fe._model import FEModel, Ints


def join(first: FEModel, *others: FEModel, name: str | None = None) -> FEModel:
    """Join models that share nodes into one: equal (node, dof) move together.

    Parameters
    ----------
    first, *others : FEModel
        With labels.  Of two superelements one may lack the numbers of its boundary nodes: its boundary is then that of
        the other, in order (a note says so).
    name : str, optional

    Returns
    -------
    FEModel

    Raises
    ------
    SceneError
        If models share nothing, or are in different units.

    Examples
    --------
    >>> import numpy as np
    >>> import fricmb as fm
    >>> spring = np.array([[1.0, -1.0], [-1.0, 1.0]])
    >>> left = fm.fe.FEModel(M=np.eye(2), K=spring, labels=[(1, 1), (2, 1)], name="left")
    >>> right = fm.fe.FEModel(M=np.eye(2), K=spring, labels=[(2, 1), (3, 1)], name="right")
    >>> fm.fe.join(left, right).M.toarray().diagonal()
    array([1., 2., 1.])
    """
    for model in (first, *others):
        if not isinstance(model, FEModel):
            raise SceneError(f"fe.join: expected FEModels, got {shown(model)}")
    found = first
    for other in others:
        found = _pair(found, other, name or f"{found.name}+{other.name}")
    return found


def _pair(a: FEModel, b: FEModel, name: str) -> FEModel:
    if a.units is not None and b.units is not None and a.units != b.units:
        raise SceneError(f"fe.join: {a.name!r} is in {a.units}, {b.name!r} in {b.units}; see FEModel.in_units")
    labels_a, labels_b, notes = _labels(a, b)
    index = {(node, dof): i for i, (node, dof) in enumerate(labels_a.tolist()) if dof > 0}
    place, labels = np.empty(b.n, dtype=np.int64), labels_a.tolist()
    inner = int(min(labels_a[:, 0].min(), 0))
    for i, (node, dof) in enumerate(labels_b.tolist()):
        if dof > 0 and (node, dof) in index:
            place[i] = index[node, dof]
            continue
        place[i] = len(labels)
        inner -= dof == 0
        labels.append([node, dof] if dof > 0 else [inner, 0])
    shared = int(np.count_nonzero(place < a.n))
    if not shared:
        raise SceneError(f"fe.join: {a.name!r} and {b.name!r} share no degree of freedom")
    n = len(labels)
    from_a = scipy.sparse.eye_array(a.n, n, format="csr")
    from_b = _turned(a, b, labels_b) @ scipy.sparse.csr_array((np.ones(b.n), (np.arange(b.n), place)), shape=(b.n, n))

    def sum_of(left: Any, right: Any) -> Any:
        found = [T.T @ A @ T for T, A in ((from_a, left), (from_b, right)) if A is not None]
        return sum(found[1:], found[0]) if found else None

    parts = {key: sum_of(a.parts.get(key), b.parts.get(key)) for key in dict.fromkeys((*a.parts, *b.parts))}
    return FEModel(
        M=sum_of(a.M, b.M), K=sum_of(a.K, b.K), C=sum_of(a.C, b.C), H=sum_of(a.H, b.H),
        parts=parts,
        triangles=dict.fromkeys(parts, "full"),
        scales={**b.scales, **a.scales},
        labels=np.array(labels),
        coordinates={**b.coordinates, **a.coordinates},
        frames={**b.frames, **a.frames},
        sets={**b.sets, **a.sets},
        units=a.units or b.units,
        name=name,
        notes=(*a.notes, *b.notes, *notes, f"{shared} degrees of freedom of {a.name!r} and {b.name!r} move together"),
    )  # fmt: skip


def _labels(a: FEModel, b: FEModel) -> tuple[Ints, Ints, list[str]]:
    """Labels of both; a boundary without numbers gets those of the other."""
    if a.labels is not None and b.labels is not None:
        return a.labels, b.labels, []
    bare = a if a.labels is None else b
    if a.boundary is None or b.boundary is None or a.boundary != b.boundary:
        sizes = f"boundaries of {a.boundary or 'unknown size'} and {b.boundary or 'unknown size'}"
        raise SceneError(f"fe.join: {bare.name!r} has no labels, and {sizes} do not say what belongs together")
    known = a.labels if a.labels is not None else b.labels
    boundary = (
        np.column_stack([-1 - np.arange(a.boundary), np.ones(a.boundary)]) if known is None else known[: a.boundary]
    )
    inner = int(min(boundary[:, 0].min(), 0))

    def named(model: FEModel) -> Ints:
        if model.labels is not None:
            held: Ints = model.labels
            return held
        rest = model.n - int(model.boundary or 0)
        modal = np.column_stack([inner - 1 - np.arange(rest), np.zeros(rest)])
        whole: Ints = np.asarray(np.vstack([boundary, modal]), dtype=np.int64)
        return whole

    note = f"boundary of {bare.name!r} has no numbers of nodes: taken in the order of the other's"
    return named(a), named(b), [note]


def _turned(a: FEModel, b: FEModel, labels: Ints) -> Any:
    """What turns degrees of freedom of shared nodes from a's axes into b's (n_b, n_b)."""
    turn = scipy.sparse.lil_array(scipy.sparse.eye_array(b.n))
    where = {(node, dof): i for i, (node, dof) in enumerate(labels.tolist())}
    for node in a.coordinates.keys() & b.coordinates.keys():
        R = b.frames.get(node, np.eye(3)) @ a.frames.get(node, np.eye(3)).T
        if np.allclose(R, np.eye(3), atol=1e-9):
            continue
        for start in (1, 4):
            here = [where[node, start + k] for k in range(3) if (node, start + k) in where]
            if 0 < len(here) < 3:
                raise SceneError(f"fe.join: axes of node {node} differ, and not all of its dofs are free")
            for i, row in zip(here, R, strict=False):
                turn[[i], here] = row
    return turn.tocsr()
