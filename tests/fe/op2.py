"""Writes modes as Nastran does in OUTPUT2: tables of frequencies (LAMA) and shapes (OUGV1), for tests of readers."""

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


def write_modes(path, omega, nodes, shapes, masses, *, approach=22):
    """Shapes (k, p, 6); approach 22: real modes, 92: complex ones."""
    head = _key(3) + _record(struct.pack("<3i", 11, 27, 26)) + _key(7) + _record(b"NASTRAN FORT TAPE ID CODE - ")
    head += _key(2) + _record(_words("XXXXXXXX", 2)) + _key(-1) + _key(0)
    table = b"".join(
        struct.pack("<2i5f", j + 1, j + 1, w**2, w, w / (2 * np.pi), m, m * w**2)
        for j, (w, m) in enumerate(zip(omega, masses, strict=True))
    )
    data = head + _table("LAMA", [bytes(4 * 146), table])
    shown = []
    for j, (w, shape) in enumerate(zip(omega, shapes, strict=True)):
        ident = struct.pack("<5if", approach, 7, 0, 0, j + 1, w**2) + bytes(4 * 140)
        rows = [struct.pack("<2i6f", 10 * node + 2, 1, *row) for node, row in zip(nodes, shape, strict=True)]
        shown += [ident, b"".join(rows)]
    path.write_bytes(data + _table("OUGV1", shown) + _key(0))
