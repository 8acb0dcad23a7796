"""A linear structure without contact forces, in the blocks in which it moves."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.collocation.structure_blocks import Blocks, blocks
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Problem


def free_blocks(problem: Problem) -> Blocks:
    """The structure without contact forces in blocks; raises NoBlocks where it has no such form."""
    n, linear = problem.n, problem.linear

    def make() -> Blocks:
        M, K, C = (np.asarray(x, float) for x in (linear.M, linear.Kx[:n, :n], linear.Cx[:n, :n]))
        return blocks(M, K, C, np.zeros((n, 0)), ())

    return once_per(linear, "free blocks", make)


def has_ledger(problem: Problem) -> bool:
    """Whether anything but friction takes or brings energy."""
    n, linear, contacts = problem.n, problem.linear, problem.contacts
    K = linear.Kx[:n, :n]
    parts = [linear.Cx[:n, :n], contacts.w, contacts.Wn, problem.elements.table.address]
    return bool(problem.n_u > 0 or any(np.any(x) for x in parts) or np.any(K != K.T))
