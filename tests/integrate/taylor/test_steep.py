"""Taylor steps under laws that fall within a small part of the slip speeds, beside a small program of their own."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm

SPEED = 0.5


def row(n, law, *, coupling, speed=SPEED):
    """Blocks between springs on a belt, the first of them tied to the ground."""
    belt = fm.Driven("belt", velocity={"x": speed})
    blocks = [fm.Body(f"b{i}", mass=1.0) for i in range(n)]
    springs = [fm.Spring("g", blocks[0], axis="x", stiffness=4.0)]
    springs += [fm.Spring(f"s{i}", blocks[i], blocks[i + 1], axis="x", stiffness=coupling) for i in range(n - 1)]
    pads = [fm.Contact(f"c{i}", block, belt, law=law, normal_force=1.0) for i, block in enumerate(blocks)]
    return fm.Scene("row", [*blocks, belt, *springs, *pads])


def stribeck(v_s, exponent, mu_s=1.5):
    return fm.laws.Stribeck(mu_s=mu_s, mu_k=1.0, v_s=v_s, exponent=exponent)


def run_row(n, law, coupling, times):
    """Motion of a row from transition to transition, by an explicit method of order 8; blocks slip against the belt."""
    K = np.diag([2.0 * coupling] * n) - coupling * (np.eye(n, k=1) + np.eye(n, k=-1))
    K[0, 0], K[-1, -1] = 4.0 + coupling, coupling
    slips, y, t, found = np.ones(n, dtype=bool), np.zeros(2 * n), 0.0, []

    def rates(_, y):
        r = np.maximum(SPEED - y[n:], 0.0)
        mu = law.mu_k + (law.mu_s - law.mu_k) * np.exp(-((r / law.v_s) ** law.exponent))
        return np.append(y[n:], np.where(slips, mu - K @ y[:n], 0.0))

    def ends(i):
        def distance(_, y):
            return SPEED - y[n + i] if slips[i] else law.mu_s - K[i] @ y[:n]

        distance.terminal, distance.direction = True, -1
        return distance

    while t < times[-1]:
        events = [ends(i) for i in range(n)]
        part = solve_ivp(
            rates, (t, times[-1]), y, method="DOP853", rtol=1e-12, atol=1e-14, events=events, dense_output=True,
            max_step=0.02,
        )  # fmt: skip
        inside = times[(times >= t) & (times < part.t[-1] if part.status == 1 else times >= t)]
        found += [part.sol(at) for at in inside]
        t, y = part.t[-1], part.y[:, -1].copy()
        for i in range(n):
            if len(part.t_events[i]):
                slips[i] = not slips[i]
                y[n + i] = SPEED
    return np.array(found).T


@pytest.mark.parametrize(
    ("n", "coupling", "v_s", "exponent"),
    [(2, 5.0, 1e-3, 1.0), (2, 0.5, 1e-3, 2.0), (4, 0.5, 3e-3, 1.0), (4, 30.0, 1e-3, 1.0), (2, 30.0, 2e-5, 2.0)],
)
@pytest.mark.parametrize("rtol", [1e-8, 1e-10])
def test_slip_that_begins_late_in_a_step(n, coupling, v_s, exponent, rtol):
    """The coefficients of its correction cancel; in powers of the whole step nothing was left of it."""
    law, times = stribeck(v_s, exponent), np.linspace(0.0, 8.0, 81)
    sol = fm.simulate(row(n, law, coupling=coupling), t_end=8.0, t_eval=times, rtol=rtol, method="taylor")
    good = run_row(n, law, coupling, times)
    assert np.abs(np.vstack([sol.q, sol.v]) - good).max() < 100 * rtol


@pytest.mark.parametrize("exponent", [2.0, 3.0])
def test_slip_whose_series_has_gaps(exponent):
    """Under a law that is flat at rest most coefficients of slip that begins are 0, the last ones too."""
    law, speed = stribeck(1e-3, exponent, mu_s=2.0), 0.378
    belt, block = fm.Driven("belt", velocity={"x": speed}), fm.Body("block", mass=1.0, velocity={"x": speed})
    parts = [belt, block, fm.Spring("spring", block, axis="x", stiffness=1.0)]
    scene = fm.Scene("block", [*parts, fm.Contact("pad", block, belt, law=law, normal_force=1.0)])
    since = np.array([0.0, 1e-3, 1e-2, 3e-2, 0.1, 0.3])
    times = law.mu_s / speed + since

    def rates(_, y):
        return [speed - y[1], y[0] - 1.0 - np.exp(-((max(y[1], 0.0) / law.v_s) ** exponent))]

    true = solve_ivp(rates, (0.0, 0.3), [law.mu_s, 0.0], method="DOP853", rtol=1e-12, atol=1e-18, t_eval=since)
    sol = fm.simulate(scene, t_end=times[-1], t_eval=times, rtol=1e-9, method="taylor")
    assert np.abs(speed - sol.v[0] - true.y[1]).max() < 1e-8


def test_a_belt_that_moves_costs_no_digits_in_short_steps():
    """In powers of s its velocity came from its positions: steps of 1e-3 lost seven digits of its acceleration."""
    law = fm.laws.HyperbolicStribeck(mu_s=1.4, mu_k=1.0, delta=110.0)
    scene = row(4, law, coupling=250.0, speed=0.5 + 0.2 * sympy.sin(1.3 * fm.t))
    times = np.linspace(0.0, 10.0, 101)
    found, good = (
        fm.simulate(scene, t_end=10.0, t_eval=times, rtol=rtol, method=method)
        for rtol, method in ((1e-11, "taylor"), (1e-12, "radau"))
    )
    assert np.abs(found.v - good.v).max() < 1e-9


def test_a_law_without_a_slope_at_rest_is_named():
    law = stribeck(1e-4, 0.5, mu_s=2.0)
    with pytest.raises(fm.IntegrationError, match=r"contact 'c\d' is followed over slip speeds of .*e-1\d alone"):
        fm.simulate(row(2, law, coupling=30.0), t_end=20.0, method="taylor")
