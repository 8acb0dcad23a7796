"""Modes that CalculiX writes: ``*FREQUENCY`` with ``*NODE FILE, U`` gives a ``.frd``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fricmb._files import text_of
from fricmb.errors import FileError
from fricmb.measure._types import Floats, Measured, Modes

#: Relative round-off of numbers with six digits.
SIX_DIGITS = 5e-6
#: Width of a node's number in text, by what a block says its format is; others are binary.
WIDTHS = {"0": 5, "1": 10}


def read(path: Path, over: object) -> Measured:
    """Frequencies, shapes, modal masses and coordinates."""
    lines = text_of(path, "text of CalculiX (.frd); binary ones are not read").splitlines()
    if not lines or not lines[0].startswith("    1C"):
        raise FileError(f"{path}: line 1: expected '1C', the head of a .frd file")
    if lines[-1].strip() != "9999":
        raise FileError(f"{path}: line {len(lines)}: expected '9999', the end of a .frd file; it is cut off")
    points: dict[int, Floats] = {}
    modes: list[tuple[float, float, dict[int, Floats]]] = []
    mass, at = np.nan, 0
    while at < len(lines):
        line = lines[at]
        at += 1
        if line.startswith("    2C"):
            points, at = _block(path, lines, at, line, 0)
        elif line.startswith("    1PGM"):
            mass = _number(path, at, line[8:])
        elif line.startswith("  100C"):
            hertz, modal = _number(path, at, line[12:24]), "MODAL" in line[56:68]
            width = next((int(x[13:18]) for x in lines[at : at + 1] if x.startswith(" -4  DISP")), 0)
            if not (modal and width):
                continue
            shape, at = _block(path, lines, at, line, width)
            modes.append((hertz, mass, shape))
            mass = np.nan
    if not modes:
        raise FileError(f"{path}: expected displacements (*NODE FILE, U) of a *FREQUENCY step, found none")
    return Measured(modes=_together(path, modes), points=points)


def _block(path: Path, lines: list[str], at: int, head: str, heads: int) -> tuple[dict[int, Floats], int]:
    """Three numbers of each node, from the line ``at`` on to the line behind the end of the block."""
    width = WIDTHS.get(head.rstrip()[-1:])
    if width is None:
        raise FileError(f"{path}: line {at}: expected numbers in text; this file is binary")
    found: dict[int, Floats] = {}
    while at < len(lines) and lines[at].startswith((" -4", " -5")) and heads:
        at += 1
    first = 3 + width
    for number in range(at, len(lines)):
        line = lines[number]
        if line.startswith(" -3"):
            return found, number + 1
        if not line.startswith(" -1"):
            raise FileError(f"{path}: line {number + 1}: expected a node (-1) or the end of a block (-3)")
        try:
            node = int(line[3:first])
            found[node] = np.array([float(line[first + 12 * k : first + 12 * (k + 1)]) for k in range(3)])
        except ValueError:
            raise FileError(f"{path}: line {number + 1}: expected the number of a node and three numbers") from None
        if not np.isfinite(found[node]).all():
            raise FileError(f"{path}: line {number + 1}: expected finite numbers")
    raise FileError(f"{path}: expected the end of a block (-3); the file is cut off")


def _number(path: Path, line: int, text: str) -> float:
    try:
        return float(text.split()[0])
    except (ValueError, IndexError):
        raise FileError(f"{path}: line {line}: expected a number, got {text[:30]!r}") from None


def _together(path: Path, modes: list[tuple[float, float, dict[int, Floats]]]) -> Modes:
    nodes = np.array(sorted(modes[0][2]), dtype=np.int64)
    shapes: list[Any] = []
    for number, (_, _, shape) in enumerate(modes, 1):
        if sorted(shape) != nodes.tolist():
            raise FileError(f"{path}: mode {number}: expected displacements of {nodes.size} nodes, got {len(shape)}")
        shapes.append([shape[node] for node in nodes.tolist()])
    return Modes(
        frequencies=2.0 * np.pi * np.array([hertz for hertz, _, _ in modes]),
        damping_ratios=np.zeros(len(modes)),
        masses=np.array([mass for _, mass, _ in modes]),
        nodes=nodes,
        shapes=np.array(shapes),
        round_off=SIX_DIGITS,
    )
