"""Coordinates and sets of nodes from input files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fricmb._files import text_of
from fricmb.errors import FileError
from fricmb.fe import _ansys, _nastran


def read(path: Path) -> dict[str, Any]:
    """Coordinates, sets, and axes of nodes where the format says them."""
    ending = path.suffix.lower()
    if ending == ".inp":
        return _inp(path)
    if ending == ".cdb":
        archive = _ansys.reader(f"fe.read of {path.name}").Archive(str(path), parse_vtk=False)
        places = dict(zip(archive.nnum.tolist(), archive.nodes[:, :3], strict=True))
        return {"coordinates": places, "sets": {key: np.asarray(v) for key, v in archive.node_components.items()}}
    if ending in (".bdf", ".dat", ".asm"):
        grids = _nastran.library(f"fe.read of {path.name}").bulk2uset(str(path))[0]
        table, index = grids.iloc[:, 1:].to_numpy(dtype=float), grids.index.to_list()
        nodes = {int(index[i][0]): i for i in range(0, len(table), 6)}
        frames = {node: table[i + 3 : i + 6].T for node, i in nodes.items()}
        return {"coordinates": {node: table[i] for node, i in nodes.items()}, "frames": frames}
    raise FileError(f"{path}: expected nodes in .inp (Abaqus, CalculiX), .cdb (Ansys), .bdf or .dat (Nastran)")


def _inp(path: Path) -> dict[str, Any]:
    """``*NODE`` and ``*NSET`` of an input file."""
    lines = text_of(path, "a text file of Abaqus or CalculiX", "utf-8").splitlines()
    coordinates: dict[int, Any] = {}
    sets: dict[str, list[int]] = {}
    words: list[str] = []
    for number, line in enumerate(lines, 1):
        if line.startswith("**") or not line.strip():
            continue
        if line.startswith("*"):
            words = [word.strip() for word in line[1:].split(",")]
            continue
        keyword = words[0].upper() if words else ""
        values = [word.strip() for word in line.split(",") if word.strip()]
        name = next((w.split("=")[1].strip() for w in words if w.upper().replace(" ", "").startswith("NSET=")), None)
        try:
            if keyword == "NODE":
                at = [float(word) for word in values[1:4]]
                coordinates[int(values[0])] = np.array([*at, *[0.0] * (3 - len(at))])
                if name is not None:
                    sets.setdefault(name, []).append(int(values[0]))
            elif keyword == "NSET" and name is not None:
                _add(sets, name, values, any(w.upper() == "GENERATE" for w in words))
        except ValueError:
            raise FileError(
                f"{path}: line {number}: expected numbers of *{keyword}, got {line.strip()[:40]!r}"
            ) from None
    if not coordinates:
        raise FileError(f"{path}: expected *NODE with coordinates, found none")
    return {"coordinates": coordinates, "sets": {key: np.array(nodes) for key, nodes in sets.items() if nodes}}


def _add(sets: dict[str, list[int]], name: str, values: list[str], generate: bool) -> None:
    members = sets.setdefault(name, [])
    if generate:
        first, last, step = (int(v) for v in ([*values, "1"] if len(values) == 2 else values))
        if not step > 0 or (last - first) // step > 10**8:
            raise ValueError
        members.extend(range(first, last + 1, step))
        return
    for value in values:
        members.extend(
            [int(value)] if value.lstrip("-").isdecimal() else sets[value] if value in sets else [int(value)]
        )
