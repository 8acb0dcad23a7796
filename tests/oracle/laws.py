"""Laws of the catalogue as functions of numbers, from what they publish of themselves."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import sympy
from scipy.interpolate import PchipInterpolator
from scipy.special import ellipe, ellipk

import fricmb as fm


def parts_of(law: Any, d: int) -> dict[str, Any]:
    """Arguments of :class:`Contact` for a law; ``stretch`` (d,) scales velocities and forces."""
    if isinstance(law, fm.laws.Elliptic):
        inner = parts_of(law.law, d)
        return {**inner, "stretch": np.array([1.0, float(law.ratio)])[:d]}
    if isinstance(law, fm.laws.Offset):
        return parts_of(law.law, d)
    if isinstance(law, fm.laws.Contensou):
        return {"force": disc(float(law.mu), float(law.v_reg))}
    if law.kind == "smooth":
        return smooth(law, d)
    mu = tabulated(law) if isinstance(law, fm.laws.Tabulated) else coefficient(law)
    static = getattr(law, "mu_s", None)
    return {"mu": mu, "mu_s": (lambda N: mu(0.0, N)) if static is None else (lambda N: float(static))}


def coefficient(law: Any) -> Callable[[float, float], float]:
    """mu(r, N) of ``define_coefficient``."""
    r, N = sympy.Symbol("r", nonnegative=True), sympy.Symbol("N", nonnegative=True)
    mu = sympy.sympify(law.define_coefficient(r, N) if law.load_dependent else law.define_coefficient(r))
    limit = float(sympy.limit(mu, r, 0, "+")) if not mu.has(N) else None
    code = sympy.lambdify([r, N], mu, "math")

    def value(r: float, N: float) -> float:
        return limit if limit is not None and r < 1e-300 else code(r, N)

    return value


def tabulated(law: Any) -> Callable[[float, float], float]:
    """The monotone cubic of Fritsch and Carlson as scipy has it, constant outside."""
    speed = np.asarray(law.speed, dtype=float)
    curve = PchipInterpolator(speed, np.asarray(law.mu, dtype=float))
    return lambda r, N: float(curve(min(max(r, speed[0]), speed[-1])))


def smooth(law: Any, d: int) -> dict[str, Any]:
    """Force and rates of ``define_force`` and ``define_rate``."""
    v = sympy.symbols(f"v0:{d}", real=True)
    n_z = law.n_states(d)
    z = sympy.symbols(f"z0:{n_z}", real=True) if n_z else ()
    N = sympy.Symbol("N", nonnegative=True)
    force = code([*v, N, *z], law.define_force(v, N, z))
    out: dict[str, Any] = {"force": lambda g, N, z: np.array(force(*g, N, *z), dtype=float)}
    if n_z:
        rate = code([*v, N, *z], law.define_rate(v, N, z))
        out |= {"rate": lambda g, N, z: np.array(rate(*g, N, *z), dtype=float), "n_z": n_z}
    return out


def code(arguments: list[Any], expressions: Any) -> Callable[..., Any]:
    """Plain Python of these expressions."""
    many = expressions if isinstance(expressions, list | tuple | sympy.MatrixBase) else (expressions,)
    return sympy.lambdify(arguments, [sympy.sympify(e) for e in many], ["math", {"Max": max, "Min": min}], cse=True)


def disc(mu: float, v_reg: float) -> Callable[..., np.ndarray]:
    """Friction of a disc that slides and spins: the gradient of the power, by complete elliptic integrals."""

    def force(g: np.ndarray, N: float, z: np.ndarray) -> np.ndarray:
        v, u = float(np.hypot(g[0], g[1])), abs(float(g[2]))
        if v == 0.0 and u == 0.0:
            return np.zeros(3)
        f, turn = shares(v, u)
        push = mu * N * np.tanh(np.hypot(v, u) / v_reg)
        along = g[:2] / v if v > 0.0 else np.zeros(2)
        return -push * np.array([*(f * along), turn * np.sign(g[2])])

    return force


def shares(v: float, u: float) -> tuple[float, float]:
    """Sliding and rim force per mu N (Farkas and others, 2003), series where differences cancel."""
    if v >= u:
        x = u / v
        if x < 1e-2:
            return 1.0 - x**2 / 8.0 - x**4 / 64.0, x / 4.0 + x**3 / 48.0
        E, K = ellipe(x**2), ellipk(min(x**2, 1.0 - 1e-16))
        f = ((1.0 / x**2 + 1.0) * E - (1.0 / x**2 - 1.0) * K) * 4.0 / (3.0 * np.pi)
        return f, ((4.0 - 2.0 / x**2) * E + (2.0 / x**2 - 5.0 + 3.0 * x**2) * K) * 4.0 / (9.0 * np.pi * x)
    m = (v / u) ** 2
    E, K = ellipe(m), ellipk(m)
    turn = 4.0 / (9.0 * np.pi) * ((4.0 - 2.0 * m) * E - (1.0 - m) * K)
    if m < 1e-4:
        return v / u * (1.0 - m / 8.0 - m**2 / 64.0), turn
    return 4.0 / (3.0 * np.pi) * (u / v) * ((1.0 + m) * E - (1.0 - m) * K), turn
