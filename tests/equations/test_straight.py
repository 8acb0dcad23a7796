"""Straight-line kernels against the same statements run by Python."""

import math
import re

import numpy as np
import pytest

from fricmb import laws
from fricmb.equations import _store, function
from fricmb.equations._templates import law_template
from fricmb.integrate.compile.straight_line_codegen import is_straight

SMOOTH = [n for n in laws.names if getattr(laws, n).example().kind == "smooth" and n != "Contensou"]


def statements_of(template):
    text = _store.source_of(template.key)
    return re.search(r'straight\("""\n(.*)\n"""\)', text, re.DOTALL).group(1)


@pytest.mark.parametrize("name", SMOOTH)
def test_kernels_do_what_their_statements_say(name):
    law = getattr(laws, name).example()
    d = law.dimensions[-1]
    template = law_template(law, d)
    text, n = statements_of(template), d + 1 + law.n_states(d)
    kernel = function(template.address)
    rng = np.random.default_rng(0)
    for speed in (1e-6, 1e-3, 1.0, 50.0):
        x = np.concatenate([speed * rng.normal(size=d), [2.0], 1e-3 * rng.normal(size=law.n_states(d))])
        out = np.zeros((n - 1) * (n + 1))
        kernel(x, law.parameter_block(), out)
        expected = {}
        exec(text, dict(vars(math)), {"x": x.tolist(), "p": law.parameter_block().tolist(), "out": expected})
        found = np.array([expected[i] for i in range(len(out))])
        np.testing.assert_allclose(out, found, rtol=1e-12, atol=1e-13 * np.abs(found).max())


@pytest.mark.parametrize(
    "text",
    ["for i in range(3):\n    y = 1.0", "y = z.real", "y = print(1.0)", "y, w = 1.0, 2.0", "y = x[i]", "y = a % b"],
)
def test_other_statements_are_left_to_numba(text):
    assert not is_straight(text)
    text = "y = max(x[0], -p[1])**3 if x[2] > 0.0 and not x[1] <= 2.0 else sin(hypot(x[0], 1.0))\nout[0] = y"
    assert is_straight(text)
