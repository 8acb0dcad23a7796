"""Contacts whose normal force depends on a rate."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.model.table_values import evaluate
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import NORMAL_LAW, Codes, Problem

#: Distances and speeds at which a law is asked.
_SIZES = np.concatenate([[0.0], np.logspace(-9.0, 3.0, 13)])
_ASKED = np.array([(side * e, rate) for e in _SIZES for side in (-1.0, 1.0) for rate in (-1.0, 0.0, 1.0)])


def damped_normals(problem: Problem) -> Codes:
    """1 for each contact (n_c,) whose normal-force law has damping, as its values are.

    What such a contact stores has a kink where its spring is slack, and that is not where it opens: it is passed within
    a step.  Its loss is therefore what is done on it, less what it stores by then (``powers``, ``stored_by_damped``).
    One without damping opens where its spring is slack, and loses nothing at any time.
    """
    contacts = problem.contacts

    def make() -> Codes:
        found = np.zeros(problem.n_c, np.int8)
        for k in np.flatnonzero(contacts.normal == NORMAL_LAW):
            found[k] = np.any(evaluate(contacts.normal_table, int(k), _ASKED, 5)[2] != 0.0)
        return found

    return once_per(contacts, "damped normals", make)
