"""Derivatives behind a break-away in two directions at which nothing accelerates yet: an own program, and its limit."""

from functools import cache
from math import cos, exp, hypot, sin

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm
from fricmb.sensitivity._setting_out import SettingOut

#: Of a sleeve along x that a body hangs in beside its axis: weight, rate of the pull, both moments, radius, friction.
VALUES = {"W": 9.81, "k": 1.5, "J": 0.02, "c": 0.05, "R": 0.15, "mu_s": 0.45, "mu_k": 0.2, "v_s": 0.3}
NAMES = {"k": "k", "W": "W", "mu_s": "s.friction.mu_s", "R": "s.radius"}


def sleeve(law):
    """The weight loads the friction that turns, a pull that grows that along the axis, until both are too much."""
    v = VALUES
    body = fm.space.RigidBody(
        "b", mass=1.0, inertia=(v["J"], 0.03, 0.04), points={"mid": (0.0, -v["c"], 0.0)}, position=(0.0, v["c"], 0.0)
    )
    dry = fm.space.Cylindrical("s", body.point("mid"), axis=(1, 0, 0), radius=v["R"], friction=law)
    weight = fm.Force("w", body, axis="z", value=-fm.parameter("W", v["W"]))
    pull = fm.Force("f", body, axis="x", value=fm.parameter("k", v["k"]) * fm.t)
    return fm.Scene("sleeve", [body, dry, weight, pull])


def own(p, times, falls):
    """Motion (x, z, their velocities) at each time, and the time of the break-away, by an own program.

    It begins a little behind the break-away, along the direction that slip has there but for the square of that time.
    That direction soon turns slowly, so that the equations are stiff at first only.
    """
    W, k, J, c, R = (p[name] for name in ("W", "k", "J", "c", "R"))

    def mu(r):
        return p["mu_k"] + (p["mu_s"] - p["mu_k"]) * exp(-((r / p["v_s"]) ** 2)) if falls else p["mu_s"]

    def slipping(t, angle, speed, n, coefficient):
        """Accelerations of slip: the load is that of the axis, which friction changes."""
        N, last = W, 0.0
        while abs(N - last) > 1e-15 * W:
            last = N
            turn = (-W * c * cos(angle) - R * coefficient * N * n[0]) / (J + c**2)
            sinks = c * (cos(angle) * turn - sin(angle) * speed**2)
            N = hypot(c * (sin(angle) * turn + cos(angle) * speed**2), sinks + W)
        return R * turn, k * t - coefficient * N * n[1]

    holds = np.array([-W * c / R, np.sqrt((p["mu_s"] * W) ** 2 - (W * c / R) ** 2)])
    begin, least = holds[1] / k, 3e-5

    def unit(turned):
        return np.array([np.cos(turned), np.sin(turned)])

    def aside(turned):
        return slipping(begin + least, 0.0, 0.0, unit(turned), p["mu_s"]) @ unit(turned + np.pi / 2)

    first = np.arctan2(holds[1], holds[0])
    n = unit(brentq(aside, first - 0.05, first + 0.05, xtol=1e-15))
    v = np.multiply(slipping(begin + least, 0.0, 0.0, n, p["mu_s"]), least / 2)

    def rates(t, y):
        angle, _, turn, speed = y.tolist()
        r = hypot(R * turn, speed)
        a = slipping(t, angle, turn, (R * turn / r, speed / r), mu(r))
        return [turn, speed, a[0] / R, a[1]]

    start = [v[0] / R * least / 3, v[1] * least / 3, v[0] / R, v[1]]
    slow = begin + 0.03
    start = solve_ivp(rates, (begin + least, slow), start, method="Radau", rtol=3e-12, atol=1e-15).y[:, -1]
    angle, x, turn, speed = solve_ivp(
        rates, (slow, times[-1]), start, method="DOP853", rtol=1e-12, atol=1e-15, t_eval=times
    ).y  # fmt: skip
    return np.array([x, c * np.sin(angle), speed, c * np.cos(angle) * turn, np.full(len(times), begin)]).T


def differences(name, times, falls):
    """Richardson's differences of the own program."""
    slopes = []
    for h in (1e-4 * VALUES[name], 5e-5 * VALUES[name]):
        more, less = (own(VALUES | {name: VALUES[name] + sign * h}, times, falls) for sign in (1.0, -1.0))
        slopes.append((more - less) / (2.0 * h))
    return (4.0 * slopes[1] - slopes[0]) / 3.0


@pytest.mark.parametrize("falls", [True, False])
def test_a_sleeve_breaks_away_under_a_load_that_its_friction_changes(falls):
    """As an own program has it at every tolerance: at once behind the break-away, later, and where a run ends there."""
    given = {name: VALUES[name] for name in ("mu_s", "mu_k", "v_s")}
    scene = sleeve(fm.laws.Stribeck(**given) if falls else fm.laws.Coulomb(mu_s=VALUES["mu_s"]))
    begin = own(VALUES, [3.0], falls)[-1, -1]
    times = [begin + 0.05, begin + 0.5]
    slopes = {name: differences(name, times, falls) for name in NAMES}
    long = [("auto", 1e-3), ("auto", 1e-7), ("auto", 1e-11), ("bdf", 1e-5), ("bdf", 1e-9)]
    for method, rtol, n in [*((*how, 2) for how in long), ("auto", 1e-7, 1)]:
        sol = fm.simulate(
            scene, t_end=times[n - 1], t_eval=times[:n], rtol=rtol, method=method, sensitivities=tuple(NAMES.values())
        )
        for name, slope in slopes.items():
            seen = [sol.sensitivity(s, NAMES[name]) for s in ("b.x", "b.z", "b.x.velocity", "b.z.velocity")]
            for i in range(n):
                exact = slope[i]
                np.testing.assert_allclose([x[i] for x in seen], exact[:4], atol=1e-8 * np.abs(exact[:4]).max())
                assert sol.events[0].sensitivity(NAMES[name]) == pytest.approx(exact[4], rel=1e-9)


@cache
def turning_sleeve():
    """A sleeve under loads that turn, the name of its friction, and its run to many digits."""
    law = fm.laws.Stribeck(mu_s=0.3, mu_k=0.2, v_s=0.1)
    body = fm.space.RigidBody(
        "b", mass=1.0, inertia=(0.02, 0.03, 0.04), position=(0.0, -0.046, -0.048),
        points={"mid": (0.083, 0.046, 0.048), "p": (0.0, 0.0, 0.1)},
    )  # fmt: skip
    dry = fm.space.Cylindrical("s", body.point("mid"), axis=(1, 0, 0), radius=0.0955, length=0.1, friction=law)
    loads = [
        fm.Force("w", body, axis="z", value=-9.81),
        fm.Force("f", body, axis="x", value=3.82 * sympy.sin(2.459 * fm.t)),
        fm.Force("f2", body.point("p"), axis="y", value=3.63 * sympy.sin(2.87 * fm.t)),
        fm.Force("w2", body, axis="y", value=4.263 * sympy.cos(2.2 * fm.t)),
    ]
    scene, name = fm.Scene("sleeve", [body, dry, *loads]), "s.friction.mu_s"
    return scene, name, fm.simulate(scene, t_end=2.1, rtol=1e-11)


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9])
def test_at_once_behind_a_break_away_after_a_stick(method, rtol):
    """Slip grows like a (t - t_b)^2/2, so that its derivative is -a (t - t_b) dt_b/dp.

    The dense output, which has stuck to a tolerance, knows no direction of slip there: this was off by up to 30 times
    its size.
    """
    scene, name, fine = turning_sleeve()
    sol = fm.simulate(scene, t_end=2.1, rtol=rtol, method=method, sensitivities=(name,))
    stick, slip = sol.events[:2]
    assert (stick.kind, slip.kind) == ("stick", "slip")
    begin, short = fine.events[1].t, 1e-3
    grows = 2.0 * fine.at([begin + short]).velocity("b.x")[0] / short**2
    for after in (1e-3, 1e-4, 1e-5, 1e-6):
        seen = sol.at([slip.t + after]).sensitivity("b.x.velocity", name)[0]
        assert seen == pytest.approx(-grows * after * slip.sensitivity(name), rel=2e-2)


def test_a_break_away_whose_slip_is_not_found_says_so(monkeypatch):
    """No number without a word."""
    monkeypatch.setattr(SettingOut, "_step", lambda *_: None)
    scene = sleeve(fm.laws.Coulomb(mu_s=VALUES["mu_s"]))
    sol = fm.simulate(scene, t_end=2.2, sensitivities=("k",))
    assert any("'s' sets out with no acceleration" in note for note in sol.stats.notes)
    # slip that is accelerated from the first the run knows well enough
    scene = sleeve(fm.laws.Coulomb(mu_s=VALUES["mu_s"], mu_k=VALUES["mu_k"]))
    assert not fm.simulate(scene, t_end=2.2, sensitivities=("k",)).stats.notes
