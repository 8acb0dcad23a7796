"""Writes as Nastran does in OUTPUT2: frequencies (LAMA), shapes (OUGV1) and matrices, for tests of readers."""

import struct

import numpy as np


def _record(data):
    return struct.pack("<i", len(data)) + data + struct.pack("<i", len(data))


def _key(number):
    return _record(struct.pack("<i", number))


def _words(text, count):
    return text.ljust(4 * count).encode()


def _table(name, records):
    out = _key(2) + _record(_words(name, 2)) + _key(-1)
    out += _key(7) + _record(struct.pack("<7i", 101, 0, 0, 0, 0, 0, 0)) + _key(-2)
    out += _key(1) + _record(struct.pack("<i", 0)) + _key(2) + _record(_words(name, 2)) + _key(-3)
    for number, data in enumerate(records):
        out += _key(1) + _record(struct.pack("<i", 0)) + _key(len(data) // 4) + _record(data) + _key(-4 - number)
    return out + _key(1) + _record(struct.pack("<i", 0)) + _key(0)


HEAD = _key(3) + _record(struct.pack("<3i", 11, 27, 26)) + _key(7) + _record(b"NASTRAN FORT TAPE ID CODE - ")
HEAD += _key(2) + _record(_words("XXXXXXXX", 2)) + _key(-1) + _key(0)


def write_modes(path, omega, nodes, shapes, masses):
    """Real shapes (k, p, 6)."""
    table = b"".join(
        struct.pack("<2i5f", j + 1, j + 1, w**2, w, w / (2 * np.pi), m, m * w**2)
        for j, (w, m) in enumerate(zip(omega, masses, strict=True))
    )
    shown = []
    for j, (w, shape) in enumerate(zip(omega, shapes, strict=True)):
        ident = struct.pack("<5if", 22, 7, 0, 0, j + 1, w**2) + bytes(4 * 140)
        rows = [struct.pack("<2i6f", 10 * node + 2, 1, *row) for node, row in zip(nodes, shape, strict=True)]
        shown += [ident, b"".join(rows)]
    path.write_bytes(HEAD + _table("LAMA", [bytes(4 * 146), table]) + _table("OUGV1", shown) + _key(0))


def write_complex_modes(path, poles, nodes, shapes, *, polar=False):
    """Shapes (k, p, 6) as real and imaginary parts, or as sizes and phases in degrees."""
    shown = []
    for j, (pole, shape) in enumerate(zip(poles, shapes, strict=True)):
        ident = struct.pack("<5i2f3i", 92, 1007, 0, 1, j + 1, pole.real, pole.imag, 0, 3 if polar else 2, 14)
        pairs = (np.abs(shape), np.rad2deg(np.angle(shape))) if polar else (shape.real, shape.imag)
        rows = [struct.pack("<2i12f", 10 * node + 2, 1, *a, *b) for node, a, b in zip(nodes, *pairs, strict=True)]
        shown += [ident + bytes(4 * 40) + _words("", 96), b"".join(rows)]
    path.write_bytes(HEAD + _table("OUGV1", shown) + _key(0))


def _matrix(name, A):
    """Double precision, each column in the pieces that its zeros leave."""
    rows, columns = A.shape
    trailer = struct.pack("<7i", 101, columns, rows, 2, 4 if np.iscomplexobj(A) else 2, 0, 0)
    out = _key(2) + _record(_words(name, 2)) + _key(-1) + _key(7) + _record(trailer) + _key(-2)
    out += _key(1) + _record(struct.pack("<i", 0)) + _key(2) + _record(_words(name, 2)) + _key(-3)
    for j in range(columns):
        out += _key(1) + _record(struct.pack("<i", 1))
        held = np.flatnonzero(A[:, j])
        for piece in np.split(held, np.flatnonzero(np.diff(held) > 1) + 1) if held.size else []:
            data = struct.pack("<i", piece[0] + 1) + np.ascontiguousarray(A[piece, j]).tobytes()
            out += _key(len(data) // 4) + _record(data)
        out += _key(-4 - j)
    return out + _key(1) + _record(struct.pack("<i", 0)) + _key(0)


def write_matrices(path, **matrices):
    path.write_bytes(HEAD + b"".join(_matrix(name.upper(), A) for name, A in matrices.items()) + _key(0))
