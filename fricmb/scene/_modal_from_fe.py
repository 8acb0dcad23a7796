"""Modal bodies from finite element models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.errors import SceneError, shown
from fricmb.values import Parameter, as_float, is_expression, value_of

if TYPE_CHECKING:
    from fricmb.fe import FEModel
    from fricmb.scene._modal import ModalBody


def from_fe(
    cls: type[ModalBody], name: str, fe: FEModel, points: Any, axes: str, normals: Any, up_to: Any, n_modes: Any,
    residual: bool, enrich: Any, scales: Any, structural_at: Any, tolerance: Any, damping_ratios: Any,
    fields: dict[str, Any],
) -> ModalBody:  # fmt: skip
    """See :meth:`ModalBody.from_fe`."""
    from fricmb.fe import FEModel
    from fricmb.fe._places import checked_scales
    from fricmb.fe._whole import ROUND_OFF, asymmetry, symmetric_part
    from fricmb.integrate.run.one_thread import one_thread
    from fricmb.reduction import reduce_model

    label = f"ModalBody {name!r}"
    if not isinstance(fe, FEModel):
        raise SceneError(f"{label}: fe must be an FEModel, as fm.fe.read gives, got {shown(fe)}")
    if not isinstance(axes, str) or not axes or len(set(axes)) < len(axes) or not set(axes) <= set("xyz"):
        raise SceneError(f"{label}: axes must be any of 'x', 'y', 'z' in a string, got {shown(axes)}")
    if damping_ratios is not None and (fe.C is not None or fe.H is not None):
        raise SceneError(f"{label}: the model has damping of its own; damping_ratios has to be left out")
    for key in ("M", "K"):
        uneven = asymmetry(fe.matrix(key))
        if uneven > ROUND_OFF[fe.precision]:
            remedy = "; FEModel.symmetrised() makes the rest, as friction leaves it, a part" if key == "K" else ""
            raise SceneError(f"{label}: {key} of the model must be symmetric; its asymmetry is {uneven:.2g}{remedy}")
    cycles = _positive(label, "up_to", up_to)
    count = _count(label, n_modes, fe.n)
    if cycles is None and count is None:
        raise SceneError(f"{label}: give up_to, a frequency, or n_modes")
    at = _positive(label, "structural_at", structural_at)
    factors = {**fe.scales, **checked_scales(label, scales or {}, fe.parts)}
    rows = point_rows(label, fe, points, axes, normals)
    with one_thread("openblas"):  # most is sparse, or in small blocks
        found = reduce_model(
            label,
            {"M": symmetric_part(fe.M), "K": symmetric_part(fe.K), "C": fe.C, "H": fe.H},
            fe.parts,
            rows,
            count=count,
            top=None if cycles is None else 2.0 * np.pi * cycles,
            residual=bool(residual),
            samples=_samples(label, fe, enrich, factors),
            structural_at=None if at is None else 2.0 * np.pi * at,
            tolerance=_positive(label, "tolerance", tolerance) or 1e-6,
        )
    ratios = damping_ratios
    if ratios is None:
        ratios = 0.0 if found.damping is not None else found.damping_ratios
    return cls(
        name,
        frequencies=found.frequencies,
        damping_ratios=ratios,
        shapes=found.shapes,
        axes=axes,
        damping=found.damping,
        residual=found.residual,
        neglected=found.neglected,
        parts=found.parts,
        scales=factors,
        errors=found.errors,
        **fields,
    )


def _positive(label: str, argument: str, value: Any) -> float | None:
    if value is None:
        return None
    number = as_float(value)
    if not (np.isfinite(number) and number > 0.0):
        raise SceneError(f"{label}: {argument} must be a finite number > 0, got {shown(value)}")
    return number


def _count(label: str, value: Any, n: int) -> int | None:
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not 1 <= value <= n:
        raise SceneError(f"{label}: n_modes must be an integer from 1 to {n}, got {shown(value)}")
    return int(value)


def point_rows(label: str, fe: FEModel, points: Any, axes: str, normals: Any) -> dict[str, Any]:
    """Rows (len(axes), n) of each point; a list of nodes gives one point for each, ``name_node``."""
    from fricmb.fe._places import surface_frame
    from fricmb.reduction import displacement_rows

    if not isinstance(points, Mapping) or not points:
        raise SceneError(f"{label}: points must be a dict of name to nodes, with at least one; got {shown(points)}")
    if normals is not None and normals != "surface" and not isinstance(normals, Mapping):
        accepted = "'surface', a dict of point to normal, or None"
        raise SceneError(f"{label}: normals must be {accepted}, got {shown(normals)}")
    found: dict[str, Any] = {}
    for name, value in points.items():
        given = value.toarray() if hasattr(value, "toarray") else np.asarray(value)
        if fe.labels is None or given.dtype.kind == "f":
            found[name] = displacement_rows(label, name, given, len(axes), fe.n)
            continue
        if given.dtype.kind not in "iu" or given.ndim > 1 or given.size == 0:
            raise SceneError(
                f"{label}: points[{name!r}] must be the number of a node, numbers of nodes, or rows of shape"
                f" ({len(axes)}, {fe.n}); got {shown(value)}"
            )
        turn = None
        if normals == "surface" and given.ndim == 1:
            turn = surface_frame(fe, given, f"{label}: points[{name!r}]")
        elif isinstance(normals, Mapping) and name in normals:
            turn = _frame(label, name, normals[name])
        for node in given.ravel().tolist():
            found[name if given.ndim == 0 else f"{name}_{node}"] = fe.rows(node, axes, turn)
    return found


def _frame(label: str, name: str, normal: Any) -> Any:
    """Axes whose third is a normal, the first as near to global x as it can be."""
    n = np.asarray(normal, dtype=float)
    if n.shape != (3,) or not np.linalg.norm(n) > 0.0:
        raise SceneError(f"{label}: normals[{name!r}] must be three numbers, not all 0; got {shown(normal)}")
    n = n / np.linalg.norm(n)
    first = np.eye(3)[int(abs(n[0]) > 0.9)]
    first = first - (first @ n) * n
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(n, first), n])


def _samples(label: str, fe: FEModel, enrich: Any, scales: Mapping[str, Any]) -> list[dict[str, tuple[str, float]]]:
    """Of each sample the parts, what they are added to, and their factors."""
    from fricmb.fe._convert import part_target

    if not isinstance(enrich, Sequence) or isinstance(enrich, str) or not all(isinstance(e, Mapping) for e in enrich):
        raise SceneError(f"{label}: enrich must be a list of dicts such as [{{'mu': 0.4}}], got {shown(enrich)}")
    found = []
    for sample in enrich:
        values = {key: as_float(value) for key, value in sample.items()}
        named = {p.name for expression in scales.values() for p in _parameters(expression)}
        for key, value in values.items():
            if key not in fe.parts and key not in named:
                raise SceneError(
                    f"{label}: {key!r} in enrich is neither a part of the model ({', '.join(fe.parts) or 'none'}) nor a"
                    f" parameter in scales; give scales={{part: expression of {key}}}, here or to the model"
                )
            if not np.isfinite(value):
                raise SceneError(f"{label}: {key!r} in enrich must be a finite number, got {shown(sample[key])}")
        factors = {part: _value(expression, values) for part, expression in scales.items()}
        factors |= {key: value for key, value in values.items() if key in fe.parts}
        found.append({part: (part_target(part), value) for part, value in factors.items() if value != 0.0})
    return found


def _parameters(expression: Any) -> list[Parameter]:
    from fricmb.values import parameters_in

    return list(parameters_in(expression))


def _value(expression: Any, values: Mapping[str, float]) -> float:
    """An expression of parameters, some of them with other values than their own."""
    from fricmb.values._numbers import substitute

    changed = substitute(expression, {p.name: values[p.name] for p in _parameters(expression) if p.name in values})
    return float(value_of(changed)) if is_expression(changed) or isinstance(changed, Parameter) else float(changed)
