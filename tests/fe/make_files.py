"""Writes the small files in tests/data/fe: one chain in the formats of several programs.

python tests/fe/make_files.py
"""

from pathlib import Path

import numpy as np

DATA = Path(__file__).parents[1] / "data" / "fe"
MASS, STIFFNESS, NODES = 2e-3, (800.0, 200.0, 1800.0), (11, 12, 13)
LABELS = np.array([(node, dof) for node in NODES for dof in (1, 2, 3)])


def chain():
    """M and K of three equal masses in a row, held at one end, with a stiffness along each axis."""
    tie = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    return MASS * np.eye(9), np.kron(tie, np.diag(STIFFNESS))


def frequencies():
    """Closed form, rising: 2 sqrt(k/m) sin((2 j - 1) pi / 14)."""
    j = np.arange(1, 4)
    return np.sort(np.concatenate([2.0 * np.sqrt(k / MASS) * np.sin((2 * j - 1) * np.pi / 14) for k in STIFFNESS]))


def calculix(M, K):
    for matrix, ending in ((K, "sti"), (M, "mas")):
        rows = [f"{i + 1} {j + 1} {matrix[i, j]: .13e}" for j in range(9) for i in range(j + 1)]
        (DATA / f"chain.{ending}").write_text("\n".join(rows) + "\n")
    (DATA / "chain.dof").write_text("".join(f"{node}.{dof}\n" for node, dof in LABELS))


def abaqus(M, K):
    nodes = ", ".join(f"{node:10d}" for node in NODES)
    lines = [
        "** GENERATION OF SUBSTRUCTURE Z1",
        "*USER ELEMENT, NODES=         3, LINEAR",
        "** ELEMENT NODES",
        f"** {nodes}",
    ]
    lines += ["          1,          2,          3"]
    for matrix, kind in ((K, "STIFFNESS"), (M, "MASS")):
        lines.append(f"*MATRIX,TYPE={kind}")
        for i in range(9):
            row = [f"{matrix[i, j]: .13e}" for j in range(i + 1)]
            lines += [", ".join(row[a : a + 4]) + ("," if a + 4 < len(row) else "") for a in range(0, len(row), 4)]
    (DATA / "chain.mtx").write_text("\n".join(lines) + "\n")
    for matrix, kind in ((K, "STIF"), (M, "MASS")):
        rows = [
            f"{LABELS[i][0]},{LABELS[i][1]}, {LABELS[j][0]},{LABELS[j][1]}, {matrix[i, j]: .15e}"
            for i in range(9)
            for j in range(i + 1)
            if matrix[i, j]
        ]
        (DATA / f"job_{kind}2.mtx").write_text("\n".join(rows) + "\n")


def inp():
    nodes = "".join(f"{node}, {i + 1}.0, 0.0, 0.0\n" for i, node in enumerate(NODES))
    (DATA / "chain.inp").write_text(
        f"** nodes\n*NODE, NSET=ALL\n{nodes}*NSET, NSET=TIP\n13,\n*NSET, NSET=TWO, GENERATE\n11, 12\n"
    )


def nastran(M, K):
    from pyyeti.nastran import op4

    op4.write(str(DATA / "chain.op4"), {"maa": M, "kaa": K}, binary=False, digits=16)
    lines = []
    for matrix, name in ((K, "KAAX"), (M, "MAAX")):
        lines.append(f"DMIG    {name:8s}       0       6       2       0")
        for j in range(9):
            lines.append(f"DMIG*   {name:16s}{LABELS[j][0]:16d}{LABELS[j][1]:16d}")
            for i in range(j, 9):
                if matrix[i, j]:
                    number = f"{matrix[i, j]:.9E}".replace("E", "D")
                    lines.append(f"*       {LABELS[i][0]:16d}{LABELS[i][1]:16d}{number:>16s}")
    (DATA / "chain.pch").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    DATA.mkdir(parents=True, exist_ok=True)
    pair = chain()
    calculix(*pair)
    abaqus(*pair)
    inp()
    nastran(*pair)
