"""Which ports may hold more than there is to hold: those in loops of joints and contacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.mechanism import Mechanism
from fricmb.integrate.problem import Floats, Ints, Problem, Templates

#: Softness of ports that stick in a loop, beside that of the bodies, in Jacobians alone: of contacts that hold more
#: than there is to hold only what their forces do together is determined.
SOFT = 1e-5


def softness(problem: Problem, m: Mechanism, port_joint: Ints) -> Floats:
    """Softness of every port (n_c,): SOFT in loops, 0 in trees.

    Rows of a joint and its friction, or of a contact, are independent of one another, and of all others where they
    alone tie a body (or a tree of bodies) to the rest.  So the ends of trees are taken off, one after the other, until
    only loops are left, and what lies between loops.  In a tree nothing is redundant, and softening would do harm
    there: a long chain of bodies that stick together is heavy, and answers a torque in a joint by less than softened
    joints do.
    """
    tied = _ties(problem, m, port_joint)
    at: dict[str, set[int]] = {}
    for block, nodes in enumerate(tied):
        for node in nodes:
            at.setdefault(node, set()).add(block)
    loose = [node for node in at if node != GROUND and len(at[node]) == 1]
    pairs = [block for block, nodes in enumerate(tied) if len(nodes) < 2]
    while loose or pairs:
        if loose:
            node = loose.pop()
            blocks = at[node]
            if len(blocks) != 1:
                continue
            block = blocks.pop()
            tied[block].discard(node)
            if len(tied[block]) == 1:
                pairs.append(block)
            continue
        block = pairs.pop()
        for node in tied[block]:
            at[node].discard(block)
            if len(at[node]) == 1 and node != GROUND:
                loose.append(node)
        tied[block] = set()
    joints = len(m.joints.port)
    own = np.where(port_joint >= 0, port_joint, joints + np.arange(len(port_joint)))
    looped = np.array([bool(tied[block]) for block in own], dtype=bool)
    if looped.any() and problem.mechanism is None and _is_independent(problem, looped):
        looped[:] = False
    return np.where(looped, SOFT, 0.0)


def shares_a_loop(problem: Problem, m: Mechanism, port_joint: Ints) -> NDArray[np.bool_]:
    """Whether another port is in a loop of joints and contacts with each port (n_c,): they may hold more than there is.

    Loops are parts of the graph of bodies that stay together whatever single body is taken out.
    """
    import networkx as nx

    tied = _ties(problem, m, port_joint)
    joints = len(m.joints.port)
    own = [int(j) if j >= 0 else joints + c for c, j in enumerate(port_joint)]
    graph = nx.Graph()
    for nodes in tied:
        graph.add_edges_from((a, b) for a in nodes for b in nodes if a < b)
    found = np.zeros(len(own), dtype=bool)
    for part in nx.biconnected_components(graph):
        inside = [c for c, block in enumerate(own) if len(tied[block]) > 1 and tied[block] <= part]
        if len(inside) > 1:
            found[inside] = True
    return found


def _is_independent(problem: Problem, some: NDArray[np.bool_]) -> bool:
    """Whether rows of ``some`` contacts (n_c,) of a linear structure follow from no others: nothing is redundant then.

    A body given by modes moves at its contacts in as many ways as there are modes.
    """
    rows = some[problem.contacts.of_row]
    W = problem.contacts.csr("W").dense()[:, rows]
    return bool(rows.sum() <= problem.n and np.linalg.matrix_rank(W) == rows.sum())


#: The node of what the motion does not move: the ground, and what is driven.
GROUND = ""


def _ties(problem: Problem, m: Mechanism, port_joint: Ints) -> list[set[str]]:
    """Bodies that each joint ties, by name; behind them those that each contact does (none for joints' own ports)."""
    names = [name.rpartition(".")[0] for name in problem.dof_names]
    p = m.places
    for i, count in enumerate(np.diff(p.first).tolist()):
        names += [names[p.dof[p.dof_start[i]]]] * count
    inner = m.joints.inner
    tied = [set() if inner[j] else _tied(m.joints.table, j, m.n_y, names) for j in range(len(m.joints.port))]
    return tied + [set() if j >= 0 else _tied(m.slip, c, m.n_y, names) for c, j in enumerate(port_joint)]


def _tied(table: Templates, k: int, n_y: int, names: list[str]) -> set[str]:
    """Bodies in the arguments of template k; the ground where there is one body alone, or what is driven."""
    first, last = table.form_start[table.x_start[k]], table.form_start[table.x_start[k + 1]]
    index = table.form_index[first:last] - 1
    found = {names[i % n_y] for i in index.tolist() if 0 <= i < 2 * n_y}
    return found | {GROUND} if len(found) < 2 or (index >= 2 * n_y).any() else found
