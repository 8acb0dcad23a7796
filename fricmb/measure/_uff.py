"""Universal files, by pyuff (extra ``uff``)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fricmb.errors import FileError, MissingExtraError
from fricmb.measure._types import DIRECTIONS, Frf, Measured, Modes, TimeSeries

#: Datasets that are read; others are counted and said.
READ = (15, 2411, 18, 2420, 55, 2414, 58, 82, 164)
#: Kinds by what the ordinate is: displacement, velocity, acceleration over force.
ORDINATES = {8: "receptance", 11: "mobility", 12: "accelerance"}
#: What a signal is, by the same number.
QUANTITIES = {8: "displacement", 9: "force", 11: "velocity", 12: "acceleration", 13: "force"}
#: The line before and behind each dataset.
_MARK = re.compile(rb"^ {4}-1 *\r?$", re.MULTILINE)
#: Types of functions of dataset 58.
FREQUENCY_RESPONSE = 4


def read(path: Path, over: tuple[float, float] | str | None) -> Measured:
    """All datasets that are known."""
    try:
        import pyuff
    except ImportError:
        raise MissingExtraError(f"measure.read of {path.name}", "pyuff", "uff") from None
    with path.open("rb") as file:
        head = file.read(200)
    if not head.lstrip().startswith(b"-1"):
        raise FileError(f"{path}: expected a universal file, whose first line is -1")
    data = path.read_bytes()
    # behind binary values the last mark begins no line
    if len(_MARK.findall(data)) % 2 and not data.rstrip().endswith(b"    -1"):
        raise FileError(f"{path}: the last dataset is cut off: expected a line -1 at its end")
    uff = pyuff.UFF(str(path))
    kinds = [int(kind) for kind in uff.get_set_types()]
    sets = [_one(path, uff, number, kind) for number, kind in enumerate(kinds) if kind in READ]
    others = sorted({*kinds} - {*READ})
    return _measured(path, sets, others)


def _one(path: Path, uff: Any, number: int, kind: int) -> Mapping[str, Any]:
    try:
        found: Mapping[str, Any] = uff.read_sets(number)
    except Exception as error:
        raise FileError(
            f"{path}: dataset {number + 1} (type {kind}) cannot be read ({type(error).__name__}: {error})"
        ) from error
    return found


def _measured(path: Path, sets: list[Mapping[str, Any]], others: list[int]) -> Measured:
    points: dict[int, Any] = {}
    lines: dict[str, tuple[int, ...]] = {}
    units: dict[str, float] = {}
    functions, modes = [], []
    for number, held in enumerate(sets, 1):
        kind = int(held["type"])
        if kind in (15, 2411):
            nodes = np.asarray(held["node_nums"]).astype(np.int64)
            points |= dict(zip(nodes.tolist(), np.column_stack([held["x"], held["y"], held["z"]]), strict=True))
        elif kind == 82:
            lines[str(held["id"]).strip()] = tuple(int(node) for node in held["nodes"])
        elif kind == 164:
            units |= {key: float(held[key]) for key in ("length", "force") if key in held}
        elif kind == 58:
            functions.append(_function(path, number, held))
        elif kind in (55, 2414):
            mode = _mode(path, number, held)
            modes += [] if mode is None else [mode]
    notes = () if not others else (f"datasets of types {', '.join(map(str, others))} are not read",)
    return Measured(
        signals=tuple(f for f in functions if isinstance(f, TimeSeries)),
        frfs=tuple(f for f in functions if isinstance(f, Frf)),
        modes=_together(path, modes),
        points=points,
        lines=lines,
        units=units,
        notes=notes,
    )


def _axis(direction: Any) -> str:
    number = int(direction)
    name = DIRECTIONS[abs(number)] if abs(number) < len(DIRECTIONS) else ""
    return f"-{name}" if number < 0 and name else name


def _function(path: Path, number: int, held: Mapping[str, Any]) -> TimeSeries | Frf:
    x, values = np.asarray(held["x"], dtype=float), np.asarray(held["data"])
    said = int(held.get("num_pts", values.size))
    if said > values.size:
        raise FileError(f"{path}: function {number}: it announces {said} values, got {values.size}")
    if x.shape != values.shape:
        raise FileError(f"{path}: function {number}: expected {x.size} values, got {values.size}")
    where: dict[str, Any] = {"node": int(held["rsp_node"]), "axis": _axis(held["rsp_dir"])}
    unit, name = str(held.get("ordinate_axis_units_lab", "")).strip(), str(held.get("id1", "")).strip()
    plain: dict[str, Any] = {"name": "" if name == "NONE" else name, "unit": "" if unit == "NONE" else unit}
    ordinate = int(held.get("ordinate_spec_data_type", 0))
    if int(held["func_type"]) != FREQUENCY_RESPONSE and not np.iscomplexobj(values):
        plain["name"] = plain["name"] or str(held.get("rsp_ent_name", "")).strip()
        quantity = QUANTITIES.get(ordinate, "")
        return TimeSeries(t=x, y=values.astype(float), quantity=quantity, **where, **plain)
    return Frf(
        f=x,
        values=values.astype(complex),
        reference=int(held["ref_node"]),
        reference_axis=_axis(held["ref_dir"]),
        kind=ORDINATES.get(ordinate, ""),
        **where,
        **plain,
    )


def _mode(path: Path, number: int, held: Mapping[str, Any]) -> dict[str, Any] | None:
    """One mode; None for results of another kind."""
    if int(held["analysis_type"]) not in (2, 3, 7):
        return None
    if int(held["type"]) == 55:
        columns = [np.asarray(held[f"r{i}"]) for i in range(1, 7) if f"r{i}" in held]
        shape = np.column_stack(columns)
        if "freq" in held:
            frequency, damping = float(held["freq"]), float(held.get("modal_damp_vis", 0.0))
            mass = float(held.get("modal_m", 0.0))
        else:
            pole = complex(held["eig"])
            frequency, damping, mass = abs(pole) / (2 * np.pi), -pole.real / abs(pole), 0.0
    else:
        frequency, mass = float(held["record12_field2"]), float(held["record12_field4"])
        damping = float(held["record12_field5"])
        shape = np.asarray(held["data_at_node"], dtype=float)
        width = int(held["number_of_data_values_for_the_data_component"])
        if int(held["data_type"]) in (5, 6):  # real and imaginary parts in turn
            shape = shape.reshape(len(shape), width, 2) @ np.array([1.0, 1j])
        if not np.imag(shape).any():
            shape = shape.real
    nodes = np.asarray(held["node_nums"]).astype(np.int64)
    if shape.shape[0] != nodes.size or shape.shape[1] not in (3, 6):
        raise FileError(f"{path}: mode {number}: expected 3 or 6 values at {nodes.size} nodes, got {shape.shape}")
    return {"frequency": frequency, "damping": damping, "mass": mass, "nodes": nodes, "shape": shape}


def _together(path: Path, modes: list[dict[str, Any]]) -> Modes | None:
    """One table of all modes, nan where one says nothing of a node."""
    if not modes:
        return None
    nodes = np.unique(np.concatenate([mode["nodes"] for mode in modes]))
    width = max(mode["shape"].shape[1] for mode in modes)
    complex_ones = any(np.iscomplexobj(mode["shape"]) for mode in modes)
    shapes = np.full((len(modes), nodes.size, width), np.nan, dtype=complex if complex_ones else float)
    for i, mode in enumerate(modes):
        shapes[i, np.searchsorted(nodes, mode["nodes"]), : mode["shape"].shape[1]] = mode["shape"]
    return Modes(
        frequencies=2.0 * np.pi * np.array([mode["frequency"] for mode in modes]),
        damping_ratios=np.array([mode["damping"] for mode in modes]),
        masses=np.array([mode["mass"] for mode in modes]),
        nodes=nodes,
        shapes=shapes,
    )
