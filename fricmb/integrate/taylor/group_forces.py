"""Contacts that stick together: one symmetric positive definite matrix for each group of bodies that touch."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import STICK
from fricmb.integrate.taylor.network import Net


@kernel
def factor_group(net: Net, gi: int) -> None:
    """Cholesky's factor of a group's matrix under the present modes, unless it is there."""
    start, contacts = net.groups.group_start, net.groups.group_contact
    factored, stuck, L, G = net.groups.factored, net.groups.stuck, net.groups.L, net.groups.G
    first, size, at = start[gi], start[gi + 1] - start[gi], net.groups.at[gi]
    same = True
    for a in range(first, first + size):
        same = same and factored[a] == net.mode[contacts[a]]
    if same:
        return
    count = 0
    for a in range(size):
        c = contacts[first + a]
        factored[first + a] = net.mode[c]
        if net.mode[c] == STICK:
            stuck[first + count] = a
            count += 1
    net.groups.n_stuck[gi] = count
    for i in range(count):
        row = at + stuck[first + i] * size
        for j in range(i + 1):
            value = G[row + stuck[first + j]]
            for k in range(j):
                value -= L[at + i * size + k] * L[at + j * size + k]
            L[at + i * size + j] = math.sqrt(value) if i == j else value / L[at + j * size + j]


@kernel
def solve_group(net: Net, gi: int) -> None:
    """Forces of the contacts of a group that stick from the right-hand side, both in ``rhs`` from its start on."""
    first, at = net.groups.group_start[gi], net.groups.at[gi]
    size, count = net.groups.group_start[gi + 1] - first, net.groups.n_stuck[gi]
    L, b = net.groups.L, net.groups.rhs
    for i in range(count):
        value = b[first + i]
        for k in range(i):
            value -= L[at + i * size + k] * b[first + k]
        b[first + i] = value / L[at + i * size + i]
    for i in range(count - 1, -1, -1):
        value = b[first + i]
        for k in range(i + 1, count):
            value -= L[at + k * size + i] * b[first + k]
        b[first + i] = value / L[at + i * size + i]


@kernel
def stuck_contact(net: Net, gi: int, i: int) -> int:
    """Contact i of those of a group that stick."""
    first = net.groups.group_start[gi]
    return int(net.groups.group_contact[first + net.groups.stuck[first + i]])


@kernel
def is_held(net: Net, gi: int) -> bool:
    """Whether as many contacts of a group stick as it has dofs: these move as the belts do."""
    return bool(net.groups.n_stuck[gi] == net.groups.dof_start[gi + 1] - net.groups.dof_start[gi])
