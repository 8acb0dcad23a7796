"""Curves and vectors that laws share, in SymPy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fricmb.values import symbolic as symbolic


def norm(components: Sequence[Any]) -> Any:
    """Length of a vector of SymPy expressions, with derivatives that stay finite at 0."""
    from fricmb.values._symbols import norm as length

    return length(components)


def stribeck(law: Any, r: Any) -> Any:
    """mu_k + (mu_s - mu_k) exp(-(r/v_s)^exponent) of a law that has these fields."""
    import sympy

    return law.mu_k + (law.mu_s - law.mu_k) * sympy.exp(-((r / law.v_s) ** law.exponent))


def along(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """Inner product of two vectors."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def corner(s: Any, width: Any) -> Any:
    """How far an element has yielded at the share ``s`` of its strength: 0 below 1 - width, 1 at s = 1, and on.

    A parabola up to s = 1, its tangent beyond: the slope is continuous, so that error estimates see no jump, and
    Newton's method comes home from anywhere.  An element comes to its limit exponentially, within a few ``width``.
    """
    import sympy

    y = sympy.Max(0, 1 + (s - 1) / width)
    return sympy.Piecewise((y**2, y < 1), (2 * y - 1, True))


def yielding(z: Sequence[Any], rate: Sequence[Any], limit: Any, width: Any) -> tuple[Any, ...]:
    """Rate of a deflection z that follows ``rate`` but does not leave the disc |z| <= limit.

    z' = rate - A max(0, z.rate) z/|z|^2 with A from :func:`corner`: on the rim the outward part is taken away, what
    turns back is elastic again.  In one dimension this is a spring and a slider in series.
    """
    import sympy

    length = norm(z)
    outward = corner(length / limit, width) * sympy.Max(0, along(z, rate)) / length**2
    return tuple(r - outward * c for r, c in zip(rate, z, strict=True))


def chunks(z: Sequence[Any], d: int) -> list[tuple[Any, ...]]:
    """The vectors of which the states consist, one after the other."""
    return [tuple(z[i : i + d]) for i in range(0, len(z) - len(z) % d, d)]


def check_order(law: Any) -> None:
    """0 <= mu_k <= mu_s."""
    law._number("mu_s", law.mu_s, minimum=0.0)
    law._number("mu_k", law.mu_k, minimum=0.0)
    if law.mu_k > law.mu_s:
        law._refuse("mu_k", law.mu_k, f"<= mu_s = {law.mu_s:g}")
