"""First falls below 0 within a step, from values at its start and stages, against roots that numpy finds."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from fricmb.integrate.compile.kernel import entry
from fricmb.integrate.formulas.crossing import first_below, first_crossing
from fricmb.integrate.formulas.tableau import Tableau, radau
from fricmb.integrate.problem import Floats


@entry
def search(tab: Tableau, first: float, values: Floats, series: Floats, found: Floats) -> float:
    """Crossing, and the two points that enclose it into ``found``."""
    found[0], found[1] = first_below(tab, first, values, series)
    return first_crossing(tab, first, values, series)


def tried(stages: int, curve: Polynomial) -> tuple[float, np.ndarray]:
    tab, found = radau(stages), np.zeros(2)
    x = search(tab, float(curve(0.0)), np.asarray(curve(np.array(tab.c))), np.zeros(stages + 1), found)
    return x, found


@pytest.mark.parametrize("stages", [3, 5, 7])
def test_a_dip_between_two_stages_is_found(stages):
    c = radau(stages).c
    middle, half = 0.5 * (c[0] + c[1]), 0.2 * (c[1] - c[0])
    curve = Polynomial.fromroots([middle - half, middle + half])
    assert (curve(np.array(c)) > 0.0).all()
    x, (above, below) = tried(stages, curve)
    assert x == pytest.approx(middle - half, rel=1e-12)
    assert above < x < below
    assert curve(below) < 0.0


@pytest.mark.parametrize("stages", [3, 5])
def test_a_touch_from_above_is_none(stages):
    c = radau(stages).c
    middle = 0.5 * (c[0] + c[1])
    x, (above, below) = tried(stages, Polynomial.fromroots([middle, middle]) + 1e-9)
    assert (x, above, below) == (2.0, 2.0, 2.0)


def test_the_first_root_of_random_polynomials():
    rng = np.random.default_rng(7)
    crossed = 0
    for _ in range(400):
        stages = int(rng.choice([3, 5]))
        curve = Polynomial(rng.normal(size=stages + 1))
        curve = curve if curve(0.0) > 0.0 else -curve
        roots = [r.real for r in curve.roots() if abs(r.imag) < 1e-12 and 0.0 < r.real <= 1.0]
        x, (above, below) = tried(stages, curve)
        if x > 1.0:
            # one that is left and entered again within a part of an interval is seen where it has a minimum alone
            assert len(roots) % 2 == 0
            continue
        crossed += 1
        assert min(abs(x - r) for r in roots) < 1e-11
        assert curve(below) < 0.0
        assert above <= x <= below
        if len(roots) == 1:
            assert x == pytest.approx(roots[0], rel=1e-11)
    assert crossed > 100
