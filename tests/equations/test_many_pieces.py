"""A Piecewise of hundreds of pieces, such as a measured record, is compiled; Python reads no chain of so many."""

import math

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.equations._code import CHAIN, source

X = sympy.Symbol("x0", real=True)


def record(t, values, times, default=None):
    """Straight lines between the values."""
    slopes = np.diff(values) / np.diff(times)
    pieces = [
        (float(a) + float(b) * (t - float(at)), t < float(end))
        for a, b, at, end in zip(values, slopes, times, times[1:], strict=False)
    ]
    return sympy.Piecewise(*pieces, *([] if default is None else [(default, True)]))


@pytest.mark.parametrize("n", [CHAIN - 1, CHAIN, CHAIN + 1, 300])
@pytest.mark.parametrize("default", [None, -7.0])
def test_it_has_the_values_of_its_pieces(n, default):
    times = np.linspace(0.0, 3.0, n + 1)
    values = np.random.default_rng(n).normal(size=n + 1)
    code = compile(source(record(X, values, times, default)), "record", "eval")
    for x in np.random.default_rng(1).uniform(0.0, 3.0, 500):
        assert eval(code, {"x0": x, "inf": math.inf, "nan": math.nan}) == pytest.approx(np.interp(x, times, values))
    after = eval(code, {"x0": 3.5, "inf": math.inf, "nan": math.nan})
    assert math.isnan(after) if default is None else after == default


def test_a_body_runs_under_a_record():
    times = np.linspace(0.0, 1.2, 121)
    values = np.random.default_rng(5).normal(size=121)
    body = fm.Body("body", mass=2.0)
    push = fm.Force("push", body, axis="x", value=record(fm.t, values, times, 0.0))
    sol = fm.simulate(fm.Scene("pushed", [body, push]), t_end=2.0, rtol=1e-9, t_eval=[0.6, 1.2, 2.0])
    impulse = np.concatenate(([0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(times))))
    np.testing.assert_allclose(sol.velocity("body.x"), impulse[[60, 120, 120]] / 2.0, rtol=1e-8, atol=1e-12)
