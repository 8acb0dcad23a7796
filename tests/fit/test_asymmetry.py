"""Friction that differs by the sense of motion, from data of a program of its own."""

import math

import numpy as np
import pytest

import fricmb as fm

TRUE = {
    "rotor.mass": 0.013, "bearing.law.law.mu_s": 0.44, "bearing.law.law.mu_k": 0.31, "bearing.law.law.v_s": 0.6,
    "bearing.law.law.viscous": 0.021, "bearing.law.offset": 0.05,
}  # fmt: skip


def torque(t):
    return 0.9 * math.sin(1.7 * t) + 0.6 * math.sin(4.1 * t + 0.5)


def rotor(end, h=1e-4):
    """Angle at every hundredth step: steps of the midpoint rule, a reversal ends one, rest is left beyond the cone."""
    J, mu_s, mu_k, v_s, viscous, offset = TRUE.values()
    x = v = 0.0
    places = [x]
    for i in range(round(end / h)):
        f = torque(i * h) - offset
        sense = math.copysign(1.0, v if v != 0.0 else f)
        if v != 0.0 or abs(f) > mu_s:

            def rate(v, f, sense=sense):
                r = abs(v)
                return (f - sense * (mu_k + (mu_s - mu_k) * math.exp(-((r / v_s) ** 2)) + viscous * r)) / J

            middle = v + 0.5 * h * rate(v, f)
            after = v + h * rate(middle, torque((i + 0.5) * h) - offset)
            x += h * middle
            v = 0.0 if after * sense < 0.0 else after
        if i % 100 == 99:
            places.append(x)
    return np.arange(len(places)) * 100 * h, np.array(places)


def test_coefficients_of_both_senses_from_plain_guesses():
    t, angle = rotor(6.0)
    noise = 1e-4 * np.random.default_rng(0).standard_normal(angle.size)
    body = fm.Body("rotor", mass=0.05)
    law = fm.laws.Offset(law=fm.laws.Stribeck(mu_s=0.8, mu_k=0.5, v_s=1.0, viscous=0.05), offset=0.0)
    grid = np.linspace(0.0, 6.5, 6501)
    drive = fm.Signal(grid, np.array([torque(at) for at in grid]))
    scene = fm.Scene("motor", [
        body, fm.Force("drive", body, axis="x", value=drive), fm.Contact("bearing", body, law=law, normal_force=1.0),
    ])  # fmt: skip
    bounds = [(0.001, 1.0), (0.01, 3.0), (0.01, 2.0), (0.05, 5.0), (0.0, 1.0), (-0.3, 0.3)]
    found = fm.fit(
        scene, {"t": t, "rotor.x": angle + noise + 0.25}, parameters=dict(zip(TRUE, bounds, strict=True)), offset=True,
        rtol=1e-7, progress=False,
    )  # fmt: skip
    for name, value in TRUE.items():
        assert found.values[name] == pytest.approx(value, rel=0.01), name
    assert found.values["bearing.law.offset"] == pytest.approx(0.05, rel=2e-3)
    assert found.offsets["rotor.x"] == pytest.approx(0.25, abs=1e-4)
    assert np.std(found.residuals["rotor.x"]) < 1.2e-4
