"""Modes in a Nastran op2: real ones (OUG beside LAMA) and complex ones, whose eigenvalues stand before each shape."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb._files import Block, Output2
from fricmb.errors import FileError
from fricmb.measure._types import Complexes, Floats, Modes

#: What a table holds, tens of its first word: real eigenvectors, complex ones.
REAL, COMPLEX = 2, 9
#: Words of a node: its number, its kind, six displacements, and six more where these are complex.
WIDTHS = {REAL: 8, COMPLEX: 14}
#: Eigenvectors, hundreds of the second word apart; thousands: 1 complex, 2 sorted by nodes.
EIGENVECTORS, BY_NODES = (3, 7), 2
#: The ninth word where complex numbers are sizes and phases in degrees.
POLAR = 3
#: Kind of a node that has six displacements.
GRID = 1
#: Eigenvalues closer than this, relative, are those of a pair, in single precision.
_ALIKE = 1e-5


def op2_modes(file: Output2) -> tuple[Modes, tuple[str, ...]]:
    """Modes of a file, and what is to be said about them.

    Raises
    ------
    FileError
        Names what was expected and what there is.
    """
    tables = [block for block in file.blocks if block.name.startswith(("OUG", "BOPHIG")) and block.records]
    found = next(((block, kind) for block in tables if (kind := _kind(file, block)) is not None), None)
    if found is None:
        there = ", ".join([block.name for block in file.blocks][:12])
        wanted = "modes (OUG of SOL 103, 107 or 110, by DISPLACEMENT(SORT1) = ALL and PARAM,POST,-1)"
        raise FileError(f"{file.path}: expected {wanted}, found {there}")
    heads, nodes, shapes = _shapes(file, *found)
    if found[1] == COMPLEX:
        return _complex_modes(file, heads, nodes, shapes)
    return _real_modes(file, nodes, shapes), ()


def _kind(file: Output2, block: Block) -> int | None:
    """REAL or COMPLEX; None for what holds no modes, or not one after the other."""
    words = file.integers(block.records[0])
    if words.size < 10 or words[1] % 1000 not in EIGENVECTORS or words[1] // 1000 & BY_NODES:
        return None
    kind = int(words[0]) // 10
    return kind if kind in WIDTHS else None


def _shapes(file: Output2, block: Block, kind: int) -> tuple[Floats, Any, Any]:
    """First ten words before each shape as numbers, nodes, and shapes (k, p, 6)."""
    heads, shapes, nodes = list[Floats](), list[Any](), np.zeros(0, dtype=np.int64)
    if len(block.records) % 2:
        raise FileError(f"{file.path}: {block.name}: expected a head and numbers of each mode; the file is cut off")
    for number, (head, body) in enumerate(zip(block.records[::2], block.records[1::2], strict=True), 1):
        whole, values, first = file.integers(body), file.floats(body), file.integers(head)
        width = WIDTHS[kind]
        if whole.size % width or not whole.size or first.size < 10:
            size = f"{width} numbers a node, got {whole.size}"
            raise FileError(f"{file.path}: {block.name}: mode {number}: expected {size}")
        grids = whole.reshape(-1, width)[:, 1] == GRID
        there = whole.reshape(-1, width)[grids, 0].astype(np.int64) // 10
        if number > 1 and there.tolist() != nodes.tolist():
            raise FileError(f"{file.path}: {block.name}: mode {number}: expected the {nodes.size} nodes of the first")
        if first[4] != number:  # of another subcase
            got = f"behind mode {number - 1} follows number {int(first[4])}"
            raise FileError(f"{file.path}: {block.name}: expected modes 1, 2, ... of one subcase; {got}")
        nodes = there
        parts = values.reshape(-1, width)[grids, 2:].astype(float)
        heads.append(file.floats(head)[:10].astype(float))
        shapes.append(_together(parts, polar=first[8] == POLAR) if kind == COMPLEX else parts)
    order = np.argsort(nodes, kind="stable")
    return np.array(heads), nodes[order], np.array(shapes)[:, order]


def _together(parts: Floats, *, polar: bool) -> Complexes:
    """Complex numbers of real and imaginary parts, or of sizes and phases in degrees."""
    a, b = parts[:, :6], parts[:, 6:]
    found: Complexes = np.asarray(a * np.exp(1j * np.deg2rad(b)) if polar else a + 1j * b, dtype=complex)
    return found


def _round_off(file: Output2) -> float:
    """That of single precision; words of eight bytes have none."""
    return float(np.finfo(np.float32).eps) if file.word == 4 else 0.0


def _real_modes(file: Output2, nodes: Any, shapes: Floats) -> Modes:
    lama = next((block for block in file.blocks if block.name.startswith("LAMA") and len(block.records) == 2), None)
    table = np.zeros((0, 7)) if lama is None else file.floats(lama.records[1])
    if lama is None or table.size % 7 or table.size // 7 != len(shapes):
        got = "none" if lama is None else str(table.size // 7)
        raise FileError(f"{file.path}: expected {len(shapes)} frequencies (LAMA), as many as shapes (OUG); got {got}")
    table = table.reshape(-1, 7).astype(float)
    return Modes(
        frequencies=np.sqrt(np.maximum(table[:, 2], 0.0)),  # of a free structure eigenvalues round 0 may be negative
        damping_ratios=np.zeros(len(shapes)),
        masses=table[:, 5],
        nodes=nodes,
        shapes=shapes,
        round_off=_round_off(file),
    )


def _complex_modes(file: Output2, heads: Floats, nodes: Any, shapes: Complexes) -> tuple[Modes, tuple[str, ...]]:
    """Those that turn forward; of a pair of conjugate ones, one."""
    poles = heads[:, 5] + 1j * heads[:, 6]
    if not np.isfinite(poles).all() or not poles.all():
        raise FileError(f"{file.path}: expected eigenvalues of {poles.size} complex modes, got some that are 0 or nan")
    ahead = poles.imag >= 0.0
    alone = [not (np.abs(poles[ahead] - pole.conj()) <= _ALIKE * abs(pole)).any() for pole in poles[~ahead]]
    kept = np.concatenate([np.flatnonzero(ahead), np.flatnonzero(~ahead)[np.array(alone, dtype=bool)]])
    turned = ~ahead[kept]
    found, bent = np.array(poles[kept]), np.array(shapes[kept])
    found[turned], bent[turned] = found[turned].conj(), bent[turned].conj()
    modes = Modes(
        frequencies=np.abs(found),
        damping_ratios=-found.real / np.abs(found),
        masses=np.zeros(found.size),  # not in the file
        nodes=nodes,
        shapes=bent,
        round_off=_round_off(file),
    )
    left = poles.size - kept.size
    return modes, (f"{left} modes are conjugate to others and left out",) if left else ()
