"""Evaluating templates at many times."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import entry
from fricmb.integrate.compile.template import call
from fricmb.integrate.problem import Floats, Templates


@entry
def _each(address: int, x: Floats, n_x: int, p: Floats, out: Floats, n_out: int, count: int) -> None:
    for i in range(count):
        call(address, x, i * n_x, p, 0, out, i * n_out)  # type: ignore[call-arg]


def evaluate(table: Templates, k: int, x: Floats, n_out: int) -> Floats:
    """Outputs (n_out, n_t) of function k for arguments (n_t, n_x)."""
    count, n_x = x.shape
    # one number more than needed: a template without arguments or parameters still gets a pointer to something
    arguments = np.append(np.ravel(x), 0.0)
    p = np.append(table.p[table.p_start[k] : table.p_start[k + 1]], 0.0)
    out = np.zeros(count * n_out + 1)
    _each(int(table.address[k]), arguments, n_x, p, out, n_out, count)
    return out[:-1].reshape(count, n_out).T


def arguments(table: Templates, k: int, X: Floats) -> Floats:
    """Arguments (n_t, n_x) of function k out of X (n_X, n_t)."""
    places = range(int(table.x_start[k]), int(table.x_start[k + 1]))
    x = np.empty((X.shape[1], len(places)))
    for column, a in enumerate(places):
        form = slice(int(table.form_start[a]), int(table.form_start[a + 1]))
        x[:, column] = table.form_coefficient[form] @ X[table.form_index[form]] + table.form_constant[a]
    return x
