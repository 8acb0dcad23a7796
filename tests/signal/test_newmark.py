"""Newmark's sliding block under a record, by its parabolas from value to value."""

import numpy as np
import pytest

import fricmb as fm


def record():
    """A burst of noise between 1 and 8 Hz, 200 values a second."""
    rng = np.random.default_rng(7)
    t = np.arange(0.0, 6.0, 0.005)
    a = np.zeros(t.size)
    for f in rng.uniform(1.0, 8.0, 40):
        a += rng.normal() * np.sin(2 * np.pi * f * t + rng.uniform(0.0, 6.28))
    return t, 0.7 * a * np.exp(-(((t - 2.5) / 1.1) ** 2))


def slip_by_hand(t, a, mu_g):
    """Slip of the box relative to the ground: w' = -a - mu g sign(w), each stretch to the root of its parabola."""
    w, x, slips = 0.0, 0.0, []
    for t0, t1, a0, a1 in zip(t[:-1], t[1:], a[:-1], a[1:], strict=True):
        s, end, slope = 0.0, t1 - t0, (a1 - a0) / (t1 - t0)
        while s < end - 1e-15:
            here = a0 + slope * s
            if w == 0.0:  # held: when does it let go?
                starts = [0.0] if abs(here) > mu_g * (1 + 1e-12) else []
                starts += [(limit - here) / slope for limit in (mu_g, -mu_g) if slope * limit > 0.0]
                start = min((u for u in starts if u >= 0.0 and s + u < end), default=None)
                if start is None:
                    break
                s += start
                way = -np.sign(a0 + slope * (s + 1e-9))
                slips.append(t0 + s)
                here = a0 + slope * s
            else:
                way = np.sign(w)
            c, b, d = -0.5 * slope, -here - mu_g * way, w  # w(u) = c u^2 + b u + d
            roots = np.roots([c, b, d]) if c else np.array([-d / b])
            ahead = [u.real for u in roots if abs(u.imag) < 1e-12 and 1e-12 < u.real < end - s]
            u = min(ahead, default=end - s)
            x += c * u**3 / 3 + b * u**2 / 2 + d * u
            w = 0.0 if ahead else c * u**2 + b * u + d
            s += u
    return x, slips


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
def test_slip_and_transitions(method):
    mu, g = 0.25, 9.81
    t, a = record()
    ground = fm.Driven("ground", velocity={"x": fm.Signal(t, a).integral})
    box = fm.Body("box", mass=1.0)
    foot = fm.Contact("foot", box, ground, law=fm.laws.Coulomb(mu_s=mu), normal_force=g)
    sol = fm.simulate(fm.Scene("shock", [ground, box, foot]), t_end=t[-1], rtol=1e-9, method=method)
    by_hand, slips = slip_by_hand(t, a, mu * g)
    assert sol["box.x"][-1] - sol["ground.x"][-1] == pytest.approx(by_hand, abs=1e-9)
    began = [event.t for event in sol.events if event.kind in ("slip", "reversal")]
    assert len(slips) == 12
    assert began == pytest.approx(slips, abs=1e-8)
