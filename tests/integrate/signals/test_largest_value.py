"""The largest magnitude of a function of time in a run, of which its tolerance is a part."""

import numpy as np
import pytest
import sympy

from fricmb.equations._inputs import time_inputs
from fricmb.integrate.problem import Input
from fricmb.integrate.signals.largest_value import largest_value
from fricmb.integrate.signals.longest_steps import longest_steps

T = sympy.Symbol("t", real=True)
F = sympy.Float


def input_of(expression):
    (found,) = time_inputs(expression, T, [])
    return Input(tape=tuple(map(tuple, found["tape"])), parameters=())


SIZES = {
    "sine of a billion periods": (sympy.sin(1e9 * T), 1.0),
    "bell of a part of 1e-9": (3 * sympy.exp(-(((T - F(3.7123)) / F(1e-8)) ** 2)), 3.0),
    "tail of a bell": (sympy.exp(-(((T - 30) / F(0.76)) ** 2)), np.exp(-((20.0 / 0.76) ** 2))),
    "1e-300 alone": (F(1e-300) * sympy.sin(3 * T), 1e-300),
    "1/cosh, a quotient of exponentials": (1 / sympy.cosh(sympy.sin(3 * T) / F(1e-2)), 1.0),
    "cos to the power of 2000": (sympy.cos(3 * T) ** 2000, 1.0),
}


@pytest.mark.parametrize("name", SIZES)
def test_it_is_known_to_a_factor_of_two(name):
    expression, true = SIZES[name]
    found = largest_value(input_of(expression), 0.0, 10.0)
    assert 0.45 * true <= found <= (1.0 + 1e-12) * true


def test_of_inputs_that_cancel_it_is_more_by_what_bounds_on_short_stretches_leave():
    """Of sines of size 1 that are 1e-8 apart; bounds on a whole run know 2 alone."""
    found = largest_value(input_of(sympy.sin(3 * T) - sympy.sin((3 + F(1e-9)) * T)), 0.0, 10.0)
    assert 1e-8 <= found < 1e-3


def test_what_has_no_bound_at_a_pole_does_not_count():
    assert largest_value(input_of(1 / (T - F(5.1))), 0.0, 10.0) < 100.0


def longest(expression, t_end):
    found = longest_steps((input_of(expression),), 0.0, t_end, tol=1e-6, nodes=7)
    with np.errstate(invalid="ignore"):
        return found, np.diff(found.edge) / found.longest


def test_steps_within_the_bells_of_a_train_are_parts_of_one_bell():
    """Its bounds as a quotient of exponentials were e^200 too large, and bells of 1e-4 of the run were passed over."""
    omega, width = 3.7, 1e-2
    found, _ = longest(1 / sympy.cosh(sympy.sin(F(omega) * T) / F(width)), 20.0)
    for k in range(1, 23):
        stretch = np.searchsorted(found.edge, k * np.pi / omega, side="right") - 1
        assert found.longest[stretch] < width / omega


def test_two_thousand_bells_in_a_run_are_found_one_by_one():
    """Many of them lie in each half and quarter of a stretch: steps everywhere were those of a bell, 9e7 of them."""
    found, steps = longest(sympy.exp(-((sympy.sin(300 * T) / F(1e-2)) ** 2)), 20.0)
    assert np.nansum(steps[np.isfinite(steps)]) < 1e5
    between = np.searchsorted(found.edge, (np.arange(100) + 0.5) * np.pi / 300, side="right") - 1
    assert found.longest[between].min() > 1e-4
