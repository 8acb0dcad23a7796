"""Coefficients of friction that fall within a small part of the slip speeds of a scene."""

from __future__ import annotations

import ctypes

import numpy as np

from fricmb.integrate.problem import LAW_COEFFICIENT, Floats, Problem
from fricmb.integrate.run.array_cache import cached_by_content

#: Slip speeds (relative to the largest) at which a law is looked at.
SPEEDS = np.append(0.0, 10.0 ** np.arange(-6.0, 0.05, 0.2))

_DOUBLES = ctypes.POINTER(ctypes.c_double)
_TEMPLATE = ctypes.CFUNCTYPE(None, _DOUBLES, _DOUBLES, _DOUBLES)


def steepness(problem: Problem, fastest: float) -> tuple[float, float]:
    """How steep the laws are, the largest of all contacts, 0 where nothing depends on slip speed.

    First the rate at which slip grows where a law falls most, over the highest frequency of the structure (``fastest``,
    an angular frequency); then the largest slip speed over that within which the law falls.  That speed is the drive's,
    or what friction brings about in the time of the structure.
    """
    contacts = problem.contacts
    chosen = np.flatnonzero(contacts.law == LAW_COEFFICIENT)
    if not chosen.size or fastest <= 0.0:
        return 0.0, 0.0
    W, table = contacts.csr("W"), contacts.law_table
    mobility = np.bincount(W.index, W.value**2 / problem.linear.csr("M").diagonal()[W.rows], problem.m)
    push = np.abs(contacts.mu_s) * contacts.N * mobility[contacts.row[:-1]]
    speed = np.maximum(np.abs(contacts.w[contacts.row[:-1]]), push / fastest)
    found: list[tuple[float, float]] = []
    for k in chosen.tolist():
        p = table.p[table.p_start[k] : table.p_start[k + 1]]
        slope, drop = _slope(int(table.address[k]), p, float(speed[k]), float(contacts.N[k]))
        growth = float(slope * contacts.N[k] * mobility[contacts.row[k]] / fastest)
        found.append((growth, float(slope * speed[k] / max(drop, 1e-300))))
    return max(found)


@cached_by_content
def _slope(address: int, p: Floats, speed: float, N: float) -> tuple[float, float]:
    """Largest slope of a law's coefficient up to a slip speed, and by how much it changes up to there."""
    law, numbers = _TEMPLATE(address), (ctypes.c_double * (len(p) + 1))(*p)
    x, out = (ctypes.c_double * 2)(0.0, N), (ctypes.c_double * 3)()
    values = []
    for r in (speed * SPEEDS).tolist():
        x[0] = r
        law(x, numbers, out)
        values.append((out[0], abs(out[1])))
    mu, slope = np.array(values).T
    return float(slope.max()), float(mu.max() - mu.min())
